"""Scenes that depend on friction: ladder, bracket, books, H, A and V block, trough.

Without friction only `v_block` is stable. With friction, equilibrium forces exist within the
limit that each scene states. Except for the ladder, this does not imply that the parts must hold.
"""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly, FrictionPair, GivenContact, Load, Part
from kilter.errors import InputError
from kilter.scenes.pieces import block, cells, floor, prism
from kilter.scenes.registry import listed

# Scenes without friction whose first accelerations are known in closed form.


@listed(
    "wedge-on-wedge",
    "a wedge slides down a wedge that slides on the floor",
    source="S8",
    answer="unstable",
)
def wedge_on_wedge(
    angle: float = 30.0, *, mass: float = 1.0, mass_below: float = 2.0, planar: bool = False
) -> Assembly:
    """Build case S8: a wedge with a level top slides down a wedge that is free on a floor.

    There is no friction. The lower wedge descends toward +x and accelerates toward -x with

        m g sin c cos c / (M + m sin^2 c)

    Neither wedge rotates.

    Arguments: `angle`: slope c of the lower wedge [deg], 15 to 60; `mass`, `mass_below`: masses m
    of the upper and M of the lower wedge [kg].

    Examples
    --------
    >>> wedge_on_wedge().names
    ('floor', 'below', 'above')
    """
    rise = float(np.tan(np.radians(angle)))
    lower = [[0, 0], [6, 0], [0, 6 * rise]]
    a, b = 1.5, 3.0  # extent of the upper wedge along x
    upper = [[a, (6 - a) * rise], [b, (6 - b) * rise], [b, (6 - a) * rise]]
    return Assembly(
        [
            floor([-12, -2], [12, 2]),
            prism("below", lower, mass=mass_below),
            prism("above", upper, mass=mass),
        ],
        planar=planar,
    )


@listed("ladder", "a ladder on a wall, friction on the floor", source="S4", answer="stable")
def ladder(
    angle: float = 55.0,
    *,
    friction_floor: float = 0.4,
    friction_wall: float = 0.0,
    length: float = 4.0,
    planar: bool = True,
) -> Assembly:
    """Case S4: a ladder at `angle` [deg] from the floor, which leans on a wall.

    The least stable angle is tan(least) = (1 - mu_f mu_w) / (2 mu_f), from both friction
    coefficients.

    The ladder is a spindle whose ends are edges along y, one on the floor and one on the wall.
    Their contacts are given, with two points per edge. The least angles for mu_f = 0.4 are
    51.3402 degrees with mu_w = 0, and 47.7263 degrees with mu_w = 0.3.

    Arguments: `angle`: angle from the floor [deg]; `friction_floor`, `friction_wall`: friction
    coefficients mu_f, mu_w [-]; `length`: length of the ladder [m].
    """
    a = np.radians(angle)
    foot, top = np.array([length * np.cos(a), 0.0]), np.array([0.0, length * np.sin(a)])
    bulge = 0.02 * length * np.array([np.sin(a), np.cos(a)])
    middle = (foot + top) / 2
    parts = [
        floor([-1, -1], [length + 1, 1]),
        block("wall", [-1, -1, 0], [0, 1, length + 1], grounded=True),
        prism("ladder", [foot, middle + bulge, top, middle - bulge], 0.5, mass=10.0),
    ]
    ends = [[[x, y, z] for y in (-0.25, 0.25)] for x, z in (foot, top)]
    contacts = [
        GivenContact(("floor", "ladder"), ends[0], [0, 0, 1], mu=friction_floor),
        GivenContact(("wall", "ladder"), ends[1], [1, 0, 0], mu=friction_wall),
    ]
    return Assembly(parts, contacts=contacts, planar=planar)


