"""Calls that users of shapely, trimesh or build123d try first: values, and their changed copies."""

import ast
import dataclasses
import inspect
import json
import pickle
import re
import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import (
    Assembly,
    Bond,
    Box,
    Cylinder,
    Feature,
    FrictionPair,
    GivenContact,
    InputError,
    Joint,
    Load,
    Mesh,
    Part,
    Pose,
    Prism,
    Sphere,
)
from kilter.assembly.question import SHARED
from kilter.cli import main
from kilter.scenes import scene

CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]


def stack(offset: float = 0.6) -> Assembly:
    table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    lower = Part("lower", Box(1, 1, 1), [0, 0, 0.5])
    return Assembly([table, lower, Part("upper", Box(1, 1, 1), [offset, 0, 1.5])])


# poses ---------------------------------------------------------------------------------------


def random_pose(random: np.random.Generator) -> Pose:
    return Pose(random.normal(size=3), random.normal(size=4) * random.uniform(0.1, 10))


def test_the_product_of_poses_applies_the_right_one_first():
    random = np.random.default_rng(35)
    for _ in range(50):
        p, q = random_pose(random), random_pose(random)
        points = random.normal(size=(5, 3))
        assert np.allclose((p @ q).apply(points), p.apply(q.apply(points)), atol=1e-13)
        assert np.allclose(p.inverse().apply(p.apply(points)), points, atol=1e-13)
        both = p @ p.inverse()
        assert np.allclose(both.position, 0, atol=1e-13)
        assert np.allclose(both.matrix, np.eye(3), atol=1e-13)
        whole = np.eye(4)
        whole[:3, :3], whole[:3, 3] = p.matrix, p.position
        assert np.allclose(Pose.from_matrix(whole).apply(points), p.apply(points), atol=1e-13)


def test_a_pose_times_something_else_is_a_type_error():
    with pytest.raises(TypeError):
        Pose() @ [1, 2, 3]  # type: ignore[operator]


# equality and hashes --------------------------------------------------------------------------

VALUES: dict[str, Callable[[float], Any]] = {
    "Pose": lambda x: Pose([x, 0, 0]),
    "Box": lambda x: Box(x, 1, 1),
    "Cylinder": lambda x: Cylinder(x, 1),
    "Sphere": Sphere,
    "Prism": lambda x: Prism([[0, 0], [x, 0], [0, 1]], 1),
    "Mesh": lambda x: Mesh(np.array(CORNERS) * x, FACES),
    "Part": lambda x: Part("a", Box(x, 1, 1), center_of_mass=[0, 0, 0.1]),
    "mass": lambda x: Part("a", Box(1, 1, 1), mass=x),
    "Load": lambda x: Load("a", force=[x, 0, 0]),
    "Joint": lambda x: Joint(("a", "b"), "spherical", point=[x, 0, 0]),
    "Bond": lambda x: Bond(("a", "b"), pull=x),
    "FrictionPair": lambda x: FrictionPair(("a", "b"), x),
    "GivenContact": lambda x: GivenContact(("a", "b"), [[x, 0, 0]], [0, 0, 1]),
    "Feature": lambda x: Feature("face", [0, 1, 0], (0, x)),
    "Support": lambda x: kilter.Support("finger", "a", point=[x, 0, 0], direction=[0, 0, 1]),
    "Tolerance": lambda x: kilter.Tolerance(gap=x),
    "PlanRules": lambda x: kilter.PlanRules(hold=int(x)),
    "Assembly": stack,
}


@pytest.mark.parametrize("name", VALUES)
def test_equal_content_is_equal_and_hashes_alike(name):
    made = VALUES[name]
    first, second, other = made(1.0), made(1.0), made(2.0)
    assert first is not second
    assert first == second
    assert hash(first) == hash(second)
    assert first != other
    assert len({first, second, other}) == 2
    assert first != "text"
    assert pickle.loads(pickle.dumps(first)) == first


def test_every_scene_equals_itself_made_again_and_a_change_makes_another():
    for name in ("arch", "books", "ladder", "three-cylinders", "paper-figure-8"):
        first, second = scene(name), scene(name)
        assert first == second
        assert hash(first) == hash(second)
        assert first != first.with_friction(first.friction + 0.125)
        assert dataclasses.replace(first, source="elsewhere.json") == first


