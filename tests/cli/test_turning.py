"""The commands about turning: orient and region."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.cli import main
from kilter.rigid import quaternion_to_matrix
from kilter.scenes import scene

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def written(name: str) -> str:
    kilter.dump(scene(name), f"{name}.json")
    return f"{name}.json"


def answered(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, dict]:
    capsys.readouterr()
    code = main([*words, "--json"])
    out, error = capsys.readouterr()
    assert error == ""
    return code, json.loads(out)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper-figure-1", "paper-figure-11", "corner-wedges", "tower"])
def test_the_orientation_found_is_stable_and_its_turn_leads_there(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = written(name)
    code, answer = answered(capsys, "orient", file)
    assert code == 0
    assert answer["found"]
    down = [repr(x) for x in answer["down"]]
    assert main(["check", file, "--down", *down, "--quiet"]) == 0
    turned = quaternion_to_matrix(answer["rotation"]) @ answer["down"]
    assert turned == pytest.approx(scene(name).down, abs=1e-12)


@pytest.mark.slow
def test_where_nothing_is_stable_the_nearest_is_given_with_what_moves(
    capsys: pytest.CaptureFixture[str],
) -> None:
    code, answer = answered(capsys, "orient", written("floating-block"))
    assert code == 1
    assert not answer["found"]
    assert set(answer["nearest"]) == {"diamond", "sphere", "kappa"}
    assert any(part["moves"] for part in answer["parts"])
    assert main(["orient", "floating-block.json", "--quiet"]) == 1
    assert "No orientation is stable" in capsys.readouterr().out


@pytest.mark.slow
def test_friction_that_can_hold_it_is_found_and_said_to_be_no_guarantee(
    capsys: pytest.CaptureFixture[str],
) -> None:
    code, answer = answered(capsys, "orient", written("arch"), "--method", "walk")
    assert (code, answer["verdict"], answer["method"]) == (0, "found", "walk")
    assert answer["sentence"].startswith("Forces that hold it exist")
    assert "kilter check --down" in answer["sentence"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("paper-figure-10", "fan"),
        ("tower", "ray"),
        ("corner-wedges", "cone"),
        ("floating-block", "none"),
    ],
)
def test_region_in_words_and_as_data(
    name: str, kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = written(name)
    assert main(["region", file, "--quiet"]) == 0
    assert f"{kind}, dimension" in capsys.readouterr().out
    code, answer = answered(capsys, "region", file)
    assert (code, answer["kind"], answer["exact"]) == (0, kind, True)
    for ray in answer["rays"]:
        assert all(np.dot(q, ray) >= -1e-9 for q in answer["facets"])
        assert all(abs(np.dot(q, ray)) <= 1e-9 for q in answer["equations"])


@pytest.mark.slow
def test_a_region_common_to_several_lies_in_each(capsys: pytest.CaptureFixture[str]) -> None:
    files = [written("paper-figure-10"), written("paper-figure-11")]
    _, answer = answered(capsys, "region", *files, "--common")
    assert answer["kind"] == "ray"
    assert answer["rays"][0] == pytest.approx([-(0.5**0.5), 0, -(0.5**0.5)], abs=1e-9)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["orient", "books.json"], "load"),
        (["region", "books.json"], "load"),
        (["region", "tower.json", "tower.json"], "--common"),
        (["orient", "tower.json", "--method", "guess"], "joint"),
        (["orient", "nope.json"], "no such file"),
        (["region"], "FILE"),
    ],
)
def test_wrong_usage(words: list[str], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    written("books"), written("tower")
    assert main(words) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert expected in error


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="the folder of real assemblies is not there")
@pytest.mark.parametrize(
    ("file", "held", "kind"),
    [("cubes", ["0"], "ray"), ("H", ["0", "1"], "line"), ("type-a", ["0", "1"], "fan")],
)
def test_real_assemblies(
    file: str, held: list[str], kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(SHARED / "compas_cra" / f"{file}.json")]
    words += [w for name in held for w in ("--ground", name)]
    _, answer = answered(capsys, "region", *words)
    assert answer["kind"] == kind
