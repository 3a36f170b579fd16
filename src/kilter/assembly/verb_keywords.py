"""The keywords that the verbs share: one table of names, defaults, units and meanings.

A verb is a function that answers a question about an assembly: `kilter.check`, `check_many`,
`orient`, `region`, `margin`, `transport`, `plan`, `hold`, `states`, `contacts`, `improve`, `report`
and `draw`. Tests compare their signatures and docstrings with this table.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from kilter.assembly.assembly import Assembly, require_assembly
from kilter.assembly.plain_joints import plain_joints
from kilter.errors import InputError
from kilter.hooks import hook
from kilter.tell.levels import REQUIRE
from kilter.validate import name_list
from kilter.work import EFFORT

__all__ = [
    "CHANGES",
    "KEYWORDS",
    "AssemblyOrPath",
    "Keyword",
    "asked_assembly",
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
"""Keywords that change the assembly before the question, in the order in which they apply."""


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
    if down is not None:
        assembly = assembly.with_down(down)
    names = name_list(ground, "ground")
    if names:
        assembly = assembly.with_grounded(names)
    if floor is not None and floor is not False:
        assembly = assembly.with_floor(None if floor is True else floor)
    return plain_joints(assembly, verb)


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
