"""Tools for agents without a server: answers, their size, errors, and the start folder."""

import json
import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter import Assembly, Box, Part
from kilter.agents.short_answers import LIMIT
from kilter.agents.tool_calls import ASK, POSED, Called, ToolCalls
from kilter.agents.tool_schemas import TOOLS

TABLE = Part("table", Box([40, 40, 1]), [0, 0, -0.5], grounded=True)


@pytest.fixture
def calls(tmp_path: Path) -> ToolCalls:
    (tmp_path / "start").mkdir()
    return ToolCalls(tmp_path / "start")


def answer(called: Called) -> dict[str, Any]:
    assert not called.failed, called.text
    found: dict[str, Any] = json.loads(called.text)
    return found


def error(called: Called) -> str:
    assert called.failed
    assert "\n" not in called.text
    assert "Traceback" not in called.text
    return called.text


def test_every_tool_has_a_question_and_a_short_schema():
    assert {tool.name for tool in TOOLS} == {*ASK, *POSED, "draw", "example"}
    for tool in TOOLS:
        assert len(json.dumps(tool.schema)) < 1500
        assert len(tool.description) < 130
        names = set(tool.options) - {"at", "box", "mass", "turn", "what", "view", "name", "output"}
        if tool.name in {*ASK, *POSED} - {"place"}:
            import inspect

            assert names <= set(inspect.signature(getattr(kilter, tool.name)).parameters)


def test_the_example_is_written_once_and_checked(calls):
    text = calls.call("example", {"name": "paper-figure-8"}).text
    assert text.startswith("paper-figure-8.kilter.json: ")
    assert not calls.call("example", {"name": "paper-figure-8"}).failed
    (calls.folder / "paper-figure-8.kilter.json").write_text("{}")
    assert "already exists" in error(calls.call("example", {"name": "paper-figure-8"}))
    assert len(calls.call("example", {}).text.encode()) <= LIMIT


def test_a_check_names_the_moving_parts_and_the_whole_answer(calls):
    calls.call("example", {"name": "paper-figure-8"})
    short = answer(calls.call("check", {"file": "paper-figure-8.kilter.json"}))
    assert short["verdict"] == "unstable"
    assert [entry["part"] for entry in short["moving"]] == ["C2", "C3"]
    whole = json.loads(calls.answers[short["complete"]])
    expected = kilter.check(kilter.example("paper-figure-8")).to_dict()
    assert whole["z"] == expected["z"]
    assert "seconds" not in whole


@pytest.mark.quick("check", "scene")
@pytest.mark.parametrize("verb", sorted({*ASK, *POSED}))
def test_equal_questions_have_equal_answers(verb, calls):
    kilter.dump(kilter.example("tower"), calls.folder / "t.kilter.json")
    given: dict[str, Any] = {"file": "t.kilter.json"}
    if verb == "place":
        given |= {"box": [0.5, 0.5, 0.5], "mass": 1, "at": [0.1, 0]}
    first, second = calls.call(verb, given), ToolCalls(calls.folder).call(verb, given)
    assert first.text == second.text
    assert len(first.text.encode()) <= LIMIT
    assert str(calls.folder) not in first.text + "".join(calls.answers.values())
    answer(first)


