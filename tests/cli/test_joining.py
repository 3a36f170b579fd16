"""Options that join and close: --fasten, --suggest-joints, --clearance, on every command."""

import json
from pathlib import Path

import pytest

from kilter.cli import main

COMMANDS = ["check", "orient", "region", "contacts", "margin"]


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def lamp(gap: float = 0.0, **more: object) -> str:
    """A post on a table and an arm beside it, `gap` away; written to a.json."""
    data = {
        "kilter": 1,
        "units": "mm",
        "parts": [
            {"name": "table", "box": [90, 90, 10], "pose": {"position": [0, 0, -5]},
             "grounded": True},
            {"name": "post", "box": [20, 20, 40], "pose": {"position": [0, 0, 20]}},
            {"name": "arm-1", "box": [20, 10, 10], "pose": {"position": [20 + gap, 0, 35]}},
        ],
        **more,
    }  # fmt: skip
    Path("a.json").write_text(json.dumps(data))
    return "a.json"


def said(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    capsys.readouterr()
    code = main(list(words))
    out, error = capsys.readouterr()
    return code, out, error


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    code, out, error = said(capsys, *words)
    assert (code, out) == (2, "")
    assert error.count("\n") == 1
    assert error.startswith("kilter: ")
    return error


@pytest.mark.slow
def test_fasten_holds_what_fell_and_is_part_of_the_proof(capsys):
    file = lamp()
    assert main(["check", file]) == 1
    words = ["--fasten", "post", "arm*", "--proof", "p.json"]
    code, out, _ = said(capsys, "check", file, *words)
    assert code == 0
    assert "1 fixed: post - arm-1" in out
    proof = json.loads(Path("p.json").read_text())
    assert proof["options"]["fasten"] == [["post", "arm*"]]
    assert proof["joints"][0]["parts"] == ["post", "arm-1"]
    code, out, _ = said(capsys, "verify", file, "p.json")
    assert code == 0
    assert "fasten" in out
    # the joint is needed: without it the proof does not hold
    proof["options"].pop("fasten")
    Path("q.json").write_text(json.dumps(proof))
    code, out, _ = said(capsys, "verify", file, "q.json")
    assert code == 1
    assert "its joints differ from those of the file" in out


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_fasten_and_clearance_work_on_every_command(command, capsys):
    file = lamp(gap=0.2)
    words = ["--fasten", "arm-1", "post", "--clearance", "0.3"]
    code, out, _ = said(capsys, command, file, *words, "--json")
    assert code == 0
    answer = json.loads(out)
    assert answer["joints"] == [{"parts": ["arm-1", "post"], "kind": "fixed"}]
    assert any("'post' and 'arm-1' (0.2 mm)" in text for text in answer["warnings"])
    code, out, error = said(capsys, command, file, *words)
    assert code == 0
    assert "1 fixed: arm-1 - post" in out
    assert "clearances counted as closed" in error
    error = refused(capsys, command, file, "--fasten", "arm-1", "post")
    assert "none touches" in error


def test_fasten_is_repeatable(capsys):
    words = ["--fasten", "arm-1", "post", "--fasten", "p*", "table", "--json"]
    code, out, _ = said(capsys, "check", lamp(), *words)
    assert code == 0
    assert len(json.loads(out)["joints"]) == 2


@pytest.mark.slow
@pytest.mark.parametrize("word", ["--fasten-suggested", "--fasten-overlaps"])
def test_what_overlaps_is_fastened_in_one_go_and_is_part_of_the_proof(word, capsys):
    file = lamp(gap=-0.5)
    assert main(["check", file]) != 0
    code, out, error = said(capsys, "check", file, word, "--proof", "p.json")
    assert code == 0
    assert error == ""  # the user requested the joint: no warning repeats it
    assert "Fastened by option: 1 pair\n  post  arm-1  overlap\n" in out
    proof = json.loads(Path("p.json").read_text())
    assert proof["options"] == {word[2:].replace("-", "_"): True}
    code, out, _ = said(capsys, "verify", file, "p.json")
    assert code == 0
    assert f"read with  {word[2:]}\n" in out
    del proof["options"][word[2:].replace("-", "_")]
    Path("q.json").write_text(json.dumps(proof))
    assert said(capsys, "verify", file, "q.json")[0] == 1


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("word", ["--fasten-suggested", "--fasten-overlaps"])
def test_every_command_joins_what_overlaps_and_goes_on_where_nothing_does(command, word, capsys):
    code, out, _ = said(capsys, command, lamp(gap=-0.5), word, "--json")
    assert code == 0
    answer = json.loads(out)
    assert answer["joints"] == [{"parts": ["post", "arm-1"], "kind": "fixed", "why": "overlap"}]
    assert not any("overlap" in text or "fasten" in text for text in answer["warnings"])
    code, out, _ = said(capsys, command, lamp(gap=5.0), word, "--json")
    assert code != 2
    answer = json.loads(out)
    assert answer["joints"] == []
    assert any(text.startswith("nothing is fastened") for text in answer["warnings"])


@pytest.mark.slow
@pytest.mark.parametrize("word", ["--fasten-suggested", "--fasten-overlaps"])
def test_python_joins_as_the_command_does(word, capsys):
    import kilter

    file = lamp(gap=-0.5)
    _, out, _ = said(capsys, "check", file, word, "--json")
    key = word.removeprefix("--fasten-")
    answer = kilter.check(kilter.fastened(kilter.load(file), **{key: True})).to_dict()
    told, known = json.loads(out), json.loads(json.dumps(answer))
    told.pop("seconds"), known.pop("seconds")
    assert told == known


@pytest.mark.quick(2)
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--fasten", "post"], "needs NAME NAME"),
        (["--fasten", "post", "--json"], "needs NAME NAME"),
        (["--fasten=post"], "needs NAME NAME"),
        (["--fasten", "pots", "arm-1"], "did you mean 'post'"),
        (["--fasten", "post", "screw*"], "no part is named 'screw*'"),
        (["--fasten", "table", "arm-1"], "none touches"),
        (["--fasten", "t*", "post"], "'t*' matches only held parts: 'table'; name a held part"),
        (["--fasten-suggested=yes"], "--fasten-suggested"),
        (["--fasten-overlap"], "--fasten-overlaps"),
        (["--clearance", "0"], "--clearance is 0"),
        (["--clearance", "-1"], "--clearance is -1"),
        (["--clearance", "nan"], "--clearance"),
        (["--gap", "-1"], "--gap"),
        (["--angle", "0"], "--angle"),
    ],
)
def test_wrong_options_are_refused(command, words, expected, capsys):
    assert expected in refused(capsys, command, lamp(), *words)


