"""Saved choices: the same answers as the options, and a sentence for each wrong file."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from free_form import tower

import kilter
from kilter import Assembly, Box, Choices, InputError, Part, Pose
from kilter.files.reading import Reading

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def timeless(answer: Any) -> Any:
    if isinstance(answer, dict):
        return {key: timeless(value) for key, value in answer.items() if key != "seconds"}
    return [timeless(value) for value in answer] if isinstance(answer, list) else answer


def write_choices(**keys: Any) -> None:
    if not Path("t.kilter.json").exists():
        kilter.dump(tower(), "t.kilter.json")
    data = {"kilter": 1, "file": "t.kilter.json", "held": ["a"], **keys}
    Path("c.json").write_text(json.dumps(data), encoding="utf-8")


def answer_of(say: Any, line: str) -> dict[str, Any]:
    code, out, err = say(f"{line} --json")
    assert code in (0, 1, 3, 4), err
    return timeless(json.loads(out))


OPTIONS = {
    "held": "--ground a b",
    "floor": "--floor -0.25 --ground a",
    "lowest": "--floor",
    "left out": "--ground a --without c",
    "joined": '--ground a --fasten a "b*" --gap 0.02 --fasten b c',
    "friction": "--ground a --friction 0.4 --down 0.3 0 -1 --without c",
    "density": "--ground a --density 500 --loose --up z --angle 0.5",
    "clearance": "--ground a --clearance 0.02 --bond b c 2500 --down 0 0 1",
    "overlaps": "--ground a --fasten-overlaps --fasten-suggested --units m",
}


@pytest.mark.quick("joined")
@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_saved_options_give_the_same_answer(options, say):
    kilter.dump(tower(), "t.kilter.json")
    assert say(f"save t.kilter.json {options} -o c.json")[0] == 0
    expected = answer_of(say, f"check t.kilter.json {options}")
    assert answer_of(say, "check c.json") == expected
    assert timeless(kilter.check(kilter.load("c.json")).to_dict()) == expected
    choices = Choices.read("c.json")
    assert timeless(kilter.check(kilter.load(choices)).to_dict()) == expected


@pytest.mark.quick("joined")
@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_choices_options_choices(options, say):
    kilter.dump(tower(), "t.kilter.json")
    say(f"save t.kilter.json {options} -o c.json")
    say("save c.json -o again.json")
    choices = Choices.read("c.json")
    assert Choices.read("again.json") == choices
    assert hash(Choices.read("again.json")) == hash(choices)
    merged, replaced = Reading().over(choices)
    assert Reading.from_options(json.loads(json.dumps(merged.options()))) == merged
    assert replaced == []


def test_the_command_line_wins_and_names_what_it_replaces(say):
    write_choices(friction=0.5, left_out=["c"], gravity=[0, 0, -3.7], tolerance={"gap": 0.001})
    given = "check c.json --friction 0.2 --ground a b --down 0 0.1 -1 --gap 0.002"
    answer = answer_of(say, given)
    assert [w for w in answer["warnings"] if "replaces" in w] == [
        'the option ground ["a", "b"] replaces held ["a"] of the choices',
        "the option friction 0.2 replaces friction 0.5 of the choices",
        "the option down [0.0, 0.1, -1.0] replaces gravity [0, 0, -3.7] of the choices",
        "the option gap 0.002 replaces gap 0.001 of the choices",
    ]
    assert np.linalg.norm(answer["gravity"]) == pytest.approx(3.7, rel=1e-15)
    assert answer["parts"][1]["grounded"]
    assert len(answer["parts"]) == 2
    loaded = kilter.load("c.json", friction=0.2)
    assert loaded.friction == 0.2
    assert loaded.notes == ("the option friction 0.2 replaces friction 0.5 of the choices",)


def test_equal_options_replace_nothing(say):
    write_choices(friction=0.5, left_out=["c"])
    answer = answer_of(say, "check c.json --friction 0.5 --ground a")
    assert answer == answer_of(say, "check c.json")
    assert not [w for w in answer["warnings"] if "replaces" in w]


@pytest.mark.slow
def test_a_decided_pair_is_joined_touching_or_apart(say):
    """Part c is 0.01 above b: apart it falls freely, touching or joined it stays."""
    verdicts = {}
    for state in ("joined", "touching", "apart"):
        write_choices(open_pairs=[{"parts": ["b", "c"], "as": state}])
        answer = answer_of(say, "check c.json")
        verdicts[state] = answer["verdict"]
        assert answer["open_pairs"] == []
    assert verdicts == {"joined": "stable", "touching": "stable", "apart": "unstable"}
    write_choices(open_pairs=[{"parts": ["b", "c"], "as": "touching"}])
    patch = kilter.contacts(kilter.load("c.json")).to_dict()["patches"][-1]
    assert (patch["parts"], patch["normal"]) == (["b", "c"], [0, 0, 1])
    assert np.ptp(np.array(patch["points"]), axis=0) == pytest.approx([0.8, 1, 0], abs=0.011)
    # the proofs of decided pairs are recomputed from the file
    for state in verdicts:
        write_choices(open_pairs=[{"parts": ["b", "c"], "as": state}])
        say("check c.json --proof p.json")
        assert say("verify c.json p.json")[0] == 0
    write_choices(open_pairs=[{"parts": ["a", "c"], "as": "touching"}])
    assert "no faces of 'a' and 'c' come near" in say("check c.json")[2]


def test_apart_also_separates_parts_that_touch(say):
    write_choices(open_pairs=[{"parts": ["b", "a"], "as": "apart"}], left_out=["c"])
    answer = answer_of(say, "check c.json")
    assert answer["verdict"] == "unstable"
    assert answer["parts"][1]["acceleration"] == pytest.approx([0, 0, -9.81, 0, 0, 0])


def test_keys_without_options_act(say):
    write_choices(
        left_out=["c"],
        materials=[{"parts": "*", "density": 100, "name": "cork"}, {"parts": "b", "density": 7850}],
        loads=[{"part": "b", "force": [0, 0, 5]}],
        friction_pairs=[{"parts": ["a", "b"], "mu": 0.25}],
        joints=[{"parts": ["a", "b"], "kind": "prismatic", "axis": [0, 0, 1]}],
        bonds=[{"parts": ["a", "b"], "pull": 3, "shear": 2}],
        poses={"b": {"position": [0.1, 0, 1.5]}},
        gravity=[0, 0, -1.62],
        straps=[{"path": [["ground", [9, 0, 0]], ["b", [0.6, 0, 2]]], "tension": 20}],
    )
    assembly = kilter.load("c.json")
    assert assembly.geometry.mass == pytest.approx([400, 7850])
    assert assembly.geometry.center[1] == pytest.approx([0.1, 0, 1.5])
    assert assembly.gravity.tolist() == [0, 0, -1.62]
    assert assembly.loads[0].force.tolist() == [0, 0, 5]
    assert assembly.friction_pairs[0].mu == 0.25
    assert assembly.joints[0].kind == "prismatic"
    assert assembly.bonds[0].shear == 2
    assert assembly.straps[0].parts == ("ground", "b")
    assert kilter.contacts(assembly).patch_mu.tolist() == [0.25]
    assert say("check c.json --proof p.json")[0] == 0
    assert say("verify c.json p.json")[0] == 0


def test_a_material_replaces_the_mass_of_the_file():
    kilter.dump(Assembly([Part("m", Box([1, 1, 1]), mass=3.0)]), "m.kilter.json")
    materials = [{"parts": "m", "density": 2}]
    kilter.save("m.kilter.json", "m.json", ground="m", materials=materials)
    assert kilter.load("m.json").geometry.mass.tolist() == [2.0]


@pytest.mark.slow
def test_material_and_open_are_options_of_save(say):
    kilter.dump(tower(), "t.kilter.json")
    words = '--material "b*=7850" --open b c apart --ground a'
    assert say(f"save t.kilter.json {words} -o c.json")[0] == 0
    choices = Choices.read("c.json").to_dict()
    assert choices["materials"] == [{"parts": "b*", "density": 7850.0}]
    assert choices["open_pairs"] == [{"parts": ["b", "c"], "as": "apart"}]
    assert "name the parts" in say("save t.kilter.json --material b -o c.json")[2]
    assert "joined, touching or apart" in say("save t.kilter.json --open b c near -o c.json")[2]
    assert "no part is named 'd'" in say("save t.kilter.json --material d=3 -o c.json")[2]
    # a later save changes single keys
    assert say("save c.json --friction 0.3 -o c.json")[0] == 0
    assert Choices.read("c.json").to_dict() == {**choices, "friction": 0.3}


@pytest.mark.slow
def test_every_command_reads_choices(say):
    write_choices(left_out=["c"], friction=0.5)
    for verb in ("check", "contacts", "orient", "region", "margin", "plan", "hold", "transport"):
        options = "t.kilter.json --ground a --without c --friction 0.5"
        assert answer_of(say, f"{verb} c.json") == answer_of(say, f"{verb} {options}"), verb
    code, _, err = say("report c.json -o c.html")
    assert code == 0, err
    assert "kilter report c.json -o c.html" in Path("c.html").read_text(encoding="utf-8")
    assert say("draw c.json -o c.glb")[0] in (0, 2)
    Path("list.txt").write_text("c.json\nt.kilter.json\n", encoding="utf-8")
    say("batch list.txt -o out --processes 1")
    rows = "".join(path.read_text() for path in Path("out").glob("*.csv"))
    if rows:
        assert "0,c.json,stable" in rows
        assert "nothing is held" in rows


def test_several_files_have_their_own_choices(say):
    write_choices(left_out=["c"])
    code, out, _ = say("check c.json t.kilter.json --json")
    first, second = json.loads(out)
    assert code == 2
    assert first["verdict"] == "stable"
    assert "nothing is held" in second["error"]


def test_a_batch_uses_the_tolerance_of_each_file():
    write_choices(tolerance={"gap": 0.02})
    assembly = kilter.load("c.json")
    strict = assembly.with_joints([])
    verdicts = kilter.check_many([assembly, Assembly(strict.parts)])
    assert verdicts.verdict.tolist() == ["stable", "unstable"]
    assert kilter.check(assembly).verdict == "stable"


def test_a_changed_file_is_one_warning_and_refuses_old_proofs(say):
    kilter.dump(tower(), "t.kilter.json")
    say("save t.kilter.json --ground a --without c -o c.json")
    say("check c.json --proof p.json")
    assert say("verify c.json p.json")[0] == 0
    assert say("verify t.kilter.json p.json")[0] == 0
    kilter.dump(Assembly([*tower().parts, Part("d", Box([1, 1, 1]), Pose([9, 0, 0]))]), "x")
    Path("t.kilter.json").write_text(Path("t.kilter.json").read_text() + "\n")
    code, out, err = say("check c.json")
    assert code == 0
    assert err.count("t.kilter.json has changed since the choices were saved") == 1
    for file in ("c.json", "t.kilter.json"):
        code, out, _ = say(f"verify {file} p.json")
        assert code == 1
        assert "another version of t.kilter.json" in " ".join(out.split())
    say("save c.json -o c.json")
    assert "has changed" not in say("check c.json")[2]


def test_a_lost_part_is_one_warning_and_its_choices_stay(say):
    kilter.dump(tower(), "t.kilter.json")
    options = '--ground a --fasten b c --gap 0.02 --without "c-*" --open b c joined'
    kilter.dump(Assembly([*tower().parts, Part("c-1", Box([1, 1, 1]))]), "t.kilter.json")
    assert say(f"save t.kilter.json {options} -o c.json")[0] == 0
    before = Choices.read("c.json").to_dict()
    kilter.dump(tower().without("c"), "t.kilter.json")
    code, _, err = say("check c.json --proof p.json")
    assert code == 0
    lost = [line for line in err.splitlines() if "do not exist" in line]
    assert lost == [
        "kilter: warning: the choices name parts that do not exist: 'c', 'c-*'; they are kept"
    ]
    assert say("verify c.json p.json")[0] == 0
    code, _, err = say("save c.json -o again.json")
    assert code == 0, err
    after = Choices.read("again.json").to_dict()
    assert {**after, "sha256": ""} == {**before, "sha256": ""}
    # an option that names the lost part remains an error
    assert say("check c.json --ground c")[0] == 2


def test_choices_about_left_out_parts_rest(say):
    write_choices(held=["a", "c"], left_out=["c"], materials=[{"parts": "c", "density": 3}])
    answer = answer_of(say, "check c.json")
    assert [part["name"] for part in answer["parts"]] == ["a", "b"]
    assert answer["warnings"] == []


WRONG = {
    "misspelt": ({"fricton": 0.3}, "unknown key 'fricton'; did you mean 'friction'?"),
    "held": ({"hold": ["a"]}, "unknown key 'hold'; did you mean 'held'?"),
    "inside": ({"tolerance": {"gapp": 1}}, "unknown key 'tolerance.gapp'; did you mean 'gap'?"),
    "moved": ({"file": "gone.step"}, "the file 'gone.step' is not in the folder"),
    "above": ({"file": "../t.kilter.json"}, "does not lie in the folder of the choices or below"),
    "absolute": ({"file": "/t.kilter.json"}, "does not lie in the folder"),
    "drive": ({"file": "C:\\t.kilter.json"}, "does not lie in the folder"),
    "two files": ({"file": ["t.kilter.json", "u.step"]}, "file names several files"),
    "parts too": ({"parts": []}, "the keys 'file' and 'parts' are both given"),
    "straps": ({"straps": [{"name": "s"}]}, "straps[0]"),
    "angle": ({"tolerance": {"angle_deg": 60}}, "give a number below 45"),
    "up": ({"up": "y", "gravity": [0, 0, -9]}, "gravity is [0, 0, -9], but up is 'y'"),
    "as": ({"open_pairs": [{"parts": ["a", "b"], "as": "near"}]}, "open_pairs[0].as"),
    "chain": ({"file": "c.json"}, "c.json is a file of choices itself"),
    "version": ({"kilter": 2}, "kilter is 2"),
}


@pytest.mark.quick(4)
@pytest.mark.parametrize(("keys", "words"), WRONG.values(), ids=WRONG)
def test_wrong_choices_are_one_sentence(keys, words, say):
    write_choices(**keys)
    code, out, err = say("check c.json")
    assert (code, out) == (2, "")
    assert words in err
    assert err.startswith("kilter: c.json: ")
    assert len(err.strip().splitlines()) == 1
    with pytest.raises(InputError, match=re.escape(words)):
        kilter.load("c.json")


PLACES = {
    "elsewhere": ("save t.kilter.json -o sub/c.json", "or to a folder above it"),
    "no ending": ("save t.kilter.json -o c.txt", "choices need a file that ends in .json"),
    "no name": (
        "save t.kilter.json",
        "the name of the output file is missing; add -o X.kilter.json",
    ),
    "an assembly": ("save t.kilter.json -o u.kilter.json", "something other than saved choices"),
    "itself": ("save t.kilter.json -o t.kilter.json", "something other than saved choices"),
    "missing": ("save gone.step -o c.json", "gone.step: no such file"),
    "unknown part": ("save t.kilter.json --ground d -o c.json", "no part is named 'd'"),
    "stdin": ("save - -o c.json", "options for standard input cannot be saved"),
    "two files": ("save t.kilter.json u.kilter.json -o c.json", "a word too many"),
}


@pytest.mark.quick(3)
@pytest.mark.parametrize(("line", "words"), PLACES.values(), ids=PLACES)
def test_save_refuses_in_one_sentence_and_writes_nothing(line, words, say):
    kilter.dump(tower(), "t.kilter.json")
    kilter.dump(tower(), "u.kilter.json")
    Path("sub").mkdir()
    before = {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()}
    code, out, err = say(line)
    assert (code, out) == (2, "")
    assert words in err
    assert len(err.strip().splitlines()) == 1
    assert {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()} == before


@pytest.mark.slow
def test_choices_above_the_file_and_folders_of_meshes(say):
    Path("parts").mkdir()
    kilter.dump(tower(), "parts/t.kilter.json")
    assert say("save parts/t.kilter.json --ground a --without c -o c.json")[0] == 0
    assert Choices.read("c.json").file == "parts/t.kilter.json"
    assert say("check c.json")[0] == 0
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    for k, name in enumerate(("low", "high")):
        lines = [f"v {x} {y} {z + k}" for x, y, z in corners] + [f"f {face}" for face in faces]
        Path("mesh").mkdir(exist_ok=True)
        Path(f"mesh/{name}.obj").write_text("\n".join(lines))
    assert say("save mesh --ground low --units cm -o m.json")[0] == 0
    assert answer_of(say, "check m.json") == answer_of(say, "check mesh --ground low --units cm")
    Path("mesh/new.obj").write_text(Path("mesh/low.obj").read_text().replace("v ", "v 1"))
    assert "mesh has changed" in say("check m.json")[2]


def test_choices_are_values():
    choices = Choices("a.step", held=["x"], studs={"pull": 2, "shear": None}, floor=0.0)
    assert choices == Choices.from_dict(json.loads(json.dumps(choices.to_dict())), folder="b")
    assert choices.to_dict()["studs"] == {"pull": 2}
    assert choices.floor == 0.0
    assert choices != Choices("a.step", held=["x"])
    with pytest.raises(AttributeError):
        choices.held = ()
    with pytest.raises(TypeError):
        choices.studs["pull"] = 3


def test_the_example_of_the_format_is_accepted():
    """All keys of the documented format at once, with null for defaults."""
    text = (ROOT / "docs" / "reference/choices.md").read_text(encoding="utf-8")
    example = json.loads(re.findall(r"```json\n(.*?)```", text, re.S)[-1])
    choices = Choices.from_dict(example)
    keys = {key for key in Choices.__dataclass_fields__ if key != "folder"} | {"kilter"}
    assert set(example) == keys
    assert Choices.from_dict(choices.to_dict()) == choices


def test_the_text_of_save_names_keys_and_the_next_command(say):
    kilter.dump(tower(), "t.kilter.json")
    out = say("save t.kilter.json --ground a --without c --friction 0.3 -o c.json")[1]
    assert out.splitlines()[0] == "c.json: choices about t.kilter.json"
    assert "friction" in out
    assert out.splitlines()[-1] == "next: kilter check c.json"
    again = say("save c.json -o c.json")[1]
    assert again.startswith("c.json: earlier choices replaced by choices about t.kilter.json")
    # the next step of an answer is about the choices, without the saved options
    assert "next: kilter margin c.json\n" in say("check c.json")[1]