@pytest.mark.slow
def test_a_pickled_hash_is_that_of_another_process():
    code = (
        "import kilter; from kilter import *;"
        "print(hash(Part('a', Box(1, 2, 3), [0, 0, 1], density=2.5)))"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        for _ in range(2)
    }
    assert found == {f"{hash(Part('a', Box(1, 2, 3), [0, 0, 1], density=2.5))}\n"}


def test_zero_of_either_sign_is_the_same():
    assert Pose([0.0, 0, 0]) == Pose([-0.0, 0, 0])
    assert hash(Pose([0.0, 0, 0])) == hash(Pose([-0.0, 0, 0]))


# masses and boxes -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (Box(1, 2, 3), 6),
        (Cylinder(2, 3), 12 * np.pi),
        (Sphere(2), 32 / 3 * np.pi),
        (Prism([[0, 0], [4, 0], [4, 3]], 2), 12),
        (Mesh(CORNERS, FACES), 1 / 6),
    ],
    ids=lambda value: type(value).__name__,
)
@pytest.mark.parametrize(("units", "metres"), [("m", 1.0), ("mm", 1e-3), ("in", 0.0254)])
def test_the_mass_of_a_part_is_known(shape, volume, units, metres):
    part = Part("a", shape, density=7850)
    assert part.mass == pytest.approx(7850 * volume, rel=1e-12)
    assembly = Assembly([part, Part("b", shape, mass=2.5)], units=units)
    assert assembly["a"].mass == pytest.approx(7850 * volume * metres**3, rel=1e-12)
    assert assembly["a"].mass == assembly.geometry.mass[0]
    assert (assembly["b"].mass, assembly["b"].given_mass) == (2.5, 2.5)
    assert assembly["a"].given_mass is None
    assert part in assembly


def test_replace_keeps_what_was_given():
    given = dataclasses.replace(Part("a", Box(1, 1, 1), mass=3.0), grounded=True)
    assert (given.mass, given.given_mass, given.grounded) == (3.0, 3.0, True)
    assert dataclasses.replace(given, mass=4.0).mass == 4.0
    assert dataclasses.replace(given, mass=None).mass == 1000.0
    known = dataclasses.replace(Part("a", Box(1, 1, 1), density=2.0), shape=Box(2, 1, 1))
    assert (known.mass, known.given_mass) == (4.0, None)


def test_an_open_mesh_has_the_mass_of_its_hull_and_a_flat_one_has_none():
    assert Part("a", Mesh(CORNERS, FACES[:2])).mass == pytest.approx(1000 / 6, rel=1e-12)
    with pytest.raises(InputError) as caught:
        _ = Part("a", Mesh(CORNERS, FACES[:1])).mass
    assert "\n" not in str(caught.value)


def test_bounds_mass_and_centre_of_an_assembly():
    random = np.random.default_rng(1)
    ball = Part("ball", Sphere(2), [5, 0, 0], density=500)
    box = Part("box", Box(1, 1, 1), random_pose(random), mass=7)
    assembly = Assembly([ball, box])
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    world = box.pose.apply(corners)
    low = np.minimum([3, -2, -2], world.min(axis=0))
    high = np.maximum([7, 2, 2], world.max(axis=0))
    assert np.allclose(assembly.bounds, [low, high], atol=1e-12)
    heavy = 500 * 32 / 3 * np.pi
    assert assembly.mass == pytest.approx(heavy + 7, rel=1e-12)
    centre = (heavy * np.array([5, 0, 0]) + 7 * box.pose.position) / (heavy + 7)
    assert np.allclose(assembly.center_of_mass, centre, atol=1e-12)
    for array in (assembly.bounds, assembly.center_of_mass):
        assert not array.flags.writeable


# changed copies -------------------------------------------------------------------------------


def test_parts_are_added_removed_moved_and_renamed():
    assembly = stack()
    lid = Part("lid", Box(1, 1, 1), [0, 0, 2.5])
    assert (assembly + lid) == assembly.with_parts([lid])
    assert (assembly + lid).names == ("table", "lower", "upper", "lid")
    assert (assembly + lid).without("lid") == assembly
    moved = assembly.with_pose("upper", [0.2, 0, 1.5])
    assert moved == stack(0.2) == assembly.with_poses({"upper": Pose([0.2, 0, 1.5])})
    assert assembly == stack()
    with pytest.raises(TypeError):
        assembly + 1  # type: ignore[operator]
    with pytest.raises(InputError, match="did you mean 'upper'"):
        assembly.with_pose("uper", Pose())
    with pytest.raises(InputError, match="two parts are named 'upper'"):
        assembly + assembly["upper"]


