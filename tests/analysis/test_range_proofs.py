"""Proof files of ranges of forces: both sides are recomputed, and changed files are refused."""

import copy
import json

import pytest
from test_force_ranges import arch, beam_on_three, off_centre, slot

import kilter
from kilter import InputError
from kilter.cli import main
from kilter.mechanics.proof import digest_of


def proofs_of(assembly, *question, **axis):
    """The proofs as they are read from a file."""
    verdict = kilter.check(assembly)
    return json.loads(json.dumps(verdict.range_proofs(verdict.force_ranges(*question, **axis))))


@pytest.mark.parametrize(
    ("assembly", "about", "axis"),
    [
        (beam_on_three(), ("knife-1", "beam"), {}),
        (beam_on_three(), "knife-0", {"along": [0, 0, 1]}),
        (off_centre("mm", 1e-3), "floor", {"moment": [0, 1, 0]}),
        pytest.param(arch(6, 2), ("right", "v0"), {"along": [-1, 0, 0]}, marks=pytest.mark.slow),
        pytest.param(arch(20, 0.75), ("v9", "v10"), {}, marks=pytest.mark.slow),
    ],
)
def test_both_ends_are_recomputed(assembly, about, axis):
    data = proofs_of(assembly, [about], **axis)
    (found,) = kilter.check(assembly).force_ranges([about], **axis)
    stated = [(entry["about"], entry["value"]) for entry in data["proofs"]]
    assert stated == [("least", found.least.value), ("greatest", found.greatest.value)]
    result = kilter.verify(assembly, data)
    assert (result.holds, result.verdict) == (True, "ranges")
    words = {"along": " along (", "moment": " about ("}
    assert all(words[key] in note for key in axis for note in result.notes[:2])
    assert sum("no forces up to 100 weights at a point pass" in note for note in result.notes) == 2


def raise_value(entry):
    entry["value"] *= 1.001


def lower_bound(entry):
    entry["bound"] *= 0.999


def halve_motion(entry):
    entry["bounding"]["beam"] = [x / 2 for x in entry["bounding"]["beam"]]


def leave_motion_out(entry):
    entry["bounding"] = {}


def name_another_pair(entry):
    entry["parts"][0] = "knife-2"


def name_another_axis(entry):
    entry["along"] = [1.0, 0.0, 0.0]


def name_a_longer_axis(entry):
    entry["along"] = [0.0, 0.0, 2.0]


def name_two_axes(entry):
    entry["along"], entry["moment"] = [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("forge", "reason"),
    [
        (raise_value, "its forces have the value"),
        (lower_bound, "its motion bounds the force by"),
        (halve_motion, "its motion bounds the force by"),
        (leave_motion_out, "its motion bounds the force by"),
        (name_another_pair, "its forces have the value"),
        (name_another_axis, "its forces have the value"),
        (name_a_longer_axis, "its axis is not a single unit vector"),
        (name_two_axes, "its axis is not a single unit vector"),
    ],
)
def test_a_changed_statement_is_refused(forge, reason):
    scene = beam_on_three()
    data = copy.deepcopy(proofs_of(scene, [("knife-1", "beam")]))
    forge(data["proofs"][1])
    data["digest"] = digest_of(data)
    result = kilter.verify(scene, data)
    assert not result.holds
    assert any(
        f"greatest of {data['proofs'][1]['parts'][0]} - beam: {reason}" in why
        for why in result.reasons
    )


@pytest.mark.slow
def test_less_friction_than_the_proof_needs_is_refused():
    data = proofs_of(arch(6, 2), [("right", "v0")], along=[-1, 0, 0])
    assert not kilter.verify(arch(6, 2).with_friction(0.2), data).holds


def test_a_malformed_file_is_one_sentence():
    scene = beam_on_three()
    data = proofs_of(scene, [("knife-1", "beam")])
    data["proofs"][0]["parts"] = ["nobody"]
    data["digest"] = digest_of(data)
    with pytest.raises(InputError, match="does not have the required form"):
        kilter.verify(scene, data)


def test_an_end_without_a_limit_has_no_proof():
    data = proofs_of(slot(), [("left", "block")])
    assert [entry["about"] for entry in data["proofs"]] == ["least"]
    assert kilter.verify(slot(), data).holds
    falls = slot(0.0)
    with pytest.raises(InputError, match="no range has a limit"):
        proofs_of(falls)


def test_the_command_writes_and_verifies(tmp_path, capsys):
    file, proof = str(tmp_path / "b.kilter.json"), str(tmp_path / "p.json")
    kilter.dump(beam_on_three(), file)
    words = ["--between", "knife-1", "beam", "--range-proof"]
    assert main(["check", file, *words, proof]) == 0
    assert f"ranges written to {proof}" in " ".join(capsys.readouterr().out.split())
    assert main(["verify", file, proof]) == 0
    assert "greatest of knife-1 - beam: 21582 N" in capsys.readouterr().out
    falls, none = str(tmp_path / "falls.kilter.json"), tmp_path / "none.json"
    kilter.dump(slot(0.0), falls)
    assert main(["check", falls, "--forces", "--range-proof", str(none)]) == 1
    assert "ranges not written: no equilibrium is known" in capsys.readouterr().out
    assert not none.exists()
    assert main(["check", file, "--range-proof", proof]) == 2
    assert "--range-proof needs forces" in capsys.readouterr().err
    assert main(["check", file, *words, file]) == 2
    assert "would be overwritten" in capsys.readouterr().err
