"""Parts in rails, grooves, pits and frames: stable directions of every kind, in closed form.

A block that touches held plates on some of its six sides stays for exactly those directions
of gravity that are sums of directions to those plates: the cone that they generate. Two
opposite plates give a line, a pit a half-space, a closed frame every direction.

A solid that fills a pit up to its rim, cut into pieces by any planes, stays with gravity
across the rim: the pressure of a liquid of the same density balances every piece.
"""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.rigid import unit
from kilter.scenes.pieces import block, floor, prism
from kilter.scenes.registry import listed
from kilter.scenes.wedges import behind, solid_mesh, solid_volume
from kilter.shape.primitives import BOX_CORNERS, BOX_QUADS, Mesh

__all__ = ["SIDES", "groove", "pit_wedges", "railed", "seats"]


SIDES = {
    "-x": (-1.0, 0.0, 0.0),
    "+x": (1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "+y": (0.0, 1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
    "+z": (0.0, 0.0, 1.0),
}
"""Directions from a block to the plates that may hold it."""

THICK = 0.25
"""Of plates [m]."""


@listed(
    "closed-frame",
    "a block locked in a frame",
    source="region: all",
    answer="stable",
    sides="-x +x -y +y -z +z",
)
@listed(
    "pit", "a block in a pit", source="region: half-space", answer="stable", sides="-x +x -y +y -z"
)
@listed("tube", "a block in a tube", source="region: plane", answer="stable", sides="-x +x -z +z")
@listed(
    "channel",
    "a block in a channel",
    source="region: half-plane",
    answer="stable",
    sides="-x +x -z",
)
@listed(
    "slot", "a block between two plates", source="region: line", answer="unstable", sides="-x +x"
)
def railed(sides: str = "-x +x -z", *, count: int = 1, planar: bool = False) -> Assembly:
    """A column of unit cubes between held plates: stable for the cone the plates generate.

    Parameters
    ----------
    sides : str
        Where plates touch the column, of `SIDES`, with spaces between. A held block that
        touches nothing stands aside in any case.
    count : int
        Cubes of the column, bottom up along z.
    planar : bool
        Motions in the x-z plane only.

    Raises
    ------
    InputError
        If a side is not one of the six.

    Examples
    --------
    >>> [part.name for part in railed("-z +z", count=2).parts]
    ['aside', 'plate-z', 'plate+z', 'cube-0', 'cube-1']
    """
    parts = [block("aside", [-9, -9, -9], [-8, -8, -8], grounded=True)]
    low, high = np.zeros(3), np.array([1.0, 1.0, float(count)])
    for side in sides.split():
        if side not in SIDES:
            raise InputError(f"there is no side {side!r}", hint=f"give {', '.join(SIDES)}")
        direction = np.array(SIDES[side])
        a, b = low.copy(), high.copy()
        a[direction > 0], b[direction < 0] = high[direction > 0], low[direction < 0]
        a[direction < 0] -= THICK
        b[direction > 0] += THICK
        parts.append(block(f"plate{side}", a, b, grounded=True))
    parts += [block(f"cube-{k}", [0, 0, k], [1, 1, k + 1]) for k in range(count)]
    return Assembly(parts, planar=planar)


@listed(
    "stopped-groove",
    "a prism in a V-groove between two stops",
    source="region: wedge",
    answer="stable",
    ends=2,
)
@listed("groove", "a prism in a V-groove", source="region: fan", answer="stable")
def groove(angle: float = 30.0, *, ends: int = 0, planar: bool = False) -> Assembly:
    """A prism in a held V-groove along y, stable within `angle` of -z across the groove.

    Parameters
    ----------
    angle : float
        Of either side of the groove to the horizontal [deg], 5 to 85.
    ends : int
        Plates that close the groove along y: 0 (a fan), 1 (at -y: a cone of three rays) or
        2 (a wedge).
    planar : bool
        Motions in the x-z plane only.

    Examples
    --------
    >>> groove(45, ends=2).names
    ('left', 'right', 'prism', 'end-0', 'end-1')
    """
    rise = float(np.tan(np.radians(angle)))
    side = [[0, 0], [1, rise], [1, -1], [0, -1]]
    # a kite: the normals of both faces through their middles meet in its centre of mass
    top = 0.5 * (rise + 1 / rise)
    kite = [[0, 0], [1, rise], [0, 2 * top], [-1, rise]]
    parts = [
        prism("left", np.array(side) * [-1, 1], grounded=True),
        prism("right", side, grounded=True),
        prism("prism", kite, center_of_mass=[0, 0, top], mass=1.0),
    ]
    for end in range(ends):
        low, high = sorted([0.5 * (2 * end - 1), (0.5 + THICK) * (2 * end - 1)])
        reach = 2 * top + 1
        parts.append(block(f"end-{end}", [-1, low, 0], [1, high, reach], grounded=True))
    return Assembly(parts, planar=planar)


def seats(count: int = 100, *, angle: float = 0.3) -> Assembly:
    """Plates stacked on pyramid-shaped seats: stable within a thin pyramid around -z.

    The four faces of each seat slope by `angle` to the middle: the rays are as far from -z,
    toward x, -x, y and -y, and 10,000 random directions meet none of them. The plates are
    1 x 1 x 0.05.

    Parameters
    ----------
    count : int
        Free plates.
    angle : float
        [deg]; the stack must lean by less than half a plate at it.

    Examples
    --------
    >>> len(seats(3).parts)
    4
    """
    dip = 0.5 * float(np.tan(np.radians(angle)))
    height = 0.05
    parts = [
        Part(f"plate-{k}" if k else "base", _plate(k * height, height, dip), grounded=k == 0)
        for k in range(count + 1)
    ]
    return Assembly(parts)


def _plate(bottom: float, height: float, dip: float) -> Mesh:
    """A square plate whose underside and upper side sink by `dip` to their middles."""
    square = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [0.0, 0.0]]
    depth = [0.0, 0.0, 0.0, 0.0, dip]
    lower = [[x, y, bottom - d] for (x, y), d in zip(square, depth, strict=True)]
    upper = [[x, y, bottom + height - d] for (x, y), d in zip(square, depth, strict=True)]
    faces = []
    for k in range(4):
        j = (k + 1) % 4
        faces += [[j, k, 4], [5 + k, 5 + j, 9], [k, j, 5 + j, 5 + k]]
    return Mesh(lower + upper, faces)


@listed("pit-wedges", "a cube in a pit, cut into six", source="region: cone", answer="stable")
def pit_wedges(count: int = 6, *, seed: int = 0) -> Assembly:
    """A cube in a pit, filled to the rim, cut into `count` wedges by random planes: stable.

    The largest piece is cut next, through its middle.

    Parameters
    ----------
    count, seed : int

    Examples
    --------
    >>> assembly = pit_wedges(5, seed=1)
    >>> bool(abs(assembly.geometry.volume[5:].sum() - 8.0) < 1e-12)
    True
    """
    if count < 1:
        raise InputError(f"{count} wedges", hint="give 1 or more")
    random = np.random.default_rng(seed)
    corners = BOX_CORNERS * 2.0 + [0.0, 0.0, 1.0]
    pieces = [[corners[quad] for quad in BOX_QUADS]]
    while len(pieces) < count:
        largest = pieces.pop(int(np.argmax([solid_volume(piece) for piece in pieces])))
        normal = unit(random.normal(size=3))
        point = np.concatenate(largest).mean(axis=0)
        pieces += [behind(largest, point, normal), behind(largest, point, -normal)]
    t = THICK
    held = [
        floor([-1 - t, -1 - t], [1 + t, 1 + t]),
        block("wall-x0", [-1 - t, -1, 0], [-1, 1, 2], grounded=True),
        block("wall-x1", [1, -1, 0], [1 + t, 1, 2], grounded=True),
        block("wall-y0", [-1, -1 - t, 0], [1, -1, 2], grounded=True),
        block("wall-y1", [-1, 1, 0], [1, 1 + t, 2], grounded=True),
    ]
    return Assembly([*held, *(Part(f"wedge-{k}", solid_mesh(p)) for k, p in enumerate(pieces))])
