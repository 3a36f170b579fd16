"""Pairs of parts that the geometry leaves open, and pairs that it does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tubes import pin, tube

from kilter.assembly import Assembly, Joint, Part
from kilter.contact import ContactSet, Tolerance, contacts
from kilter.contact.contact_tolerances import GAP, LOOSE_ANGLE, LOOSE_GAP
from kilter.rigid import Pose
from kilter.scenes import scene
from kilter.scenes.pieces import block
from kilter.shape.primitives import Box, Prism


def stacked(gap: float, *, tilt: float = 0.0, **options: object) -> Assembly:
    """A unit cube `gap` over the middle of a held slab, tilted about y [rad]."""
    slab = block("slab", [-2, -2, -1], [2, 2, 0], grounded=True)
    turn = [np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0]
    # the lowest edge is `gap` over the slab
    height = gap + (np.cos(tilt) + abs(np.sin(tilt))) / 2
    return Assembly([slab, Part("cube", Box([1, 1, 1]), Pose([0, 0, height], turn))], **options)


def kinds(assembly: Assembly, **options: object) -> list[str]:
    found: ContactSet = contacts(assembly, **options)  # type: ignore[arg-type]
    return [one.kind for one in found.open_pairs]


@pytest.mark.quick(3)
@pytest.mark.parametrize(
    ("gap", "kind"),
    [
        (0.0, []),
        (0.9 * GAP, []),
        (1.5 * GAP, ["near"]),
        (50 * GAP, ["near"]),
        (0.99 * LOOSE_GAP, ["near"]),
        (1.01 * LOOSE_GAP, []),
        (-0.9 * GAP, []),
        (-1.5 * GAP, ["overlap"]),
        (-50 * GAP, ["overlap"]),
        (-0.3, ["overlap"]),
    ],
)
def test_a_cube_over_a_slab_by_its_gap(gap: float, kind: list[str]) -> None:
    size = float(contacts(stacked(0.0)).assembly.geometry.size[1])
    assert kinds(stacked(gap * size)) == kind


@pytest.mark.parametrize(("share", "kind"), [(0.99, ["near"]), (1.01, [])])
def test_a_tilted_cube_by_its_angle(share: float, kind: list[str]) -> None:
    assert kinds(stacked(0.0, tilt=share * LOOSE_ANGLE)) == kind


def test_what_is_known_of_it_is_said() -> None:
    found = contacts(stacked(-0.25))
    (one,) = found.open_pairs
    assert (one.ends, one.kind, one.depth) == ((0, 1), "overlap", pytest.approx(0.25))
    assert one.volume == pytest.approx(0.25)
    entry = found.to_dict()["open_pairs"][0]
    assert entry["parts"] == ["slab", "cube"]
    assert set(entry) == {"parts", "kind", "gap", "depth", "volume", "why"}
    (one,) = contacts(stacked(1e-4)).open_pairs
    assert (one.kind, one.gap, one.depth) == ("near", pytest.approx(1e-4), None)


@pytest.mark.parametrize("depth", [1e-3, -1e-4])
def test_what_is_joined_or_held_is_not_open(depth: float) -> None:
    assembly = stacked(-depth)
    assert len(kinds(assembly)) == 1
    assert kinds(assembly.with_joints([Joint(("cube", "slab"))])) == []
    assert kinds(assembly.with_joints([Joint(("cube", "ground"))])) == []
    assert (
        len(kinds(assembly.with_joints([Joint(("cube", "slab"), "prismatic", axis=[1, 0, 0])])))
        == 1
    )


def test_a_wider_tolerance_closes_a_gap() -> None:
    assembly = stacked(1e-4)
    assert kinds(assembly) == ["near"]
    assert kinds(assembly, tolerance=Tolerance(gap=2e-4)) == []
    assert kinds(assembly, tolerance=Tolerance.loose()) == []
    assert kinds(assembly, tolerance=Tolerance(clearance=2e-4)) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize(("radius", "kind"), [(0.999, ["clearance"]), (1.001, ["overlap"])])
def test_a_round_fit_with_clearance_or_interference(radius: float, kind: list[str]) -> None:
    found = Assembly([tube("tube", 1.0, 2.0, 1.0, grounded=True), pin("pin", radius, 4.0)])
    assert kinds(found) == kind


def test_the_depth_of_two_corners_is_at_most_the_way_in() -> None:
    # no facet is nearly across the way, so the planes of the facets alone give a depth of .2
    upper, lower = scene("paper-figure-3-vertices").parts[::-1]
    sunk = replace(upper, pose=Pose([0, 0, -0.01]))
    [overlap] = contacts(Assembly([replace(lower, grounded=True), sunk])).overlaps
    assert 0.005 < overlap.depth <= 0.01


def test_the_depth_of_crossing_ridges_is_measured_across_both() -> None:
    lower = Part("lower", Prism([[-1, -1], [1, -1], [0, 0]], 2.0), grounded=True)
    turned = Pose([0, 0, -0.02], [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    upper = Part("upper", Prism([[-1, 1], [1, 1], [0, 0]], 2.0), turned)
    [overlap] = contacts(Assembly([lower, upper])).overlaps
    assert overlap.depth == pytest.approx(0.02, rel=1e-6)
