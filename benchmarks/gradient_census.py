"""Census of gradients: compares the derivatives of limits with differences of the limits.

    python benchmarks/gradient_census.py                     300 assemblies
    python benchmarks/gradient_census.py 60 --first 100      seeds 100 to 159
    python benchmarks/gradient_census.py 60 --family stack   a single family

Families: stack (boxes of random size and turn), arch, pile, wedge (`tests/scenes/random_turned.py`)
and voronoi (3D cells with shared faces). Each assembly becomes meshes in the world frame. The limit
is its tilt, else its load factor along a random direction, else its least friction. For each:

- equal growth of all masses, and a movement of all parts, change no limit;
- a turn of all parts about the vertical changes neither tilt nor least friction, and a turn toward
  the least tilt changes the tilt as much;
- in a random direction (masses, centres, friction, and a stretch of all parts that keeps their
  contacts), the derivatives of both sides agree with differences of the limit to both sides.

All agree to 1e-6, relative to the larger of the derivative and the limit. Differences of limits
need refined limits, which have twelve digits. If a limit beside is not refined, a smaller step is
tried, and else the assembly is counted as unrefined beside; limits with too many unknowns are
counted as large.

Exit code 1 if there is a contradiction.
"""

from __future__ import annotations

import argparse
import collections
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

import numpy as np
from boxes_on_deck import random_stack
from random_turned import random_turned
from random_voronoi import random_voronoi
from scipy.optimize import minimize_scalar

import kilter
from kilter.analysis.margins import solved_limits
from kilter.errors import InputError

FAMILIES = ("stack", "arch", "pile", "wedge", "voronoi")
AGREE = 1e-6
"""Largest difference of a derivative, relative to the larger of it and the limit [-]."""
STEP = 2e-5
"""Step of the differences, relative to the sizes, masses and coefficients [-]."""
STEPS = (STEP, STEP / 4)
"""Steps of the differences; each is tried until the limits beside are refined [-]."""
EXACT = 1e-4
"""Step of the rates that derivatives take from two assemblies [-]. All data are linear in it, so
that only rounding matters, which grows with a smaller step."""
NO_ERROR = ("smooth", "one-sided", "unknown", "no limit beside", "unrefined beside", "large")
"""Outcomes of a comparison with differences that are no contradiction; the first two agree."""


def assembly_of(family: str, seed: int) -> kilter.Assembly:
    """A random assembly of a family, as meshes in the world frame with given masses."""
    if family == "stack":
        given = random_stack(seed)
    elif family == "voronoi":
        given = random_voronoi(seed)
    else:
        given = random_turned(family, seed)
    return as_meshes(given)


def as_meshes(given: kilter.Assembly) -> kilter.Assembly:
    """The same parts as meshes in the world frame."""
    geometry = given.geometry
    parts = []
    for k, part in enumerate(given.parts):
        span = slice(geometry.vertex_start[k], geometry.vertex_start[k + 1])
        triangles = geometry.triangles[geometry.triangle_start[k] : geometry.triangle_start[k + 1]]
        shape = kilter.Mesh(geometry.vertices[span], triangles - geometry.vertex_start[k])
        parts.append(
            kilter.Part(
                part.name, shape, grounded=part.grounded, mass=float(geometry.mass[k]),
                center_of_mass=geometry.center[k],
            )
        )  # fmt: skip
    return kilter.Assembly(
        parts, gravity=given.gravity, friction=given.friction,
        friction_pairs=given.friction_pairs, units=given.units,
    )  # fmt: skip


def changed(given, growth, shift, masses, centers, rougher):
    """Copy of an assembly with x -> x + growth x + shift, other masses, centres and friction."""
    parts = []
    for k, part in enumerate(given.parts):
        move = lambda x: x + x @ growth.T + shift  # noqa: E731
        shape = kilter.Mesh(move(part.shape.vertices), part.shape.triangles)
        center = move(np.asarray(part.center_of_mass)) + centers[k]
        parts.append(
            kilter.Part(
                part.name, shape, grounded=part.grounded, mass=part.mass * (1 + masses[k]),
                center_of_mass=center,
            )
        )  # fmt: skip
    pairs = [replace(each, mu=each.mu * (1 + rougher)) for each in given.friction_pairs]
    return kilter.Assembly(
        parts, gravity=given.gravity, friction=given.friction * (1 + rougher),
        friction_pairs=pairs, units=given.units,
    )  # fmt: skip


class Case:
    """An assembly, the limit that it has, and its gradient."""

    def __init__(self, assembly, random):
        self.assembly = assembly
        self.push = random.normal(size=3)
        answer = kilter.margin(assembly, push=self.push)
        self.of = "tilt"
        if answer.tilt is None or not 1e-3 < answer.tilt.angle < 1.5:
            greatest = answer.load_limits and answer.load_limits[1]
            self.of = "load factor" if greatest and abs(greatest.value) < 50 else "friction"
        begun = time.process_time()
        self.gradient = answer.gradient(self.of)
        self.seconds = time.process_time() - begun

    def limit(self, assembly) -> float:
        """The same limit of a changed assembly, to rounding; NaN if it is not refined."""
        answer = kilter.margin(assembly, push=self.push, effort=0)
        if self.gradient._cases.turned is not None:  # all directions have nearly the same limit
            return least_over_directions(answer)
        gradient = answer.gradient(self.of)
        if any(case.refined is None for case in gradient._cases.cases):
            return np.nan
        least = min(case.solved.value for case in gradient._cases.cases)
        return float(np.degrees(np.arctan(least))) if self.of == "tilt" else least


