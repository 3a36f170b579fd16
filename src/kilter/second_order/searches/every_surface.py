"""Decisions that are valid for every surface that a mesh may represent."""

from __future__ import annotations

from dataclasses import replace

from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.cluster_facts import ClusterFacts
from kilter.second_order.proofs.minimum_proof import MinimumProof, judge_minimum
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.energy_decision import EnergyDecision
from kilter.second_order.searches.path_search import find_path
from kilter.work import Work

__all__ = ["decided_for_all"]

TOO_NEAR = "the surfaces recognised in meshes are not known exactly enough to decide"


def decided_for_all(
    facts: ClusterFacts,
    problem: Stationary,
    decision: EnergyDecision,
    work: Work,
) -> tuple[Stationary, EnergyDecision]:
    """Return a decision only if it holds for all surfaces within their doubt; else "open".

    Returns the problem at the worst bounds, which the proof is about.
    """
    proof = decision.proof
    if isinstance(proof, MinimumProof):
        worst = facts.bounded(1.0)
        if not judge_minimum(problem, proof, worst):
            return worst, decision
    elif isinstance(proof, Path):
        worst = facts.bounded(-1.0)
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
