"""Calls that users guess: each is accepted, or its message is a sentence with the right call."""

import inspect
import re
import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, InputError, Load, Mesh, Part, Pose, Prism, Sphere
from kilter.values.guesses import CALLS, MEANT, RIGHT, Guessable, guarded

CUBE = Box(1, 1, 1)


def stack(offset: float = 0.2) -> Assembly:
    table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    lower = Part("lower", CUBE, [0, 0, 0.5])
    return Assembly([table, lower, Part("upper", CUBE, [offset, 0, 1.5])])


a = stack()
WRONG: dict[str, tuple[Callable[[], Any], str]] = {
    "save an assembly": (lambda: kilter.save(a, "x.json"), "kilter.dump(assembly, path)"),
    "place a box": (lambda: kilter.place(a, CUBE), "give kilter.Part(name, shape"),
    "parts by name": (lambda: a.parts["upper"], "use assembly['upper']"),
    "a part named ground": (lambda: Part("ground", CUBE), "the world in joints and straps"),
    "poses of a rest": (lambda: kilter.settle(a).poses, 'assembly["name"].pose'),
    "qpos of a rest": (lambda: kilter.settle(a).qpos, 'assembly["name"].pose'),
    "load(clearance)": (lambda: kilter.load("a", clearance=1), "kilter.Tolerance(clearance=...)"),
    "load(straps)": (lambda: kilter.load("a", straps=[]), "assembly.with_straps"),
    "load(held)": (lambda: kilter.load("a", held="b"), "use ground"),
    "load(mu)": (lambda: kilter.load("a", mu=0.5), "use friction"),
    "transport in words": (
        lambda: kilter.transport(a, accelerate="0.5g 0 0"), "accelerate=[0.5 * 9.81, 0, 0]"
    ),
    "check(density)": (lambda: kilter.check(a, density=1), "kilter.load(path, density=...)"),
    "check(mu)": (lambda: kilter.check(a, mu=1), "use friction"),
    "check(gravity)": (lambda: kilter.check(a, gravity=[0, 0, -1]), "use down"),
    "check(timeout)": (lambda: kilter.check(a, timeout=3), "use time_limit"),
    "check(frction)": (lambda: kilter.check(a, frction=1), "did you mean 'friction'"),
    "check(verbose)": (lambda: kilter.check(a, verbose=True), "use progress=print"),
    "check(nonsense)": (lambda: kilter.check(a, qwertz=1), "it has assembly, friction"),
    "region(gap)": (lambda: kilter.region(a, gap=1), "kilter.Tolerance(gap=...)"),
    "with_mass": (lambda: a.with_mass({}), "dataclasses.replace(part, mass=2.0)"),
    "with_load": (lambda: a.with_load({}), "assembly.with_loads"),
    "assembly.save": (lambda: a.save("x"), "kilter.dump(assembly"),
    "verdict.holds": (lambda: kilter.check(a).holds, "verdict.stable"),
    "verdict.report": (lambda: kilter.check(a).report("x.html"), "kilter.report(assembly"),
    "verdict.draw": (lambda: kilter.check(a).draw("x.svg"), "kilter.draw(verdict"),
    "Part(fixed)": (lambda: Part("b", CUBE, fixed=True), "use grounded=True"),
    "Part(position)": (lambda: Part("b", CUBE, position=[0, 0, 1]), "use pose=[x, y, z]"),
    "Part(friction)": (lambda: Part("b", CUBE, friction=0.5), "kilter.Assembly(parts, friction"),
    "Part(densty)": (lambda: Part("b", CUBE, densty=1), "did you mean 'density'"),
    "Box(width)": (lambda: Box(width=1, depth=1, height=1), "kilter.Box(x, y, z)"),
    "Sphere(diameter)": (lambda: Sphere(diameter=1), "radius=diameter / 2"),
    "Load(at)": (lambda: Load("b", at=[0, 0, 0]), "point=[x, y, z]"),
    "Pose(quaternion)": (lambda: Pose(quaternion=[1, 0, 0, 0]), "rotation=[w, x, y, z]"),
    "Assembly(ground)": (lambda: Assembly([], ground="b"), "grounded=True"),
    "a text as shape": (lambda: Part("b", "cube"), "kilter.Box, Cylinder, Sphere"),  # type: ignore[arg-type]
    "a polygon with a hole": (
        lambda: Prism(SimpleNamespace(exterior=[], interiors=[1]), 1), "mesh of the solid"
    ),
    "a flat hull": (lambda: Mesh.convex_hull(np.eye(3)), "enclose a volume"),
    "wrong axes": (lambda: Pose.from_euler([0, 0, 0], axes="abc"), '"xyz" or "ZYX"'),
    "check a part": (lambda: kilter.check(a["lower"]), "kilter.Assembly([part, ...])"),
    "kilter.read": (lambda: kilter.read("a"), "use kilter.load(path)"),
    "kilter.simulate": (lambda: kilter.simulate(a), "use kilter.settle(assembly)"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_call_names_the_right_one(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, remedy = WRONG[case]
    with pytest.raises(InputError) as caught:
        call()
    message = str(caught.value)
    assert remedy in message
    assert "\n" not in message
    assert ";" in message  # the fault, then the remedy
    assert not list(tmp_path.iterdir())


def test_every_remedy_names_what_exists_and_no_guess_is_a_name():
    for owner, rows in CALLS.items():
        target: Any = kilter if owner == "kilter" else getattr(kilter, owner.rstrip("()"), None)
        for word, call in rows.items():
            for name in re.findall(r"kilter\.(\w+)", call.replace('"a.kilter.json"', "")):
                assert name in kilter.__all__, call
            if owner.endswith("()"):
                functions = (
                    [target]
                    if owner != "kilter()"
                    else [kilter.check, kilter.margin, kilter.plan, kilter.region]
                )
                for function in functions:
                    assert word not in inspect.signature(function).parameters, (owner, word)
            else:
                assert not hasattr(target, word), (owner, word)
    attributes = {"verdict": kilter.Verdict, "assembly": Assembly, "part": Part, "pose": Pose}
    for owner, rows in RIGHT.items():
        target = getattr(kilter, owner.rstrip("()"), None)
        for call in rows.values():
            answer = {} if owner in ("kilter", "kilter()") else {"answer": target}
            named = {**attributes, **answer}
            for name, attribute in re.findall(rf"(?<![\w.])({'|'.join(named)})\.(\w+)", call):
                fields = getattr(named[name], "__dataclass_fields__", {})
                assert attribute in fields or hasattr(named[name], attribute), call


def test_words_are_in_the_table_once():
    for rows in RIGHT.values():
        words = [word for key in rows for word in key.split()]
        assert len(words) == len(set(words))
    assert len(MEANT) == len(set(MEANT))


def test_a_property_that_fails_keeps_its_own_error():
    """An error of kilter itself must not look like a wrong name of the user."""

    class Answer(Guessable):
        @property
        def holds(self) -> bool:
            raise AttributeError("a fault inside")

    with pytest.raises(AttributeError, match="a fault inside"):
        _ = Answer().holds
    with pytest.raises(AttributeError, match="has no attribute 'other'"):
        _ = Answer().other
    assert not hasattr(Answer(), "other")
    assert not hasattr(a, "with_mass")


def test_a_guarded_function_and_class_keep_their_signatures():
    assert list(inspect.signature(kilter.check).parameters)[:2] == ["assembly", "friction"]
    assert list(inspect.signature(Part).parameters)[:2] == ["name", "shape"]

    @guarded
    def passes_on(**others: int) -> dict[str, int]:
        return others

    assert passes_on(mu=1) == {"mu": 1}


@pytest.mark.parametrize(
    "name", [n for n in kilter.__all__ if inspect.isfunction(getattr(kilter, n))]
)
def test_the_help_of_a_function_names_the_two_calls_that_are_confused_with_it(name):
    text = inspect.getdoc(getattr(kilter, name)) or ""
    section = re.search(r"See Also\n-{8}\n((?:kilter\.\w+ : .+\.\n?)+)", text)
    assert section is not None
    named = re.findall(r"kilter\.(\w+) :", section[1])
    assert len(set(named) - {name}) == len(named) == 2
    assert set(named) <= set(kilter.__all__)


# accepted -------------------------------------------------------------------------------------


def test_a_part_of_a_rest_and_the_forces_on_a_part_have_names():
    rest = kilter.settle(a)
    assert rest["upper"] is rest.assembly["upper"]
    with pytest.raises(InputError, match="did you mean 'upper'"):
        rest["uper"]
    forces = kilter.check(a).forces
    assert np.array_equal(forces["upper"].forces, forces.on("upper").forces)


def test_a_polygon_of_shapely_makes_a_prism():
    import shapely

    outline = shapely.Polygon([(0, 0), (4, 0), (4, 3)])
    assert Part("a", Prism(outline, 2)).mass == pytest.approx(12_000, rel=1e-12)


def test_a_mesh_of_another_library_makes_a_part():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((1, 2, 3))
    part = Part("a", box)
    assert part.mass == pytest.approx(6000, rel=1e-12)
    assert part == Part("a", Mesh(box.vertices, box.faces))


def test_a_hull_of_points_is_a_mesh():
    corners = [[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)]
    hull = Mesh.convex_hull([*corners, [0.5, 1, 1]])
    assert len(hull.vertices) == 8
    assert Part("a", hull).mass == pytest.approx(6000, rel=1e-12)


def test_a_pose_is_made_from_a_transform_and_from_angles():
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [1, 2, 3]
    assert Pose(whole) == Pose.from_matrix(whole)
    roll, pitch, yaw = 0.3, -0.7, 1.1
    turns = [Pose.from_euler([angle if i == k else 0 for i in range(3)]).matrix
             for k, angle in enumerate((roll, pitch, yaw))]  # fmt: skip
    # URDF: roll first, about axes of the world
    expected = turns[2] @ turns[1] @ turns[0]
    found = Pose.from_euler([roll, pitch, yaw], [1, 2, 3])
    assert np.allclose(found.matrix, expected, atol=1e-14)
    assert found.position.tolist() == [1, 2, 3]
    assert np.allclose(Pose.from_euler([yaw, pitch, roll], axes="ZYX").matrix, expected, atol=1e-14)


def test_the_workbench_does_not_block_a_cell(monkeypatch):
    kernel = SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel=None))
    monkeypatch.setitem(sys.modules, "IPython", kernel)
    with pytest.raises(InputError, match=r"use assembly\.show\(\) in a notebook"):
        kilter.view(a)


def test_an_object_of_another_library_is_converted_by_load():
    compound = type("Compound", (), {"__module__": "build123d.topology"})()
    with pytest.raises(InputError, match=r"convert it: kilter\.load\(object, floor=True\)"):
        kilter.check(compound)
