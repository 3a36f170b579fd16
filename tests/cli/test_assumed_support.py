"""Files that hold no part stand on an assumed floor, and files without a unit have an assumed one.

Answer, proof and next command state what is assumed.
"""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import kilter
from kilter import Assembly, Box, InputError, Part
from kilter.files.reading import Reading
from kilter.tell.text import text_of

NOTE = "assumed: a floor under it; --ground NAME holds a part instead"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def stack(x: float, name: str = "s.obj", *, small: tuple[float, float, float] = (1, 1, 1)) -> str:
    """Write a box of 1 x 1 x 2 on a box that may be smaller, with its centre at x."""
    lower = trimesh.creation.box(small)
    upper = trimesh.creation.box((1, 1, 2))
    upper.apply_translation([x, 0, small[2] / 2 + 1])
    trimesh.Scene({"low": lower, "up": upper}).export(name)
    return name


@pytest.mark.parametrize(("x", "verdict"), [(0.49, "stable"), (0.51, "unstable")])
def test_a_drawing_stands_on_an_assumed_floor(x, verdict):
    answer = kilter.check(stack(x))
    data = answer.to_dict()
    assert (data["verdict"], data["assumed"]) == (verdict, ["units", "floor"])
    assert data["warnings"].count(NOTE) == 1
    assert [part["name"] for part in data["parts"] if part["grounded"]] == ["floor"]
    np.testing.assert_allclose(data["size"], [0.5 + x + 0.5, 1, 3], atol=1e-12)
    Path("p.json").write_text(json.dumps(answer.proof()))
    assert kilter.verify("s.obj", "p.json").holds
    assert json.loads(Path("p.json").read_text())["options"] == {"units": "m", "floor": "lowest"}
    loaded = kilter.load("s.obj")
    assert (loaded.names, loaded.notes) == (("low", "up"), ())
    assert kilter.check(loaded).verdict == verdict


def test_only_files_that_state_held_parts_and_a_refused_floor_are_errors(say):
    loose = Assembly([Part("cube", Box(1, 1, 1)), Part("large", Box(1, 1, 2), [0, 0, 1.5])])
    kilter.dump(loose, "loose.kilter.json")
    stack(0.2)
    for words in ("loose.kilter.json", "s.obj --no-floor", "s.obj --off floor"):
        code, _, err = say(f"check {words}")
        assert code == 2, words
        assert "nothing is held" in err
        assert "hold a part with --ground" in err
    for act in (lambda: kilter.check("s.obj", floor=False), lambda: kilter.check(loose)):
        with pytest.raises(InputError, match="nothing is held"):
            act()
    assert kilter.check("s.obj", ground="low").to_dict()["assumed"] == ["units"]


def test_a_saved_choice_keeps_no_assumed_floor(say):
    stack(0.2)
    assert say("save s.obj -o c.json")[0] == 0
    assert "floor" not in json.loads(Path("c.json").read_text())
    assert say("check c.json")[0] == 0
    assert say("check c.json --no-floor")[0] == 2


@pytest.mark.parametrize("verb", ["orient", "region"])
def test_questions_about_all_directions_hold_the_largest_part(verb, say):
    stack(0, small=(2, 2, 0.4))
    code, out, err = say(f"{verb} s.obj --json" + " --proof p.json" * (verb == "region"))
    assert code == 0, err
    answer = json.loads(out)
    assert answer["assumed"] == ["units", "ground"]
    held = "assumed: 'up' is held, the largest part; --ground NAME holds another part instead"
    assert answer["warnings"].count(held) == 1
    if verb == "region":
        assert say("verify s.obj p.json")[0] == 0


def test_hold_and_contacts_assume_no_floor_and_the_next_step_names_it(say):
    stack(0.51)
    code, out, _ = say("hold s.obj --json")
    assert code == 0
    assert "floor" not in json.loads(out)["base"]
    assert [patch["parts"] for patch in json.loads(say("contacts s.obj --json")[1])["patches"]] == [
        ["low", "up"]
    ]
    assert "next: kilter hold s.obj --floor" in say("transport s.obj")[1]


