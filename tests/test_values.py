"""Values: their representation and arguments; tolerances of files and shapes."""

import dataclasses
import pickle
from collections.abc import Iterator
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, InputError, Joint, Load, Mesh, Part, Pose
from kilter.assembly import assembly_tolerances as a
from kilter.files import file_tolerances as f
from kilter.scenes import scene
from kilter.shape import shape_tolerances as t
from kilter.shape.primitives import surface
from literals import unnamed

CUBE = Part("cube", Box([1, 1, 1]))


@pytest.fixture(scope="module")
def wall() -> Assembly:
    return scene("wall")


@pytest.fixture(scope="module")
def unstable() -> kilter.Verdict:
    return kilter.check(scene("paper-figure-8"))


# one line ----------------------------------------------------------------------------------


def values() -> Iterator[Any]:
    assembly = scene("ladder")
    yield from (assembly, *assembly, *assembly.contacts, assembly.geometry)
    yield from (part.shape for name in ("bracket", "three-cylinders") for part in scene(name))
    yield from (part.pose for part in assembly)
    yield from scene("books").friction_pairs
    yield from scene("books").loads
    yield Joint(("cube", "ground"), "revolute", point=[0, 0, 1], axis=[0, 1, 0])
    yield kilter.Tolerance(clearance=0.5)
    yield kilter.check(assembly)
    yield kilter.check(assembly).contacts
    yield kilter.region(scene("slope"))
    yield kilter.region(scene("slope-with-friction"))
    yield kilter.orient(scene("paper-figure-11"))
    yield kilter.margin(scene("tower"))
    yield kilter.verify(scene("tower"), kilter.check(scene("tower")).proof())
    yield kilter.states(scene("tower"))
    yield kilter.states(scene("tower")).of()
    yield kilter.example()[0]


@pytest.mark.slow
def test_shown_in_one_short_line():
    for value in values():
        shown = repr(value)
        assert "\n" not in shown
        assert len(shown) <= 150
        assert type(value).__name__ in shown


def test_of_an_assembly_counts_are_shown_and_no_numbers(wall):
    held = sum(part.grounded for part in wall)
    assert repr(wall) == f"<Assembly: {len(wall)} parts, {held} held, in m>"


# parts by name -----------------------------------------------------------------------------


def test_an_assembly_is_a_sequence_of_parts_with_names(wall):
    name = wall.names[3]
    assert len(wall) == len(wall.parts) == len(list(wall))
    assert wall[name] is wall[3] is wall.parts[3]
    assert wall[-1] is wall.parts[-1]
    assert name in wall
    assert wall[name] in wall
    assert "nobody" not in wall


@pytest.mark.parametrize("wrong", ["brik-1-1", 1000, -1000, None, 1.5])
def test_no_such_part(wall, wrong):
    with pytest.raises(InputError, match="no part"):
        wall[wrong]


def test_words_of_a_part_by_name_and_by_position(unstable):
    assert unstable.words("C2") == unstable.words(1) == "drops at 0.75 g"
    assert unstable.words("C1") == "is held"
    with pytest.raises(InputError, match="did you mean 'C2'"):
        unstable.words("c2")


def test_a_notebook_shows_counts_and_what_is_held(wall):
    shown = wall._repr_html_()
    assert f"{len(wall)}" in shown
    assert "held" in shown
    assert len(shown) < 3000


# a verdict is no truth value ---------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["tower", "paper-figure-8", "trough"])
def test_stable_says_so_and_truth_is_refused(name):
    verdict = kilter.check(scene(name), effort=0)
    assert verdict.stable == (verdict.level in ("settles", "proved"))
    with pytest.raises(TypeError, match=r"use \.stable"):
        bool(verdict)


def test_times_are_read_only(unstable):
    with pytest.raises(TypeError):
        unstable.seconds["read"] = 1.0  # type: ignore[index]


def test_a_verdict_can_be_sent_to_another_process(unstable):
    copy = pickle.loads(pickle.dumps(unstable))
    assert copy.to_dict() == unstable.to_dict()


# read-only ---------------------------------------------------------------------------------


