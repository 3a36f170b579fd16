"""Free motions in scaled unknowns: their span, and the parts that they visibly move."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, SPHERE
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_motions import FreeMotions
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import ACROSS
from kilter.shape.primitives import Cylinder, Sphere

__all__ = ["free_span", "moving_free", "scaled_columns", "spins_unseen"]


def free_span(program: Program, problem: Stationary, free: FreeMotions) -> Array:
    """Orthonormal basis, (n, f), of the free motions that open no contact and cost no energy."""
    columns = scaled_columns(program, problem, free.motions)
    size = np.linalg.norm(columns, axis=0)
    columns = np.asarray(columns[:, size > 0] / size[size > 0], dtype=np.float64)
    opened = np.abs(problem.rows @ columns).max(axis=0, initial=0.0)
    spent = np.abs(problem.load @ columns)
    columns = columns[:, (opened < ACROSS / 10) & (spent < ACROSS / 10)]
    if not columns.shape[1]:
        return columns
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return np.ascontiguousarray(left[:, values > ACROSS * values[0]])


def scaled_columns(program: Program, problem: Stationary, motions: Array) -> Array:
    """Convert motions of all parts, shape (F, N, 6), to scaled unknowns, shape (n, F)."""
    assert problem.scale is not None
    free = np.flatnonzero(program.free)
    moved = motions[:, free][:, :, program.freedoms].reshape(len(motions), len(problem.scale))
    return np.asarray((moved / problem.scale).T)


def moving_free(assembly: Assembly, free: FreeMotions) -> Index:
    """Indices of the parts that a free motion visibly moves; spins of round parts do not count.

    A group of tied parts counts as its first part, as in the motions.
    """
    groups, moving = RigidGroups.of(assembly), np.zeros(len(assembly.parts), dtype=bool)
    for motion in groups.spread(free.motions):
        for k in np.flatnonzero(np.abs(motion).max(axis=1) > 0):
            moving[k] |= not spins_unseen(assembly, int(k), motion[k])
    return np.unique(groups.first[moving])


def spins_unseen(assembly: Assembly, part: int, motion: Array) -> bool:
    """True if a motion, shape (6,), only spins a round part about its own axis."""
    turn, center = motion[3:], assembly.geometry.center[part]
    radius = float(assembly.geometry.radius[part])
    speed = float(np.abs(turn).max()) * radius
    still = ACROSS * max(speed, float(np.abs(motion[:3]).max()))
    if speed == 0 or abs(motion[:3] @ turn) * radius > still * speed:
        return False
    shape, pose = assembly.parts[part].shape, assembly.parts[part].pose
    if not isinstance(shape, Sphere | Cylinder):
        return _of_revolution(assembly.geometry, part, motion, center)
    if np.abs(motion[:3] + np.cross(turn, pose.position - center)).max() > still:
        return False
    across = np.abs(np.cross(turn, pose.matrix[:, 2])).max() * radius
    return isinstance(shape, Sphere) or bool(across < still)


def _of_revolution(geometry: Geometry, part: int, motion: Array, center: Array) -> bool:
    """True if a motion, shape (6,), maps every face of a part to itself."""
    surfaces, turn = geometry.surfaces, motion[3:] / np.linalg.norm(motion[3:])
    near = ACROSS * float(geometry.radius[part]) + float(geometry.accuracy[part])
    faces = np.arange(surfaces.start[part], surfaces.start[part + 1])
    if (surfaces.kind[faces] == FREE).any():
        return False
    through = center + np.cross(motion[3:], motion[:3]) / (motion[3:] @ motion[3:])
    off = np.linalg.norm(np.cross(surfaces.point[faces] - through, turn), axis=1)
    leans = np.linalg.norm(np.cross(surfaces.axis[faces], turn), axis=1)
    if (off > near).any() or (leans[surfaces.kind[faces] != SPHERE] > ACROSS).any():
        return False
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    corners = geometry.vertices[geometry.triangles[span][geometry.triangle_surface[span] < 0]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    aside = np.linalg.norm(np.cross(normal, turn), axis=1)
    return bool(len(faces)) and bool((aside <= ACROSS * np.linalg.norm(normal, axis=1)).all())
