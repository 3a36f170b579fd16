"""Changes of an assembly that raise a margin most: holding a part, more friction, other masses.

At a limit t, with the forces f and the mechanism m there (b + t d is the load, power 0):

    the mass of part i         t' = -(w_i + t d_i).m_i / (d.m)          per share of it
    friction at a contact      t' = sum of f_n |u_t| over its points / (d.m)      per unit of mu

u_t is the velocity at which the mechanism slides there. These are the derivatives only if the
mechanism is unique, which it is not in a symmetric assembly. So they select the change that is
tried, and the gain is that of a second margin, computed for the changed assembly. Holding a part
ends every mechanism in which it moves: the parts that drive it most are held in turn.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.analysis.analysis_tolerances import (
    MOVES,
    NO_GAIN,
)
from kilter.analysis.load_limit import (
    Limit,
    NoLimit,
    beyond_at,
    find_limit,
    gravity_wrench,
    motion_share,
)
from kilter.analysis.margins.tilt import TiltMargin, find_tilt_margin
from kilter.arrays import Array
from kilter.contact.round_edges import RoundEdge
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.tell.record import OrNull, Record

HELD = 4
"""Largest number of parts for which the effect of holding the part is computed."""
MORE_FRICTION = 0.1
"""Relative increase of a friction coefficient that is tried [-]."""
MORE_MASS = 0.1
"""Relative change of a mass that is tried [-]."""
What = Literal["hold", "friction", "mass"]


class Help(Record):
    """A part to hold or another change that widens a margin, and the gain."""

    of: Literal["tilt", "load factor"]
    """The margin that widens."""
    what: What
    """Kind of the change."""
    parts: tuple[str, ...]
    """The part, or the two parts of the contact."""
    by: float | None
    """Increase of mu, or of the mass as a share of it [-]; None: a part is held."""
    gain: OrNull
    """Gain of a second margin, computed with this change: [deg] of tilt, which ends at a right
    angle, or of the load factor [-], infinite if no factor is then too large."""
    sentence: str
    """The change in words."""


def what_helps(
    program: Program,
    tilt: TiltMargin | None,
    factor: Limit | None,
    push: Array | None,
    *,
    held: Sequence[int],
    edges: Sequence[RoundEdge] = (),
    others: float = np.inf,
) -> tuple[Help, ...]:
    """The most effective change of each kind, which raises the tilt margin or else the load factor.

    Arguments: `program`: that of all parts; `push` (3,): the direction of the load factor; None:
    of given loads; `held`: free parts, by position, of which those that drive the mechanism most
    are held in turn; `others`: the limit of the other groups, [rad] or [-], which no change of
    the group with the least limit raises.

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
        group = tilt.shared.program
        aside = tilt.down / float(tilt.down @ group.down) - group.down
        size = float(np.linalg.norm(aside))
        if size < NO_GAIN:
            return ()
        along = gravity_wrench(group, aside / size)
        limit = find_limit(group, along, shared=tilt.shared)
        if isinstance(limit, NoLimit):
            return ()
        before = float(np.degrees(tilt.angle))
        most = float(np.degrees(others))
        gain = _Gain("tilt", before, lambda changed: _tilt(changed, edges), most)
        return _helps(group, limit, along, True, gain, held)
    if factor is None:
        return ()
    group = factor.program
    if push is not None:
        gain = _Gain(
            "load factor", factor.value, lambda p: _factor(p, gravity_wrench(p, push)), others
        )
        return _helps(group, factor, gravity_wrench(group, push), True, gain, held)
    load = np.where(group.free[:, None], program.applied, 0.0)
    gain = _Gain("load factor", factor.value, lambda p: _factor(p, load * p.free[:, None]), others)
    return _helps(group, factor, load, False, gain, held)


@dataclass(frozen=True, slots=True)
class _Gain:
    """A margin: its name, its value, and the function that computes it for a changed program."""

    of: Literal["tilt", "load factor"]
    before: float
    margin: Callable[[Program], float]
    others: float
    """The margin of parts that no change concerns."""

    def by(self, changed: Program) -> float:
        """Gain of a change; 0 if it cannot be computed."""
        if self.others <= self.before:
            return 0.0
        gain = min(self.margin(changed), self.others) - self.before
        return 0.0 if np.isnan(gain) else gain

    def value_of(self, share: float) -> float:
        """The margin at a share of the load; infinite shares are allowed."""
        return float(np.degrees(np.arctan(share))) if self.of == "tilt" else share

    def help(
        self, what: What, parts: tuple[str, ...], by: float | None, gain: float, sentence: str
    ) -> Help:
        """A change with its gain."""
        return Help(of=self.of, what=what, parts=parts, by=by, gain=gain, sentence=sentence)

    def words(self, gain: float) -> str:
        """The gain with its unit."""
        tilt = self.of == "tilt"
        return f"{gain:.3g} deg of tilt" if tilt else f"{gain:.3g} to the load factor"


def _tilt(program: Program, edges: Sequence[RoundEdge]) -> float:
    """Least tilt [deg] after which a part moves; NaN if it is not known."""
    tilt = find_tilt_margin(program, edges) if program.free.any() else None
    if isinstance(tilt, NoLimit):
        return np.nan
    return 90.0 if tilt is None else float(np.degrees(tilt.angle))


