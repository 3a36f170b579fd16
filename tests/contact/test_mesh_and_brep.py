"""A mesh and the exact solid of the same object: the same verdict, the same stable cone."""

from __future__ import annotations

import numpy as np
import pytest
from solids import ball, bolt, bore, cone_frustum, cone_socket, mesh_of, peg, socket, trough

import kilter
from kilter import check
from kilter.assembly import Assembly, Part
from kilter.contact import detect
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from sampled import sampled

LYING = [np.sqrt(0.5), np.sqrt(0.5), 0, 0]
"""Turns z to -y: a peg that lies along y."""
FLOOR = (Box([20, 20, 1]), Pose([0, 0, -0.5]))

SHAPES = {
    "peg in a hole": lambda n: ((bore(sides=n), Pose()), (peg(sides=n), Pose())),
    "peg on a floor": lambda n: (FLOOR, (peg(sides=n), Pose([0, 0, 2]))),
    "peg lying on a floor": lambda n: (FLOOR, (peg(sides=n), Pose([0, 0, 1], LYING))),
    "ring on a floor": lambda n: (FLOOR, (bore(sides=n), Pose([0, 0, 1]))),
    "bolt hung in a hole": lambda n: (
        (bore(low=-2.0, high=0.0, sides=n), Pose()),
        (bolt(sides=n), Pose()),
    ),
    "bolt in a loose hole": lambda n: (
        (bore(radius=1.2, low=-2.0, high=0.0, sides=n), Pose()),
        (bolt(sides=n), Pose()),
    ),
    "ball on a floor": lambda n: (FLOOR, (ball(sides=n), Pose([0, 0, 1]))),
    "ball in a socket": lambda n: ((socket(sides=n), Pose()), (ball(sides=n), Pose())),
    "cone in a cone": lambda n: ((cone_socket(sides=n), Pose()), (cone_frustum(sides=n), Pose())),
    "peg in a trough": lambda n: ((trough(), Pose()), (peg(sides=n), Pose([0, 0, 0], LYING))),
    "frustum on a floor": lambda n: (FLOOR, (cone_frustum(sides=n), Pose([0, 0, -1.0]))),
}
"""Held and free part of each, of a given number of sides."""

DOWNS = [[0, 0, -1], [0, 0, 1], [1, 0, -1], [0, 1, -0.2], [0.3, -0.2, -1], [1, 0.5, 0]]
BOUND_DEG = 0.5
"""Hulls of discs keep the corners of the tessellation: a margin differs by its sagitta."""


def assembly_of(name, *, sides, exact):
    """The pair as exact solids, or as the meshes of those with other sides."""
    parts = []
    for k, (shape, pose) in enumerate(SHAPES[name](sides)):
        own = shape if exact or isinstance(shape, Box) else mesh_of(shape)
        parts.append(Part(f"part-{k}", own, pose, grounded=k == 0, density=1000.0))
    return Assembly(parts)


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(4, SHAPES))
@pytest.mark.parametrize("cuts", sampled(1, [[48], [72]]))
def test_same_verdict_in_every_direction(name, cuts):
    exact = assembly_of(name, sides=48, exact=True)
    meshes = [assembly_of(name, sides=n, exact=False) for n in cuts]
    kinds = set(detect.contacts(exact).patch_kind.tolist())
    assert kinds  # they touch
    assert all(set(detect.contacts(mesh).patch_kind.tolist()) == kinds for mesh in meshes)
    for down in DOWNS:
        word = check(exact.with_down(down)).verdict
        for mesh in meshes:
            assert check(mesh.with_down(down)).verdict == word, down


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_same_stable_cone(name):
    exact = kilter.region(assembly_of(name, sides=48, exact=True))
    mesh = kilter.region(assembly_of(name, sides=72, exact=False))
    assert mesh.kind == exact.kind
    if exact.half_angle_deg is not None:
        assert mesh.half_angle_deg == pytest.approx(exact.half_angle_deg, abs=BOUND_DEG)
    if exact.center is not None:
        assert np.allclose(mesh.center, exact.center, atol=np.radians(BOUND_DEG))
