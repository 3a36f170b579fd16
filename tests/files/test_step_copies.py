"""Bodies that a STEP file contains twice, as an export of the steps of a feature writes them."""

from pathlib import Path

import pytest

import kilter

pytest.importorskip("OCP", reason="needs the extra kilter[step]")


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """A top with a bore, beside its pad and itself once more, on two legs."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from step_maker import write_step

    def box(low: tuple[float, ...], high: tuple[float, ...]) -> object:
        return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()

    pin = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 50), gp_Dir(0, 0, 1)), 5, 30).Shape()
    pad = box((-100, -50, 60), (100, 50, 70))
    top = BRepAlgoAPI_Cut(pad, pin).Shape()
    again = BRepAlgoAPI_Cut(pad, pin).Shape()
    legs = [box((x, -50, 0), (x + 20, 50, 60)) for x in (-100, 80)]
    bodies = {"Pad": pad, "Pocket": top, "Body": again, "left": legs[0], "right": legs[1]}
    roots = [(name, shape, None) for name, shape in bodies.items()]
    return write_step(tmp_path / "table.step", roots)


@pytest.mark.slow
def test_each_body_of_a_step_file_counts_once(table):
    verdict = kilter.check(table)
    assert verdict.assembly.names == ("Pocket", "left", "right", "floor")
    assert verdict.verdict == "stable"
    [note] = [text for text in verdict.warnings if "twice" in text]
    assert note == (
        "2 bodies are in the file twice, left out: 'Pad' (as 'Pocket'), 'Body' (as 'Pocket'); "
        "--keep-copies keeps them"
    )
    mass = 1e-6 * (200 * 100 * 10 - 3.141592653589793 * 25 * 10)
    assert verdict.parts[0].mass == pytest.approx(mass, rel=1e-9)
    assert len(kilter.load(table, keep_copies=True)) == 5