def test_entries_follow_new_names():
    entries = {
        "friction_pairs": [FrictionPair(("table", "lower"), 0.5)],
        "loads": [Load("upper", force=[1, 0, 0])],
        "joints": [Joint(("lower", "ground"), "fixed")],
        "bonds": [Bond(("lower", "upper"), pull=3)],
    }
    assembly = dataclasses.replace(stack(), **entries)  # type: ignore[arg-type]
    swapped = assembly.renamed({"lower": "upper", "upper": "lower"})
    assert swapped.names == ("table", "upper", "lower")
    assert swapped.loads[0].part == "lower"
    assert swapped.bonds[0].parts == ("upper", "lower")
    assert swapped.joints[0].parts == ("upper", "ground")
    assert swapped.renamed({"lower": "upper", "upper": "lower"}) == assembly
    with pytest.raises(InputError, match="did you mean"):
        assembly.renamed({"lowr": "x"})


def test_assemblies_are_merged_with_a_prefix():
    assembly = stack().with_loads([Load("upper", force=[0, 0, -1])])
    both = assembly.merged(stack().with_poses({"table": [9, 0, -0.5]}), prefix="b/")
    assert both.names == ("table", "lower", "upper", "b/table", "b/lower", "b/upper")
    assert [load.part for load in both.loads] == ["upper"]
    assert both.without("b/*") == assembly
    with pytest.raises(InputError, match="both assemblies have a part named 'table'"):
        assembly.merged(assembly)
    with pytest.raises(InputError, match=r"differ in friction: 0\.0 and 0\.5"):
        assembly.merged(assembly.with_friction(0.5), prefix="b/")


@pytest.mark.slow
def test_an_assembly_is_shown_in_a_notebook():
    shown = stack().show(height=300)
    assert "height:300px" in shown._repr_html_()
    with pytest.raises(InputError, match="nothing is held"):
        Assembly([Part("a", Box(1, 1, 1))]).show()


# verbs ----------------------------------------------------------------------------------------

VERBS = {
    "check": "assembly",
    "check_many": "assemblies",
    "contacts": "assembly",
    "draw": "subject",
    "hold": "assembly",
    "margin": "assembly",
    "orient": "assembly",
    "plan": "assembly",
    "region": "assembly",
    "report": "assembly",
    "scene": "assembly",
    "settle": "assembly",
    "states": "assembly",
    "transport": "assembly",
}
"""Each verb, and the name of its first argument."""
EVERY = {"friction", "down", "ground", "floor", "progress"}
OTHER_DEFAULTS = {
    ("margin", "require"): "equilibrium",  # higher levels of limits cost a search
    ("plan", "require"): "equilibrium",  # the search for orders decides at this level
}
"""Defaults that differ from the table; the docstring of the verb states the reason."""
OTHER_MEANINGS = {("check_many", "progress")}  # it receives numbers of assemblies


def documented(function: Callable[..., Any]) -> dict[str, str]:
    """The text about each parameter in a docstring, without the type."""
    section = re.search(r"Parameters\n-{10}\n(.*?)\n\n", inspect.getdoc(function) or "", re.S)
    assert section is not None
    entries = re.findall(r"^(\S[^:\n]*)(?: : .*)?\n((?:    .*\n?)*)", section[1], re.M)
    return {
        name: re.sub(r"\s+", " ", text).strip()
        for names, text in entries
        for name in names.split(", ")
    }


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_the_keywords_of_the_table(verb):
    function = getattr(kilter, verb)
    parameters = inspect.signature(function).parameters
    assert next(iter(parameters)) == VERBS[verb]
    assert set(parameters) >= EVERY
    assert "tolerance" in parameters
    texts = documented(function)
    for name in set(parameters) & set(SHARED):
        default = OTHER_DEFAULTS.get((verb, name), SHARED[name].default)
        assert parameters[name].default == default, name
        assert parameters[name].kind is inspect.Parameter.KEYWORD_ONLY, name
        begins = SHARED[name].metadata["text"].split("; ")[0].split(". ")[0]
        if (verb, name) not in OTHER_MEANINGS:
            assert texts[name].startswith(begins), (name, texts[name])
    if verb == "check":
        assert set(parameters) >= set(SHARED)