@listed("bracket", "a bracket on a post", source="S5", answer="potentially-stable")
def bracket(
    offset: float = 1.0, *, height: float = 1.0, friction: float = 0.6, pad: float = 0.01
) -> Assembly:
    """Case S5: a bracket on a thin post; forces hold it if offset >= height / (2 friction).

    A pad presses on the left side of the post, and a second pad on the right side, `height` below
    the first (between their inner edges). A plate in front of the post joins the pads without
    touching it. The bracket has a mass of 1 kg, at `offset` to the right of the post's axis.

    Parameters
    ----------
    offset, height : float
        Distances [m].
    friction : float
        Friction coefficient [-].
    pad : float
        Height of the pads [m]. If the pads press evenly instead of on their inner edges, the
        effective height is the distance between their middles.
    """
    half = 0.05
    xs = [-half - pad, -half, half, half + pad]
    zs = [-height / 2 - pad, -height / 2, height / 2, height / 2 + pad]
    solid = np.zeros((3, 2, 3), dtype=bool)
    solid[:, 0, :] = True  # the plate, in front of the post
    solid[0, 1, 2] = solid[2, 1, 0] = True  # the pads
    post = block("post", [-half, -0.1, -2 * height], [half, 0.1, 2 * height], grounded=True)
    shape = cells(xs, [-0.4, -0.2, 0.2], zs, solid)
    arm = [offset, 0.0, 0.0]
    return Assembly(
        [post, Part("bracket", shape, mass=1.0, center_of_mass=arm)],
        friction_pairs=[FrictionPair(("post", "bracket"), friction)],
    )


@listed("books", "eight books pressed together", source="S6", answer="potentially-stable")
def books(
    count: int = 8,
    *,
    force: float = 200.0,
    friction: float = 0.5,
    thickness: float = 0.05,
    height: float = 0.25,
    weight: float = 9.81,
) -> Assembly:
    """Case S6: a row of books in the air, pressed against a wall by a force on an end plate.

    The least force is max(n w / (2 mu), n^2 w t / (8 h)) for an even number n of books. Guides
    without friction around the plate let it slide only along the force.

    Arguments: `force`, `weight`: force on the plate toward -x, and weight w of a book [N];
    `friction`: friction coefficient mu between books, wall and plate [-]; `thickness`, `height`:
    thickness t and height h of a book [m].
    """
    depth, end = 0.2, count * thickness
    plate = 2 * height
    rows = [
        block(f"book-{k}", [k * thickness, -depth / 2, 0],
              [(k + 1) * thickness, depth / 2, height], mass=weight / 9.81)
        for k in range(count)
    ]  # fmt: skip
    low, high = [end, -depth / 2, 0.0], [end + plate, depth / 2, height]
    wall = block("wall", [-0.1, -depth, -height], [0, depth, 2 * height], grounded=True)
    guides = _guides(end + 0.1, end + plate, depth, height)
    slides = [FrictionPair((part.name, "plate"), 0.0) for part in guides]
    return Assembly(
        [wall, *guides, *rows, block("plate", low, high, mass=1.0)],
        friction=friction,
        friction_pairs=slides,
        loads=[Load("plate", force=[-force, 0, 0])],
    )


def squeezed_row(
    count: int = 8,
    *,
    friction: float = 0.5,
    thickness: float = 0.05,
    height: float = 0.25,
    planar: bool = False,
) -> Assembly:
    """A row of blocks in the air between two held walls, held by squeeze and friction alone.

    Thin and high blocks form a row of books, thick and low blocks a flat arch. Equilibrium forces
    exist for every friction above zero, but free fall obeys the contact law, too.

    Arguments: `friction`: friction coefficient [-]; `thickness`, `height`: size of a block along x
    and z [m].
    """
    end, depth = count * thickness, 0.2
    wall = max(thickness, 0.1)
    low, high = [-depth, -0.5 * height], [depth, 1.5 * height]
    held = [
        block(f"wall-{side}", [x, low[0], low[1]], [x + wall, high[0], high[1]], grounded=True)
        for side, x in (("left", -wall), ("right", end))
    ]
    rows = [
        block(f"block-{k}", [k * thickness, -depth / 2, 0],
              [(k + 1) * thickness, depth / 2, height])
        for k in range(count)
    ]  # fmt: skip
    return Assembly([*held, *rows], friction=friction, planar=planar)


