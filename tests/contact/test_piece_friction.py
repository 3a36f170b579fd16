"""Parts whose pieces have friction of their own: patches, verdicts, files and choices."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, FrictionPair, GivenContact, InputError, Mesh, Part, Pose, Sphere
from kilter.files.kilter_json import from_dict, to_dict
from kilter.files.one_body import one_body
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
def test_a_patch_has_the_friction_of_its_pieces(round_feet: bool) -> None:
    patches = list(kilter.contacts(desk(round_feet=round_feet)))
    assert {(patch.pieces, patch.mu) for patch in patches} == {((0, 1), 0.1), ((0, 2), 0.3)}
    for patch in patches:
        assert (patch.points[:, 0] > 0).all() == (patch.mu == 0.3)


@pytest.mark.parametrize(("factor", "held"), [(0.999, True), (1.001, False)])
def test_a_verdict_counts_the_friction_of_each_piece(factor: float, held: bool) -> None:
    # Down a slope t along x the rough legs bear most if they press at x = .8, and the others at -1:
    # the share (1 + t h) / 1.8 of the weight. The limit is t = .1 + .2 (1 + t h) / 1.8.
    assembly = desk()
    height = assembly.geometry.center[1, 2]
    slope = factor * (0.1 + 0.2 / 1.8) / (1 - 0.2 * height / 1.8)
    assert (kilter.check(assembly.with_down([slope, 0, -1])).verdict != "unstable") is held


def test_the_friction_of_the_whole_pair_counts_for_its_other_pieces() -> None:
    pairs = [FrictionPair(("floor", "desk"), 0.1, (0, 1)), WHOLE]
    assert sorted(kilter.contacts(desk(friction_pairs=pairs)).patch_mu) == [0.1, 0.5]
    assert sorted(kilter.contacts(desk(friction_pairs=pairs[:1])).patch_mu) == [0.1, 0.9]


def test_pieces_that_do_not_touch_have_no_patch() -> None:
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
def test_a_contact_of_uncertain_pieces_is_decided_by_both(
    mu: tuple[float, float], verdict: str
) -> None:
    found = kilter.contacts(tripod(mu, 0.3))
    assert found.patch_mu.tolist() == [min(mu)] * 3
    assert found.possible.mu.tolist() == ([max(mu)] * 3 if mu[0] != mu[1] else [])
    assert [patch.pieces for patch in found] == [None] * 3
    assert kilter.check(found.assembly).verdict.replace("potentially-", "") == verdict


def test_pieces_are_kept_by_files_scales_and_equality(tmp_path: Path) -> None:
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


def test_the_friction_option_leaves_friction_pairs_and_says_so(tmp_path: Path) -> None:
    kilter.dump(desk(), tmp_path / "desk.kilter.json")
    found = kilter.load(tmp_path / "desk.kilter.json", friction=0.6)
    assert "2 friction pairs keep their own coefficient" in found.notes[-1]
    assert sorted(kilter.contacts(found).patch_mu) == [0.1, 0.3]


def test_saved_choices_replace_the_friction_of_pieces(tmp_path: Path) -> None:
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
def test_pieces_that_make_no_sense_are_refused(make: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()
