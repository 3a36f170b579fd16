"""Random CAD drawings with a known outcome that earlier versions answered wrongly."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import pytest

import kilter

pytest.importorskip("OCP", reason="needs kilter[step]")

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
PLAYS = (20071, 20129, 20156, 20236, 20240, 20260)
"""A cover hangs on snap hooks with play, beside threads, press fits and O-rings."""
COPIES = (20120,)
"""Drawing with a cover, an O-ring that overlaps its pin, and a block inside its variant."""
MIRRORED = (20094, 20170)
"""A mirrored sub-assembly; a part of it was drawn in inches."""


@pytest.fixture
def census(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of the census."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    monkeypatch.setattr(sys, "path", [*sys.path])
    return importlib.import_module("cad_census")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*PLAYS, *COPIES, *MIRRORED])
def test_the_known_outcome_follows_from_two_proposed_commands(
    seed: int, census: Any, tmp_path: Path
) -> None:
    case = census.examine(seed, tmp_path)
    assert case.fault == ""
    assert case.is_useful()
    assert case.judgement() == "right"


@pytest.mark.slow
@pytest.mark.parametrize("seed", MIRRORED)
def test_the_image_of_a_sub_assembly_has_its_volumes_and_lies_on_the_base(
    seed: int, census: Any, tmp_path: Path
) -> None:
    file = census.write_drawn(census.draw(seed), tmp_path / "drawn.step")
    assembly = kilter.load(file)
    geometry = assembly.geometry
    volumes = dict(zip(assembly.names, geometry.volume, strict=True))
    images = [name for name in assembly.names if "far_side" in name]
    assert images
    for name in images:
        assert volumes[name] == pytest.approx(volumes[name.replace("far_side/", "")], rel=1e-9)
    low, high = (dict(zip(assembly.names, ends, strict=True)) for ends in geometry.part_boxes)
    for name in images:
        assert (low[name][:2] >= low["base"][:2]).all()
        assert (high[name][:2] <= high["base"][:2]).all()
