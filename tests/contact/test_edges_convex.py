"""Edges and corners of convex bodies that touch by construction, against a brute-force oracle."""

from __future__ import annotations

import numpy as np
import pytest
from edge_oracle import Convex, contacts, stacked

from kilter import Assembly, Mesh, Part
from kilter.contact import detect
from sampled import sampled

KINDS = ("vertex-face", "edge-face", "edge-edge")
SEEDS = sampled(1, [range(8), range(8, 20)])


def assembly_of(a: Convex, b: Convex) -> Assembly:
    parts = [
        Part(n, Mesh(x.corners, x.triangles), grounded=n == "a") for n, x in (("a", a), ("b", b))
    ]
    return Assembly(parts)


def compared(kind: str, gap: float, tilt: float, seed: int, *, swap: bool = False) -> list[str]:
    """Differences between the contacts of the search and those of the oracle."""
    a, b = stacked(kind, gap, tilt, np.random.default_rng(seed))
    if swap:
        a, b = b, a
    assembly = assembly_of(a, b)
    found = detect.contacts(assembly)
    size = float(assembly.geometry.size.min())
    expected = contacts(a, b, 1e-5 * size)
    wrong = []
    if len(found.degenerate):
        wrong.append("degenerate")
    if found.patch_kind.tolist() != [kind] or len(expected) != 1:
        return [*wrong, f"{found.patch_kind} for {len(expected)} of {kind}"]
    points, normal = expected[0].points, expected[0].normal
    if len(found.points) != len(points):
        return [*wrong, f"{len(found.points)} points for {len(points)}"]
    apart = np.linalg.norm(found.points[:, None] - points[None], axis=2)
    if (
        apart.min(axis=1).max() > 1e-7 * size + (2 * gap if tilt else 0)
        or (apart.min(axis=0)).max() > 1e-5 * size
    ):
        wrong.append(f"points off by {apart.min(axis=1).max():.1e}")
    if np.abs(found.normals - normal).max() > 1e-9 + (1e-3 if tilt else 0):
        wrong.append(f"normal off by {np.abs(found.normals - normal).max():.1e}")
    if not tilt and np.abs(found.patch_gap - gap).max() > 1e-11:
        wrong.append(f"gap {found.patch_gap} for {gap}")
    return wrong


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-7, 1e-6])
@pytest.mark.parametrize("seeds", SEEDS)
def test_contact_is_found_and_no_other(kind, gap, seeds):
    wrong = {}
    for seed in seeds:
        answer = compared(kind, gap, 0.0, seed, swap=bool(seed % 2))
        if answer:
            wrong[seed] = answer
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tilt", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("seeds", SEEDS)
def test_tilted_contact_is_found_and_no_other(kind, tilt, seeds):
    wrong = {seed: answer for seed in seeds if (answer := compared(kind, 1e-7, tilt, seed))}
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("gap", [2e-5, 1e-3])
def test_nothing_is_found_across_a_gap(kind, gap):
    for seed in range(20):
        a, b = stacked(kind, 2 * gap, 0.0, np.random.default_rng(seed))
        found = detect.contacts(assembly_of(a, b))
        assert len(found) == 0
        assert found.unsupported == ()
