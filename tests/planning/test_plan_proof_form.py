"""Damaged statements of a plan or a fixture: a message about the form, or a refused proof."""

import copy
import json
import random
from collections.abc import Iterator
from typing import Any

import pytest

import kilter
from kilter.errors import InputError
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene

WRONG = [None, True, -1, 0, 3, 99, 1e308, "x", "", [], {}, [1], ["x"], [[1, 2, 3], None], {"a": 1}]


def places(data: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Keys and indices that lead to each value."""
    if place:
        yield place
    entries = data.items() if isinstance(data, dict) else enumerate(data[:6])
    for key, value in entries if isinstance(data, dict | list) else ():
        if isinstance(value, dict | list):
            yield from places(value, (*place, key))
        else:
            yield (*place, key)


def damaged(proof: dict[str, Any], rng: random.Random, where: list[tuple[Any, ...]]) -> Any:
    """The proof with a changed or missing value, and its digest."""
    other = copy.deepcopy(proof)
    place, at = rng.choice(where), other
    for key in place[:-1]:
        at = at[key]
    if isinstance(at, dict) and rng.random() < 0.3:
        del at[place[-1]]
    else:
        at[place[-1]] = rng.choice(WRONG)
    other.pop("digest", None)
    return other | {"digest": digest_of(other)}


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "kind"),
    [("tower", "plan"), ("paper-figure-8", "plan"), ("squeezed-block", "hold")],
)
def test_a_damaged_statement_raises_no_other_error(name: str, kind: str) -> None:
    assembly = scene(name)
    answer = kilter.plan(assembly) if kind == "plan" else kilter.hold(assembly)
    proof = json.loads(json.dumps(answer.proof()))
    assert kilter.verify(assembly, proof).holds
    statements = {"rules": proof["rules"], "proofs": proof["proofs"]}
    where, rng = list(places(statements)), random.Random(7)
    refused = 0
    for _ in range(24):
        try:
            refused += not kilter.verify(assembly, damaged(proof, rng, where)).holds
        except InputError:
            refused += 1
    assert refused > 16
