"""Properties of every assembly with friction, on random assemblies."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from judged import judged
from random_friction import random_assembly

from kilter import check
from kilter.assembly import FrictionPair
from kilter.contact import detect
from kilter.friction.exclusion import prove_no_motion
from kilter.friction.seating import find_seating
from kilter.mechanics.program import build_program

SEEDS = range(20)
EFFORT = 0.5


def rougher(assembly, factor):
    """The assembly with every coefficient raised."""
    pairs = [FrictionPair(pair.parts, factor * pair.mu) for pair in assembly.friction_pairs]
    contacts = [
        dataclasses.replace(c, mu=None if c.mu is None else factor * c.mu)
        for c in assembly.contacts
    ]
    return dataclasses.replace(
        assembly,
        friction=factor * assembly.friction,
        friction_pairs=pairs,
        contacts=contacts,
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_verdict_and_its_opposite_never_both(seed):
    _, assembly = random_assembly(seed)
    verdict = judged(assembly, effort=EFFORT)
    assert verdict.verdict != "undecided"
    if verdict.friction is None:
        return
    if verdict.guarantee == "proved":
        assert find_seating(verdict.program).holds
    if verdict.guarantee == "refuted":
        witness = verdict.friction.witness
        assert witness.law.holds
        # a.M a <= w.a for every solution of the law, in units of |w|^2 of the parts that move
        assert witness.law.size <= witness.law.power * (1 + 1e-6) + 1e-9
        assert not prove_no_motion(verdict.program, work=EFFORT).proved


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_more_friction_never_takes_equilibrium_away(seed):
    _, assembly = random_assembly(seed)
    words = [check(rougher(assembly, f), effort=0).verdict for f in (0.0, 0.5, 1.0, 2.0)]
    held = [word in ("stable", "settles", "potentially-stable") for word in words]
    assert held == sorted(held)
    if words[0] == "stable":
        assert set(words) == {"stable"}


@pytest.mark.slow
def test_forces_shown_balance_and_stay_in_their_cones():
    for seed in SEEDS[:20]:
        _, assembly = random_assembly(seed)
        verdict = check(assembly, effort=0)
        if verdict.level is None:
            continue
        found = verdict.forces
        program = build_program(assembly, detect.contacts(assembly))
        mu = verdict.program.mu[found.rows]
        normal = verdict.program.normal[found.rows]
        push = np.einsum("ij,ij->i", found.force, normal)
        aside = np.linalg.norm(found.force - push[:, None] * normal, axis=1)
        assert (push >= 0).all()
        assert (aside <= mu * push + 1e-9 * np.abs(push) + 1e-12).all()
        assert found.residual <= float(program.tolerance.max())
        assert np.nanmax(found.utilisation, initial=0.0) <= 1 + 1e-6
