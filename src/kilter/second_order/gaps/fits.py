"""Pairs of bodies that enclose each other: a shaft in its bore, a ball in its socket.

Contacts at curved surfaces of two bodies enclose each other if positive forces at them, s > 0 with
J^T s = 0, keep both at rest. These contacts stay closed without any force of the load: J z >= 0
implies J z = 0.

If all normals meet an axis and are across it, or meet in a point, both surfaces are cylinders about
the axis, or spheres about the point, with the radius of the contact points. This also describes a
fit with play that counts as closed, whose true surfaces have two radii. If the only motion that
keeps bodies closed that enclose each other turns about an axis, as that of a screw in a nut whose
thread is drawn as rings, both surfaces are surfaces of revolution about it. All held parts are a
single body.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, read_only
from kilter.mechanics.program import Program
from kilter.second_order.gaps.features import FACE, Features
from kilter.second_order.gaps.touched_surfaces import LINE, POINT, UNKNOWN, Touched
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.second_order_tolerances import BENDS


@dataclass(frozen=True, slots=True, eq=False)
class Fits:
    """Contact rows of bodies that enclose each other, and their common surfaces."""

    enclosed: Mask
    """Shape (K,)."""
    kind: Index
    """LINE for a surface of revolution and POINT for a sphere, shape (K,); UNKNOWN for any other
    surface."""
    point: Array
    direction: Array
    """Point of the axis, or centre, shape (K, 3); direction of the axis."""
    curvature: Array
    """Curvature of the surface of part a, shape (K, 3, 3); that of part b is the opposite."""

    def __post_init__(self) -> None:
        read_only(self)

    @property
    def known(self) -> Mask:
        """Mask of the rows on common cylinders and spheres, shape (K,)."""
        return np.asarray(self.kind != UNKNOWN)

    def of_features(self, features: Features) -> Features:
        """Copy of the features of all rows, with the curvature of the common surfaces."""
        at, curvature = self.known, self.curvature
        rows = at[:, None, None]
        return replace(
            features,
            kind_a=np.where(at, FACE, features.kind_a),
            kind_b=np.where(at, FACE, features.kind_b),
            edge_a=np.where(at[:, None], 0.0, features.edge_a),
            edge_b=np.where(at[:, None], 0.0, features.edge_b),
            fibre=np.where(at[:, None], 0.0, features.fibre),
            curvature_a=np.where(rows, curvature, features.curvature_a),
            curvature_b=np.where(rows, -curvature, features.curvature_b),
            conformal=features.conformal | at,
        )

    def of_touched(self, touched: Touched, rows: Index) -> Touched:
        """Copy of the surfaces of a side at some rows, with the common surfaces."""
        at = self.known[rows]
        return Touched(
            np.where(at, self.kind[rows], touched.kind),
            np.where(at[:, None], self.point[rows], touched.point),
            np.where(at[:, None], self.direction[rows], touched.direction),
        )


def find_fits(program: Program, curved: Index, play: Index | None = None) -> Fits:
    """Find the bodies that enclose each other, and fits with play that count as closed.

    Arguments: `play`: rows among these of cylinders and spheres with play: they fit even if they do
    not enclose each other, as a bar in half a bore.
    """
    count = len(program.kind)
    enclosed, kind = np.zeros(count, dtype=bool), np.full(count, UNKNOWN)
    point, direction = np.zeros((2, count, 3))
    curvature = np.zeros((count, 3, 3))
    pair = body_pairs(program)[curved]
    for number in np.unique(pair):
        rows = curved[pair == number]
        enclosed[rows] = stressed(wrenches(program, rows))
        if enclosed[rows[0]] or (play is not None and np.isin(rows, play).all()):
            found = _common_surface(program.point[rows], program.normal[rows])
            if found is None and enclosed[rows[0]]:
                found = _revolved_surface(program.point[rows], program.normal[rows])
            if found is not None:
                kind[rows], point[rows], direction[rows], curvature[rows] = found
    return Fits(enclosed, kind, point, direction, curvature)


def body_pairs(program: Program) -> Index:
    """Number of the pair of bodies of each row, shape (K,); all held parts are one body."""
    body = np.append(np.where(program.free, np.arange(len(program.free)), -1), -1)
    ends = np.sort(np.column_stack([body[program.part_a], body[program.part_b]]), axis=1)
    return np.asarray((ends[:, 0] + 1) * (len(body) + 1) + ends[:, 1] + 1)


def wrenches(program: Program, rows: Index) -> Array:
    """Wrench of a unit force at each row of a pair on the same free body, scaled, shape (k, m)."""
    first, free = int(rows[0]), np.append(program.free, False)
    b = int(program.part_b[first])
    body = b if free[b] else int(program.part_a[first])
    sense = np.where(program.part_b[rows] == body, 1.0, -1.0)
    lever = program.lever(rows, np.full(len(rows), body))[:, program.freedoms]
    scaled = lever / np.where(program.freedoms < 3, 1.0, program.radius[body])
    return np.asarray(sense[:, None] * scaled)


def stressed(wrench: Array) -> bool:
    """True if positive forces at all rows, with these wrenches, keep a body at rest."""
    ones = np.ones(len(wrench))
    stress = ones - wrench @ np.linalg.lstsq(wrench, ones, rcond=1e-9)[0]
    return bool(stress.min() > BENDS)


def _common_surface(point: Array, normal: Array) -> tuple[int, Array, Array, Array] | None:
    """Kind, point, direction and curvatures (k, 3, 3) of the surface at points with normals."""
    axis = null_space(normal, BENDS)
    across = np.eye(3) - (np.outer(axis[:, 0], axis[:, 0]) if axis.shape[1] else 0.0)
    if axis.shape[1] > 1:
        return None
    # normal x (point - centre) = 0, for an axis along the axis only
    parts = axis.T if axis.shape[1] else np.eye(3)
    moment = cross(normal, point @ across) @ parts.T
    turns = np.stack([np.cross(normal, across[k]) @ parts.T for k in range(3)], axis=2)
    centre = np.linalg.lstsq(turns.reshape(-1, 3), moment.reshape(-1), rcond=1e-9)[0] @ across
    arms = (point - centre) @ across
    radius = np.einsum("ij,ij->i", arms, normal)
    size = float(np.abs(radius).max())
    if np.abs(arms - radius[:, None] * normal).max() > BENDS * size or not radius.all():
        return None
    tangent = across - normal[:, :, None] * normal[:, None, :]
    kind = LINE if axis.shape[1] else POINT
    direction = axis[:, 0] if axis.shape[1] else normal[0]
    return kind, centre, direction, tangent / radius[:, None, None]


def _revolved_surface(point: Array, normal: Array) -> tuple[int, Array, Array, Array] | None:
    """Kind, point, direction and curvatures (k, 3, 3) of a surface of revolution at points.

    The normals keep a turn about its axis closed, and no other motion. The curvature along the
    meridian does not count: no motion goes along it.
    """
    middle = point.mean(axis=0)
    size = float(np.linalg.norm(point - middle, axis=1).max())
    away = (point - middle) / size
    twist = null_space(np.hstack([normal, cross(away, normal)]), BENDS)
    if twist.shape[1] != 1:
        return None
    move, turn = twist[:3, 0], twist[3:, 0]
    rate = float(turn @ turn)
    if rate < BENDS or abs(move @ turn) > BENDS * rate:
        return None
    axis = turn / np.sqrt(rate)
    centre = np.cross(turn, move) / rate
    arms = away - centre
    arms = arms - np.outer(arms @ axis, axis)
    radius = np.linalg.norm(arms, axis=1)
    if radius.min() < BENDS:
        return None
    around = cross(axis, arms) / radius[:, None]
    bent = np.einsum("ij,ij->i", arms, normal) / (radius**2 * size)
    curvature = bent[:, None, None] * around[:, :, None] * around[:, None, :]
    return LINE, middle + size * centre, axis, curvature
