"""Census of energy wells: compares `region --rests` with an independent height computation.

    python benchmarks/rest_census.py            100 bodies
    python benchmarks/rest_census.py 500 100    500 bodies, from seed 100 on

Two thirds of the bodies are convex polyhedra with random corners and a random centre of mass,
placed on each of their faces. The others are solids of revolution: domes, roly-polies, bottles,
cups, cones, shells. The height of the centre of mass over the lowest point is computed from the
corners, or from the profile with 4,000 points per arc, without any code of kilter. For each well
the census tests:

    rises       the height grows along 200 random directions of tilt, up to the reported tilt
    costs       along none of them a lower height is reached for less than the reported energy
    pass        on a grid of 20,000 directions, and along the arcs between neighbouring faces,
                another rest is reached for that energy, but not for 1e-3 of the size less
    falls       at the reported tilt that energy is reached, and the body falls beyond (rounds)
    stiffness   the height at a tilt of 0.1 rad agrees with the reported stiffness to 1e-3

For each rest without a reported well, some small tilt must not raise the height. The command
prints counts, the slowest case and the contradictions; the exit code is 1 if there are any. A case
of more than 20 s counts as late.
"""

from __future__ import annotations

import collections
import sys
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.transform import Rotation

from kilter import Assembly, Mesh, Part, Pose, region
from kilter.analysis.regions.well import Well
from kilter.scenes.pieces import floor

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from lathe import turned_part

Array = NDArray[np.float64]
G = 9.81
DOWN = np.array([0.0, 0.0, -1.0])
WAYS, NET, ALONG, PROFILE = 200, 20_000, 60, 4_000
LATE = 20.0
"""A case counts as late above this time [CPU s]."""


@dataclass(frozen=True)
class Case:
    """A standing body: its part, and the points of its hull relative to the centre of mass.

    `points`: shape (n, 3); of a body of revolution (n, 2), distance from the axis and height.
    """

    kind: str
    part: Part
    points: Array

    def heights(self, directions: Array) -> Array:
        """Heights of the centre of mass over the lowest point for directions of gravity, (k,)."""
        if self.points.shape[1] == 3:
            return np.asarray((directions @ self.points.T).max(axis=1))
        aside = np.hypot(directions[:, 0], directions[:, 1])
        flat = np.column_stack([aside, directions[:, 2]])
        return np.asarray((flat @ self.points.T).max(axis=1))


def polyhedra(random: np.random.Generator) -> list[Case]:
    """A random polyhedron, once on each face of its hull."""
    cloud = random.normal(size=(int(random.integers(5, 14)), 3)) * random.uniform(0.4, 1.6, 3)
    cloud /= np.where(random.random() < 0.5, np.linalg.norm(cloud, axis=1), 1.0)[:, None]
    hull = ConvexHull(cloud)
    corners = cloud[hull.vertices]
    hull = ConvexHull(corners)
    center = random.dirichlet(np.ones(len(corners))) @ corners
    legs = corners[hull.simplices[:, 1:]] - corners[hull.simplices[:, :1]]
    out = np.einsum("ij,ij->i", np.cross(legs[:, 0], legs[:, 1]), hull.equations[:, :3]) > 0
    faces = np.where(out[:, None], hull.simplices, hull.simplices[:, ::-1])
    cases = []
    for normal, offset in zip(hull.equations[:, :3], hull.equations[:, 3], strict=True):
        turn, _ = Rotation.align_vectors(DOWN[None], normal[None])
        shape = Mesh(corners, faces)
        quaternion = turn.as_quat()[[3, 0, 1, 2]]
        part = Part("b", shape, Pose([0, 0, -offset], quaternion), mass=2.0, center_of_mass=center)
        cases.append(Case("polyhedron", part, turn.apply(corners - center)))
    return cases


def rounds(random: np.random.Generator) -> list[Case]:
    """A body of revolution of a random kind and size."""
    a, b, c = random.uniform(0.2, 1.5, 3)
    kinds = {
        "dome": [(0, 0), (a, a, 0, a), (0, a)],
        "dome on its flat side": [(0, 0), (a, 0), (0, a, 0, 0)],
        "roly-poly": [(0, 0), (a, a, 0, a), (a, a + b), (0, a + b)],
        "tall dome": [(0, 0), (a, a, 0, a), (c / 2, a + b), (0, a + b)],
        "bottle": [(0, 0), (a, 0), (a, b), (c / 3, b + c), (0, b + c)],
        "cup": [(0, 0), (a, 0), (a, b), (0.9 * a, b), (0.9 * a, 0.2 * b), (0, 0.2 * b)],
        "cone": [(0, 0), (a, 0), (0, b)],
        "shell": [(0, 0), (a, a, 0, a), (0.9 * a, a), (0, 0.1 * a, 0, a)],
        "top": [(0, 0), (a, b), (0, b + c)],
    }
    kind = list(kinds)[int(random.integers(len(kinds)))]
    own = turned_part("b", kinds[kind])
    low = float(own.shape.centroid[2])
    part = turned_part("b", kinds[kind], center_of_mass=[0, 0, low * random.uniform(0.8, 1.2)])
    height = float(part.center_of_mass[2])
    return [Case(kind, part, _profile(kinds[kind]) - [0, height])]


