"""Check that the entries of a proof file of a plan or a fixture have the right keys and types.

Statements of this form can be judged without further checks: every key that is read exists, every
name is the name of a part, and every number of a candidate exists.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.mechanics.proof_form import (
    COUNT,
    FLAG,
    LOADS,
    NUMBER,
    PAIR,
    SIX,
    STRAPS,
    VECTOR,
    WORD,
    Form,
    count_up_to,
    every,
    keys,
    list_of,
    named,
    nullable,
    one_of,
    optional_keys,
    require,
    row_of,
)

PLAN_RULES = every(
    keys(
        hold=COUNT,
        press=NUMBER,
        turn=FLAG,
        precedence=list_of(PAIR),
        groups=list_of(list_of(WORD)),
        never_held=list_of(WORD),
        screws=list_of(row_of(WORD, WORD, VECTOR)),
    ),
    optional_keys(carried=list_of(VECTOR)),
)
"""Rules that an order keeps."""
HOLD_RULES = keys(candidates=list_of(keys(kind=WORD, part=WORD)), least=COUNT)
"""Candidates for supports, and the proved least number of supports."""


def require_plan_form(bundle: Mapping[str, Any], names: Sequence[str]) -> None:
    """Reject a plan in a proof file if an entry has a wrong key or type.

    Raises `MalformedProof` with the first key that is missing or of another kind.
    """
    part, step = one_of(*names), COUNT
    parts = list_of(part)
    kinds: dict[str, Form] = {
        "step": keys(
            parts=parts,
            legs=list_of(row_of(VECTOR, nullable(NUMBER))),
            over=nullable(part),
        ),
        "turned": keys(step=step, change=keys(down=VECTOR)),
        "carried": keys(step=step, change=keys(gravity=VECTOR)),
        "pressed": keys(step=step, change=keys(loads=LOADS)),
        "not fewer": keys(step=step, parts=parts),
        "falls alone": keys(part=part),
        "locked": keys(part=part, multipliers=list_of(NUMBER)),
        "refused": keys(parts=parts),
    }
    state = every(
        keys(without=parts, held=parts), optional_keys(down=VECTOR, gravity=VECTOR, loads=LOADS)
    )

    def statement(entry: Any, place: str) -> str:
        form = every(keys(change=state), kinds.get(entry["about"], keys()))
        return form(entry, place)

    require(keys(rules=PLAN_RULES, proofs=list_of(statement)), bundle)


def require_hold_form(bundle: Mapping[str, Any], names: Sequence[str]) -> None:
    """Reject a fixture in a proof file if an entry has a wrong key or type.

    Arguments and errors as for a plan.
    """
    require(keys(rules=HOLD_RULES), bundle)
    last = len(bundle["rules"]["candidates"]) - 1
    chosen = keys(supports=list_of(count_up_to(last, least=0)))
    falls = keys(proof=keys(motion=named(SIX)))

    def statement(entry: Any, place: str) -> str:
        return every(chosen, falls if entry["about"] == "not fewer" else keys())(entry, place)

    require(keys(proofs=list_of(statement)), bundle)


def require_lashing_form(bundle: Mapping[str, Any], names: Sequence[str]) -> None:
    """Reject a lashing in a proof file if an entry has a wrong key or type.

    Arguments and errors as for a plan.
    """
    code = optional_keys(code=keys(name=WORD, forward=VECTOR))
    require(keys(rules=every(keys(candidates=STRAPS, least=COUNT), code)), bundle)
    last = len(bundle["rules"]["candidates"]) - 1
    chosen = every(keys(chosen=list_of(count_up_to(last, least=0))), optional_keys(case=WORD))
    falls = keys(proof=keys(motion=named(SIX)))

    def statement(entry: Any, place: str) -> str:
        return every(chosen, keys() if entry["about"] == "held" else falls)(entry, place)

    require(keys(proofs=list_of(statement)), bundle)
