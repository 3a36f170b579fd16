"""Files of several proofs with an exchanged value: an answer or an error message, no fault."""

from __future__ import annotations

import copy
import json
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError
from kilter.analysis.verification import verify_bundle
from kilter.mechanics.proof import digest_of
from kilter.scenes import example

Path = tuple[Any, ...]

LEFT_OUT = object()
OTHER = (LEFT_OUT, None, "x", [], {}, [[1]], ["x", 3], -1, 0, 10**400, 1e308, True)

"""What is put in the place of whatever stands there."""
FEW, MANY = 25, 400
"""Exchanges that are tried of each file: always, and with the slow tests."""
MAKERS: dict[str, Callable[[Any], Any]] = {
    "plan": kilter.plan,
    "no plan": lambda assembly: kilter.plan(assembly, kilter.PlanRules(hold=0)),
    "hold": kilter.hold,
    "region": kilter.region,
    "margin": lambda assembly: kilter.margin(assembly, push=[1, 0, 0]),
}


@cache
def made(kind: str) -> tuple[Any, Any, Any]:
    """An assembly, its contacts and the proofs of an answer about it, as a file has them."""
    assembly = example("tower" if kind == "margin" else "paper-figure-9")
    proof = json.loads(json.dumps(MAKERS[kind](assembly).proof()))
    contacts = kilter.contacts(assembly)
    assert verify_bundle(assembly, contacts, proof).holds
    return assembly, contacts, proof


def places(data: Any, at: Path = ()) -> Iterator[Path]:
    """Every place in a file; for the proofs themselves only their first level."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*at, key)
        if isinstance(value, dict | list) and not (at[:1] == ("proofs",) and key == "proof"):
            yield from places(value, (*at, key))


def exchanged(proof: Any, place: Path, value: Any) -> Any:
    """The file with another value in a single place, with a new digest."""
    proof = copy.deepcopy(proof)
    inner = proof
    for key in place[:-1]:
        inner = inner[key]
    if value is LEFT_OUT:
        del inner[place[-1]]
    else:
        inner[place[-1]] = value
    return {**proof, "digest": digest_of(proof)}


def wrong(assembly: Any, contacts: Any, proof: Any) -> str:
    """Reasons against a file of proofs; empty if they hold."""
    try:
        return "; ".join(verify_bundle(assembly, contacts, proof).reasons)
    except InputError as error:
        return str(error)


@pytest.mark.quick("25-plan", "25-hold")
@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("tried", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_whatever_is_exchanged_it_is_no_fault(kind: str, tried: int) -> None:
    assembly, contacts, proof = made(kind)
    every = list(places(proof))
    random = np.random.default_rng(11)
    refused = 0
    for _ in range(tried):
        place, value = every[random.integers(len(every))], OTHER[random.integers(len(OTHER))]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            refused += bool(wrong(assembly, contacts, exchanged(proof, place, value)))
    assert refused > tried / 2
