"""Bonds against a program written apart, and motions beside them."""

from __future__ import annotations

import numpy as np
import pytest
from random_bonded import random_bonded
from scipy.optimize import linprog

import kilter
from kilter import Assembly, Bond, Box, Part, Pose
from kilter.analysis.decision.judge import judge
from kilter.mechanics.program import build_program
from kilter.mechanics.rows import BONDED

STEPS = np.vstack([np.eye(3), -np.eye(3)])
SIDES = 24


def cluster(seed, mu=None, limited=0.0):
    """A random cluster of unit cubes with random densities around a held cube; most pairs bonded.

    `limited`: number of bonds whose shear is limited by a force.
    """
    random = np.random.default_rng(seed)
    cells = [np.zeros(3)]
    while len(cells) < random.integers(4, 9):
        grown = cells[random.integers(len(cells))] + STEPS[random.integers(6)]
        if not any((grown == cell).all() for cell in cells):
            cells.append(grown)
    sizes = [1.0, 2.0, 0.5] * np.ones((len(cells), 3))
    parts = [
        Part(
            f"p{k}",
            Box(size),
            Pose(cell * size),
            grounded=k == 0,
            density=random.uniform(300, 3000),
        )
        for k, (cell, size) in enumerate(zip(cells, sizes, strict=True))
    ]
    bonds = []
    for a in range(len(cells)):
        for b in range(a + 1, len(cells)):
            if np.abs(cells[a] - cells[b]).sum() == 1 and random.random() < 0.9:
                shear = "mu" if mu is not None and random.random() < 0.4 else None
                pull = float(10 ** random.uniform(4, 5))
                if limited and random.random() < limited:
                    pull *= float(random.random() < 0.95)
                    shear = float(10 ** random.uniform(4, 6))
                bonds.append(Bond((f"p{a}", f"p{b}"), pull=pull, shear=shear))
    down = random.normal(size=3)
    gravity = 9.81 * down / np.linalg.norm(down)
    return Assembly(parts, gravity=gravity, friction=mu or 0.0, bonds=bonds)


def least_share(assembly, contacts, stretch=1.0):
    """The least s, or None if no s suffices; `stretch`: factor on the radius of the pyramids."""
    geometry, bonds = assembly.geometry, assembly.bonds
    of_pair = {frozenset(assembly.index_of(n) for n in bond.parts): bond for bond in bonds}
    free = np.flatnonzero(~geometry.grounded)
    place = {part: 6 * k for k, part in enumerate(free)}
    load = np.zeros(6 * len(free))
    for part in free:
        load[place[part] :][:3] = geometry.mass[part] * assembly.gravity
    scale = np.abs(load).max()
    columns, low, clamp, discs = [], [], np.zeros(6 * len(free)), []
    patch = np.repeat(np.arange(len(contacts.patch_parts)), np.diff(contacts.patch_start))

    def wrench(a, b, point, force):
        column = np.zeros(6 * len(free))
        for part, sign in ((a, -1.0), (b, 1.0)):
            if part in place:
                arm = point - geometry.center[part]
                column[place[part] :][:6] = np.append(sign * force, np.cross(arm, sign * force))
        return column

    for point, normal, own in zip(contacts.points, contacts.normals, patch, strict=True):
        a, b = contacts.patch_parts[own]
        bond = of_pair.get(frozenset((int(a), int(b))))
        u = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        u /= np.linalg.norm(u)
        v = np.cross(normal, u)
        if bond is not None:
            clamp -= bond.pull * wrench(a, b, point, normal)
        angle = 2 * np.pi * np.arange(SIDES) / SIDES
        around = np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)
        if bond is not None and bond.shear is None:
            rays, ends = [normal, u, v], [0.0, -np.inf, -np.inf]
        elif bond is not None and isinstance(bond.shear, float):
            # corners of a polygon, with shares whose sum is at most s
            rays, ends = [normal, *(bond.shear / scale * stretch * around)], [0.0] * (1 + SIDES)
            discs.append(range(len(columns) + 1, len(columns) + 1 + SIDES))
        else:
            rays = list(normal + assembly.friction * stretch * around)
            ends = [0.0] * SIDES
        columns += [wrench(a, b, point, ray) for ray in rays]
        low += ends
    sums = np.zeros((len(discs), len(columns) + 1))
    for row, disc in zip(sums, discs, strict=True):
        row[list(disc)], row[-1] = 1.0, -1.0
    answer = linprog(
        np.append(np.zeros(len(columns)), 1.0),
        A_ub=sums if discs else None,
        b_ub=np.zeros(len(discs)) if discs else None,
        A_eq=np.column_stack([*columns, clamp / scale]),
        b_eq=-load / scale,
        bounds=[*((end, None) for end in low), (0, None)],
    )
    return answer.x[-1] if answer.status == 0 else None


