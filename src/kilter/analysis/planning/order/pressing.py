"""Verdicts on an assembly while a force presses an inserted part in.

A hand presses the part p along its path onto the standing parts S, of which H are held. Contacts
must hold the seated free part p under the force F d at its centre of mass:

    S + p holds under F d on p, H held            F: the force [N];  d: direction of the last leg

(Boneschanscher's criterion). So a seat or friction must stop p along d. The force on a group is
distributed over its parts by mass.
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
    """Verdicts on a step: before its part is inserted, and while the part is pressed in."""

    standing: State
    pressed: State | None
    """None if the standing parts do not hold even before."""

    @property
    def stable(self) -> bool | None:
        """Whether the parts hold before the insertion and under the pressing force."""
        return self.standing.stable if self.pressed is None else self.pressed.stable

    @property
    def moves(self) -> Mask:
        """Mask of the moving parts in the first of the two states that falls, shape (N,)."""
        return self.standing.moves if self.pressed is None else self.pressed.moves


@dataclass(slots=True)
class Pressing:
    """Verdicts on the steps of a plan under the force that presses parts in."""

    states: States
    """States without the force."""
    force: float
    """Pressing force [N]."""
    _of: dict[tuple[int, Direction], States] = field(default_factory=dict)

    def judge_of(self, moved: int, direction: Direction) -> Callable[[Mask, Mask], Pressed]:
        """Create the function that judges a step before insertion and under the pressing force.

        Its arguments are the masks of standing and held parts.
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
        """States of the assembly with the pressing force on the moved parts."""
        key = moved, direction
        if key not in self._of:
            assembly = self.states.assembly
            names = [assembly.names[k] for k in members(moved, len(assembly)).tolist()]
            mass = dict(zip(assembly.names, assembly.geometry.mass.tolist(), strict=True))
            loads = press_loads(names, [mass[name] for name in names], direction, self.force)
            loaded = replace(assembly, loads=[*assembly.loads, *(Load(**load) for load in loads)])
            self._of[key] = States(loaded, self.states.contacts)
        return self._of[key]


def press_loads(
    names: list[str], mass: list[float], direction: Direction, force: float
) -> list[dict[str, Any]]:
    """Loads for a file that distribute a force [N] over parts by mass."""
    along = force * np.array(direction)
    return [
        {"part": name, "force": (along * (share / sum(mass))).tolist(), "torque": [0.0] * 3}
        for name, share in zip(names, mass, strict=True)
    ]
