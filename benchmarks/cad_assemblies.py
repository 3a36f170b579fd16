"""Random assemblies as engineers draw them in CAD, written as STEP files, with a known outcome.

An assembly is a base plate with one to four modules: bolted stacks, press fits, inserts, shafts in
bearings, dovetails, keys, tabs in slots, lids, and so on. The drawing has the usual properties of
such files: clearances, cosmetic or interfering threads, fillets and chamfers, engraved pockets,
nested and mirrored sub-assemblies, units, bodies drawn twice, hidden variants, misplaced copies.

The outcome is known by construction. `Drawn.joined` are the pairs that a designer would call
joined. `Drawn.falls` are the parts that fall although these pairs are joined; the assembly holds if
there are none. OCCT makes all solids; lengths are mm inside this module.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

__all__ = ["MODULES", "Drawn", "draw"]

Solid = Any
Point = tuple[float, float, float]
UNITS = ("mm", "mm", "mm", "in", "m")
"""Units of the files; millimetres are the most frequent."""


@dataclass
class Drawn:
    """A drawn assembly: its product tree, and the outcome that its maker knows.

    Attributes
    ----------
    tree : list of (str, solid or list, gp_Trsf or None)
        Products, as `write_step` of the tests takes them.
    joined : list of (str, str)
        Pairs of parts that are meant to be joined.
    falls : set of str
        Parts that fall although these pairs are joined.
    units : str
        Length unit of the file.
    kinds : list of str
        Names of the modules and of the flaws of the drawing.
    """

    tree: list[tuple[str, Any, Any]] = field(default_factory=list)
    joined: list[tuple[str, str]] = field(default_factory=list)
    falls: set[str] = field(default_factory=set)
    units: str = "mm"
    kinds: list[str] = field(default_factory=list)

    def add(self, name: str, solid: Solid, at: Point = (0.0, 0.0, 0.0)) -> str:
        """Add a solid at a position, and return its name."""
        self.tree.append((name, solid, shift(at)))
        return name

    @property
    def names(self) -> list[str]:
        """Names of the top products."""
        return [name for name, _, _ in self.tree]


# solids -----------------------------------------------------------------------------------


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


# modules ----------------------------------------------------------------------------------
# each adds parts about (0, 0) at the height z of the base's top face; its foot is within 25 mm


@dataclass
class Site:
    """The place of a module: its middle, the top of the base, and a prefix for its names."""

    x: float
    y: float
    z: float
    prefix: str
    hole: list[Solid] = field(default_factory=list)
    """Solids to cut from the base."""

    def at(self, dx: float = 0.0, dy: float = 0.0, dz: float = 0.0) -> Point:
        """A point relative to the middle of the site."""
        return (self.x + dx, self.y + dy, self.z + dz)


Module = Callable[[np.random.Generator, Drawn, Site], None]


def _bolt(radius: float, length: float, head: float) -> Solid:
    """A bolt along -z below its head, whose lower face is at 0."""
    return fuse(hexagon(3.4 * radius, 0, head), rod(radius, -length, 0))


def bolted_stack(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """Plates on a raised foot, a bolt from above with washer and nut below, some without nut."""
    radius = float(rng.uniform(1.5, 4.0))
    hole = radius + float(rng.uniform(0.1, 0.6))
    foot = drawn.add(f"{site.prefix}_foot", ring(14.0, 18.0, 0, 30), site.at())
    plates = int(rng.integers(1, 4))
    top = 30.0
    for k in range(plates):
        thick = float(rng.uniform(2, 6))
        plate = eased(ring(hole, 18.0, 0, thick), rng, 0.4)
        drawn.add(f"{site.prefix}_plate{k}", plate, site.at(dz=top))
        top += thick
    below = 30.0
    washer = rng.random() < 0.5
    if washer:
        drawn.add(f"{site.prefix}_washer", ring(hole, 2.6 * radius, 0, 1.0), site.at(dz=top))
        top += 1.0
    height = 1.6 * radius
    length = top - below + height + 2.0
    kind = rng.choice(["cosmetic", "cut", "none"])
    upward = rng.random() < 0.5
    shank = radius * (1.06 if kind == "cut" else 1.0)
    bolt_solid = _bolt(shank if kind == "cut" else radius, length, height)
    nut_solid = cut(hexagon(3.4 * radius, 0, height), rod(radius, -1, height + 1))
    if kind == "cut":
        hole_needed = shank + 0.05
        if hole_needed > hole:  # the thread would touch the plates: a drawing without this clash
            bolt_solid = fuse(
                hexagon(3.4 * radius, 0, height),
                rod(radius, -(top - below), 0),
                rod(shank, -length, -(top - below)),
            )
    bolt = f"{site.prefix}_bolt"
    if upward:  # the head is below and the nut on top: without the nut the bolt falls
        turn = gp_Trsf()
        turn.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)))
        drawn.tree.append((bolt, bolt_solid, shift(site.at(dz=below)).Multiplied(turn)))
    else:
        drawn.add(bolt, bolt_solid, site.at(dz=top))
    if kind == "none":
        if upward:
            drawn.falls.add(bolt)
        drawn.kinds.append("bolt without nut")
        return
    nut = f"{site.prefix}_nut"
    drawn.add(nut, nut_solid, site.at(dz=top if upward else below - height))
    drawn.joined.append((bolt, nut))
    drawn.kinds.append(f"bolted stack, {kind} thread")
    _ = foot


def press_fit(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A pin that hangs in a plate on a foot: pressed in, or with clearance, so that it falls."""
    radius = float(rng.uniform(2, 6))
    over = float(rng.uniform(0.005, 0.04))
    pressed = rng.random() < 0.7
    drawn.add(f"{site.prefix}_foot", ring(14.0, 18.0, 0, 30), site.at())
    drawn.add(f"{site.prefix}_plate", ring(radius, 18.0, 0, 5), site.at(dz=30))
    size = radius + over if pressed else radius - float(rng.uniform(0.05, 0.2))
    pin = drawn.add(f"{site.prefix}_pin", rod(size, 0, 20), site.at(dz=18))
    if pressed:
        drawn.joined.append((pin, f"{site.prefix}_plate"))
    else:
        drawn.falls.add(pin)
    drawn.kinds.append("press fit" if pressed else "loose pin")


