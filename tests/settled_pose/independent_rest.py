"""A second program for poses at rest of boxes and other convex parts, from their corners alone.

It shares no function with the search or its verification. The gap of two convex parts is the
largest distance of parallel planes that separate them. The closed points are corners of a part on
planes of the other, and corners of overlaps. A linear program over pyramids of forces, which lie
inside Coulomb's cones, balances the parts.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from kilter import Assembly

SIDES = 32
"""Sides of the pyramid inside a cone of forces."""


def hull_of(assembly: Assembly, part: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners, outward normals and offsets of the hull of a part."""
    geometry = assembly.geometry
    corners = geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]
    center = corners.mean(axis=0)
    hull = ConvexHull(corners - center)
    planes = np.unique(hull.equations.round(12), axis=0)
    return corners, planes[:, :3], -planes[:, 3] + planes[:, :3] @ center


def separation(assembly: Assembly, a: int, b: int) -> float:
    """Largest distance of two parallel planes between convex parts; negative: the depth."""
    corners_a, normals_a, _ = hull_of(assembly, a)
    corners_b, normals_b, _ = hull_of(assembly, b)
    edges = [_edge_directions(corners, normals) for corners, normals in
             ((corners_a, normals_a), (corners_b, normals_b))]  # fmt: skip
    across = [np.cross(x, y) for x, y in itertools.product(*edges)]
    sound = [v / np.linalg.norm(v) for v in across if np.linalg.norm(v) > 1e-3]
    normals = np.array([*normals_a, *-normals_b, *sound, *(-v for v in sound)])
    gaps = (normals @ corners_b.T).min(axis=1) - (normals @ corners_a.T).max(axis=1)
    return float(gaps.max())


def _edge_directions(corners: np.ndarray, normals: np.ndarray) -> list[np.ndarray]:
    """Distinct directions of the edges of a convex part: crossings of its planes."""
    found: list[np.ndarray] = []
    for m, n in itertools.combinations(normals, 2):
        v = np.cross(m, n)
        if np.linalg.norm(v) < 1e-3:
            continue
        v /= np.linalg.norm(v)
        if all(abs(v @ w) < 1 - 1e-9 for w in found):
            found.append(v)
    return found


def closed_forces(assembly: Assembly, gap: float) -> list[tuple[int, int, np.ndarray, np.ndarray]]:
    """Corners of a part on a face of another part: parts a and b, point, normal from a to b."""
    points = []
    for a, b in itertools.permutations(range(len(assembly)), 2):
        _, normals, offsets = hull_of(assembly, a)
        corners, _, _ = hull_of(assembly, b)
        if separation(assembly, min(a, b), max(a, b)) > gap:
            continue
        height = corners @ normals.T - offsets
        for corner, row in zip(corners, height, strict=True):
            if row.max() <= gap:
                points += [(a, b, corner, normals[k]) for k in np.flatnonzero(row >= -gap)]
    return points + _crossings(assembly, gap)


def _crossings(assembly: Assembly, gap: float) -> list[tuple[int, int, np.ndarray, np.ndarray]]:
    """Corners of the overlaps of faces in the same plane that are corners of neither part."""
    points = []
    for a, b in itertools.permutations(range(len(assembly)), 2):
        _, normals_a, offsets_a = hull_of(assembly, a)
        _, normals_b, offsets_b = hull_of(assembly, b)
        if abs(separation(assembly, min(a, b), max(a, b))) > gap:
            continue
        for k, l in itertools.product(range(len(normals_a)), range(len(normals_b))):
            if normals_a[k] @ normals_b[l] > -1 + 1e-4:
                continue
            planes = np.vstack([normals_a, normals_b])
            limits = np.concatenate([offsets_a, offsets_b])
            for i, j in itertools.product(range(len(normals_a)), range(len(normals_b))):
                triple = np.array([normals_a[k], normals_a[i], normals_b[j]])
                if abs(np.linalg.det(triple)) < 1e-2:
                    continue
                x = np.linalg.solve(triple, [offsets_a[k], offsets_a[i], offsets_b[j]])
                if (planes @ x - limits).max() <= 2 * gap:
                    points.append((a, b, x, normals_a[k]))
    return points


def balances(assembly: Assembly, gap: float) -> float:
    """Largest unbalanced force or torque, over the mean weight, of the best closed forces."""
    points = closed_forces(assembly, gap)
    geometry = assembly.geometry
    free = np.flatnonzero(~geometry.grounded).tolist()
    columns = []
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    for a, b, x, n in points:
        u = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
        u /= np.linalg.norm(u)
        v = np.cross(n, u)
        rays = [n] if assembly.friction == 0 else [
            n + assembly.friction * (np.cos(t) * u + np.sin(t) * v) for t in angles
        ]  # fmt: skip
        for ray in rays:
            column = np.zeros(6 * len(free))
            for part, sign in ((a, -1.0), (b, 1.0)):
                if part in free:
                    at = 6 * free.index(part)
                    column[at : at + 3] += sign * ray
                    column[at + 3 : at + 6] += sign * np.cross(x - geometry.center[part], ray)
            columns.append(column)
    weight = float(geometry.mass[free].mean() * np.linalg.norm(assembly.gravity))
    load = np.zeros((len(free), 6))
    load[:, :3] = geometry.mass[free][:, None] * assembly.gravity / weight
    # the parts of a planar assembly move in x-z only: two forces and a torque about y balance
    freedoms = [0, 2, 4] if assembly.planar else list(range(6))
    rows = (6 * np.arange(len(free))[:, None] + freedoms).ravel()
    load = load.ravel()[rows]
    matrix = np.array(columns).T[rows] if columns else np.zeros((len(load), 0))
    count = matrix.shape[1]
    # least t with |matrix f + load| <= t
    rows = np.block([[matrix, -np.ones((len(load), 1))], [-matrix, -np.ones((len(load), 1))]])
    answer = linprog(
        np.append(np.zeros(count), 1.0), A_ub=rows, b_ub=np.concatenate([-load, load]),
        bounds=[(0, None)] * (count + 1), method="highs",
    )  # fmt: skip
    return float(answer.fun)
