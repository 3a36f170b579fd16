"""Scenes of the library, and transformations that change no answer."""

import subprocess
import sys
import time

import numpy as np
import pytest
from judged import judged
from transformations import as_single, permuted, renamed, scaled, tilted

import kilter
from kilter.assembly import Assembly, Feature, FrictionPair, GivenContact, Joint, Load, Part
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.scenes import (
    SCENES,
    arches,
    example,
    friction,
    paper,
    scene,
    stacks,
    traps,
    walls,
    wedges,
)
from kilter.scenes import random_bricks as packings
from kilter.scenes import traps as rounds
from kilter.scenes.friction import bracket, ladder
from kilter.scenes.paper import figure_2, figure_3
from kilter.scenes.pieces import cells, compose, moved, turn
from kilter.scenes.traps import three_cylinders
from kilter.shape.primitives import Box, Mesh


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


TURN = compose(turn([1, 2, 3], 50), turn([0, 1, 0], 20))
SMALL = ["paper-figure-8", "inverted-triangle", "keystone", "bracket", "corner-wedges"]


def stable(assembly):
    return judged(assembly, effort=0.5).stable


def everything():
    """An assembly with an item of every kind that contains names of parts or positions."""
    return Assembly(
        [
            Part("a", Box([2, 2, 2]), grounded=True),
            Part("b", Box([1, 1, 1]), Pose([0, 0, 1.5]), mass=2.0, center_of_mass=[0.1, 0, 0]),
        ],
        friction_pairs=[FrictionPair(("a", "b"), 0.3)],
        loads=[Load("b", force=[1, 0, 0], torque=[0, 1, 0], point=[0, 0, 2])],
        contacts=[
            GivenContact(("a", "b"), [[0, 0, 1], [1, 0, 1]], [0, 0, 1]),
            GivenContact(
                ("b", "a"),
                [[0, 0, 1]],
                [0, 0, 1],
                feature=(Feature("face", [1, 2, 0], (2, -1)), Feature("edge", [0, 1, 0], 3)),
            ),
        ],
        joints=[Joint(("ground", "b"), "revolute", [1, 0, 0], [0, 0, 1])],
    )


@pytest.mark.parametrize("name", SMALL)
class TestChangesNoAnswer:
    @pytest.mark.quick(1)
    def test_moved(self, name):
        assembly = SCENES[name].build()
        turned = moved(assembly, TURN, [3, -4, 5])
        assert np.allclose(turned.geometry.mass, assembly.geometry.mass)
        assert stable(turned) == stable(assembly)

    @pytest.mark.quick(1)
    def test_scaled(self, name):
        assembly = SCENES[name].build()
        twice = scaled(assembly, 2.0)
        assert stable(twice) == stable(assembly)
        assert np.allclose(twice.geometry.mass, 8 * assembly.geometry.mass)
        assert np.allclose(twice.geometry.center, 2 * assembly.geometry.center)

    @pytest.mark.quick(1)
    def test_permuted(self, name):
        assembly = SCENES[name].build()
        order = np.random.default_rng(0).permutation(len(assembly.parts))
        other = permuted(assembly, order)
        assert other.names == tuple(assembly.names[k] for k in order)
        assert stable(other) == stable(assembly)

    @pytest.mark.quick(1)
    def test_renamed(self, name):
        assembly = SCENES[name].build()
        other = renamed(assembly, lambda part: f"x {part}")
        assert other.names[0] == f"x {assembly.names[0]}"
        assert stable(other) == stable(assembly)

    def test_as_single_rounds_and_keeps_masses(self, name):
        assembly = SCENES[name].build()
        single = as_single(assembly)
        for part in single.parts:
            assert isinstance(part.shape, Mesh)
            assert np.array_equal(part.shape.vertices, part.shape.vertices.astype(np.float32))
            assert part.shape.accuracy > 1e-9
        assert np.allclose(single.geometry.mass, assembly.geometry.mass, rtol=1e-6)
        assert np.allclose(single.geometry.center, assembly.geometry.center, atol=1e-5)


def test_moved_takes_loads_contacts_and_joints_along():
    whole = everything()
    there = moved(whole, TURN, [1, 2, 3])
    back = moved(there, TURN * [1, -1, -1, -1])
    shift = back.parts[0].pose.position
    assert np.allclose(back.loads[0].force, whole.loads[0].force)
    assert np.allclose(back.loads[0].torque, whole.loads[0].torque)
    assert np.allclose(back.loads[0].point, whole.loads[0].point + shift)
    assert np.allclose(back.contacts[0].points, whole.contacts[0].points + shift)
    assert np.allclose(back.contacts[0].normal, whole.contacts[0].normal)
    assert np.allclose(back.joints[0].point, whole.joints[0].point + shift)
    assert np.allclose(back.joints[0].axis, whole.joints[0].axis)
    assert np.allclose(back.gravity, whole.gravity)


def test_scaled_grows_forces_as_weights():
    twice = scaled(everything(), 2.0)
    assert twice.parts[1].mass == 16.0
    assert twice.parts[1].center_of_mass.tolist() == [0.2, 0, 0]
    assert twice.loads[0].force.tolist() == [8, 0, 0]
    assert twice.loads[0].torque.tolist() == [0, 16, 0]
    assert twice.contacts[0].points[1].tolist() == [2, 0, 2]
    assert scaled(three_cylinders(), 3.0).parts[1].shape.radius == 3.0


def test_renamed_renames_what_names_parts_but_not_the_ground():
    other = renamed(everything(), str.upper)
    assert other.joints[0].parts == ("ground", "B")
    assert other.contacts[0].parts == other.friction_pairs[0].parts == ("A", "B")
    assert other.loads[0].part == "B"


def test_as_single_keeps_the_given_centre_in_place():
    assembly = moved(bracket(), turn([1, 1, 0], 30))
    assert np.allclose(as_single(assembly).geometry.center, assembly.geometry.center)


def test_planar_scenes_turn_about_y_only():
    flat = paper.figure_9(planar=True)
    turned = moved(flat, turn([0, 1, 0], 30), [1, 0, 1])
    assert turned.planar
    assert turned.gravity[1] == 0.0
    assert stable(turned)
    assert tilted(flat, [0, -1, 0], 10).gravity[1] == 0.0
    for wrong in (lambda: moved(flat, turn([1, 0, 0], 30)), lambda: tilted(flat, [1, 0, 0], 1)):
        with pytest.raises(InputError, match="leaves the x-z plane"):
            wrong()


def test_tilted_leans_toward_minus_x_about_y():
    down = tilted(stacks.tower(1), [0, 1, 0], 30).down
    assert np.allclose(down, [-0.5, 0, -np.sqrt(0.75)])
    ladder_down = tilted(ladder(), [0, 1, 0], -30).down
    assert np.allclose(ladder_down, [0.5, 0, -np.sqrt(0.75)])


def test_wrong_transformations_are_refused():
    wall = walls.wall(2, 2)
    with pytest.raises(InputError, match="not a permutation"):
        permuted(wall, [0, 0, 1, 2, 3, 4])
    with pytest.raises(InputError, match="factor is -1"):
        scaled(wall, -1)
    with pytest.raises(InputError, match="do not fit"):
        cells([0, 1], [0, 1], [0, 1], [[[False]]])