@pytest.mark.quick(1)
@pytest.mark.parametrize("verb", ["check", "contacts", "scene"])
def test_a_large_answer_is_cut_with_its_counts(verb, calls):
    parts = [
        Part(
            f"a cube with a long name {k}",
            Box([1, 1, 1]),
            [1.5 * (k % 20) - 15, 1.5 * (k // 20), 0.5 + (k % 3)],
        )
        for k in range(200)
    ]
    kilter.dump(Assembly([TABLE, *parts]), calls.folder / "many.kilter.json")
    called = calls.call(verb, {"file": "many.kilter.json"})
    assert len(called.text.encode()) <= LIMIT
    short = answer(called)
    whole = json.loads(calls.answers[short["complete"]])
    key = {"check": "moving", "contacts": "patches", "scene": "objects"}[verb]
    of = len(whole["objects"]) if verb == "scene" else None
    assert short["left_out"][key] > 0
    if of is not None:
        assert short["left_out"][key] + len(short[key]) == of
        assert short[key][0]["state"] == "floats"  # faults first


def test_a_scene_answer_has_the_faults_first(calls):
    cube = Part("a", Box([1, 1, 1]), [0, 0, 0.5])
    kilter.dump(
        Assembly([TABLE, cube, replace(cube, name="b", pose=kilter.Pose([3, 0, 1.5]))]),
        calls.folder / "s.kilter.json",
    )
    short = answer(calls.call("scene", {"file": "s.kilter.json"}))
    assert short["objects"][0] == {
        "name": "b", "state": "floats", "gap": 1.0, "other": "table", "move": [3.0, 0.0, 0.5],
    }  # fmt: skip


def test_options_change_the_question(calls):
    kilter.dump(kilter.example("slope"), calls.folder / "s.kilter.json")
    falls = answer(calls.call("check", {"file": "s.kilter.json", "friction": 0.0}))
    stands = answer(calls.call("check", {"file": "s.kilter.json", "friction": 2.0}))
    assert (falls["verdict"], stands["verdict"]) == ("unstable", "stable")
    loose = Assembly([replace(part, grounded=False) for part in kilter.example("tower")])
    kilter.dump(loose, calls.folder / "loose.kilter.json")
    assert "nothing is held" in error(calls.call("check", {"file": "loose.kilter.json"}))
    for held in ({"floor": True}, {"ground": ["*1"]}):
        assert answer(calls.call("check", {"file": "loose.kilter.json", **held}))
    both = {"file": "loose.kilter.json", "floor": True, "fasten": [list(loose.names[:2])]}
    assert answer(calls.call("check", both))["verdict"] == "stable"


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        ("chek", {}, "there is no tool 'chek'; did you mean 'check'"),
        ("check", {}, "check needs the argument 'file'"),
        ("check", {"fle": "a"}, "no argument 'fle'; did you mean 'file'"),
        ("check", {"file": 3}, "file is 3; give string"),
        ("check", {"file": "a.json", "down": [1, 2]}, "give a list of 3"),
        ("check", {"file": "a.json", "friction": True}, "friction is True"),
        ("check", {"file": "a.json", "require": "safe"}, "give one of equilibrium"),
        ("check", {"file": "-"}, "give a path below the start folder"),
        ("check", {"file": ""}, "give a path below the start folder"),
        ("check", {"file": "none.json"}, "none.json: no such file"),
        ("example", {"name": "towr"}, "tower"),
        ("place", {"file": "t.kilter.json"}, "the box is not given"),
    ],
)  # fmt: skip
def test_wrong_calls_are_one_sentence(name, given, words, calls):
    kilter.dump(kilter.example("tower"), calls.folder / "t.kilter.json")
    assert words in error(calls.call(name, given))


# the start folder -----------------------------------------------------------------------------


OUTSIDE = "outside of the start folder"
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def refused(calls: ToolCalls, file: str) -> None:
    for tool in ("check", "scene", "draw"):
        text = error(calls.call(tool, {"file": file, "floor": True}))
        assert OUTSIDE in text or "leads out of the folder" in text, text


def test_paths_out_of_the_folder_are_refused(calls):
    kilter.dump(kilter.example("tower"), calls.folder.parent / "t.kilter.json")
    (calls.folder / "sub").mkdir()
    whole = str(calls.folder.parent / "t.kilter.json")
    for file in ("../t.kilter.json", "sub/../../t.kilter.json", whole, "/etc/passwd", ".."):
        refused(calls, file)
    kilter.dump(kilter.example("tower"), calls.folder / "in.kilter.json")
    assert answer(calls.call("check", {"file": "../start/sub/../in.kilter.json"}))


def test_a_neighbour_with_the_same_beginning_is_outside(calls):
    (calls.folder.parent / "start2").mkdir()
    kilter.dump(kilter.example("tower"), calls.folder.parent / "start2" / "t.kilter.json")
    refused(calls, "../start2/t.kilter.json")


