"""Friction of pieces and changes of friction; features that are found."""

import dataclasses
import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import solids
from random_pushed import pushed_assembly

import kilter
from kilter import (
    Assembly,
    Box,
    Cylinder,
    Feature,
    FrictionPair,
    GivenContact,
    InputError,
    Mesh,
    Part,
    Pose,
    Sphere,
)
from kilter.contact.contact_tolerances import GAP
from kilter.contact.detect import detected_with_friction
from kilter.files.own.kilter_json import from_dict, to_dict
from kilter.files.robots.one_body import one_body
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import cells, moved, turn
from kilter.second_order.gaps.features import EDGE, FACE, OPEN, VERTEX, Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.shape.primitives import Shape, surface

FLOOR = Part("floor", Box(9, 9, 1), [0, 0, -0.5], grounded=True)
TOP = Box(2, 2, 0.2), Pose([0, 0, 1.1])
LEGS = [(x, y) for x in (-0.9, 0.9) for y in (-0.9, 0.9)]
WHOLE = FrictionPair(("floor", "desk"), 0.5)


def desk(*, round_feet: bool = False, **changes: Any) -> Assembly:
    """A desk whose two pairs of legs are pieces 1 and 2, with friction .1 and .3."""
    legs: list[tuple[Shape, Pose]] = [(Box(0.2, 0.2, 1), Pose([x, y, 0.5])) for x, y in LEGS]
    if round_feet:
        posts = [(Box(0.1, 0.1, 0.9), Pose([x, y, 0.55])) for x, y in LEGS]
        legs = [*((Sphere(0.1), Pose([x, y, 0.1])) for x, y in LEGS), *posts]
    pieces = [0, *([1, 1, 2, 2] * 2)[: len(legs)]]
    shape, pose = one_body([TOP, *legs], "desk", [], pieces)
    pairs = [
        FrictionPair(("floor", "desk"), 0.1, (0, 1)),
        FrictionPair(("desk", "floor"), 0.3, (2, 0)),
    ]
    values = {"friction": 0.9, "friction_pairs": pairs} | changes
    return Assembly([FLOOR, Part("desk", shape, pose)], **values)


@pytest.mark.quick(1)
@pytest.mark.parametrize("round_feet", [False, True])
def test_a_patch_has_the_friction_of_its_pieces(round_feet):
    patches = list(kilter.contacts(desk(round_feet=round_feet)))
    assert {(patch.pieces, patch.mu) for patch in patches} == {((0, 1), 0.1), ((0, 2), 0.3)}
    for patch in patches:
        assert (patch.points[:, 0] > 0).all() == (patch.mu == 0.3)


@pytest.mark.parametrize(("factor", "held"), [(0.999, True), (1.001, False)])
def test_a_verdict_counts_the_friction_of_each_piece(factor, held):
    # Down a slope t along x the rough legs bear most if they press at x = .8, and the others at -1:
    # the share (1 + t h) / 1.8 of the weight. The limit is t = .1 + .2 (1 + t h) / 1.8.
    assembly = desk()
    height = assembly.geometry.center[1, 2]
    slope = factor * (0.1 + 0.2 / 1.8) / (1 - 0.2 * height / 1.8)
    assert (kilter.check(assembly.with_down([slope, 0, -1])).verdict != "unstable") is held


def test_the_friction_of_the_whole_pair_counts_for_its_other_pieces():
    pairs = [FrictionPair(("floor", "desk"), 0.1, (0, 1)), WHOLE]
    assert sorted(kilter.contacts(desk(friction_pairs=pairs)).patch_mu) == [0.1, 0.5]
    assert sorted(kilter.contacts(desk(friction_pairs=pairs[:1])).patch_mu) == [0.1, 0.9]


def test_pieces_that_do_not_touch_have_no_patch():
    apart = GivenContact(("desk", "floor"), [], [0, 0, 1], pieces=(1, 0))
    found = kilter.contacts(desk(contacts=[apart]))
    assert found.patch_pieces.tolist() == [[0, 2]]
    assert kilter.check(desk(contacts=[apart])).verdict == "unstable"


