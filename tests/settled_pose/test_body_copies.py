"""Equal groups of bodies come to rest once: their rests, and all that tells them apart."""

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.settled_pose import rest_engine
from kilter.analysis.settled_pose.body_copies import find_copies
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.rigid import quaternion_to_matrix

TABLE = Part("table", Box(40, 40, 1), [0, 0, -0.5], grounded=True)
LOW, TOP = Box(1, 0.8, 0.5), Box(0.9, 0.3, 0.3)


def turned(angle):
    """Quaternion of a turn about the vertical."""
    return [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]


def stack(name, place, angle, height=0.02):
    """A box above the table, and a second one on it that tips off."""
    turn = quaternion_to_matrix(np.array(turned(angle)))
    top = turn @ [0.55, 0.1, 0.15 + 0.5 + height] + [*place, 0]
    return [
        Part(f"{name}-low", LOW, Pose([*place, 0.25 + height], turned(angle))),
        Part(f"{name}-top", TOP, Pose(top, turned(angle))),
    ]


PLACES = {"a": ((-8, 0), 0.3), "b": ((3, 5), 2.1), "c": ((4, -7), -1.2)}


def row(*more):
    parts = [part for name, where in PLACES.items() for part in stack(name, *where)]
    return Assembly([TABLE, *parts, *more], friction=0.5)


def chosen(assembly):
    """Names of the parts that come to rest by themselves, or None without copies."""
    bodies = rigid_bodies(assembly, ())
    copies = find_copies(bodies)
    if copies is None:
        return None
    return [assembly.names[k] for k in np.flatnonzero(copies.chosen[bodies.of_part])]


def settled(assembly, monkeypatch, *, copies):
    """The answer, and whether it took the rest of copies."""
    used = []
    with monkeypatch.context() as patch:
        found = rest_engine._with_copies
        patch.setattr(
            rest_engine, "_with_copies", lambda *given: used.append(found(*given)) or used[-1]
        )
        if not copies:
            patch.setattr(rest_engine, "find_copies", lambda bodies: None)
        answer = kilter.settle(assembly)
    return answer, bool(used) and used[-1] is not None


def poses(answer):
    return np.array([[*part.pose.position, *part.pose.matrix.ravel()] for part in answer.assembly])


def test_equal_stacks_rest_as_the_first_of_them_does_alone(monkeypatch):
    scene = row()
    assert chosen(scene) == ["a-low", "a-top"]
    answer, copied = settled(scene, monkeypatch, copies=True)
    assert copied
    assert answer.at_rest
    ways = {moved.part: [way.how for way in moved.way] for moved in answer.moved}
    assert ways["a-top"] == ways["b-top"] == ways["c-top"]
    for name, (place, angle) in PLACES.items():
        alone, _ = settled(
            Assembly([TABLE, *stack(name, place, angle)], friction=0.5), monkeypatch, copies=False
        )
        assert alone.at_rest
        for k in (f"{name}-low", f"{name}-top"):
            here, there = answer[k].pose, alone[k].pose
            assert here.position == pytest.approx(there.position, abs=1e-4)
            assert here.matrix == pytest.approx(there.matrix, abs=1e-4)


OBSTACLES = {
    "beside one": Part("step", Box(0.3, 3, 0.2), [5.1, -7.5, 0.1], grounded=True),
    "below one": Part("plate", Box(2, 2, 0.01), [4, -7, 0.005], grounded=True),
    "a free part beside one": Part("box", Box(0.4, 0.4, 0.3), [4.9, -8.3, 0.15]),
    "round": Part("rod", kilter.Cylinder(0.1, 0.6), [3.2, -7.9, 0.3], grounded=True),
}


@pytest.mark.quick("round")
@pytest.mark.parametrize("name", OBSTACLES)
def test_a_group_with_something_else_near_it_comes_to_rest_by_itself(name, monkeypatch):
    scene = row(OBSTACLES[name])
    one, copied = settled(scene, monkeypatch, copies=True)
    assert not copied
    other, _ = settled(scene, monkeypatch, copies=False)
    assert poses(one) == pytest.approx(poses(other), abs=1e-9)


def test_a_group_beyond_the_edge_of_the_table_does_not_take_the_rest_of_another(monkeypatch):
    parts = [*stack("a", (0, 0), 0.0), *stack("b", (19.8, 0), 0.0)]
    scene = Assembly([TABLE, *parts], friction=0.5)
    one, copied = settled(scene, monkeypatch, copies=True)
    assert not copied
    assert one.leaves == ("b-top",)


def test_different_masses_heights_tilts_and_joints_are_no_copies():
    first = stack("a", (0, 0), 0.0)
    heavy = [Part(p.name, p.shape, p.pose, mass=7.0) for p in stack("b", (5, 0), 0.0)]
    other_shape = [Part("b", Box(1, 0.8, 0.5), [5, 0, 0.27])]
    tilt = [Part("b", LOW, Pose([5, 0, 1.0], [np.cos(0.1), np.sin(0.1), 0, 0]))]
    assert chosen(Assembly([TABLE, *first, *heavy])) is None
    assert chosen(Assembly([TABLE, first[0], *other_shape])) is None
    assert chosen(Assembly([TABLE, first[0], *tilt])) is None
    second = stack("b", (5, 0), 0.0)
    assert chosen(Assembly([TABLE, *first, *second])) == ["a-low", "a-top"]
    tied = kilter.Joint(("b-low", "b-top"))
    assert chosen(Assembly([TABLE, *first, *second], joints=[tied])) is None
    both = [tied, kilter.Joint(("a-low", "a-top"))]
    assert chosen(Assembly([TABLE, *first, *second], joints=both)) == ["a-low", "a-top"]
    push = kilter.Load("b-top", [1, 0, 0])
    assert chosen(Assembly([TABLE, *first, *second], loads=[push])) is None