def test_symbolic_links_out_of_the_folder_are_refused(calls):
    kilter.dump(kilter.example("tower"), calls.folder.parent / "t.kilter.json")
    os.symlink(calls.folder.parent / "t.kilter.json", calls.folder / "link.kilter.json")
    os.symlink(calls.folder.parent, calls.folder / "up")
    refused(calls, "link.kilter.json")
    refused(calls, "up/t.kilter.json")
    (calls.folder / "meshes").mkdir()
    (calls.folder.parent / "a.obj").write_text(OBJ)
    os.symlink(calls.folder.parent / "a.obj", calls.folder / "meshes" / "a.obj")
    refused(calls, "meshes")


def test_a_link_within_the_folder_is_read(calls):
    kilter.dump(kilter.example("tower"), calls.folder / "t.kilter.json")
    os.symlink("t.kilter.json", calls.folder / "link.kilter.json")
    assert answer(calls.call("check", {"file": "link.kilter.json"}))["verdict"] == "stable"


def test_files_that_a_file_names_are_refused(calls):
    (calls.folder.parent / "a.obj").write_text(OBJ)
    os.symlink(calls.folder.parent / "a.obj", calls.folder / "link.obj")
    for k, mesh in enumerate(("../a.obj", "link.obj")):
        part = {"name": "a", "mesh": mesh}
        (calls.folder / f"{k}.kilter.json").write_text(json.dumps({"kilter": 1, "parts": [part]}))
        refused(calls, f"{k}.kilter.json")
    kilter.dump(kilter.example("tower"), calls.folder.parent / "t.kilter.json")
    choices = {"kilter": 1, "file": "../t.kilter.json"}
    (calls.folder / "c.kilter.json").write_text(json.dumps(choices))
    assert calls.call("check", {"file": "c.kilter.json"}).failed


def test_meshes_and_includes_of_urdf_and_mjcf_are_refused(calls):
    (calls.folder.parent / "a.obj").write_text(OBJ)
    (calls.folder / "sub").mkdir()
    for name in ("../../a.obj", f"file://{calls.folder.parent}/a.obj", "package://a.obj"):
        geometry = f'<geometry><mesh filename="{name}"/></geometry>'
        text = f'<robot name="r"><link name="l"><collision>{geometry}</collision></link></robot>'
        (calls.folder / "sub" / "r.urdf").write_text(text)
        assert calls.call("check", {"file": "sub/r.urdf"}).failed
    pytest.importorskip("mujoco", reason="mujoco is not installed: pip install 'kilter[mujoco]'")
    mesh = '<asset><mesh name="m" file="a.obj"/></asset>'
    geom = '<worldbody><body name="b"><geom type="mesh" mesh="m"/></body></worldbody>'
    outside = calls.folder.parent
    (outside / "s.xml").write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    scenes = {
        "up": f'<mujoco><asset><mesh name="m" file="../a.obj"/></asset>{geom}</mujoco>',
        "dir": f'<mujoco><compiler meshdir=".."/>{mesh}{geom}</mujoco>',
        "whole": f'<mujoco><asset><mesh name="m" file="{outside}/a.obj"/></asset>{geom}</mujoco>',
        "include": '<mujoco><include file="../s.xml"/></mujoco>',
        "again": '<mujoco><include file="inner.xml"/></mujoco>',
    }
    (calls.folder / "inner.xml").write_text('<mujoco><include file="../s.xml"/></mujoco>')
    for name, text in scenes.items():
        (calls.folder / f"{name}.xml").write_text(text)
        refused(calls, f"{name}.xml")
    (calls.folder / "a.obj").write_text(OBJ)
    text = f"<mujoco>{mesh}{geom}</mujoco>"
    (calls.folder / "good.xml").write_text(text)
    answer(calls.call("contacts", {"file": "good.xml"}))


