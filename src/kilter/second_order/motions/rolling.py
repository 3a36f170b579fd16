"""Rolling without slip: does friction hold a balanced assembly, or does it roll and fall?

If no contact slips, all contact points are at rest relative to each other: G z = 0, with three rows
for each contact (two in the plane). Differentiated along such a rolling z,

    G d + g(z) = 0,     g = w_b x (x' - c_b') - w_a x (x' - c_a'),     x' = v_a(x) + s

with the angular velocities w, the velocities c' of the centres of mass, and the velocity s of the
contact point over both surfaces: s = -(A + B)^-1 n x (w_b - w_a) in the directions in which both
features extend. With forces f of equilibrium, G^T f + w = 0, the curvature of the energy is

    E'' = -sum of f_k . g_k(z)

Only proved results are reported. If the rows of G are independent, f is unique, and rolling has the
same dimension near by. If f is strictly within the friction cones, no contact slips at first. Then

    holds   E'' > 0, if rolling is holonomic: in the plane, or of dimension 1 or 0
    falls   E'' < 0 along some rolling, if the stiffness is symmetric: in the same cases, or for a
            single contact with an upright normal (a root of the linear equations of motion grows)

A single body on two points has f up to a squeeze along their line, which does no work. Points of a
body slip alike along their line, so if an f is within the cones, no other f makes a point slip: a
slip straight across the line needs the friction across it, which is unique, at its limit, and any
other slip moves both points to the same side, each with all the friction that is left of the limit.

`guarantee` decides whether another motion starts from rest. An assembly that is stable without
friction, as `check` requires here, has no other start.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.arrays import TINY, Array, Index, cross, read_only
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.gaps.features import EDGE, FACE, Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.second_order_tolerances import BALANCED, CURVED, SLIPS

__all__ = ["Rolling", "Rolls", "find_rolling", "worst_rolling"]

Rolls = Literal["holds", "falls", "open"]
ORDER: tuple[Rolls, ...] = ("falls", "open", "holds")
"""Results about rolling; an assembly has the first one that any of its clusters has."""


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """Result about rolling without slip (holds, falls or open), with its proof.

    Attributes
    ----------
    state : {"holds", "falls", "open"}
    dimension : int
        Dimension of the rollings.
    curvature : float
        Least E'' over weight and length, for rollings of length 1 [-]; 0 if there are none.
    why : str
        Reason for an open result.
    forces : ndarray, shape (K, 3)
        Forces on part b [N].
    motion : ndarray, shape (N, 6)
        Rolling with the least E'', of length 1; 0 if there is none.
    """

    state: Rolls
    dimension: int
    curvature: float
    why: str
    forces: Array
    motion: Array

    def __post_init__(self) -> None:
        read_only(self)


def worst_rolling(states: Iterable[Rolls]) -> Rolls:
    """Combine the results about rolling of several clusters to the result of the assembly."""
    return min(states, key=ORDER.index, default="open")


def find_rolling(program: Program, features: Features) -> Rolling:
    """Decide whether friction holds a balanced cluster against rolling without slip.

    Parameters
    ----------
    program : Program
        Contacts of the cluster, with friction.
    features : Features
        Features of its rows.
    """
    why = _unmodelled_reason(program, features)
    if why:
        return _open(program, why)
    scale = _scale(program)
    grip = _grip(program) * scale
    load = program.load[np.ix_(program.free, program.freedoms)].reshape(-1) * scale
    sizes = np.linalg.svd(grip, compute_uv=False)
    rank = int((sizes > BALANCED * sizes.max(initial=TINY)).sum())
    components = np.linalg.lstsq(grip.T, -load, rcond=None)[0]
    if np.abs(grip.T @ components + load).max() > BALANCED * np.abs(load).max():
        return _open(program, "no forces balance it")
    forces = components.reshape(len(program.part_a), -1) @ _directions(program)
    if not _all_inside_cones(program, forces):
        return _open(program, "its forces are not within the cones of friction")
    basis = null_space(grip, BALANCED) * scale[:, None]
    stiffness = _stiffness(program, features, forces, basis)
    return _result(program, basis, stiffness, forces, unique=rank == len(grip))


def _result(
    program: Program, basis: Array, stiffness: Array, forces: Array, *, unique: bool
) -> Rolling:
    """Result about rolling, from the energy's second derivative on a basis of rolling motions."""
    dimension = basis.shape[1]
    weight = float(program.weight[program.free].max())
    length = float(program.radius[program.free].max())
    values, axes = np.linalg.eigh(stiffness / (weight * length))
    least = float(values[0]) if dimension else 0.0
    motion = program.full(basis @ axes[:, 0] if dimension else np.zeros(len(basis)))
    holonomic = program.planar or dimension <= 1
    count = len(program.part_a)
    upright = (
        np.abs(np.linalg.norm(np.cross(program.normal, program.down), axis=1)).max() < BALANCED
    )
    sure = unique or (count == 2 and program.free.sum() == 1)  # a squeeze does no work
    why = "its friction forces are not unique"
    if dimension and least < -CURVED:
        if (holonomic and sure) or (unique and count == 1 and upright):
            return Rolling("falls", dimension, least, "", forces, motion)
        why = why if not unique else "its rolling depends on the path, which is not modelled"
    elif sure:
        if holonomic and (not dimension or least > CURVED):
            return Rolling("holds", dimension, least, "", forces, motion)
        why = (
            "it is too close to the boundary of two answers"
            if holonomic
            else "its rolling depends on the path, which is not modelled"
        )
    return Rolling("open", dimension, least, why, forces, motion)


