"""A step of a plan: inserted parts, their path, held parts and verdict level after the step.

A step inserts one part, or several parts that move together, from far away to the seat. Its
state, the standing parts with the holds and without the moved parts, holds. It also holds with
the moved parts in place if they are held too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kilter.analysis.decision.cascade import Word
from kilter.analysis.planning.order.removal import Direction, Leg
from kilter.analysis.planning.order.search import OrderSearch, Removed
from kilter.analysis.planning.states.holds import Holds, members
from kilter.analysis.planning.states.known_proofs import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.errors import InputError, some_names
from kilter.tell.numbers import count
from kilter.tell.record import InPython, LevelWord, Lines, Record, Vector, key

FAR = 2.0
"""Distance at which a part starts, relative to the size of the whole assembly [-]."""
VERDICTS: dict[str, Word] = {
    "proved": "stable",
    "settles": "settles",
    "equilibrium": "potentially-stable",
}
"""Verdict of a step for each level."""
NO_WAY = "no free path was found along the directions that were tried"
UNDECIDED = "it is undecided whether the parts in place before it hold"
"""Reasons why a step of a given order fails that are not proofs for every path."""


class Step(Record):
    """A step of a plan, which inserts one part, or several parts that move together."""

    parts: tuple[str, ...]
    """Inserted parts."""
    legs: InPython[tuple[Leg, ...]]
    """Straight pieces of the path out; the parts come in along its reverse."""
    path: Lines
    """Positions of the part, relative to its final position, which is the last [length unit]."""
    over: str | None
    """Bolt whose thread carries the inserted nut; null for other parts."""
    touches: tuple[str, ...]
    """Parts in contact with the seated parts."""
    rubs: tuple[str, ...]
    """Parts along which the inserted parts slide on the last piece of the path."""
    held: tuple[str, ...]
    """Parts held during the step."""
    grips: tuple[str, ...]
    """Newly gripped parts."""
    releases: tuple[str, ...]
    """Parts released before the step."""
    down: Vector
    """Direction of gravity during the step."""
    level: LevelWord | None
    """Level of the state of the standing parts; null if it does not hold."""
    fails: tuple[str, ...] = ()
    """Reasons why a step of a given order is impossible; path and holds may then be empty."""
    state: InPython[State]
    """State of the standing parts during the step."""
    needs: InPython[Holds[State] | None] = None
    """Motions that prove that fewer holds are not enough; None without held parts."""
    pressed: InPython[State | None] = None
    """State with the moved parts in place under the pressing force; None without that force."""
    under: InPython[States | None] = None
    """States under the pressing force."""
    turned: InPython[States | None] = None
    """States under the direction of gravity of this step; None under that of the file."""
    between: InPython[State | None] = None
    """State of the standing parts before the assembly is turned after this step, or None."""

    @property
    @key
    def direction(self) -> Direction | None:
        """Direction in which the inserted parts arrive, unit; null without a path."""
        return _back(self.legs) if self.legs else None

    @property
    @key
    def verdict(self) -> Word:
        """Verdict on the standing parts."""
        return "unstable" if self.level is None else VERDICTS[self.level]

    @property
    def part(self) -> str:
        """Name of the inserted part of the step, or the first name of several."""
        return self.parts[0]

    @property
    def broken(self) -> bool:
        """Whether this step of a given order fails for every path."""
        return any(reason not in (NO_WAY, UNDECIDED) for reason in self.fails)

    def __repr__(self) -> str:
        held = f", held: {', '.join(self.held)}" if self.held else ""
        return f"<Step: {', '.join(self.parts)}{held}>"


def steps_of(
    search: OrderSearch, removed: Sequence[Removed], require: str, effort: float
) -> list[Step]:
    """Convert removals into the steps of a plan, each with its verdict level."""
    states, names = search.states, search.states.assembly.names
    far = FAR * float(np.ptp(states.assembly.geometry.vertices, axis=0).max())
    steps: list[Step] = []
    before: set[str] = set()
    for removal in reversed(removed):
        held = states.held_names(removal.state)
        moved = _names(names, removal.parts)
        along = removal.legs[0].direction if removal.legs else (0.0, 0.0, 0.0)
        touches, rubs = search.removal.touching(removal.set, removal.state.present, along)
        under = states if removal.turned is None else removal.turned
        level = under.level(removal.state, require=require, effort=effort, work=search.work)
        pressed_by = None
        if removal.pressed is not None and search.pressing is not None:
            pressed_by = search.pressing.states_of(removal.set, _back(removal.legs))
            pressed = pressed_by.level(
                removal.pressed, require=require, effort=effort, work=search.work
            )
            level = lower_level(level, pressed)
        bolt = search.removal.over(removal.set, removal.state.present)
        steps.append(
            Step(
                parts=moved,
                legs=removal.legs,
                path=_way_in(removal.legs, far),
                over=None if bolt is None else names[bolt],
                touches=_names(names, touches),
                rubs=_names(names, rubs) if removal.legs else (),
                held=tuple(held),
                grips=tuple(name for name in held if name not in before),
                releases=tuple(sorted(before - set(held), key=names.index)),
                down=under.assembly.down,
                state=removal.state,
                level=level,
                needs=removal.needs if removal.state.stable else None,
                fails=removal.fails,
                pressed=removal.pressed,
                under=pressed_by,
                turned=removal.turned,
                between=removal.between,
            )
        )
        before = {*held, *moved} if held else set()
    return steps


def _way_in(legs: tuple[Leg, ...], far: float) -> Array:
    """Points of the path in, shape (n, 3) [length unit]; `far` is the length of an endless leg."""
    lengths = [leg.length if np.isfinite(leg.length) else far for leg in legs]
    pieces = [size * np.array(leg.direction) for size, leg in zip(lengths, legs, strict=True)]
    back: Array = np.cumsum([np.zeros(3), *pieces], axis=0)[::-1] + 0.0
    return back


def _back(legs: tuple[Leg, ...]) -> Direction:
    """Unit direction in which parts arrive, from the straight legs along which they would leave."""
    x, y, z = (0.0 - component for component in legs[0].direction)
    return x, y, z


def lower_level(first: str | None, second: str | None) -> str | None:
    """The lower of two verdict levels; None if one of them is None."""
    if first is None or second is None:
        return None
    return max(first, second, key=list(VERDICTS).index)


def _names(names: Sequence[str], parts: Iterable[int]) -> tuple[str, ...]:
    """Names of parts with the given indices."""
    return tuple(names[k] for k in parts)


# Judge an order of assembly that the user gives: path, held parts and failures of each step.


def sets_of_order(assembly: Assembly, order: Iterable[str | Iterable[str]]) -> list[int]:
    """For each step of a given order, a bit set of the parts that this step inserts.

    Arguments: `order`: names of the steps; the parts of an entry with several names move together.
    Raises `InputError` if a name is not a part, belongs to a grounded part, comes twice, or if a
    part is left out.
    """
    sets, seen = [], {part.name for part in assembly if part.grounded}
    for entry in order:
        names = [entry] if isinstance(entry, str) else list(entry)
        if not names:
            raise InputError("a step of the sequence names no part", hint="name its parts")
        for name in names:
            place = assembly.index_of(name)
            if name in seen:
                fixed = assembly[place].grounded
                why = (
                    "is grounded, so it stands from the start"
                    if fixed
                    else "comes twice in the sequence"
                )
                raise InputError(f"{name!r} {why}", hint="leave it out")
            seen.add(name)
        sets.append(sum(1 << assembly.index_of(name) for name in names))
    missing = [name for name in assembly.names if name not in seen]
    if missing:
        raise InputError(f"the sequence leaves out {some_names(missing)}", hint="add them")
    return sets


def judge_order(search: OrderSearch, order: list[int], hold: int) -> list[Removed]:
    """Judge each step of a given order, the last step first, as a removal with reasons of failure.

    Parameters
    ----------
    search : OrderSearch
    order : list of int
        Bit sets of parts from `sets_of_order`.
    hold : int
        Largest number of parts held at once.
    """
    present, removals = search.whole, []
    for moved in reversed(order):
        removals.append(_judge_removal(search, moved, present, hold))
        present &= ~moved
        search.visited += 1
    return removals


def _judge_removal(search: OrderSearch, moved: int, present: int, hold: int) -> Removed:
    """Judge the removal of given parts: its path, held parts and reasons of failure."""
    rest, fails = present & ~moved, []
    parts = tuple(members(moved, len(search.after)).tolist())
    names = search.states.assembly.names
    early = search.later_of(moved) & rest
    if early:
        later = [names[k] for k in members(early, len(names)).tolist()]
        fails.append(f"it must come before {some_names(later)}")
    if not search.hangs_on(moved, rest):
        fails.append("it touches no standing part")
    legs = search.way_out(moved, present, 1) or search.way_out(moved, present, 2)
    if legs is None:
        fails.append(NO_WAY)
    state = search.state(rest)
    needs = None if state.stable else search.needs(rest, hold)
    if needs is not None and needs.state is not None:
        state = needs.state
    elif needs is not None:
        held = f" with up to {count(hold, 'part')} held" if hold else ""
        if state.stable is None or needs.undecided:
            fails.append(UNDECIDED)
        else:
            fails.append(f"{some_names(state.moving)} would fall before it is in place{held}")
    if search.pressing is not None and legs and not fails:
        pressed = next(search.pressed(search.pressing, moved, legs, present, hold), None)
        if pressed is not None:
            return pressed
        fails.append("the standing parts do not withstand the pressing force")
    return Removed(parts, legs or (), state, needs, tuple(fails))
