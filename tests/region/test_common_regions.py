"""Directions that are stable for all of a list of assemblies."""

import pytest
from cones import same_rays

import kilter
from kilter.analysis.regions.region import common_region
from kilter.analysis.verification import verify_proof
from kilter.contact import detect
from kilter.errors import InputError
from kilter.scenes import paper, rails, wedges

PAIRS = [
    ("-x +x -z", "-x -z +z", "fan"),
    ("-x +x -y +y -z", "-x -y -z", "cone"),
    ("-x +x -y +y -z", "-x +x -y +y +z", "plane"),
    ("-x +x", "-z +z", "none"),
    ("-x +x -z", "-x +x +z", "line"),
    ("-x +x -y +y -z +z", "-x +x -y +y -z +z", "all"),
    ("-x -y -z", "-x +y -z", "fan"),
    ("-x -y -z", "+x +y -z", "ray"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("one", "other", "kind"), PAIRS)
def test_intersections(one: str, other: str, kind: str) -> None:
    both = [rails.railed(one), rails.railed(other, count=2)]
    region = common_region(both)
    assert region.kind == kind
    assert common_region(both[::-1]).kind == kind


@pytest.mark.slow
def test_a_plan_without_a_common_direction() -> None:
    region = common_region([paper.figure_11(), paper.figure_12()])
    assert region.kind == "none"
    assert "no direction is stable for all assemblies" in region.warnings[-1]
    assert region.warnings[0].startswith("assembly 1: ")


@pytest.mark.slow
def test_common_proofs_verify() -> None:
    region = common_region([rails.railed("-x +x -z", count=2), rails.railed("-x -y -z")])
    proofs = region.proofs()
    assert region.kind == "fan"
    # the rays in both assemblies; facets and equations in one of them
    assert sorted(proof.about for proof in proofs) == (
        ["equation"] * 2 + ["facet"] * 2 + ["ray"] * 4
    )
    for proof in proofs:
        answer = verify_proof(proof.assembly, detect.contacts(proof.assembly), proof.data)
        assert answer.holds


@pytest.mark.slow
def test_one_is_itself() -> None:
    assembly = wedges.corner_wedges()
    assert same_rays(common_region([assembly]).rays, list(kilter.region(assembly).rays))


def test_none_given() -> None:
    with pytest.raises(InputError, match="no assembly is given"):
        common_region([])
