"""Proofs of plans and fixtures as a reader has them: from their JSON, signed anew, judged again."""

import json
from typing import Any

import kilter
from kilter.analysis.verification import verify_bundle
from kilter.mechanics.bundle_changes import restored
from kilter.mechanics.proof import digest_of

Proof = dict[str, Any]


def written(answer: kilter.Order | kilter.Fixture) -> Proof:
    """Its proof, through JSON."""
    proof: Proof = json.loads(json.dumps(answer.proof(), allow_nan=False))
    return proof


def proof_of(answer: kilter.Order | kilter.Fixture) -> Proof:
    """Its proof, through JSON, with all rows of each state as objects of their own, signed."""
    return signed(json.loads(json.dumps(restored(written(answer)))))


def signed(proof: Proof) -> Proof:
    """The same, signed as one who knows how files are signed would after a change."""
    for entry, whole in zip(proof["proofs"], restored(proof)["proofs"], strict=True):
        entry["proof"]["digest"] = digest_of({**proof["common"], **whole["proof"]})
    proof["digest"] = digest_of(proof)
    return proof


def reasons(order: kilter.Order, proof: Proof) -> str:
    """Why a proof of a plan does not hold; empty where it holds."""
    made = order.states
    answer = verify_bundle(made.assembly, made.contacts, proof)
    assert answer.holds == (not answer.reasons)
    return "; ".join(answer.reasons)
