"""Groups of parts that do not touch: equal ones are computed once, others bound each other."""

from dataclasses import replace

import numpy as np
import pytest

import kilter
from kilter.analysis.decision import motion as motions
from kilter.analysis.placing import near_load
from kilter.analysis.turning import facet_program
from kilter.arrays import Array
from kilter.assembly import Assembly, Joint, Part
from kilter.mechanics.clusters import limit_groups
from kilter.mechanics.program import Program, build_program
from kilter.rigid import Pose
from kilter.scenes.walls import wall_of
from kilter.shape.primitives import Box


def towers(angles: Array, last: float = 1.0) -> Assembly:
    """Towers of two boxes that tip over, turned by angles [rad]; `last`: a mass of the last."""
    parts = [Part("table", Box([40, 40, 1]), Pose([0, 0, -0.5]), True)]
    for k, angle in enumerate(angles):
        half = np.array([np.cos(angle / 2), 0, 0, np.sin(angle / 2)])
        aside = 0.9 * np.array([np.cos(angle), np.sin(angle), 0])
        at = np.array([4.0 * k, 0, 0])
        mass = last if k == len(angles) - 1 else 1.0
        parts.append(
            Part(f"low-{k}", Box([1.5, 1, 1]), Pose(at + np.array([0, 0, 0.5]), half), mass=1.0)
        )
        top = Pose(at + aside + np.array([0, 0, 1.5]), half)
        parts.append(Part(f"top-{k}", Box([1.5, 1, 1]), top, mass=mass))
    return Assembly(parts)


def program_of(assembly: Assembly) -> Program:
    """The program of an assembly with all its contacts."""
    return build_program(assembly, kilter.contacts(assembly))


@pytest.mark.parametrize(("last", "parts"), [(1.0, 2), (1.0 + 1e-6, 4)])
def test_only_clusters_that_are_equal_up_to_a_turn_are_left_out(last: float, parts: int) -> None:
    groups = limit_groups(program_of(towers(np.array([0.3, 1.7, 4.0]), last)))
    assert sum(int(group.free.sum()) for group in groups) == parts


def test_motion_of_turned_clusters_is_that_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    program = program_of(towers(np.array([0.3, 1.7, 4.0])))
    whole = motions.find_motion(program)
    monkeypatch.setattr(motions, "PARTED", 0)
    parted = motions.find_motion(program)
    assert whole.instability > 0.1
    np.testing.assert_allclose(parted.acceleration, whole.acceleration, atol=1e-6)


def test_facets_that_a_cluster_excludes_change_no_optimum(monkeypatch: pytest.MonkeyPatch) -> None:
    program = program_of(towers(np.array([0.3, 1.7]), last=2.0)).frictionless
    bounded = facet_program.joint(program, every=True)
    monkeypatch.setattr(facet_program, "_heaviest_cluster", lambda program: None)
    exact = facet_program.joint(program, every=True)
    assert bounded.z == pytest.approx(exact.z)
    np.testing.assert_allclose(bounded.gravity, exact.gravity, atol=1e-9)
    for bound, facet in zip(bounded.facets, exact.facets, strict=True):
        assert facet.z - 1e-9 <= bound.z <= exact.z + 1e-9


@pytest.mark.slow
def test_few_parts_near_a_place_decide_as_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    wall, box = wall_of(40), kilter.box_to_place([0.2, 0.1, 0.06], 1.0)
    whole = kilter.place(wall, box)
    monkeypatch.setattr(near_load, "NEAREST", (12,))
    near = kilter.place(wall, box)
    strip = 2 * near.accuracy * 0.1 * len(wall)
    for first, second in zip(whole.levels, near.levels, strict=True):
        assert first.stands.intersection(second.falls).area < 1e-9
        assert second.stands.intersection(first.falls).area < 1e-9
        assert abs(first.area - second.area) <= strip
    assert kilter.verify(wall, near.proof()).holds


def test_copies_with_the_same_parts_share_the_geometry() -> None:
    assembly = towers(np.array([0.3]))
    joined = replace(assembly, joints=[Joint(("low-0", "top-0"))])
    assert joined.geometry is assembly.geometry
    assert assembly.with_grounded("low-0").geometry is not assembly.geometry
    assert assembly.with_grounded("low-0").geometry.grounded.sum() == 2
