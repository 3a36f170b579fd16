"""Further modules of random CAD drawings: flanges, ball bearings, threads, snaps, cabinets.

As in `cad_modules`, each module adds parts about the middle of a site, with a known outcome.
"""

from __future__ import annotations

import numpy as np
from cad_modules import Drawn, Site, bolt
from cad_solids import (
    Solid,
    ball,
    box,
    cut,
    eased,
    engraved_text,
    fuse,
    grooved_rod,
    helical_ridge,
    hexagon,
    ring,
    rod,
    torus,
)

from kilter.analysis.assumptions.assume import MOST_PLAY
from kilter.units import METRES


def flange(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """Two flanges of pipes with three to eight equal bolts in clearance holes, most with nuts."""
    radius = float(rng.uniform(1.0, 1.8))
    hole = radius + float(rng.uniform(0.1, 0.5))
    count, thick = int(rng.integers(3, 9)), float(rng.uniform(3, 5))
    middle = 22.0 - 3.4 * radius
    angles = 2 * np.pi * np.arange(count) / count
    places = [(middle * np.cos(t), middle * np.sin(t)) for t in angles.tolist()]
    holes = [rod(hole, -1, 60, (x, y, 0)) for x, y in places]
    lower = cut(fuse(ring(8, 10, 0, 25), ring(8, 22, 25, 25 + thick)), *holes)
    upper = fuse(ring(8, 10, 25 + thick, 45), ring(8, 22, 25 + thick, 25 + 2 * thick))
    drawn.add(f"{site.prefix}_lower", eased(lower, rng, 0.3), site.at())
    drawn.add(f"{site.prefix}_upper", eased(cut(upper, *holes), rng, 0.3), site.at())
    height = 1.6 * radius
    screw = bolt(radius, 2 * thick + height + 1.0, height)
    nut = cut(hexagon(3.4 * radius, 0, height), rod(radius, -1, height + 1))
    has_nuts = rng.random() < 0.8
    for k, (x, y) in enumerate(places, start=1):
        drawn.add(f"{site.prefix}_screw", screw, site.at(x, y, 25 + 2 * thick))
        if has_nuts:
            drawn.add(f"{site.prefix}_nut", nut, site.at(x, y, 25 - height))
            drawn.joined.append((f"{site.prefix}_screw_{k}", f"{site.prefix}_nut_{k}"))
    drawn.kinds.append("flange" if has_nuts else "flange without nuts")


def ball_bearing(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A shaft with a collar in a bearing of two rings and balls, in a bored housing."""
    size, count = float(rng.uniform(2.0, 3.0)), int(rng.integers(5, 10))
    pitch, half, middle = 11.0, 1.6 * size, 16.0
    play = 0.0 if rng.random() < 0.6 else float(rng.uniform(0.01, 0.05))
    inner, outer = pitch - 2.0 * size, pitch + 2.0 * size
    groove = torus(pitch, size + play, middle)
    low, high = middle - half, middle + half
    bore = rod(outer, low, high + 5)
    housing = cut(rod(outer + 4, 0, high), bore, rod(outer - size, 4, low + 1))
    drawn.add(f"{site.prefix}_housing", eased(housing, rng, 0.3), site.at())
    outer_ring = cut(ring(pitch + 0.5 * size, outer, low, high), groove)
    drawn.add(f"{site.prefix}_outer", outer_ring, site.at())
    inner_ring = cut(ring(inner, pitch - 0.5 * size, low, high), groove)
    drawn.add(f"{site.prefix}_inner", inner_ring, site.at())
    solid = ball(size, (pitch, 0, middle))
    for t in (2 * np.pi * np.arange(count) / count).tolist():
        drawn.add(f"{site.prefix}_ball", solid, site.at())
        drawn.turn_last(t)
    names = [f"{site.prefix}_ball_{k}" for k in range(1, count + 1)]
    if play:
        drawn.joined += [
            (name, f"{site.prefix}_{which}") for name in names for which in ("inner", "outer")
        ]
    shaft = fuse(rod(inner, low - 5, 40), rod(inner + 0.4 * size, high, high + 4))
    drawn.add(f"{site.prefix}_shaft", shaft, site.at())
    drawn.kinds.append("ball bearing with play" if play else "ball bearing, size on size")


def threaded(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A screw from below in a nut above a plate, with teeth that are cut as rings or a helix."""
    minor = float(rng.uniform(3, 4.5))
    pitch = float(rng.uniform(0.8, 1.2))
    major = minor + 0.4 * pitch
    is_helix = rng.random() < 0.4
    play = 0.0 if rng.random() < 0.3 and not is_helix else float(rng.uniform(0.02, 0.08))
    drawn.add(f"{site.prefix}_foot", ring(14, 18, 0, 30), site.at())
    drawn.add(f"{site.prefix}_plate", ring(major + 0.3, 18, 30, 34), site.at())

    def cut_thread(minor: float, major: float, is_helix: bool) -> Solid:
        """A shank with teeth from below the nut, at the height 34, to above it."""
        end = 34.0 + 7 * pitch
        if is_helix:  # the end of a ridge lies within the shank, where OCCT unites them reliably
            ridge = helical_ridge(minor, major, pitch, 34 - pitch, end - pitch)
            return fuse(rod(minor, 30, end), ridge)
        teeth = grooved_rod(minor, major, 34 - pitch, 8, pitch)
        return fuse(rod(minor, 30, 34 - pitch), teeth)

    shank = cut_thread(minor, major, is_helix)
    tool = cut_thread(minor + play, major + play, is_helix)
    head = hexagon(3.4 * minor, 30 - minor, 30)
    drawn.add(f"{site.prefix}_screw", fuse(shank, head), site.at())
    body = hexagon(3.4 * major, 34, 34 + 5 * pitch)
    drawn.add(f"{site.prefix}_nut", cut(body, tool), site.at())
    drawn.joined.append((f"{site.prefix}_screw", f"{site.prefix}_nut"))
    drawn.kinds.append(f"thread cut as {'a helix' if is_helix else 'rings'}")


def snap_cover(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A cover that hangs below a frame by two snap hooks, drawn on their ledges or short of it."""
    gap = 0.0 if rng.random() < 0.6 else float(rng.uniform(0.05, 0.3))
    frame = cut(box((-18, -12, 0), (18, 12, 20)), box((-15, -13, -1), (15, 13, 16)))
    frame = cut(frame, box((-8, -5, 15), (8, 5, 21)))
    text = "".join(rng.choice(["I", "L", "T", "H", "O", "8", "P"], size=2))
    frame = engraved_text(frame, text, (-4.0, -11.5, 20.0), 5.0, 0.4)
    drawn.add(f"{site.prefix}_frame", frame, site.at())
    # the hooks pass a window of the frame, and their noses lie on its top at the height 20
    cover = box((-7, -8, 10), (7, 8, 13))
    for side in (-1, 1):
        arm = box((min(5 * side, 7 * side), -4, 13), (max(5 * side, 7 * side), 4, 24))
        nose = box((min(7 * side, 10 * side), -4, 20 + gap), (max(7 * side, 10 * side), 4, 24))
        cover = fuse(cover, arm, nose)
    drawn.add(f"{site.prefix}_cover", cover, site.at())
    if gap * METRES[drawn.units] > MOST_PLAY:  # in a drawing in inches or metres
        drawn.falls.add(f"{site.prefix}_cover")
    elif gap:
        drawn.joined.append((f"{site.prefix}_cover", f"{site.prefix}_frame"))
    drawn.kinds.append("snap hooks with play" if gap else "snap hooks")


def cabinet(rng: np.random.Generator, drawn: Drawn, site: Site) -> None:
    """A cabinet of folded or flat sheets with many tabs in slots that have play."""
    thick, play = float(rng.uniform(1, 2)), float(rng.uniform(0.05, 0.2))
    high = float(rng.uniform(40, 80))
    starts = (-16.0, -3.0, 10.0)

    def tab(x: float, y: float, low: float, up: float, wider: float) -> Solid:
        return box((x - wider, y - wider, low), (x + thick + wider, y + 6 + wider, up))

    sides = (-15.0, 15.0 - thick)
    slots = [tab(x, y, 0, 9, play) for x in sides for y in starts]
    foot = cut(box((-20, -20, 2), (20, 20, 4)), *slots)
    foot = fuse(foot, box((-20, -20, 0), (-18, 20, 2)), box((18, -20, 0), (20, 20, 2)))
    drawn.add(f"{site.prefix}_foot", foot, site.at())
    roof_slots = [tab(x, y, high - 1, high + 9, play) for x in sides for y in starts]
    for k, x in enumerate(sides):
        sheet = box((x, -18, 4), (x + thick, 18, high))
        for y in starts:
            sheet = fuse(sheet, tab(x, y, 2.5, 4, 0.0), tab(x, y, high, high + 2.0, 0.0))
        drawn.add(f"{site.prefix}_side{k}", eased(sheet, rng, 0.2), site.at())
    roof = cut(box((-20, -20, high), (20, 20, high + 2)), *roof_slots)
    text = "".join(rng.choice(["I", "L", "T", "H", "O", "8", "P"], size=3))
    roof = engraved_text(roof, text, (-8, -4, high + 2), 6.0, 0.3)
    drawn.add(f"{site.prefix}_roof", roof, site.at())
    drawn.kinds.append("cabinet of sheets")
