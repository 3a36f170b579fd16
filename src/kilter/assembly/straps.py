"""Straps: belts that run over parts and press them together, or that hold them back.

A strap runs along straight pieces between points of its path, from one end to the other. It pulls
with its tension at its ends, and at each corner it pushes with the sum of the pulls of both pieces:

    end         T e                     e: unit vector along the piece, away from the point
    corner      T_1 e_1 + T_2 e_2

At corners with friction mu the strap slips over the corner while it is tensioned. The tension falls
by exp(-mu angle) at each corner, from the tensioned end on; the angle is that between the pieces.

A strap with a capacity LC instead (direct lashing) pulls only if its load moves away: its pull is
unknown, between 0 and LC. Its corners have no friction, so all its pieces have the same pull
(`kilter.mechanics.rows`). With friction, the pull would fall at a corner in one of two directions,
depending on the side to which the strap slips, which is unknown.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from kilter.arrays import Array, cross
from kilter.assembly.part import GROUND
from kilter.errors import InputError
from kilter.validate import finite, in_range, number
from kilter.values.guesses import guarded
from kilter.values.value import Value

StrapEnd = Literal["first", "last"]


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Strap(Value):
    """A belt along a path over parts, such as a lashing strap: of known tension, or of capacity.

    Parameters
    ----------
    path : sequence of (str, array_like of shape (3,))
        Part and point of each end and corner, world frame [length unit]. The part "ground" is the
        world.
    tension : float, optional
        Tension at the tensioned end [N].
    mu : float
        Friction coefficient at the corners [-].
    tensioned : {"first", "last"}, optional
        End of the path at which the strap was tensioned. With friction, `kilter.check` tries both
        ends if it is not given, and other functions require it.
    capacity : float, optional
        Largest pull LC [N] of a strap that is not tensioned, instead of `tension`. The pull is
        unknown, from 0 to LC.
    name : str
        Name of the strap in messages and answers; empty without a name.

    Raises
    ------
    InputError
        If the path has fewer than two points or two equal neighbours, tension or capacity is not
        above 0 or not given alone, or a strap with a capacity has friction or no piece between
        different parts.

    Examples
    --------
    >>> strap = Strap([("ground", [0, 0, 0]), ("box", [0, 0, 1])], tension=2000)
    >>> strap.parts, strap.tensions.tolist()
    (('ground', 'box'), [2000.0])
    """

    path: Any
    tension: float | None = None
    mu: float = 0.0
    tensioned: StrapEnd | None = None
    capacity: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise InputError(f"name of a strap is {self.name!r:.40}", hint="give a text")
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
        if (self.tension is None) == (self.capacity is None):
            given = "neither" if self.tension is None else "both"
            raise InputError(
                f"the strap over {some(self)} has {given} of tension and capacity",
                hint="give a tension, or the capacity of a strap that is not tensioned",
            )
        name = "capacity" if self.tension is None else "tension"
        what = f"{name} of the strap over {some(self)}"
        size = number(getattr(self, name), what, lowest=0)
        if size == 0:
            raise InputError(f"{what} is 0", hint="give newtons above 0")
        in_range(size, what)
        object.__setattr__(self, name, size)
        object.__setattr__(self, "mu", number(self.mu, "mu of a strap", lowest=0))
        if self.tensioned not in (None, *get_args(StrapEnd)):
            raise InputError(
                f"tensioned end of a strap is {self.tensioned!r:.40}", hint="give first or last"
            )
        if self.capacity is not None:
            self._require_direct()

    def _require_direct(self) -> None:
        """Reject friction of a strap with a capacity, and a strap that connects no two parts."""
        if self.mu or self.tensioned is not None:
            raise InputError(
                f"the strap over {some(self)} has a capacity, and friction or a tensioned end",
                hint="leave out mu and tensioned, or give its tension",
            )
        if not self.pulling:
            raise InputError(
                f"the strap over {some(self)} has a capacity and connects no two parts",
                hint="add a point on the ground or on another part",
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
    def open_end(self) -> bool:
        """True if friction at corners makes the tension depend on an end that is not named."""
        return bool(self.mu) and self.tensioned is None and len(self.path) > 2

    @property
    def pulling(self) -> list[int]:
        """Indices of the straight pieces that connect two different parts."""
        names = self.parts
        return [k for k in range(len(names) - 1) if names[k] != names[k + 1]]

    @property
    def tensions(self) -> Array:
        """Known tension of each straight piece, (n - 1,) [N]; 0 for a strap with a capacity.

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
        return (self.tension or 0.0) * (share[::-1] if backwards else share)

    @property
    def forces(self) -> Array:
        """Known force on the part at each point of the path, world frame, shape (n, 3) [N]."""
        pieces = np.diff(self.points, axis=0)
        pulls = self.tensions[:, None] * pieces / np.linalg.norm(pieces, axis=1)[:, None]
        total = np.zeros((len(pulls) + 1, 3))
        total[:-1] += pulls
        total[1:] -= pulls
        return total

    def with_strength(self, share: float) -> Strap:
        """The strap with its tension or capacity multiplied by `share`, which is above 0."""
        if self.tension is None:
            return dataclasses.replace(self, capacity=share * (self.capacity or 0.0))
        return dataclasses.replace(self, tension=share * self.tension)

    def to_dict(self) -> dict[str, Any]:
        """JSON data of the strap, as an assembly file has it."""
        data: dict[str, Any] = {
            "path": [[name, point.tolist()] for name, point in self.path],
        }
        for name in ("tension", "capacity"):
            if getattr(self, name) is not None:
                data[name] = getattr(self, name)
        if self.mu:
            data["mu"] = self.mu
        if self.tensioned is not None:
            data["tensioned"] = self.tensioned
        if self.name:
            data["name"] = self.name
        return data

    def __repr__(self) -> str:
        name = "capacity" if self.tension is None else "tension"
        return f"Strap({' - '.join(self.parts)}, {name}={getattr(self, name):g})"


def some(strap: Strap) -> str:
    """The name of a strap in messages: its own, or the names of its parts.

    Examples
    --------
    >>> some(Strap([("ground", [0, 0, 0]), ("box", [0, 0, 1])], 1.0))
    "'box'"
    """
    if strap.name:
        return repr(strap.name)
    names = dict.fromkeys(name for name in strap.parts if name != GROUND)
    return " and ".join(repr(name) for name in names) or repr(GROUND)
