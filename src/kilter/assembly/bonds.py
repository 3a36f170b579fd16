"""Bonds: connections of two parts that resist pull up to a limit, such as glue, studs, magnets."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Protocol

import numpy as np

from kilter.errors import InputError, nearest_name
from kilter.rigid import in_brackets, unit
from kilter.tell.record import OneOf, OrAbsent, Record
from kilter.validate import frozen, in_range, number
from kilter.values.guesses import guarded
from kilter.values.value import Value

BondKind = Literal["glue", "mortar", "magnet", "suction", "press-fit"]
KINDS: dict[BondKind, str | None] = {
    "glue": None,
    "mortar": "mu",
    "magnet": "mu",
    "suction": "mu",
    "press-fit": None,
}
"""Default shear strength of each kind of bond: by friction ("mu"), or unlimited (None)."""
NO_CONE = "their strength does not scale with gravity, so the stable directions do not form a cone"
"""Reason why a set of stable directions is not computed for bonds, for messages."""
NOT_SET = "the sequence does not state when each bond sets"
"""Reason why an order of assembly is not computed for bonds, for messages."""
NOT_RANGED = "their strength does not scale with the masses"
"""Reason why a worst case over intervals of masses is not computed for bonds, for messages."""


class ListedBond(Record):
    """A bond of two parts and its strength, in an answer."""

    parts: tuple[str, str]
    """Names of the parts."""
    pull: OrAbsent[float] = None
    """Largest pull at each point [N]."""
    pull_per_area: OrAbsent[float] = None
    """Strength of the surface [N/length unit^2]."""
    kind: OrAbsent[BondKind] = None
    """Kind of the bond."""
    shear: float | Annotated[str, OneOf(("mu",))] | None
    """Largest sideways force at each point [N]; "mu": by friction; null: no limit."""


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Bond(Value):
    """A glued, studded or magnetic connection of two parts, which breaks beyond a limit of pull.

    At a point with normal n, from the first part to the second, the contact force is bounded by

    =============  =================================================
    along n        f_n >= -T, no upper bound
    across n       no bound, `shear`, or mu (f_n + T)
    =============  =================================================

    Parameters
    ----------
    parts : pair of str
        Names of the two parts.
    pull : float, optional
        Largest pull T at each point [N].
    pull_per_area : float, optional
        Strength of the surface, instead of `pull` [N / length unit^2]. The strength times the area
        of a patch acts at the centroid of the patch.
    shear : float or "mu", optional
        Largest sideways force at each point [N], or "mu": friction due to the normal force plus
        the pull. Default no limit.
    points : array_like, shape (n, 3), optional
        Points of the bond, world frame [length unit]; default all contact points of the two
        parts.
    normal : array_like, shape (3,), optional
        Surface normal from the first part to the second, of any length; needed with `points`.
    kind : {"glue", "mortar", "magnet", "suction", "press-fit"}, optional
        Name of the kind; mortar, magnets and suction cups have shear by friction unless `shear`
        is given.

    Raises
    ------
    InputError
        If the strength is missing or negative, a number is not finite, or points have no normal.

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
        """Verify pull and shear strength; `what` names the bond in error messages."""
        given = [self.pull, self.pull_per_area]
        if given.count(None) != 1:
            has = "has no strength" if given.count(None) == 2 else "has both pull and pull_per_area"
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
        """Verify the kind of bond; `what` names the bond in error messages."""
        if self.kind is None:
            return
        if self.kind not in KINDS:
            near = nearest_name(str(self.kind), KINDS)
            hint = f"did you mean {near!r}?" if near else f"give one of {', '.join(KINDS)}"
            raise InputError(f"{what} has the kind {self.kind!r}", hint=hint)

    def _require_points(self, what: str) -> None:
        """Verify points and normal of the bond; `what` names it in error messages."""
        if self.points is None:
            if self.normal is not None:
                raise InputError(f"{what} has a normal but no points", hint="give both or neither")
            return
        points = frozen(self.points, (-1, 3)) if len(self.points) else np.empty((0, 3))
        if not len(points) or not np.isfinite(points).all():
            raise InputError(f"{what} has no valid points", hint="give at least one point")
        if self.normal is None:
            raise InputError(
                f"{what} has points but no normal",
                hint="give the normal, from the first part to the second",
            )
        if self.pull_per_area is not None:
            raise InputError(
                f"{what} has points, which have no area", hint="give pull, the force at each point"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "normal", unit(self.normal, f"normal of the {what}"))

    @property
    def bears(self) -> float | str | None:
        """Shear strength of the bond: a force per point [N], "mu" for friction, None: no limit."""
        return KINDS[self.kind] if self.shear is None and self.kind is not None else self.shear

    @property
    def entry(self) -> ListedBond:
        """The bond as an entry of an answer."""
        return ListedBond(
            parts=self.parts,
            pull=self.pull,
            pull_per_area=self.pull_per_area,
            kind=self.kind,
            shear=self.bears,
        )

    def with_strength(self, share: float) -> Bond:
        """The bond with its pull and shear strength multiplied by `share`."""

        def times_share(value: Any) -> Any:
            return value * share if isinstance(value, float) else value

        return dataclasses.replace(
            self,
            pull=times_share(self.pull),
            pull_per_area=times_share(self.pull_per_area),
            shear=times_share(self.shear),
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
    """Raise an InputError if two bonds of the same parts both act at all contact points.

    Raises `InputError` if a pair has two such bonds.
    """
    seen: set[frozenset[str]] = set()
    for bond in bonds:
        pair = frozenset(bond.parts)
        if bond.points is None and pair in seen:
            names = " and ".join(repr(name) for name in bond.parts)
            raise InputError(
                f"the bonds of {names} conflict: two of them act at all contacts of the pair",
                hint="remove a bond, or give the points of each",
            )
        if bond.points is None:
            seen.add(pair)


class _HasBonds(Protocol):
    """An assembly-like object with bonds and straps, as `require_no_bonds` needs it."""

    @property
    def bonds(self) -> Any: ...
    @property
    def straps(self) -> Any: ...
    @property
    def source(self) -> str: ...


def require_no_bonds(assembly: _HasBonds, verb: str, why: str) -> None:
    """Raise an InputError if an assembly has bonds or straps, for a function `verb` without them.

    Arguments: `why`: reason why it does not support bonds, for the message; the same reason
    excludes straps. Raises `InputError` if the assembly has bonds or straps.
    """
    if assembly.straps:
        raise InputError(
            f"{verb} does not support straps: their forces are those of one position",
            file=assembly.source or None,
            hint="remove the straps, or use check, margin or transport",
        )
    if assembly.bonds:
        names = " and ".join(repr(name) for name in assembly.bonds[0].parts)
        raise InputError(
            f"{verb} does not support bonds, such as that of {names}: {why}",
            file=assembly.source or None,
            hint="remove the bonds, or use check or margin in this orientation",
        )
