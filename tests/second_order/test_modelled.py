"""Which contacts second order knows: rims of flat faces, and nothing that is left open."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.mechanics.proof import digest_of
from kilter.second_order.modelled import why_unmodelled

TABLE = Part("table", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
CAN = Part("can", Cylinder(0.5, 1.0), Pose([0, 0, 0.5]))


@pytest.mark.parametrize(
    ("more", "neutral"),
    [
        ([], 3),
        ([Part("plate", Box([3, 3, 0.2]), Pose([0.2, 0, 1.1]))], 6),
        ([Part("can on can", Cylinder(0.3, 1.0), Pose([0.1, 0, 1.5]))], 6),
        ([Part("ball", Sphere(0.5), Pose([0.2, 0, 1.5]))], 8),
    ],
)
def test_what_stands_on_a_round_face_is_free(more: list[Part], neutral: int) -> None:
    assembly = Assembly([TABLE, CAN, *more])
    assert len(kilter.contacts(assembly).possible)  # corners around the rim
    found = kilter.check(assembly)
    second = found.second_order
    assert second is not None
    assert (second.state, second.neutral, second.free) == ("free", neutral, neutral)
    assert kilter.verify(assembly, found.proof()).holds


def test_a_ball_on_a_can_on_a_ball_is_balanced() -> None:
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5]))
    can = Part("can", Cylinder(0.5, 1.0), Pose([0, 0, 1.5]))
    found = kilter.check(Assembly([TABLE, ball, can]))
    assert found.second_order is not None
    assert found.second_order.state == "balanced"


def test_of_pairs_that_are_left_open_nothing_is_said_or_proved() -> None:
    assembly = Assembly([TABLE, CAN])
    proof = kilter.check(assembly).proof()
    near = Part("near", Box([1, 1, 1]), Pose([1.0 + 2e-4, 0, 0.5]), grounded=True)
    more = Assembly([TABLE, CAN, near])
    contacts = kilter.contacts(more)
    assert contacts.open_pairs
    assert "left open" in why_unmodelled(more, contacts)
    found = kilter.check(more)
    assert found.second_order is not None
    assert found.second_order.state == "open"
    own = copy.deepcopy(found.proof())
    own["second_order"] = proof["second_order"]
    own["digest"] = digest_of(own)
    refused = kilter.verify(more, own)
    assert not refused.holds
    assert any("left open" in reason for reason in refused.reasons)


def test_what_is_possible_out_of_the_plane_of_a_face_is_not_its_rim() -> None:
    ball = Part("ball", Sphere(0.5), Pose([3, 0, 0.5]))
    contacts = kilter.contacts(Assembly([TABLE, CAN, ball]))
    assert why_unmodelled(contacts.assembly, contacts) == ""
    possible = contacts.possible
    for name, value in (
        ("points", possible.points + 0.01),
        ("normals", np.tile([0.6, 0, 0.8], (len(possible), 1))),
        ("two_sided", ~possible.two_sided),
        ("part_b", possible.part_b + 1),
    ):
        fields = {key: getattr(possible, key) for key in possible.__slots__}
        other = type(possible)(**{**fields, name: value})
        assert "not modelled" in why_unmodelled(
            contacts.assembly, contacts_with(contacts, other)
        ), name


def contacts_with(contacts: kilter.ContactSet, possible: object) -> kilter.ContactSet:
    return replace(contacts, possible=possible)
