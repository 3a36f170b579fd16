"""The well of potential energy of a body on a horizontal table: width, depth, stiffness.

    width       the tilt below which it comes back, and the energy that it costs to tip it
                (`kilter.analysis.regions.tipping`)
    stiffness   if it stands on a round place: the moment by which it rights itself, over the
                angle. With forces f_k, gaps phi_k and level turns t that open no gap,

                    K = - sum of f_k phi_k''(t, t),

                which is weight x (radius of the ground that it covers - height of c). On a face
                or an edge it is V-shaped instead: the moment is there at once.
    period      of the slowest swing without friction: c moves straight up and down, so that
                K t = s^2 I t, I the inertia about c with the spin about the vertical left free.

The table is taken as endless, and the body as free of friction: it slides at no cost.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.analysis.analysis_tolerances import NO_GAIN, NO_PROJECTION, NO_RISE, SAME_RAY
from kilter.analysis.check import check
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.tipping import find_tipping
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, across, cross
from kilter.assembly import Assembly
from kilter.assembly.changed_copies import lowest_heights
from kilter.contact import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.gaps.features import FACE, Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import gap_forms
from kilter.second_order.parts.cluster_states import State
from kilter.tell.record import Record, Vector
from kilter.units import metres_per_unit


class Well(Record, kw_only=False):
    """Width, depth and stiffness of the energy minimum of a body on a level table.

    The table is endless, without friction.
    """

    part: str
    """The body."""
    over_deg: float | None
    """Tilt from which it comes back, about any level axis [deg]; 180: from anywhere. None if it is
    not known: for bodies with curved faces that are not of revolution about the vertical through
    their centre of mass."""
    barrier: float | None
    """Least energy that can take it to another place of rest [J]; None if there is no such place,
    or if it is not known."""
    stiffness: float | None
    """Least moment by which it rights itself, over the angle [N m/rad]; None if it stands on a
    face, whose edges right it at once."""
    axis: Vector | None
    """Level axis of that turn, unit, in the frame of the assembly."""
    period: float | None
    """Period of its slowest swing [s]."""


def find_well(assembly: Assembly, contacts: ContactSet, verdict: Verdict) -> Well | None:
    """Find the well of energy of a body on a horizontal table; None if the body has none.

    Returns None for several bodies, for contacts besides a level table, and if the body stands in
    no well: it rolls, or only balances.
    """
    program = verdict.program
    forces = verdict.judgement.forces
    if program.planar or int(program.free.sum()) != 1 or forces is None:
        return None
    part = int(np.flatnonzero(program.free)[0])
    features = features_of(program, contacts)
    if not _on_table(assembly, program, features, part):
        return None
    metres, weight = metres_per_unit(assembly.units), float(program.weight[part])
    tipping = find_tipping(assembly.geometry, part, program.down)
    turns, stiffness = _stiffness(program, features, forces.forces, part)
    least = (
        np.inf if stiffness is None else float(np.linalg.eigvalsh(stiffness).min(initial=np.inf))
    )
    if least <= NO_RISE * weight * float(program.radius[part]):
        return None
    if tipping is None and (stiffness is None or not len(stiffness)):
        return None
    over = rise = None
    if tipping is not None:
        over, rise = float(np.degrees(tipping.angle)), tipping.rise
    name = program.names[part]
    barrier = None if rise is None else weight * rise * metres
    if stiffness is None or not len(stiffness):
        return Well(name, over, barrier, None, None, None)
    values, ways = np.linalg.eigh(stiffness)
    period = _period(program, part, turns, stiffness) * float(np.sqrt(metres))
    return Well(name, over, barrier, float(values[0]) * metres, turns @ ways[:, 0], period)


def _on_table(assembly: Assembly, program: Program, features: Features, part: int) -> bool:
    """Whether all contacts of the body are horizontal, flat, equally high, and below it."""
    if (program.kind != CONTACT).any() or program.two_sided.any() or program.applied.any():
        return False
    down = program.down
    mine = program.part_b == part
    normal = np.where(mine[:, None], program.normal, -program.normal)
    height = program.point @ -down
    near = NO_PROJECTION * float(assembly.geometry.size[part])
    lowest = float(lowest_heights(assembly.geometry, -down)[part])
    flat = np.where(mine, features.kind_a, features.kind_b) == FACE
    bent = np.where(mine[:, None, None], features.curvature_a, features.curvature_b)
    level = np.linalg.norm(normal + down, axis=1) <= NO_PROJECTION
    alike = np.abs(height - lowest) <= near
    known = ~features.open
    return bool(len(height)) and bool((level & alike & flat & known).all()) and not bent.any()


def _stiffness(
    program: Program, features: Features, forces: Array, part: int
) -> tuple[Array, Array | None]:
    """Rotations about horizontal axes that open no gap, (3, d), and their energy stiffness, (d, d).

    In N x length unit/rad; None if a gap has no second derivative.
    """
    arm = program.point - program.center[part]
    level = np.stack(across(program.down), axis=1)
    opens = cross(arm, program.normal) @ level
    near = SAME_RAY * float(program.radius[part])
    _, sizes, ways = np.linalg.svd(opens, full_matrices=True)
    sizes = np.append(sizes, np.zeros(2 - len(sizes)))
    turns = level @ ways[sizes <= near * np.sqrt(len(opens))].T
    if not turns.shape[1]:
        return turns, np.zeros((0, 0))
    forms = gap_forms(program, features)
    mine = (program.part_b == part)[:, None, None]
    blocks = np.where(mine, forms[:, 9:, 9:], forms[:, 3:6, 3:6])
    if np.isnan(blocks).any():
        return turns, None
    bent = -np.tensordot(forces, blocks, axes=1)
    return turns, turns.T @ (bent + bent.T) @ turns / 2


def _period(program: Program, part: int, turns: Array, stiffness: Array) -> float:
    """Period of the slowest swing [s / sqrt(metres per length unit)]."""
    inertia, spin = program.inertia[part], program.down
    along = turns.T @ inertia @ spin
    moved = turns.T @ inertia @ turns - np.outer(along, along) / (spin @ inertia @ spin)
    lower = np.linalg.inv(np.linalg.cholesky(moved))
    least = float(np.linalg.eigvalsh(lower @ stiffness @ lower.T).min())
    return float(2 * np.pi / np.sqrt(least))


# Places of rest of an assembly in its stable region: largest tilt, and period of a small swing.


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
    """The least angular frequency of small oscillations that is proved, at a minimum that curves;
    the rate of growth, if it is balanced [1/s]."""
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
