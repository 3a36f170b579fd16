"""Census of the rung *play*: assemblies that are drawn with play, in closed form.

    python benchmarks/play_census.py 100
    python benchmarks/play_census.py --only 17

Pins in holes, buttons, drawers, lids, stacks with gaps and overlaps, balls in grooves, keys, rings
and cabinets of random sizes between 10 mm and 1 m, in random directions
(`tests/settled_pose/play_scenes.py`). For each, the shift of every part that comes to rest and the
names of the parts that fall out are known. The command lists each assembly whose answer differs by
more than 1e-6 of its size, and the CPU time; the exit code is 1 if there are any.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

import kilter

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "settled_pose"))
from compared_rest import rest_error
from play_scenes import KnownRest, random_scene


def examined(known: KnownRest, limit: float) -> tuple[str, float]:
    """Difference from the known answer, empty if there is none, and the CPU time [s]."""
    begun = time.process_time()
    try:
        answer = kilter.settle(known.assembly, require="equilibrium", time_limit=limit)
    except kilter.KilterError as error:
        return str(error), time.process_time() - begun
    return rest_error(known, answer), time.process_time() - begun


def main() -> int:
    """Run the census; return 1 if an answer differs."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("count", type=int, nargs="?", default=100, help="number of assemblies")
    parser.add_argument("--seed", type=int, default=0, help="first seed")
    parser.add_argument("--only", type=int, help="a single seed")
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of a search [s]")
    options = parser.parse_args()
    seeds = range(options.seed, options.seed + options.count)
    wrong, seconds = 0, []
    for seed in seeds if options.only is None else [options.only]:
        known = random_scene(np.random.default_rng([11, seed]))
        why, took = examined(known, options.seconds)
        seconds.append(took)
        wrong += bool(why)
        if why or options.only is not None:
            print(f"{seed:4} {known.name}, {took:.2f} s: {why or 'right'}", flush=True)
    print(
        f"{len(seconds) - wrong} of {len(seconds)} right; CPU s: median {np.median(seconds):.2f}, "
        f"largest {max(seconds):.2f}"
    )
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
