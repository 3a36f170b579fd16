"""How parts start to move just beyond a limit of transport.

The mechanism of a limit is a proof: with friction it opens sliding contacts, as no real part does.
So its direction is not shown. A little beyond the limit the load has a motion that obeys Coulomb's
law (`kilter.friction.motion_search`), which the words describe. If none is found, or if straps or
bonds give way, which the law does not model, the words name only the kind of motion.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.decision.motion import find_motion_with_friction, round_mantle
from kilter.analysis.load_limit import Limit, starting, with_more
from kilter.analysis.transport.carrier import CarrierMotion, carrier_wrench
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.program import Program
from kilter.tell.record import Record
from kilter.tell.words import motion_words
from kilter.units import metres_per_unit

__all__ = ["FirstMotion", "first_motions", "kind_of_motion"]

BEYOND = 1e-3
"""Excess of the load over the limit at which the motion is computed [-]."""
MOST_POINTS = 150
"""Number of contact points above which the motion is not computed; it would take seconds."""
EFFORT = 0.2
"""Effort of the search for the motion at a limit: an answer has up to eight."""


class FirstMotion(Record):
    """How a part starts to move, in words."""

    part: str
    """Name of the part."""
    words: str
    """The motion, such as "slides +x"."""


def first_motions(assembly: Assembly, limit: Limit, carried: CarrierMotion) -> list[FirstMotion]:
    """How the parts start to move beyond a limit of a carrier motion, the fastest first."""
    program = limit.program
    if limit.motion is None:
        return []
    found = _by_the_law(program, limit, carried)
    dilates = found is None and bool(program.mu.any())
    motion = limit.motion.motion if found is None else found
    names = set(starting(program, limit.motion))
    size = part_sizes(program, motion, per_radius=False)
    if found is not None:
        names = {name for k, name in enumerate(program.names) if size[k] > 0}
    order = [k for k in np.argsort(-size, kind="stable") if program.names[k] in names]
    metres = metres_per_unit(program.units)
    words = []
    for k in order:
        turn = float(np.linalg.norm(motion[k, 3:])) * program.radius[k]
        relative = np.array([np.linalg.norm(motion[k, :3]), turn])
        twist = np.concatenate([motion[k, :3] * metres, motion[k, 3:]])
        phrase = motion_words(
            twist,
            relative,
            program.down,
            center=program.center[k],
            unit=metres,
            sizes=False,
            mantle=round_mantle(assembly.parts[k]),
        )
        phrase = kind_of_motion(phrase) if dilates else phrase
        words.append(FirstMotion(part=program.names[k], words=phrase))
    return words


def kind_of_motion(words: str) -> str:
    """Name of a motion, such as "slides" or "tips", without its direction."""
    return words.split(maxsplit=1)[0]


def _by_the_law(program: Program, limit: Limit, carried: CarrierMotion) -> Array | None:
    """Motion that obeys the law of friction just beyond a limit, shape (N, 6), or None.

    Translations [length unit] and rotations [rad] of any common size; 0 for parts at rest.
    """
    modelled = not (len(program.bounded) or program.cohesion.any() or program.tied.any())
    few = 0 < len(program.part_a) <= MOST_POINTS
    if not (modelled and few and program.mu.any() and np.isfinite(limit.value)):
        return None
    share = limit.value + BEYOND * max(abs(limit.value), BEYOND)
    beyond = with_more(program, carrier_wrench(program, carried), share)
    found = find_motion_with_friction(beyond, EFFORT)
    if found is None or not found.moves.any():
        return None
    return found.screws(metres_per_unit(program.units))