@pytest.mark.slow
def test_the_shared_keywords_are_declared_in_one_place():
    declaring = set()
    for path in Path(kilter.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                names = {each.arg for each in [*node.args.args, *node.args.kwonlyargs]}
                declaring |= {node.name} if len(names & set(SHARED)) >= 4 else set()
    assert not declaring


def test_no_other_function_takes_the_keywords():
    """A new verb must join the list above; `load` reads a file with its options.

    `place` takes a part too; `check_plan` makes its assembly itself.
    """
    functions = {name for name in kilter.__all__ if inspect.isfunction(getattr(kilter, name))}
    taking = {
        name
        for name in functions
        if {"friction", "floor"} & set(inspect.signature(getattr(kilter, name)).parameters)
    }
    assert taking - {"load", "place", "check_plan"} == set(VERBS)


def loose_stack() -> Assembly:
    held = [dataclasses.replace(part, grounded=False) for part in stack(0.2)]
    return dataclasses.replace(stack(), parts=held)


def content_of(answer: Any) -> Any:
    """Content of an answer that is equal for equal questions."""
    if isinstance(answer, kilter.Report):
        return answer.verdict
    if isinstance(answer, kilter.States):
        return answer.assembly
    if hasattr(answer, "savefig"):
        return [text.get_text() for axes in answer.axes for text in axes.texts]
    if isinstance(answer, kilter.Verdicts):
        return [content_of(verdict) for verdict in answer]
    return {key: value for key, value in answer.to_dict().items() if key != "seconds"}


@pytest.mark.quick("contacts", "states")
@pytest.mark.parametrize("verb", VERBS)
def test_keywords_and_paths_are_the_same_as_a_changed_assembly(verb, tmp_path):
    if verb == "draw":
        pytest.importorskip("matplotlib")
    loose = loose_stack()
    path = tmp_path / "stack.kilter.json"
    kilter.dump(loose, path)
    changed = loose.with_friction(0.6).with_grounded("table")
    keywords: dict[str, Any] = {"friction": 0.6, "down": [0.1, 0, -1], "ground": "table"}
    if verb not in ("plan", "states", "hold"):
        note = "the floor lies across the up direction of the file, (0, 0, 1), and turns with the "
        note += "parts: gravity is oblique to it"
        changed = dataclasses.replace(changed.with_floor(), notes=[note])
        keywords["floor"] = True
    changed = changed.with_down([0.1, 0, -1])
    function = getattr(kilter, verb)
    if verb == "check_many":
        asked = function([loose, path, str(path)], **keywords)
        by_hand = function([changed] * 3)
        assert content_of(asked) == content_of(by_hand)
        return
    by_hand = content_of(function(changed))
    for given in (loose, path, str(path)):
        assert content_of(function(given, **keywords)) == by_hand


@pytest.mark.slow
def test_bricks_have_the_keywords_too(tmp_path):
    path = tmp_path / "bricks.txt"
    path.write_text("4x2 (0,0,0)\n4x2 (2,0,1)\n2x2 (5,0,2)\n", "utf-8")
    bricks = kilter.load(path)
    changed = bricks.with_friction(0.3).with_down([0.05, 0, -1])
    expected = content_of(kilter.margin(changed, improve=True))
    assert expected != content_of(kilter.margin(bricks, improve=True))
    for given in (bricks, path):
        asked = kilter.margin(given, improve=True, friction=0.3, down=[0.05, 0, -1])
        assert content_of(asked) == expected


@pytest.mark.parametrize("change", [{"friction": 0.1}, {"down": [0, 0, -1]}, {"ground": "table"},
                                    {"floor": True}])  # fmt: skip
def test_a_complete_answer_rejects_changes_of_its_assembly(change):
    pytest.importorskip("matplotlib")
    [name] = change
    order = kilter.plan(stack(0.2))
    with pytest.raises(InputError, match=f"^{name} changes an assembly, but the type is Order"):
        kilter.report(order, **change)
    with pytest.raises(InputError, match=f"^{name} changes an assembly, but the type is Verdict"):
        kilter.draw(kilter.check(stack(0.2)), **change)


def test_wrong_elements_of_many_are_one_sentence(tmp_path):
    for given, words in (
        (["gone.json"], "gone.json: no such file"),
        ([stack(), 3], "assembly 1 is of type int"),
        (stack(), "check_many got a single assembly"),
        ("stack.json", "check_many got a single assembly"),
    ):
        with pytest.raises(InputError, match=words) as caught:
            kilter.check_many(given)  # type: ignore[arg-type]
        assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="assembly 1: no part is named 'lid'"):
        kilter.check_many([stack() + Part("lid", Box(1, 1, 1)), stack()], ground="lid")
    corners = np.array(CORNERS, dtype=float)
    arrays = kilter.AssemblyArrays(corners, FACES, [0, 4], [0, 4], [0, 1], [True])
    with pytest.raises(InputError, match="friction changes an assembly"):
        kilter.check_many(arrays, friction=0.5)


