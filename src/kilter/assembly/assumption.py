"""Assumptions about an inexact file: the rungs of a ladder, each with more than the one before.

    drawn    the drawn pose and its certain contacts
    play     parts move within their play until they rest
    fits     play, and pairs that look fastened are joined: threads, press fits, inserts
    joined   fits, and parts that touch or overlap are joined into bodies

A contact that is merely sunk is never a joint on the rungs below "joined".
"""

from __future__ import annotations

from typing import Annotated

from kilter.errors import InputError
from kilter.tell.record import LevelWord, OneOf, Record, Vector, Word

DRAWN, PLAY, FITS, JOINED = RUNGS = ("drawn", "play", "fits", "joined")
"""The assumptions, the least first."""
RungWord = Annotated[str, OneOf(RUNGS)]


def valid_rung(rung: str) -> str:
    """A rung by name.

    Raises `InputError` for another word.

    Examples
    --------
    >>> valid_rung("play")
    'play'
    """
    if rung not in RUNGS:
        raise InputError(f"assume is {rung!r}", hint=f"it is one of {', '.join(RUNGS)}")
    return rung


class LadderRow(Record):
    """The verdict on a rung of the ladder of assumptions."""

    assume: RungWord
    """The rung."""
    friction: float | None = None
    """Friction coefficient that this row assumes [-]; null: that of the file."""
    verdict: Word | None = None
    """The verdict; null if it was not decided."""
    level: LevelWord | None = None
    """The level; null if the assembly does not hold, or was not decided."""
    falls: int = 0
    """Number of parts that fall."""
    names: tuple[str, ...] = ()
    """Names of the largest parts that fall, at most five."""
    decided: bool = True
    """Whether the row was decided within its share of the work; else further parts may fall."""
    why: Annotated[str, OneOf(("size", "work"))] | None = None
    """Why it was not decided: the assembly is too large for a search for a pose at rest beside the
    verdict, or the search did not end within its work. Null if it was decided."""


class Body(Record):
    """Parts that touch or overlap, taken as one body, or a single loose part."""

    parts: tuple[str, ...]
    """Names of the parts, the largest first."""
    name: str
    """Name of the largest part."""
    mass: float
    """Mass [kg]."""
    on_floor: bool
    """Whether the body touches a floor, a table or a part that is held."""
    tilt_deg: float | None = None
    """Tilt at which the body tips over [deg]; 0 if it tips as it stands. Null unless it is on a
    floor, without a held part, and its contacts with the floor are modelled."""
    tilt_down: Vector | None = None
    """Direction of gravity at this tilt [-]; null without a tilt."""
    rest_deg: float | None = None
    """Angle by which a body tips over on the floor until it rests on its triangles, as if no other
    body were there [deg]; null if it stands, and for a loose body that does not fall onto a floor.
    """
    rests_on: tuple[str, ...] = ()
    """Its parts that touch the floor then."""
    nearest: str | None = None
    """Nearest part of another body; null for a body on the floor."""
    distance: float | None = None
    """Distance of this part [length unit]; far curved faces count as their triangles."""
    below: str | None = None
    """Part or floor onto which the body falls straight down; null if it is on the floor, or if
    nothing is below it."""
    fall: float | None = None
    """Way of this fall [length unit]; 0 if both touch in a way that is not modelled."""
