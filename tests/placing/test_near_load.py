"""Maps of large assemblies: the parts near a load decide as the whole assembly does."""

import numpy as np
import pytest

import kilter
from kilter.analysis.placing import near_load
from kilter.analysis.placing.near_load import NearParts, RestGraph
from kilter.analysis.placing.place import Places, box_to_place
from kilter.contact import contacts
from kilter.mechanics.program import build_program
from kilter.scenes import walls
from kilter.scenes.random_bricks import box_pile


def both_maps(assembly: kilter.Assembly, monkeypatch: pytest.MonkeyPatch) -> tuple[Places, Places]:
    """The map by the parts near each load, and the map by the whole assembly."""
    box = box_to_place([1, 1, 1], 1000.0)
    near = kilter.place(assembly, box)
    monkeypatch.setattr(near_load, "LARGE", 0.0)  # no parts are few enough
    return near, kilter.place(assembly, box)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("count", "seed", "friction"),
    [(12, 1, 0.0), pytest.param(40, 2, 0.0, marks=pytest.mark.slow), (6, 3, 0.5)],
)
def test_the_map_is_that_of_the_whole_assembly(count, seed, friction, monkeypatch):
    pile = box_pile(count, seed=seed, cells=8, friction=friction)
    near, whole = both_maps(pile, monkeypatch)
    for ours, theirs in zip(near.levels, whole.levels, strict=True):
        assert ours.height == theirs.height
        strip = 2 * near.accuracy * (ours.stands.length + ours.falls.length + 1)
        assert ours.stands.symmetric_difference(theirs.stands).area <= strip
        assert ours.stands.intersection(theirs.falls).area == pytest.approx(0.0, abs=1e-9)
        assert theirs.stands.intersection(ours.falls).area == pytest.approx(0.0, abs=1e-9)


def test_a_proof_by_near_parts_is_verified_with_the_whole_assembly():
    pile = box_pile(12, seed=1, cells=8)
    answer = kilter.place(pile, box_to_place([1, 1, 1], 1000.0))
    assert answer.stands
    assert kilter.verify(pile, answer.proof()).holds


def test_near_parts_are_those_below_and_those_that_rest_on_them():
    """In a running bond the bricks below one brick form a triangle, which is a small part."""
    wall = walls.wall_of(100)
    program = build_program(wall, contacts(wall))
    graph = RestGraph(program)
    top = int(np.argmax(program.center[:, 2]))
    below = NearParts.of(graph, [top], program.center[top], above=False, most=np.inf)
    assert below is not None
    courses = np.unique(program.center[program.free, 2].round(6))
    near = below.parts[below.near]
    assert len(np.unique(program.center[near, 2].round(6))) == len(courses)
    lowest = int(np.argmin(np.where(program.free, program.center[:, 2], np.inf)))
    alone = NearParts.of(graph, [lowest], program.center[lowest], above=False, most=np.inf)
    assert alone is not None
    assert alone.parts[alone.near].tolist() == [lowest]
    assert alone.inside.sum() < len(alone.rows)


def test_findings_keep_only_the_forces_of_near_parts():
    """The memory of a map does not grow with the parts that stand elsewhere."""
    base = kilter.Part("base", kilter.Box([99, 9, 1]), kilter.Pose([0, 0, -0.5]), True)
    boxes = [
        kilter.Part(f"b{k}", kilter.Box([1, 1, 1]), kilter.Pose([2 * k, 0, 0.5])) for k in range(9)
    ]
    answer = kilter.place(kilter.Assembly([base, *boxes]), box_to_place([1, 1, 1], 1000.0))
    findings = [each for level in answer.question.maps[0].levels for each in level.findings]
    proofs = [proof for each in findings for _, proof in each.carried.points]
    assert len(proofs) == 4 * len(boxes)
    assert {len(proof.forces) for proof in proofs} == {4}
    assert kilter.verify(answer.assembly, answer.proof()).holds