def test_an_assumed_floor_lies_across_the_up_direction_of_the_file():
    stack(0.2)
    for options in ({"down": [0.1, 0, -1]}, {"up": "y"}, {"up": "-x"}):
        assumed = kilter.check(kilter.load("s.obj", **options))
        stated = kilter.check(kilter.load("s.obj", floor=True, **options))
        assert assumed.assembly.parts == stated.assembly.parts
        assert assumed.verdict == stated.verdict
        np.testing.assert_array_equal(assumed.assembly.gravity, stated.assembly.gravity)


@pytest.mark.slow
@pytest.mark.parametrize("verb", ["plan", "margin", "transport", "settle"])
def test_proofs_of_other_commands_state_the_floor(verb, say):
    stack(0.2 if verb != "settle" else 0.8)
    code, _, err = say(f"{verb} s.obj --friction 0.4 --proof p.json")
    assert code in (0, 3), err
    assert NOTE in err
    code, out, _ = say("verify s.obj p.json")
    assert code == 0, out
    assert "floor lowest" in out


def test_a_scene_of_a_simulator_without_a_static_body_has_a_floor(say):
    body = '<body pos="0 0 {}"><freejoint/><geom type="box" size=".1 .1 .1"/></body>'
    bodies = body.format(0.1) + body.format(0.3)
    Path("s.xml").write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    code, out, err = say("scene s.xml --json")
    assert code == 0, err
    assert json.loads(out)["assumed"] == ["floor"]


@pytest.mark.parametrize(
    ("files", "units"), [("b.stl", "mm"), ("b.obj", "m"), ("stl", "mm"), ("both", "m")]
)
def test_the_unit_of_a_file_that_states_none(files, units):
    cube = trimesh.creation.box((120, 80, 40))
    for name in ("b.stl", "b.obj", "stl/a.stl", "both/a.stl", "both/b.obj"):
        Path(name).parent.mkdir(exist_ok=True)
        cube.export(name)
    without = "b" if files == "both" else ()
    answer = kilter.check(kilter.load(files, without=without))
    assert (answer.units, "units" in answer.assumed) == (units, True)
    metre = {"mm": 1e-3, "m": 1.0}[units]
    assert answer.parts[0].mass == pytest.approx(1000 * 120 * 80 * 40 * metre**3, rel=1e-6)
    other = "m" if units == "mm" else "mm"
    words = text_of(answer.to_dict(), brief=False)
    assert f"size 120 x 80 x 40 {units}, units assumed; --units {other}" in words
    stated = kilter.check(kilter.load(files, without=without, units=units))
    assert "units" not in stated.assumed
    assert "units assumed" not in text_of(stated.to_dict(), brief=False)


def test_a_mesh_of_a_kilter_file_has_the_unit_of_this_file():
    trimesh.creation.box((3, 2, 1)).export("b.stl")
    data = {"kilter": 1, "units": "cm", "parts": [{"name": "b", "mesh": "b.stl", "grounded": True}]}
    Path("b.kilter.json").write_text(json.dumps(data))
    assembly = kilter.load("b.kilter.json")
    assert (assembly.units, assembly.size.tolist()) == ("cm", [3, 2, 1])
    assert dict(assembly.assumed) == {}


def test_the_size_is_that_of_the_free_parts_with_their_round_surfaces():
    ball = Part("ball", kilter.Sphere(0.5), [0, 0, 0.5])
    block = Part("block", Box(1, 2, 1), [3, 0, 0.5])
    table = Part("table", Box(20, 20, 1), [0, 0, -0.5], grounded=True)
    answer = kilter.check(Assembly([table, ball, block]), require="equilibrium")
    np.testing.assert_allclose(answer.size, [4, 2, 1], atol=1e-12)
    np.testing.assert_allclose(Assembly([table]).size, [20, 20, 1], atol=1e-12)


def test_the_options_of_a_reading_without_a_floor_are_read_again():
    reading = Reading(off=("floor",))
    assert Reading.from_options(reading.options()) == reading


def test_saved_joints_may_name_the_assumed_floor(say):
    stack(0.3)
    code, _, error = say("check s.obj --fasten low flor")
    assert (code, "did you mean 'floor'?" in error) == (2, True)
    assert say("save s.obj --fasten low floor -o s.json")[0] == 0
    code, out, error = say("check s.json")
    assert (code, out.split(":")[0]) == (0, "Stable")
    assert "do not exist" not in error
