"""Places of rest of an assembly in its stable region: largest tilt, and period of a small swing.

A place of rest is a well of energy. Its width to first order is the angle to the nearest
unstable direction: within it the walls of the well are V-shaped, as those of a box in a corner.
If any tilt is too large to first order (a ball in a bowl), curvature decides: whether the energy
curves up, and how fast the parts come back (`kilter.second_order`). A body on a level table has a
well of its own though it slides freely: its largest tilt there, and the energy at which it goes
over (`kilter.analysis.regions.well`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.well import Well, find_well
from kilter.analysis.turning_tolerances import NO_GAIN
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.rows import CONTACT
from kilter.second_order.parts.cluster_states import State
from kilter.tell.record import Record, Vector

__all__ = ["MOST_RESTS", "PlaceOfRest", "find_rests"]

MOST_RESTS = 20
"""Largest number of directions for which the state of rest is examined."""


class PlaceOfRest(Record):
    """A direction of gravity at which an assembly rests without friction, and how firmly."""

    down: Vector
    """The direction, unit, in the frame of the assembly."""
    on: tuple[str, ...] = ()
    """Held parts that bear the weight."""
    state: State
    """"minimum": a strict minimum of the energy; no small push moves it away."""
    tilt_deg: float | None
    """Angle to the nearest direction that is not stable to first order [deg]; None if all are
    stable."""
    rate: float | None = None
    """Of a minimum that curves, the least angular frequency of small oscillations that is proved;
    if it is balanced, the rate of growth [1/s]."""
    moving: tuple[str, ...] = ()
    """Parts that fall, or move freely."""
    why: str | None = None
    """Why it is open."""
    well: Well | None = None
    """Energy minimum of a single body on a level table."""

    @property
    def strict(self) -> bool:
        """Whether the energy of the assembly has a strict minimum at this place of rest."""
        return self.state == "minimum"


def find_rests(cone: Cone, assembly: Assembly, contacts: ContactSet) -> tuple[PlaceOfRest, ...]:
    """Classify how an assembly rests for gravity along the axis, lines and rays of its region.

    Returns `MOST_RESTS` at most; none of a cone without an axis, lines or rays.
    """
    return tuple(_classify_rest(down, cone, assembly, contacts) for down in _directions(cone))


def _directions(cone: Cone) -> Array:
    """The distinct directions of gravity to classify: axis, lines and rays, shape (d, 3)."""
    center = np.zeros((0, 3)) if cone.center is None else cone.center[None]
    listed = np.vstack([center, cone.lines, -cone.lines, cone.rays])
    same = np.linalg.norm(listed[:, None] - listed, axis=-1) <= cone.blur
    first = ~np.tril(same, -1).any(axis=1)
    places: Array = listed[first][:MOST_RESTS]
    return places


def _classify_rest(
    down: Array, cone: Cone, assembly: Assembly, contacts: ContactSet
) -> PlaceOfRest:
    """Classify how an assembly rests with gravity along a direction of its region."""
    known: dict[str, Any] = {"down": down, "tilt_deg": _tilt(down, cone)}
    turned = assembly.with_down(down)
    verdict = check(turned, contacts=contacts)
    if verdict.first_order != "stable":
        why = f"so near the boundary of the region its verdict is {verdict.verdict}"
        return PlaceOfRest(state="open", why=why, **known)
    second = verdict.second_order
    known |= {"well": find_well(turned, contacts, verdict), "on": _bearing(verdict)}
    if second is None:
        return PlaceOfRest(state="minimum", **known)
    moving = tuple(second.motion or ())
    return PlaceOfRest(
        state=second.state, rate=second.rate, moving=moving, why=second.why or None, **known
    )


def _bearing(verdict: Verdict) -> tuple[str, ...]:
    """Names of the held parts that carry free parts, by the contact forces of a verdict."""
    proof, program = verdict.judgement.forces, verdict.program
    if proof is None:
        return ()
    both = np.stack([program.part_a, program.part_b], axis=1)
    held = ~np.append(program.free, True)[both] & (both < len(program.names))
    presses = np.abs(proof.forces) > NO_GAIN * float(program.weight[program.free].max(initial=0.0))
    bear = np.unique(both[held & presses[:, None] & (program.kind == CONTACT)[:, None]])
    return tuple(program.names[k] for k in bear)


def _tilt(down: Array, cone: Cone) -> float | None:
    """Angle from a direction of gravity to the nearest direction outside its region [deg].

    None if every direction is inside.
    """
    if len(cone.equations):
        return 0.0
    if not len(cone.facets):
        return None
    least = float(np.clip((cone.facets @ down).min(), 0.0, 1.0))
    return float(np.degrees(np.arcsin(least)))
