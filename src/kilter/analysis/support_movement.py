"""Small movements of supports: motions of the parts, contacts that open, and released energy.

The held parts get small movements. With the opening speeds h that these alone give the contacts,
and motions p of the free parts, to first order

    max w.p  over  J p + h in the dual cones: u_n >= mu |u_t|
    = min h.f  over  f in Coulomb's cones,  J^T f + w = 0

The motion releases as much energy as the forces of the assembly do least work on the supports: a
range of forces (`kilter.analysis.force_ranges`), whose multipliers are such a motion. Of several
motions, that with the least openings is chosen. If no contact slides that carries a force, the
motion obeys Coulomb's law, and forces and motion are exact. Otherwise the work of the forces lies
between its least and its greatest value, and the motion is one of a flow that opens as it slides.

References
----------
J. Heyman, *The Stone Skeleton*, International Journal of Solids and Structures 2, 1966: an arch on
spreading abutments cracks at hinges and has its least thrust.
A. Iannuzzo et al., the PRD method, Computers and Structures 2020: least energy for given
settlements.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.sparse import csc_array, eye_array, vstack

from kilter.analysis.analysis_tolerances import OPENS_BY_MOVING, RANGE_AGREES
from kilter.analysis.force_ranges import EndSearch, ForceEnd, added
from kilter.arrays import TINY, Array, Mask
from kilter.errors import InputError
from kilter.mechanics.certificate import row_openings
from kilter.mechanics.clusters import clusters
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.solvers.problem import quadratic_program
from kilter.tell.record import InPython, PairNames, Record, Vector, key
from kilter.units import metres_per_unit

LARGEST = 0.1
"""Largest movement of a support [size of the smallest free part that moves with it]."""
ROUNDED = 1e-10
"""Shift, or turn of a part times its radius, that counts as 0 [movement of the supports]."""
SHORT = 1e-8
"""Weight of the motion beside that of the openings in the choice of the motion [-]."""

Outcome = Literal["follows", "cracks", "slides", "squeezed", "falls", "unknown"]


class MovedPart(Record):
    """A small movement of a part."""

    part: str
    """Name of the part."""
    translation: Vector
    """Movement of its centre of mass [length unit]."""
    rotation: Vector
    """Rotation vector [deg]."""


class OpenedContact(Record):
    """Two parts whose contact opens or slides."""

    parts: PairNames
    """Names of both parts."""
    opening: float
    """Largest distance between them [length unit]."""
    at: Vector
    """Point of this distance [length unit], world frame."""
    hinge: Vector | None
    """Middle of the points that stay closed [length unit]; null if none does."""
    angle: float
    """Angle by which they turn to each other [deg]."""
    slides: bool
    """Whether a point that carries a force slides."""


class SupportMovement(Record):
    """The response of an assembly to small movements of its supports, to first order."""

    outcome: str
    """One of "follows" (no contact opens or slides), "cracks", "slides", "squeezed" (no movement of
    the parts gives way without friction being overcome), "falls", "unknown"."""
    exact: bool
    """Whether forces and movement obey Coulomb's law: no contact slides that carries a force."""
    least_work: ForceEnd
    """Least work of the contact forces on the supports over all equilibria [J]; the weights release
    this energy if no contact slides."""
    greatest_work: ForceEnd
    """Greatest work of the contact forces on the supports [J]."""
    supports: tuple[MovedPart, ...]
    """Movements of the supports."""
    moves: tuple[MovedPart, ...]
    """Movements of the free parts, the largest first."""
    opened: tuple[OpenedContact, ...]
    """Contacts that open or slide, the widest first."""
    motion: InPython[Array]
    """Movements of all parts, supports included: translation [length unit] and rotation [rad],
    shape (N, 6)."""
    forces: InPython[tuple[Array, Array] | None]
    """Forces along and across the rows at the least work [N], shapes (K,) and (K, 3); 0 between
    parts that no moved support touches, also by other parts."""

    @property
    @key
    def sentence(self) -> str:
        """The outcome in words."""
        if self.outcome == "squeezed":
            return (
                "The supports squeeze the parts: no movement of the parts gives way as long as "
                "friction holds."
            )
        if self.outcome == "falls":
            return "The assembly falls, however little its supports move."
        if self.outcome == "unknown":
            return "The movement of the parts is not known."
        if self.outcome == "follows":
            return "The parts follow their supports: no contact opens, and the forces stay."
        count = len(self.opened)
        if self.outcome == "slides":
            contacts = "1 contact slides" if count == 1 else f"{count} contacts slide"
            return f"{contacts} while loaded: the work lies between the two values."
        contacts = "1 contact opens," if count == 1 else f"{count} contacts open, the widest"
        where = " and ".join(repr(name) for name in self.opened[0].parts)
        return f"The assembly cracks: {contacts} between {where}."


