"""Census of `kilter.Pile`: places on random piles, compared with `kilter.check`.

    python benchmarks/pile_census.py [PILES] [FIRST SEED] [--boxes N] [--places P] [--mu MU]
                                     [--limit SECONDS] [--aligned]

Each pile grows by random boxes of irregular size and mass; with --aligned, the sizes are multiples
of the step, so that most faces are flush. Half of the places are on a grid, so
that sides are flush, the others anywhere. Half of the heights are equal or differ by about the gap
tolerance, so that boxes rest on several others, or nearly do. Of the places at which the pile
stands, low ones are preferred, so there are overhangs that later boxes hold down. Then
`Pile.fits` decides a grid of 24 x 16 places for three further boxes, and `kilter.check` (level
equilibrium) decides P of these places at random, on the assembly with the box. Prints
contradictions, undecided places, and places per CPU second: places at which the box lies on the
base; those off the base are decided at no cost. A pile that reaches the time limit [CPU s] is
reported and left.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

import numpy as np

import kilter
from kilter import Pile, PileFit

BASE = (1.2, 0.8)
STEP = 0.05
QUESTIONS = 3
HEIGHTS = (0.1, 0.15, 0.2)


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("piles", nargs="?", type=int, default=20)
    parser.add_argument("first", nargs="?", type=int, default=1)
    parser.add_argument("--boxes", type=int, default=20)
    parser.add_argument("--places", type=int, default=30)
    parser.add_argument("--mu", type=float, default=0.0)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--aligned", action="store_true")
    given = parser.parse_args()
    answers: Counter[tuple[str, str]] = Counter()
    steps: Counter[str] = Counter()
    seconds, places, wrong, programs, slowest, checking = 0.0, 0, 0, 0, 0.0, 0.0
    for seed in range(given.first, given.first + given.piles):
        started = time.process_time()
        rng = np.random.default_rng(seed)
        pile = random_pile(rng, given, started + given.limit)
        if len(pile) < given.boxes:
            print(f"seed {seed}: {len(pile)} boxes at the time limit", flush=True)
        for _ in range(QUESTIONS):
            size, mass = random_box(rng, given.aligned)
            began = time.process_time()
            fit = pile.fits(size, mass, STEP)
            took = time.process_time() - began
            seconds, slowest = seconds + took, max(slowest, took)
            places += int(np.isfinite(fit.heights).sum())
            programs += fit.programs
            steps.update(fit.steps)
            on_base = np.argwhere(np.isfinite(fit.heights))
            chosen = rng.permutation(len(on_base))[: given.places]
            for i, j in on_base[chosen]:
                if time.process_time() > started + given.limit:
                    print(f"seed {seed}: time limit", flush=True)
                    break
                began = time.process_time()
                pair = answer_of(fit, i, j), checked(pile, size, mass, (fit.x[i], fit.y[j]))
                checking += time.process_time() - began
                answers[pair] += 1
                if "undecided" not in pair and pair[0] != pair[1]:
                    wrong += 1
                    print(f"seed {seed}: {pair} at {i}, {j} of {size}, {mass}", flush=True)
    compared = sum(answers.values())
    print(
        f"{given.piles} piles of {given.boxes} boxes, mu {given.mu:g}; {compared} places compared"
    )
    print(f"contradictions: {wrong}")
    for (ours, theirs), number in sorted(answers.items()):
        print(f"  Pile {ours}, check {theirs}: {number}")
    print(f"{places} places in {seconds:.2f} CPU s: {places / seconds:.0f} places per second")
    print(f"slowest grid {slowest:.3f} CPU s; {programs / places:.4f} programs per place")
    print(f"check: {compared / max(checking, 1e-9):.0f} places per second")
    for step, number in steps.most_common():
        print(f"  {step}: {number}")
    return 1 if wrong else 0


def random_box(rng: np.random.Generator, aligned: bool) -> tuple[np.ndarray, float]:
    """Size and mass of a box; half of the heights are equal up to about the gap tolerance."""
    if aligned:
        return rng.integers(2, 9, 3) * STEP, float(rng.uniform(0.5, 12))
    height = float(rng.choice([*HEIGHTS, *rng.uniform(0.06, 0.25, 3)]))
    height += float(rng.choice([0.0, 0.0, 1e-6, 4e-6, 1e-4])) * rng.choice([-1, 1])
    return np.append(rng.uniform(0.08, 0.45, 2), height), float(rng.uniform(0.5, 12))


def random_pile(rng: np.random.Generator, given: argparse.Namespace, until: float) -> Pile:
    """A pile that grows at random places at which it stands."""
    pile = Pile(BASE, given.mu)
    while len(pile) < given.boxes and time.process_time() < until:
        size, mass = random_box(rng, given.aligned)
        shift = rng.uniform(0, STEP, 2) * (0 if given.aligned else rng.integers(0, 2))
        fit = pile.fits(size, mass, STEP)
        standing = np.argwhere(fit.mask)
        if not len(standing):
            continue
        height = fit.heights[tuple(standing.T)] + rng.uniform(0, 0.1, len(standing))
        i, j = standing[rng.choice(np.argsort(height)[:20])]
        at = np.minimum(np.array([fit.x[i], fit.y[j]]) + shift, np.array(BASE) - size[:2])
        grown = pile.copy()
        grown.add(size, mass, at)
        if not grown.stands:
            grown = pile.copy()
            grown.add(size, mass, (fit.x[i], fit.y[j]))
        pile = grown
    return pile


def answer_of(fit: PileFit, i: int, j: int) -> str:
    """The answer of the pile at a place."""
    if fit.undecided[i, j]:
        return "undecided"
    return "stands" if fit.mask[i, j] else "falls"


def checked(pile: Pile, size: np.ndarray, mass: float, at: tuple[float, float]) -> str:
    """The answer of check on the assembly with the box."""
    grown = pile.copy()
    grown.add(size, mass, at)
    verdict = kilter.check(grown.assembly(), require="equilibrium")
    if verdict.verdict == "undecided":
        return "undecided"
    return "falls" if verdict.level is None else "stands"


if __name__ == "__main__":
    sys.exit(main())
