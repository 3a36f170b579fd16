"""Random bodies on round feet in equilibrium, with the exact gaps of their contacts.

A body stands on one to three balls or corners, which touch planes, balls, bowls, cylinders, troughs
and rings. All normals meet the z axis, so there are forces of equilibrium, with the centre of mass
at a height without torque. It may carry a ball on a face, in a bowl, on a ball or in a trough.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import exact_gaps as exact
import numpy as np
from scipy.optimize import nnls

from kilter import Assembly, Box, Feature, GivenContact, Part, Pose, Sphere
from kilter.arrays import Array, across

Random = np.random.Generator
ANY = ("plane", "ball", "bowl", "cylinder", "trough", "ring")
HOLLOW = ("bowl", "bowl", "trough")
"""Hollow surfaces; an assembly has any surfaces, or hollow surfaces only."""
LEAST_FORCE = 0.05
"""Least force of a contact, over the weight [-]; with less the energy well is too flat."""
GROUND = exact.Pose(np.zeros(3), np.zeros(3), np.eye(3))


@dataclass
class Round:
    """An assembly with its gaps by part (-1: held) and the spins of balls about their centres."""

    assembly: Assembly
    gaps: list[tuple[int, int, exact.Gap]]
    centers: list[Array]
    masses: list[float]
    spins: list[Array] = field(default_factory=list)

    def open(self, z: Array) -> Array:
        """All gaps after the motion z, shape (6 n,) for n free parts."""
        poses = [exact.pose(c, z[6 * k : 6 * k + 6]) for k, c in enumerate(self.centers)]
        poses.append(GROUND)
        return np.array([gap(poses[a], poses[b]) for a, b, gap in self.gaps])

    def weights(self) -> Array:
        """The energy over gravity is this vector times z."""
        up = np.zeros(6 * len(self.masses))
        up[2::6] = self.masses
        return up


def _surface(
    random: Random, kinds: tuple[str, ...], x: Array, n: Array, r: float
) -> tuple[Feature, Feature, exact.Gap]:
    """A surface at x with normal n, a ball of radius r on it (0: a corner), and their gap."""
    foot = Feature("face", curvature=1 / r) if r else Feature("vertex")
    above, size = x + r * n, float(random.uniform(0.6, 3.0)) + r
    turn, (u, v) = float(random.uniform(0, np.pi)), across(n)
    along = np.cos(turn) * u + np.sin(turn) * v
    kind = random.choice(kinds)
    if kind == "plane":
        return Feature("face"), foot, exact.sphere_plane(above, r, x, n)
    if kind in ("ball", "bowl"):
        size = size if kind == "ball" else -size
        face = Feature("face", curvature=1 / size)
        return face, foot, exact.spheres(x - size * n, size, above, r)
    if kind in ("cylinder", "trough"):
        size = size if kind == "cylinder" else -size
        face = Feature("face", along, (0.0, 1 / size))
        return face, foot, exact.sphere_cylinder(above, r, x - size * n, along, size)
    tube = float(random.uniform(0.2, 0.6))
    axis = np.cross(n, along)  # of the ring; its highest point is at x
    face = Feature("face", along, (1 / (size + tube), 1 / tube))
    gap = exact.sphere_torus(above, r, x - (size + tube) * n, axis, size, tube)
    return face, foot, gap


def random_round(seed: int) -> Round:
    """The assembly of a seed."""
    random = np.random.default_rng(seed)
    while True:
        made = _attempt(random)
        if made is not None:
            return made


def _attempt(random: Random) -> Round | None:
    count, kinds = int(random.integers(1, 4)), ANY if random.uniform() < 0.4 else HOLLOW
    angle = 2 * np.pi * (np.arange(count) + 0.3 * random.uniform(-1, 1, count)) / count
    lean = random.uniform(0.1, 0.9, count)
    if count == 1:
        lean[:] = 0.0
    if count == 2:
        angle[1] = angle[0] + np.pi
    away = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
    points = away * random.uniform(0.5, 1.5, count)[:, None]
    points[:, 2] = random.uniform(-0.3, 0.3, count)
    if count == 1:
        points[:] = 0.0
    normals = np.cos(lean)[:, None] * np.array([0, 0, 1.0]) - np.sin(lean)[:, None] * away
    forces, off = nnls(normals.T, np.array([0, 0, 1.0]))
    if off > 1e-12 or forces.min() < LEAST_FORCE:
        return None
    moment = (forces[:, None] * np.cross(points, normals)).sum(axis=0)
    center = np.array([-moment[1], moment[0], random.uniform(-2.0, 0.6)])
    gaps, given, contacts = [], [], []
    for x, n in zip(points, normals, strict=True):
        r = float(random.choice([0.0, 0.2, 0.5]))
        on, foot, gap = _surface(random, kinds, x, n, r)
        contacts.append(GivenContact(("base", "body"), [x], n, feature=(on, foot)))
        gaps.append((-1, 0, gap))
    base = Part("base", Box([1, 1, 1]), Pose([0, 0, -5]), grounded=True)
    given = [base, Part("body", Box([1, 1, 1]), Pose(center), mass=1.0)]
    made = Round(Assembly([base]), gaps, [center], [1.0])
    if random.uniform() < 0.3:
        top, n = center + np.array([0, 0, random.uniform(0.2, 1.0)]), np.array([0, 0, 1.0])
        on, foot, gap = _surface(random, kinds, top, n, 0.3)
        contacts.append(GivenContact(("body", "ball"), [top], n, feature=(on, foot)))
        gaps.append((0, 1, gap))
        mass = float(random.uniform(0.1, 0.5))
        given.append(Part("ball", Sphere(0.3), Pose(top + 0.3 * n), mass=mass))
        made.centers.append(top + 0.3 * n)
        made.masses.append(mass)
        made.spins = list(np.eye(12)[9:])
    if count == 1:  # one contact below the centre of mass: a turn about the vertical
        turn = np.zeros(6 * len(made.masses))
        turn[5::6] = 1.0
        made.spins.append(turn)
    made.assembly = Assembly(given, contacts=contacts, detect=False)
    return made
