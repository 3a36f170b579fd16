"""Triangles refined on exact surfaces: volumes of bodies, and of the overlap of two bodies."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import bolt, bore, cone_frustum, mesh_of, peg, socket, torus, trough

from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.assembly.polyhedra import polyhedron_moments
from kilter.assembly.refined import refine
from kilter.contact import detect

SHAPES = {
    "ball": (Sphere(1.0), 4 / 3 * np.pi),
    "cylinder": (Cylinder(1.0, 3.0), 3 * np.pi),
    "ring": (bore(), 16 * np.pi),
    "torus": (torus(), 2 * np.pi**2 * 2.0 * 0.25),
    "frustum": (cone_frustum(), np.pi / 3 * np.tan(0.4) ** 2 * 26),
    "bolt": (bolt(), np.pi * (3 + 1.5**2 * 0.5)),
    "trough": (trough(), None),
    "socket": (socket(rim=-0.3), None),
}


def volume_of(vertices, triangles):
    return float(polyhedron_moments(vertices, triangles, np.array([0, len(triangles)]))[0][0])


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_finer_triangles_close_in_on_the_exact_body_and_stay_closed(name):
    shape, exact = SHAPES[name]
    turn = Rotation.from_rotvec([0.3, -0.7, 0.4]).as_quat()[[3, 0, 1, 2]]
    geometry = Assembly([Part("other", Box([1, 1, 1])), Part("a", shape, Pose([5, 6, 7], turn))])
    geometry = geometry.geometry
    whole = np.full(3, -99.0), np.full(3, 99.0)
    volumes = []
    for rounds in range(3):
        vertices, triangles = refine(geometry, 1, rounds, whole)
        sides = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        there = {tuple(side) for side in sides.tolist()}
        assert len(there) == len(sides)
        assert {(q, p) for p, q in there} == there
        volumes.append(volume_of(vertices, triangles))
    if exact is not None:
        off = np.abs(np.array(volumes) - exact)
        assert off[2] < off[0] / 12
    else:  # each round leaves a quarter of the missing volume
        assert volumes[1] - volumes[0] == pytest.approx(4 * (volumes[2] - volumes[1]), rel=0.1)


def test_only_what_comes_within_the_box_is_cut():
    geometry = Assembly([Part("a", Cylinder(1.0, 3.0))]).geometry
    none = np.array([2.0, 0, 0]), np.array([3.0, 1, 1])
    vertices, triangles = refine(geometry, 0, 2, none)
    assert len(triangles) == len(geometry.triangles)
    some = np.array([0.9, -0.1, 1.4]), np.array([1.1, 0.1, 1.6])
    vertices, triangles = refine(geometry, 0, 2, some)
    assert len(geometry.triangles) < len(triangles) < 3 * len(geometry.triangles)
    assert np.hypot(*vertices[:, :2].T).max() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("apart", [0.5, 1.5, 1.9])
def test_lens_of_two_balls(apart):
    parts = [Part("a", Sphere(1.0), grounded=True), Part("b", Sphere(1.0), Pose([0, 0, apart]))]
    (overlap,) = detect.contacts(Assembly(parts)).overlaps
    lens = np.pi / 12 * (4 + apart) * (2 - apart) ** 2
    assert overlap.volume == pytest.approx(lens, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("depth", [0.05, 0.3])
def test_cap_of_a_ball_and_segment_of_a_cylinder_in_a_slab(depth):
    slab = Part("slab", Box([9, 9, 2]), Pose([0, 0, -1]), grounded=True)
    ball = Part("part", Sphere(1.0), Pose([0, 0, 1 - depth]))
    bar = Part("part", peg(), Pose([0, 0, 1 - depth], [np.sqrt(0.5), np.sqrt(0.5), 0, 0]))
    cap = np.pi * depth**2 * (3 - depth) / 3
    half = np.arccos(1 - depth)
    segment = (half - np.sin(half) * np.cos(half)) * 4.0
    for part, volume in ((ball, cap), (bar, segment)):
        (overlap,) = detect.contacts(Assembly([slab, part])).overlaps
        assert overlap.volume == pytest.approx(volume, rel=0.01)


def test_meshes_are_measured_as_they_are():
    mesh = mesh_of(peg(sides=12))
    geometry = Assembly([Part("a", mesh)]).geometry
    whole = np.full(3, -99.0), np.full(3, 99.0)
    finer = volume_of(*refine(geometry, 0, 2, whole))
    assert finer == pytest.approx(float(geometry.volume[0]), rel=1e-12)
