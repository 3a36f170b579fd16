"""A spherical face with the wrong side of its outline: it is recognised, and replaced."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sampled import sampled

pytest.importorskip("OCP")

from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS, TopoDS_Shape

from kilter.errors import InputError
from kilter.files import checked_solid as checking
from kilter.files import load
from kilter.files.checked_solid import checked_solid
from kilter.files.doubled_faces import has_doubled_faces
from kilter.files.file_tolerances import DOUBLED
from kilter.files.occt import inside
from kilter.files.step_repairs import _area, with_other_sides
from kilter.files.step_solids import read_solid
from kilter.rigid import quaternion_to_matrix
from kilter.scenes.pieces import turn
from kilter.shape.solid import Solid, Surface

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if"
RADIUS = 2.0
SPHERE = GeomAbs_SurfaceType.GeomAbs_Sphere


def cap(height: float, *, rest: bool) -> TopoDS_Shape:
    """The part of a sphere above `height`, or the rest of the sphere, as a face."""
    angle, axes = np.arcsin(height / RADIUS), gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    ends = (-np.pi / 2, angle) if rest else (angle, np.pi / 2)
    ball = BRepPrimAPI_MakeSphere(axes, RADIUS, *ends).Shape()
    faces = map(TopoDS.Face, inside(ball, TopAbs_ShapeEnum.TopAbs_FACE))
    return next(f for f in faces if BRepAdaptor_Surface(f).GetType() == SPHERE)


@pytest.mark.parametrize("height", [0.2, 0.9, 1.7])
def test_the_other_side_has_the_rest_of_the_area(height: float) -> None:
    whole, small = 4 * np.pi * RADIUS**2, 2 * np.pi * RADIUS * (RADIUS - height)
    other = with_other_sides(cap(height, rest=True))
    assert _area(cap(height, rest=True)) == pytest.approx(whole - small)
    assert _area(other) == pytest.approx(small)
    assert with_other_sides(cap(height, rest=False)) is None


def test_solids_without_such_faces_are_not_changed() -> None:
    assert with_other_sides(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape()) is None
    assert ball_of(RADIUS).volume == pytest.approx(4 / 3 * np.pi * RADIUS**3)


def ball_of(radius: float) -> Solid:
    ball = BRepPrimAPI_MakeSphere(radius).Shape()
    return read_solid(TopoDS.Solid(next(inside(ball, TopAbs_ShapeEnum.TopAbs_SOLID)))).solid


def two_hemispheres(angle: float, *, hollow: bool = True) -> Solid:
    """Half a sphere, and half of the same sphere turned by `angle` degrees with its faces inwards.

    They share the part 1 - angle / 180 of their area.
    """
    solid = ball_of(1.0)
    middles = solid.vertices[solid.triangles].mean(axis=1)
    half = solid.triangles[middles[:, 2] > 0]
    turned = solid.vertices @ quaternion_to_matrix(turn([1, 0, 0], angle)).T
    triangles = np.concatenate([half, half[:, ::-1] + len(turned)])
    on = np.repeat([0, 1], len(half))
    sphere = Surface("sphere", [0, 0, 0], radius=1.0)
    inner = Surface("sphere", [0, 0, 0], radius=1.0, hollow=hollow)
    return Solid(
        np.concatenate([solid.vertices, turned]), triangles, (sphere, inner), on,
        1.0, [0, 0, 0], np.eye(3), sagitta=solid.sagitta,
    )  # fmt: skip


@pytest.mark.parametrize("angle", sampled(3, [60.0, 80.0, 100.0, 5.0, 120.0, 175.0]))
def test_faces_on_each_other_are_recognised_by_the_shared_area(angle: float) -> None:
    assert has_doubled_faces(two_hemispheres(angle)) == (1 - angle / 180 > DOUBLED)


def test_faces_with_material_on_the_same_side_are_no_error() -> None:
    assert not has_doubled_faces(two_hemispheres(5.0, hollow=False))


def test_a_solid_with_doubled_faces_is_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    ball = ball_of(1.0)
    assert checked_solid(ball) is ball
    monkeypatch.setattr(checking, "has_doubled_faces", lambda solid: True)
    with pytest.raises(InputError, match="lie on each other"):
        checked_solid(ball)


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here: ../shared/data")
def test_the_head_of_the_spaceship_has_the_mass_of_its_other_export() -> None:
    wrong = load(DATA / "s1-c5-214" / "s1-c5-214.stp")
    right = load(DATA / "s1-tu-203" / "s1-tu-203.stp")
    mass = dict(zip(wrong.names, wrong.geometry.mass, strict=True))
    known = dict(zip(right.names, right.geometry.mass, strict=True))
    assert mass["HEAD_FRONT"] == pytest.approx(known["headfront"], rel=1e-4)
    assert mass["HEAD_BACK"] == pytest.approx(known["headback"], rel=0.03)
    assert any("HEAD_BACK" in note and "other side" in note for note in wrong.notes)
