"""Shapes to draw: stored once, with feature edges, at the poses of the parts."""

from __future__ import annotations

import numpy as np
import pytest

from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose
from kilter.rigid import quaternion_to_matrix
from kilter.scenes import SCENES, scene
from kilter.shape.primitives import surface
from kilter.show.colours import part_colours
from kilter.show.shapes import feature_edges, place_shapes, shape_mesh
from kilter.tell.palette import PALETTE

CUBE = surface(Box([1, 1, 1]))


@pytest.mark.quick(7)
@pytest.mark.parametrize("name", list(SCENES))
def test_parts_are_drawn_where_their_geometry_is(name: str) -> None:
    assembly = scene(name)
    found, geometry = place_shapes(assembly), assembly.geometry
    rotation = quaternion_to_matrix(found.rotation)
    for k in range(len(assembly.parts)):
        drawn_ = found.shapes[found.shape[k]].positions @ rotation[k].T + found.position[k]
        own = geometry.vertices[geometry.vertex_start[k] : geometry.vertex_start[k + 1]]
        near = 3e-6 * geometry.size[k]
        assert np.allclose(drawn_.min(axis=0), own.min(axis=0), atol=near)
        assert np.allclose(drawn_.max(axis=0), own.max(axis=0), atol=near)


def test_a_cube_has_twelve_edges_and_a_cylinder_two_rims() -> None:
    assert len(feature_edges(*CUBE)) == 12
    vertices, triangles = surface(Cylinder(1, 2))
    edges = feature_edges(vertices, triangles)
    assert len(edges) == len(vertices)
    height = vertices[edges][:, :, 2]
    assert (height[:, 0] == height[:, 1]).all()


def test_a_sphere_has_no_edges_until_the_crease_is_as_sharp_as_its_facets() -> None:
    from kilter import Sphere

    vertices, triangles = surface(Sphere(1))
    assert len(feature_edges(vertices, triangles)) == 0
    assert len(feature_edges(vertices, triangles, crease=0.1)) > 100


def test_an_open_border_is_an_edge() -> None:
    vertices, triangles = CUBE
    assert len(feature_edges(vertices, triangles[2:])) == 12
    assert len(feature_edges(vertices, triangles[1:])) == 13


def test_copies_that_differ_by_rounding_are_one_shape() -> None:
    vertices, triangles = CUBE
    away = vertices + np.array([1e3 / 3, 0.1, -7.7])
    parts = [Part("a", Mesh(vertices, triangles)), Part("b", Mesh(away, triangles))]
    assert len(place_shapes(Assembly(parts)).shapes) == 1
    parts.append(Part("c", Mesh(vertices * [1, 1, 1.01], triangles)))
    found = place_shapes(Assembly(parts))
    assert found.shape.tolist() == [0, 0, 1]


def test_corners_listed_once_a_face_make_the_same_edges() -> None:
    vertices, triangles = CUBE
    soup = vertices[triangles].reshape(-1, 3)
    shape, middle = shape_mesh(soup, np.arange(len(soup)).reshape(-1, 3))
    assert len(shape.edges) == 12
    assert len(shape.positions) == 8
    assert np.allclose(middle, 0)


def test_a_shape_far_from_the_origin_keeps_its_digits() -> None:
    box = Part("far", Box([1, 1, 1]), Pose([1e7, 0, 0]))
    shape = place_shapes(Assembly([box])).shapes[0]
    assert np.abs(np.abs(shape.positions) - 0.5).max() == 0


def test_few_parts_have_a_hue_each_and_held_ones_are_grey() -> None:
    colours = part_colours([0, 0, 0, 0], [True, False, False, False])
    assert len({tuple(c) for c in colours.tolist()}) == 4
    assert len(set(colours[0].tolist())) <= 3
    assert np.ptp(colours[0].astype(int)) < 20


def test_many_parts_have_a_hue_a_shape() -> None:
    count = 8 * len(PALETTE)
    colours = part_colours(np.arange(count) % 2, np.zeros(count, dtype=bool)).astype(float)
    blue = colours[::2, 2] > colours[::2, 0]
    yellow = colours[1::2, 2] < colours[1::2, 0]
    assert blue.all()
    assert yellow.all()
