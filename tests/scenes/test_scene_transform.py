import numpy as np
import pytest
from judged import judged
from transformations import as_single, permuted, renamed, scaled, tilted

from kilter.assembly import Assembly, Feature, FrictionPair, GivenContact, Joint, Load, Part
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.scenes import SCENES, paper, stacks, walls
from kilter.scenes.friction import bracket, ladder
from kilter.scenes.pieces import cells, compose, turn
from kilter.scenes.rounds import three_cylinders
from kilter.scenes.transform import moved
from kilter.shape.primitives import Box, Mesh

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

    @pytest.mark.quick(2)
    def test_scaled(self, name):
        assembly = SCENES[name].build()
        twice = scaled(assembly, 2.0)
        assert stable(twice) == stable(assembly)
        assert np.allclose(twice.geometry.mass, 8 * assembly.geometry.mass)
        assert np.allclose(twice.geometry.center, 2 * assembly.geometry.center)

    @pytest.mark.quick(2)
    def test_permuted(self, name):
        assembly = SCENES[name].build()
        order = np.random.default_rng(0).permutation(len(assembly.parts))
        other = permuted(assembly, order)
        assert other.names == tuple(assembly.names[k] for k in order)
        assert stable(other) == stable(assembly)

    @pytest.mark.quick(2)
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


def test_wrong_arguments_are_refused():
    wall = walls.wall(2, 2)
    with pytest.raises(InputError, match="not a permutation"):
        permuted(wall, [0, 0, 1, 2, 3, 4])
    with pytest.raises(InputError, match="factor is -1"):
        scaled(wall, -1)
    with pytest.raises(InputError, match="do not fit"):
        cells([0, 1], [0, 1], [0, 1], [[[False]]])
