"""Straps: belts under a known tension that run over parts and press them together.

A strap runs along straight pieces between points of its path, from one end to the other. It pulls
with its tension at its ends, and at each corner it pushes with the sum of the pulls of both pieces:

    end         T e                     e: unit vector along the piece, away from the point
    corner      T_1 e_1 + T_2 e_2

At corners with friction mu the strap slips over the corner while it is tensioned. The tension falls
by exp(-mu angle) at each corner, from the tensioned end on; the angle is that between the pieces.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from kilter.arrays import Array, cross
from kilter.assembly.part import GROUND
from kilter.errors import InputError
from kilter.validate import finite, in_range, number
from kilter.values import Value

if TYPE_CHECKING:
    from kilter.assembly.assembly import Assembly

__all__ = ["Strap", "StrapEnd", "strap_wrenches"]

StrapEnd = Literal["first", "last"]
OFF_PART = 1e-2
"""Largest distance of a point of a strap from the bounding box of its part, relative to the size of
the part [-]. A larger value accepts points that are farther away."""
THROUGH = 1e-3
"""Depth to which a strap may pass through a part, relative to its size [-]. A larger value accepts
straps that cut deeper."""


@dataclass(frozen=True, slots=True, eq=False)
class Strap(Value):
    """A belt under a known tension along a path over parts, such as a lashing strap.

    Parameters
    ----------
    path : sequence of (str, array_like of shape (3,))
        Part and point of each end and corner, world frame [length unit]. The part "ground" is the
        world.
    tension : float
        Tension at the tensioned end [N].
    mu : float
        Friction coefficient at the corners [-].
    tensioned : {"first", "last"}, optional
        End of the path at which the strap was tensioned; required with friction.

    Raises
    ------
    InputError
        If the path has fewer than two points or two equal neighbours, the tension is not above 0,
        or friction comes without the tensioned end.

    Examples
    --------
    >>> strap = Strap([("ground", [0, 0, 0]), ("box", [0, 0, 1])], tension=2000)
    >>> strap.parts, strap.tensions.tolist()
    (('ground', 'box'), [2000.0])
    """

    path: Any
    tension: float
    mu: float = 0.0
    tensioned: StrapEnd | None = None

    def __post_init__(self) -> None:
        entries = list(self.path) if isinstance(self.path, list | tuple) else []
        if len(entries) < 2 or not all(
            isinstance(entry, list | tuple) and len(entry) == 2 and isinstance(entry[0], str)
            for entry in entries
        ):
            raise InputError(
                f"the path of a strap is {self.path!r:.60}",
                hint='give two or more points as ["part", [x, y, z]]',
            )
        points = []
        for name, point in entries:
            place = finite(point, (3,), "point of a strap")
            in_range(place, "point of a strap")
            points.append((name, place))
        object.__setattr__(self, "path", tuple(points))
        if not np.linalg.norm(np.diff(self.points, axis=0), axis=1).all():
            raise InputError(
                f"two successive points of the strap over {some(self)} are equal",
                hint="leave one of them out",
            )
        tension = number(self.tension, f"tension of the strap over {some(self)}", lowest=0)
        if tension == 0:
            raise InputError(
                f"tension of the strap over {some(self)} is 0", hint="give newtons above 0"
            )
        in_range(tension, f"tension of the strap over {some(self)}")
        object.__setattr__(self, "tension", tension)
        object.__setattr__(self, "mu", number(self.mu, "mu of a strap", lowest=0))
        if self.tensioned not in (None, *get_args(StrapEnd)):
            raise InputError(
                f"tensioned end of a strap is {self.tensioned!r:.40}", hint="give first or last"
            )
        if self.mu and self.tensioned is None and len(points) > 2:
            raise InputError(
                f"the strap over {some(self)} has friction, but its tensioned end is not named",
                hint='give "tensioned": "first" or "last"',
            )

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the part at each point of the path."""
        return tuple(name for name, _ in self.path)

    @property
    def points(self) -> Array:
        """Points of the path, world frame, shape (n, 3) [length unit]."""
        return np.array([point for _, point in self.path])

    @property
    def tensions(self) -> Array:
        """Tension of each straight piece of the path, shape (n - 1,) [N].

        Examples
        --------
        >>> over = [("ground", [0, 0, 0]), ("box", [0, 0, 1]), ("ground", [1, 0, 1])]
        >>> Strap(over, 1000, mu=0.5, tensioned="last").tensions.round(3).tolist()
        [455.938, 1000.0]
        """
        pieces = np.diff(self.points, axis=0)
        pieces /= np.linalg.norm(pieces, axis=1)[:, None]
        turn = np.arctan2(
            np.linalg.norm(cross(pieces[:-1], pieces[1:]), axis=1),
            np.einsum("ij,ij->i", pieces[:-1], pieces[1:]),
        )
        backwards = self.tensioned == "last"
        passed = np.cumsum(np.append(0.0, turn[::-1] if backwards else turn))
        share: Array = np.exp(-self.mu * passed)
        return self.tension * (share[::-1] if backwards else share)

    @property
    def forces(self) -> Array:
        """Force of the strap on the part at each point of the path, world frame, (n, 3) [N]."""
        pieces = np.diff(self.points, axis=0)
        pulls = self.tensions[:, None] * pieces / np.linalg.norm(pieces, axis=1)[:, None]
        total = np.zeros((len(pulls) + 1, 3))
        total[:-1] += pulls
        total[1:] -= pulls
        return total

    def with_strength(self, share: float) -> Strap:
        """The strap with its tension multiplied by `share`, which is above 0."""
        return dataclasses.replace(self, tension=share * self.tension)

    def to_dict(self) -> dict[str, Any]:
        """JSON data of the strap, as an assembly file has it."""
        data: dict[str, Any] = {
            "path": [[name, point.tolist()] for name, point in self.path],
            "tension": self.tension,
        }
        if self.mu:
            data["mu"] = self.mu
        if self.tensioned is not None:
            data["tensioned"] = self.tensioned
        return data

    def __repr__(self) -> str:
        return f"Strap({' - '.join(self.parts)}, tension={self.tension:g})"


