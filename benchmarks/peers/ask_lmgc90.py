"""Adapter for LMGC90 through compas_dem: simulate, and test whether a block moved.

compas_dem builds the model, and LMGC90 detects its own contacts. The blocks are turned upright,
because its gravity is along -z, and scaled to a mean size of 1 m, since its tolerances are
absolute. A block that moves by more than `MOVED` of its size within `SECONDS` falls.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator

import numpy as np
from question import Question

STEP = 0.001
"""Time step [s]."""
SECONDS = 1.0
"""Simulated time [s]."""
MOVED = 0.01
"""Displacement at which a block counts as moved [size of the block]."""


def settle(question: Question) -> Callable[[], tuple[str, str]]:
    """Simulate for the whole time, then compare the poses of the blocks."""
    from compas.datastructures import Mesh
    from compas_dem.elements import Block
    from compas_dem.material import Stone
    from compas_dem.models import BlockModel
    from compas_dem.problem import Problem, Solver

    geometry, turn = question.assembly.geometry, question.upright
    vertices = geometry.vertices @ turn.T / question.length
    volume = geometry.volume / question.length**3
    density = geometry.mass / geometry.volume
    if np.ptp(density) > 1e-9 * density.max():
        raise ValueError("LMGC90 in compas_dem has a single density")
    stone = Stone(density=1000.0)
    model = BlockModel()
    model.add_material(stone)
    for k, held in enumerate(geometry.grounded):
        rows = slice(*geometry.vertex_start[k : k + 2])
        faces = geometry.triangles[slice(*geometry.triangle_start[k : k + 2])] - rows.start
        mesh = Mesh.from_vertices_and_faces(vertices[rows].tolist(), faces.tolist())
        block = Block.from_mesh(mesh, is_support=bool(held))
        model.add_element(block)
        model.assign_material(stone, element=block)
    problem = Problem(model)
    problem.set_contact_model("MohrCoulomb", mu=question.assembly.friction)
    problem.set_solver(Solver.LMGC90(duration=SECONDS, dt=STEP))
    size = volume ** (1 / 3)

    def run() -> tuple[str, str]:
        with _quiet():
            results = problem.solve()
        blocks = [block.graphnode for block in model.elements()]
        shift = [np.linalg.norm(results.displacement(node)) for node in blocks]
        turned = [np.linalg.norm(np.array(results.rotation(node)) - np.eye(3)) for node in blocks]
        moved = np.maximum(np.array(shift) / size, np.array(turned) / 8**0.5).max()
        return ("holds" if moved < MOVED else "falls"), f"moved {moved:.1e}"

    return run


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Discard what compiled code prints."""
    with open(os.devnull, "w") as nothing, contextlib.redirect_stdout(nothing):
        kept = os.dup(1)
        os.dup2(nothing.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)
