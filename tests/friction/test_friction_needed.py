"""The share of friction that a patch needs, against closed forms and linear programs of many rays.

A torque T about the vertical axis on a square foot of half diagonal r needs T / (mu W r): all
corners are at the same distance. The resultant of its friction is zero.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck
from scipy.optimize import linprog

import kilter
from kilter.analysis.verdict.friction_share import PressedPatch, friction_shares
from kilter.assembly import Load
from kilter.tell.check_facts import forces_phrase

SIDES = 240
"""Rays of a friction cone in the linear programs; they lie inside the cone by 9e-5."""


@pytest.mark.parametrize("part", [0.3, 0.99])
def test_a_torque_needs_its_share_of_the_friction_torque(part: float) -> None:
    box = stack_on_deck([[0.6, 0.6, 0.4]], 0.5)
    weight = 9.81 * float(box.geometry.mass[1])
    torque = part * 0.5 * weight * 0.3 * 2**0.5
    turned = dataclasses.replace(box, loads=[Load("box-0", torque=[0, 0, torque])])
    verdict = kilter.check(turned, require="equilibrium")
    assert verdict.forces.utilisation == pytest.approx([part], abs=1e-6)
    words = forces_phrase(verdict.to_dict()["forces"])
    assert words is not None
    assert f"needs up to {100 * part:g} % of the friction" in words


def test_a_force_needs_its_share_of_the_friction_force() -> None:
    """Also a force beside the centre that turns: the pressures shift, the share stays."""
    box = stack_on_deck([[0.6, 0.6, 0.4]], 0.5)
    weight = 9.81 * float(box.geometry.mass[1])
    pushed = dataclasses.replace(box, loads=[Load("box-0", force=[0.8 * 0.5 * weight, 0, 0])])
    verdict = kilter.check(pushed, require="equilibrium")
    assert verdict.forces.utilisation == pytest.approx([0.8], abs=1e-6)


def random_patch(seed: int) -> PressedPatch:
    """Three to six points of a face, or of a bent face, with forces inside their cones."""
    rng = np.random.default_rng([7, seed])
    count = int(rng.integers(3, 7))
    normals = np.tile([0.0, 0.0, 1.0], (count, 1))
    if seed % 3 == 2:
        normals += 0.3 * rng.normal(size=(count, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
    points, mu = rng.normal(size=(count, 3)), float(rng.uniform(0.1, 1))
    push = rng.uniform(0, 1, count) * (rng.random(count) < 0.8) + 1e-3
    slip = np.cross(normals, rng.normal(size=(count, 3)))
    slip *= (mu * push * rng.uniform(0, 1, count) / np.linalg.norm(slip, axis=1))[:, None]
    none = np.zeros(count)
    return PressedPatch(points, normals, push[:, None] * normals + slip, mu, none, none)


def carries(patch: PressedPatch, share: float) -> bool:
    """Whether forces in cones of `share` times mu have the force and the moment of the patch."""
    columns, pushes = [], []
    for point, normal in zip(patch.points, patch.normals, strict=True):
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        for angle in 2 * np.pi * np.arange(SIDES) / SIDES:
            across = np.cos(angle) * first + np.sin(angle) * second
            ray = normal + share * patch.mu * across
            columns.append(np.append(ray, np.cross(point, ray)))
            pushes.append(1.0)
    wrench = np.append(patch.forces.sum(axis=0), np.cross(patch.points, patch.forces).sum(axis=0))
    most = np.einsum("ij,ij->", patch.forces, patch.normals) * (1 + 1e-7)
    found = linprog(
        np.zeros(len(columns)),
        A_ub=[pushes],
        b_ub=[most],
        A_eq=np.array(columns).T,
        b_eq=wrench,
    )
    return bool(found.status == 0)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 40, 10))
def test_no_smaller_share_carries_the_patch(first: int) -> None:
    patches = [random_patch(seed) for seed in range(first, first + 10)]
    for patch, share in zip(patches, friction_shares(patches), strict=True):
        assert 0 < share <= 1
        assert carries(patch, share * (1 + 2e-4))
        assert not carries(patch, share * (1 - 1e-4))