def some(strap: Strap) -> str:
    """Names of the parts of a strap, for messages.

    Examples
    --------
    >>> some(Strap([("ground", [0, 0, 0]), ("box", [0, 0, 1])], 1.0))
    "'box'"
    """
    names = dict.fromkeys(name for name in strap.parts if name != GROUND)
    return " and ".join(repr(name) for name in names) or repr(GROUND)


def strap_wrenches(assembly: Assembly) -> Array:
    """Wrenches of all straps on the parts, shape (N, 6).

    Force [N], and torque about the centre of mass [N x length unit].

    Raises
    ------
    InputError
        If a strap passes through a part, or a point is away from its part.
    """
    geometry = assembly.geometry
    total = np.zeros((len(assembly.parts), 6))
    for strap in assembly.straps:
        _require_clear(assembly, strap)
        for (name, point), force in zip(strap.path, strap.forces, strict=True):
            if name != GROUND:
                k = assembly.index_of(name)
                total[k, :3] += force
                total[k, 3:] += cross(point - geometry.center[k], force)
    return total


def _require_clear(assembly: Assembly, strap: Strap) -> None:
    """Reject a strap that surely passes through a part, or whose points are away from the parts."""
    geometry, points = assembly.geometry, strap.points
    low, high = geometry.part_boxes
    for name, point in strap.path:
        if name == GROUND:
            continue
        k = assembly.index_of(name)
        away = np.maximum(np.maximum(low[k] - point, point - high[k]), 0.0)
        if float(np.linalg.norm(away)) > OFF_PART * geometry.size[k]:
            raise InputError(
                f"a strap has the point {point.tolist()} on this part, which is not there",
                part=name,
                file=assembly.source or None,
                hint="give points on the surface of the part",
            )
    for k, part in enumerate(assembly.parts):
        corners = geometry.corners_of(k)
        normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normal, axis=1)
        normal = normal[length > 0] / length[length > 0, None]
        reach = np.einsum("ij,ij->i", normal, corners[length > 0, 0])
        depth = THROUGH * geometry.size[k]
        if _pieces_inside(points, normal, reach - depth):
            raise InputError(
                "a strap passes through this part",
                part=part.name,
                file=assembly.source or None,
                hint="add the corners at which the strap bends around the part",
            )


def _pieces_inside(points: Array, normal: Array, reach: Array) -> bool:
    """Whether a piece between successive points meets the intersection of half-spaces.

    For a part that is not convex the half-spaces of its faces meet in a core of the part, so that
    only straps through this core are found.
    """
    first, along = points[:-1], np.diff(points, axis=0)
    room: Array = reach - first @ normal.T
    rate: Array = along @ normal.T
    limit = np.divide(room, rate, out=np.zeros_like(rate), where=rate != 0)
    latest = np.where(rate > 0, limit, 1.0).min(axis=1, initial=1.0)
    earliest = np.where(rate < 0, limit, 0.0).max(axis=1, initial=0.0)
    outside = ((rate == 0) & (room <= 0)).any(axis=1)
    return bool(((earliest < latest) & ~outside).any())
