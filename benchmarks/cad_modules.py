"""Modules of random CAD drawings: bolts, fits, seats, slides, sheets, with a known outcome.

Each module adds parts about the middle of a site, above the top of the base; its foot is within
25 mm of the middle. OCCT makes all solids; lengths are mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from cad_solids import (
    Point,
    Solid,
    ball,
    box,
    cut,
    eased,
    engraved,
    fuse,
    hexagon,
    prism,
    ring,
    rod,
    shift,
    torus,
)
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf


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
        Parts that fall although these pairs are joined, each by its name or a tail of its path.
    inches : list of str
        Parts whose product states inches, in a file of millimetres.
    units : str
        Length unit of the file.
    kinds : list of str
        Names of the modules and of the flaws of the drawing.
    """

    tree: list[tuple[str, Any, Any]] = field(default_factory=list)
    joined: list[tuple[str, str]] = field(default_factory=list)
    falls: set[str] = field(default_factory=set)
    inches: list[str] = field(default_factory=list)
    units: str = "mm"
    kinds: list[str] = field(default_factory=list)

    def add(self, name: str, solid: Solid, at: Point = (0.0, 0.0, 0.0)) -> str:
        """Add a solid at a position, and return its name."""
        self.tree.append((name, solid, shift(at)))
        return name

    def turn_last(self, angle: float) -> None:
        """Turn the last part about the vertical axis through its origin [rad]."""
        name, solid, place = self.tree[-1]
        turn = gp_Trsf()
        turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), angle)
        self.tree[-1] = (name, solid, place.Multiplied(turn))


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


def bolt(radius: float, length: float, head: float) -> Solid:
    """A bolt along -z below its head, whose lower face is at 0."""
    return fuse(hexagon(3.4 * radius, 0, head), rod(radius, -length, 0))


def bolted_stack(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """Plates on a raised foot, a bolt from above with washer and nut below, some without nut."""
    radius = float(rng.uniform(1.5, 4.0))
    hole = radius + float(rng.uniform(0.1, 0.6))
    drawn.add(f"{site.prefix}_foot", ring(14.0, 18.0, 0, 30), site.at())
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
    solid = bolt(shank if kind == "cut" else radius, length, height)
    nut_solid = cut(hexagon(3.4 * radius, 0, height), rod(radius, -1, height + 1))
    if kind == "cut":
        hole_needed = shank + 0.05
        if hole_needed > hole:  # the thread would touch the plates: a drawing without this clash
            solid = fuse(
                hexagon(3.4 * radius, 0, height),
                rod(radius, -(top - below), 0),
                rod(shank, -length, -(top - below)),
            )
    name = f"{site.prefix}_bolt"
    if upward:  # the head is below and the nut on top: without the nut the bolt falls
        turn = gp_Trsf()
        turn.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)))
        drawn.tree.append((name, solid, shift(site.at(dz=below)).Multiplied(turn)))
    else:
        drawn.add(name, solid, site.at(dz=top))
    if kind == "none":
        if upward:
            drawn.falls.add(name)
        drawn.kinds.append("bolt without nut")
        return
    nut = f"{site.prefix}_nut"
    drawn.add(nut, nut_solid, site.at(dz=top if upward else below - height))
    drawn.joined.append((name, nut))
    drawn.kinds.append(f"bolted stack, {kind} thread")


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
    drawn.add(f"{site.prefix}_ball", ball(radius, (0, 0, height)), site.at())
    drawn.kinds.append("ball in a seat")


def o_ring(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """An O-ring around a pin, drawn undeformed, so that it overlaps the pin; a cap on the pin."""
    radius, cord = float(rng.uniform(5, 8)), float(rng.uniform(1, 2))
    drawn.add(f"{site.prefix}_pin", fuse(rod(14, 0, 4), rod(radius, 4, 20)), site.at())
    squeeze = float(rng.uniform(0.05, 0.2)) * cord
    cord_ring = torus(radius + cord - squeeze, cord, 12)
    seal = drawn.add(f"{site.prefix}_oring", cord_ring, site.at())
    drawn.joined.append((seal, f"{site.prefix}_pin"))
    drawn.kinds.append("O-ring")
