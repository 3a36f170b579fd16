"""Rules of a plan: allowed orders, held parts, paths, and the quantity to be minimised."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.validate import frozen, number
from kilter.values.guesses import guarded
from kilter.values.value import Value

MOST_HELD = 2
"""Default of the largest number of parts held at once."""
FEWEST = ("holds", "held-steps", "turns")
"""Quantities that a plan may minimise."""


@guarded
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlanRules(Value):
    """Rules that `kilter.plan` obeys; part names may be patterns with ``*``, ``?`` and ``[]``.

    Parameters
    ----------
    hold : int
        Largest number of parts held at once, without the moved part.
    directions : sequence of "axes", "normals" or array_like, shape (3,)
        Directions of motion in the world frame, in the order in which they are tried.
    before : iterable of pairs of str
        Pairs of patterns; parts of the first are inserted before parts of the second.
    never_hold : str or iterable of str
        Parts that must not be held.
    screws : iterable of pairs of str
        Bolts and nuts: a bolt stays while its nut is on, a nut comes off along its axis.
    groups : iterable of str or of iterables of str
        Groups of parts that move together. Nothing is assumed to join the parts of a group once
        they are in place; their connection on the path is not analysed.
    together : bool
        Whether parts that block each other may move together if no part can leave alone.
    fewest : {"holds", "held-steps", "turns"}
        Quantity to be minimised: parts held at once, steps during which a part is held, or turns
        between steps. "turns" implies `turn`.
    sequence : iterable of str or of iterables of str, optional
        Order to verify instead of a search; the parts of an entry with several names move together.
    press : float
        Force that presses each seated part along the last leg of its path [N].
    carried : float or array_like, shape (3,)
        Acceleration of the carrier that the standing parts of every step and the finished assembly
        also carry [m/s^2]: a size, in every horizontal direction, or a single vector.
    turn : bool
        Whether the standing parts, base included, may be turned between steps. Cannot be combined
        with `press`, `carried`, `together`, `sequence`, loads or the fewest held steps.

    Raises
    ------
    InputError
        If a number or a word is invalid, or if turns are combined with a rule that excludes them.

    Examples
    --------
    >>> PlanRules(hold=0, before=[("plate", "bolt-*")]).hold
    0
    """

    hold: int = MOST_HELD
    directions: Sequence[str | ArrayLike] = ("axes", "normals")
    before: Iterable[tuple[str, str]] = ()
    never_hold: str | Iterable[str] = ()
    screws: Iterable[tuple[str, str]] = ()
    groups: Iterable[str | Iterable[str]] = ()
    together: bool = False
    fewest: str = "holds"
    sequence: Iterable[str | Iterable[str]] | None = None
    press: float = 0.0
    carried: float | ArrayLike = 0.0
    turn: bool = False

    def __post_init__(self) -> None:
        """Convert and validate the values of the rules."""
        if self.fewest not in FEWEST:
            raise InputError(f"fewest is {self.fewest!r:.40}", hint=f"give {' or '.join(FEWEST)}")
        for name in ("directions", "before", "never_hold", "screws", "groups", "sequence"):
            value = getattr(self, name)
            if isinstance(value, Iterator):  # an iterator could be read by a single plan only
                object.__setattr__(self, name, tuple(value))
        object.__setattr__(self, "hold", _whole_number(self.hold))
        object.__setattr__(self, "press", number(self.press, "press", lowest=0))
        object.__setattr__(self, "carried", _acceleration(self.carried))
        object.__setattr__(self, "turn", self.turn or self.fewest == "turns")
        others = self.press or self.together or self.sequence is not None or np.any(self.carried)
        if self.turn and (others or self.fewest == "held-steps"):
            raise turns_alone()


def turns_alone() -> InputError:
    """Create the error for turns combined with a rule or a load that excludes turns."""
    return InputError(
        "turns cannot be combined with press, carried, together, a sequence, held-steps or loads",
        hint="leave the turns or the other option out",
    )


def _acceleration(carried: float | ArrayLike) -> float | Array:
    """Validate the acceleration to be carried: a size of at least 0, or a vector [m/s^2]."""
    if np.ndim(carried) == 0:
        return number(carried, "carried", lowest=0)
    vector = frozen(carried, (3,), "carried")
    if not np.isfinite(vector).all():
        raise InputError(f"carried is {vector.tolist()}", hint="give three finite numbers")
    return vector


def _whole_number(hold: int) -> int:
    """Validate the number of hands: a whole number of at least 0."""
    if isinstance(hold, bool) or not isinstance(hold, int | np.integer) or hold < 0:
        raise InputError(f"hold is {hold!r:.40}", hint="give a whole number, 0 or more")
    return int(hold)
