"""Scenes of the library: their lists, their geometry, and wrong arguments.

Closed forms of their verdicts are in `tests/analysis/test_known_cases.py`, `test_paper_figures.py`,
`tests/friction` and `tests/margin`; each scene gives its stated answer in the first.
"""

import subprocess
import sys
import time

import numpy as np
import pytest

import kilter
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.scenes import (
    SCENES,
    arches,
    example,
    friction,
    packings,
    paper,
    rounds,
    scene,
    stacks,
    traps,
    walls,
    wedges,
)
from kilter.scenes.paper_contacts import figure_2, figure_3


def overlaps(assembly):
    return [pair.ends for pair in kilter.contacts(assembly).open_pairs if pair.kind == "overlap"]


def test_each_scene_has_a_title_held_and_free_parts_and_masses():
    for name, entry in SCENES.items():
        assembly = entry.build()
        assert isinstance(assembly, Assembly)
        assert 0 < assembly.geometry.grounded.sum() < len(assembly.parts)
        assert (assembly.geometry.mass > 0).all()
        assert (assembly.geometry.volume > 0).all()
        assert assembly.geometry.warnings == ()
        assert entry.name == name == name.lower().replace(" ", "-")
        assert 0 < len(entry.title) <= 80
        assert "\n" not in entry.title
        assert entry.source


def test_there_are_scenes_of_every_answer():
    answers = {"stable", "settles", "potentially-stable", "balanced", "unstable"}
    assert {entry.answer for entry in SCENES.values()} == answers


@pytest.mark.parametrize("name", ["box-pile", "corner-wedges"])
def test_builds_the_same_scene_each_time(name):
    assert np.array_equal(scene(name).geometry.vertices, scene(name).geometry.vertices)


def test_an_example_is_an_assembly_or_the_list_of_all():
    listed = example()
    assert [entry.name for entry in listed] == list(SCENES)
    assert example("tower").names == scene("tower").names
    assert listed[0].to_dict().keys() == {"name", "title", "source", "answer"}
    assert all("\n" not in repr(entry) for entry in listed)


@pytest.mark.slow
def test_listing_the_examples_is_light():
    code = (
        "import sys, kilter; kilter.example();"
        "print([m for m in ('scipy', 'shapely', 'highspy', 'pydantic') if m in sys.modules])"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"


@pytest.mark.parametrize(("build", "said"), [
    (lambda: scene("harmonic-stak"), "did you mean 'harmonic-stack'"),
    (lambda: scene("??"), "use one of: paper-figure-1"),
    (lambda: figure_3("e"), "Figure 3 has no contact 'e'; give 'a', 'b', 'c' or 'd'"),
    (lambda: paper.figure_4(5), "no orientation 5"),
    (lambda: paper.figure_1("c"), "no orientation 'c'"),
    (lambda: walls.hanging_brick(3, 4), "no room for a lintel"),
    (lambda: walls.hanging_brick(4, 3), "no room for a lintel"),
    (lambda: walls.wall(3, 3, gap=0.1), "too large for a brick"),
    (lambda: traps.floating_block(7), "no cube 7"),
    (lambda: arches.arch(5, span=181), "span 181"),
    (lambda: friction.a_block(60), "half angle is 60"),
], ids=range(11))  # fmt: skip
def test_wrong_arguments_are_refused(build, said):
    with pytest.raises(InputError, match=said):
        build()


@pytest.mark.parametrize("build", [
    lambda: packings.box_pile(20, seed=1, level=False),
    lambda: wedges.corner_wedges(9, seed=1),
    lambda: arches.arch(6, span=157.5),
    lambda: paper.two_blocks_in_an_l(30),
    lambda: paper.figure_8(75),
    lambda: friction.ladder(75),
], ids=range(6))  # fmt: skip
def test_no_parts_overlap_at_other_parameters(build):
    assert overlaps(build()) == []


def test_wedges_fill_their_cube_and_sectors_weigh_half_a_ring():
    wedge = wedges.corner_wedges(4, seed=2)
    assert wedge.geometry.volume[3:].sum() == pytest.approx(8.0, rel=1e-13)
    geometry = arches.arch(9, ratio=0.2, radius=1.0, sectors=True).geometry
    ring = np.pi / 2 * (1.1**2 - 0.9**2) * 1000
    assert geometry.mass[2:].sum() == pytest.approx(ring)
    height = (geometry.mass[2:] @ geometry.center[2:, 2]) / ring
    assert height == pytest.approx(2 / 3 * (1.1**3 - 0.9**3) * 1000 / ring)


def test_top_of_a_harmonic_stack_is_at_half_the_harmonic_sum():
    top = stacks.harmonic_stack(20, scale=1).parts[-1]
    assert top.pose.position[0] + 0.5 == pytest.approx(sum(1 / k for k in range(1, 21)) / 2)


def test_round_parts_touch_their_neighbours():
    for assembly in (rounds.three_cylinders(), rounds.four_spheres()):
        centers = assembly.geometry.center[1:]
        apart = np.linalg.norm(centers[:, None] - centers, axis=-1)
        assert np.isclose(apart, 2.0).sum() == len(centers) * (len(centers) - 1)
        assert np.isclose(centers[:-1, 2], 1.0).all()


@pytest.mark.parametrize("count", [1, 10, 1000])
def test_wall_of_about_a_count(count):
    assert len(walls.wall_of(count).parts) - 1 == pytest.approx(count, rel=0.06)


@pytest.mark.slow
def test_large_walls_are_fast():
    start = time.process_time()
    walls.wall_of(10_000)
    assert time.process_time() - start < 1.5


def test_a_segment_has_a_constraint_at_each_end():
    contacts = kilter.contacts(figure_2())
    ends = np.unique(contacts.points[:, [0, 2]], axis=0)
    assert ends.tolist() == [[-1, 0], [1, 0]]
    assert np.unique(contacts.normals, axis=0).tolist() == [[0, 0, 1]]


def test_a_pentagon_has_a_constraint_at_each_corner_and_edges_have_their_common_normal():
    contacts = kilter.contacts(figure_3("a"))
    assert len(contacts.points) == 5
    # the area of a regular pentagon in a circle of radius 1
    assert contacts.patch_area.sum() == pytest.approx(5 / 2 * np.sin(2 * np.pi / 5), rel=1e-12)
    contacts = kilter.contacts(figure_3("b"))
    assert contacts.points == pytest.approx(np.zeros((1, 3)), abs=1e-12)
    assert contacts.normals == pytest.approx(np.array([[0, 0, 1]]), abs=1e-12)
    assert contacts.patch_kind.tolist() == ["edge-edge"]


def test_two_vertices_have_no_normal_and_slide_off():
    contacts = kilter.contacts(figure_3("c"))
    assert len(contacts.points) == 0
    assert [pair.kind for pair in contacts.open_pairs] == ["degenerate"]
    verdict = kilter.check(figure_3("c"))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["m"]