def _profile(steps: list[tuple[float, ...]]) -> Array:
    points = [np.array([steps[0][:2]])]
    share = np.linspace(0, 1, PROFILE)[:, None]
    for before, step in pairwise(steps):
        start, end = np.array(before[:2]), np.array(step[:2])
        if len(step) == 2:
            points.append(np.array([end]))
            continue
        center = np.array(step[2:])
        first, last = (np.arctan2(*(p - center)[::-1]) for p in (start, end))
        angle = first + share * ((last - first + np.pi) % (2 * np.pi) - np.pi)
        radius = np.linalg.norm(start - center)
        points.append(center + radius * np.hstack([np.cos(angle), np.sin(angle)]))
    return np.vstack(points)


# comparison ---------------------------------------------------------------------------------


def way_out(angles: Array, way: float) -> Array:
    """Unit directions of gravity tilted by angles (n,) towards an azimuth `way` [rad]; (n, 3)."""
    level = np.array([np.cos(way), np.sin(way), 0.0])
    return np.cos(angles)[:, None] * DOWN + np.sin(angles)[:, None] * level


def disagreements(case: Case, well: Well | None, random: np.random.Generator) -> list[str]:
    """Names of the tests in which a well contradicts the heights."""
    size = float(np.linalg.norm(case.points, axis=1).max())
    blur = 1e-6 * size if case.points.shape[1] == 2 else 1e-9 * size
    rest = float(case.heights(DOWN[None])[0])
    ways = random.uniform(0, 2 * np.pi, WAYS)
    if well is None:
        near = [case.heights(way_out(np.array([3e-2]), way))[0] - rest for way in ways]
        return [] if min(near) < 1e-3 * size else ["there is a well"]
    weight = G * (2.0 if case.kind == "polyhedron" else _mass(case.part))
    wrong = []
    if well.over_deg is not None:
        tilt = np.radians(well.over_deg)
        shares = np.linspace(0, tilt, 60)
        every = [*ways, *_over_edges(case)]
        rising = [np.diff(case.heights(way_out(shares, way))).min() for way in every]
        wrong += ["rises"] if min(rising) < -blur else []
    if well.barrier is not None:
        top = rest + well.barrier / weight
        around = np.linspace(0, np.pi, 720)
        for way in ways:
            height = case.heights(way_out(around, way))
            lower = np.flatnonzero(height < rest - blur)
            if len(lower) and height[: lower[0]].max() < top - blur - 3e-5 * size:
                wrong.append("costs")
                break
        wrong += _passes(case, tilt, top, rest, size)
    if well.stiffness is not None:
        step = 0.1
        up = float(case.heights(way_out(np.array([step]), 0.3))[0]) - rest
        found = up / (1 - np.cos(step)) * weight
        wrong += ["stiffness"] if abs(found / well.stiffness - 1) > 1e-3 else []
    return wrong


def _mass(part: Part) -> float:
    return float(Assembly([part]).geometry.mass[0])


def _passes(case: Case, tilt: float, top: float, rest: float, size: float) -> list[str]:
    """Contradictions of the reported barrier: another rest is reached for less, or not for it."""
    if case.points.shape[1] == 2:
        after = case.heights(way_out(np.array([tilt, tilt + 1e-3 * np.pi]), 0.0))
        level = abs(after[0] - top) < 1e-6 * size
        return [] if level and after[1] < after[0] else ["falls"]
    k = np.arange(NET) + 0.5
    z, turn = 1 - 2 * k / NET, np.pi * (1 + np.sqrt(5)) * k
    flat = np.sqrt(1 - z**2)
    others = _other_rests(case)
    ends, arcs = _arcs(case)
    spread = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)
    net = np.vstack([DOWN, others, spread, arcs])
    pairs = cKDTree(net).query_pairs(2.6 * np.sqrt(4 * np.pi / NET) / 2, output_type="ndarray")
    pairs = np.vstack([pairs, ends + len(net) - len(arcs)])
    height = case.heights(net)
    cost = np.maximum(height[pairs[:, 0]], height[pairs[:, 1]])

    def reaches(level: float) -> bool:
        kept = pairs[cost <= level]
        graph = coo_array((np.ones(len(kept)), kept.T), shape=(len(net), len(net)))
        _, group = connected_components(graph, directed=False)
        return bool((group[1 : len(others) + 1] == group[0]).any())

    wrong = ["pass: for less"] if reaches(top - 1e-3 * size) else []
    return wrong if reaches(top + 1e-3 * size) else [*wrong, "pass: not for it"]


