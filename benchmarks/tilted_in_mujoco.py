"""Verdicts for random bodies on tilted floors beside 2 s of simulation in MuJoCo.

    pip install -e ".[mujoco]"
    python benchmarks/tilted_in_mujoco.py 200
    python benchmarks/tilted_in_mujoco.py 50 --first 200

The scenes of `tests/objects/tilted_scenes.py` have several geoms a body, with random friction,
priority and contact pairs. A scene is wrong if it is proved stable and moves by more than 1 mm, or
proved unstable and does not. Scenes whose verdict changes within 3 % of the slope are not judged.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "objects"))

from tilted_scenes import MOVED, outcome


def main() -> None:
    """Count the outcomes of the scenes, and print those that are wrong."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scenes", nargs="?", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    asked = parser.parse_args()
    counts: Counter[tuple[str, str]] = Counter()
    wrong = 0
    for seed in range(asked.first, asked.first + asked.scenes):
        found = outcome(seed)
        counts[found.verdict, "moves" if found.moved > MOVED else "rests"] += 1
        if found.wrong:
            wrong += 1
            print(f"wrong: scene {seed}: {found.verdict}, moved {found.moved:.3g} m", flush=True)
    for (verdict, state), count in sorted(counts.items()):
        print(f"{count} {verdict}, {state}")
    print(f"wrong: {wrong}")


if __name__ == "__main__":
    main()
