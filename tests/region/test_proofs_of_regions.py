"""Every ray, line, facet and equation carries a proof that a stranger can verify."""

import json

import numpy as np
import pytest
from cones import KINDS, MORE, region_of

import kilter
from kilter.analysis.turning_tolerances import BEYOND_CONE
from kilter.analysis.verification import proof_tolerance, verify_proof
from kilter.contact import detect
from kilter.files import from_dict, to_dict
from kilter.scenes import rails, wedges


@pytest.mark.slow
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_proofs_pass_verify(name: str) -> None:
    region = region_of(name)
    proofs = region.proofs()
    assert len(proofs) == _count(region)
    for proof in proofs:
        assembly = from_dict(json.loads(json.dumps(to_dict(proof.assembly))))
        data = json.loads(json.dumps(proof.data, allow_nan=False))
        answer = verify_proof(
            assembly, detect.contacts(assembly, tolerance=proof_tolerance(data)), data
        )
        stable = proof.about in ("ray", "line")
        # on the boundary a part may stand exactly above an edge: the forces prove equilibrium
        at_limit = stable and answer.level == "equilibrium" and not answer.reasons
        assert answer.holds or at_limit, (proof.about, proof.vector, answer.reasons)
        assert answer.verdict == ("stable" if stable else "unstable")
        assert bool(region.contains(proof.assembly.down)) == stable


def _count(region) -> int:
    equations = len(region.equations) - region.assemblies[0].planar
    return len(region.rays) + 2 * len(region.lines) + len(region.facets) + 2 * equations


def test_the_motion_of_a_facet_is_its_normal() -> None:
    region = kilter.region(wedges.corner_wedges())
    for proof in region.found[0].proofs:
        if proof.about != "facet":
            continue
        assembly = region.assemblies[0]
        sum_of_motions = assembly.geometry.mass @ proof.certificate.motion[:, :3]
        sum_of_motions /= np.linalg.norm(sum_of_motions)
        assert np.allclose(sum_of_motions, -proof.vector, atol=1e-7)
        # just outside, by one of the steps: which one suffices depends on the solver's vertex
        beyond = -proof.vector @ proof.down
        assert any(step <= beyond < 1.1 * step for step in BEYOND_CONE[:3]), beyond


def test_facets_are_not_claimed_where_friction_may_hold() -> None:
    assembly = rails.railed("-x -z").with_friction(0.5)
    region = kilter.common_region([assembly])
    assert {proof.about for proof in region.proofs()} == {"ray"}
    assert any("left out: friction" in text for text in region.warnings)


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
def test_proofs_with_friction_are_verified(planar: bool) -> None:
    assembly = rails.railed("-z", planar=planar).with_friction(0.5)
    region = kilter.region(assembly, gap_deg=3.0)
    proofs = region.proofs()
    assert {proof.about for proof in proofs} >= {"ray", "facet"}
    assert region.proved
    for proof in proofs:
        assert verify_proof(proof.assembly, detect.contacts(proof.assembly), proof.data).holds