def test_contacts_and_a_keyword_that_changes_them_are_refused():
    found = kilter.contacts(stack())
    with pytest.raises(InputError, match="check got contacts and friction"):
        kilter.check(stack(), contacts=found, friction=0.5)
    assert kilter.check(stack(), contacts=found, down=[0, 0, -1]).verdict == "unstable"


# answers --------------------------------------------------------------------------------------


def test_parts_of_a_verdict_have_names():
    verdict = kilter.check(stack())
    upper = verdict["upper"]
    assert (upper.moves, upper.motion) == (True, verdict.words("upper"))
    assert upper.acceleration is not None
    assert upper.displacement is not None
    assert np.array_equal(upper.acceleration, verdict.motion.acceleration[2])
    assert np.array_equal(upper.displacement, verdict.displacement.displacement[2])
    assert not upper.acceleration.flags.writeable
    assert [part.name for part in verdict.parts] == ["table", "lower", "upper"]
    assert [part.name for part in verdict.parts if part.moves] == verdict.moving == ["upper"]
    with pytest.raises(InputError, match="did you mean 'upper'"):
        verdict["uper"]


def test_the_word_of_a_verdict_is_an_enumeration_equal_to_its_text():
    word = kilter.check(stack()).verdict
    assert isinstance(word, kilter.VerdictWord)
    assert word is kilter.VerdictWord.UNSTABLE
    assert word == "unstable"
    assert f"{word}" == "unstable"
    assert json.dumps(word) == '"unstable"'


def test_forces_between_parts_and_on_a_part():
    verdict = kilter.check(stack(0.2))
    forces = verdict.forces
    assert forces is not None
    weight = 9.81 * 1000
    down = forces.between("upper", "lower")
    up = forces.between("lower", "upper")
    assert np.allclose(up.resultant, [0, 0, weight], rtol=1e-9, atol=1e-6)
    assert np.allclose(down.resultant, -up.resultant, atol=1e-9)
    assert up.center is not None
    assert np.allclose(up.center, [0.2, 0, 1], atol=1e-9)  # below the centre of mass
    assert np.allclose(up.moment([0.2, 0, 1.5]), 0, atol=1e-6)
    assert np.allclose(up.moment([0, 0, 0]), np.cross([0.2, 0, 1], up.resultant), atol=1e-6)
    both = forces.on("lower")
    assert np.allclose(both.resultant, [0, 0, weight], rtol=1e-9, atol=1e-6)
    assert len(both) == len(up) + len(forces.between("table", "lower"))
    apart = forces.between("table", "upper")
    assert (len(apart), apart.center) == (0, None)
    assert not apart.resultant.any()
    with pytest.raises(InputError, match="did you mean 'lower'"):
        forces.on("lowr")


@pytest.mark.quick(2)
@pytest.mark.parametrize("verb", ["check", "region", "orient", "margin", "plan", "hold"])
def test_answers_travel_as_text_and_as_files(verb, tmp_path):
    answer = getattr(kilter, verb)(stack(0.2))
    text = answer.to_json()
    file = tmp_path / "answer.json"
    file.write_text(text, encoding="utf-8")
    for source in (text, file, str(file), answer.to_json(indent=None)):
        loaded = kilter.load_answer(source)
        assert loaded.answer == verb
        assert loaded.to_dict() == answer.to_dict()
        assert {"answer", "schema", *answer.to_dict()} <= set(dir(loaded))  # as notebooks complete
    if verb == "check":
        assert loaded.verdict == answer.verdict == loaded["verdict"]
        assert loaded.part("upper")["moves"] is answer["upper"].moves
        with pytest.raises(InputError, match="did you mean 'upper'"):
            loaded.part("uper")
        with pytest.raises(AttributeError, match="no key 'verdit'"):
            loaded.verdit  # noqa: B018


