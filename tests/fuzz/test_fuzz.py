"""A short round of the fuzzer; ``python tests/fuzz/fuzz.py`` runs long ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fuzz_corpus import corpus
from fuzz_mutations import damaged
from fuzz_oracles import faults_of_command, faults_of_proof

from fuzz import KINDS, Worker

ROUND = {"files": 60, "scenes": 20}
"""Cases of each kind."""


@pytest.mark.parametrize("kind", KINDS)
def test_a_short_round_finds_no_fault(kind: str) -> None:
    worker = Worker()
    found = [f"{kind}:{k} {fault}" for k in range(ROUND[kind]) for fault in worker.run(kind, k)]
    worker.end()
    assert found == []


@pytest.mark.parametrize("number", [5254, 5285], ids=["crash in OCCT", "faces inside out"])
def test_cases_that_were_faults_once(number: int) -> None:
    worker = Worker()
    assert worker.run("files", number) == []
    worker.end()


@pytest.mark.parametrize("name", sorted(corpus()))
def test_a_whole_file_is_answered_and_its_damage_is_seeded(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(corpus()[name])
    words = ["check", str(path), "--quiet", "--effort", "0.5"]
    if not name.endswith("kilter.json"):
        words.append("--floor")
    assert faults_of_command(words) == []
    assert faults_of_proof(words, tmp_path / "proof.json") == []
    assert (tmp_path / "proof.json").exists()
    first, again = (damaged(name, corpus()[name], np.random.default_rng(7)) for _ in range(2))
    assert first == again != corpus()[name]


def test_a_fault_is_seen(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import kilter.analysis.check

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("on purpose")

    path = tmp_path / "a.kilter.json"
    path.write_bytes(corpus()["tower.kilter.json"])
    monkeypatch.setattr(kilter.analysis.check, "check", broken)
    [fault] = faults_of_command(["check", str(path)])
    assert fault.startswith("exit 70")
    assert "ZeroDivisionError" in fault
