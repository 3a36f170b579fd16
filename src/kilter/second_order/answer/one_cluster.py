"""What second order says of one cluster: of its gaps, and of what is left when idle contacts go.

1  contacts that carry nothing, or have no form, are left out where it stays without them
2  what stops keep from where it would fall (`stopped`)
3  minimum, path down or neither, across what is free (`decide`)
4  what slides on faces, all else locked (`locked`)

A path counts where the parts have an exact configuration on it that is apart and lower, which needs
no theory; where contacts are given, with their features, or surfaces were recognised in meshes, the
path itself is all there is to know (`recognised`).
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.answer.oscillation import growth_rate
from kilter.second_order.answer.second_order_answer import SecondOrder, answer_of, open_answer
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.recognised import formed_for_all
from kilter.second_order.gaps.stationary import Stationary, problem_of
from kilter.second_order.gaps.touched_surfaces import Touched, planes_of, touched_surfaces
from kilter.second_order.motions.free_motions import FreeMotions, find_free_motions
from kilter.second_order.motions.free_span import free_span, moving_free
from kilter.second_order.motions.sharp_points import SharpPoints, opens_points, sharp_points
from kilter.second_order.parts.bearing import level_axes
from kilter.second_order.proofs.configuration import find_configuration
from kilter.second_order.proofs.locked import faces_of, shifts
from kilter.second_order.proofs.minimum_proof import MinimumProof
from kilter.second_order.proofs.paths import Path
from kilter.second_order.proofs.stopped import level_contacts, level_motions, stop_forms
from kilter.second_order.searches.critical import Critical, find_critical
from kilter.second_order.searches.decide import Decision, decide
from kilter.second_order.searches.every_surface import decided_for_all
from kilter.second_order.searches.level_rest_search import find_parting
from kilter.second_order.searches.locking_stress import find_locked
from kilter.second_order.searches.opening_contacts import enough_to_open, opening_motion
from kilter.second_order.searches.parted_path import parted_paths
from kilter.second_order.searches.stopping_weights import find_stopped
from kilter.second_order.second_order_tolerances import ACROSS, KEEPS
from kilter.work import Work

__all__ = ["answer_alone"]


def answer_alone(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    features: Features,
    *,
    critical: Critical | None = None,
    whole: Program | None = None,
    work: Work | None = None,
    if_it_stays: bool = False,
) -> SecondOrder:
    """What second order says of a place of equilibrium.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
        Found in it.
    program : Program
        Of these contacts, without friction; forces of equilibrium are known to exist.
    features : Features
        Of its rows.
    critical : Critical, optional
        Of the rows that are certain, where it is known already.
    whole : Program, optional
        Also with the points that have no one normal, which what falls has to open.
    if_it_stays : bool
        Whether it is only asked if it does: no place is sought to which it falls.
    """
    if (program.kind != CONTACT).any():
        return _beside_points(assembly, contacts, program, features, critical, work)
    if critical is not None and len(critical.sides):
        kept = critical.carries
        own = Critical(critical.forces[kept], kept[kept], critical.basis, critical.sides[:0])
        found = _without(assembly, contacts, program, features, kept, own, work)
        if found is not None:
            return found
    known, doubted = formed_for_all(program, features), features.doubted
    if not known.any():
        return open_answer(_unknown(program, known), program)
    if not known.all():
        found = _without(assembly, contacts, program, features, known, None, work)
        return found or open_answer(_unknown(program, known), program)
    problem = problem_of(program, features)
    touched = touched_surfaces(program, features, contacts)
    problem = replace(problem, on_plane=planes_of(touched))
    free = find_free_motions(program, features, touched)
    critical = critical or find_critical(problem)
    if critical is not None and len(critical.sides) and not doubted:
        stopped = _stopped(program, features, touched, problem, free.symmetries)
        if stopped is not None:
            return stopped
    span = free_span(program, problem, free)
    decision = decide(problem, span, critical=critical, work=work)
    if decision.free < decision.neutral and len(free.symmetries.kinds) < len(free.kinds):
        free = free.symmetries
        decision = decide(problem, free_span(program, problem, free), critical=critical, work=work)
        if decision.state == "open" and span.shape[1] > decision.free:
            more = span.shape[1] - decision.free
            decision = replace(
                decision, free=span.shape[1], undecided=max(decision.undecided - more, 0)
            )
    if doubted:
        problem, decision = decided_for_all(program, features, problem, decision)
    if decision.state == "minimum":
        found = answer_of(program, problem, decision)
        moving = moving_free(assembly, free)
        if not len(moving):
            return found
        motion = free.motions[int(np.argmax([_moves(one, moving) for one in free.motions]))]
        size = float(np.linalg.norm(motion.reshape(-1, 3), axis=1).max())
        return replace(found, state="free", rate=None, motion=motion / size, moving=moving)
    if decision.state == "balanced" and if_it_stays:
        return open_answer("it falls", program)
    if decision.state == "balanced":
        return _falling(
            assembly, contacts, program, whole or program, problem, decision, doubted=doubted
        )
    if decision.state == "open" and not doubted:
        sliding = _sliding(program, contacts, problem, critical, work)
        if sliding is not None:
            return sliding
    return answer_of(program, problem, decision)


def _beside_points(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    features: Features,
    critical: Critical | None,
    work: Work | None,
) -> SecondOrder:
    """Of a cluster with points that have no one normal: they only take motions away."""
    rows = np.flatnonzero(program.kind == CONTACT)
    part, own = program.taking(rows), features.take(rows)
    found = answer_alone(
        assembly, contacts, part, own, critical=critical, whole=program, work=work
    )  # fmt: skip
    if found.state in ("balanced", "open"):
        return found
    return _opening_idle(assembly, contacts, program, rows, found) or open_answer(
        _sharp(program), program
    )


def _without(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    features: Features,
    kept: Mask,
    critical: Critical | None,
    work: Work | None,
) -> SecondOrder | None:
    """Of some of the contacts alone: less keeps it, and if it stays then, it stays.

    None where it does not stay, or nothing is known to be free.
    """
    part, rows = program.taking(kept), np.flatnonzero(kept)
    own = features.take(rows)
    found = answer_alone(
        assembly, contacts, part, own, critical=critical, work=work, if_it_stays=True
    )  # fmt: skip
    return _opening_idle(assembly, contacts, program, rows, found)


def _opening_idle(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    rows: Index,
    found: SecondOrder,
) -> SecondOrder | None:
    """The answer of some rows as one of all: what is free opens the others too.

    Or shifts both parts alike. None where it does not stay, or nothing is known to be free.
    """
    if found.state not in ("minimum", "free"):
        return None
    idle = np.ones(len(program.kind), dtype=bool)
    idle[np.delete(rows, found.idle)] = False
    found = replace(found, idle=np.flatnonzero(idle))
    if found.state != "free":
        return found
    assert found.decision is not None
    assert found.problem is not None
    assert found.problem.scale is not None
    proof = found.decision.proof
    if not isinstance(proof, MinimumProof):
        return None
    free = proof.free * found.problem.scale[:, None] / found.problem.length
    opening = _away(program, idle, free, sharp_points(program, contacts))
    if opening is None:
        return None
    motion = program.full(free @ opening)
    moving = moving_free(assembly, FreeMotions(motion[None], ("level",)))
    size = float(np.linalg.norm(motion.reshape(-1, 3), axis=1).max())
    if not len(moving):
        return None
    decision = replace(found.decision, opening=proof.free @ opening)
    return replace(found, motion=motion / size, moving=moving, decision=decision)


def _away(program: Program, idle: Mask, free: Array, points: SharpPoints) -> Array | None:
    """Of free motions (n, f) one that opens all idle contacts, shape (f,); None where none does.

    Or that shifts all parts alike, and opens those with what is held.
    """
    parting = find_parting(program, ~idle, points)
    if parting is not None:
        columns = parting[np.ix_(program.free, program.freedoms)].reshape(-1)
        within, *_ = np.linalg.lstsq(free, columns, rcond=None)
        if np.abs(free @ within - columns).max(initial=0.0) < KEEPS:
            return np.asarray(within)
    rows = program.jacobian() @ free
    for chosen in enough_to_open(points, idle):
        opening = opening_motion(rows[chosen])
        if opening is not None:
            return opening
    count = int(program.free.sum())
    shifts = np.zeros((3, 6))
    shifts[: len(level_axes(program)), :3] = level_axes(program)
    alike = np.tile(shifts[:, program.freedoms], count).T
    inside, *_ = np.linalg.lstsq(free, alike, rcond=None)
    inside = inside[:, np.abs(free @ inside - alike).max(axis=0) < ACROSS]
    held = np.append(~program.free, True)
    outer = idle & (held[program.part_a] | held[program.part_b])
    found = opening_motion(program.taking(outer).jacobian() @ free @ inside)
    return None if found is None else inside @ found


def _sliding(
    program: Program,
    contacts: ContactSet,
    problem: Stationary,
    critical: Critical | None,
    work: Work | None,
) -> SecondOrder | None:
    """That parts slide on faces, all else locked; None where that was not proved."""
    critical = critical or find_critical(problem)
    if critical is None or program.planar:
        return None
    faces = faces_of(program, contacts, problem)
    proof = find_locked(problem, faces, critical, work=work or Work())
    if proof is None:
        return None
    free, across = shifts(problem)
    count, blocked = free.shape[1], across.shape[1]
    decision = Decision("minimum", count + blocked, count, blocked, 0, proof)
    own = free @ (free.T @ np.ones(len(free)))
    own = own if np.abs(own).max() > ACROSS else free[:, 0]
    return _sliding_by(program, problem, decision, own)


def _stopped(
    program: Program,
    features: Features,
    touched: tuple[Touched, Touched],
    problem: Stationary,
    symmetries: FreeMotions,
) -> SecondOrder | None:
    """That parts slide level, away from stops too; None where that was not proved."""
    level, motions = level_contacts(program, features, touched), level_motions(program)
    span = free_span(program, problem, symmetries)
    proof = find_stopped(problem, level, motions, span)
    if proof is None:
        return None
    forms = stop_forms(problem, level, motions, span, proof.forces)
    blocked = forms.tilts.shape[1]
    decision = Decision("minimum", forms.neutral, forms.neutral - blocked, blocked, 0, proof)
    return _sliding_by(program, problem, decision, proof.opening)


def _sliding_by(
    program: Program, problem: Stationary, decision: Decision, motion: Array
) -> SecondOrder:
    """That parts slide as a motion, shape (n,), says."""
    assert problem.scale is not None
    moved = program.full(motion * problem.scale)
    sizes = np.linalg.norm(moved[:, :3], axis=1)
    return replace(
        answer_of(program, problem, decision),
        state="free",
        motion=moved / sizes.max(),
        moving=np.flatnonzero(sizes > ACROSS * sizes.max()),
    )


def _moves(motion: Array, parts: Index) -> float:
    return float(np.abs(motion[parts, :3]).sum())


def _unknown(program: Program, known: Mask) -> str:
    return f"how the surfaces of {_first(program, ~known)} curve where they touch is not known"


def _sharp(program: Program) -> str:
    pair = _first(program, program.kind != CONTACT)
    return f"edges or corners of {pair} meet, which have no one normal"


def _first(program: Program, rows: Mask) -> str:
    """The parts of the first of some rows."""
    k = int(np.flatnonzero(rows)[0])
    names = (*program.names, "the ground")
    return f"{names[program.part_a[k]]} and {names[program.part_b[k]]}"


def _falling(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    whole: Program,
    problem: Stationary,
    decision: Decision,
    *,
    doubted: bool,
) -> SecondOrder:
    """A balanced place with its configuration; open where none was found.

    `whole`: the program also with points that have no one normal, which the path has to open.
    """
    path, why = decision.proof, ""
    assert isinstance(path, Path)
    assert problem.scale is not None
    scale, configuration = problem.scale, None

    def parts(one: Path) -> bool:
        return whole is program or opens_points(whole, contacts, program.full(one.first * scale))

    by_path = doubted or bool((contacts.patch_kind[program.source] == "given").all())
    if by_path:
        why = "" if path.one_form else "a corner on edges of both parts slips"
        why = why if parts(path) else _sharp(whole)
    else:
        own = (path, *decision.others)
        for one in itertools.chain(own, parted_paths(whole, contacts, problem, own)):
            if not parts(one):
                continue
            configuration, wrong = find_configuration(assembly, contacts, program, problem, one)
            if configuration is not None:
                path = one
                break
            why = why or wrong
        why = "" if configuration is not None else why or _sharp(whole)
    if why:
        return replace(answer_of(program, problem, decision), state="open", why=why)
    found = answer_of(program, problem, replace(decision, proof=path))
    motion = program.full(path.first * scale)
    sizes = np.maximum(
        np.linalg.norm(motion[:, :3], axis=1),
        np.linalg.norm(motion[:, 3:], axis=1) * program.radius,
    )
    moving = np.flatnonzero(sizes > 1e-6 * sizes.max(initial=TINY))
    return replace(
        found,
        rate=growth_rate(program, problem, path),
        motion=motion / sizes.max(),
        moving=moving,
        configuration=configuration,
    )
