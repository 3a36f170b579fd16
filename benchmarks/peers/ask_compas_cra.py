"""Adapters for compas_cra: rigid-block equilibrium (RBE) and coupled rigid-block analysis (CRA).

Both use IPOPT. compas_cra receives the patches that kilter detected, so that both have the same
contacts, rotated upright, because its gravity is along -z. Its tolerances are absolute, so that
length and density matter. CRA runs twice: in the units of its examples (`EXAMPLES`), and in the
fastest units for leaning walls among lengths of 0.3 to 1.7 and densities of 0.05 and 1 (`TUNED`),
which are ten to thirty times faster. Other options have their default values.

RBE always answers, with tension at 10^6 times the cost if compression cannot balance. It counts as
"falls" if the tension exceeds `PULL` of a mean weight. The answer of CRA is its status: converged,
locally infeasible, or neither.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from typing import Any

import numpy as np
from question import Question

EXAMPLES = (3**0.5, 1.0)
"""Mean diagonal of the free parts (that of a unit cube) and mean density, as in its examples."""
TUNED = (0.6, 0.05)
"""Mean diagonal and mean density at which it is fastest."""
PULL = 1e-3
"""Smaller sums of tension count as rounding [mean weight of a part]."""


def assembled(question: Question, units: tuple[float, float]) -> tuple[Any, float]:
    """A `CRA_Assembly` with its interfaces, and the mean weight of its free parts."""
    from compas.geometry import Frame
    from compas_assembly.datastructures import Block
    from compas_cra.datastructures import CRA_Assembly

    geometry, contacts = question.assembly.geometry, question.contacts
    turn, free = question.upright, ~geometry.grounded
    diagonal, mean = units
    length = float(np.mean(geometry.size[free])) / diagonal
    vertices = geometry.vertices @ turn.T / length
    points, normals = contacts.points @ turn.T / length, contacts.patch_normal @ turn.T
    density = geometry.mass / geometry.volume
    density = density / np.mean(density[free]) * mean
    made = CRA_Assembly()
    for k, held in enumerate(geometry.grounded):
        rows = slice(*geometry.vertex_start[k : k + 2])
        faces = geometry.triangles[slice(*geometry.triangle_start[k : k + 2])] - rows.start
        solid = Block.from_vertices_and_faces(vertices[rows].tolist(), faces.tolist())
        solid.attributes["density"] = float(density[k])
        made.add_block(solid, node=k)
        if held:
            made.set_boundary_condition(k)
    for patch, (a, b) in enumerate(contacts.patch_parts.tolist()):
        corners = points[slice(*contacts.patch_start[patch : patch + 2])]
        along = corners[1] - corners[0]
        across = np.cross(normals[patch], along)
        frame = Frame(corners[0].tolist(), along.tolist(), across.tolist())
        area = float(contacts.patch_area[patch]) / length**2
        made.add_to_interfaces(a, b, size=area, points=corners.tolist(), frame=frame)
    weight = density[free] * geometry.volume[free] / length**3
    return made, float(np.mean(weight))


def rbe(question: Question) -> Callable[[], tuple[str, str]]:
    """`rbe_solve`: equilibrium with penalised tension."""
    from compas_cra.equilibrium import rbe_solve

    made, weight = assembled(question, EXAMPLES)

    def run() -> tuple[str, str]:
        failed = attempted(rbe_solve, made, question.assembly.friction)
        if failed:
            return "open", failed
        pulls = sum(
            force["c_nn"]
            for edge in made.graph.edges()
            for interface in made.graph.edge_attribute(edge, "interfaces")
            for force in interface.forces
        )
        return ("falls" if pulls > PULL * weight else "holds"), f"pulls {pulls / weight:.1e}"

    return run


def cra(question: Question) -> Callable[[], tuple[str, str]]:
    """`cra_solve` in the units of its examples."""
    return _cra(question, EXAMPLES)


def cra_tuned(question: Question) -> Callable[[], tuple[str, str]]:
    """`cra_solve` in its fastest units."""
    return _cra(question, TUNED)


def _cra(question: Question, units: tuple[float, float]) -> Callable[[], tuple[str, str]]:
    from compas_cra.equilibrium import cra_solve

    made, _ = assembled(question, units)

    def run() -> tuple[str, str]:
        failed = attempted(cra_solve, made, question.assembly.friction)
        if not failed:
            return "holds", "converged"
        return ("falls" if "infeasible" in failed.lower() else "open"), failed

    return run


def attempted(solve: Callable[..., Any], made: Any, mu: float) -> str:
    """Run a solver without its output; return the error message, empty on success."""
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            solve(made, mu=mu)
        except ValueError as error:
            return str(error)
    return ""
