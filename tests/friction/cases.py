"""Programs with known answers, from scenes: near their limits, in the plane and in space."""

import dataclasses

import numpy as np

from kilter.assembly import Assembly, GivenContact, Part
from kilter.contact import detect
from kilter.mechanics.program import build_program
from kilter.scenes import stacks
from kilter.scenes import traps as rounds
from kilter.scenes.pieces import block
from kilter.shape.primitives import Box


def program(assembly):
    return build_program(assembly, detect.contacts(assembly))


def planar(assembly):
    return dataclasses.replace(assembly, planar=True)


def slope(share, mu, height):
    """Case S1 at a fraction of its limit, tan = min(mu, width / height)."""
    angle = float(np.degrees(np.arctan(share * min(mu, 1.0 / height))))
    return stacks.block_on_incline(angle=angle, friction=mu, height=height)


def _with_points(assembly):
    """Round parts of radius 1, with a given contact point between each touching pair."""
    centers = [np.array(part.pose.position) for part in assembly.parts]
    friction = {tuple(sorted(pair.parts)): pair.mu for pair in assembly.friction_pairs}
    names, found = assembly.names, []
    for i in range(1, len(names)):
        x, _, z = centers[i]
        if abs(z - 1) < 1e-9:
            foot = [x, centers[i][1], 0.0]
            found.append(
                GivenContact((names[0], names[i]), [foot], [0, 0, 1], mu=assembly.friction)
            )
        for j in range(i + 1, len(names)):
            half = (centers[j] - centers[i]) / 2
            if abs(np.linalg.norm(half) - 1) < 1e-9:
                mu = friction[tuple(sorted((names[i], names[j])))]
                at = centers[i] + half
                found.append(GivenContact((names[i], names[j]), [at], half, mu=mu))
    return dataclasses.replace(assembly, contacts=found, detect=False)


def cylinders(share):
    """Case R1 in the plane, both coefficients 1 / share of their limits."""
    between = (2 - np.sqrt(3)) / share
    return planar(
        _with_points(rounds.three_cylinders(friction_between=between, friction_ground=between / 3))
    )


def spheres(share):
    """Case R2, both coefficients 1 / share of their limits."""
    between = (np.sqrt(3) - np.sqrt(2)) / share
    return _with_points(rounds.four_spheres(friction_between=between, friction_ground=between / 4))


def random_block(rng: np.random.Generator, points: int) -> Assembly:
    """A block in the plane against a held part, at points with random normals."""
    at = rng.uniform(-1, 1, (points, 2))
    angle = rng.uniform(0, 2 * np.pi, points)
    contacts = [
        GivenContact(
            ("held", "block"), [[x, 0.0, z]], [np.cos(a), 0.0, np.sin(a)],
            mu=float(rng.uniform(0.2, 1.2)),
        )
        for (x, z), a in zip(at, angle, strict=True)
    ]  # fmt: skip
    held = block("held", [-1, -1, -9], [1, 1, -8], grounded=True)
    return Assembly([held, Part("block", Box([2, 1, 2]))], contacts=contacts, planar=True,
                    detect=False)  # fmt: skip