def _guides(start: float, stop: float, depth: float, height: float) -> list[Part]:
    """Held blocks on the four long sides of a bar along x, of given depth (y) and height (z)."""
    d, h = depth, height
    corners = {
        "below": ([start, -d, -0.1], [stop, d, 0]),
        "above": ([start, -d, h], [stop, d, h + 0.1]),
        "front": ([start, -d, 0], [stop, -d / 2, h]),
        "back": ([start, d / 2, 0], [stop, d, h]),
    }
    return [block(f"guide-{side}", *ends, grounded=True) for side, ends in corners.items()]


@listed("squeezed-block", "a block between two walls", source="I1", answer="potentially-stable")
def h_block(*, friction: float = 0.5, planar: bool = False) -> Assembly:
    """Case I1: a block between two held vertical walls; only squeeze and friction can hold it.

    Equilibrium forces exist for every friction above zero, but free fall obeys the contact law,
    too.
    """
    return _between_plates(0.0, friction, planar)


def a_block(half_angle: float = 10.0, *, friction: float = 0.5, planar: bool = False) -> Assembly:
    """Case I2: a trapezoid, wider below, between held plates that lean inwards by an angle.

    Equilibrium forces exist if and only if friction >= tan(half_angle).
    """
    return _between_plates(half_angle, friction, planar)


def v_block(half_angle: float = 10.0, *, friction: float = 0.0, planar: bool = False) -> Assembly:
    """Case I2 upside down: a wedge, wider above, between plates that open upwards; stable."""
    return _between_plates(-half_angle, friction, planar)


def _between_plates(half_angle: float, friction: float, planar: bool) -> Assembly:
    """A trapezoid between held plates that lean inwards by `half_angle` [deg].

    The trapezoid is 1 high, and 1 wide in the middle.
    """
    if abs(half_angle) >= 25:
        raise InputError(f"half angle is {half_angle:g}", hint="give less than 25 degrees")
    lean = 0.5 * float(np.tan(np.radians(half_angle)))
    low, high = 0.5 + lean, 0.5 - lean
    thick = 1.0
    right = [[low, -0.5], [low + thick, -0.5], [low + thick, 0.5], [high, 0.5]]
    left = [[-x, z] for x, z in right]
    return Assembly(
        [
            prism("plate-left", left, grounded=True),
            prism("plate-right", right, grounded=True),
            prism("block", [[-low, -0.5], [low, -0.5], [high, 0.5], [-high, 0.5]]),
        ],
        friction=friction,
        planar=planar,
    )


@listed("trough", "a prism in a tilted trough", source="I3", answer="stable")
def trough(
    slope: float = 30.0, *, tilt: float = 40.0, friction: float = 0.84, length: float = 6.0
) -> Assembly:
    """Case I3: a prism in a V-shaped trough, whose sides slope by `slope`, tilted lengthwise [deg].

    Gravity leans toward +y. The prism slips at tan(tilt) = friction / cos(slope). Equilibrium
    forces exist up to tan(tilt) = friction / sqrt(cos^2 - friction^2 sin^2).

    Arguments: `slope`, `tilt`: angles [deg]; `friction`: friction coefficient [-]; `length`: length
    of the prism along y [m]; its width is 2 m.
    """
    rise = float(np.tan(np.radians(slope)))
    held = [[0, 0], [1.5, 1.5 * rise], [1.5, -1], [-1.5, -1], [-1.5, 1.5 * rise]]
    angle = np.radians(tilt)
    return Assembly(
        [
            prism("trough", held, 2 * length, grounded=True),
            prism("prism", [[0, 0], [1, rise], [-1, rise]], length),
        ],
        gravity=[0.0, 9.81 * np.sin(angle), -9.81 * np.cos(angle)],
        friction=friction,
    )
