"""A floor belongs to the up direction of the file: four commands give the same limit of tilt."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.cli import main

LIMIT = float(np.degrees(np.arctan(0.2)))
NOTE = "the floor lies across the up direction of the file, (0, 0, 1), and turns with the parts"


def down(degrees: float) -> list[float]:
    """Gravity turned from -z towards +x."""
    return [float(np.sin(np.radians(degrees))), 0.0, -float(np.cos(np.radians(degrees)))]


def words(degrees: float) -> list[str]:
    return ["--down", *(f"{x:.17g}" for x in down(degrees))]


@pytest.fixture
def box(tmp_path: Path) -> str:
    path = tmp_path / "box.kilter.json"
    kilter.dump(
        kilter.Assembly([kilter.Part("b", kilter.Box(0.4, 1, 2), [0, 0, 1])], friction=0.9), path
    )
    return str(path)


@pytest.mark.slow
@pytest.mark.parametrize("floor", [["--floor"], ["--floor", "0"]], ids=["lowest", "height"])
@pytest.mark.parametrize("off", [-0.01, 0.01])
def test_check_falls_where_margin_region_and_orient_have_their_limit(
    box: str, floor: list[str], off: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    degrees = LIMIT + off
    proof = tmp_path / "p.json"
    options = [*floor, *words(degrees)]
    code = main(["check", box, *options, "--proof", str(proof), "--json"])
    assert code == (1 if off > 0 else 0)
    assert any(NOTE in warning for warning in json.loads(capsys.readouterr().out)["warnings"])
    table = json.loads(proof.read_text())["parts"][1]
    assert table["center"][:2] == [0.0, 0.0]
    assert main(["verify", box, str(proof), "--quiet"]) == 0
    capsys.readouterr()
    main(["margin", box, *options, "--json"])
    assert json.loads(capsys.readouterr().out)["tilt_deg"] == pytest.approx(-off, abs=1e-6)


def test_region_and_orient_ask_about_the_same_floor(box: str) -> None:
    drawn = kilter.load(box, floor=True)
    turned = kilter.load(box, floor=True, down=down(5))
    for assembly in (drawn, turned):
        region = kilter.region(assembly)
        inside, outside = region.contains([down(LIMIT - 0.01), down(LIMIT + 0.01)])
        assert (inside, outside) == (True, False)
        assert kilter.orient(assembly).tilt_margin_deg == pytest.approx(LIMIT, abs=0.01)


def test_a_floor_without_another_direction_has_no_note(box: str) -> None:
    assert kilter.load(box, floor=True, down=[0, 0, -3]).notes == ()
    assert kilter.load(box, down=down(5)).notes == ()
    sideways = kilter.load(box, floor=True, up="x")
    assert np.allclose(sideways["floor"].pose.matrix[:, 2], [1, 0, 0])
