"""Options: their grammar, their types, and choices switched off."""

import json
import math
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from free_form import tower

import kilter
from kilter import Assembly, Box, Choices, Cylinder, InputError, Part
from kilter.cli import main
from kilter.cli.commands import functions_of
from kilter.cli.declarations import declared_in
from kilter.cli.option_parser import values_of
from kilter.cli.options import AddedOptions
from kilter.cli.quantities import ToleranceOptions
from kilter.files.own.choices_writing import OFF, switched_off
from kilter.files.reading_options import ReadingOptions
from kilter.workbench.live_assembly import MATERIALS


def values(line: str) -> dict[str, Any]:
    """The values of a command line that differ from the defaults."""
    name, *words = line.split(" ")
    [function] = functions_of(name)
    plain = values_of(function, ["a.json", "b.json"][: 2 if name == "verify" else 1])
    given = values_of(function, words)
    return {key: value for key, value in given.items() if value != plain[key]}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("check a.json", {}),
        ("check --floor b.json", {"floor": "lowest", "files": ["b.json"]}),
        ("check --floor .2 a.json", {"floor": 0.2}),
        ("check --floor -2e-1 a.json", {"floor": -0.2}),
        ("check --floor=1 a.json", {"floor": 1.0}),
        ("check --ground a b a.json", {"ground": ("a", "b")}),
        ("check --ground a.json a.json", {"ground": ("a.json",)}),
        ("check a.json --ground a b --ground c", {"ground": ("a", "b", "c")}),
        ("check --accelerate -.5g 0 0 a.json", {"accelerate": ("-.5g", "0", "0")}),
        ("check --down 1e-3 0 -1e-3 a.json", {"down": (0.001, 0.0, -0.001)}),
        ("check --up -z a.json", {"up": "-z"}),
        ("check -", {"files": ["-"]}),
        ("check --no-floor --no-fasten-suggested a.json", {"off": ("floor", "fasten_suggested")}),
        ("check --off floor loose --release a b a.json",
         {"off": ("floor", "loose"), "release": ("a", "b")}),
        ("check x.json --json y.json", {"files": ["x.json", "y.json"], "json": True}),
        ("check -vo x a.json", {"verbose": True, "output": Path("x")}),
        ("check -o - a.json", {"output": Path("-")}),
        ("check --friction 30% --density steel a.json", {"friction": 0.3, "density": 7850}),
        ("check --friction=45deg a.json", {"friction": pytest.approx(1.0)}),
        ("check --units m --units mm a.json", {"units": "mm"}),
        ("check --fasten bolt* nut* --bond a b 1e2 a.json",
         {"fasten": (("bolt*", "nut*"),), "bond": (("a", "b", 100.0),)}),
        ("check --mass a=1 --mass b=2 a.json", {"mass": (("a", 1.0), ("b", 2.0))}),
        ("check -- -x.json", {"files": ["./-x.json"]}),
        ("plan --before a b --turn --hold 2 a.json",
         {"before": [("a", "b")], "turn": True, "hold": 2}),
        ("orient --method walk a.json", {"method": "walk"}),
        ("batch a.json -o rows --chunk 7", {"output": Path("rows"), "chunk": 7}),
        ("verify a.json b.json --require proved", {"require": "proved"}),
        ("view --port 80 b.json", {"port": 80, "file": "b.json"}),
    ],
)  # fmt: skip
def test_values_of_a_line(line, expected):
    if line.startswith("batch"):
        [function] = functions_of("batch")
        given = values_of(function, line.split()[1:])
        assert {name: given[name] for name in expected} == expected
        return
    assert values(line) == expected


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("check", "FILE is missing"),
        ("check a.json --fric 1", "there is no option --fric: did you mean --friction?"),
        ("check a.json --mu 1", "there is no option --mu: use --friction"),
        ("check a.json --friction", "--friction needs MU"),
        ("check a.json --friction --json", "--friction needs MU"),
        ("check a.json --friction x", "--friction has 'x'"),
        ("check a.json --gap x", "--gap has 'x', not a number"),
        ("check a.json --quiet=1", "--quiet takes no value, but has '1'"),
        ("check a.json --down 0 1", "--down needs X Y Z"),
        ("check a.json --down 0 0 x", "--down has 'x', not a number"),
        ("check a.json --fasten a", "--fasten needs NAME NAME"),
        ("verify a.json", "P.json is missing"),
        ("doctor a.json", "there is a word too many: 'a.json'"),
        ("plan a.json --hold 1.5", "--hold has '1.5', not a whole number"),
        ("orient a.json --method x", "--method has 'x', not one of joint|walk"),
        ("batch a.json", "-o/--output is missing"),
        ("chek a.json", "there is no command 'chek'; did you mean 'check'?"),
        ("--jsn", "there is no option '--jsn'; see 'kilter --help'"),
        ("a.json", "there is no command 'a.json'; type 'kilter check a.json'"),
        ("help plans", "there is no page 'plans'; did you mean 'plan'?"),
        ("--down plan a.json", "options follow the command: kilter plan FILE --down"),
    ],
)
def test_a_wrong_line_is_a_sentence(line, words, capsys):
    assert main(line.split()) == 2
    message = capsys.readouterr().err
    assert message.startswith("kilter: ")
    assert message.count("\n") == 1
    assert words in message


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_a_shell_completes_commands_and_options(shell, capsys):
    pytest.importorskip("shtab")
    assert main(["--print-completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(word in script for word in ("check-plan", "--fasten-suggested", "--forward"))


def test_an_unknown_shell_is_a_sentence():
    pytest.importorskip("shtab")
    from kilter.cli.option_parser import completion

    with pytest.raises(InputError, match="no completion for 'dos'; give one of bash"):
        completion("dos")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with a stack of six bolts on a plate, whose parts state no density."""
    monkeypatch.chdir(tmp_path)
    plate = Part("plate", Box(9, 2, 1), [0, 0, 0.5])
    bolts = [Part(f"m{k}-bolt", Box(1, 1, 1), [1.5 * k - 3.75, 0, 1.5]) for k in range(6)]
    kilter.dump(Assembly([plate, *bolts]), "a.kilter.json")


WRONG = {
    "check a.kilter.json --floor --friction wet": "0.3, 30% or 17deg",
    "check a.kilter.json --floor --friction 95deg": "an angle below 90 degrees",
    "check a.kilter.json --floor --friction x%": "0.3, 30% or 17deg",
    "check a.kilter.json --floor --density steal": "did you mean 'steel'",
    "check a.kilter.json --floor --density heavy": "give kg/m^3, or one of steel",
    "check a.kilter.json --floor --material steel": '--material "*=steel"',
    "check a.kilter.json --floor --material *=0": "give a density above zero",
    "check a.kilter.json --floor --material *=nan": "give a density above zero",
    "check a.kilter.json --floor --material bot*=steel": "no part is named 'bot*'",
    "check a.kilter.json --ground bolt": "6 parts end in bolt: '*bolt'",
    "check a.kilter.json --ground m": "6 parts begin with m: 'm*'",
    "check a.kilter.json --ground -": "6 parts contain -: '*-*'",
    "check a.kilter.json --ground plat": "did you mean 'plate'",
    "check a.kilter.json --floor --tilt 5": "'kilter margin' computes the limit",
    "check a.kilter.json --floor --slope 5": "use --down X Y Z",
    "check a.kilter.json --floor --animate x": "'kilter draw FILE -o x.glb'",
    "check a.kilter.json --floor --html x": "'kilter report FILE -o x.html'",
    "margin a.kilter.json --floor --earthquake 1": "'kilter transport --accelerate 0.2g 0 0'",
    "check a.kilter.json --floor -o x.html": "'kilter report FILE -o x.html' writes a page",
    "check a.kilter.json --floor -o x.glb": "'kilter draw FILE -o x.glb' writes a film",
    "margin a.kilter.json --floor -o x.pdf": "'kilter draw FILE -o x.png' writes a picture",
    "place a.kilter.json --floor --box 1x1x1 -o x.png": "'kilter draw FILE -o x.png'",
    "scene a.kilter.json --floor -o x.glb": "'kilter draw FILE -o x.glb' writes a film",
    "check-plan p.csv -o x.html": "'kilter report FILE -o x.html' writes a page",
    "plan a.kilter.json --floor -o x.docx": "'kilter report FILE -o x.html' writes a page",
    "scene a.kilter.json --floor -o x.usda": "'kilter scene' objects",
    "transport a.kilter.json --floor --accelerate 1 2": "--accelerate needs X Y Z; see 'kilter",
    "place a.kilter.json --floor --at 0 0 0 0": "a word too many: '0'; see 'kilter place",
    "place a.kilter.json --floor --box 1x1 --mass 1": "--box is '1x1'; give --box 400x300x250",
    "place a.kilter.json --floor --box 1x1x1": "mass of the box is not given; give",
    "place a.kilter.json --floor --box 1x1x1 --mass 1 --at 0 nan": "give finite numbers",
    "settle a.kilter.json --floor -o rest.txt": "give X.kilter.json, X.xml, X.npy, X.glb",
    "hold a.kilter.json --candidates legs": "give grips, props, fingers or a file of supports",
    "plan a.kilter.json --floor --base plate": "use fixed or floating",
    "plan a.kilter.json --floor --before plate plate": "has a cycle: 'plate'; leave a pair out",
    "transport a.kilter.json --floor --code en": "the rule 'en' does not exist; use one of en12195",
    "margin a.kilter.json --floor --mu-range 1 0": "the interval is empty; give low, then high",
    "margin a.kilter.json --floor --push 0 0 0": "give three finite numbers, not all of them zero",
    "check a.kilter.json --floor --load m0-bolt=1,2": "write --load lid=0,0,-20",
    "check a.kilter.json --floor --require always": "require one of equilibrium, settles",
    "check-plan a.kilter.json": "this is no packing plan; give orders of BED-BPP, or a CSV",
    "verify a.kilter.json a.kilter.json": "give a file of kilter check --proof",
    "margin a.kilter.json --floor --write b.json": "add --improve or --make-stand",
    "report a.kilter.json --floor -o x.pdf": "use a name that ends in .html",
    "view a.kilter.json --port 99999999": "give a number from 0 to 65535",
    "draw a.kilter.json --floor -o x.gif": ".svg, .png, .pdf, or in .glb for a film",
}  # fmt: skip


@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_option_names_the_right_one(line, say):
    before = sorted(Path().iterdir())
    code, out, error = say(line)
    assert (code, out) == (2, "")
    assert WRONG[line] in error
    assert error.count("\n") == 1
    assert error.startswith("kilter: ")
    assert sorted(Path().iterdir()) == before


def masses(say: Any, options: str) -> dict[str, float]:
    """Mass of each part that `check` reports [kg]."""
    answer = json.loads(say(f"check a.kilter.json --floor --json {options}")[1])
    return {part["name"]: part["mass"] for part in answer["parts"] if part["name"] != "floor"}


@pytest.mark.parametrize(
    ("typed", "coefficient"),
    [("30%", 0.3), ("17deg", math.tan(math.radians(17))), ("0deg", 0.0), ("0.3", 0.3)],
)
def test_friction_is_a_share_or_an_angle(typed, coefficient, say):
    said = [
        json.loads(say(f"contacts a.kilter.json --floor --json --friction {value}")[1])["patches"]
        for value in (typed, repr(coefficient))
    ]
    assert said[0]
    for typed_patch, patch in zip(*said, strict=True):
        assert typed_patch["mu"] == pytest.approx(coefficient, rel=1e-14)
        assert patch["mu"] == pytest.approx(coefficient, rel=1e-14)


@pytest.mark.parametrize("material", MATERIALS[:3], ids=lambda material: material.name)
def test_a_density_has_the_name_of_a_material(material, say):
    typed = masses(say, f'--density "{material.name.upper()}"')
    assert typed == masses(say, f"--density {material.density}")
    assert typed["m0-bolt"] == pytest.approx(material.density, rel=1e-12)


def test_each_command_takes_materials_by_pattern_and_names_them_in_the_next_step(say):
    typed = masses(say, '--material "*bolt=steel" --material m1*=5')
    assert typed == {
        "plate": pytest.approx(18_000, rel=1e-12),
        **{f"m{k}-bolt": pytest.approx(5 if k == 1 else 7850, rel=1e-12) for k in range(6)},
    }
    _, out, _ = say('check a.kilter.json --floor --material "*bolt=steel"')
    [step] = [line for line in out.splitlines() if line.startswith("next: ")]
    words = shlex.split(step)
    assert words[words.index("--material") + 1] == "*bolt=steel"
    # saved materials are the same as typed ones
    assert say('save a.kilter.json --material "*bolt=oak" -o b.kilter.json')[0] == 0
    saved = json.loads(Path("b.kilter.json").read_text(encoding="utf-8"))
    assert saved["materials"] == [{"parts": "*bolt", "density": 700, "name": "oak"}]


@pytest.mark.slow
def test_a_library_of_solids_prints_no_list_of_leaks():
    """Two cylinders overlap, so that their solids are made and kept for a next search."""
    pytest.importorskip("matplotlib")
    shape = Cylinder(1, 1)
    low, high = Part("low", shape, [0, 0, 0.5]), Part("high", shape, [0.3, 0.2, 1.4])
    kilter.dump(Assembly([low, high]), "sunk.kilter.json")
    words = ["draw", "sunk.kilter.json", "--floor", "-o", "x.svg"]
    done = subprocess.run([sys.executable, "-m", "kilter", *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "leaked" not in done.stderr


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
    "state": {"state": "S.npy:3"},
    "base": {"base": "floating"},
    "model": {"model": "house.ldr"},
    "loose_robots": {"loose_robots": True},
    "stud_pull": {"studs": {"pull": 2}},
    "stud_shear": {"studs": {"shear": "mu"}},
    "brick_sides": {"studs": {"sides": "face"}},
    "gap": {"tolerance": {"gap": 0.02}},
    "angle": {"tolerance": {"angle_deg": 1}},
    "clearance": {"tolerance": {"clearance": 0.02}},
    "loose": {"loose": True},
    "assume": {"assume": "joined"},
    "keep_copies": {"keep_copies": True},
    "material": {"materials": [{"parts": "b", "density": 3}]},
    "open": {"open_pairs": [{"parts": ["b", "c"], "as": "joined"}]},
}
"""A saved value of each option."""
ACTING = [
    name
    for name in SAVED
    if name not in ("ground", "keyframe", "state", "model", "base", "loose_robots")
]
"""Options with an effect on kilter's own files, beside the held part."""


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder of a test, with the tower in a file."""
    monkeypatch.chdir(tmp_path)
    kilter.dump(tower(), "t.kilter.json")


def write(**keys: Any) -> None:
    data = {"kilter": 1, "file": "t.kilter.json", **keys}
    Path("c.json").write_text(json.dumps(data), encoding="utf-8")


def flag(name: str) -> str:
    return f"--no-{name.replace('_', '-')}"


def test_every_option_that_is_saved_has_an_off_switch():
    question = {"mass", "load", "accelerate"}  # refused by `kilter save`: part of a question
    assert set(OFF) == {*READING, "material", "open"} - {"off", "release"} - question
    assert set(OFF) == set(SAVED)


@pytest.mark.parametrize("name", SAVED)
def test_only_the_switched_value_is_removed(name):
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
def test_an_option_switched_off_answers_as_if_never_saved(name, say):
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


def test_a_released_part_is_free_and_its_proof_is_verified(say):
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
def test_a_part_of_a_saved_wildcard_is_released(release, say):
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


def test_a_wildcard_releases_all_parts_that_it_matches():
    write(held=["a", "c*"])
    assert not kilter.load("c.json", release=["a", "c"]).geometry.grounded.any()


def test_python_switches_off_with_names_and_with_false():
    write(held=["a"], floor=True, friction=0.4, tolerance={"gap": 0.02})
    assert kilter.load("c.json").tolerance is not None
    bare = kilter.load("c.json", off=["friction", "gap"], floor=False)
    assert (bare.friction, bare.tolerance, bare.names) == (0.0, None, ("a", "b", "c"))
    assert len(bare.notes) == 3
    saved = kilter.save("c.json", "d.json", off="floor")
    assert saved.to_dict().keys() == {"kilter", "file", "sha256", "held", "friction", "tolerance"}


def test_a_file_without_choices_has_nothing_to_switch_off(say):
    code, text, _ = say("check t.kilter.json --ground a --no-floor --no-loose")
    assert " --off floor " in text  # without it the next command may assume a floor
    bare = say("check t.kilter.json --ground a")
    assert (code, text.replace(" --off floor", "")) == bare[:2]


REFUSED = {
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


@pytest.mark.parametrize(("words", "message"), REFUSED.values(), ids=REFUSED)
def test_wrong_switches_are_one_sentence(words, message, say):
    write(held=["a", "c*"])
    code, out, err = say(f"check c.json {words}")
    assert (code, out) == (2, "")
    assert message in err
    assert len(err.strip().splitlines()) == 1


def test_a_plain_file_releases_nothing(say):
    code, _, err = say("check t.kilter.json --release a")
    assert code == 2
    assert "release names 'a', but the file is no file of choices" in err
    with pytest.raises(InputError, match="no file of choices"):
        kilter.load("t.kilter.json", release=["a"])
