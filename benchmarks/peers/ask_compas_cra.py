"""compas_cra: rigid-block equilibrium and coupled rigid-block analysis, by IPOPT.

It is handed the patches that kilter found, so that both see the same contacts, turned upright,
since its gravity points along -z. Its tolerances are absolute, so length and density matter:
CRA is asked twice, as its examples are made (`EXAMPLES`), and with the pair that was fastest
on leaning walls among lengths of 0.3 to 1.7 and densities of 0.05 and 1 (`TUNED`), ten to thirty
times so. Its other options are its own.

RBE always answers, with pulls where pushes cannot balance, at 10^6 times the price: it is
read as "falls" where the pulls come to more than `PULL` of a mean weight. CRA is read by its
status: converged, proved locally infeasible, or neither.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from typing import Any

import numpy as np
from question import Question

EXAMPLES = (3**0.5, 1.0)
"""Mean diagonal of the free parts, that of a unit cube, and mean density."""
TUNED = (0.6, 0.05)
PULL = 1e-3
"""Sum of the pulls over the mean weight of a part, from which on they are no rounding [-]."""


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
    """`rbe_solve`: equilibrium with pulls that cost."""
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
    """`cra_solve`, as its examples are made."""
    return _cra(question, EXAMPLES)


def cra_tuned(question: Question) -> Callable[[], tuple[str, str]]:
    """`cra_solve`, in the units that suit it best."""
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
    """What it says where it fails; what it prints is kept quiet."""
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            solve(made, mu=mu)
        except ValueError as error:
            return str(error)
    return ""