@pytest.mark.quick(1)
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("words", [["--gap", "0.3"], ["--loose", "--gap", "0.3"]])
def test_gap_closes_too(command, words, capsys):
    file = lamp(gap=0.2)
    code, out, _ = said(capsys, command, file, "--fasten", "arm-1", "post", *words, "--json")
    assert code == 0
    assert len(json.loads(out)["joints"]) == 1


@pytest.mark.slow
def test_clearance_is_in_the_proof_and_in_what_verify_says(capsys):
    file = lamp(gap=0.2)
    words = ["--fasten", "arm-1", "post", "--clearance", "0.3", "--proof", "p.json"]
    assert said(capsys, "check", file, *words)[0] == 0
    code, out, _ = said(capsys, "verify", file, "p.json")
    assert code == 0
    assert "clearances up to 0.3 mm counted as closed" in out
    code, out, _ = said(capsys, "contacts", file, "--clearance", "0.3")
    assert "clearances up to 0.3 mm counted as closed" in out
    code, out, _ = said(capsys, "check", file, "--clearance", "0.3", "--json")
    assert json.loads(out)["tolerance"]["clearance"] == 0.3


def test_gaps_are_shown_as_bars_with_their_sizes(capsys):
    code, out, _ = said(capsys, "contacts", lamp(gap=0.01))
    assert code == 0
    assert "Gaps of opposing faces" in out
    assert sum(set(line.split()[-1]) == {"#"} for line in out.splitlines() if line.split()) == 2
    assert "(sizes " in out
    assert " mm;" in out
    assert "gap above the tolerance" in out  # the near pair, and why it is rejected
    assert "gap 0.01 mm" in out


@pytest.mark.slow
def test_suggested_joints_can_be_pasted(capsys):
    code, out, _ = said(capsys, "check", lamp(), "--suggest-joints")
    assert code == 1
    assert "No pair looks fastened" in out
    code, out, _ = said(capsys, "check", lamp(), "--suggest-joints", "--json")
    assert json.loads(out)["suggested_joints"] == []
    code, out, _ = said(capsys, "check", lamp(), "--json")
    assert "suggested_joints" not in json.loads(out)


PINNED = {"kind": "revolute", "parts": ["post", "arm-1"], "point": [10, 0, 35], "axis": [0, 1, 0]}


@pytest.mark.slow
def test_joints_of_the_file_are_shown_and_missing_numbers_refused(capsys):
    code, out, _ = said(capsys, "check", lamp(joints=[PINNED]), "--json")
    assert code in (0, 1)
    assert json.loads(out)["joints"] == [{"parts": ["post", "arm-1"], "kind": "revolute"}]
    for key in ("point", "axis"):
        less = {name: value for name, value in PINNED.items() if name != key}
        error = refused(capsys, "check", lamp(joints=[less]))
        assert f"joints[0]: revolute joint of 'post' and 'arm-1' has no {key}" in error
        assert error.count(key) >= 2
    tilted = {**PINNED, "axis": [1, 0, 0]}
    error = refused(capsys, "check", lamp(joints=[tilted], planar=True))
    assert "revolute joint of 'post' and 'arm-1'" in error
    assert "turn about y" in error


def test_a_load_on_a_held_part_has_no_effect(capsys):
    load = {"part": "post", "force": [0, 0, -1]}
    file = lamp(loads=[load])
    assert said(capsys, "check", file)[0] == 1
    assert main(["check", str(file), "--ground", "post"]) == 1
    assert "loads on held parts, without effect: 'post'" in capsys.readouterr().err
    error = refused(capsys, "check", file, "--ground", "post", "--load", "post=0,0,-1")
    assert "part 'post': a load acts on a held part" in error
    error = refused(capsys, "check", lamp(loads=[{**load, "part": "table"}]))
    assert "part 'table'" in error
