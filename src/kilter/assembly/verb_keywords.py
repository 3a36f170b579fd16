"""The keywords that the verbs share: one table of names, defaults, units and meanings.

A verb is a function that answers a question about an assembly: `kilter.check`, `kilter.orient`,
`kilter.region`, `kilter.margin`, `kilter.plan`, `kilter.hold`, `kilter.states` and
`kilter.contacts`. Tests compare their signatures with this table.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from kilter.assembly.assembly import Assembly, require_assembly
from kilter.errors import InputError
from kilter.hooks import hook
from kilter.tell.levels import REQUIRE
from kilter.work import EFFORT

__all__ = ["CHANGES", "KEYWORDS", "AssemblyOrPath", "Keyword", "asked_assembly"]

AssemblyOrPath = Assembly | str | os.PathLike[str]
"""The first argument of a verb: an assembly, or the path of a file that `kilter.load` reads."""


@dataclass(frozen=True, slots=True)
class Keyword:
    """A keyword argument that several functions share: its default, its unit, its meaning."""

    default: Any
    unit: str
    meaning: str


KEYWORDS = {
    "friction": Keyword(None, "-", "coefficient of contacts without a coefficient of their own"),
    "down": Keyword(None, "-", "direction of gravity, shape (3,); its magnitude stays"),
    "ground": Keyword((), "", "names of parts that are also held; * and ? are globs"),
    "floor": Keyword(None, "length unit", "True: a held table under the lowest point; or its top"),
    "contacts": Keyword(None, "", "contacts of the assembly; by default they are detected"),
    "tolerance": Keyword(None, "", "tolerances of this detection"),
    "require": Keyword(REQUIRE, "", "level from which the answer is yes"),
    "effort": Keyword(EFFORT, "-", "limit of counted work: each unit allows ten times more"),
    "time_limit": Keyword(None, "s", "limit of time; the answer is what was proved until then"),
    "progress": Keyword(None, "", "function that is called with the name of each stage"),
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
        return read
    require_assembly(assembly, verb)
    if friction is not None:
        assembly = assembly.with_friction(friction)
    if down is not None:
        assembly = assembly.with_down(down)
    names = [ground] if isinstance(ground, str) else list(ground)
    if names:
        assembly = assembly.with_grounded(names)
    if floor is not None and floor is not False:
        assembly = assembly.with_floor(None if floor is True else floor)
    return assembly