def support_movement(
    program: Program, twist: Array, *, known: Outcome | None = None
) -> SupportMovement:
    """Compute how the parts follow small movements of held parts.

    Arguments: `twist` (N, 6): translation [length unit] and rotation about the centre of mass
    [rad] of each held part, 0 for free parts; `known`: the outcome without any movement, if no
    contact forces are known that balance the assembly. Raises `InputError` if a movement is too
    large for a statement of first order, or contacts are bonded.
    """
    if program.cohesion.any() or program.pull.any():
        raise InputError("movements of supports are not computed for bonds", hint="leave them out")
    _refuse_large(program, twist)
    if known is not None:
        no_end = ForceEnd(value=None, bound=None, proved=False)
        return _record(program, twist, twist, None, (no_end, no_end), word=known)
    motion, ends = twist.copy(), [ForceEnd(value=0.0, bound=0.0, proved=True)] * 2
    forces, friction = np.zeros(len(program.part_a)), np.zeros((len(program.part_a), 3))
    squeezed, found = False, True
    metres = metres_per_unit(program.units)
    for cluster in clusters(program):
        inner = cluster.program
        gain = _speeds(inner, twist)
        if not gain.any():
            continue
        search, scale = EndSearch(inner), float(np.abs(gain).max())
        greatest = search.end(gain / scale, 1)
        least = search.end(gain / scale, -1)
        work = scale * metres
        ends = [added(end, more, work) for end, more in zip(ends, (least, greatest), strict=True)]
        if least.value is None:
            squeezed, found = squeezed or least.proved, found and least.proved
            continue
        of_cluster = _motion(inner, twist, search, least.value, scale)
        if of_cluster is None or search.forces is None:
            found = False
            continue
        motion[inner.free] = of_cluster[inner.free]
        forces[cluster.rows], friction[cluster.rows] = search.forces.forces, search.forces.friction
    proof = None if squeezed or not found else (forces, friction)
    word: Outcome = "squeezed" if squeezed else "unknown"
    return _record(program, twist, motion, proof, (ends[0], ends[1]), word=word)


def _refuse_large(program: Program, twist: Array) -> None:
    """Raise `InputError` if a held part moves by more than `LARGEST` of the parts on it."""
    sizes = program.radius[program.free]
    if not len(sizes):
        raise InputError("no part is free", hint="move a support of free parts")
    a, b = program.part_a, program.part_b
    for part in np.flatnonzero(twist.any(axis=1)).tolist():
        other = np.where(a == part, b, a)[(a == part) | (b == part)]
        touched = other[(other >= 0) & program.free[other]]
        size = float(program.radius[touched].min()) if len(touched) else float(sizes.min())
        rows = np.flatnonzero((a == part) | (b == part))
        arms = np.linalg.norm(program.point[rows] - program.center[part], axis=1)
        way = np.linalg.norm(twist[part, :3]) + np.linalg.norm(twist[part, 3:]) * arms.max(
            initial=0
        )
        if way > LARGEST * size:
            raise InputError(
                f"{program.names[part]!r} moves by {way:.3g}, more than a tenth of the size of a "
                f"part on it ({size:.3g})",
                hint="give a smaller movement: the answer is of first order",
            )


def _speeds(program: Program, twist: Array) -> Array:
    """Relative movement at each row by movements of parts, shape (K, 3); rotation if angular."""
    turned = np.append(twist[:, 3:], np.zeros((1, 3)), axis=0)  # the ground is the last
    turns = turned[program.part_b] - turned[program.part_a]
    at_point = program.relative(twist, np.arange(len(program.part_a)))
    return np.where(program.angular[:, None], turns, at_point)


