"""The proof of a motion that refutes friction has the forces of bonds that carry any shear."""

import pytest
from random_bonded import random_bonded

import kilter
from kilter.mechanics.rows import BONDED


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
