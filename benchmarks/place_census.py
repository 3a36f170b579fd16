"""Census of `kilter.place`: polygons on random stacks of boxes, checked by `kilter.check_many`.

    python benchmarks/place_census.py [STACKS] [FIRST SEED] [--prisms] [--mu MU] [--falling]
                                      [--places P]

Each stack has 3 to 15 boxes (with --prisms: convex prisms). Each is put down at a random place at
which the stack stood (with --falling: the last part at a place at which the stack falls); half of
the heights are equal, so that parts rest on several others. For a further part, the map of places
is computed. `kilter.check_many` (level equilibrium), which has the verdicts of `check`, decides
the whole assembly at P places at random that stand by the map and P that fall, and just inside and
just outside of the middle of each edge of these polygons. A place outside of an edge counts if it
lies in a polygon again, beyond the open strip or beyond an exact edge. Prints contradictions, the
share of open places (of stacks in which the geometry decides all contacts), and CPU seconds per
map, after each 10 stacks.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import shapely

from kilter import Assembly, Box, Part, Pose, Prism, check_many
from kilter.analysis.placing.place import LevelPlaces, Places, box_to_place, place
from kilter.analysis.placing.upright_prisms import find_tops
from kilter.errors import InputError

EDGE = 1e-4
"""Distance of the places beside an edge from it."""
FLUSH = 2 * EDGE
"""Distance from the side of a neighbour below which places are left out: of flush places the map
states nothing, and check leaves open whether parts that are this near are joined."""
BASE = 6.0
HOLDS = ("stable", "settles", "potentially-stable", "balanced")


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stacks", nargs="?", type=int, default=20)
    parser.add_argument("first", nargs="?", type=int, default=1)
    parser.add_argument("--prisms", action="store_true")
    parser.add_argument("--mu", type=float, default=0.0)
    parser.add_argument("--falling", action="store_true")
    parser.add_argument("--places", type=int, default=100)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
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
        if places.question is not None and not places.question.contacts.open_pairs:
            shares.append(100 * sum(level.open.area for level in places.levels) / BASE**2)
        assert sum(level.stands.area + level.falls.area for level in places.levels) > 0
        counts += compared(rng, places, given.places, seed)
        if len(seconds) % 10 == 0 or len(seconds) == given.stacks:
            print(f"{len(seconds)} maps: {dict(counts)}")
            shown = (("open [% of the base]", shares), ("programs", programs),
                     ("CPU s per map", seconds))  # fmt: skip
            for name, values in shown:
                print(f"  {name}: median {statistics.median(values):.3g}, worst {max(values):.3g}",
                      flush=True)  # fmt: skip
    return 1 if counts["contradictions"] else 0


def compared(rng: np.random.Generator, places: Places, number: int, seed: int) -> Counter[str]:
    """Compare places of a map with check; print and count contradictions."""
    counts: Counter[str] = Counter()
    chosen = [
        (level, kind, point, stands)
        for level in places.levels
        for kind, point, stands in chosen_places(rng, level, number / len(places.levels))
        if not is_flush(places, level, point)
    ]
    if not chosen:
        return counts
    answers = check_many(
        [placed(places, level, point) for level, _, point, _ in chosen], require="equilibrium"
    )
    for (_, kind, point, stands), verdict in zip(chosen, answers.verdict, strict=True):
        counts[kind] += 1
        if verdict in ("undecided", "error"):
            counts[str(verdict)] += 1
        elif (verdict in HOLDS) != stands:
            counts["contradictions"] += 1
            said = "stands" if stands else "falls"
            print(f"seed {seed}: {said} at {point} ({kind}), check: {verdict}", flush=True)
    return counts


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
        if answer.at is not None and answer.at.verdict == verdict:
            return answer.at.worst.assembly
    return stack


def chosen_places(
    rng: np.random.Generator, level: LevelPlaces, number: float
) -> Iterator[tuple[str, np.ndarray, bool]]:
    """Kind of a place, place, and whether it stands by the map: at random, and beside edges."""
    regions = ((level.stands, True), (level.falls, False))
    for region, stands in regions:
        pieces = [piece for piece in shapely.get_parts(region) if piece.area > 1e-6]
        total = sum(piece.area for piece in pieces)
        for piece in pieces:
            low, high = np.array(piece.bounds[:2]), np.array(piece.bounds[2:])
            tried = np.ceil(number * piece.area / total * (high - low).prod() / piece.area)
            for point in rng.uniform(low, high, (int(tried), 2)):
                if piece.contains(shapely.Point(point)):
                    yield ("inside" if stands else "outside"), point, stands
            for ring in (piece.exterior, *piece.interiors):
                corners = shapely.get_coordinates(ring)
                for start, end in itertools.pairwise(corners):
                    along = end - start
                    if np.linalg.norm(along) < 10 * EDGE:
                        continue
                    across = EDGE * np.array([-along[1], along[0]]) / np.linalg.norm(along)
                    for beside in ((start + end) / 2 + across, (start + end) / 2 - across):
                        for other, answer in regions:
                            if other.contains(shapely.Point(beside)):
                                inner = other is region
                                yield f"{'inside' if inner else 'beyond'} an edge", beside, answer


def is_flush(places: Places, level: LevelPlaces, point: np.ndarray) -> bool:
    """Whether the part touches the side of a neighbour at a place."""
    assert places.prism is not None
    under = shapely.polygons(places.prism.footprint + point)
    return any(
        top.high > level.height - places.prism.below + FLUSH
        and top.low < level.height + places.prism.above - FLUSH
        and top.polygon.distance(under) < FLUSH
        for top in find_tops(places.assembly)
    )


def placed(places: Places, level: LevelPlaces, point: np.ndarray) -> Assembly:
    """The assembly with the part at a place."""
    assert places.prism is not None
    center = Assembly([places.part]).geometry.center[0]
    shift = np.append(point, level.height) - center
    pose = Pose(np.asarray(places.part.pose.position) + shift, places.part.pose.rotation)
    return places.assembly.with_parts([replace(places.part, pose=pose)])


if __name__ == "__main__":
    sys.exit(main())