def _over_edges(case: Case) -> list[float]:
    """Azimuths perpendicular to the edges of the base [rad]."""
    if case.points.shape[1] == 2:
        return []
    base = case.points[case.points @ DOWN > (case.points @ DOWN).max() - 1e-9]
    out = ConvexHull(base[:, :2]).equations
    return [float(way) for way in np.arctan2(out[:, 1], out[:, 0])]


def _other_rests(case: Case) -> Array:
    """Normals of the other faces that contain the foot of the centre of mass, shape (k, 3)."""
    hull = ConvexHull(case.points)
    found = []
    for normal, offset, face in zip(
        hull.equations[:, :3], hull.equations[:, 3], hull.simplices, strict=True
    ):
        corners = case.points[face]
        share = np.linalg.solve(corners.T, -offset * normal)
        if (share > 0).all() and normal @ DOWN < 1 - 1e-9:
            found.append(normal)
    return np.array(found).reshape(-1, 3)


def _arcs(case: Case) -> tuple[NDArray[np.int64], Array]:
    """Directions on the arcs between neighbouring faces, and pairs of successive directions.

    The cheapest passes between rests lie on these arcs.
    """
    hull = ConvexHull(case.points)
    first = np.repeat(np.arange(len(hull.simplices)), 3)
    second = hull.neighbors.reshape(-1)
    m, n = (
        hull.equations[one, :3][:, None] for one in (first[first < second], second[first < second])
    )
    share = np.linspace(0, 1, ALONG)[:, None]
    arcs = (1 - share) * m + share * n
    arcs /= np.linalg.norm(arcs, axis=2)[:, :, None]
    place = np.arange(arcs.shape[0] * ALONG).reshape(-1, ALONG)
    return np.stack([place[:, :-1], place[:, 1:]], axis=2).reshape(-1, 2), arcs.reshape(-1, 3)


def _nearly_flat(case: Case) -> bool:
    """Whether a face next to the base differs by less than a milliradian; then both touch."""
    if case.points.shape[1] == 2:
        return False
    away = np.linalg.norm(ConvexHull(case.points).equations[:, :3] - DOWN, axis=1)
    return bool(((away > 1e-9) & (away < 1e-3)).any())


def main() -> None:
    """Run the census and print counts, the slowest case and the contradictions."""
    given = [int(one) for one in sys.argv[1:]]
    count, first = (given + [100, 0][len(given) :])[:2]
    counts: collections.Counter[str] = collections.Counter()
    slowest, wrong = (0.0, ""), []
    for seed in range(first, first + count):
        random = np.random.default_rng(seed)
        for k, case in enumerate((rounds if seed % 3 == 2 else polyhedra)(random)):
            begun = time.process_time()
            assembly = Assembly([floor([-30, -30], [30, 30]), case.part])
            rests = region(assembly, rests=True).rests
            spent = time.process_time() - begun
            slowest = max(slowest, (spent, f"{case.kind}, seed {seed}, face {k}"))
            here = [rest for rest in rests if rest.down @ DOWN > 1 - 1e-12]
            if not here or here[0].state in ("balanced", "open"):
                counts[f"{case.kind}: {here[0].state if here else 'does not stay'}"] += 1
                continue
            well = here[0].well
            if well is None and _nearly_flat(case):
                counts[f"{case.kind}: touches by two faces that are nearly one"] += 1
                continue
            counts[f"{case.kind}: {'a well' if well else 'none'}"] += 1
            counts["late"] += spent > LATE
            wrong += [
                f"seed {seed} face {k} {case.kind}: {one}"
                for one in disagreements(case, well, random)
            ]
    for kind, number in sorted(counts.items()):
        print(f"{number:6d}  {kind}")
    print(f"slowest {slowest[0]:.2f} s CPU: {slowest[1]}")
    print(f"{len(wrong)} contradictions", *wrong, sep="\n")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
