"""Features of given contacts in a program, and the rejection of wrong features."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from transformations import permuted, renamed, scaled

import kilter
from kilter import Assembly, Box, Feature, GivenContact, InputError, Part, Pose
from kilter.arrays import Array
from kilter.files import from_dict
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import turn
from kilter.scenes.transform import moved
from kilter.second_order.gaps.features import EDGE, FACE, OPEN, VERTEX, Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import formed, gap_forms

UP = [0.0, 0, 1]
CYLINDER = Feature("face", [0, 3, 0], (0, 0.5))


def assembly(*features: tuple[Feature, Feature] | None) -> Assembly:
    """A part on a held part, with a contact for each pair of features."""
    base = Part("base", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    part = Part("part", Box([1, 1, 2]), Pose([0.1, 0.2, 1]))
    given = [
        GivenContact(("base", "part"), [[0.1 * k, 0, 0], [0, 0.3, 0]], UP, feature=feature)
        for k, feature in enumerate(features)
    ]
    return Assembly([base, part], contacts=given, detect=False)


def found(given: Assembly) -> tuple[Features, Array]:
    contacts = kilter.contacts(given)
    program = build_program(given, contacts)
    features = features_of(program, contacts)
    forms = gap_forms(program, features)
    np.testing.assert_array_equal(np.isnan(forms).any(axis=(1, 2)), ~formed(program, features))
    return features, forms


def test_a_feature_is_read_to_its_rows() -> None:
    features, _ = found(
        assembly(
            (CYLINDER, Feature("edge", [1, 0, 0], 2)), None, (Feature("vertex"), Feature("face"))
        )
    )
    assert features.kind_a.tolist() == [FACE, FACE, OPEN, OPEN, VERTEX, VERTEX]
    assert features.kind_b.tolist() == [EDGE, EDGE, OPEN, OPEN, FACE, FACE]
    assert features.group.tolist() == [0, 0, 1, 1, 2, 2]
    np.testing.assert_allclose(features.curvature_a[0], np.diag([0.5, 0, 0]))
    np.testing.assert_allclose(features.curvature_b[0], np.diag([2.0, 0, 0]))
    np.testing.assert_allclose(features.edge_b[0], [1, 0, 0])
    assert features.open.tolist() == [False, False, True, True, False, False]


def test_a_sphere_needs_no_direction() -> None:
    features, _ = found(assembly((Feature("face"), Feature("face", curvature=2))))
    np.testing.assert_allclose(features.curvature_b[0], np.diag([2.0, 2, 0]))


def test_turned_and_renamed_parts_have_the_same_forms() -> None:
    pair = (CYLINDER, Feature("face", [1, 2, 0], (3, 1)))
    given = assembly(pair)
    _, forms = found(given)
    pose = Pose([3, -4, 5], turn([1, 2, 3], 50))
    _, turned = found(moved(given, pose.rotation, pose.position))
    blocks = np.kron(np.eye(4), pose.matrix)
    np.testing.assert_allclose(blocks.T @ turned @ blocks, forms, atol=1e-12)
    other = permuted(renamed(given, lambda name: name + "!"), [1, 0])
    np.testing.assert_array_equal(found(other)[1], forms)


def test_scaled_parts_have_scaled_forms() -> None:
    pair = (CYLINDER, Feature("face", [1, 2, 0], (3, 1)))
    _, forms = found(assembly(pair))
    _, large = found(scaled(assembly(pair), 10.0))
    units = np.tile(np.repeat([10.0, 1.0], 3), 2)
    np.testing.assert_allclose(large * np.outer(units, units) / 10, forms, rtol=1e-9, atol=1e-12)


def around(axis: Array, radius: float, up: float, tube: float = np.inf) -> Feature:
    """A torus above the origin, with the lowest circle of its tube at the origin."""
    other = np.cross(UP, axis)
    curvature = (1 / radius, 1 / tube if np.isfinite(tube) else 0.0)
    return Feature("face", other, curvature, [0, 0, up], axis)


def test_an_axis_turns_moves_and_scales_with_its_part() -> None:
    given = assembly((Feature("face"), around(np.array([0.0, 1, 0]), 2.0, 2.0, tube=0.3)))
    at = replace(given, contacts=[replace(given.contacts[0], points=[[0.0, 0, 0], [0, 0.5, 0]])])
    pose = Pose([3, -4, 5], turn([1, 2, 3], 50))
    for other, factor in ((moved(at, pose.rotation, pose.position), 1.0), (scaled(at, 7.0), 7.0)):
        features, _ = found(other)
        line, points = features.axis_b, other.contacts[0].points
        away = np.linalg.norm(np.cross(points - line[:, :3], line[:, 3:]), axis=1)
        np.testing.assert_allclose(away, 2.0 * factor)
        assert not features.axis_a.any()


@pytest.mark.parametrize("off", [0.0, 1e-3])
def test_a_surface_is_of_revolution_about_its_axis_or_refused(off: float) -> None:
    y = np.array([0.0, 1, 0])
    lean = np.array([0.3, 0, np.sqrt(1 - 0.09)])  # a rim whose plane leans from the normal
    rim = 2.0 * np.array([0.0, 0, 1])
    tries = [
        lambda e: around(y, 2.0, 2.0 + e, tube=0.3),  # radius
        lambda e: Feature("face", [1, 0, 0], (0.5, 3), rim, [e, 1, 0]),  # direction
        lambda e: Feature("face", curvature=2, point=[e, 0, 1], axis=UP),  # a pole
        lambda e: Feature("face", curvature=2, point=[0, 0, 1], axis=[e, 0, 1]),
        lambda e: Feature("face", [1, 0, 0], (2, 2 + e), point=[0, 0, 1], axis=UP),
        lambda e: Feature("face", point=[5, 6, 0], axis=[e, 0, 1]),  # a plane, upright
        lambda e: Feature("edge", y, lean[2] / 2 + e, 2 * lean, np.cross(lean, y)),
        lambda e: Feature("edge", [e, 1, 0], 0.5, rim, [1, 0, 0]),
    ]
    for make in tries:
        one = make(off)
        if off:
            with pytest.raises(InputError, match="not a surface of revolution about its axis"):
                at_origin(one)
        else:
            at_origin(one)


def at_origin(feature: Feature) -> GivenContact:
    return GivenContact(("base", "part"), [[0, 0, 0]], UP, feature=(Feature("face"), feature))


def test_contacts_of_other_lists_are_open() -> None:
    given = assembly((Feature("face"), Feature("vertex")))
    contacts = kilter.contacts(given)
    program = build_program(given, contacts)
    without = replace(contacts, assembly=replace(given, contacts=()))
    assert features_of(program, without).open.all()


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Feature("fase"), "did you mean 'face'"),  # type: ignore[arg-type]
        (lambda: Feature("edge"), 'give "along"'),
        (lambda: Feature("face", curvature=(1, 2)), 'give "along"'),
        (lambda: Feature("edge", [1, 0, 0], (1, 2)), "give only that along the edge"),
        (lambda: Feature("vertex", curvature=1), "remove it"),
        (lambda: Feature("face", curvature=np.nan), "finite"),
        (lambda: Feature("face", axis=UP), 'give both "point" and "axis"'),
        (lambda: Feature("vertex", point=UP, axis=UP), "remove it"),
        (lambda: Feature("face", point=UP, axis=[0, 0, 0]), "axis of a face"),
        (lambda: assembly((Feature("face"), Feature("edge", UP))), "not perpendicular to"),
        (lambda: assembly((Feature("face"),)), "pair of kilter.Feature"),  # type: ignore[arg-type]
        (lambda: assembly(("face", "face")), "pair of kilter.Feature"),  # type: ignore[arg-type]
    ],
)
def test_what_is_no_feature_is_refused(build: object, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        build()  # type: ignore[operator]
    assert "\n" not in str(caught.value)


def test_shown_in_one_line() -> None:
    given = assembly((CYLINDER, Feature("edge", [1, 0, 0], 2))).contacts[0]
    assert repr(given).endswith("face on edge)")
    assert repr(CYLINDER) == "Feature('face', along=(0, 1, 0), curvature=(0, 0.5))"


@pytest.mark.slow
def test_the_contact_of_the_page_is_a_ball_in_a_bowl() -> None:
    page = (Path(__file__).parents[2] / "docs" / "contacts.md").read_text(encoding="utf-8")
    [text] = re.findall(r"```json\n(.*?)```", page, flags=re.S)
    contact = json.loads(text)
    parts = [
        {"name": "bowl", "box": [1, 1, 1], "pose": {"position": [0, 0, -1]}, "grounded": True},
        {"name": "ball", "sphere": {"radius": 0.8}, "pose": {"position": [0, 0, 0.8]}},
    ]
    for hollow, state in ((-0.5, "minimum"), (0.5, "balanced"), (-2.0, "open")):
        contact["feature"][0]["curvature"] = hollow
        whole = {"kilter": 1, "parts": parts, "contacts": [contact], "detect": False}
        second = kilter.check(from_dict(whole, folder=".", source="page")).second_order_answer
        assert second is not None
        assert second.state == state
        if state != "open":  # the ball may spin
            assert second.free == 3