def _motion(
    program: Program, twist: Array, search: EndSearch, least: float, unit: float
) -> Array | None:
    """The motion of the free parts that releases the energy with the least openings, (N, 6).

    It keeps all contacts of the outer pyramids closed or opens them, so it is a motion of the
    cones. Arguments: `least`: least value of the search, whose gains are movements over `unit`.
    Returns None if no solver finds it.
    """
    from kilter.solvers.clarabel import solve_quadratic

    problem, released = search.rays, least * unit
    if problem is None:
        return None
    rays, openings = problem.program, problem.openings()
    moved = rays.velocities(twist) * rays.arm
    scale = max(float(np.abs(moved).max(initial=0.0)), TINY)
    power, two_sided = problem.power(), rays.two_sided
    size = max(float(np.linalg.norm(power)), TINY)
    matrix = vstack(
        [openings[two_sided], openings[~two_sided], csc_array(power[None] / size)], format="csc"
    )
    bound = np.concatenate([-moved[two_sided], -moved[~two_sided], [released / size]]) / scale
    quadratic = csc_array(openings.T @ openings + SHORT * eye_array(openings.shape[1]))
    answer = solve_quadratic(
        quadratic_program(
            quadratic, openings.T @ (moved / scale), matrix, bound, int(two_sided.sum())
        )
    )
    # the multipliers of the simplex method have more digits, if they are the same motion
    first = -problem.over_weight(search.multipliers) * unit
    chosen = answer.x * scale if answer.found else first
    closes = -float((openings @ chosen + moved).min(initial=0.0))
    misses = abs(released - float(power @ chosen)) / size
    near = np.abs(chosen - first).max() <= OPENS_BY_MOVING * max(scale, np.abs(first).max())
    if near or max(closes, misses) > OPENS_BY_MOVING * scale:
        chosen = first
    return problem.motion(chosen)


def _record(
    program: Program, twist: Array, motion: Array, forces: tuple[Array, Array] | None,
    ends: tuple[ForceEnd, ForceEnd], *, word: Outcome,
) -> SupportMovement:  # fmt: skip
    """The answer from the motion of all parts and the forces of the least work.

    Without forces, the outcome is `word`.
    """
    supports = tuple(_moved(program, twist, k) for k in np.flatnonzero(twist.any(axis=1)).tolist())
    if forces is None:
        return SupportMovement(
            outcome=word, exact=False, least_work=ends[0],
            greatest_work=ends[1], supports=supports, moves=(), opened=(), motion=motion,
            forces=None,
        )  # fmt: skip
    scale = float(np.abs(_speeds(program, twist)).max(initial=TINY))
    # smaller movements are rounding
    sizes = np.abs(motion) * np.where(np.arange(6) < 3, 1.0, program.radius[:, None])
    motion[(sizes < ROUNDED * scale) & program.free[:, None]] = 0.0
    opened = _opened(program, motion, forces[0], OPENS_BY_MOVING * scale)
    violation = -float(row_openings(program, motion).min(initial=0.0))
    metres, weight = metres_per_unit(program.units), float(program.weight[program.free].sum())
    released = float((program.load * motion)[program.free].sum()) * metres
    agrees = abs(released - (ends[0].value or 0.0)) <= RANGE_AGREES * weight * scale * metres
    sizes = np.linalg.norm(motion[:, :3], axis=1)
    order = np.argsort(-sizes, kind="stable")
    free = [k for k in order.tolist() if program.free[k]]
    slides = any(contact.slides for contact in opened)
    outcome: Outcome = "follows" if not opened else "slides" if slides else "cracks"
    return SupportMovement(
        outcome=outcome, exact=bool(not slides and agrees and violation <= OPENS_BY_MOVING * scale),
        least_work=ends[0], greatest_work=ends[1], supports=supports,
        moves=tuple(_moved(program, motion, k) for k in free), opened=opened, motion=motion,
        forces=forces,
    )  # fmt: skip


def _moved(program: Program, motion: Array, k: int) -> MovedPart:
    """The movement of a part."""
    return MovedPart(
        part=program.names[k], translation=motion[k, :3], rotation=np.degrees(motion[k, 3:])
    )


def _opened(
    program: Program, motion: Array, forces: Array, least: float
) -> tuple[OpenedContact, ...]:
    """Contacts at which a point opens or slides by more than `least`, the widest first."""
    rows = np.flatnonzero(program.kind == CONTACT)
    open_by = program.velocities(motion)[rows]
    slip = np.linalg.norm(program.slips(motion, rows), axis=1)
    carries = forces[rows] > RANGE_AGREES * float(program.weight[program.free].sum())
    slides = carries & (slip > least) & (program.mu[rows] > 0)
    pairs = np.column_stack([program.part_a[rows], program.part_b[rows]])
    found = []
    for pair in np.unique(pairs[(open_by > least) | slides], axis=0).tolist():
        here: Mask = (pairs == pair).all(axis=1)
        k = np.flatnonzero(here)
        widest = int(k[np.argmax(open_by[k])])
        closed = k[np.abs(open_by[k]) <= least]
        a, b = pair
        turned = motion[b, 3:] - motion[a, 3:]
        found.append(
            OpenedContact(
                parts=(program.names[a], program.names[b]), opening=float(open_by[widest]),
                at=program.point[rows[widest]], angle=float(np.degrees(np.linalg.norm(turned))),
                hinge=program.point[rows[closed]].mean(axis=0) if len(closed) else None,
                slides=bool(slides[k].any()),
            )
        )  # fmt: skip
    return tuple(sorted(found, key=lambda contact: -contact.opening))