def test_layers_of_usd_are_refused(calls):
    pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")
    cube = '#usda 1.0\ndef Cube "a" {\n}\n'
    (calls.folder.parent / "o.usda").write_text(cube)
    (calls.folder / "in.usda").write_text(cube)
    layers = {
        "sub": "#usda 1.0\n(\n subLayers = [@{}@]\n)\n",
        "ref": '#usda 1.0\ndef "a" (references = @{}@</a>) {{\n}}\n',
        "load": '#usda 1.0\ndef "a" (payload = @{}@</a>) {{\n}}\n',
    }
    for name, text in layers.items():
        (calls.folder / f"{name}.usda").write_text(text.format("../o.usda"))
        refused(calls, f"{name}.usda")
        (calls.folder / f"{name}2.usda").write_text(text.format(f"./{name}.usda"))
        refused(calls, f"{name}2.usda")
        (calls.folder / f"{name}3.usda").write_text(text.format("./in.usda"))
        answer(calls.call("contacts", {"file": f"{name}3.usda"}))


def test_reading_elsewhere_is_free_after_a_call(calls):
    kilter.dump(kilter.example("tower"), calls.folder.parent / "t.kilter.json")
    refused(calls, "../t.kilter.json")
    assert len(kilter.load(calls.folder.parent / "t.kilter.json")) > 0


@pytest.mark.slow
def test_a_picture_is_png_and_the_same_twice(calls):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    kilter.dump(kilter.example("paper-figure-8"), calls.folder / "f.kilter.json")
    first = calls.call("draw", {"file": "f.kilter.json"})
    assert first.image is not None
    assert first.image.startswith(b"\x89PNG")
    assert first.image == calls.call("draw", {"file": "f.kilter.json"}).image
    turned = calls.call("draw", {"file": "f.kilter.json", "view": [80, 10]})
    assert turned.image != first.image


# faults ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("error_", "said"),
    [
        (
            ZeroDivisionError("a\x1b[8m\ud800"),
            r"a fault of kilter itself: ZeroDivisionError: a\\x1b",
        ),
        (RecursionError("deep"), "'kilter check tower.kilter.json'.*exit code 70"),
        (MemoryError(), "not enough memory"),
    ],
)
def test_an_unexpected_exception_is_the_sentence_of_the_command(error_, said, calls, monkeypatch):
    def broken(*_: Any) -> None:
        raise error_

    kilter.dump(kilter.example("tower"), calls.folder / "tower.kilter.json")
    monkeypatch.setitem(ASK, "check", broken)
    words = error(calls.call("check", {"file": "tower.kilter.json"}))
    assert re.search(said, words)
    assert words.isprintable()
    monkeypatch.undo()
    assert answer(calls.call("check", {"file": "tower.kilter.json"}))["verdict"] == "stable"


@pytest.mark.parametrize("name", ["x" * 4000, "x" * 300 + ".step", "a\0b", "\ud800.step", "\udce9"])
def test_a_name_that_the_system_rejects_is_a_sentence(name, calls):
    words = error(calls.call("check", {"file": name}))
    assert "fault of kilter" not in words
    assert len(words) < 400


# new poses ------------------------------------------------------------------------------------


@pytest.mark.parametrize("tool", ["scene", "settle"])
def test_a_new_pose_is_a_new_file(tool, calls):
    sunk = Part("a", Box([1, 1, 1]), [0, 0, 0.495])
    kilter.dump(Assembly([TABLE, sunk]), calls.folder / "s.kilter.json")
    given: dict[str, Any] = {"file": "s.kilter.json", "output": "rest.kilter.json"}
    if tool == "scene":
        assert "give settle: true" in error(calls.call(tool, given))
        given["settle"] = True
    assert answer(calls.call(tool, given))["sentence"]
    assert kilter.check(calls.folder / "rest.kilter.json").verdict == "stable"
    assert "already exists" in error(calls.call(tool, given))
    assert OUTSIDE in error(calls.call(tool, given | {"output": "../rest.kilter.json"}))
    assert "no format of a pose" in error(calls.call(tool, given | {"output": "rest.py"}))


def test_no_pose_at_rest_writes_nothing(calls):
    block = Part("a", Box([1, 1, 1]), [20.6, 0, 0.5])
    kilter.dump(Assembly([TABLE, block]), calls.folder / "s.kilter.json")
    given = {"file": "s.kilter.json", "output": "rest.kilter.json"}
    assert "no pose at rest" in error(calls.call("settle", given))
    assert not (calls.folder / "rest.kilter.json").exists()
