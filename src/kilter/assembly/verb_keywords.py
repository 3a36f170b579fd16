"""The keywords that the verbs share: one table of names, defaults, units and meanings.

A verb is a function that answers a question about an assembly: `kilter.check`, `check_many`,
`orient`, `region`, `margin`, `transport`, `plan`, `hold`, `states`, `contacts`, `improve`, `report`
and `draw`. Tests compare their signatures and docstrings with this table.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.assembly.assembly import Assembly, require_assembly
from kilter.assembly.assembly_tolerances import SAME_DOWN
from kilter.assembly.plain_joints import plain_joints
from kilter.errors import InputError, some_names
from kilter.hooks import hook
from kilter.rigid import in_brackets
from kilter.tell.levels import REQUIRE
from kilter.validate import name_list
from kilter.work import EFFORT

__all__ = [
    "CHANGES",
    "KEYWORDS",
    "AssemblyOrPath",
    "Keyword",
    "asked_assembly",
    "holding",
    "on_floor",
    "require_unchanged",
]

AssemblyOrPath = Assembly | str | os.PathLike[str]
"""The first argument of a verb: an assembly, or the path of a file that `kilter.load` reads."""


@dataclass(frozen=True, slots=True)
class Keyword:
    """A keyword argument that several functions share: its default, its unit, its meaning.

    The unit is "-" for a number without a unit, and empty for values that are no numbers.
    """

    default: Any
    unit: str
    meaning: str

    @property
    def sentence(self) -> str:
        """The sentence about this keyword in the docstrings of verbs."""
        return f"{self.meaning} [{self.unit}]." if self.unit else f"{self.meaning}."


KEYWORDS = {
    "friction": Keyword(
        None, "-", "Coefficient of the contacts without a coefficient of their own"
    ),
    "down": Keyword(None, "-", "Direction of gravity, whose magnitude stays"),
    "ground": Keyword((), "", "Parts that are also held; ``*`` and ``?`` are wildcards"),
    "floor": Keyword(
        None, "length", "True adds a held table under the lowest point; a number is its height"
    ),
    "contacts": Keyword(
        None, "", "Contacts of this assembly; by default they are detected from its geometry"
    ),
    "tolerance": Keyword(None, "", "Tolerances of the detection: gap, angle and clearance"),
    "require": Keyword(REQUIRE, "", "Level from which the answer is yes"),
    "effort": Keyword(
        EFFORT, "-", "Work limit; each further unit allows about ten times more work"
    ),
    "time_limit": Keyword(None, "s", "Time limit"),
    "progress": Keyword(None, "", "Function that is called with the name of each stage"),
}
"""Shared keywords by name."""
CHANGES = ("friction", "down", "ground", "floor")
"""Keywords that change the assembly before the question."""


def asked_assembly(
    assembly: AssemblyOrPath,
    verb: str,
    contacts: object = None,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
) -> Assembly:
    """Read the assembly that a function is called with, and apply its keyword arguments.

    Parameters
    ----------
    assembly : Assembly, or path
    verb : str
        Name of the verb, for messages.
    contacts : ContactSet or None
        Given contacts; they exclude `friction` and `floor`, which would change them.
    friction, down, ground, floor
        See `KEYWORDS`; None and () change nothing.

    Raises
    ------
    InputError
        If the value is neither an assembly nor the path of a readable file, a name matches no
        part, or contacts are given beside a keyword that changes them.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> cube = Assembly([Part("cube", Box(1, 1, 1))])
    >>> asked_assembly(cube, "check", ground="cube", friction=0.5).friction
    0.5
    >>> asked_assembly(cube, "check") is cube
    True
    """
    changing = [name for name, value in (("friction", friction), ("floor", floor)) if value]
    if contacts is not None and changing:
        raise InputError(
            f"{verb} got contacts and {changing[0]}, which changes the contacts",
            hint=f"leave out one of them, or find the contacts with the same {changing[0]}",
        )
    if isinstance(assembly, str | os.PathLike):
        read: Assembly = hook("load")(
            assembly, friction=friction, down=down, ground=ground, floor=floor
        )
        return plain_joints(read, verb)
    require_assembly(assembly, verb)
    if friction is not None:
        assembly = assembly.with_friction(friction)
    names = name_list(ground, "ground")
    if names:
        assembly = holding(assembly, names)
    return plain_joints(on_floor(assembly, floor, down), verb)


def holding(assembly: Assembly, patterns: Iterable[str]) -> Assembly:
    """The assembly with further held parts; a note names those whose loads have no effect.

    Examples
    --------
    >>> from kilter import Box, Load, Part
    >>> cube = Assembly([Part("cube", Box(1, 1, 1))], loads=[Load("cube", [0, 0, -1])])
    >>> holding(cube, ["cube"]).notes
    ("loads on held parts, without effect: 'cube'",)
    """
    chosen = assembly.matching(patterns)
    loaded = sorted({load.part for load in assembly.loads if load.part in chosen})
    held = assembly.with_grips(chosen)
    if not loaded:
        return held
    note = f"loads on held parts, without effect: {some_names(loaded)}"
    return dataclasses.replace(held, notes=[*held.notes, note])


def on_floor(assembly: Assembly, floor: bool | float | None, down: ArrayLike | None) -> Assembly:
    """The assembly on a floor across its own gravity, which is then turned to `down`.

    The floor belongs to the assembly as drawn, as in margins and regions. A note states this if
    gravity is oblique to it.

    Parameters
    ----------
    assembly : Assembly
    floor : bool or float or None
        True for a floor under the lowest point, or its height; None and False for no floor.
    down : array_like, shape (3,), optional
        Direction of gravity.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> cube = Assembly([Part("cube", Box(1, 1, 1))])
    >>> tilted = on_floor(cube, True, [0.1, 0, -1])
    >>> tilted["floor"].pose.position.tolist(), tilted.notes[0][:59]
    ([0.0, 0.0, -0.625], 'the floor lies across the up direction of the file, (0, 0, ')
    """
    has_floor = floor is not None and floor is not False
    if has_floor:
        assembly = assembly.with_floor(None if floor is True else floor)
    if down is None:
        return assembly
    turned = assembly.with_down(down)
    if not has_floor or np.linalg.norm(turned.down - assembly.down) <= SAME_DOWN:
        return turned
    note = (
        f"the floor lies across the up direction of the file, {in_brackets(-assembly.down)}, and "
        "turns with the parts: gravity is oblique to it"
    )
    return dataclasses.replace(turned, notes=[*turned.notes, note])


def require_unchanged(
    subject: object,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
) -> None:
    """Reject keywords that would change the assembly of a complete answer.

    Raises
    ------
    InputError
        If a keyword has another value than its default.

    Examples
    --------
    >>> require_unchanged("answer", friction=0.5)
    Traceback (most recent call last):
        ...
    kilter.errors.InputError: friction changes an assembly, but the type is str; give an assembly
    """
    names = [ground] if isinstance(ground, str) else list(ground)
    changes = {"friction": friction, "down": down, "ground": names or None, "floor": floor}
    changing = [name for name, value in changes.items() if value is not None]
    if changing:
        kind = type(subject).__name__
        raise InputError(
            f"{changing[0]} changes an assembly, but the type is {kind}",
            hint="give an assembly",
        )
