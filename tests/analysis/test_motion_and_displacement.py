"""Gauss's accelerations against Baraff's forces, LP (9) against its dual; kappa and z scale."""

import numpy as np
import pytest
from independent import baraff, dense_rows, kinetic, z_by_duality
from judged import judged, program_of
from transformations import tilted

from kilter.analysis.decision.motion import find_motion
from kilter.analysis.verdict.displacement import find_displacement
from kilter.assembly import Assembly, Load
from kilter.mechanics.forms import displacement
from kilter.scenes import packings, paper, scene, stacks, traps, walls, wedges
from kilter.scenes.pieces import block, floor
from kilter.solvers.highs import solve_linear
from kilter.units import METRES

G = 9.81


def _turned(assembly, seed):
    return assembly.with_down(np.random.default_rng(seed).normal(size=3))


def random_assemblies():
    """Forty small assemblies, most of them unstable, by name."""
    made = {}
    for seed in range(16):
        made[f"pile-{seed}"] = packings.box_pile(4 + seed % 5, seed=seed, cells=4, level=False)
    for seed in range(10):
        wedge = wedges.corner_wedges(3 + seed % 4, seed=seed)
        made[f"wedges-{seed}"] = _turned(wedge, 100 + seed)
    for seed in range(6):
        made[f"leaning-pile-{seed}"] = _turned(packings.box_pile(5, seed=seed, cells=3), seed)
    made |= {
        "opening": walls.wall_with_opening(4, 4, opening=(1, 3, 1, 3)),
        "short-base": walls.short_base(3, 4, held=2.25),
        "hanging": walls.hanging_brick(4, 4),
        "tilted-wall": tilted(walls.wall(3, 3), [1, 1, 0], 7.0),
        "triangle": stacks.inverted_triangle(3),
        "figure-8": paper.figure_8(),
        "figure-1": paper.figure_1(planar=True),
        "wedge": scene("wedge-on-wedge"),
        "floating": traps.floating_block(),
    }
    return made


ASSEMBLIES = random_assemblies()
EACH = pytest.mark.parametrize("name", ASSEMBLIES)


@pytest.mark.quick(3)
@EACH
def test_accelerations_are_those_of_baraffs_forces(name):
    program = program_of(ASSEMBLIES[name])
    found = find_motion(program)
    expected = baraff(program)
    radius = np.repeat(program.radius[:, None], 6, axis=1)
    radius[:, :3] = 1.0
    assert np.abs((found.acceleration - expected) * radius).max() < 1e-9 * G


@pytest.mark.quick(3)
@EACH
def test_gravity_does_the_work_that_becomes_motion(name):
    program = program_of(ASSEMBLIES[name])
    found = find_motion(program)
    power = float((program.load * found.acceleration).sum())
    size = float(program.mass[program.free].sum()) * G**2
    assert power == pytest.approx(kinetic(program, found.acceleration), abs=1e-9 * size)
    assert np.sqrt(max(power, 0) / size) == pytest.approx(found.instability, abs=1e-9)
    assert 0 <= found.instability <= 1 + 1e-12
    assert dense_rows(program) @ found.acceleration.ravel() == pytest.approx(
        np.maximum(dense_rows(program) @ found.acceleration.ravel(), 0), abs=1e-8 * G
    )


@pytest.mark.quick(2)
@EACH
def test_z_is_the_least_imbalance_of_its_dual(name):
    program = program_of(ASSEMBLIES[name])
    z = find_displacement(program).z
    assert z == pytest.approx(z_by_duality(program), rel=1e-9, abs=1e-9 * program.mass.max())


@pytest.mark.quick(3)
@EACH
def test_least_displacement_is_feasible_and_optimal(name):
    program = program_of(ASSEMBLIES[name])
    found = find_displacement(program)
    dp = found.displacement
    assert np.abs(dp).max() <= 1 + 1e-9
    assert (dense_rows(program) @ dp.ravel()).min(initial=0.0) >= -1e-8
    work = float((program.load * dp).sum()) / G
    assert -work == pytest.approx(found.z, rel=1e-8, abs=1e-9)


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", ["pile-1", "wedges-2", "figure-8", "opening", "triangle"])
def test_least_displacement_is_no_longer_than_any_other_optimum(name):
    program = program_of(ASSEMBLIES[name])
    found = find_displacement(program)
    lp = displacement(program)
    for method in ("simplex", "interior"):
        other = solve_linear(lp, method=method).x
        assert np.linalg.norm(found.displacement) <= np.linalg.norm(other) + 1e-6
        # 0 is projected on a convex set: the angle to every other optimum is not obtuse
        shift = program.full(other) - found.displacement
        assert float((found.displacement * shift).sum()) >= -1e-6


def test_z_counts_loads_over_the_size_of_gravity():
    parts = [floor([-2, -2], [2, 2]), block("box", [0, 0, 0], [1, 1, 1], mass=1.0)]
    verdict = judged(Assembly(parts, loads=[Load("box", force=[3 * G, 0, 0])]))
    assert verdict.displacement.z == pytest.approx(-3.0, rel=1e-9)
    assert verdict.to_dict()["instability"] is None


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", ["m", "cm", "mm", "in"])
def test_accelerations_are_si_in_every_unit(units):
    # a box past an edge: m/s^2 and rad/s^2 of the same box told in other units
    u = METRES[units]
    table = block("table", np.array([-3, -1, -1]) / u, np.array([0, 1, 0]) / u, grounded=True)
    box = block("box", np.array([-0.4, -0.5, 0]) / u, np.array([0.6, 0.5, 1]) / u, density=500.0)
    verdict = judged(Assembly([table, box], units=units))
    alpha = G * 0.1 / (1 / 6 + 0.01)
    expected = [0, 0, -alpha * 0.1, 0, alpha, 0]
    assert np.allclose(verdict.motion.acceleration[1], expected, atol=1e-9)
    assert verdict.program.mass[1] == pytest.approx(500.0)


def test_figures_that_no_solver_finishes_are_left_out_and_the_verdict_stands(monkeypatch):
    from kilter import check, example
    from kilter.solvers import highs

    assembly = example("paper-figure-8")
    verdict = check(assembly)
    monkeypatch.setattr(highs, "FEW", 1)
    monkeypatch.setattr(highs, "MANY", 0)
    monkeypatch.setattr(highs, "INTERIOR_STEPS", 1)
    answer = verdict.to_dict()
    assert answer["verdict"] == "unstable"
    assert answer["z"] is None
    assert {part["displacement"] is None for part in answer["parts"]} == {True}
    assert any(
        "no solver finished the displacement program" in warning for warning in answer["warnings"]
    )
