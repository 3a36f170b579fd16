"""Second-order limits by bisection: distance from the limit up to which each side is proved.

    python benchmarks/second_order_limits.py            all cases with a limit
    python benchmarks/second_order_limits.py 19 39      selected cases, by number

Each case has two bisections between 0.1 below and 0.1 above the known limit: the last parameter
at which the state below is proved, and the first at which the state above is proved. Between them
the answer is open. A row contains both parameters minus the limit. The exit code is 1 if a
parameter is on the wrong side, or farther than 1e-6 from the limit.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import kilter

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from balance_cases import CASES, Case

AROUND, WITHIN, RESOLVED = 0.1, 1e-6, 1e-7
"""Half width of the bisected interval, largest allowed distance, accuracy [parameter]."""


def last(holds: Callable[[float], bool], inner: float, outer: float) -> float:
    """Bisect the last parameter from `inner` towards `outer` at which a property holds."""
    if not holds(inner):
        raise ValueError(f"it does not hold at {inner}")
    while abs(outer - inner) > RESOLVED:
        middle = (inner + outer) / 2
        inner, outer = (middle, outer) if holds(middle) else (inner, middle)
    return inner


def found_limits(case: Case) -> tuple[float, float]:
    """Last parameter with the state below proved, first with the state above; minus the limit."""
    limit = case.limit
    assert limit is not None

    def is_in(state: str | None) -> Callable[[float], bool]:
        def holds(parameter: float) -> bool:
            second = kilter.check(case.build(parameter)).second_order_answer
            return second is not None and second.state == state

        return holds

    below = last(is_in(case.state), limit - AROUND, limit + AROUND)
    above = last(is_in(case.above), limit + AROUND, limit - AROUND)
    return below - limit, above - limit


def right(below: float, above: float) -> bool:
    """Whether both parameters are on their side of the limit and close to it."""
    return -WITHIN <= below <= RESOLVED and -RESOLVED <= above <= WITHIN and below < above


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("numbers", nargs="*", help="of cases; all without")
    numbers = parser.parse_args().numbers
    wrong = 0
    print(f"{'case':>5} {'limit':>10} {'proved below':>13} {'proved above':>13} {'s':>6}")
    for case in CASES:
        if case.limit is None or (numbers and case.number not in numbers):
            continue
        begun = time.process_time()
        below, above = found_limits(case)
        wrong += not right(below, above)
        took = time.process_time() - begun
        print(f"{case.number:>5} {case.limit:10.6f} {below:13.1e} {above:13.1e} {took:6.1f}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
