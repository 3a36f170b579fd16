"""Data without the form of a proof are refused, and the message names the place."""

from __future__ import annotations

import json
import math
from functools import cache
from typing import Any

import pytest

import kilter
from kilter import InputError
from kilter.mechanics.proof_form import require_bundle_form, require_form
from kilter.scenes import example
from kilter.validate import LARGEST


@cache
def proof_of(name: str) -> str:
    return json.dumps(kilter.check(example(name)).proof())


def forces() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(proof_of("tower"))
    return found


def motion() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(proof_of("paper-figure-8"))
    return found


@cache
def region() -> str:
    return json.dumps(kilter.region(example("tower")).proof())


def test_whole_ones_are_taken() -> None:
    for one in (forces(), motion()):
        require_form(one)
    require_bundle_form(json.loads(region()))


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"motion": []}, "motion is"),
        ({"motion": {"C2": [1.0]}}, "motion.C2 is"),
        ({"motion": {"C2": ["a", 0, 0, 0, 0, 0]}}, r"motion.C2\[0\] is 'a'"),
        ({"gravity": [0.0, 0.0, 2 * LARGEST]}, r"gravity\[2\] is"),
        ({"planar": 1}, "planar is 1"),
        ({"verdict": None}, "verdict is None"),
        ({"units": True}, "units is True"),
    ],
)
def test_the_place_is_named(change: dict[str, Any], place: str) -> None:
    with pytest.raises(InputError, match=place):
        require_form({**motion(), **change})


def test_a_number_may_be_as_large_as_numbers_may() -> None:
    require_form({**motion(), "gravity": [0.0, 0.0, -LARGEST]})


@pytest.mark.parametrize("value", [math.nan, math.inf, {1}])
def test_a_key_that_nobody_reads_is_json_too(value: Any) -> None:
    with pytest.raises(InputError, match="it is no JSON"):
        require_form({**forces(), "note": value})
    with pytest.raises(InputError, match="it is no JSON"):
        require_bundle_form({**json.loads(region()), "note": value})
    require_form({**forces(), "note": "x"})


def test_what_friction_says_has_a_form_too() -> None:
    for damaged in ({}, {"guarantee": 1}):
        with pytest.raises(InputError, match=r"friction\.guarantee is"):
            require_form({**forces(), "friction": damaged})
    require_form({**forces(), "friction": None})


@pytest.mark.parametrize("bundle", [[], "x", None, {}, {"kilter_proofs": 2}])
def test_another_format_of_several_proofs_is_refused(bundle: Any) -> None:
    for asked in (bundle, {**json.loads(region()), "kilter_proofs": 2}):
        with pytest.raises(InputError, match="no file of kilter proofs of format 1"):
            require_bundle_form(asked)


def test_no_proof_at_all_is_no_file_of_proofs() -> None:
    with pytest.raises(InputError, match="it has no proofs"):
        require_bundle_form({**json.loads(region()), "proofs": []})


@pytest.mark.parametrize("proof", [[], "x", None, {}, {"kilter_proof": 2}])
def test_another_format_is_refused(proof: Any) -> None:
    for asked in (proof, {**forces(), "kilter_proof": 2}):
        with pytest.raises(InputError, match="no kilter proof of format 1"):
            require_form(asked)
