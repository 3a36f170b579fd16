"""Answers of kilter as results of compas_dem, for its viewer and its result functions.

`solve` stands beside `Problem.solve`, whose list of solvers is closed.

References
----------
compas_dem 0.6, `problem.Results`: an edge has the forces on its first block, in a frame whose
z axis is the normal into that block.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.analysis.check import check
from kilter.arrays import Array, cross
from kilter.errors import InputError
from kilter.files.meshes.placed import natural_key
from kilter.loading import load
from kilter.rigid import screwed
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from compas_dem.problem import Problem, Results

    from kilter.analysis.verdict.verdict import Verdict

SHOWN = 0.05
"""Largest shift of a block that starts to fall, over the size of the model."""


def solve(problem: Problem, *, shown: float = SHOWN, **options: Any) -> Results:
    """Decide whether the model of a problem stays together, as results of compas_dem.

    Parameters
    ----------
    problem : compas_dem.problem.Problem
        Problem with its model: supports, densities, loads and friction are used; cohesion,
        stiffness and prescribed displacements are not.
    shown : float
        Largest shift of a block in the results, over the size of the model [-], if the model is
        unstable. It has no physical size: kilter computes how a motion starts.
    **options
        Options of `kilter.check` and `kilter.load`, for example ``friction=0.6``.

    Returns
    -------
    compas_dem.problem.Results
        For each block its transformation: the motion with which it starts if the model is unstable,
        else 1. For each pair in contact the points, and the forces [N] on the first block; without
        forces of equilibrium they are 0. `metadata` has verdict, level, sentence and friction.

    Raises
    ------
    InputError
        If the problem has no model, or an option is invalid.
    """
    from compas_dem.problem import Results

    if getattr(problem, "_model", None) is None:
        raise InputError("the problem has no model", hint="call problem.load_model(model) first")
    model = problem.model
    answer: Verdict = check(load(problem), **options)
    blocks = [block.graphnode for block in model.elements() if block.geometry is not None]
    nodes = sorted(blocks, key=lambda node: natural_key(str(node)))  # a floor comes last
    results = Results(model_id=str(model.guid), problem_id=str(problem.guid))
    _set_motions(results, nodes, answer, shown)
    _set_contacts(results, nodes, answer, model.graph)
    results.metadata |= {
        "solver": "kilter",
        "verdict": str(answer.verdict),
        "level": answer.level,
        "sentence": answer.sentence,
        "mu": answer.assembly.friction,
    }
    return results


def _set_motions(results: Results, nodes: list[int], answer: Verdict, shown: float) -> None:
    """Set the transformation of each block: the start of its motion, else 1."""
    from compas.geometry import Transformation

    assembly = answer.assembly
    screws = np.zeros((len(assembly.parts), 6))
    if answer.verdict == "unstable":
        screws = answer.motion.screws(metres_per_unit(assembly.units))
    size = float(np.linalg.norm(np.diff(assembly.bounds, axis=0)))
    reach = np.linalg.norm(screws[:, :3], axis=1).max(initial=0.0)
    turn = np.linalg.norm(screws[:, 3:], axis=1).max(initial=0.0)
    amount = shown / max(reach / size, turn, np.finfo(float).tiny)
    for node, screw, centre in zip(nodes, screws, assembly.geometry.center, strict=False):
        matrix = np.eye(4)
        if screw.any():
            (turned,), (shift,) = screwed(screw, [amount])
            matrix[:3, :3] = turned
            matrix[:3, 3] = shift + centre - turned @ centre
        results.set_node(node, "transformation", Transformation.from_matrix(matrix.tolist()))


def _set_contacts(results: Results, nodes: list[int], answer: Verdict, graph: Any) -> None:
    """Set the contact points and forces of each pair, as edges of the graph of the model."""
    contacts, forces = answer.contact_set, answer.forces
    carried = {}
    if forces is not None:
        carried = dict(zip(forces.patch.tolist(), forces.patches, strict=True))
    pairs: dict[tuple[int, int], list[tuple[Array, Array, Array]]] = {}
    for k, (a, b) in enumerate(contacts.patch_parts.tolist()):
        if max(a, b) >= len(nodes):
            continue
        rows = slice(*contacts.patch_start[k : k + 2].tolist())
        points, force = contacts.points[rows], np.zeros((rows.stop - rows.start, 3))
        if k in carried:
            points, force = np.asarray(carried[k].points), np.asarray(carried[k].forces)
        u, v, normal = nodes[a], nodes[b], contacts.patch_normal[k]
        if graph.has_edge((v, u)) and not graph.has_edge((u, v)):
            u, v, normal, force = v, u, -normal, -force
        pairs.setdefault((u, v), []).append((points, -normal, -force))
    for edge, patches in pairs.items():
        _set_edge(results, edge, patches)
        if not (graph.has_edge(edge) or graph.has_edge(edge[::-1])):
            results.metadata.setdefault("added_edges", []).append(list(edge))


def _set_edge(
    results: Results, edge: tuple[int, int], patches: list[tuple[Array, Array, Array]]
) -> None:
    """Set the contact of a pair from its patches.

    Arguments: `patches`: points, shape (n, 3), unit normal into the first block of the edge, and
    forces on this block [N], shape (n, 3). The frame is that of the first patch.
    """
    from compas.geometry import Frame, Line, Point, Polygon
    from compas_dem.interactions import EdgeContact, FrictionContact, VertexContact

    normal = patches[0][1]
    x_axis = cross(normal, np.eye(3)[np.abs(normal).argmin()])
    x_axis /= np.linalg.norm(x_axis)
    axes = np.array([x_axis, cross(normal, x_axis), normal])
    points = np.concatenate([patch[0] for patch in patches])
    forces = np.concatenate([patch[2] for patch in patches])
    flat = (points - points.mean(axis=0)) @ axes[:2].T
    around = np.arctan2(flat[:, 1], flat[:, 0]).argsort(kind="stable")
    points, forces = points[around], forces[around]
    local, total = forces @ axes.T, forces.sum(axis=0)
    corners = [Point(*point) for point in points.tolist()]
    parts = [
        {"c_np": max(n, 0.0), "c_nn": max(-n, 0.0), "c_u": u, "c_v": v}
        for u, v, n in local.tolist()
    ]
    frame = Frame(points.mean(axis=0).tolist(), axes[0].tolist(), axes[1].tolist())
    kind: dict[str, Any] = {"face_contact": False, "edge_contact": False, "point_contact": False}
    if len(corners) > 2:
        contact = FrictionContact(points=corners, frame=frame, forces=parts)
        kind |= {"face_contact": True, "contact_polygon": Polygon(corners)}
    elif len(corners) == 2:
        contact = EdgeContact(corners, frame, parts)
        kind |= {"edge_contact": True, "contact_geometry": Line(*corners)}
    else:
        contact = VertexContact(corners[0], frame, forces=parts)
        kind |= {"point_contact": True, "contact_geometry": corners[0]}
    values = {
        **kind,
        "contact_points": points.tolist(),
        "contact_data": contact,
        "contact_frame": frame,
        "contact_frames": [Frame(corner, frame.xaxis, frame.yaxis) for corner in corners],
        "gap": [0.0] * len(corners),
        "status": ["stick" if force.any() else "noctc" for force in forces],
        "force_vector": forces.tolist(),
        "force_normal": local[:, 2].tolist(),
        "force_tangent1": local[:, 0].tolist(),
        "force_tangent2": local[:, 1].tolist(),
        "resultant_global": total.tolist(),
        "resultant_local": (axes @ total).tolist(),
        "force_magnitude": float(np.linalg.norm(total)),
        "nodal_force_magnitudes": np.linalg.norm(forces, axis=1).tolist(),
    }
    weight = np.abs(local[:, 2])
    if weight.sum() > 0:
        values["force_point"] = (weight @ points / weight.sum()).tolist()
    for name, value in values.items():
        results.set_edge(edge, name, value)
