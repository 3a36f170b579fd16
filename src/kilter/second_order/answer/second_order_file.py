"""Proof of a second-order answer as data of a proof file.

Several clusters have a proof each, None for an open cluster. `proof_kinds` has the kinds of proof;
`second_order_recheck` judges the data.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kilter.second_order.parts.cluster_states import joined_state
from kilter.second_order.proofs.minimum_proof import by_part, counts

if TYPE_CHECKING:
    from kilter.second_order.answer.second_order_answer import SecondOrder


def second_order_data(answer: SecondOrder) -> dict[str, Any] | None:
    """Data for a proof file from a second-order answer; None without a proof of any cluster."""
    rolling = answer.rolling
    rolls = {} if rolling is None or rolling.state == "open" else {"rolling": rolling.state}
    if answer.clusters:
        entries = [second_order_data(cluster) for cluster in answer.clusters]
        given = [entry for entry in entries if entry is not None]
        if not given:
            return None
        # a fall by rolling alone is found again by rules, and has no proof here
        state = joined_state("open" if entry is None else entry["state"] for entry in entries)
        rolls = rolls if state == "balanced" else {}
        return {"state": state, **counts(entries), "clusters": entries} | rolls
    problem, decision, program = answer.problem, answer.decision, answer.program
    proof = answer.proof
    if decision is None or program is None or proof is None or answer.state == "open":
        return None
    data: dict[str, Any] = {"state": answer.state}
    if answer.state != "balanced":  # a path proves that parts fall, not how much may move
        data |= {"neutral": answer.neutral, "free": answer.free}
    if answer.alone:
        data["alone"] = answer.names_alone
    if len(answer.idle):
        data["idle"] = answer.idle.tolist()
        if decision.opening is not None:
            assert problem is not None
            data["motion"] = by_part(program, problem, decision.opening)
    return data | rolls | proof.to_data(program, problem)
