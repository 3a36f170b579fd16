"""Decisions that are valid for every surface that a mesh may represent."""

from __future__ import annotations

from dataclasses import replace

from kilter.mechanics.program import Program
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.recognised import bounded
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.minimum_proof import MinimumProof, judge_minimum
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.energy_decision import EnergyDecision
from kilter.second_order.searches.path_search import find_path
from kilter.work import Work

__all__ = ["decided_for_all"]

TOO_NEAR = "the surfaces recognised in meshes are not known exactly enough to decide"


def decided_for_all(
    program: Program,
    features: Features,
    problem: Stationary,
    decision: EnergyDecision,
    work: Work,
) -> tuple[Stationary, EnergyDecision]:
    """Return a decision only if it holds for all surfaces within their doubt; else "open".

    Parameters
    ----------
    program : Program
    features : Features
        Features of its rows; all gaps have a form for all surfaces.
    problem : Stationary
        Problem with the surfaces as they were recognised.
    decision : EnergyDecision
        Decision about this problem.

    Returns
    -------
    Stationary
        The problem at the worst bounds, which the proof is about.
    EnergyDecision
    """
    proof = decision.proof
    if isinstance(proof, MinimumProof):
        worst = bounded(program, features, 1.0)
        if not judge_minimum(problem, proof, worst):
            return worst, decision
    elif isinstance(proof, Path):
        worst = replace(bounded(program, features, -1.0), on_plane=problem.on_plane)
        for candidate in (proof, *decision.others):
            path = find_path(worst, candidate.first, work=work)
            if path is not None and path.falls:
                return worst, replace(decision, proof=path, others=())
    else:
        return problem, decision
    left = decision.neutral - decision.free
    return problem, replace(
        decision, state="open", blocked=0, undecided=left, proof=None, why=TOO_NEAR, others=()
    )
