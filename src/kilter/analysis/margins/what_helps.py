"""Changes of an assembly that raise a margin most: holding a part, more friction, other masses.

At a limit t, with the forces f and the mechanism m there (b + t d is the load, power 0):

    another load               t' = -(dw.m) / (d.m)
    the mass of part i         t' = -(w_i + t d_i).m_i / (d.m)          per share of it
    friction at a contact      t' = sum of f_n |u_t| over its points / (d.m)      per unit of mu

u_t is the velocity at which the mechanism slides there. These are the derivatives if the
mechanism is unique, and otherwise lower bounds. Holding a part ends every mechanism in
which it moves: the parts that drive it most are held in turn, and the margin found anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from kilter.analysis.margins.load_limit import (
    Limit,
    NoLimit,
    find_limit,
    finite,
    gravity_wrench,
)
from kilter.analysis.margins.tilt import TiltMargin, find_tilt_margin
from kilter.analysis.turning_tolerances import (
    MOVES,
    NO_GAIN,
)
from kilter.arrays import Array
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

if TYPE_CHECKING:
    from kilter.tell.answer_data.margin_data import HelpData

__all__ = ["Help", "what_helps"]


HELD = 4
"""Largest number of parts for which the effect of holding the part is computed."""
MORE_FRICTION = 0.1
"""Relative increase of a friction coefficient that is tried [-]."""
MORE_MASS = 0.1
"""Relative change of a mass that is tried [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Help:
    """A change of the assembly that raises a margin, and the new margin.

    Attributes
    ----------
    of : {"tilt", "load factor"}
    what : {"hold", "friction", "mass"}
    parts : tuple of str
        The part, or the two parts of the contact.
    gain : float
        [deg] of tilt (a margin ends at a right angle), or of the load factor [-]: in total if
        a part is held, infinite if no factor is then too large; per unit of mu; per share of
        the mass, negative if less mass helps.
    sentence : str
    """

    of: Literal["tilt", "load factor"]
    what: Literal["hold", "friction", "mass"]
    parts: tuple[str, ...]
    gain: float
    sentence: str

    def to_dict(self) -> HelpData:
        """The change as JSON data, for the answer of `kilter margin`."""
        return {
            "of": self.of,
            "what": self.what,
            "parts": list(self.parts),
            "gain": finite(self.gain),
            "sentence": self.sentence,
        }


def what_helps(
    program: Program,
    tilt: TiltMargin | None,
    factor: Limit | None,
    push: Array | None,
    *,
    held: Sequence[int],
) -> tuple[Help, ...]:
    """The most effective change of each kind, which raises the tilt margin or else the load factor.

    Parameters
    ----------
    tilt : TiltMargin or None
    factor : Limit or None
        Greatest load factor.
    push : ndarray, shape (3,), or None
        The direction that it is of; None: of given loads.
    held : sequence of int
        Free parts, by position, of which those that drive the mechanism most are held in turn.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> from kilter.mechanics.program import build_program
    >>> program = build_program(block, contacts(block))
    >>> [one.what for one in what_helps(program, find_tilt_margin(program), None, None, held=[1])]
    ['hold', 'friction']
    """
    if tilt is not None and tilt.angle < np.pi / 2:
        aside = tilt.down / float(tilt.down @ program.down) - program.down
        size = float(np.linalg.norm(aside))
        if size < NO_GAIN:
            return ()
        along = gravity_wrench(program, aside / size)
        limit = find_limit(program, along)
        if isinstance(limit, NoLimit):
            return ()
        slope = float(np.degrees(np.cos(tilt.angle) ** 2))
        return _helps(program, limit, along, True, slope, "tilt", held)
    if factor is None:
        return ()
    if push is not None:
        along = gravity_wrench(program, push)
        return _helps(program, factor, along, True, 1.0, "load factor", held)
    base = program.with_rows(applied=np.zeros_like(program.applied))
    return _helps(base, factor, program.applied, False, 1.0, "load factor", held)


def _helps(
    program: Program,
    limit: Limit,
    along: Array,
    by_mass: bool,
    slope: float,
    of: Literal["tilt", "load factor"],
    held: Sequence[int],
) -> tuple[Help, ...]:
    """The most effective change of each kind that raises a given limit.

    The load `along` grows with the masses if `by_mass`.
    """
    if limit.mechanism is None or not np.isfinite(limit.value):
        return ()
    motion = limit.mechanism.motion
    pace = float((along * motion).sum())
    if pace <= 0:
        return ()
    weight = program.load - program.applied + (limit.value * along if by_mass else 0.0)
    power = np.where(program.free, (weight * motion).sum(axis=1), 0.0)
    changes = [
        _hold(program, limit, along, motion, power, of, held),
        _friction(program, limit, motion, slope / pace, of),
        _mass(program, -power * slope / pace, of),
    ]
    return tuple(change for change in changes if change is not None)


def _words(of: str, gain: float) -> str:
    return f"{gain:.3g} deg of tilt" if of == "tilt" else f"{gain:.3g} to the load factor"


def _hold(
    program: Program,
    limit: Limit,
    along: Array,
    motion: Array,
    power: Array,
    of: Literal["tilt", "load factor"],
    held: Sequence[int],
) -> Help | None:
    """The part that raises the limit most if it is held; only the fastest parts are tried."""
    size = part_sizes(program, motion, per_radius=False)
    chosen = np.asarray(held, dtype=np.int64)
    moving = chosen[size[chosen] > MOVES * size.max()]
    best: tuple[float, int] | None = None
    for k in moving[np.argsort(-power[moving], kind="stable")][:HELD]:
        gain = _gain_of_holding(program, int(k), limit, along, of)
        if best is None or gain > best[0]:
            best = gain, int(k)
    if best is None or best[0] <= NO_GAIN:
        return None
    name, more = program.names[best[1]], _words(of, best[0])
    fix = f"fix {name!r} so that it cannot move at all"
    words = f"{fix}: this adds {more}"
    if np.isinf(best[0]):
        words = f"{fix}: then it withstands every load factor"
    elif of == "tilt" and best[0] >= 90.0 - np.degrees(np.arctan(limit.value)) - NO_GAIN:
        words = f"{fix}: then no tilt up to a right angle moves another part"
    return Help(of, "hold", (name,), best[0], words)


def _gain_of_holding(program: Program, part: int, limit: Limit, along: Array, of: str) -> float:
    """Increase of a limit if a part is held; 0 if it cannot be computed."""
    free = program.free.copy()
    free[part] = False
    held = program.with_rows(free=free)
    if of == "tilt":
        tilt = find_tilt_margin(held) if free.any() else None
        if isinstance(tilt, NoLimit):  # also where the numbers fail: no gain is known
            return 0.0
        after = np.pi / 2 if tilt is None else tilt.angle
        return float(np.degrees(after - np.arctan(limit.value)))
    if not free.any():
        return np.inf
    again = find_limit(held, along * free[:, None])
    return 0.0 if isinstance(again, NoLimit) else again.value - limit.value


def _friction(
    program: Program,
    limit: Limit,
    motion: Array,
    scale: float,
    of: Literal["tilt", "load factor"],
) -> Help | None:
    """The pair of parts between which additional friction raises the limit most."""
    rows = np.flatnonzero(program.kind == CONTACT)
    slip = np.linalg.norm(program.slips(motion, rows), axis=1)
    gain = limit.forces.forces[rows] * slip * scale
    pairs = np.column_stack([program.part_a[rows], program.part_b[rows]])
    each, number = np.unique(pairs, axis=0, return_inverse=True)
    total = np.bincount(number.ravel(), gain, minlength=len(each))
    if not len(total) or total.max() <= NO_GAIN:
        return None
    k = int(total.argmax())
    a, b = (program.names[p] for p in each[k])
    more = _words(of, MORE_FRICTION * float(total[k]))
    words = f"increase mu between {a!r} and {b!r} by {MORE_FRICTION:g}: it adds about {more}"
    return Help(of, "friction", (a, b), float(total[k]), words)


def _mass(program: Program, gain: Array, of: Literal["tilt", "load factor"]) -> Help | None:
    """The part whose mass changes the limit most."""
    k = int(np.abs(gain).argmax())
    if abs(gain[k]) <= NO_GAIN:
        return None
    name, share = program.names[k], f"{100 * MORE_MASS:g} %"
    less = "heavier" if gain[k] > 0 else "lighter"
    more = _words(of, MORE_MASS * abs(float(gain[k])))
    words = f"make {name!r} {share} {less}: it adds about {more}"
    return Help(of, "mass", (name,), float(gain[k]), words)