@pytest.mark.quick(3)
@pytest.mark.parametrize(
    "verb",
    [
        "check",
        "contacts",
        "region",
        "orient",
        "margin",
        "transport",
        "plan",
        "hold",
        "scene",
        "settle",
    ],
)
def test_the_sentence_of_an_answer_is_the_first_line_of_its_command(verb, tmp_path, capsys):
    kilter.dump(stack(0.2), tmp_path / "stack.kilter.json")
    main([verb, str(tmp_path / "stack.kilter.json")])
    printed = " ".join(capsys.readouterr().out.split())
    sentence = getattr(kilter, verb)(stack(0.2)).sentence
    assert len(sentence) > 20
    assert printed.startswith(" ".join(sentence.split()))


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("{", "not JSON"),
        ('{"verdict": "stable"}', 'no keys "answer" and "schema"'),
        ('{"answer": "check", "schema": 1000}', "version 1000 of the answer is unknown"),
        ("missing.json", "cannot be read"),
    ],
)
def test_what_is_no_answer_gets_one_sentence(source, words):
    with pytest.raises(InputError, match=words) as caught:
        kilter.load_answer(source)
    assert "\n" not in str(caught.value)


def test_contacts_are_patches_and_a_graph():
    found = kilter.contacts(stack(0.25))
    patches = list(found)
    assert len(patches) == len(found) == 2
    assert {patch.parts for patch in patches} == {("table", "lower"), ("lower", "upper")}
    for patch, row in zip(patches, found.to_dict()["patches"], strict=True):
        assert patch.points.tolist() == row["points"]
        assert (patch.area, patch.kind, patch.mu) == (row["area"], row["kind"], row["mu"])
    assert found[-1].parts == patches[-1].parts
    with pytest.raises(IndexError):
        found[2]
    graph = found.graph()
    assert sorted(graph.edges) == [("lower", "upper"), ("table", "lower")]
    assert graph.edges["lower", "upper"]["area"] == pytest.approx(0.75, rel=1e-12)
    assert graph.nodes["table"]["grounded"] is True


def test_a_graph_without_networkx_gets_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "networkx", None)
    with pytest.raises(InputError, match=r"kilter\[graph\]"):
        kilter.contacts(stack()).graph()


def test_no_is_an_answer_of_a_plan():
    order = kilter.plan(stack(0.6))
    assert (order.found, order.verdict) == (False, "impossible")


PAGE = (Path(__file__).resolve().parents[1] / "docs" / "tutorials/python.md").read_text(
    encoding="utf-8"
)
SNIPPETS = "\n".join(re.findall(r"```python\n(.*?)```", PAGE, re.S))


@pytest.mark.slow
@pytest.mark.parametrize(
    "checker",
    [["mypy", "--strict"], ["basedpyright", "--pythonpath", sys.executable]],
    ids=lambda c: c[0],
)
def test_a_type_checker_accepts_the_python_page(checker, tmp_path):
    def judge(text: str) -> subprocess.CompletedProcess[str]:
        (tmp_path / "snippets.py").write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", *checker, "snippets.py"]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)

    if find_spec(checker[0]) is None:
        pytest.skip(f"{checker[0]} is not installed")
    # the rules of pyright, without those that only basedpyright has
    settings = '{"typeCheckingMode": "standard"}'
    (tmp_path / "pyrightconfig.json").write_text(settings, encoding="utf-8")
    done = judge(SNIPPETS)
    assert done.returncode == 0, done.stdout
    assert judge(SNIPPETS + "\nverdict.stabel\n").returncode == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["kilter", "verdict", "stack", "forces", "pressed", "patch"])
def test_an_editor_completes_the_names_of_the_python_page(name):
    """Each attribute that the page shows is among the completions that jedi lists."""
    jedi = pytest.importorskip("jedi", reason="jedi is not installed")
    shown = set(re.findall(rf"(?<![\w.]){name}\.(\w+)", SNIPPETS))
    text = f"{SNIPPETS}\n{name}."
    listed = jedi.Script(text).complete(text.count("\n") + 1, len(name) + 1)
    assert shown
    assert shown <= {completion.name for completion in listed}
