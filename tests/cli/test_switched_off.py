"""Saved options that are switched off, and saved held parts that are released."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from free_form import tower

import kilter
from kilter import Choices, InputError
from kilter.cli.declarations import declared_in
from kilter.cli.options import AddedOptions
from kilter.cli.tolerance_options import ToleranceOptions
from kilter.files.choices_off import OFF, switched_off
from kilter.files.reading_options import ReadingOptions

RECORDS = (ReadingOptions, AddedOptions, ToleranceOptions)
READING = [each.name for record in RECORDS for each in declared_in(record)]

SAVED: dict[str, dict[str, Any]] = {
    "ground": {"held": ["b"]},
    "floor": {"floor": -0.25},
    "without": {"left_out": ["c"]},
    "down": {"gravity": [0.1, 0, -3.7]},
    "up": {"up": "-z"},
    "friction": {"friction": 0.4},
    "units": {"units": "m"},
    "density": {"density": 500},
    "fasten": {"joined": [["a", "b*"]]},
    "bond": {"bonds": [{"parts": ["a", "b"], "pull": 3}]},
    "straps": {"straps": [{"path": [["ground", [3, 0, 2]], ["b", [0.5, 0, 2]]], "tension": 9}]},
    "fasten_suggested": {"fasten_suggested": True},
    "fasten_overlaps": {"fasten_overlaps": True},
    "contacts": {"contacts": "geometry"},
    "keyframe": {"keyframe": "home"},
    "base": {"base": "floating"},
    "stud_pull": {"studs": {"pull": 2}},
    "stud_shear": {"studs": {"shear": "mu"}},
    "brick_sides": {"studs": {"sides": "face"}},
    "gap": {"tolerance": {"gap": 0.02}},
    "angle": {"tolerance": {"angle_deg": 1}},
    "clearance": {"tolerance": {"clearance": 0.02}},
    "loose": {"loose": True},
    "material": {"materials": [{"parts": "b", "density": 3}]},
    "open": {"open_pairs": [{"parts": ["b", "c"], "as": "joined"}]},
}
"""A saved value of each option."""
ACTING = [name for name in SAVED if name not in ("ground", "keyframe", "base")]
"""Options with an effect on kilter's own files, beside the held part."""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder of a test, with the tower in a file."""
    monkeypatch.chdir(tmp_path)
    kilter.dump(tower(), "t.kilter.json")


def write(**keys: Any) -> None:
    data = {"kilter": 1, "file": "t.kilter.json", **keys}
    Path("c.json").write_text(json.dumps(data), encoding="utf-8")


def flag(name: str) -> str:
    return f"--no-{name.replace('_', '-')}"


def test_every_option_that_is_saved_has_an_off_switch() -> None:
    question = {"mass", "load", "accelerate"}  # refused by `kilter save`: part of a question
    assert set(OFF) == {*READING, "material", "open"} - {"off", "release"} - question
    assert set(OFF) == set(SAVED)


@pytest.mark.parametrize("name", SAVED)
def test_only_the_switched_value_is_removed(name: str) -> None:
    others = {key: value for entry in SAVED.values() for key, value in entry.items()
              if key not in ("gravity", "studs", "tolerance", *SAVED[name])}  # fmt: skip
    others |= {"studs": {"pull": 1, "shear": "mu", "sides": "none"}}
    others |= {"tolerance": {"gap": 1, "angle_deg": 2, "clearance": 3}}
    if name == "down":
        del others["up"]
    [(key, value)] = SAVED[name].items()
    inner = next(iter(value)) if key in ("studs", "tolerance") else None
    data = {**others, key: {**others[key], **value}} if inner else {**others, key: value}
    changed, notes = switched_off(Choices("f", **data), [name])
    expected = {**data}
    if inner:
        expected[key] = {k: v for k, v in data[key].items() if k != inner}
    else:
        del expected[key]
    assert changed == Choices("f", **expected)
    [note] = notes
    assert note.startswith(f"the option {flag(name)[2:]} replaces {inner or key} ")
    again, none = switched_off(changed, [name])
    assert (again, none) == (changed, [])


@pytest.mark.quick("floor", "gap")
@pytest.mark.parametrize("name", ACTING)
def test_an_option_switched_off_answers_as_if_never_saved(name: str, say: Any) -> None:
    """Also the choices that `save` writes then, and the words that the next step suggests."""
    write(held=["a"], **SAVED[name])
    answers = []
    for line in ("check t.kilter.json --ground a", f"check c.json {flag(name)}",
                 f"check c.json --off {name}"):  # fmt: skip
        answer = json.loads(say(f"{line} --json")[1])
        del answer["seconds"]
        noted = [text for text in answer["warnings"] if "replaces" in text]
        answer["warnings"] = [text for text in answer["warnings"] if "replaces" not in text]
        assert len(noted) == (0 if "t.kilter" in line else 1)
        answers.append(answer)
    assert answers[0] == answers[1] == answers[2]
    assert say(f"save c.json {flag(name)} -o d.json")[0] == 0
    say("save t.kilter.json --ground a -o e.json")
    assert Choices.read("d.json") == Choices.read("e.json")


