"""Proofs of fixtures, one thing in them wrong: what `wrong_hold` says of each."""

import copy
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import pytest
from read_proofs import Proof, proof_of

import kilter
from kilter import Assembly, Fixture, InputError, Support
from kilter.analysis.planning.hold.hold_check import wrong_hold
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor


def hanging(*, capacity: float) -> Fixture:
    """A cube of weight 9.81 beside a floor, and three magnets above it, a grip of what stands."""
    cube, other = (
        block("cube", [4, 0, 0], [5, 1, 1], mass=1.0),
        block("other", [0, 0, 0], [1, 1, 1]),
    )
    places = [[4.5, 0.5, 1.0], [4.4, 0.5, 1.0], [4.6, 0.5, 1.0]]
    magnets = [Support("magnet", "cube", at, [0, 0, -1], capacity=capacity) for at in places]
    made = Assembly([floor([-2, -2], [2, 2]), cube, other])
    return kilter.hold(made, candidates=[Support("grip", "other"), *magnets])


@cache
def made(kind: str) -> Fixture:
    """One that holds with fewest, one that no candidates hold, one of a single prop."""
    if kind == "arch":
        return kilter.hold(arch(9, ratio=0.3, friction=0.6).without("voussoir-4"))
    if kind == "strong":
        return hanging(capacity=6.0)
    if kind == "weak":
        return hanging(capacity=3.0)
    cube = block("cube", [4, 0, 0], [5, 1, 1])
    prop = Support("prop", "cube", [4.5, 0.5, 0])
    return kilter.hold(Assembly([floor([-2, -2], [2, 2]), cube]), candidates=[prop])


def said(
    kind: str, change: Callable[[Proof], object] = lambda _: None, words: Any = None
) -> list[str]:
    """What is said of the proofs after a change; with these verdicts, or their own."""
    given = made(kind)
    proof = copy.deepcopy(proof_of(made(kind)))
    verdicts: Sequence[str] = words or [one["proof"]["verdict"] for one in proof["proofs"]]
    change(proof)
    verdicts = verdicts[: len(proof["proofs"])]
    return list(wrong_hold(given.assembly, given.contacts, proof, verdicts))


def test_a_motion_of_a_part_that_does_not_exist_proves_nothing():
    """The name was looked up in the assembly: a fault of kilter instead of a reason."""

    def misnamed(proof: Proof) -> None:
        falls = next(one for one in proof["proofs"] if one["about"] != "held")
        falls["proof"]["motion"]["no such part"] = [0.0] * 6

    assert "motion names a part that the assembly does not have" in said("prop", misnamed)[0]


LEAST = {"arch": 2, "strong": 2, "weak": 5, "prop": 1}
"""Fewest supports; one more than there are where all together are not enough."""


@pytest.mark.parametrize("kind", LEAST)
def test_what_is_proved_is_not_doubted(kind):
    assert said(kind) == []
    assert made(kind).verdict == ("impossible" if kind == "weak" else "held")


@pytest.mark.parametrize("kind", LEAST)
def test_without_its_motions_fewer_may_be_enough(kind):
    def bare(proof: Proof) -> None:
        proof["proofs"] = [one for one in proof["proofs"] if one["about"] == "held"]

    assert said(kind, bare) == [f"fewer than {LEAST[kind]} supports may be enough"]


@pytest.mark.parametrize("kind", ["arch", "strong", "prop"])
def test_no_other_count_is_proved(kind):
    least = LEAST[kind]
    many = said(kind, lambda p: p["rules"].update(least=least + 1))
    assert many == [
        "it has no proof that the fewest supports hold it",
        f"fewer than {least + 1} supports may be enough",
    ]
    # fewer than are proved: what is said is true, but not all
    assert said(kind, lambda p: p["rules"].update(least=least - 1)) == []


def test_it_holds_once():
    def twice(proof: Proof) -> None:
        proof["proofs"].insert(0, copy.deepcopy(proof["proofs"][0]))

    words = ["stable", "stable", *["unstable"] * 9]
    assert said("arch", twice, words) == ["it has no proof that the fewest supports hold it"]


def test_what_is_said_is_what_is_proved():
    supports = "{}: its supports differ from the candidates that it names"
    falls = said("prop", words=["unstable", "unstable"])
    assert falls[0] == "it states 'held', but its proof gives the verdict unstable"
    held = said("prop", words=["stable", "stable"])
    assert held[0] == "it states 'not fewer', but its proof gives the verdict stable"
    other = said("prop", lambda p: p["proofs"][1].update(about="more"))
    assert other[0] == "it states 'more', but its proof gives the verdict unstable"
    none = said("prop", lambda p: p["proofs"][0].update(supports=[]))
    assert none[0] == supports.format("held")
    # an entry that is refused does not end the rest
    assert none[1:] == ["fewer than 2 supports may be enough"]
    assert other[1:] == ["fewer than 1 supports may be enough"]


def test_grips_hold_and_all_others_are_supports():
    supports = "it names"
    first = proof_of(made("strong"))["proofs"]
    kinds = {(bool(one["change"]["held"]), bool(one["change"]["supports"])) for one in first}
    assert len(kinds) > 1
    for key in ("held", "supports"):
        k = next(k for k, one in enumerate(first) if one["change"][key])
        wrong = said("strong", lambda p, k=k, key=key: p["proofs"][k]["change"].update({key: []}))
        assert supports in wrong[0]


@pytest.mark.parametrize(
    ("other", "why"),
    [
        ({"part": "none"}, "none"),
        ({"part": "floor"}, "held already"),
        ({"point": [0, 0, 9]}, "not on the part"),
    ],
)
def test_candidates_are_of_the_assembly(other, why):
    with pytest.raises(InputError, match=why):
        said("prop", lambda p: p["rules"]["candidates"][0].update(other))


def test_every_proof_has_a_verdict():
    with pytest.raises(ValueError, match="shorter"):
        said("prop", words=["stable"])
