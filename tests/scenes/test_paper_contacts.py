"""Figures 2 and 3 of the paper: the constraints that the text counts."""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter.errors import InputError
from kilter.scenes.paper_contacts import figure_2, figure_3


def test_a_segment_has_a_constraint_at_each_end() -> None:
    contacts = kilter.contacts(figure_2())
    ends = np.unique(contacts.points[:, [0, 2]], axis=0)
    assert ends.tolist() == [[-1, 0], [1, 0]]
    assert np.unique(contacts.normals, axis=0).tolist() == [[0, 0, 1]]


def test_a_polygonal_contact_has_a_constraint_at_each_of_five_corners() -> None:
    contacts = kilter.contacts(figure_3("a"))
    assert len(contacts.points) == 5
    # the area of a regular pentagon in a circle of radius 1
    assert contacts.patch_area.sum() == pytest.approx(5 / 2 * np.sin(2 * np.pi / 5), rel=1e-12)


def test_the_normal_of_two_edges_is_perpendicular_to_both() -> None:
    contacts = kilter.contacts(figure_3("b"))
    assert contacts.points == pytest.approx(np.zeros((1, 3)), abs=1e-12)
    assert contacts.normals == pytest.approx(np.array([[0, 0, 1]]), abs=1e-12)
    assert contacts.patch_kind.tolist() == ["edge-edge"]


def test_two_vertices_have_no_normal_and_slide_off() -> None:
    contacts = kilter.contacts(figure_3("c"))
    assert len(contacts.points) == 0
    assert [pair.kind for pair in contacts.open_pairs] == ["degenerate"]
    verdict = kilter.check(figure_3("c"))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["m"]


def test_another_contact_is_one_sentence() -> None:
    with pytest.raises(InputError, match="Figure 3 has no contact 'e'; give 'a', 'b', 'c' or 'd'"):
        figure_3("e")
