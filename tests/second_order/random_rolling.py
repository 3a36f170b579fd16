"""Random chains of bodies that roll on one another in a plane, with their exact rolling.

Each body has circular or flat faces below and above and its centre of mass between them. It rolls
without slip by the same length of arc on both faces, which determines its place exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from random_linkages import second_derivatives

from kilter import Assembly, Box, Feature, GivenContact, Part, Pose
from kilter.arrays import Array

STEP = 2e-3
"""Length of a rolling over which the energy is differentiated."""


@dataclass
class Chain:
    """A chain of rolling bodies: its faces (curvatures below and above), heights and masses."""

    assembly: Assembly
    faces: list[tuple[float, float]]
    centers: list[float]
    heights: list[float]
    masses: list[float]
    ground: float

    def energy(self, arcs: Array) -> float:
        """Energy over gravity after each body has rolled by an arc on the body below."""
        turn, at, energy, over = 0.0, np.zeros(2), 0.0, self.ground
        for k, arc in enumerate(arcs):
            below, above = self.faces[k]
            place, tilt = _on_face(-over, arc)  # a convex face bends down
            mine, own = _on_face(below, arc)
            at = at + _turned(turn, place)
            turn = turn + tilt - own
            at = at - _turned(turn, mine)
            energy += self.masses[k] * (at + _turned(turn, np.array([0, self.centers[k]])))[1]
            at = at + _turned(turn, np.array([0, self.heights[k]]))
            over = above
        return float(energy)

    def curvatures(self) -> Array:
        """Eigenvalues of the second derivative of the energy by the arcs."""
        start = self.energy(np.zeros(len(self.masses)))

        def bent(u: Array) -> float:
            ends = (self.energy(sense * STEP * u) for sense in (1.0, -1.0))
            return (sum(ends) - 2 * start) / STEP**2

        return second_derivatives(bent, np.eye(len(self.masses)))


def _on_face(bend: float, arc: float) -> tuple[Array, float]:
    """Place and direction after an arc on a face that bends upward with a curvature."""
    if bend == 0.0:
        return np.array([arc, 0.0]), 0.0
    angle = bend * arc
    return np.array([np.sin(angle), 1 - np.cos(angle)]) / bend, angle


def _turned(turn: float, v: Array) -> Array:
    return np.array(
        [v[0] * np.cos(turn) - v[1] * np.sin(turn), v[0] * np.sin(turn) + v[1] * np.cos(turn)]
    )


def random_chain(seed: int) -> Chain:
    """The chain of a seed: one to four bodies on a held one."""
    random = np.random.default_rng(seed)
    count = int(random.integers(1, 5))
    ground = _face(random, -2.0, 1.0)
    over, z = ground, 0.0
    faces, centers, heights, masses = [], [], [], []
    parts = [Part("held", Box([0.1, 0.1, 0.1]), Pose([0, 0, -9]), grounded=True)]
    contacts = []
    for k in range(count):
        below = _face(random, max(0.05, 0.2 - over), 4.0)
        above = _face(random, -2.0, 1.0)
        height = float(random.uniform(0.2, 0.6))
        center = float(random.uniform(-0.3, 0.8)) * height
        faces.append((below, above))
        centers.append(center)
        heights.append(height)
        masses.append(float(random.uniform(0.5, 3.0)))
        name = f"body {k}"
        parts.append(Part(name, Box([0.1, 0.1, 0.1]), Pose([0, 0, z + center]), mass=masses[-1]))
        feature = (_feature(over), _feature(below))
        both = (parts[-2].name, name)
        contacts.append(GivenContact(both, [[0, 0, z]], [0, 0, 1], feature=feature))
        over, z = above, z + height
    assembly = Assembly(parts, contacts=contacts, friction=0.8, planar=True, detect=False)
    return Chain(assembly, faces, centers, heights, masses, ground)


def _face(random: np.random.Generator, least: float, most: float) -> float:
    """A curvature, or often 0, if it is allowed."""
    if least < 0 and random.random() < 0.3:
        return 0.0
    return float(random.uniform(least, most))


def _feature(curvature: float) -> Feature:
    return Feature("face", curvature=curvature) if curvature else Feature("face")
