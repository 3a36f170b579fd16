"""The parts that the proof moves come first; groups that touch no other part are named."""

import numpy as np

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.tell.text import text_of


def two_groups() -> Assembly:
    """A ball in a close box on a table, which stays open, and two boxes that hang in the air."""
    return Assembly(
        [
            Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True),
            Part("base", Box([1, 1, 1]), Pose([0, 0, 0.5])),
            Part("sunk", Box([0.5, 0.5, 0.5]), Pose([0, 0, 1.2])),  # 5 cm deep in the base
            Part("upper", Box([1, 1, 1]), Pose([0, 0, 6.0])),
            Part("lower", Box([1, 1, 1]), Pose([0, 0, 5.0])),
        ]
    )


def test_the_parts_of_the_proof_are_listed_first() -> None:
    verdict = kilter.check(two_groups())
    assert verdict.verdict == "unstable"
    proved = [verdict.program.names[k] for k in np.flatnonzero(verdict.moved_by_proof)]
    assert proved
    assert set(proved) <= {"upper", "lower"}  # joined to the base, "sunk" stays
    assert set(verdict.moving) == {"sunk", "upper", "lower"}
    text = text_of(verdict.to_dict())
    which = "the first moves" if len(proved) == 1 else "the first 2 move"
    assert (
        "3 of 4 free parts move if the open pairs carry no force; it is proved that "
        f"{which} in any case:"
    ) in text
    assert max(text.index(f"\n  {name}") for name in proved) < text.index("\n  sunk")


def test_the_sentence_states_that_no_open_pair_could_stop_it() -> None:
    assembly = two_groups()
    verdict = kilter.check(assembly)
    (pair,) = verdict.to_dict()["open_pairs"]
    assert "can hold it, not even with forces at its open pairs. Here is how" in verdict.sentence
    joined = kilter.check(assembly.with_joints([kilter.Joint(tuple(pair["parts"]))]))
    alone = kilter.check(assembly.without(["sunk"]))
    for other in (joined, alone):
        assert other.verdict == "unstable"
        assert "open pairs" not in other.sentence
    undecided = kilter.check(assembly.without(["upper", "lower"]))
    assert undecided.verdict == "undecided"


def test_a_group_that_touches_no_other_part_is_named() -> None:
    verdict = kilter.check(two_groups())
    assert "touch no other part: the group ('upper', 'lower')" in verdict.warnings


def test_a_group_with_a_held_part_or_a_joint_to_it_does_not_float() -> None:
    joined = two_groups().with_joints([kilter.Joint(("base", "lower"))])
    assert not any("touch no other part" in text for text in kilter.check(joined).warnings)


def test_without_a_motion_the_proof_moves_no_part() -> None:
    verdict = kilter.check(kilter.example("tower"))
    assert not np.any(verdict.moved_by_proof)
    assert not any(part["moved_by_proof"] for part in verdict.to_dict()["parts"])
