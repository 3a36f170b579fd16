"""Second-order answer for a single cluster (free parts that touch each other).

1  contacts without force, or whose gap has no form, are left out: if the rest is a minimum or free,
   so is the cluster
2  parts that stops keep from sliding off and falling (`stopped`)
3  minimum, path down or neither, across the free motions (`decide`)
4  parts that slide on faces, with everything else locked (`locked`)

A path counts if it has an exact configuration in which the parts are apart and lower, which needs
no theory. For contacts that are given with their features, and for surfaces that were recognised
in meshes, the path alone is the proof (`by_path_alone`).
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask
from kilter.mechanics.program import Program
from kilter.mechanics.rows import POSSIBLE
from kilter.second_order.answer.second_order_answer import (
    SecondOrder,
    answer_of,
    growth_rate,
    open_answer,
)
from kilter.second_order.gaps.joint_forms import of_joints
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_motions import FreeMotions, free_span, moving_free
from kilter.second_order.motions.sharp_points import SharpPoints, opens_points, sharp_points
from kilter.second_order.parts.bearing import level_axes
from kilter.second_order.proofs.cluster_facts import ClusterFacts
from kilter.second_order.proofs.fall_proof import by_path_alone, find_configuration
from kilter.second_order.proofs.minimum_proof import MinimumProof, faces_of, shifts
from kilter.second_order.proofs.paths import Path
from kilter.second_order.proofs.stopped import stop_forms, stop_question
from kilter.second_order.searches.critical import Critical, find_critical
from kilter.second_order.searches.curved_energy import find_locked
from kilter.second_order.searches.decide import decide
from kilter.second_order.searches.energy_decision import EnergyDecision
from kilter.second_order.searches.level_rest_search import (
    enough_to_open,
    find_parting,
    find_stopped,
    opening_motion,
)
from kilter.second_order.searches.path_search import decided_for_all, parted_paths
from kilter.second_order.second_order_tolerances import ACROSS, KEEPS
from kilter.work import Work


def answer_alone(
    facts: ClusterFacts,
    *,
    critical: Critical | None = None,
    whole: Program | None = None,
    work: Work,
    only_if_stays: bool = False,
) -> SecondOrder:
    """Second-order answer (minimum, free, balanced or open) for a cluster in equilibrium.

    Arguments: `facts`: its contacts, without friction; forces of equilibrium are known to exist;
    `critical`: critical motions of the contacts that are certain, if they are known already;
    `whole`: the contacts with edges and corners that have no unique normal, which a fall has to
    open.
    """
    program = facts.program
    if (program.kind == POSSIBLE).any():
        return _beside_points(facts, critical, work)
    if critical is not None and len(critical.sides):
        kept = critical.carries
        carrying = Critical(critical.forces[kept], kept[kept], critical.basis, critical.sides[:0])
        answer = _without_idle(facts, kept, carrying, work)
        if answer is not None:
            return answer
    known, doubted = facts.known, facts.features.doubted
    if not known.all():
        answer = _without_idle(facts, known, None, work) if known.any() else None
        return answer or open_answer(_unknown(program, known), program)
    problem = facts.problem
    critical = critical or find_critical(problem, work=work)
    if critical is not None and len(critical.sides) and not doubted:
        answer = _stopped_or_none(facts, work)
        if answer is not None:
            return answer
    decision, free = _decide_across_free(facts, critical, work, only_if_stays)
    if doubted:
        problem, decision = decided_for_all(facts, problem, decision, work)
    if decision.state == "minimum":
        return _minimum_or_free(facts, problem, decision, free)
    if decision.state == "balanced":
        if only_if_stays:
            return open_answer("it falls", program)
        return _falling(facts, whole or program, problem, decision, work)
    if not doubted:
        answer = _sliding(facts, critical, work)
        if answer is not None:
            return answer
    return answer_of(program, problem, decision)


def _decide_across_free(
    facts: ClusterFacts, critical: Critical | None, work: Work, only_if_stays: bool
) -> tuple[EnergyDecision, FreeMotions]:
    """Decide whether the energy rises along all motions orthogonal to the free motions.

    If motions are left beside the free ones, only symmetries may be divided out.
    """
    program, problem, free = facts.program, facts.problem, facts.free_motions
    span, symmetric = free_span(program, problem, free), free.symmetries
    neutral = 0 if critical is None else critical.basis.shape[1]
    if span.shape[1] >= neutral or len(symmetric.kinds) == len(free.kinds):
        decision = decide(problem, span, critical=critical, only_if_stays=only_if_stays, work=work)
        if decision.free == decision.neutral or len(symmetric.kinds) == len(free.kinds):
            return decision, free
    free = symmetric
    span_of_symmetries = free_span(program, problem, free)
    decision = decide(
        problem, span_of_symmetries, critical=critical, only_if_stays=only_if_stays, work=work
    )
    if decision.state == "open" and span.shape[1] > decision.free:
        undecided = max(decision.undecided - span.shape[1] + decision.free, 0)
        decision = replace(decision, free=span.shape[1], undecided=undecided)
    return decision, free


def _minimum_or_free(
    facts: ClusterFacts, problem: Stationary, decision: EnergyDecision, free: FreeMotions
) -> SecondOrder:
    """Answer for a proved minimum: "free" if a free motion visibly moves a part, else "minimum"."""
    answer = answer_of(facts.program, problem, decision)
    moving = moving_free(facts.assembly, free)
    if not len(moving):
        return answer
    shifted = np.abs(free.motions[:, moving, :3]).sum(axis=(1, 2))
    motion = free.motions[int(shifted.argmax())]
    size = float(np.linalg.norm(motion.reshape(-1, 3), axis=1).max())
    return replace(answer, state="free", rate=None, motion=motion / size, moving=moving)


def _beside_points(facts: ClusterFacts, critical: Critical | None, work: Work) -> SecondOrder:
    """Answer for a cluster in which edges or corners touch without a unique normal.

    These only take motions away.
    """
    program = facts.program
    answer = answer_alone(facts.certain, critical=critical, whole=program, work=work)
    if answer.state in ("balanced", "open"):
        return answer
    rows = np.flatnonzero(program.kind != POSSIBLE)
    return _opening_idle(facts, rows, answer, work) or open_answer(_sharp(program), program)


def _without_idle(
    facts: ClusterFacts, kept: Mask, critical: Critical | None, work: Work
) -> SecondOrder | None:
    """Answer from the contacts `kept` alone, extended to all contacts; None if that fails.

    Fewer contacts only admit more motions, so a minimum of the subset is a minimum of all. None
    if the subset is neither a minimum nor free, or no free motion opens the other contacts.
    """
    answer = answer_alone(facts.taking(kept), critical=critical, work=work, only_if_stays=True)
    return _opening_idle(facts, np.flatnonzero(kept), answer, work)


def _opening_idle(
    facts: ClusterFacts, rows: Index, answer: SecondOrder, work: Work
) -> SecondOrder | None:
    """Extend an answer for the contacts `rows` to all contacts; None if that is impossible.

    The motion may also shift both parts of a contact alike. None if there is no such motion, or
    the rows are neither at a minimum nor free.
    """
    program = facts.program
    if answer.state not in ("minimum", "free"):
        return None
    idle = np.ones(len(program.kind), dtype=bool)
    idle[np.delete(rows, answer.idle)] = False
    answer = replace(answer, idle=np.flatnonzero(idle))
    if answer.state != "free":
        return answer
    assert answer.decision is not None
    assert answer.problem is not None
    assert answer.problem.scale is not None
    proof = answer.decision.proof
    if not isinstance(proof, MinimumProof):
        return None
    free = proof.free * answer.problem.scale[:, None] / answer.problem.length
    opening = _away(program, idle, free, sharp_points(program, facts.contacts), work)
    if opening is None:
        return None
    motion = program.full(free @ opening)
    moving = moving_free(facts.assembly, FreeMotions(motion[None], ("level",)))
    size = float(np.linalg.norm(motion.reshape(-1, 3), axis=1).max())
    if not len(moving):
        return None
    decision = replace(answer.decision, opening=proof.free @ opening)
    return replace(answer, motion=motion / size, moving=moving, decision=decision)


def _away(
    program: Program, idle: Mask, free: Array, points: SharpPoints, work: Work
) -> Array | None:
    """Coefficients, (f,), of a sum of free motions that opens all contacts without force; or None.

    The sum may also shift all parts alike, and open the idle contacts with held parts. None if no
    such sum was found.
    """
    parting = find_parting(program, ~idle, points, work)
    if parting is not None:
        columns = parting[np.ix_(program.free, program.freedoms)].reshape(-1)
        within, *_ = np.linalg.lstsq(free, columns, rcond=None)
        if np.abs(free @ within - columns).max(initial=0.0) < KEEPS:
            return np.asarray(within)
    rows = program.jacobian() @ free
    for chosen in enough_to_open(points, idle):
        opening = opening_motion(rows[chosen], work)
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
    shift = opening_motion(program.taking(outer).jacobian() @ free @ inside, work)
    return None if shift is None else inside @ shift


def _sliding(facts: ClusterFacts, critical: Critical | None, work: Work) -> SecondOrder | None:
    """Answer "free" if parts slide on faces and no turn is possible; None without a proof."""
    program, problem = facts.program, facts.problem
    critical = critical or find_critical(problem, work=work)
    if critical is None or program.planar:
        return None
    faces = faces_of(program, facts.contacts, problem)
    proof = find_locked(problem, faces, critical, work=work)
    if proof is None:
        return None
    free, across = shifts(problem)
    count, blocked = free.shape[1], across.shape[1]
    decision = EnergyDecision("minimum", count + blocked, count, blocked, 0, proof)
    all_alike = free @ (free.T @ np.ones(len(free)))
    motion = all_alike if np.abs(all_alike).max() > ACROSS else free[:, 0]
    return _sliding_by(program, problem, decision, motion)


def _stopped_or_none(facts: ClusterFacts, work: Work) -> SecondOrder | None:
    """Answer "free" if stops keep sliding parts from falling off; None without a proof."""
    if of_joints(facts.program).any():
        return None
    question = stop_question(facts)
    proof = find_stopped(*question, work=work)
    if proof is None:
        return None
    forms = stop_forms(*question, proof.forces)
    blocked = forms.tilts.shape[1]
    decision = EnergyDecision("minimum", forms.neutral, forms.neutral - blocked, blocked, 0, proof)
    return _sliding_by(facts.program, facts.problem, decision, proof.opening)


def _sliding_by(
    program: Program, problem: Stationary, decision: EnergyDecision, motion: Array
) -> SecondOrder:
    """Answer "free" for parts that slide along `motion`, shape (n,), given in scaled unknowns."""
    assert problem.scale is not None
    moved = program.full(motion * problem.scale)
    sizes = np.linalg.norm(moved[:, :3], axis=1)
    return replace(
        answer_of(program, problem, decision),
        state="free",
        motion=moved / sizes.max(),
        moving=np.flatnonzero(sizes > ACROSS * sizes.max()),
    )


def _unknown(program: Program, known: Mask) -> str:
    """Reason for an open answer: two surfaces of unknown curvature meet; names their parts."""
    pair = _first(program, ~known)
    return f"the curvature of the surfaces of {pair} at their contact is not known"


def _sharp(program: Program) -> str:
    """Reason for an open answer: edges or corners meet without a normal; names their parts."""
    pair = _first(program, program.kind == POSSIBLE)
    return f"edges or corners of {pair} meet without a unique normal"


def _first(program: Program, rows: Mask) -> str:
    """Names of the two parts of the first row in a mask, shape (K,), joined by "and"."""
    k = int(np.flatnonzero(rows)[0])
    names = (*program.names, "the ground")
    return f"{names[program.part_a[k]]} and {names[program.part_b[k]]}"


def _falling(
    facts: ClusterFacts, whole: Program, problem: Stationary, decision: EnergyDecision, work: Work
) -> SecondOrder:
    """Answer "balanced" with an exact configuration below the start; "open" if none is found.

    Arguments: `whole`: the contacts with edges and corners that have no unique normal, which the
    path has to open.
    """
    path, why, program = decision.proof, "", facts.program
    assert isinstance(path, Path)
    assert problem.scale is not None
    scale, configuration = problem.scale, None

    def opens(path: Path) -> bool:
        motion = program.full(path.first * scale)
        return whole is program or opens_points(whole, facts.contacts, motion)

    if by_path_alone(facts):
        why = "" if path.one_form else "a corner on edges of both parts slips"
        why = why if opens(path) else _sharp(whole)
    else:
        paths = (path, *decision.others)
        parted = parted_paths(whole, facts.contacts, problem, paths, work)
        for candidate in itertools.chain(paths, parted):
            if not opens(candidate):
                continue
            configuration, wrong = find_configuration(
                facts.assembly, facts.contacts, program, problem, candidate
            )
            if configuration is not None:
                path = candidate
                break
            why = why or wrong
        why = "" if configuration is not None else why or _sharp(whole)
    if why:
        return replace(answer_of(program, problem, decision), state="open", why=why)
    motion = program.full(path.first * scale)
    sizes = np.maximum(
        np.linalg.norm(motion[:, :3], axis=1),
        np.linalg.norm(motion[:, 3:], axis=1) * program.radius,
    )
    return replace(
        answer_of(program, problem, replace(decision, proof=path)),
        rate=growth_rate(program, problem, path, find_critical(problem, work=work)),
        motion=motion / sizes.max(),
        moving=np.flatnonzero(sizes > 1e-6 * sizes.max(initial=TINY)),
        configuration=configuration,
    )