def insert(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A threaded insert melted into the underside of a printed bracket."""
    radius = float(rng.uniform(2, 4))
    bracket = fuse(box((-18, -10, 0), (-12, 10, 30)), box((-18, -10, 30), (18, 10, 40)))
    bracket = fuse(bracket, box((12, -10, 0), (18, 10, 30)))
    bracket = cut(bracket, rod(radius, 29, 36))
    name = drawn.add(f"{site.prefix}_bracket", eased(bracket, rng, 0.5), site.at())
    body = ring(0.6 * radius, radius + float(rng.uniform(0.05, 0.3)), 0, 5)
    piece = drawn.add(f"{site.prefix}_insert", body, site.at(dz=30))
    drawn.joined.append((piece, name))
    drawn.kinds.append("insert")


def bearing(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A shaft in two pedestals, size on size or with a running clearance, with a collar."""
    radius = float(rng.uniform(3, 6))
    play = 0.0 if rng.random() < 0.5 else float(rng.uniform(0.01, 0.05))
    for k, y in enumerate((-14.0, 10.0)):
        block = cut(
            box((-10, y, 0), (10, y + 4, 30)),
            rod(radius + play, y - 1, y + 5, (0, 0, 20), (0, 1, 0)),
        )
        drawn.add(f"{site.prefix}_pedestal{k}", block, site.at())
    solid = rod(radius, -20, 20, (0, 0, 20 - play), (0, 1, 0))
    drawn.add(f"{site.prefix}_shaft", solid, site.at())
    drawn.kinds.append("shaft, size on size" if play == 0.0 else "shaft resting with play")


def dovetail(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A slider that hangs in a dovetail below a beam on two posts."""
    half, deep = float(rng.uniform(4, 7)), float(rng.uniform(3, 6))
    flare = deep * float(rng.uniform(0.3, 0.8))
    tail = [(-half, 30.0), (half, 30.0), (half + flare, 30 + deep), (-half - flare, 30 + deep)]
    beam = cut(box((-18, -10, 30), (18, 10, 45)), prism(tail, -11, 11))
    beam = fuse(beam, box((-18, -10, 0), (-15, 10, 30)), box((15, -10, 0), (18, 10, 30)))
    drawn.add(f"{site.prefix}_beam", beam, site.at())
    slider = fuse(prism(tail, -8, 8), box((-half, -8, 20), (half, 8, 30)))
    drawn.add(f"{site.prefix}_slider", slider, site.at())
    drawn.kinds.append("dovetail")


def key(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A shaft that stands in a socket of a foot, with a feather key between shaft and hub."""
    radius = float(rng.uniform(5, 8))
    wide = radius * 0.5
    foot = cut(rod(18, 0, 10), rod(radius, 4, 12))
    drawn.add(f"{site.prefix}_foot", foot, site.at())
    slot = box((radius - 2, -wide / 2, 14), (radius + 2, wide / 2, 22))
    drawn.add(f"{site.prefix}_shaft", cut(rod(radius, 4, 40), slot), site.at())
    hub_slot = box((radius - 2, -wide / 2, 9), (radius + 2, wide / 2, 23))
    hub = cut(ring(radius, 16.0, 10, 22), hub_slot)
    drawn.add(f"{site.prefix}_hub", hub, site.at())
    drawn.add(f"{site.prefix}_key", slot, site.at())
    drawn.kinds.append("key")


def tabs(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A sheet that stands on a foot, with tabs in slots with clearance; or whose tabs hang free."""
    thick, play = float(rng.uniform(1, 3)), float(rng.uniform(0.05, 0.25))
    slots = [
        box((x, -thick / 2 - play, 2), (x + 6 + 2 * play, thick / 2 + play, 10))
        for x in (-14.0, 8.0)
    ]
    drawn.add(f"{site.prefix}_foot", cut(box((-18, -12, 0), (18, 12, 6)), *slots), site.at())
    sheet = box((-18, -thick / 2, 6), (18, thick / 2, 26))
    for x in (-14.0 + play, 8.0 + play):
        sheet = fuse(sheet, box((x, -thick / 2, 3), (x + 6, thick / 2, 6)))
    drawn.add(f"{site.prefix}_sheet", eased(sheet, rng, 0.2), site.at())
    drawn.kinds.append("tabs")


def lid(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A box with a snap-fit lid that rests on its rim, with clearance inside."""
    play = float(rng.uniform(0.05, 0.3))
    case = cut(box((-18, -12, 0), (18, 12, 16)), box((-16, -10, 2), (16, 10, 20)))
    drawn.add(f"{site.prefix}_case", eased(case, rng, 0.5), site.at())
    cover = fuse(
        box((-18, -12, 16), (18, 12, 18)),
        box((-16 + play, -10 + play, 13), (16 - play, 10 - play, 16)),
    )
    cover = engraved(cover, rng, (-4, -2, 18), 0.4)
    drawn.add(f"{site.prefix}_lid", cover, site.at())
    drawn.kinds.append("lid")


def ball_seat(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A ball on a ring-shaped seat, or balls in a groove under a plate."""
    radius = float(rng.uniform(5, 9))
    inner = radius * float(rng.uniform(0.4, 0.8))
    drawn.add(f"{site.prefix}_seat", ring(inner, 16.0, 0, 8), site.at())
    height = 8 + float(np.sqrt(radius**2 - inner**2))
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, height), radius).Solid()
    drawn.add(f"{site.prefix}_ball", ball, site.at())
    drawn.kinds.append("ball in a seat")


def o_ring(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """An O-ring around a pin, drawn undeformed, so that it overlaps the pin; a cap on the pin."""
    radius, cord = float(rng.uniform(5, 8)), float(rng.uniform(1, 2))
    drawn.add(f"{site.prefix}_pin", fuse(rod(14, 0, 4), rod(radius, 4, 20)), site.at())
    squeeze = float(rng.uniform(0.05, 0.2)) * cord
    frame = gp_Ax2(gp_Pnt(0, 0, 12), gp_Dir(0, 0, 1))
    torus = BRepPrimAPI_MakeTorus(frame, radius + cord - squeeze, cord).Solid()
    seal = drawn.add(f"{site.prefix}_oring", torus, site.at())
    drawn.joined.append((seal, f"{site.prefix}_pin"))
    drawn.kinds.append("O-ring")


MODULES: tuple[Module, ...] = (
    bolted_stack,
    bolted_stack,
    press_fit,
    insert,
    bearing,
    dovetail,
    key,
    tabs,
    lid,
    ball_seat,
    o_ring,
)
"""The modules; a bolted stack is twice as frequent."""


# flaws of a drawing -----------------------------------------------------------------------


def _drawn_twice(rng: np.random.Generator, drawn: Drawn) -> None:
    """Add a copy of a part in the same place."""
    name, solid, place = drawn.tree[int(rng.integers(1, len(drawn.tree)))]  # not the base
    drawn.tree.append((f"{name}_copy", solid, place))
    drawn.joined.append((f"{name}_copy", name))
    if name in drawn.falls:
        drawn.falls.add(f"{name}_copy")
    drawn.kinds.append("drawn twice")


def _misplaced(rng: np.random.Generator, drawn: Drawn) -> None:
    """Add a box on the base that is sunk into it by 0.1 to 3 mm."""
    sunk = float(10 ** rng.uniform(-1, 0.5))
    drawn.add("misplaced_box", box((0, 0, 0), (10, 10, 10)), (-45.0, -45.0, -sunk))
    drawn.joined.append(("misplaced_box", "base"))
    drawn.kinds.append("misplaced")


def _nested(drawn: Drawn) -> None:
    """Put the parts of each site into a sub-assembly."""
    groups: dict[str, list[tuple[str, Any, Any]]] = {}
    top = []
    for node in drawn.tree:
        site = node[0].split("_")[0]
        if site.startswith("m") and site[1:].isdigit():
            groups.setdefault(site, []).append(node)
        else:
            top.append(node)
    drawn.tree = top + [(f"unit_{site}", nodes, None) for site, nodes in groups.items()]
    drawn.kinds.append("nested")


def draw(seed: int) -> Drawn:
    """The random assembly of a seed."""
    rng = np.random.default_rng(seed)
    drawn = Drawn(units=str(rng.choice(UNITS)))
    count = int(rng.integers(1, 5))
    sites = [(-25.0, -25.0), (25.0, -25.0), (-25.0, 25.0), (25.0, 25.0)][:count]
    base = engraved(box((-50, -50, -10), (50, 50, 0)), rng, (40, 40, 0), 0.3)
    drawn.add("base", eased(base, rng, 1.0))
    for k, (x, y) in enumerate(sites):
        module = MODULES[int(rng.integers(len(MODULES)))]
        module(rng, drawn, Site(x, y, 0.0, f"m{k}"))
    if rng.random() < 0.1:
        _drawn_twice(rng, drawn)
    if rng.random() < 0.1:
        _misplaced(rng, drawn)
    if rng.random() < 0.4:
        _nested(drawn)
    drawn.tree = [("product", drawn.tree, None)]  # a root product has no placement of its own
    return drawn
