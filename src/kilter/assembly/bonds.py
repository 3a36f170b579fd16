"""Bonds: connections of two parts that take pull up to a limit, such as glue, studs, magnets."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np

from kilter.errors import InputError, nearest_name
from kilter.rigid import in_brackets, unit
from kilter.validate import frozen, in_range, number

__all__ = [
    "KINDS",
    "NOT_RANGED",
    "NOT_SET",
    "NO_CONE",
    "Bond",
    "BondKind",
    "require_apart",
    "require_no_bonds",
]

BondKind = Literal["glue", "mortar", "magnet", "suction", "press-fit"]
KINDS: dict[BondKind, str | None] = {
    "glue": None,
    "mortar": "mu",
    "magnet": "mu",
    "suction": "mu",
    "press-fit": None,
}
"""Kinds of bond, and what bears shear in each where that is not said."""
NO_CONE = "what they hold depends on the size of gravity, so directions that are held are no cone"
"""Why a set of directions is not asked of bonds."""
NOT_SET = "it does not say when each one sets"
"""Why an order of assembly is not asked of bonds."""
NOT_RANGED = "what they hold does not grow with the masses"
"""Why a worst case over intervals is not asked of bonds."""


@dataclass(frozen=True, slots=True, eq=False)
class Bond:
    """A connection of two parts that takes pull up to a limit, and breaks beyond it.

    At a point with normal n, from the first part to the second, contact forces may pull:

    =============  =================================================
    along n        f_n >= -T, any push
    across n       any force, up to `shear`, or up to mu (f_n + T)
    =============  =================================================

    Parameters
    ----------
    parts : pair of str
        Names of the two.
    pull : float, optional
        T at each point [N].
    pull_per_area : float, optional
        Strength of the surface, in place of `pull` [N / length unit^2]: of each patch, times its
        area, acting at the middle of the area.
    shear : float or "mu", optional
        What is borne across each point: up to this force [N], or by friction on what presses the
        surfaces together, the pull included. Any force, where it is not given.
    points : array_like, shape (n, 3), optional
        Where it acts, world frame [length unit]; all contact points of the two parts where they
        are not given.
    normal : array_like, shape (3,), optional
        Of the surface, from the first part to the second, of any length; needed with `points`.
    kind : {"glue", "mortar", "magnet", "suction", "press-fit"}, optional
        A name; mortar, magnets and suction cups bear shear by friction unless `shear` says
        otherwise.

    Raises
    ------
    InputError
        If the strength is missing or negative, a number is not finite, or points come without
        a normal.

    Examples
    --------
    >>> Bond(("lid", "box"), pull=2.5)
    Bond(('lid', 'box'), pull=2.5)
    >>> Bond(("lid", "box"))
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: bond of 'lid' and 'box' has no strength; give pull or pull_per_area
    """

    parts: tuple[str, str]
    pull: float | None = None
    pull_per_area: float | None = None
    shear: float | str | None = None
    points: Any = None
    normal: Any = None
    kind: BondKind | None = None

    def __post_init__(self) -> None:
        names = tuple(self.parts) if isinstance(self.parts, tuple | list) else ()
        if len(names) != 2 or not all(isinstance(name, str) for name in names):
            raise InputError(f"parts are {self.parts!r:.60}", hint="give a pair of names")
        object.__setattr__(self, "parts", names)
        what = f"bond of {names[0]!r} and {names[1]!r}"
        self._require_strength(what)
        self._require_kind(what)
        self._require_points(what)

    def _require_strength(self, what: str) -> None:
        given = [self.pull, self.pull_per_area]
        if given.count(None) != 1:
            has = "has no strength" if given.count(None) == 2 else "has pull and pull_per_area"
            raise InputError(f"{what} {has}", hint="give pull or pull_per_area")
        for name in ("pull", "pull_per_area"):
            if getattr(self, name) is not None:
                size = number(getattr(self, name), f"{name} of the {what}", lowest=0)
                in_range(size, f"{name} of the {what}")
                object.__setattr__(self, name, size)
        if self.shear is not None and self.shear != "mu":
            if isinstance(self.shear, str):
                raise InputError(f"shear of the {what} is {self.shear!r}", hint='give "mu" or N')
            size = number(self.shear, f"shear of the {what}", lowest=0)
            object.__setattr__(self, "shear", size)

    def _require_kind(self, what: str) -> None:
        if self.kind is None:
            return
        if self.kind not in KINDS:
            near = nearest_name(str(self.kind), KINDS)
            hint = f"did you mean {near!r}?" if near else f"give one of {', '.join(KINDS)}"
            raise InputError(f"{what} is {self.kind!r}", hint=hint)

    def _require_points(self, what: str) -> None:
        if self.points is None:
            if self.normal is not None:
                raise InputError(f"{what} has a normal but no points", hint="give both, or none")
            return
        points = frozen(self.points, (-1, 3)) if len(self.points) else np.empty((0, 3))
        if not len(points) or not np.isfinite(points).all():
            raise InputError(f"{what} has no usable points", hint="give one point or more")
        if self.normal is None:
            raise InputError(
                f"{what} has points but no normal",
                hint="give the normal, from the first part to the second",
            )
        if self.pull_per_area is not None:
            raise InputError(
                f"{what} has points, which have no area", hint="give pull, of each point"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "normal", unit(self.normal, f"normal of the {what}"))

    @property
    def bears(self) -> float | str | None:
        """What bears shear: "mu", a force a point [N], or None for any force."""
        return KINDS[self.kind] if self.shear is None and self.kind is not None else self.shear

    def to_dict(self) -> dict[str, Any]:
        """What is said of it, as JSON data of an answer: pull of each point [N], or of an area."""
        said = {name: getattr(self, name) for name in ("pull", "pull_per_area", "kind")}
        given = {name: value for name, value in said.items() if value is not None}
        return {"parts": list(self.parts), **given, "shear": self.bears}

    def with_strength(self, share: float) -> Bond:
        """The bond with a share of its pull and of its limit of shear."""

        def part(value: Any) -> Any:
            return value * share if isinstance(value, float) else value

        return dataclasses.replace(
            self,
            pull=part(self.pull),
            pull_per_area=part(self.pull_per_area),
            shear=part(self.shear),
        )

    def __repr__(self) -> str:
        words = [
            f", {name}={value!r}" if isinstance(value, str) else f", {name}={value:g}"
            for name in ("pull", "pull_per_area", "shear", "kind")
            if (value := getattr(self, name)) is not None
        ]
        if self.points is not None:
            words.append(f", {len(self.points)} points, normal={in_brackets(self.normal)}")
        return f"Bond({self.parts}{''.join(words)})"


def require_apart(bonds: tuple[Bond, ...]) -> None:
    """Refuse two bonds of one pair that both hold all its contact points.

    Raises
    ------
    InputError
    """
    seen: set[frozenset[str]] = set()
    for bond in bonds:
        pair = frozenset(bond.parts)
        if bond.points is None and pair in seen:
            names = " and ".join(repr(name) for name in bond.parts)
            raise InputError(
                f"two bonds hold all contacts of {names}",
                hint="leave one out, or give the points of each",
            )
        if bond.points is None:
            seen.add(pair)


class _Bonded(Protocol):
    """What may have bonds: an assembly."""

    @property
    def bonds(self) -> Any: ...
    @property
    def source(self) -> str: ...


def require_no_bonds(assembly: _Bonded, verb: str, why: str) -> None:
    """Refuse bonds where a question does not know what to do with them.

    Raises
    ------
    InputError
    """
    if assembly.bonds:
        names = " and ".join(repr(name) for name in assembly.bonds[0].parts)
        raise InputError(
            f"{verb} does not take bonds, such as that of {names}: {why}",
            file=assembly.source or None,
            hint="leave the bonds out, or ask check or margin as it lies",
        )