def tripod(mu: tuple[float, float], slope: float) -> Assembly:
    """A plate on three balls; their halves, pieces 0 and 1, meet where they touch the floor."""
    feet = [(-0.8, -0.6), (0.8, -0.6), (0, 0.8)]
    shapes: list[tuple[Shape, Pose]] = [(Box(2, 2, 0.2), Pose([0, 0, 0.28]))]
    shapes += [(Sphere(0.1), Pose([x, y, 0.1])) for x, y in feet]
    shape, _ = one_body(shapes, "tripod", [])
    assert isinstance(shape, Mesh)
    middle = shape.vertices[shape.triangles].mean(axis=1)[:, None] - [(x, y, 0) for x, y in feet]
    near = np.linalg.norm(middle, axis=2).argmin(axis=1)
    half = middle[np.arange(len(near)), near, 0] > 0
    pairs = [FrictionPair(("floor", "tripod"), value, (0, k)) for k, value in enumerate(mu)]
    halves = Mesh(shape.vertices, shape.triangles, pieces=half)
    return Assembly(
        [FLOOR, Part("tripod", halves)], friction_pairs=pairs, gravity=[0, 9 * slope, -9]
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("mu", "verdict"),
    [((0.4, 0.4), "stable"), ((0.2, 0.2), "unstable"), ((0.2, 0.4), "undecided")],
)
@pytest.mark.slow
def test_a_contact_of_uncertain_pieces_is_decided_by_both(mu, verdict):
    found = kilter.contacts(tripod(mu, 0.3))
    assert found.patch_mu.tolist() == [min(mu)] * 3
    assert found.possible.mu.tolist() == ([max(mu)] * 3 if mu[0] != mu[1] else [])
    assert [patch.pieces for patch in found] == [None] * 3
    assert kilter.check(found.assembly).verdict.replace("potentially-", "") == verdict


def test_pieces_are_kept_by_files_scales_and_equality(tmp_path):
    assembly = desk()
    assert from_dict(json.loads(json.dumps(to_dict(assembly)))) == assembly
    path = tmp_path / "desk.kilter.json"
    kilter.dump(assembly, path)
    assert kilter.load(path).friction_pairs == assembly.friction_pairs
    plain = dataclasses.replace(assembly.parts[1], shape=Mesh(*surface(assembly.parts[1].shape)))
    assert plain.shape != assembly.parts[1].shape
    # a doubled face is dropped, so the triangles of the welded mesh are fewer
    shape = assembly.parts[1].shape
    assert isinstance(shape, Mesh)
    assert shape.pieces is not None
    twice = Mesh(
        shape.vertices,
        np.vstack([shape.triangles[:1], shape.triangles]),
        pieces=[shape.pieces[0], *shape.pieces],
    )
    again = desk().with_parts([])._replace(parts=[FLOOR, Part("desk", twice)])
    assert sorted(kilter.contacts(again).patch_mu) == [0.1, 0.3]


def test_the_friction_option_leaves_friction_pairs_and_says_so(tmp_path):
    kilter.dump(desk(), tmp_path / "desk.kilter.json")
    found = kilter.load(tmp_path / "desk.kilter.json", friction=0.6)
    assert "2 friction pairs keep their own coefficient" in found.notes[-1]
    assert sorted(kilter.contacts(found).patch_mu) == [0.1, 0.3]


