"""Programs and disturbances that the tests of margins share."""

from __future__ import annotations

import dataclasses
from itertools import combinations

import numpy as np

from kilter.assembly import Assembly, GivenContact
from kilter.contact import detect
from kilter.mechanics.program import Program, build_program


def program_of(assembly: Assembly) -> Program:
    return build_program(assembly, detect.contacts(assembly))


def leaning(assembly: Assembly, along, degrees: float) -> Assembly:
    """Gravity turned from where it is toward a direction across it."""
    angle = np.radians(degrees)
    return assembly.with_down(np.cos(angle) * assembly.down + np.sin(angle) * np.asarray(along))


def by_points(assembly: Assembly) -> Assembly:
    """Round parts of radius 1 on a floor z = 0: one given point where two of them touch."""
    center = {part.name: np.array(part.pose.position) for part in assembly.parts[1:]}
    floor = assembly.names[0]
    given = [
        GivenContact((floor, name), [[x[0], x[1], 0.0]], [0, 0, 1])
        for name, x in center.items()
        if abs(x[2] - 1) < 1e-9
    ]
    for a, b in combinations(center, 2):
        half = (center[b] - center[a]) / 2
        if abs(np.linalg.norm(half) - 1) < 1e-9:
            given.append(GivenContact((a, b), [center[a] + half], half))
    return dataclasses.replace(assembly, contacts=given, friction_pairs=[], detect=False)


def small_assembly(seed: int) -> Assembly:
    """A few boxes that stand on one another, somewhat loose, with one coefficient of friction."""
    from kilter.scenes.pieces import block, floor

    random = np.random.default_rng(seed)
    parts, top, middle = [floor([-9, -9], [9, 9])], 0.0, np.zeros(2)
    for k in range(int(random.integers(1, 5))):
        half = random.uniform(0.5, 1.0, size=2)
        middle = middle + random.uniform(-0.2, 0.2, size=2)
        height = float(random.uniform(0.3, 1.0))
        low, high = [*(middle - half), top], [*(middle + half), top + height]
        parts.append(block(f"box-{k}", low, high, density=float(random.uniform(500, 2000))))
        top += height
    return Assembly(parts, friction=float(random.uniform(0.1, 1.0)))
