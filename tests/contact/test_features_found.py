"""Features at detected contacts, compared with features given by hand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import solids

import kilter
from kilter import Assembly, Box, Cylinder, Feature, GivenContact, Mesh, Part, Pose, Sphere
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import cells, turn
from kilter.scenes.transform import moved
from kilter.second_order.gaps.features import EDGE, FACE, OPEN, VERTEX, Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.shape.primitives import surface

X, Y, Z = np.eye(3)
TABLE = Part("a", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
PLANE = Feature("face")
LYING = turn(X, 90)


def found(assembly: Assembly) -> tuple[Features, np.ndarray, np.ndarray]:
    """Features, whether they have a form, and their forms."""
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    features = features_of(program, contacts)
    return features, formed(program, features), gap_forms(program, features)


def by_hand(assembly: Assembly, a: Feature, b: Feature) -> np.ndarray:
    """Forms of the same points and normals, with given features."""
    contacts = kilter.contacts(assembly)
    given = [
        GivenContact(("a", "b"), [point], normal, feature=(a, b))
        for point, normal in zip(contacts.points, contacts.normals, strict=True)
    ]
    assert (contacts.patch_parts == [0, 1]).all()
    _, has, forms = found(replace(assembly, contacts=given, detect=False))
    assert has.all()
    return forms


def on(a: Part, shape: object, at: object, rotation: object = (1, 0, 0, 0)) -> Assembly:
    return Assembly([a, Part("b", shape, Pose(at, rotation))])  # type: ignore[arg-type]


def held(shape: object, at: object, rotation: object = (1, 0, 0, 0)) -> Part:
    return Part("a", shape, Pose(at, rotation), grounded=True)  # type: ignore[arg-type]


def pairs() -> Iterator[tuple[str, Assembly, Feature, Feature]]:
    """Pairs that touch, with the features of a and of b."""
    small, ball = Feature("face", curvature=2), Sphere(0.5)
    yield "ball on a table", on(TABLE, ball, [0, 0, 0.5]), PLANE, small
    top = held(Sphere(1.0), [0, 0, -1])
    yield "ball on a ball", on(top, ball, [0, 0, 0.5]), Feature("face", curvature=1), small
    log = held(Cylinder(1.0, 4), [0, 0, -1], LYING)
    over = Feature("face", Y, (0, 1))
    yield "ball on a cylinder", on(log, ball, [0, 0, 0.5]), over, small
    across = on(log, Cylinder(0.5, 3), [0, 0, 0.5], turn(Y, 90))
    yield "crossed cylinders", across, over, Feature("face", X, (0, 2))
    lying = on(TABLE, Cylinder(0.5, 2), [0, 0, 0.5], LYING)
    yield "cylinder on a table", lying, PLANE, Feature("edge", X, 2)
    board = on(log, Box([1, 2, 0.2]), [0, 0, 0.1])
    yield "board on a cylinder", board, over, Feature("edge", X)
    end = np.array([np.cos(0.6), 0, np.sin(0.6)])  # the axis leans by this from the table
    corner = np.array([0.5 * np.sin(0.6), 0, -0.5 * np.cos(0.6)])
    tilted = on(TABLE, Cylinder(0.5, 2), end - corner, turn(Y, 90 - np.degrees(0.6)))
    yield "tilted cylinder on a table", tilted, PLANE, Feature("edge", Y, np.cos(0.6) / 0.5)
    bowl = held(solids.socket(1.3, 2.0, 2.0, 0.9), [0, 0, 0])
    inside = on(bowl, ball, [0, 0, -0.8])
    yield "ball in a bowl", inside, Feature("face", curvature=-1 / 1.3), small
    pipe = held(solids.bore(1.3, 3.0, -2, 2), [0, 0, 0], LYING)
    yield "ball in a pipe", on(pipe, ball, [0, 0, -0.8]), Feature("face", Y, (0, -1 / 1.3)), small
    tyre = held(solids.torus(2.0, 0.5), [0, 0, -2.5], LYING)
    hoop = Feature("face", X, (1 / 2.5, 2.0))
    yield "ball on a standing torus", on(tyre, ball, [0, 0, 0.5]), hoop, small


PAIRS = list(pairs())


@pytest.mark.quick(2)
@pytest.mark.parametrize("pair", PAIRS, ids=[pair[0] for pair in PAIRS])
def test_found_features_are_those_of_a_hand(
    pair: tuple[str, Assembly, Feature, Feature],
) -> None:
    _, assembly, a, b = pair
    features, has, forms = found(assembly)
    assert len(features)
    assert has.all()
    np.testing.assert_allclose(forms, by_hand(assembly, a, b), atol=1e-9)


@pytest.mark.quick(2)
@pytest.mark.parametrize("pair", PAIRS, ids=[pair[0] for pair in PAIRS])
def test_turned_parts_have_the_same_features(
    pair: tuple[str, Assembly, Feature, Feature],
) -> None:
    assembly = pair[1]
    features, has, forms = found(assembly)
    pose = Pose([3, -4, 5], turn([1, 2, 3], 50))
    turned, also, other = found(moved(assembly, pose.rotation, pose.position))
    assert turned.kind_a.tolist() == features.kind_a.tolist()
    assert turned.kind_b.tolist() == features.kind_b.tolist()
    assert also.tolist() == has.tolist()
    blocks = np.kron(np.eye(4), pose.matrix)
    np.testing.assert_allclose(blocks.T @ other @ blocks, forms, atol=1e-9)


def test_corners_of_a_flat_patch_are_corners_and_crossings() -> None:
    """Corners of b lie on the face; edges cross at the overhang of b."""
    features, has, _ = found(on(TABLE, Box([1, 1, 1]), [1.8, 0, 0.5]))
    assert has.all()
    assert sorted(zip(features.kind_a.tolist(), features.kind_b.tolist(), strict=True)) == [
        (EDGE, EDGE), (EDGE, EDGE), (FACE, VERTEX), (FACE, VERTEX),
    ]  # fmt: skip
    assert not features.conformal.any()
    hanging = features.kind_a == EDGE
    np.testing.assert_allclose(np.abs(features.edge_a[hanging]), [Y, Y], atol=1e-12)
    np.testing.assert_allclose(np.abs(features.edge_b[hanging]), [X, X], atol=1e-12)
    small = held(Box([0.5, 0.5, 1]), [0, 0, -0.5])
    features, has, _ = found(on(small, Box([1, 1, 1]), [0, 0, 0.5]))
    assert features.kind_a.tolist() == [VERTEX] * 4
    assert features.kind_b.tolist() == [FACE] * 4


@pytest.mark.slow
def test_faces_that_end_together_are_conformal() -> None:
    same = held(Box([1, 1, 1]), [0, 0, -0.5])
    for assembly in (
        on(same, Box([1, 1, 1]), [0, 0, 0.5]),
        on(TABLE, Cylinder(0.5, 1), [0, 0, 0.5]),
        on(held(solids.socket(0.5, 2.0, 2.0), [0, 0, 0]), Sphere(0.5), [0, 0, 0]),
    ):
        features, has, _ = found(assembly)
        assert has.all()
        assert features.conformal.all()


def test_a_line_that_ends_on_both_parts_keeps_its_points() -> None:
    """Yaw of a cylinder on one of its length: (psi s)^2 / (R + r)."""
    log = held(Cylinder(1.3, 2), [0, 0, -1.3], LYING)
    features, has, forms = found(on(log, Cylinder(0.7, 2), [0, 0, 0.7], LYING))
    assert has.all()
    np.testing.assert_allclose(np.abs(features.fibre), [Y, Y], atol=1e-12)
    np.testing.assert_allclose(forms[:, 11, 11], 1 / 2.0, atol=1e-9)


def test_what_is_not_known_exactly_is_open() -> None:
    """A ball of triangles on a table; a corner in a notch; a closed clearance."""
    mesh = Mesh(*surface(Sphere(0.5)))
    low = -mesh.vertices[:, 2].min()
    features, has, _ = found(on(TABLE, mesh, [0, 0, low]))
    assert not has.any()
    notch = held(cells([-1, 0, 1], [-1, 1], [-1, 0, 1], [[[1, 1]], [[1, 0]]]), [0, 0, 0])
    features, _, _ = found(on(notch, Box([0.5, 0.5, 0.5]), [0.25, 0, 0.25]))
    assert OPEN not in features.kind_a  # faces that end at the notch: corners of b on them
    raised = on(TABLE, Box([1, 1, 1]), [0, 0, 0.51])
    contacts = kilter.contacts(raised, tolerance=kilter.Tolerance(clearance=0.02))
    program = build_program(raised, contacts)
    assert len(program.part_a) == 4
    assert features_of(program, contacts).open.all()