def arrays_of(value: Any, seen: set[int]) -> Iterator[tuple[str, np.ndarray]]:
    """Every array that public attributes lead to, with the way to it."""
    if id(value) in seen or isinstance(value, type):
        return
    seen.add(id(value))
    if isinstance(value, np.ndarray):
        yield "", value
    elif isinstance(value, list | tuple):
        for one in value:
            yield from ((f"[]{way}", array) for way, array in arrays_of(one, seen))
    elif type(value).__module__.startswith("kilter"):
        for name in (n for n in dir(value) if not n.startswith("_")):
            attribute = getattr(value, name, None)  # an unstable verdict has no forces
            kept = getattr(value, name, None) is attribute  # else computed anew: nobody else's
            if kept and not callable(attribute):
                yield from ((f".{name}{way}", a) for way, a in arrays_of(attribute, seen))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["paper-figure-8", "ladder", "trough", "three-cylinders", "corner-wedges"]
)
def test_no_array_of_a_verdict_can_be_written_to(name):
    verdict = kilter.check(scene(name), effort=1)
    found = list(arrays_of(verdict, set()))
    assert len(found) > 50
    writable = [way for way, array in found if array.flags.writeable]
    assert not writable


def test_what_is_handed_over_is_copied():
    corners, faces = (np.array(a) for a in surface(Box([1, 1, 1])))
    mesh = Mesh(corners, faces)
    corners[:] = 0.0
    assert np.ptp(mesh.vertices) == 1.0


# what a wrong type is told -----------------------------------------------------------------


VERBS = (
    *(kilter.check, kilter.contacts, kilter.orient, kilter.region, kilter.margin, kilter.report),
    *(kilter.draw, kilter.common_region, kilter.verify, kilter.dump),
)


@pytest.mark.quick(27)
@pytest.mark.parametrize("verb", VERBS, ids=lambda verb: verb.__name__)
@pytest.mark.parametrize(
    ("given", "hint"),
    [
        ("arch.stl", r"arch\.stl"),
        (SimpleNamespace(vertices=[], faces=[]), r"kilter\.load\(mesh\)"),
        (CUBE, r"kilter\.Assembly\(\[part"),
        ([CUBE], r"kilter\.load\(path or object\)"),
        (None, r"kilter\.load\(path or object\)"),
    ],
    ids=["path", "trimesh", "part", "list", "None"],
)
def test_what_is_no_assembly_is_told_how_to_become_one(verb, given, hint):
    single = verb in (kilter.check, kilter.contacts, kilter.orient, kilter.region, kilter.margin)
    with pytest.raises(InputError, match=hint if single else None) as caught:
        verb(*([given, {}] if verb in (kilter.verify, kilter.dump) else [given]))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Part("a", "box"), "shape is of type str"),
        (lambda: Part("a", Box([1, 1, 1]), [1, 2]), r"a pose is \[1, 2\]"),
        (lambda: Box(1, 1), r"expected 3 numbers"),
        (lambda: Pose.from_matrix([1, 2, 3]), r"matrix of a pose: expected 3 x 3 numbers"),
        (lambda: Part("a", Box([1, 1, 1]), np.diag([1, 1, 2])), "not a rotation"),
        (lambda: Part("a", Box([1, 1, 1]), np.diag([1, 1, -1])), "not a rotation"),
        (lambda: Part("a", Box([1, 1, 1]), np.full((4, 4), 1.0)), "last row"),
        (lambda: Part("a", Box([1, 1, 1]), grounded="yes"), "grounded is 'yes'"),
        (lambda: Part("a", Box([1, 1, 1]), density=[1]), r"density is \[1\]"),
        (lambda: Assembly(CUBE), "parts is a single Part"),
        (lambda: Assembly(["cube"]), r"parts\[0\] is of type str"),
        (lambda: Assembly([CUBE], loads=Load("cube")), "loads is a single Load"),
        (lambda: Assembly([CUBE], gravity=-9.81), "gravity: expected 3 numbers"),
        (lambda: Assembly([CUBE], joints=[("cube", "ground")]), r"kilter\.Joint"),
        (lambda: Joint("ab"), "give a pair of names"),
        (lambda: kilter.check(Assembly([CUBE]).with_grounded("*"), tolerance=0.1), "Tolerance"),
        (lambda: kilter.check(Assembly([CUBE]).with_grounded("*"), contacts=[]), "contacts"),
        (lambda: kilter.check(Assembly([CUBE]).with_grounded("*"), effort=-1), "effort"),
    ],
)
def test_wrong_types_fail_at_once_in_one_sentence(build, words):
    with pytest.raises(InputError, match=words) as caught:
        build()
    assert "\n" not in str(caught.value)
    assert "--" not in str(caught.value)