def _open(program: Program, why: str) -> Rolling:
    none = np.zeros((len(program.part_a), 3)), np.zeros((len(program.names), 6))
    return Rolling("open", 0, 0.0, why, *none)


def _unmodelled_reason(program: Program, features: Features) -> str:
    """Reason why rolling of a cluster cannot be modelled; empty if it can."""
    if (program.kind != CONTACT).any() or program.pull.any() or program.tied.any():
        return "rolling is not modelled with joints and bonds"
    if not (program.mu > 0).all():
        return "a contact has no friction"
    if np.abs(program.applied[program.free, 3:]).max(initial=0.0) > 0:
        return "rolling is not modelled with loads beside a centre of mass"
    if not formed(program, features).all() or features.conformal.any():
        return "the curvature of its surfaces at a contact is not known"
    return ""


def _scale(program: Program) -> Array:
    """Displacement for one unit of each unknown, shape (n,): 1 for shifts, 1 / radius for turns."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    return np.asarray(units[:, program.freedoms].reshape(-1))


def _directions(program: Program) -> Array:
    """Unit directions in which contact points must not slip, as rows: three, or two planar."""
    return np.eye(3)[[0, 2]] if program.planar else np.eye(3)


def _grip(program: Program) -> Array:
    """Matrix G from motions of the free parts to slips at all contacts."""
    columns = np.eye(len(program.columns))
    slips = [_slip(program, program.full(column)) for column in columns]
    return np.array([(slip @ _directions(program).T).reshape(-1) for slip in slips]).T


def _velocity(program: Program, motion: Array, part: Index) -> Array:
    """Velocities at the contact points of the material of the given parts, shape (K, 3).

    Points of the ground have the velocity 0.
    """
    padded = np.vstack([motion, np.zeros((1, 6))])[part]
    center = np.vstack([program.center, np.zeros((1, 3))])[part]
    return padded[:, :3] + cross(padded[:, 3:], program.point - center)


def _slip(program: Program, motion: Array) -> Array:
    """Velocity of part b relative to part a at each contact point, shape (K, 3)."""
    over = _velocity(program, motion, program.part_b)
    return over - _velocity(program, motion, program.part_a)


def _all_inside_cones(program: Program, forces: Array) -> bool:
    """True if all contact forces, shape (K, 3), are strictly within their friction cones."""
    along = np.einsum("ki,ki->k", forces, program.normal)
    aside = np.linalg.norm(forces - along[:, None] * program.normal, axis=1)
    weight = float(program.weight[program.free].max())
    return bool(((along > SLIPS * weight) & (aside < (1 - SLIPS) * program.mu * along)).all())


def _stiffness(program: Program, features: Features, forces: Array, basis: Array) -> Array:
    """Second derivative of the energy on a basis of rolling motions, shape (d, d)."""
    dimension = basis.shape[1]
    inverse = _rolls_over(program, features)

    def curvature(z: Array) -> float:
        motion = program.full(z)
        return -float(np.sum(forces * _turning(program, inverse, motion)))

    single = [curvature(column) for column in basis.T]
    result = np.diag(single) if dimension else np.zeros((0, 0))
    for i in range(dimension):
        for j in range(i):
            both = curvature(basis[:, i] + basis[:, j]) - single[i] - single[j]
            result[i, j] = result[j, i] = both / 2
    return result


def _turning(program: Program, inverse: Array, motion: Array) -> Array:
    """Second-order part of the slip in a rolling motion, at each contact, shape (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])
    a, b = padded[program.part_a], padded[program.part_b]
    turn = cross(program.normal, b[:, 3:] - a[:, 3:])
    at = _velocity(program, motion, program.part_a) - np.einsum("kij,kj->ki", inverse, turn)
    return np.asarray(cross(b[:, 3:], at - b[:, :3]) - cross(a[:, 3:], at - a[:, :3]))


def _rolls_over(program: Program, features: Features) -> Array:
    """Inverse of the sum of both curvatures, within their common directions, (K, 3, 3)."""
    total = features.curvature_a + features.curvature_b
    inverse = np.zeros_like(total)
    for k in range(len(total)):
        axes = _common(program, features, k)
        if axes.size:
            inverse[k] = axes.T @ np.linalg.inv(axes @ total[k] @ axes.T) @ axes
    return inverse


def _common(program: Program, features: Features, k: int) -> Array:
    """Unit tangents along which both features of contact k extend, as rows."""
    away = [program.normal[k]]
    for kind, edge in (
        (features.kind_a[k], features.edge_a[k]),
        (features.kind_b[k], features.edge_b[k]),
    ):
        if kind == EDGE:
            away.append(np.cross(program.normal[k], edge))
        elif kind != FACE:
            return np.zeros((0, 3))
    if features.fibre[k].any():
        away.append(features.fibre[k])
    if program.planar:
        away.append(np.array([0.0, 1.0, 0.0]))
    return null_space(np.array(away), BALANCED).T
