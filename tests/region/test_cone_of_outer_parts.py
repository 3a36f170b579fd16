"""The cone of a few outer parts is that of a large pile, if forces hold the pile along it."""

import numpy as np
import pytest

from kilter import Assembly, Box, Part, Pose
from kilter.analysis.regions import stable_cone as cones
from kilter.contact import contacts
from kilter.mechanics.certificate import MotionProof
from kilter.mechanics.program import Program, build_program
from kilter.scenes.random_bricks import box_pile
from kilter.scenes.walls import wall_of


def program_of(assembly: Assembly) -> Program:
    """The program of an assembly without friction."""
    return build_program(assembly, contacts(assembly)).frictionless


@pytest.mark.parametrize("assembly", [box_pile(40, cells=7), wall_of(40)], ids=["pile", "wall"])
def test_the_cone_of_outer_parts_is_that_of_all(assembly, monkeypatch):
    program = program_of(assembly)
    quick = cones.stable_cone(program)
    monkeypatch.setattr(cones, "FEW_PARTS", 99)
    whole = cones.stable_cone(program)
    assert quick.cone.kind == whole.cone.kind == "ray"
    assert np.allclose(quick.cone.rays, whole.cone.rays)
    assert quick.proved
    assert len(quick.proofs) == len(whole.proofs) == 6
    motions = [p.certificate.motion for p in quick.proofs if isinstance(p.certificate, MotionProof)]
    assert max(np.count_nonzero(motion.any(axis=1)) for motion in motions) <= 5


@pytest.mark.parametrize(("beyond", "kind"), [(False, "ray"), (True, "none")])
def test_a_part_with_a_wider_cone_does_not_decide(beyond, kind, monkeypatch):
    """The highest box stands by itself; another one hangs over the edge of its support."""
    monkeypatch.setattr(cones, "FEW_PARTS", 2)
    base = Part("base", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    edge = Part("edge", Box([1, 1, 1]), Pose([2.2 if beyond else 1.2, 0, 0.5]))
    low = Part("low", Box([1, 1, 1]), Pose([-1, 0, 0.5]))
    high = Part("high", Box([1, 1, 1]), Pose([-1, 0, 1.5]))
    found = cones.stable_cone(program_of(Assembly([base, edge, low, high])))
    assert found.cone.kind == kind
    assert found.proved
