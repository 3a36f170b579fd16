"""Census of `kilter.place`: polygons on random stacks of boxes, checked by `kilter.check`.

    python benchmarks/place_census.py [STACKS] [FIRST SEED] [--prisms] [--mu MU] [--falling]

Each stack has 3 to 15 boxes (with --prisms: convex prisms). Each is put down at a random place at
which the stack stood (with --falling: the last part at a place at which the stack falls); half of
the heights are equal, so that parts rest on several others. For a further part, the map of places
is computed. `kilter.check` of the whole assembly decides places at random inside the polygons that
stand and those that fall, and places just inside of their edges. Prints contradictions, the share
of open places, and CPU seconds per map.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time

import numpy as np
import shapely

from kilter import Assembly, Box, Part, Pose, Prism
from kilter.analysis.placing.place import box_to_place, place
from kilter.errors import InputError

POINTS = 20
EDGE = 1e-4
BASE = 6.0


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stacks", nargs="?", type=int, default=20)
    parser.add_argument("first", nargs="?", type=int, default=1)
    parser.add_argument("--prisms", action="store_true")
    parser.add_argument("--mu", type=float, default=0.0)
    parser.add_argument("--falling", action="store_true")
    given = parser.parse_args()
    wrong = tested = 0
    seconds, shares, programs = [], [], []
    for seed in range(given.first, given.first + given.stacks):
        rng = np.random.default_rng(seed)
        stack = random_stack(rng, int(rng.integers(3, 16)), given.prisms, given.mu)
        if given.falling:
            stack = with_next(rng, stack, given.prisms, "unstable")
        part = random_part(rng, given.prisms, "new")
        began = time.process_time()
        places = place(stack, part)
        seconds.append(time.process_time() - began)
        programs.append(places.programs)
        mapped = sum(level.stands.area + level.falls.area for level in places.levels)
        left = sum(level.open.area for level in places.levels)
        shares.append(left / BASE**2)
        for level in places.levels:
            for name, region in (("stands", level.stands), ("falls", level.falls)):
                for point in chosen(rng, region):
                    answer = decided(stack, part, point)
                    if answer is None:
                        continue
                    tested += 1
                    holds = answer in ("stable", "settles", "potentially-stable", "balanced")
                    if holds != (name == "stands") and answer != "undecided":
                        wrong += 1
                        print(
                            f"seed {seed}: {name} at {point}, but check says {answer}", flush=True
                        )
        assert mapped > 0
    print(f"{given.stacks} maps, {tested} places, {wrong} contradictions")
    shown = (("open [% of the base]", [100 * share for share in shares]), ("programs", programs))
    for name, values in (*shown, ("CPU s per map", seconds)):
        print(f"{name}: median {statistics.median(values):.3g}, worst {max(values):.3g}")
    return 1 if wrong else 0


def random_part(rng: np.random.Generator, prism: bool, name: str) -> Part:
    mass = float(rng.uniform(1, 10))
    if not prism:
        size = rng.uniform(0.5, 2.5, 3)
        size[2] = rng.choice([0.5, 1.0, rng.uniform(0.4, 1.5)])
        return box_to_place(size, mass, name=name)
    angles = np.sort(rng.uniform(0, 2 * np.pi, int(rng.integers(4, 8))))
    radius = rng.uniform(0.6, 1.4)
    outline = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    outline -= outline.mean(axis=0)
    # a prism lies along y: turned about x, its axis is vertical
    turn = [np.sqrt(0.5), np.sqrt(0.5), 0, 0]
    height = float(rng.choice([0.5, 1.0, rng.uniform(0.4, 1.5)]))
    return Part(name, Prism(outline, height), Pose([0, 0, 0], turn), mass=mass)


def random_stack(rng: np.random.Generator, count: int, prisms: bool, mu: float) -> Assembly:
    """Parts put down one after the other, each at a place at which everything stands."""
    base = Part("base", Box([BASE, BASE, 1]), Pose([0, 0, -0.5]), grounded=True)
    stack = Assembly([base], friction=mu)
    tries = 0
    while len(stack.parts) <= count and tries < 20:
        stack = with_next(rng, stack, prisms, "stable")
        tries += 1
    return stack


def with_next(rng: np.random.Generator, stack: Assembly, prisms: bool, verdict: str) -> Assembly:
    """The stack with a further part at a random place with this verdict, if one is found."""
    for _ in range(20):
        part = random_part(rng, prisms, f"p{len(stack.parts)}")
        at = rng.uniform(-BASE / 2 + 0.5, BASE / 2 - 0.5, 2)
        try:
            answer = place(stack, part, at=at, require="equilibrium")
        except InputError:
            continue
        if answer.at is not None and answer.at.verdict.verdict == verdict:
            return answer.at.verdict.assembly
    return stack


def chosen(rng: np.random.Generator, region: shapely.Geometry) -> list[np.ndarray]:
    """Places inside a region at random, and near its edges on the inner side."""
    found = []
    for piece in shapely.get_parts(region):
        if not piece.area > 1e-6:
            continue
        low, high = np.array(piece.bounds[:2]), np.array(piece.bounds[2:])
        for point in rng.uniform(low, high, (POINTS, 2)):
            if piece.contains(shapely.Point(point)):
                found.append(point)
        inner = piece.buffer(-EDGE)
        rings = shapely.get_coordinates(inner)
        if len(rings):
            found += list(rings[rng.integers(0, len(rings), min(4, len(rings)))])
    return found


def decided(stack: Assembly, part: Part, point: np.ndarray) -> str | None:
    """The verdict of check at a place; None if the part touches a neighbour there."""
    try:
        answer = place(stack, part, at=point, require="equilibrium")
    except InputError:
        return None
    assert answer.at is not None
    whole = answer.at.verdict
    names = whole.assembly.names
    contacts = whole.contacts
    k = whole.assembly.index_of(names[-1])
    side = [
        abs(contacts.patch_normal[p, 2]) < 0.5
        for p in range(len(contacts))
        if k in contacts.patch_parts[p]
    ]
    return None if any(side) else str(whole.verdict)


if __name__ == "__main__":
    sys.exit(main())
