"""Limits of second order found by bisection: how near to each both sides are proved.

    python benchmarks/second_order_limits.py            all cases of second order that have one
    python benchmarks/second_order_limits.py 19 39      some of them, by number

Two bisections a case, from 0.1 below the known limit to 0.1 above: the last parameter that is
proved to be what it is below, and the first that is proved to be balanced. Between them the answer
is open. A row says both less the limit; the command ends with 1 if one is on the wrong side, or
farther than 1e-6.
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


def last(holds: Callable[[float], bool], inner: float, outer: float) -> float:
    """The farthest from `inner` towards `outer` at which it holds, to `RESOLVED`."""
    if not holds(inner):
        raise ValueError(f"it does not hold at {inner}")
    while abs(outer - inner) > RESOLVED:
        middle = (inner + outer) / 2
        inner, outer = (middle, outer) if holds(middle) else (inner, middle)
    return inner


def found_limits(case: Case) -> tuple[float, float]:
    """The last parameter proved to be as below the limit, the first proved balanced; less it."""
    limit = case.limit
    assert limit is not None

    def is_in(state: str | None) -> Callable[[float], bool]:
        def holds(parameter: float) -> bool:
            second = kilter.check(case.build(parameter)).second_order
            return second is not None and second.state == state

        return holds

    below = last(is_in(case.state), limit - AROUND, limit + AROUND)
    above = last(is_in(case.above), limit + AROUND, limit - AROUND)
    return below - limit, above - limit


def right(below: float, above: float) -> bool:
    """Whether both are on their side of the limit, and near."""
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
