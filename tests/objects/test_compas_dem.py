"""Models and problems of compas_dem as objects, and answers as its results."""

from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError, Mesh, Part

pytest.importorskip("compas_dem")

import compas
from compas.geometry import Box, Frame
from compas_dem.models import BlockModel
from compas_dem.problem import Problem
from compas_dem.templates import ArchTemplate, BarrelVaultTemplate, DomeTemplate

from kilter.compas import solve

MU = 0.6
THICKNESSES = (0.3, 0.45, 0.6)
"""The critical thickness of the arch with a span of 10 is .3682."""


def arch(thickness: float) -> Any:
    model = BlockModel.from_template(ArchTemplate(5, 10, thickness, 0.5, 20))
    for block in model.elements():
        block.is_support = block.graphnode in (0, 19)
    return model


def barrel(thickness: float) -> Any:
    return BlockModel.from_barrelvault(BarrelVaultTemplate(thickness=thickness / 2, vou_length=2))


def dome(thickness: float) -> Any:
    # rows of staggered prisms cut into each other, as in the template's own example
    return _on_ground(
        BlockModel.from_template(
            DomeTemplate(meridians=12, hoops=3, r_i=4 - thickness, r_f=4 - thickness, R_f=4)
        )
    )


def wall(thickness: float) -> Any:
    boxes = []
    for row in range(3):
        for k in range(4 - row % 2):
            at = [k + 0.5 * (row % 2), 0, (row + 0.5) * thickness]
            boxes.append(Box(1, 0.5, thickness, frame=Frame(at, [1, 0, 0], [0, 1, 0])))
    return _on_ground(BlockModel.from_boxes(boxes))


def stack(thickness: float) -> Any:
    at = [[0.3 * k, 0, (k + 0.5) * thickness] for k in range(3)]
    axes = [1, 0, 0], [0, 1, 0]
    boxes = [Box(1, 1, thickness, frame=Frame(origin, *axes)) for origin in at]
    return _on_ground(BlockModel.from_boxes(boxes))


def _on_ground(model: Any) -> Any:
    low = min(vertex[2] for block in model.elements() for vertex in _corners(block))
    for block in model.elements():
        block.is_support = min(vertex[2] for vertex in _corners(block)) < low + 0.01
    return model


def _corners(block: Any) -> Any:
    return block.modelgeometry.vertices_attributes("xyz")


def by_hand(model: Any) -> kilter.Assembly:
    """The same blocks as parts of kilter."""
    parts = []
    for block in model.elements():
        vertices, faces = block.modelgeometry.to_vertices_and_faces()
        shape = Mesh(np.array(vertices), faces)
        parts.append(Part(str(block.graphnode), shape, grounded=block.is_support))
    return kilter.Assembly(parts, friction=MU)


@pytest.mark.slow
@pytest.mark.parametrize("thickness", THICKNESSES)
@pytest.mark.parametrize("make", [arch, barrel, dome, wall, stack])
def test_file_object_and_blocks_by_hand_have_the_same_verdict(make, thickness, tmp_path):
    model = make(thickness)
    compas.json_dump(model, str(tmp_path / "model.json"))
    read = kilter.load(tmp_path / "model.json", friction=MU)
    given = kilter.load(model, friction=MU)
    answers = [kilter.check(one) for one in (read, given, by_hand(model))]
    assert len({(str(a.verdict), a.level, tuple(sorted(a.moving))) for a in answers}) == 1
    assert solve(Problem(model), friction=MU).metadata["verdict"] == answers[0].verdict


@pytest.mark.parametrize(("thickness", "stands"), [(0.3682, False), (0.3683, True)])
@pytest.mark.slow
def test_the_arch_stands_from_its_critical_thickness(thickness, stands):
    assert (kilter.check(kilter.load(arch(thickness), friction=MU)).level is not None) == stands


def problem_of(model: Any, **law: float) -> Any:
    made = Problem(model)
    made.set_contact_model("MohrCoulomb", **law)
    return made


def balance(model: Any, results: Any) -> float:
    """Largest imbalance of force and moment of a free block over its weight, by their objects."""
    worst, centres = 0.0, kilter.load(model).geometry.center
    for block in model.elements():
        if block.is_support:
            continue
        solid = block.modelgeometry.copy()
        solid.quads_to_triangles()
        weight = 9810 * abs(solid.volume())
        force, moment = np.array([0.0, 0.0, -weight]), np.zeros(3)
        centre = centres[block.graphnode]
        for edge in results.edges():
            if block.graphnode not in edge:
                continue
            sign = 1.0 if edge[0] == block.graphnode else -1.0
            contact = results.contact_data(edge)
            axes = np.array([contact.frame.xaxis, contact.frame.yaxis, contact.frame.zaxis])
            for point, part in zip(contact.points, contact.forces, strict=True):
                local = [part["c_u"], part["c_v"], part["c_np"] - part["c_nn"]]
                one = sign * np.array(local) @ axes
                force += one
                moment += np.cross(np.array(point) - centre, one)
        worst = max(worst, np.abs(force).max() / weight, np.abs(moment).max() / weight)
    return worst


def test_results_have_forces_that_balance_every_block():
    model = stack(0.5)
    results = solve(problem_of(model, mu=MU))
    assert results.metadata["verdict"] == "stable"
    assert balance(model, results) < 1e-9
    edge = next(e for e in results.edges() if set(e) == {1, 2})
    assert results.face_contact(edge)
    assert results.contact_polygon(edge).area == pytest.approx(0.7)
    sign = 1 if edge[0] == 2 else -1
    assert results.resultant_global(edge) == pytest.approx([0, 0, sign * 4905], abs=1e-6)
    assert results.contact_data(edge).resultantline().length == pytest.approx(4905)
    assert results.force_magnitude(edge) == pytest.approx(4905)
    assert all(results.displacement(node) == [0, 0, 0] for node in results.nodes())


def test_results_of_a_falling_model_show_how_it_starts_to_move():
    model = arch(0.3)
    results = solve(problem_of(model, mu=MU), shown=0.02)
    assert results.metadata["verdict"] == "unstable"
    moved = {node for node in results.nodes() if any(results.displacement(node))}
    assert moved
    assert not moved & {0, 19}
    assert results.displacement(9)[2] < 0  # the crown sinks
    assert compas.json_loads(compas.json_dumps(results)).metadata == results.metadata


def test_a_problem_brings_its_loads_as_an_object(tmp_path):
    model = stack(0.5)
    made = problem_of(model, mu=MU)
    made.add_boundary_condition("push").add_point_load(2, force=[9000, 0, 0])
    compas.json_dump(model, str(tmp_path / "model.json"))
    compas.json_dump(made, str(tmp_path / "problem.json"))
    assert kilter.load(made).loads == kilter.load(tmp_path / "problem.json").loads
    assert solve(made).metadata["verdict"] == "unstable"


def test_a_floor_of_kilter_is_no_block_of_the_results():
    model = BlockModel.from_boxes([Box(1, 1, 1)])
    results = solve(problem_of(model, mu=MU), floor=True)
    assert results.metadata["level"] == "proved"
    assert list(results.nodes()) == [0]
    assert list(results.edges()) == []


def test_a_problem_without_its_model_is_refused():
    made = compas.json_loads(compas.json_dumps(problem_of(stack(0.5), mu=MU)))
    with pytest.raises(InputError, match="the problem has no model"):
        solve(made)
