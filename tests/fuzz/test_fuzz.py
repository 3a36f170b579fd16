"""A short round of the fuzzer, and what it found; ``python tests/fuzz/fuzz.py`` runs long ones."""

import copy
import json
import math
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fuzz_cases import EFFORT, KINDS
from fuzz_corpus import corpus
from fuzz_mutations import damaged
from fuzz_oracles import (
    faults_of_command,
    faults_of_loading,
    faults_of_proof,
    said,
    why_undecided,
)
from fuzz_scenes import random_scene
from transformations import scaled

import kilter
from kilter.scenes.pieces import moved

HERE = Path(__file__).parent
ROUND = {
    "files": 160, "scenes": 16, "options": 24, "proofs": 24,
    "formats": 152, "messages": 4, "tools": 22,
}  # fmt: skip
"""Cases of each kind."""
ENOUGH = 60.0
"""CPU time that such a round may take [s]."""


def fuzz(*words: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, HERE / "fuzz.py", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=280)


@pytest.mark.slow
def test_a_short_round_finds_no_fault_and_goes_on(tmp_path):
    log = tmp_path / "log.json"
    for part in (2, 1):
        asked = [word for kind in KINDS for word in (f"--{kind}", str(ROUND[kind] // part))]
        ended = fuzz("--log", log, *asked)
        assert (ended.returncode, ended.stderr) == (0, ""), ended.stdout + ended.stderr
        assert ended.stdout.splitlines()[-1].endswith(": 0 faults")
        kept = json.loads(log.read_text("utf-8"))
        assert kept["done"] == {k: ROUND[k] // part for k in KINDS}
        assert 0 < kept["cpu"] < ENOUGH


def scene_of(number: int) -> kilter.Assembly:
    """As the fuzzer makes it."""
    return random_scene(np.random.default_rng([KINDS.index("scenes"), number]))()


@pytest.mark.slow
def test_why_one_answer_is_undecided_has_a_name():
    """The masses of its parts are many orders apart: turned, they are proved to fall."""
    scene = scene_of(700649)
    undecided = kilter.check(scene, effort=EFFORT)
    assert undecided.verdict == "undecided"
    assert "with every possible contact, numerical errors prevent a proof" in undecided.sentence
    falls = kilter.check(moved(scene, [0.9, 0.1, 0.3, 0.3], [0, 0, 0]), effort=EFFORT)
    assert why_undecided(undecided, falls) == "masses far apart"
    left_out = kilter.check(kilter.Assembly(scene.parts[:1]), effort=EFFORT)
    assert why_undecided(undecided, left_out) == "another pair is open"
    blocks = [
        kilter.Part(name, kilter.Box([1, 1, 1]), kilter.Pose([x, 0, 0]), grounded=x == 0)
        for name, x in (("a", 0.0), ("b", 0.5))
    ]
    plain = kilter.check(kilter.Assembly(blocks))
    assert plain.verdict == "undecided"
    assert why_undecided(plain, plain) == ""  # nothing about it is far from usual


@pytest.mark.slow
def test_forces_beyond_the_squares_of_numbers_are_not_polished():
    """Scene 705427: a start of the search for motions had some; numpy warned."""
    assert kilter.check(scene_of(705427), effort=EFFORT).verdict != "unstable"


@pytest.mark.slow
def test_what_moves_is_told_without_a_warning_where_masses_are_far_apart():
    """Scene 700182: forces that a solver left at its end were beyond all numbers."""
    scene = scene_of(700182)
    for factor in (1.0, 1e-3, 1e2):
        verdict = kilter.check(scaled(scene, factor), effort=EFFORT)
        assert verdict.to_dict()["verdict"] in ("unstable", "undecided")
        assert any("masses differ" in warning for warning in verdict.warnings)


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted((HERE / "found").iterdir()), ids=lambda path: path.name)
def test_files_that_were_faults_once(path, tmp_path):
    copy = Path(shutil.copy(path, tmp_path))
    all_held, stands = ["--ground", "*"], ["--floor"]
    for command, *held in (
        ["check", *all_held],
        ["check", *stands],
        ["contacts", *all_held],
        ["region", *stands],
    ):
        assert faults_of_command([command, str(copy), *held])[1] == []
    assert faults_of_loading(copy, effort=0.2)[1] == []


@pytest.mark.slow
def test_an_arch_of_wedges_that_was_a_fault_once():
    """Nine prisms over a half circle, a fifth as thick as its radius: no cone had a size."""
    angle = np.linspace(0, np.pi, 10)
    ring = [radius * np.column_stack([np.cos(angle), np.sin(angle)]) for radius in (0.9, 1.1)]
    parts = []
    for k in range(9):
        corners = [ring[0][k], ring[1][k], ring[1][k + 1], ring[0][k + 1]]
        parts.append(kilter.Part(f"v{k}", kilter.Prism(corners, depth=0.3), grounded=k in (0, 8)))
    arch = kilter.Assembly(parts, friction=0.7)
    region = kilter.region(arch)
    assert region.kind == "cone"
    assert region.contains(arch.down)
    assert kilter.orient(arch).found


@pytest.mark.slow
def test_of_a_part_thinner_than_a_gap_no_share_is_told():
    """A sliver in a ball was refused in one frame: rounding was most of its volume."""
    ball = kilter.Part("ball", kilter.Sphere(0.03), pose=kilter.Pose([0.0, 0.0, 0.045]))
    for thick, refused in ((5e-11, False), (1e-3, True)):
        corners = [[0.0, 0.0], [thick, 0.0], [thick / 2, 0.05]]
        shape, pose = kilter.Prism(corners, depth=0.066), kilter.Pose([0.0, 0.0, 0.02])
        sliver = kilter.Part("sliver", shape, pose)
        shares = [one.share for one in kilter.contacts(kilter.Assembly([sliver, ball])).overlaps]
        assert any((share or 0.0) > 0.5 for share in shares) == refused


SMALL = {
    "sphere": kilter.Sphere,
    "cylinder": lambda radius: kilter.Cylinder(radius, 2 * radius),
    "box": lambda radius: kilter.Box([2 * radius] * 3),
}


@pytest.mark.slow
@pytest.mark.parametrize("shape", SMALL)
def test_a_part_that_rounding_is_larger_than_is_refused(shape):
    """One was called unstable, others ended with a warning of numpy."""
    floor = kilter.Part("floor", kilter.Box([1.0, 1.0, 1.0]), grounded=True)
    for radius in (1e-13, 1e-16, 1e-18):
        part = kilter.Part("small", SMALL[shape](radius), kilter.Pose([0.3, 0.2, 0.5 + radius]))
        assembly = kilter.Assembly([floor, part])
        if radius > 1e-14:
            assert kilter.check(assembly).verdict != "unstable"
            continue
        with pytest.raises(kilter.InputError, match=r"'small': its size is .*too small"):
            kilter.check(assembly)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(corpus()))
def test_a_whole_file_is_answered_and_its_damage_is_seeded(name, tmp_path):
    path = tmp_path / name
    path.write_bytes(corpus()[name])
    words = ["check", str(path), "--quiet", "--effort", "0.5"]
    if not name.endswith(("kilter.json", "urdf", "xml")):
        words.append("--floor")
    assert faults_of_command(words)[1] == []
    assert faults_of_proof(words, tmp_path / "proof.json")[1] == []
    assert (tmp_path / "proof.json").exists()
    seeds = [np.random.default_rng(k) for k in (*range(10), *range(10))]
    made = [damaged(name, corpus()[name], rng) for rng in seeds]
    assert made[:10] == made[10:]
    assert len(set(made) - {corpus()[name]}) >= 7


@pytest.fixture(scope="module")
def proved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """A tower, and the proofs of its region."""
    path = tmp_path_factory.mktemp("proved") / "tower.kilter.json"
    path.write_bytes(corpus()["tower.kilter.json"])
    said(["region", str(path), "--proof", str(path.with_name("proof.json"))])
    return path, json.loads(path.with_name("proof.json").read_text("utf-8"))


def test_a_proof_with_a_number_that_is_none_is_refused(proved, tmp_path):
    path, bundle = proved
    (tmp_path / "p.json").write_text(json.dumps({**bundle, "center": math.nan}), "utf-8")
    code, _, error = said(["verify", str(path), str(tmp_path / "p.json")])
    assert code == 2
    assert "it is no JSON" in error


def test_a_motion_that_leaves_a_part_out_does_not_prove_a_facet(proved):
    path, bundle = proved
    bundle = copy.deepcopy(bundle)
    facet = next(one for one in bundle["proofs"] if one["about"] == "facet")
    del facet["proof"]["motion"]["cube-2"]
    found = kilter.verify(path, bundle)
    assert not found.holds
    assert any("its motion leaves 'cube-2' out" in one for one in found.reasons)


def test_a_fault_is_seen(monkeypatch, tmp_path):
    import kilter.analysis.check

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("on purpose")

    path = tmp_path / "a.kilter.json"
    path.write_bytes(corpus()["tower.kilter.json"])
    monkeypatch.setattr(kilter.analysis.check, "check", broken)
    _, [fault] = faults_of_command(["check", str(path)])
    assert fault.startswith("exit 70")
    assert "ZeroDivisionError" in fault


@pytest.mark.slow
@pytest.mark.parametrize("how", ["hangs", "dies", "takes memory", "prints"])
def test_what_breaks_a_limit_is_seen(how, monkeypatch):
    import os

    import fuzz_worker

    def broken(*_: object) -> tuple[str, list[str]]:
        if how == "dies":
            os._exit(9)
        if how == "prints":
            os.write(2, b"a warning of a library\n")
        if how == "takes memory":
            return str(len(bytearray(3 << 30))), []
        while how == "hangs":
            pass
        return "ended", []

    monkeypatch.setattr(fuzz_worker, "case", broken)
    if how == "hangs":
        monkeypatch.setattr(fuzz_worker, "HANGS", 2.0)
    worker = fuzz_worker.Worker()
    _, [fault] = worker.run("files", 0)
    worker.end()
    said = {"hangs": "takes over", "dies": "exit 9", "takes memory": "takes over 2 GiB"}
    assert said.get(how, "a library printed") in fault