def test_saved_choices_replace_the_friction_of_pieces(tmp_path):
    kilter.dump(desk(), tmp_path / "desk.kilter.json")
    for entry, mu in (
        ({"parts": ["floor", "desk"], "mu": 0.7}, [0.7, 0.7]),
        ({"parts": ["floor", "desk"], "mu": 0.7, "pieces": [0, 1]}, [0.3, 0.7]),
    ):
        saved = {"kilter": 1, "file": "desk.kilter.json", "friction_pairs": [entry]}
        path = tmp_path / "desk.choices.json"
        path.write_text(json.dumps(saved))
        found = sorted(kilter.contacts(kilter.load(path)).patch_mu)
        assert found == mu


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: FrictionPair(("a", "b"), 0.1, (0, -1)),
            r"pieces of a friction pair are \(0, -1\)",
        ),
        (
            lambda: GivenContact(("a", "b"), [[0, 0, 0]], [0, 0, 1], pieces=(0, 0)),
            "give pieces only",
        ),
        (lambda: Mesh(*surface(Box(1, 1, 1)), pieces=[1, 2]), "for each of the 12 triangles"),
        (
            lambda: desk(friction_pairs=[FrictionPair(("floor", "desk"), 0.1, (1, 0))]),
            "part 'floor': there is no piece 1 of it; it has 1",
        ),
        (
            lambda: desk(friction_pairs=[FrictionPair(("floor", "desk"), 0.1, (0, 1))] * 2),
            "two friction pairs name .* and the same pieces; remove a pair",
        ),
    ],
    ids=["number", "points", "mesh", "unknown", "twice"],
)
def test_pieces_that_make_no_sense_are_refused(make, words):
    with pytest.raises(InputError, match=words):
        make()


def touching(assembly):
    found = kilter.contacts(assembly)
    gap = GAP * assembly.geometry.size[found.patch_parts].min(axis=1)
    return found.patch_parts, found.patch_normal, gap


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(40))
def test_a_change_of_friction_equals_a_new_detection(seed):
    smooth = pushed_assembly(seed, touching).drawn.with_friction(0.0)
    changed = detected_with_friction(kilter.contacts(smooth), 0.3)
    # other parts have their own geometry, so that no recent search serves them
    fresh = dataclasses.replace(smooth, parts=[dataclasses.replace(part) for part in smooth.parts])
    again = kilter.contacts(fresh.with_friction(0.3))
    for one, other in ((changed, again), (changed.possible, again.possible)):
        for field in dataclasses.fields(one):
            first, second = getattr(one, field.name), getattr(other, field.name)
            if isinstance(first, np.ndarray):
                np.testing.assert_array_equal(first, second, err_msg=field.name)


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
def test_found_features_are_those_of_a_hand(pair):
    _, assembly, a, b = pair
    features, has, forms = found(assembly)
    assert len(features)
    assert has.all()
    np.testing.assert_allclose(forms, by_hand(assembly, a, b), atol=1e-9)


@pytest.mark.quick(2)
@pytest.mark.parametrize("pair", PAIRS, ids=[pair[0] for pair in PAIRS])
def test_turned_parts_have_the_same_features(pair):
    assembly = pair[1]
    features, has, forms = found(assembly)
    pose = Pose([3, -4, 5], turn([1, 2, 3], 50))
    turned, also, other = found(moved(assembly, pose.rotation, pose.position))
    assert turned.kind_a.tolist() == features.kind_a.tolist()
    assert turned.kind_b.tolist() == features.kind_b.tolist()
    assert also.tolist() == has.tolist()
    blocks = np.kron(np.eye(4), pose.matrix)
    np.testing.assert_allclose(blocks.T @ other @ blocks, forms, atol=1e-9)


def test_corners_of_a_flat_patch_are_corners_and_crossings():
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
def test_faces_that_end_together_are_conformal():
    same = held(Box([1, 1, 1]), [0, 0, -0.5])
    for assembly in (
        on(same, Box([1, 1, 1]), [0, 0, 0.5]),
        on(TABLE, Cylinder(0.5, 1), [0, 0, 0.5]),
        on(held(solids.socket(0.5, 2.0, 2.0), [0, 0, 0]), Sphere(0.5), [0, 0, 0]),
    ):
        features, has, _ = found(assembly)
        assert has.all()
        assert features.conformal.all()


def test_a_line_that_ends_on_both_parts_keeps_its_points():
    """Yaw of a cylinder on one of its length: (psi s)^2 / (R + r)."""
    log = held(Cylinder(1.3, 2), [0, 0, -1.3], LYING)
    features, has, forms = found(on(log, Cylinder(0.7, 2), [0, 0, 0.7], LYING))
    assert has.all()
    np.testing.assert_allclose(np.abs(features.fibre), [Y, Y], atol=1e-12)
    np.testing.assert_allclose(forms[:, 11, 11], 1 / 2.0, atol=1e-9)


def test_what_is_not_known_exactly_is_open():
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
