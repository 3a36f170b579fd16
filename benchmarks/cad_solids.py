"""Solids of OCCT in mm, from which `cad_modules` builds parts as engineers draw them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Transform,
)
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepLib import BRepLib
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipeShell
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeRevol,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.Geom import Geom_CylindricalSurface
from OCP.Geom2d import Geom2d_Line
from OCP.gp import (
    gp_Ax1,
    gp_Ax2,
    gp_Ax3,
    gp_Dir,
    gp_Dir2d,
    gp_Pnt,
    gp_Pnt2d,
    gp_Trsf,
    gp_Vec,
)
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

Solid = Any
Point = tuple[float, float, float]


def shift(at: Point) -> gp_Trsf:
    """A translation."""
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(*at))
    return move


def box(low: Point, high: Point) -> Solid:
    """A box between two corners."""
    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Solid()


def rod(
    radius: float, low: float, high: float, at: Point = (0, 0, 0), axis: Point = (0, 0, 1)
) -> Solid:
    """A cylinder from height `low` to `high` along an axis through a point."""
    start = np.array(at) + low * np.array(axis)
    frame = gp_Ax2(gp_Pnt(*start.tolist()), gp_Dir(*axis))
    return BRepPrimAPI_MakeCylinder(frame, radius, high - low).Solid()


def cut(solid: Solid, *tools: Solid) -> Solid:
    """A solid without others."""
    for tool in tools:
        solid = BRepAlgoAPI_Cut(solid, tool).Shape()
    return solid


def fuse(solid: Solid, *others: Solid) -> Solid:
    """The union of solids that touch."""
    for other in others:
        solid = BRepAlgoAPI_Fuse(solid, other).Shape()
    return solid


def ring(inner: float, outer: float, low: float, high: float) -> Solid:
    """A tube about z."""
    return cut(rod(outer, low, high), rod(inner, low - 1, high + 1))


def prism(corners: list[tuple[float, float]], low: float, high: float) -> Solid:
    """A polygon in the x-z plane, extruded along y."""
    outline = BRepBuilderAPI_MakePolygon()
    for x, z in corners:
        outline.Add(gp_Pnt(x, low, z))
    outline.Close()
    face = BRepBuilderAPI_MakeFace(outline.Wire()).Face()
    return BRepPrimAPI_MakePrism(face, gp_Vec(0, high - low, 0)).Shape()


def hexagon(across: float, low: float, high: float) -> Solid:
    """A hexagonal prism about z with the given width across flats."""
    radius = across / np.sqrt(3)
    angles = np.arange(6) * np.pi / 3
    outline = BRepBuilderAPI_MakePolygon()
    for t in angles.tolist():
        outline.Add(gp_Pnt(radius * np.cos(t), radius * np.sin(t), low))
    outline.Close()
    face = BRepBuilderAPI_MakeFace(outline.Wire()).Face()
    return BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, high - low)).Shape()


def eased(solid: Solid, rng: np.random.Generator, size: float) -> Solid:
    """The solid with one edge rounded or chamfered; unchanged if OCCT cannot do it."""
    edges = []
    explorer = TopExp_Explorer(solid, TopAbs_EDGE)
    while explorer.More():
        edges.append(TopoDS.Edge(explorer.Current()))
        explorer.Next()
    maker = (BRepFilletAPI_MakeFillet if rng.random() < 0.5 else BRepFilletAPI_MakeChamfer)(solid)
    try:
        maker.Add(size, edges[int(rng.integers(len(edges)))])
        maker.Build()
        return maker.Shape() if maker.IsDone() else solid
    except Exception:  # OCCT raises errors of many types
        return solid


def engraved(solid: Solid, rng: np.random.Generator, at: Point, depth: float) -> Solid:
    """The solid with three engraved strokes, as of letters, in its top face at a point."""
    x, y, z = at
    for k in range(3):
        width = float(rng.uniform(0.3, 0.8))
        low = (x + 2.0 * k, y, z - depth)
        solid = cut(solid, box(low, (x + 2.0 * k + width, y + 3.0, z + 1.0)))
    return solid


def ball(radius: float, centre: Point) -> Solid:
    """A sphere."""
    return BRepPrimAPI_MakeSphere(gp_Pnt(*centre), radius).Solid()


def torus(large: float, small: float, height: float) -> Solid:
    """A torus about z, whose circle of radius `large` lies at a height."""
    frame = gp_Ax2(gp_Pnt(0, 0, height), gp_Dir(0, 0, 1))
    return BRepPrimAPI_MakeTorus(frame, large, small).Solid()


def revolved(profile: Sequence[tuple[float, float]]) -> Solid:
    """A polygon of points (radius, z), revolved about z."""
    outline = BRepBuilderAPI_MakePolygon()
    for r, z in profile:
        outline.Add(gp_Pnt(r, 0, z))
    outline.Close()
    face = BRepBuilderAPI_MakeFace(outline.Wire()).Face()
    return BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()


def grooved_rod(minor: float, major: float, low: float, teeth: int, pitch: float) -> Solid:
    """A rod with ring-shaped teeth about z: a thread as many modellers cut it, without a lead."""
    profile = [(0.0, low)]
    for k in range(teeth):
        start = low + k * pitch
        profile += [(minor, start), (major, start + pitch / 2)]
    profile += [(minor, low + teeth * pitch), (0.0, low + teeth * pitch)]
    return revolved(profile)


def helical_ridge(minor: float, major: float, pitch: float, low: float, high: float) -> Solid:
    """A ridge along a helix about z, from just below the radius `minor` to the radius `major`."""
    surface = Geom_CylindricalSurface(gp_Ax3(gp_Pnt(0, 0, low), gp_Dir(0, 0, 1)), minor)
    length = np.hypot(2 * np.pi, pitch) * (high - low) / pitch
    line = Geom2d_Line(gp_Pnt2d(0, 0), gp_Dir2d(2 * np.pi, pitch))
    edge = BRepBuilderAPI_MakeEdge(line, surface, 0.0, float(length)).Edge()
    BRepLib.BuildCurves3d_s(edge)
    foot, tip = 0.4 * pitch, 0.1 * pitch
    inner = minor - 0.1 * (major - minor)
    outline = BRepBuilderAPI_MakePolygon()
    for r, z in ((inner, -foot), (major, -tip), (major, tip), (inner, foot)):
        outline.Add(gp_Pnt(r, 0, low + z))
    outline.Close()
    sweep = BRepOffsetAPI_MakePipeShell(BRepBuilderAPI_MakeWire(edge).Wire())
    sweep.SetMode(True)
    sweep.Add(outline.Wire())
    sweep.Build()
    sweep.MakeSolid()
    return sweep.Shape()


def mirrored(solid: Solid, x: float) -> Solid:
    """A mirror image of a solid in the plane of a constant x: a shape of its own."""
    mirror = gp_Trsf()
    mirror.SetMirror(gp_Ax2(gp_Pnt(x, 0, 0), gp_Dir(1, 0, 0)))
    return BRepBuilderAPI_Transform(solid, mirror, True).Shape()


def placed(solid: Solid, place: gp_Trsf | None) -> Solid:
    """A copy of a solid in its place."""
    return BRepBuilderAPI_Transform(solid, place or gp_Trsf(), True).Shape()


def scaled(solid: Solid, factor: float) -> Solid:
    """A solid with all lengths multiplied by a factor."""
    scale = gp_Trsf()
    scale.SetScaleFactor(factor)
    return BRepBuilderAPI_Transform(solid, scale, True).Shape()


LETTERS = {
    "I": [("box", 0.0, 0.0, 0.3, 2.0)],
    "L": [("box", 0.0, 0.0, 0.3, 2.0), ("box", 0.3, 0.0, 1.2, 0.3)],
    "T": [("box", 0.45, 0.0, 0.75, 1.7), ("box", 0.0, 1.7, 1.2, 2.0)],
    "H": [("box", 0.0, 0.0, 0.3, 2.0), ("box", 0.9, 0.0, 1.2, 2.0), ("box", 0.3, 0.9, 0.9, 1.1)],
    "O": [("arc", 0.6, 1.0, 0.35, 0.6)],
    "8": [("arc", 0.6, 0.5, 0.2, 0.5), ("arc", 0.6, 1.5, 0.2, 0.499)],
    "P": [("box", 0.0, 0.0, 0.3, 2.0), ("arc", 0.6, 1.4, 0.25, 0.6)],
}
"""Strokes of letters, 2 high: rectangles (low corner, high corner), rings (middle, two radii)."""


def engraved_text(solid: Solid, text: str, at: Point, height: float, depth: float) -> Solid:
    """A solid with a text cut into it from above; `at`: its lower left corner on the face."""
    size = height / 2.0
    x, y, z = at
    tools = []
    for place, letter in enumerate(text):
        left = x + 1.6 * size * place
        for kind, a, b, c, d in LETTERS[letter]:
            if kind == "box":
                low = (left + a * size, y + b * size, z - depth)
                tools.append(box(low, (left + c * size, y + d * size, z + 1.0)))
            else:
                pipe = ring(c * size, d * size, z - depth, z + 1.0)
                tools.append(placed(pipe, shift((left + a * size, y + b * size, 0.0))))
    return cut(solid, *tools)