def test_a_released_part_is_free_and_its_proof_is_verified(say: Any) -> None:
    write(held=["a", "b"], left_out=["c"])
    code, out, err = say("check c.json --release b --json --proof p.json")
    assert code == 0, err
    answer = json.loads(out)
    assert [part["grounded"] for part in answer["parts"]] == [True, False]
    words = 'the option release ["b"] replaces held ["a", "b"] of the choices'
    assert answer["warnings"] == [words]
    assert say("verify c.json p.json")[0] == 0
    assert say("save c.json --release b -o d.json")[0] == 0
    assert Choices.read("d.json").held == ("a",)
    loaded = kilter.load("c.json", release="b")
    assert loaded.geometry.grounded.tolist() == [True, False]
    assert "next: kilter margin c.json --release b" in say("check c.json --release b")[1]


@pytest.mark.parametrize("release", ["b", "[bx]"])
def test_a_part_of_a_saved_wildcard_is_released(release: str, say: Any) -> None:
    write(held=["?"], left_out=["c"], floor=-9)
    code, out, err = say(f"check c.json --release {release} --json --proof p.json")
    assert code == 0, err
    answer = json.loads(out)
    held = {part["name"]: part["grounded"] for part in answer["parts"]}
    assert held == {"a": True, "b": False, "floor": True}
    assert (
        f'the option release ["{release}"] replaces held ["?"] of the choices'
        in (answer["warnings"])
    )
    assert say("verify c.json p.json")[0] == 0
    assert kilter.load("c.json", release=release).geometry.grounded.tolist() == [True, False, True]
    assert say(f"save c.json --release {release} -o d.json")[0] == 0
    assert Choices.read("d.json").held == ("a",)


def test_a_wildcard_releases_all_parts_that_it_matches() -> None:
    write(held=["a", "c*"])
    assert not kilter.load("c.json", release=["a", "c"]).geometry.grounded.any()


def test_python_switches_off_with_names_and_with_false() -> None:
    write(held=["a"], floor=True, friction=0.4, tolerance={"gap": 0.02})
    assert kilter.load("c.json").tolerance is not None
    bare = kilter.load("c.json", off=["friction", "gap"], floor=False)
    assert (bare.friction, bare.tolerance, bare.names) == (0.0, None, ("a", "b", "c"))
    assert len(bare.notes) == 3
    saved = kilter.save("c.json", "d.json", off="floor")
    assert saved.to_dict().keys() == {"kilter", "file", "sha256", "held", "friction", "tolerance"}


def test_a_file_without_choices_has_nothing_to_switch_off(say: Any) -> None:
    given = say("check t.kilter.json --ground a --no-floor --no-loose")
    assert given[:2] == say("check t.kilter.json --ground a")[:2]


WRONG = {
    "unknown": ("--off loos", "no saved option is named 'loos'; did you mean 'loose'?"),
    "misspelt": ("--no-flor", "there is no option --no-flor"),
    "both": ("--floor --no-floor", "floor and no-floor are both given; give only one of the two"),
    "tolerance": ("--gap 1 --no-gap", "gap and no-gap are both given"),
    "flag": ("--loose --no-loose", "loose and no-loose are both given"),
    "held": ("--ground a --release a", "ground and release are both given"),
    "held off": ("--no-ground --release a", "release and no-ground are both given"),
    "not held": ("--release b", "the choices do not hold 'b'; they hold 'a', 'c*'"),
    "no part": ("--release c9", "'c9' names no held part, so it cannot be released"),
    "no name": ("--release", "--release needs NAME"),
}


@pytest.mark.parametrize(("words", "message"), WRONG.values(), ids=WRONG)
def test_wrong_switches_are_one_sentence(words: str, message: str, say: Any) -> None:
    write(held=["a", "c*"])
    code, out, err = say(f"check c.json {words}")
    assert (code, out) == (2, "")
    assert message in err
    assert len(err.strip().splitlines()) == 1


def test_a_plain_file_releases_nothing(say: Any) -> None:
    code, _, err = say("check t.kilter.json --release a")
    assert code == 2
    assert "release names 'a', but the file is no file of choices" in err
    with pytest.raises(InputError, match="no file of choices"):
        kilter.load("t.kilter.json", release=["a"])
