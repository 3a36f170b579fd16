"""Does what stands take the force with which a part is pressed in?

While a part p is put down on what stands, S with H held, a hand presses on it along its way. In
place, loaded with the force F d at its centre of mass and free, it has to be held by contacts:

    S + p holds under F d on p, H held            F: the force [N];  d: the last piece of its way

(Boneschanscher's question). So p itself has to be stopped along d, by a seat or by friction. A
group is pressed at each of its parts, by their share of its mass.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kilter.analysis.planning.order.removal import Direction
from kilter.analysis.planning.states.part_sets import mask_of, members
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Mask
from kilter.assembly import Load

__all__ = ["Pressed", "Pressing", "press_loads"]


@dataclass(frozen=True, slots=True, eq=False)
class Pressed:
    """What stands before a part is put in, and with it in place and pressed.

    Attributes
    ----------
    standing : State
    pressed : State or None
        None where what stands does not hold even before.
    """

    standing: State
    pressed: State | None

    @property
    def stable(self) -> bool | None:
        """Whether both hold."""
        return self.standing.stable if self.pressed is None else self.pressed.stable

    @property
    def moves(self) -> Mask:
        """Parts that move where one of both does not hold, shape (N,)."""
        return self.standing.moves if self.pressed is None else self.pressed.moves


@dataclass(slots=True)
class Pressing:
    """The states of an assembly in which a part is pressed.

    Attributes
    ----------
    states : States
        Without the force.
    force : float
        [N]
    """

    states: States
    force: float
    _of: dict[tuple[int, Direction], States] = field(default_factory=dict)

    def judge_of(self, moved: int, direction: Direction) -> Callable[[Mask, Mask], Pressed]:
        """From masks of parts that stand and that are held to both states.

        Parameters
        ----------
        moved : int
            The parts that are put in.
        direction : tuple of float
            Along which they come (unit).
        """
        coming = mask_of(moved, len(self.states.assembly))

        def judge(present: Mask, held: Mask) -> Pressed:
            standing = self.states.judge(present, held & present)
            if not standing.stable:
                return Pressed(standing, None)
            pressed = self.states_of(moved, direction).judge(present | coming, held)
            return Pressed(standing, pressed)

        return judge

    def states_of(self, moved: int, direction: Direction) -> States:
        """The states of the assembly with the force on some parts."""
        key = moved, direction
        if key not in self._of:
            assembly = self.states.assembly
            names = [assembly.names[k] for k in members(moved, len(assembly)).tolist()]
            mass = dict(zip(assembly.names, assembly.geometry.mass.tolist(), strict=True))
            loads = press_loads(names, [mass[name] for name in names], direction, self.force)
            loaded = replace(assembly, loads=[*assembly.loads, *(Load(**one) for one in loads)])
            self._of[key] = States(loaded, self.states.contacts)
        return self._of[key]


def press_loads(
    names: list[str], mass: list[float], direction: Direction, force: float
) -> list[dict[str, Any]]:
    """The loads of a force [N] on some parts, by share of their mass, as a file has them."""
    along = force * np.array(direction)
    return [
        {"part": name, "force": (along * (one / sum(mass))).tolist(), "torque": [0.0] * 3}
        for name, one in zip(names, mass, strict=True)
    ]
