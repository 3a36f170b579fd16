"""The paper's figures 1 (b), 11 and 12, turned, in space: the blocks twist and sink.

The library's scenes give the blocks a depth, without friction. An independent test by separating
planes verifies that the configurations are apart.
"""

import itertools
import pathlib
import re
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly
from kilter.arrays import Array, unit_rows
from kilter.mechanics.program import Program, build_program
from kilter.scenes import scene
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import gap_forms
from kilter.second_order.gaps.stationary import Stationary, stationary
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.decide import decide

FINDINGS = pathlib.Path(__file__).parents[2] / "docs" / "contributing/findings.md"
TURNED = ("paper-figure-1-in-space", "paper-figure-11-in-space", "paper-figure-12-in-space")


def problem_of(assembly: Assembly) -> tuple[Program, Stationary]:
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return program, stationary(program, gap_forms(program, features_of(program, contacts)))


def near_path(problem: Stationary, path: Path) -> tuple[Array, Array]:
    """First and second derivative of a path, the second as short as possible."""
    bends = problem.bends(path.first)
    count = problem.rows.shape[1]
    lower = np.vstack(
        [np.column_stack([-problem.rows, np.ones(len(bends))]), [*-problem.load, 0.0]]
    )
    most = linprog(
        [*np.zeros(count), -1.0], lower, [*bends, -0.1], bounds=[(-20, 20)] * count + [(0, None)]
    )
    assert most.status == 0
    assert most.x[-1] > 1e-3  # every gap opens
    return path.first, most.x[:count]


@dataclass
class Moved:
    """A displaced block: its corners, and the directions of its faces and edges."""

    corners: Array
    normals: Array
    edges: Array


def block(assembly: Assembly, part: int, center: Array, motion: Array) -> Moved:
    triangles = assembly.geometry.corners_of(part)
    turn = Rotation.from_rotvec(motion[3:]).as_matrix()
    sides = triangles - np.roll(triangles, 1, axis=1)
    normals = unit_rows(np.cross(sides[:, 0], sides[:, 1]))
    edges = unit_rows(sides.reshape(-1, 3))
    corners = triangles.reshape(-1, 3)
    return Moved(
        (corners - center) @ turn.T + center + motion[:3], normals @ turn.T, edges @ turn.T
    )


def apart(one: Moved, other: Moved) -> float:
    """Greatest separation along normals of faces and cross products of edges: exact if convex."""
    products = np.cross(one.edges[:, None], other.edges[None]).reshape(-1, 3)
    long = np.linalg.norm(products, axis=1) > 1e-6
    axes = np.vstack([one.normals, -other.normals, unit_rows(products[long])])
    axes = np.vstack([axes, -axes])
    gaps = (other.corners @ axes.T).min(axis=0) - (one.corners @ axes.T).max(axis=0)
    return float(gaps.max())


def least_gap(assembly: Assembly, program: Program, motion: Array) -> float:
    """Least separation of blocks from each other and from the walls that they touch."""
    free = np.flatnonzero(program.free)
    blocks = {k: block(assembly, k, program.center[k], motion[k]) for k in free.tolist()}
    gaps = [apart(blocks[a], blocks[b]) for a, b in itertools.combinations(blocks, 2)]
    for a, b, x, n in zip(
        program.part_a, program.part_b, program.point, program.normal, strict=True
    ):
        if not program.free[a]:
            gaps.append(float(((blocks[int(b)].corners - x) @ n).min()))
        elif not program.free[b]:
            gaps.append(float(((x - blocks[int(a)].corners) @ n).min()))
    return min(gaps)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", TURNED)
def test_blocks_twist_and_sink_with_every_gap_open(name):
    assembly = scene(name)
    program, problem = problem_of(assembly)
    found = decide(problem)
    assert found.state == "balanced"
    assert isinstance(found.proof, Path)
    first, second = near_path(problem, found.proof)
    assert least_gap(assembly, program, np.zeros((len(program.names), 6))) > -1e-12
    assert problem.scale is not None
    energies = []
    for t in (0.005, 0.0025, 0.00125):
        step = t * first + t**2 * second / 2
        motion = program.full(step * problem.scale)
        assert least_gap(assembly, program, motion) > 0
        energies.append(-float(problem.load @ step) / t**2)
    assert max(energies) < -0.04  # it sinks as t^2
    assert np.ptp(energies) < 1e-9


def test_the_configuration_of_the_page_is_lower_and_apart():
    assembly = scene(TURNED[0])
    program, _ = problem_of(assembly)
    motion = np.zeros((len(program.names), 6))
    for line in FINDINGS.read_text(encoding="utf-8").splitlines():
        words = [word.strip() for word in line.strip("|").split("|")]
        if words[0] in program.names:
            motion[program.names.index(words[0])] = [float(word) for word in words[1:]]
    free = program.free
    assert np.abs(motion[free]).max(axis=1).min() > 0.01
    assert least_gap(assembly, program, motion) == pytest.approx(3.1e-5, abs=1e-6)
    assert motion[free, 2].sum() == pytest.approx(-3.0e-5, abs=1e-6)


def test_the_corners_of_the_page_are_those_of_the_scene():
    geometry = scene(TURNED[0]).geometry
    page = FINDINGS.read_text(encoding="utf-8")
    [words] = re.findall(r"prism over the corners \(x, z\) = (.*?), with", page)
    said = np.array([[float(a), float(b)] for a, b in re.findall(r"\((.*?), (.*?)\)", words)])
    for part, mirror in ((1, 1), (2, -1)):
        corners = geometry.corners_of(part).reshape(-1, 3)
        assert np.allclose(np.unique(corners[:, 1]), [-0.5, 0.5])
        flat = corners[:, [0, 2]] * np.sqrt(2) * [mirror, 1]
        near = np.abs(flat[:, None] - said).max(axis=2) < 1e-9
        assert near.any(axis=1).all()
        assert near.any(axis=0).all()