def test_an_error_says_python_to_python_and_options_to_a_command():
    with pytest.raises(InputError) as caught:
        kilter.check(Assembly([CUBE]))
    assert "with_grounded('cube')" in str(caught.value)
    assert "--ground 'cube'" in caught.value.for_command
    assert "--" not in str(caught.value)


# poses -------------------------------------------------------------------------------------


@pytest.mark.parametrize("as_list", [False, True])
def test_a_pose_may_be_a_matrix(as_list):
    random = np.random.default_rng(11)
    for _ in range(20):
        pose = Pose(random.normal(size=3), random.normal(size=4))
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = pose.matrix, pose.position
        given = matrix.tolist() if as_list else matrix
        part = Part("cube", Box([1, 1, 1]), given)
        assert np.allclose(part.pose.matrix, pose.matrix, atol=1e-14)
        assert part.pose.position.tolist() == pose.position.tolist()
        turned = Part("cube", Box([1, 1, 1]), [row[:3] for row in given[:3]])
        assert np.allclose(turned.pose.matrix, pose.matrix, atol=1e-14)
        assert not turned.pose.position.any()


def test_a_part_can_be_changed_by_replace():
    held = dataclasses.replace(CUBE, grounded=True)
    assert held.grounded
    assert held.pose is CUBE.pose


def test_a_copy_with_the_same_parts_shares_the_geometry():
    tower = scene("tower")
    geometry = tower.geometry
    assert tower.with_joints([Joint(("cube-1", "cube-2"))]).geometry is geometry
    assert tower.with_friction(0.5).geometry is geometry
    assert tower.with_grounded("cube-1").geometry.grounded.sum() == geometry.grounded.sum() + 1
    assert dataclasses.replace(tower, units="mm").geometry is not geometry


CHAINS = [
    (a, ("SAME_SURFACE", "COPLANAR", "SMOOTH")),
    (f, ("INTEGRAL", "RIGID", "SAME_FACE", "VOLUME", "RECOGNISED", "DEFLECTION", "TURN")),
]


@pytest.mark.parametrize(("where", "chain"), CHAINS, ids=["assembly", "files"])
def test_tolerances_are_ordered(where, chain):
    values = [getattr(where, name) for name in chain]
    assert all(low < high for low, high in pairwise(values))


def test_what_the_docstrings_call_equal_is_equal():
    assert a.SAME_SURFACE == a.PLANAR_AXIS == a.FLAT_PART == a.INSIDE_OUT
    assert f.RECOGNISED == f.SAME_ANGLE


def test_the_fifth_power_of_the_largest_size_is_a_number():
    assert a.LARGEST**5 < 1e300


@pytest.mark.slow
def test_no_small_number_goes_without_a_name():
    # masses of bricks [kg]
    found = unnamed("assembly", but="assembly_tolerances.py")
    assert {place.split(":")[0] for place in found} == {"assembly/bricks/brick_library.py"}
    # units: a micron in millimetres (3MF); prefixes and inches (STEP, FreeCAD)
    found = unnamed("files", but="file_tolerances.py")
    places = {place.split(":")[0] for place in found}
    assert places == {
        "files/cad/freecad_tree.py",
        "files/cad/step_statements.py",
        "files/cad/step_densities.py",
        "files/meshes/threemf.py",
    }


ORDERS = [
    ("NO_AREA", "PLANE_FLATNESS", "WELD"),
    ("LEAST_TURN", "FACET_NORMAL", "STEEPEST_EDGE"),
    ("PLANE_ROUNDINGS", "EVIDENCE", "GROWING"),
    ("STEP_RANK", "FIT_RANK", "BEHIND_APEX", "NARROWEST_CONE", "WIDEST_CONE"),
]


@pytest.mark.parametrize("chain", ORDERS, ids=lambda chain: " < ".join(chain))
def test_tolerances_of_shapes_are_ordered(chain):
    values = [getattr(t, name) for name in chain]
    assert all(low < high for low, high in pairwise(values))


def test_prism_of_twelve_sides_is_round_and_one_of_eleven_is_not():
    assert 2 * np.pi / 12 < t.STEEPEST_EDGE < 2 * np.pi / 11


def test_what_is_welded_fits_a_surface():
    assert t.WELD == t.SURFACE_FIT


def test_no_small_number_of_the_shapes_goes_without_a_name():
    assert unnamed("shape", but="shape_tolerances.py") == []
