"""The accuracy that a STEP file states: its unit, and its effect on verdicts."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("OCP")

from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from step_maker import placement, write_step

from kilter.analysis.check import check
from kilter.assembly import Assembly, Part
from kilter.files import from_dict, load, to_dict
from kilter.files.stated_accuracy import stated_accuracy
from kilter.rigid import Pose

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if"
MILLI = "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))"
PLAIN = "( LENGTH_UNIT ( ) NAMED_UNIT ( * ) SI_UNIT ( $ , .METRE. ) )"
INCH = "(CONVERSION_BASED_UNIT('INCH',#9)LENGTH_UNIT()NAMED_UNIT(#8))"


@pytest.mark.parametrize(("unit", "units", "factor"), [
    (MILLI, "mm", 1), (MILLI, "cm", 0.1), (PLAIN, "mm", 1000), (INCH, "in", 1), (INCH, "mm", 25.4),
    ("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MICRO.,.METRE.))", "mm", 1e-3),
    ("(CONVERSION_BASED_UNIT('cubit',#9)LENGTH_UNIT())", "mm", 0),
    ("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.HECTO.,.METRE.))", "mm", 0),
])  # fmt: skip
def test_it_is_read_in_its_unit(unit: str, units: str, factor: float, tmp_path: Path) -> None:
    path = tmp_path / "a.step"
    measure = "#7={}(LENGTH_MEASURE({}),#5,'distance_accuracy_value','');\n"
    name = "UNCERTAINTY_MEASURE_WITH_UNIT"
    rows = [measure.format(name, number) for number in ("2.E-3", "1.E-002", "-1.", "x", "1.E400")]
    path.write_text(f"#5={unit};\n" + "".join(rows))
    assert stated_accuracy([path], units) == pytest.approx(0.01 * factor)
    assert stated_accuracy([tmp_path / "none.step"], units) == 0


def leaning(path: Path, beyond: float, accuracy: str) -> Assembly:
    """A cube whose centre of mass is `beyond` the edge of the block below it."""
    roots = [
        ("base", BRepPrimAPI_MakeBox(20.0, 20.0, 20.0).Shape(), None),
        ("cube", BRepPrimAPI_MakeBox(10.0, 10.0, 10.0).Shape(), placement([15 + beyond, 5, 20])),
    ]
    text = write_step(path, [("all", roots, None)]).read_text()
    assert "LENGTH_MEASURE(1.E-07)" in text
    path.write_text(text.replace("LENGTH_MEASURE(1.E-07)", f"LENGTH_MEASURE({accuracy})"))
    return load(path, ground="base")


@pytest.mark.quick(2)
@pytest.mark.parametrize(("beyond", "accuracy", "verdict"), [
    (-0.004, "1.E-07", "stable"),
    (-0.004, "0.01", "stable"),  # a stable nominal position is reported as stable
    (0.004, "1.E-07", "unstable"),
    (0.004, "0.01", "undecided"),
    (0.1, "0.01", "unstable"),
    (0.1, "100.", "undecided"),
    (1.0, "100.", "unstable"),  # whatever accuracy the file states
])  # fmt: skip
def test_what_it_explains_is_not_proved_unstable(
    beyond: float, accuracy: str, verdict: str, tmp_path: Path
) -> None:
    assembly = leaning(tmp_path / "a.step", beyond, accuracy)
    found = check(assembly)
    assert found.verdict == verdict
    assert ("coordinates are not accurate enough" in found.sentence) == (verdict == "undecided")
    written = to_dict(assembly)
    assert to_dict(from_dict(written)) == written
    assert check(from_dict(written)).verdict == verdict


def test_what_falls_falls(tmp_path: Path) -> None:
    """A part without contacts falls, however coarse the stated accuracy is."""
    assembly = leaning(tmp_path / "a.step", 0.004, "0.01")
    base, cube = assembly.parts
    stray = Part("stray", cube.shape, Pose([100, 0, 0]))
    assert check(Assembly([base, cube, stray], units="mm")).verdict == "unstable"


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here")
def test_bolts_whose_heads_are_off_by_less_than_the_file_knows() -> None:
    assembly = load(DATA / "dm1-id-214.stp", floor=True)
    stated = [getattr(part.shape, "uncertainty", 0) for part in assembly.parts[:7]]
    assert stated == pytest.approx([0.01 / 25.4] * 7)
    found = check(assembly)
    assert found.verdict == "undecided"
    assert "0.000394 in" in found.sentence


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here")
def test_files_that_a_file_names_state_it_too() -> None:
    assembly = load(DATA / "s1-tu-203" / "s1-tu-203.stp")
    assert assembly.parts[0].shape.uncertainty == pytest.approx(0.000785973431)
