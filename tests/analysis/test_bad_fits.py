"""Assemblies that fit badly, with light and heavy parts: each is proved, by forces or a motion."""

from __future__ import annotations

import numpy as np
import pytest
from random_fits import random_fit

from kilter.analysis.decision import judge as judging
from kilter.analysis.decision.judge import Judgement, judge
from kilter.mechanics.mechanics_tolerances import RULED_OUT
from kilter.mechanics.program import Program
from sampled import sampled

SEEDS, BLOCK = 200, 10


def proves_by_matrix(program: Program, judgement: Judgement) -> bool:
    """Recheck the proof of a judgement by the matrix J alone, not by the certificate."""
    rows, per = program.jacobian(), len(program.freedoms)
    radius = np.where(np.arange(6) < 3, 1.0, program.radius[program.free, None])
    load = program.load[program.free]
    if judgement.stable:
        forces = judgement.forces.forces
        assert (forces[~program.two_sided] >= 0.0).all()
        rest = ((rows.T @ forces).reshape(-1, per) + load) / radius
        rounded = 1e-14 * program.force_sums(forces)[program.free, None]
        return bool((np.abs(rest) <= 2e-9 * program.weight[program.free, None] + rounded).all())
    motion = judgement.motion.motion[program.free]
    opening = rows @ motion.reshape(-1)
    violation = np.where(program.two_sided, np.abs(opening), -opening).max(initial=0.0)
    moving = np.abs(motion * radius).max(axis=1) > 0.0
    power = (load * motion).sum()
    weight = program.weight[program.free][moving].max()
    return bool(power > 0.0 and power >= RULED_OUT * violation * weight)


@pytest.mark.parametrize("start", sampled(1, range(0, SEEDS, BLOCK)))
def test_each_assembly_with_a_bad_fit_is_proved(start: int) -> None:
    for seed in range(start, start + BLOCK):
        program = random_fit(seed)
        judgement = judge(program)
        assert judgement.stable is not None, (seed, judgement)
        assert proves_by_matrix(program, judgement), seed


@pytest.mark.parametrize("seed", sampled(3, 40))
def test_rounded_rows_alone_prove_the_same(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    program = random_fit(seed)
    known = judge(program).stable
    monkeypatch.setattr(judging, "_by_load_factor", lambda *_, **__: iter(()))
    monkeypatch.setattr(judging, "_by_equilibrium", lambda *_: iter(()))
    rounded = judging._by_rounded_rows
    monkeypatch.setattr(
        judging, "_candidates_without_friction",
        lambda program, work: rounded(judging.scaled_problem(program), work),
    )  # fmt: skip
    assert judge(program).stable is known
