"""Step: parts that are put in, what is held meanwhile, and how surely what stands holds.

A step puts one part in, or several that move as one, along its way, reversed: from far away to its
seat. What stands then, the held parts held, holds with what moves absent; once it is in place and
held too, it holds as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from kilter.analysis.planning.order.removal import Direction, Leg
from kilter.analysis.planning.order.search import OrderSearch, Removed
from kilter.analysis.planning.states.holds import Holds
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Array

__all__ = ["FAR", "NO_WAY", "UNDECIDED", "VERDICTS", "Step", "lower_level", "steps_of"]

FAR = 2.0
"""How far away a part begins, over the size of the whole assembly."""
VERDICTS = {"proved": "stable", "settles": "settles", "equilibrium": "potentially-stable"}
"""Of a step by its level."""
NO_WAY = "no free path was found along the directions that were tried"
UNDECIDED = "it is undecided whether the parts that stand before it hold"
"""Why a step of a given order fails, so far as is known."""


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """Parts that are put in: one, or several that move as one.

    Attributes
    ----------
    parts : tuple of str
    legs : tuple of Leg
        Their way out; they come in along it, reversed.
    over : str or None
        The bolt over whose thread a nut comes.
    touches, rubs : tuple of str
        What they touch once they are in place; what they slide along on the last piece.
    held, grips, releases : tuple of str
        Parts held while they move; of these, those that were not held before; parts that were.
    state : State
        What stands while they move.
    level : {"proved", "settles", "equilibrium"} or None
        How surely that holds; None where it does not.
    needs : Holds or None
        Where parts are held: the motions that say that fewer are not enough.
    fails : tuple of str
        Of a given order: why this step cannot be made; then what is said of its way, or of its
        holds, may be empty.
    pressed : State or None
        What stands and these in place, pressed along their way, where that was asked.
    under : States or None
        The states of that force.
    turned : States or None
        The states under the direction of gravity of this step, where that is not the file's.
    between : State or None
        Where all is turned after it: what stands then, before it is turned.
    """

    parts: tuple[str, ...]
    legs: tuple[Leg, ...]
    over: str | None
    touches: tuple[str, ...]
    rubs: tuple[str, ...]
    held: tuple[str, ...]
    grips: tuple[str, ...]
    releases: tuple[str, ...]
    state: State
    level: str | None
    needs: Holds[State] | None = None
    fails: tuple[str, ...] = ()
    pressed: State | None = None
    under: States | None = None
    turned: States | None = None
    between: State | None = None

    @property
    def part(self) -> str:
        """The part; the first of several."""
        return self.parts[0]

    @property
    def broken(self) -> bool:
        """Whether it fails whatever the ways."""
        return any(reason not in (NO_WAY, UNDECIDED) for reason in self.fails)

    @property
    def direction(self) -> Direction | None:
        """The direction of the last piece of its way in (unit, world frame); None without one."""
        if not self.legs:
            return None
        return _back(self.legs)

    def path(self, far: float) -> Array:
        """Its way in, as places relative to its seat, the seat last, shape (n, 3) [length unit].

        Parameters
        ----------
        far : float
            Length of the endless piece.
        """
        lengths = [leg.length if np.isfinite(leg.length) else far for leg in self.legs]
        pieces = [
            size * np.array(leg.direction) for size, leg in zip(lengths, self.legs, strict=True)
        ]
        places = np.cumsum([np.zeros(3), *pieces], axis=0)
        back: Array = places[::-1] + 0.0
        return back

    def __repr__(self) -> str:
        held = f", held: {', '.join(self.held)}" if self.held else ""
        return f"<Step: {', '.join(self.parts)}{held}>"


def steps_of(
    search: OrderSearch, removed: Sequence[Removed], require: str, effort: float
) -> list[Step]:
    """The removals as steps forwards, each with the level that its state reaches."""
    states, names = search.states, search.states.assembly.names
    steps: list[Step] = []
    before: set[str] = set()
    for one in reversed(removed):
        held = states.held_names(one.state)
        moved = tuple(names[k] for k in one.parts)
        along = one.legs[0].direction if one.legs else (0.0, 0.0, 0.0)
        touches, rubs = search.removal.touching(one.set, one.state.present, along)
        under = states if one.turned is None else one.turned
        level = under.level(one.state, require=require, effort=effort, work=search.work)
        pressed_by = None
        if one.pressed is not None and search.pressing is not None:
            pressed_by = search.pressing.states_of(one.set, _back(one.legs))
            pressed = pressed_by.level(
                one.pressed, require=require, effort=effort, work=search.work
            )
            level = lower_level(level, pressed)
        bolt = search.removal.over(one.set, one.state.present)
        steps.append(
            Step(
                parts=moved,
                legs=one.legs,
                over=None if bolt is None else names[bolt],
                touches=_names(names, touches),
                rubs=_names(names, rubs) if one.legs else (),
                held=tuple(held),
                grips=tuple(name for name in held if name not in before),
                releases=tuple(sorted(before - set(held), key=names.index)),
                state=one.state,
                level=level,
                needs=one.needs if one.state.stable else None,
                fails=one.fails,
                pressed=one.pressed,
                under=pressed_by,
                turned=one.turned,
                between=one.between,
            )
        )
        before = {*held, *moved} if held else set()
    return steps


def _back(legs: tuple[Leg, ...]) -> Direction:
    """The direction of the last piece of a way in (unit)."""
    x, y, z = (0.0 - one for one in legs[0].direction)
    return x, y, z


def lower_level(first: str | None, second: str | None) -> str | None:
    """The lower of two levels; None if one of them is None."""
    if first is None or second is None:
        return None
    return max(first, second, key=list(VERDICTS).index)


def _names(names: Sequence[str], parts: Iterable[int]) -> tuple[str, ...]:
    return tuple(names[k] for k in parts)
