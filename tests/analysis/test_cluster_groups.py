"""Large programs are solved group by group of their clusters: the answer is that of the whole."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import judged

import kilter
from kilter import Assembly, Part, Pose
from kilter.analysis.decision.judge import judge
from kilter.analysis.verdict.displacement import LIMIT, find_displacement
from kilter.contact import contacts
from kilter.mechanics import clusters as groups
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import Program, build_program
from kilter.shape.primitives import Box

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def towers(count: int, *, height: int = 3, hanging: int | None = None) -> Assembly:
    """Towers of boxes side by side on a plate; the top box of the tower `hanging` tips."""
    parts = [Part("plate", Box([4 * count, 4, 1]), Pose([2 * count, 0, -0.5]), grounded=True)]
    for k in range(count):
        for level in range(height):
            off = 0.8 if k == hanging and level == height - 1 else 0.1 * level
            place = [4 * k + 2 + off, 0.05 * level, 0.5 + level]
            parts.append(Part(f"t{k}-{level}", Box([1, 1, 1]), Pose(place)))
    return Assembly(parts)


def program_of(assembly: Assembly) -> Program:
    return build_program(assembly, contacts(assembly))


@pytest.fixture
def parted(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Divide programs of any size, into groups of two towers at most."""
    monkeypatch.setattr(groups, "PARTED", 0)
    monkeypatch.setattr(groups, "GROUP", 40)
    return monkeypatch


def test_groups_divide_the_free_parts_and_the_rows(parted: pytest.MonkeyPatch) -> None:
    program = program_of(towers(7))
    divided = groups.cluster_groups(program)
    assert [int(group.program.free.sum()) for group in divided] == [6, 6, 6, 3]
    free = np.sum([group.program.free for group in divided], axis=0)
    assert free.tolist() == program.free.astype(int).tolist()
    rows = np.concatenate([group.rows for group in divided])
    assert np.sort(rows).tolist() == list(range(len(program.part_a)))
    parted.setattr(groups, "GROUP", 10)  # a cluster is never divided
    assert [int(g.program.free.sum()) for g in groups.cluster_groups(program)] == [3] * 7
    parted.setattr(groups, "PARTED", 6 * 21)
    assert len(groups.cluster_groups(program)) == 1


@pytest.mark.parametrize("hanging", [None, 0, 6])
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_the_judgement_of_groups_is_that_of_the_whole(
    hanging: int | None, mu: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = program_of(towers(7, hanging=hanging).with_friction(mu))
    whole = judge(program)
    monkeypatch.setattr(groups, "PARTED", 0)
    monkeypatch.setattr(groups, "GROUP", 40)
    parts = judge(program)
    assert parts.stable is whole.stable is (hanging is None)
    if parts.stable:
        assert parts.forces is not None
        assert check_forces(program, parts.forces.forces, parts.forces.friction).holds
    else:
        assert parts.motion is not None
        assert check_motion(program, parts.motion.motion).holds
        moving = np.flatnonzero(np.abs(parts.motion.motion).max(axis=1) > 1e-9)
        tower = 3 * (hanging or 0)
        assert set(moving.tolist()) <= set(range(tower + 1, tower + 7))  # parts of one group


@pytest.mark.parametrize("hanging", [None, 2])
def test_the_displacement_program_adds_up(
    hanging: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = program_of(towers(6, hanging=hanging))
    whole = find_displacement(program)
    monkeypatch.setattr(groups, "PARTED", 0)
    monkeypatch.setattr(groups, "GROUP", 40)
    parts = find_displacement(program)
    assert parts.z == pytest.approx(whole.z, rel=1e-7, abs=1e-9)
    assert parts.displacement is not None
    assert whole.displacement is not None
    np.testing.assert_allclose(parts.displacement, whole.displacement, atol=1e-5)


def test_a_capacity_shared_by_clusters_is_not_divided(parted: pytest.MonkeyPatch) -> None:
    program = program_of(towers(3))
    capacity = np.full(len(program.part_a), np.inf)
    capacity[0] = 1.0
    assert len(groups.cluster_groups(program)) > 1
    assert len(groups.cluster_groups(program.with_rows(capacity=capacity))) == 1


def test_one_tower_of_many_falls() -> None:
    assembly = towers(LIMIT // 3 + 1, hanging=40)
    verdict = judged(assembly)
    assert verdict.verdict == "unstable"
    moving = zip(assembly.names, verdict.motion.moves, strict=True)
    assert "t40-2" in {name for name, moves in moving if moves} <= {f"t40-{k}" for k in range(3)}
    assert verdict.displacement.displacement is None
    assert verdict.displacement.z is not None
    alone = kilter.check(towers(1, hanging=0))
    assert verdict.displacement.z == pytest.approx(alone.displacement.z, rel=1e-6)


@pytest.fixture
def frames(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of the benchmark of bolted frames."""
    pytest.importorskip("OCP", reason="needs kilter[step]")
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    monkeypatch.setattr(sys, "path", [*sys.path])
    return importlib.import_module("cad_frames")


@pytest.mark.slow
@pytest.mark.parametrize("linked", [False, True], ids=["apart", "linked"])
def test_bolted_frames_need_their_nuts(linked: bool, frames: Any, tmp_path: Path) -> None:
    file = frames.write_frames(300, 1, tmp_path / "frames.step", linked=linked)
    assembly = kilter.load(file, ground="base")
    assert len(assembly.parts) == 309 + 4 * linked
    verdict = kilter.check(assembly)
    pairs = zip(assembly.names, verdict.motion.moves, strict=True)
    moving = {name for name, moves in pairs if moves}
    assert verdict.verdict == "unstable"
    assert {name.split("/")[-1] for name in moving} == {"nut", "washer_2"}
    assert [r.option for r in verdict.remedies if r.leads_to == "stable"] == ["--fasten-suggested"]