def agrees(seed, mu, limited=0.0):
    assembly = cluster(seed, mu, limited)
    found = kilter.margin(assembly, pushed=[], effort=0)
    contacts = kilter.contacts(assembly)
    most = least_share(assembly, contacts)
    exact = mu is None and not limited
    least = most if exact else least_share(assembly, contacts, 1 / np.cos(np.pi / SIDES))
    if least is None:
        assert found.missing["bond"] == "none"
        assert found.verdict in ("unstable", "undecided")
        return "none"
    share = found.bond
    assert "bond" not in found.missing
    assert share >= least * (1 - 1e-6) - 1e-9
    assert most is None or share <= most * (1 + 1e-6) + 1e-9
    if found.verdict != "undecided":  # contacts of parallel edges may leave it undecided
        assert abs(share - 1) < 1e-6 or (found.verdict == "unstable") is (share > 1)
    return "falls" if share > 1 else "stands" if share > 0 else "needs none"


@pytest.mark.slow
@pytest.mark.parametrize("mu", [None, 0.6])
def test_a_program_written_apart_agrees(mu):
    seen = {agrees(seed, mu) for seed in range(8)}
    assert {"falls", "stands"} <= seen


@pytest.mark.slow
@pytest.mark.parametrize("mu", [None, 0.6])
def test_a_program_written_apart_agrees_where_shear_is_limited_by_a_force(mu):
    seen = {agrees(seed, mu, limited=0.7) for seed in range(8)}
    assert {"falls", "stands"} <= seen


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(6))
def test_no_pull_and_shear_by_friction_is_a_contact_with_that_friction(seed):
    """A higher strength never destabilises."""
    whole = cluster(seed, 0.6)
    plain = Assembly(whole.parts, gravity=whole.gravity, friction=0.6)
    contacts = kilter.contacts(plain)
    held = [judge(build_program(plain, contacts)).stable]
    for pull in (0.0, 1e3, 1e4, 1e9):
        bonds = [Bond(bond.parts, pull=pull, shear="mu") for bond in whole.bonds]
        bonded = Assembly(whole.parts, gravity=whole.gravity, friction=0.6, bonds=bonds)
        held.append(judge(build_program(bonded, contacts.of(bonded))).stable)
    assert None not in held
    assert held[0] == held[1]
    assert held == sorted(held)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(4))
def test_a_very_strong_bond_is_a_fixed_joint(seed):
    whole = cluster(seed)
    strong = [Bond(bond.parts, pull=1e9) for bond in whole.bonds]
    joined = [kilter.Joint(bond.parts) for bond in whole.bonds]
    one = Assembly(whole.parts, gravity=whole.gravity, bonds=strong)
    other = Assembly(whole.parts, gravity=whole.gravity, joints=joined)
    assert kilter.check(one).verdict == kilter.check(other).verdict


@pytest.mark.slow
@pytest.mark.parametrize("seed", [297])
def test_the_motion_beside_bonds_with_any_shear_is_verified(seed: int) -> None:
    assembly = random_bonded(seed).assembly
    verdict = kilter.check(assembly)
    assert verdict.why == "refuted"
    assert (verdict.program.kind == BONDED).any()
    proof = verdict.proof()
    assert kilter.verify(assembly, proof).holds
    proof["friction"]["witness"]["bonds"][0][0] += 1.0
    assert not kilter.verify(assembly, proof).holds
