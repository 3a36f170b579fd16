"""The wells of bodies that OCCT made, read from STEP files: the closed forms of their own lathe."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter

pytest.importorskip("OCP")
G = 9.81


def written(path: Path, shape: Any) -> str:
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(path))
    return str(path)


def axes(z: float, down: bool = False) -> Any:
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return gp_Ax2(gp_Pnt(0, 0, z), gp_Dir(0, 0, -1 if down else 1))


def made(kind: str) -> Any:
    """A body of radius 10 mm on z = 0."""
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeCone,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
    )

    if kind == "half ball":
        return BRepPrimAPI_MakeSphere(axes(10, down=True), 10.0, 0.0, np.pi / 2).Shape()
    if kind == "half ball on its flat side":
        return BRepPrimAPI_MakeSphere(axes(0), 10.0, 0.0, np.pi / 2).Shape()
    if kind == "cone":
        return BRepPrimAPI_MakeCone(axes(0), 10.0, 0.0, 20.0).Shape()
    return BRepPrimAPI_MakeCylinder(axes(0), 10.0, 4.0).Shape()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "over"),
    [
        ("half ball", np.arctan2(1, -3 / 8)),
        ("half ball on its flat side", np.arctan2(1, 3 / 8)),
        ("cone", np.arctan2(10, 5)),
        ("coin", np.arctan2(10, 2)),
    ],
)
def test_what_occt_made_has_the_well_of_its_closed_form(
    kind: str, over: float, tmp_path: Path
) -> None:
    file = written(tmp_path / "b.step", made(kind))
    assembly = kilter.load(file).with_floor()
    (rest,) = kilter.region(assembly, rests=True).rests
    assert rest.state == "free"
    assert rest.well is not None
    assert rest.well.over_deg == pytest.approx(np.degrees(over), rel=1e-7)
    if kind == "half ball":
        assert rest.well.period == pytest.approx(
            2 * np.pi * np.sqrt(83 / 320 * 0.01 / (G * 3 / 8)), rel=1e-6
        )
    else:
        assert rest.well.stiffness is None