def _factor(program: Program, load: Array) -> float:
    """Greatest factor of a load; NaN if it is not known."""
    if not program.free.any():
        return np.inf
    limit = find_limit(program, load)
    return np.nan if isinstance(limit, NoLimit) else limit.value


def _helps(
    program: Program, limit: Limit, along: Array, by_mass: bool, gain: _Gain, held: Sequence[int]
) -> tuple[Help, ...]:
    """The most effective change of each kind that raises a given limit.

    The load `along` grows with the masses if `by_mass`.
    """
    if limit.motion is None or not np.isfinite(limit.value):
        return ()
    motion = limit.motion.motion
    if float((along * motion).sum()) <= 0 or _ends_apart(program, along, motion, gain):
        return ()
    weight = program.load - program.applied + (limit.value * along if by_mass else 0.0)
    power = np.where(program.free, (weight * motion).sum(axis=1), 0.0)
    changes = [
        _hold(program, motion, power, gain, held),
        _friction(program, limit, motion, gain),
        _mass(program, power, gain),
    ]
    return tuple(change for change in changes if change is not None)


def _ends_apart(program: Program, along: Array, motion: Array, gain: _Gain) -> bool:
    """Whether the mechanism of several clusters alone ends the margin: then no change helps.

    A change concerns one cluster only. The motion of each other cluster proves its own limit.
    """
    label = program.clusters
    numbers = np.unique(label[program.free & motion.any(axis=1)])
    ended = 0
    for number in numbers.tolist() if len(numbers) > 1 else ():
        alone = np.where((label == number)[:, None], motion, 0.0)
        share = motion_share(program, along, alone)
        beyond = beyond_at(program, along, share, alone).beyond
        ended += gain.value_of(beyond) <= gain.before + NO_GAIN
    return ended > 1


def _hold(
    program: Program, motion: Array, power: Array, gain: _Gain, held: Sequence[int]
) -> Help | None:
    """The part that raises the limit most if it is held; only the fastest parts are tried."""
    size = part_sizes(program, motion, per_radius=False)
    chosen = np.asarray(held, dtype=np.int64)
    chosen = chosen[program.free[chosen]]
    moving = chosen[size[chosen] > MOVES * size.max()]
    best: tuple[float, int] | None = None
    for k in moving[np.argsort(-power[moving], kind="stable")][:HELD]:
        free = program.free.copy()
        free[k] = False
        more = gain.by(program.with_rows(free=free))
        if best is None or more > best[0]:
            best = more, int(k)
    if best is None or best[0] <= NO_GAIN:
        return None
    name = program.names[best[1]]
    fix = f"fix {name!r} so that it cannot move at all"
    words = f"{fix}: this adds {gain.words(best[0])}"
    if np.isinf(best[0]):
        words = f"{fix}: then it withstands every load factor"
    elif gain.of == "tilt" and gain.before + best[0] >= 90.0 - NO_GAIN:
        words = f"{fix}: then no tilt up to a right angle moves another part"
    return gain.help("hold", (name,), None, best[0], words)


def _friction(program: Program, limit: Limit, motion: Array, gain: _Gain) -> Help | None:
    """More friction between the pair of parts at which the mechanism loses most power."""
    rows = np.flatnonzero(program.kind == CONTACT)
    slip = np.linalg.norm(program.slips(motion, rows), axis=1)
    lost = limit.forces.forces[rows] * slip
    pairs = np.column_stack([program.part_a[rows], program.part_b[rows]])
    each, number = np.unique(pairs, axis=0, return_inverse=True)
    total = np.bincount(number.ravel(), lost, minlength=len(each))
    if not len(total) or total.max() <= NO_GAIN:
        return None
    pair = each[int(total.argmax())]
    rougher = np.zeros(len(program.mu))
    rougher[rows[(pairs == pair).all(axis=1)]] = MORE_FRICTION
    more = gain.by(program.with_rows(mu=program.mu + rougher))
    if more <= NO_GAIN:
        return None
    a, b = (program.names[p] for p in pair)
    words = f"increase mu between {a!r} and {b!r} by {MORE_FRICTION:g}: this adds"
    if np.isinf(more):
        words = f"{words.removesuffix(': this adds')}: then it withstands every load factor"
    else:
        words = f"{words} {gain.words(more)}"
    return gain.help("friction", (a, b), MORE_FRICTION, more, words)


def _mass(program: Program, power: Array, gain: _Gain) -> Help | None:
    """Another mass of the part whose weight has the largest power in the mechanism."""
    k = int(np.abs(power).argmax())
    if abs(power[k]) <= NO_GAIN:
        return None
    share = -MORE_MASS if power[k] > 0 else MORE_MASS
    mass = program.mass.copy()
    mass[k] *= 1 + share
    more = gain.by(program.with_rows(mass=mass))
    if more <= NO_GAIN:
        return None
    less = "heavier" if share > 0 else "lighter"
    words = f"make {program.names[k]!r} {100 * MORE_MASS:g} % {less}: this adds {gain.words(more)}"
    return gain.help("mass", (program.names[k],), share, more, words)