def least_over_directions(answer) -> float:
    """The tilt of an assembly that slides in every direction [deg], by a search over directions."""
    tilt = answer.tilt
    turned = solved_limits.LeastDirection(answer, tilt.shared, tilt.toward, 10.0, 1.0).at_angle

    def value(angle):
        return turned(angle).solved.value

    starts = np.arange(16) * (np.pi / 8)
    first = float(starts[np.argmin([value(angle) for angle in starts])])
    bounds = (first - np.pi / 8, first + np.pi / 8)
    best = minimize_scalar(value, bounds=bounds, method="bounded", options={"xatol": 1e-6})
    return float(np.degrees(np.arctan(best.fun)))


def contradictions(case, random) -> list[str]:
    """The comparisons of a case that fail, in words."""
    assembly, gradient = case.assembly, case.gradient
    count = len(assembly.parts)
    none, zero = np.zeros(count), np.zeros((count, 3))
    still = np.zeros((3, 3))
    size = float(np.linalg.norm(assembly.size))
    failed = []

    def compare(name, other, expected, step):
        slope = gradient.along(other)
        for side in (slope.left, slope.right):
            allowed = AGREE * max(abs(gradient.value), abs(expected))
            if not np.isnan(side) and abs(side / step - expected) > allowed:
                failed.append(f"{name}: {side / step:.9g}, not {expected:.9g}")

    compare("masses", changed(assembly, still, 0, none + 0.5, zero, 0), 0.0, 0.5)
    moved = random.normal(size=3) * size
    compare("move", changed(assembly, still, moved, none, zero, 0), 0.0, 1.0)
    down = assembly.down
    spin = np.cross(np.eye(3), down)
    if case.of != "load factor":
        compare("turn", changed(assembly, EXACT * spin, 0, none, zero, 0), 0.0, EXACT)
    if case.of == "tilt" and len(gradient._cases.cases) == 1:
        toward = gradient._cases.cases[0].solved.along_mass
        axis = np.cross(down, toward / np.linalg.norm(toward))
        turn = np.cross(np.eye(3), axis)
        expected = np.degrees(1.0)
        slope = gradient.along(changed(assembly, EXACT * turn, 0, none, zero, 0))
        if abs(abs(slope.right / EXACT) - expected) > AGREE * expected:
            failed.append(f"turn toward: {slope.right / EXACT:.9g}, not {expected:.9g}")
    failed += differences(case, random)
    return failed


def differences(case, random) -> list[str]:
    """Contradictions to differences of the limit in a random direction."""
    assembly, gradient = case.assembly, case.gradient
    count = len(assembly.parts)
    size = float(assembly.geometry.size.min())
    growth = random.normal(size=(3, 3)) * 0.3
    masses, centers = random.normal(size=count), random.normal(size=(count, 3)) * size * 0.1
    centers[[part.grounded for part in assembly.parts]] = 0
    rough = random.normal()

    def at(step):
        return changed(assembly, step * growth, 0, step * masses, step * centers, step * rough)

    slope = gradient.along(at(EXACT))
    slopes = np.array([slope.left, slope.right]) / EXACT
    base = min(c.solved.value for c in gradient._cases.cases)
    if case.of == "tilt":
        base = float(np.degrees(np.arctan(base)))
    if np.isnan(slopes).any():
        return ["unknown"]
    if any(each.refined is None for each in gradient._cases.cases):
        return ["large"]
    for size in STEPS:
        try:
            limits = {k: case.limit(at(k * size)) for k in (-2, -1, 1, 2)}
        except InputError:
            return ["no limit beside"]
        sides = [k * (4 * limits[k] - limits[2 * k] - 3 * base) / (2 * size) for k in (-1, 1)]
        if not np.isnan(sides).any():
            break
    else:
        return ["unrefined beside"]
    if np.abs(slopes - sides).max() > AGREE * max(abs(gradient.value), np.abs(slopes).max()):
        return [
            f"differences {sides[0]:.9g} {sides[1]:.9g}, slopes {slopes[0]:.9g} {slopes[1]:.9g}"
        ]
    apart = abs(slopes[1] - slopes[0]) > AGREE * np.abs(slopes).max()
    return ["one-sided" if apart else "smooth"]


def main() -> int:
    """Run the census; exit code 1 with a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=300)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--family", choices=FAMILIES)
    options = parser.parse_args()
    tally: collections.Counter[str] = collections.Counter()
    wrong = 0
    for seed in range(options.first, options.first + options.count):
        family = options.family or FAMILIES[seed % len(FAMILIES)]
        random = np.random.default_rng(seed)
        try:
            case = Case(assembly_of(family, seed), random)
        except InputError as error:
            tally[f"no limit: {error.what[:40]}"] += 1
            continue
        tally[case.of] += 1
        failed = contradictions(case, random)
        for word in failed:
            tally[word.split(":")[0].split(" ")[0]] += 1
        failed = [word for word in failed if word not in NO_ERROR]
        wrong += len(failed)
        if failed:
            found = f"{family} {seed} {case.of} {case.gradient.value:.6g}: {'; '.join(failed)}"
            print(found, flush=True)
    print(dict(tally), f"{wrong} contradictions, {time.process_time():.0f} CPU s")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
