"""Exact solids with a free-form face: prisms over an oval, and blocks that meet in a joint."""

import dataclasses

import numpy as np

from kilter.assembly import Assembly
from kilter.assembly.polyhedra import polyhedron_moments
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, Surface

__all__ = ["as_solids", "oval", "oval_hole", "oval_plug"]


def as_solid(mesh: Mesh, free: np.ndarray, sagitta: float) -> Solid:
    """A mesh as a solid: `free` triangles lie on a free form, the others on planes."""
    corners = mesh.vertices[mesh.triangles]
    out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    out /= np.linalg.norm(out, axis=1)[:, None]
    labels = np.full(len(corners), -1)
    planes: list[Surface] = []
    for k in np.flatnonzero(~free).tolist():
        if labels[k] >= 0:
            continue
        level = np.abs((corners - corners[k, 0]) @ out[k]).max(axis=1) < 1e-9
        labels[level & (out @ out[k] > 1 - 1e-9) & ~free] = len(planes)
        planes.append(Surface("plane", corners[k, 0], out[k]))
    starts = np.array([0, len(corners)])
    volume, center, second, _ = polyhedron_moments(mesh.vertices, mesh.triangles, starts)
    return Solid(
        mesh.vertices,
        mesh.triangles,
        tuple(planes),
        labels,
        volume[0],
        center[0],
        second[0],
        sagitta,
    )


def as_solids(assembly: Assembly, sagitta: float) -> Assembly:
    """Blocks of a joint as solids whose joint is a free form."""
    parts = []
    for part in assembly.parts:
        corners = part.shape.vertices[part.shape.triangles]
        out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        far = np.abs(part.shape.vertices[:, 2]).max()
        level = (np.abs(corners[..., 2]) > far - 1e-9).all(axis=1)
        free = (np.abs(out[:, 2]) > 1e-9) & ~level
        parts.append(dataclasses.replace(part, shape=as_solid(part.shape, free, sagitta)))
    return dataclasses.replace(assembly, parts=tuple(parts))


def oval(sides: int, out: float = 0.0, *, a: float = 2.0, b: float = 1.0, phase: float = 0.0):
    """Corners (n, 2) of an ellipse, moved out along its normals."""
    t = phase + np.arange(sides) * 2 * np.pi / sides
    normal = np.column_stack([b * np.cos(t), a * np.sin(t)])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return np.column_stack([a * np.cos(t), b * np.sin(t)]) + out * normal


def rings(*levels: tuple[np.ndarray, float]) -> np.ndarray:
    """Outlines (n, 2) at heights, in order."""
    return np.concatenate([np.column_stack([p, np.full(len(p), z)]) for p, z in levels])


def band(low: int, high: int, sides: int) -> np.ndarray:
    """Triangles between two outlines, given by their first corners, turned outwards."""
    k = np.arange(sides)
    m = (k + 1) % sides
    one = np.column_stack([low + k, low + m, high + m])
    return np.concatenate([one, np.column_stack([low + k, high + m, high + k])])


def oval_plug(sides: int = 48, low: float = -1.0, high: float = 1.0, **outline: float) -> Solid:
    """A plug over an oval; its side is a free form."""
    points = oval(sides, **outline)
    vertices = np.concatenate([rings((points, low), (points, high)), [[0, 0, low], [0, 0, high]]])
    k = np.arange(sides)
    m = (k + 1) % sides
    bottom = np.column_stack([m, k, np.full(sides, 2 * sides)])
    top = np.column_stack([k + sides, m + sides, np.full(sides, 2 * sides + 1)])
    faces = np.concatenate([band(0, sides, sides), bottom, top])
    free = np.arange(len(faces)) < 2 * sides
    return as_solid(Mesh(vertices, faces), free, _sagitta(points))


def oval_hole(sides: int = 48, low: float = -1.0, high: float = 1.0, **outline: float) -> Solid:
    """A hole over an oval in an oval plate; its side and the rim of the plate are free forms."""
    inner, outer = oval(sides, **outline), oval(sides, a=4.0, b=3.0)
    vertices = rings((inner, low), (inner, high), (outer, low), (outer, high))
    n = sides
    hole, rim = band(0, n, n)[:, ::-1], band(2 * n, 3 * n, n)
    faces = np.concatenate([hole, rim, band(2 * n, 0, n)[:, ::-1], band(3 * n, n, n)])
    free = np.arange(len(faces)) < 4 * n
    return as_solid(Mesh(vertices, faces), free, _sagitta(outer))


def _sagitta(points: np.ndarray) -> float:
    """Lower bound of the height of the outline over its chords: that of the most curved circle."""
    step = np.roll(points, -1, axis=0) - points
    bend = np.roll(step, -1, axis=0) - step
    return float(np.linalg.norm(bend, axis=1).max() / 8)
