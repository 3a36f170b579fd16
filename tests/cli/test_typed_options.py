"""Options as users type them: accepted, or refused in a sentence with the right option."""

import json
import math
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter import Assembly, Box, Cylinder, Part
from kilter.workbench.materials import MATERIALS


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
    "settle a.kilter.json --floor -o rest.txt": "give X.kilter.json, X.xml, X.glb, X.usda",
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
    "improve a.kilter.json": "give an assembly as it was read from a file of bricks",
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
