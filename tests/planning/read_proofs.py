"""Proofs of plans and fixtures as a reader has them: from their JSON, signed anew, judged again."""

from __future__ import annotations

import json
from typing import Any

import kilter
from kilter.analysis.verification import verify_bundle
from kilter.mechanics.proof import digest_of

Proof = dict[str, Any]


def proof_of(answer: kilter.Order | kilter.Fixture) -> Proof:
    """Its proof, through JSON."""
    proof: Proof = json.loads(json.dumps(answer.proof(), allow_nan=False))
    return proof


def signed(proof: Proof) -> Proof:
    """The same, signed as one who knows how files are signed would after a change."""
    for entry in proof["proofs"]:
        entry["proof"]["digest"] = digest_of({**proof["common"], **entry["proof"]})
    proof["digest"] = digest_of(proof)
    return proof


def reasons(order: kilter.Order, proof: Proof) -> str:
    """Why a proof of a plan does not hold; empty where it holds."""
    made = order.states
    answer = verify_bundle(made.assembly, made.contacts, proof)
    assert answer.holds == (not answer.reasons)
    return "; ".join(answer.reasons)
