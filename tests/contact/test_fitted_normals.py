"""Fitted normals in orient, region and margin: no friction is counted above their error."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from test_smooth_joints import made, with_exact_normals

import kilter
from kilter.analysis.verification import verify
from kilter.mechanics.program import build_program
from kilter.rigid import Pose

SHARED = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "compas_cra"
LEANT = [0.1, 0.05, -1.0]


def both(seed, mu):
    """An assembly on a curved joint; its detected contacts, and those with the exact normals."""
    joint, assembly, _ = made(seed)
    assembly = assembly.with_friction(mu)
    found = kilter.contacts(assembly)
    return assembly, found, with_exact_normals(found, joint, Pose())


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_without_friction_no_direction_is_called_stable(seed):
    assembly, found, exact = both(seed, 0.0)
    region = kilter.region(assembly, contacts=found)
    assert region.kind == "none"
    assert not region.exact
    assert not region.none
    assert any("'below' and 'above'" in text for text in region.warnings)
    assert kilter.orient(assembly, contacts=found).verdict == "undecided"
    # one number flipped: normals in no doubt
    assert kilter.region(assembly, contacts=exact).kind in ("fan", "cone")
    assert kilter.orient(assembly, contacts=exact).found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 4])
def test_the_least_friction_is_that_of_exact_normals_and_their_doubt_more(seed):
    assembly, found, exact = both(seed, 0.0)
    leant, doubt = assembly.with_down(LEANT), float(found.patch_doubt.max())
    margin = kilter.margin(leant, contacts=found)
    assert margin.tilt_deg is None
    assert not margin.to_dict()["exact"]
    assert any("'below' and 'above'" in text for text in margin.warnings)
    true = kilter.margin(leant, contacts=exact).friction
    assert true < margin.friction < true + 2.5 * doubt
    proof = json.loads(json.dumps(margin.proof()))
    assert "friction" in {entry["about"] for entry in proof["proofs"] if entry["held"]}
    assert verify(leant, proof).holds


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 4])
@pytest.mark.parametrize("above", [False, True])
def test_a_contact_counts_where_friction_is_above_its_doubt(seed, above):
    _, assembly, _ = made(seed)
    doubt = float(kilter.contacts(assembly).patch_doubt.max())
    assembly = assembly.with_friction(doubt * (1.01 if above else 0.99))
    found = kilter.contacts(assembly)
    assert bool(len(build_program(assembly, found).kind)) == above
    assert len(build_program(assembly, found, fitted=True).kind) == len(found.points)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_with_friction_what_is_held_is_held_with_exact_normals(seed):
    assembly, found, exact = both(seed, 0.3)
    doubt = float(found.patch_doubt.max())
    fitted, true = (kilter.region(assembly, contacts=c) for c in (found, exact))
    assert not fitted.exact
    assert true.contains(fitted.rays, margin=-doubt).all()
    less = kilter.region(assembly, contacts=exact.with_friction(0.3 - 3 * doubt))
    assert fitted.contains(less.rays, margin=-doubt).all()
    proof = json.loads(json.dumps(fitted.proof()))
    assert verify(assembly, proof).holds


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="the real assemblies are not here")
def test_curved_blocks_of_a_library_have_no_direction_without_friction():
    """On the interfaces of their file they slide along x below mu about .051."""
    assembly = kilter.load(SHARED / "curve-3-blocks.json").with_grounded(["0"]).with_friction(0)
    found = kilter.contacts(assembly)
    assert kilter.region(assembly, contacts=found).kind == "none"
    assert kilter.orient(assembly, contacts=found).verdict == "undecided"
    margin = kilter.margin(assembly, contacts=found)
    assert margin.tilt_deg is None
    assert not margin.to_dict()["exact"]
    assert margin.friction is not None
    assert margin.friction > 0.03
    assert np.all(found.patch_doubt > 0)
