"""Properties of a `ContactSet`: read-only, short to print, and its JSON."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from kilter import Assembly, Box, Joint, Part, Pose
from kilter import example as scene
from kilter.contact import detect


def arrays(values):
    for field in dataclasses.fields(values):
        value = getattr(values, field.name)
        if isinstance(value, np.ndarray):
            yield field.name, value
        elif field.name in ("possible", "degenerate"):
            yield from arrays(value)


def test_every_array_of_contacts_is_read_only() -> None:
    found = detect.contacts(scene("tower"))
    held = dict(arrays(found))
    assert len(held) > 20
    assert [name for name, array in held.items() if array.flags.writeable] == []
    with pytest.raises(ValueError, match="read-only"):
        found.normals[0] = 0.0


def test_contacts_print_as_one_short_line() -> None:
    text = repr(detect.contacts(scene("tower")))
    assert "\n" not in text
    assert len(text) < 100
    assert text.startswith("<ContactSet: patches 5, points 20, pairs 5")


def test_contacts_know_the_names_and_joints_of_their_assembly() -> None:
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    found = detect.contacts(Assembly([floor, cube], joints=[Joint(("floor", "cube"))]))
    data = found.to_dict()
    assert [patch["parts"] for patch in data["patches"]] == [["floor", "cube"]]
    assert data["patches"][0]["area"] == 1.0
    assert data["joints"] == [{"parts": ["floor", "cube"], "kind": "fixed"}]
    assert data["units"] == "m"
    assert data["histogram"]["edges"][0] is data["histogram"]["edges"][-1] is None
