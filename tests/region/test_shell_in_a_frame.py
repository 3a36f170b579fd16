"""A frictionless shell of 40 wedge-shaped blocks in a frame: tilt limits three ways."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

import kilter
from kilter.analysis.margins.tilt import find_tilt_margin, tilt_about
from kilter.arrays import cross
from kilter.assembly import Assembly, Part
from kilter.mechanics.program import Program, build_program
from kilter.shape.primitives import Mesh

FACES = np.array([[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6], [0, 5, 1], [0, 4, 5],
                  [1, 6, 2], [1, 5, 6], [2, 7, 3], [2, 6, 7], [3, 4, 0], [3, 7, 4]])  # fmt: skip
AZIMUTHS = np.radians([0, 45, 90, 135, 180, 225, 270, 315])


def wedge(name: str, low, high, **options) -> Part:
    """The part of a pyramid with its tip in the origin over a rectangle of z = 1, z 1 to 1.2."""
    (x, y), (u, v) = low, high
    base = np.array([[x, y, 1.0], [x, v, 1.0], [u, v, 1.0], [u, y, 1.0]])
    return Part(name, Mesh(np.concatenate([base, 1.2 * base]), FACES), **options)


def shell(rows: int = 8, each: int = 5, seed: int = 2) -> Assembly:
    """Rows of wedges whose joints never line up, between four held ones."""
    random = np.random.default_rng(seed)
    ys = np.linspace(-0.2, 0.2, rows + 1)
    ys[1:-1] += random.uniform(-0.008, 0.008, rows - 1)
    parts = []
    for row in range(rows):
        xs = np.linspace(-0.25, 0.25, each + 1)
        xs[1:-1] += random.uniform(-0.03, 0.03, each - 1)
        parts += [
            wedge(f"w{row}-{k}", (xs[k], ys[row]), (xs[k + 1], ys[row + 1])) for k in range(each)
        ]
    frame = {
        "north": ((-0.35, 0.2), (0.35, 0.3)),
        "south": ((-0.35, -0.3), (0.35, -0.2)),
        "west": ((-0.35, -0.2), (-0.25, 0.2)),
        "east": ((0.25, -0.2), (0.35, 0.2)),
    }
    parts += [wedge(name, *corners, grounded=True) for name, corners in frame.items()]
    return Assembly(parts)


def held(program: Program, down) -> bool:
    """Whether some f >= 0 has J^T f + w = 0: written apart, from J alone."""
    jacobian = program.jacobian().toarray()
    weight = np.zeros((len(program.names), 6))
    weight[:, :3] = program.mass[:, None] * np.asarray(down)
    load = weight[program.free].reshape(-1) / program.mass.max()
    answer = linprog(
        np.zeros(len(jacobian)), A_eq=jacobian.T, b_eq=-load, bounds=(0, None), method="highs-ds"
    )
    return answer.status == 0


def by_bisection(program: Program, aside) -> float:
    """Largest tilt of gravity toward `aside` that is held [deg]."""
    low, high = 0.0, 89.0
    while high - low > 2e-5:
        middle = (low + high) / 2
        angle = np.radians(middle)
        down = np.cos(angle) * program.down + np.sin(angle) * aside
        low, high = (middle, high) if held(program, down) else (low, middle)
    return (low + high) / 2


@pytest.fixture(scope="module")
def found():
    assembly = shell()
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return assembly, program, kilter.region(assembly, contacts=contacts)


@pytest.mark.slow
def test_tilt_limits_at_eight_azimuths_agree(found) -> None:
    _, program, region = found
    assert int(program.free.sum()) == 40
    assert region.kind == "cone"
    assert region.proved
    for azimuth in AZIMUTHS:
        aside = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        tilt = tilt_about(program, cross(program.down, aside))
        expected = by_bisection(program, aside)
        assert tilt.tilt_deg == pytest.approx(expected, abs=1e-4)
        assert tilt.limit.gap < 2e-5
        # q.(cos t down + sin t aside) = 0 at the facet that is met first
        with np.errstate(divide="ignore"):
            turns = np.arctan2(region.facets @ program.down, -(region.facets @ aside))
        assert np.degrees(turns[turns > 0].min()) == pytest.approx(expected, abs=1e-4)


@pytest.mark.slow
def test_the_nearest_is_the_margin(found) -> None:
    _, program, region = found
    tilt = find_tilt_margin(program)
    nearest = np.degrees(np.arcsin((region.facets @ program.down).min()))
    assert np.degrees(tilt.angle) == pytest.approx(nearest, abs=1e-6)
    assert np.degrees(tilt.lower) == pytest.approx(nearest, abs=1e-6)
