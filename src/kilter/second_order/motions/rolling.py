"""What balances, with friction at every contact: does it roll back, or off?

Where nothing slips, all contact points are at rest relative to each other: G z = 0 with three rows
a contact (two in the plane). Differentiated along such a rolling,

    G d + g(z) = 0,     g = w_b x (x' - c_b') - w_a x (x' - c_a'),     x' = v_a(x) + s

w the turns, c' the velocities of the centres of mass, and s how the point of touch moves over both:
s = -(A + B)^-1 n x (w_b - w_a) in the directions in which both features extend. With forces f of
equilibrium, G^T f + w = 0, the energy curves as

    E'' = -sum of f_k . g_k(z)

Said is only what is proved. With rows of G independent, f is unique and rolling has the same
dimension near by; f strictly within the cones, nothing slips at first. Then

    holds   E'' > 0 where rolling is holonomic: in the plane, or of one dimension, or none
    falls   E'' < 0 along some rolling, where the stiffness is symmetric: the same, or one contact
            with an upright normal (a root of the linear equations of motion grows)

One body on two points has f up to a squeeze along their line, which does no work. Points of one
body slip alike along their line; so where one f is within the cones, none makes a point slip: a
slip straight across the line needs the friction across it, which is unique, at its limit, and any
other slips both points to the same side, each with all the friction that is left of the limit.

That nothing else begins from rest is asked elsewhere (`guarantee`): what stands without friction,
as all do that `check` asks this of, has no other start.
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
"""Of the rollings of clusters, the first that one of them has is that of all."""


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """What is proved of rolling.

    Attributes
    ----------
    state : {"holds", "falls", "open"}
    dimension : int
        Of the rollings.
    curvature : float
        Least E'' over weight and length, of rollings of length 1; 0 where there are none.
    why : str
        Why it is open.
    forces : ndarray, shape (K, 3)
        On part b [N].
    motion : ndarray, shape (N, 6)
        The rolling of least E'', of length 1; 0 where there is none.
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
    """Of several clusters that balance."""
    return min(states, key=ORDER.index, default="open")


def find_rolling(program: Program, features: Features) -> Rolling:
    """Whether what stands with friction comes back when it rolls.

    Parameters
    ----------
    program : Program
        With friction.
    features : Features
        Of its rows.
    """
    why = _beyond(program, features)
    if why:
        return _open(program, why)
    scale = _scale(program)
    grip = _grip(program) * scale
    load = program.load[np.ix_(program.free, program.freedoms)].reshape(-1) * scale
    sizes = np.linalg.svd(grip, compute_uv=False)
    rank = int((sizes > BALANCED * sizes.max(initial=TINY)).sum())
    found = np.linalg.lstsq(grip.T, -load, rcond=None)[0]
    if np.abs(grip.T @ found + load).max() > BALANCED * np.abs(load).max():
        return _open(program, "no forces balance it")
    forces = found.reshape(len(program.part_a), -1) @ _directions(program)
    if not _inside(program, forces):
        return _open(program, "its forces are not within the cones of friction")
    basis = null_space(grip, BALANCED) * scale[:, None]
    stiffness = _stiffness(program, features, forces, basis)
    return _said(program, basis, stiffness, forces, unique=rank == len(grip))


def _said(
    program: Program, basis: Array, stiffness: Array, forces: Array, *, unique: bool
) -> Rolling:
    """Holds, falls, or open."""
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
    sure = unique or (count == 2 and program.free.sum() == 1)
    why = "friction is not determined"
    if dimension and least < -CURVED:
        if (holonomic and sure) or (unique and count == 1 and upright):
            return Rolling("falls", dimension, least, "", forces, motion)
        why = why if not unique else "rolling is not holonomic"
    elif sure:
        if holonomic and (not dimension or least > CURVED):
            return Rolling("holds", dimension, least, "", forces, motion)
        why = "it is too near a limit" if holonomic else "rolling is not holonomic"
    return Rolling("open", dimension, least, why, forces, motion)


def _open(program: Program, why: str) -> Rolling:
    none = np.zeros((len(program.part_a), 3)), np.zeros((len(program.names), 6))
    return Rolling("open", 0, 0.0, why, *none)


def _beyond(program: Program, features: Features) -> str:
    """Why nothing is said."""
    if (program.kind != CONTACT).any() or program.pull.any() or program.tied.any():
        return "joints and bonds are not looked at"
    if not (program.mu > 0).all():
        return "a contact does not rub"
    if np.abs(program.applied[program.free, 3:]).max(initial=0.0) > 0:
        return "loads beside a centre of mass are not looked at"
    if not formed(program, features).all() or features.conformal.any():
        return "how its surfaces curve where they touch is not known"
    return ""


def _scale(program: Program) -> Array:
    """Of displacements: lengths as they are, turns over the radius of the part, shape (n,)."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    return np.asarray(units[:, program.freedoms].reshape(-1))


def _directions(program: Program) -> Array:
    """Unit directions in which contact points do not slip, as rows."""
    return np.eye(3)[[0, 2]] if program.planar else np.eye(3)


def _grip(program: Program) -> Array:
    """G, shape (rows of all contacts, freedoms of free parts)."""
    columns = np.eye(len(program.columns))
    moved = [_relative(program, program.full(one)) for one in columns]
    return np.array([(one @ _directions(program).T).reshape(-1) for one in moved]).T


def _velocity(program: Program, motion: Array, part: Index) -> Array:
    """Of the contact points as points of these parts, shape (K, 3); 0 of the ground."""
    padded = np.vstack([motion, np.zeros((1, 6))])[part]
    center = np.vstack([program.center, np.zeros((1, 3))])[part]
    return padded[:, :3] + cross(padded[:, 3:], program.point - center)


def _relative(program: Program, motion: Array) -> Array:
    """Velocity of b over a at each contact, shape (K, 3)."""
    over = _velocity(program, motion, program.part_b)
    return over - _velocity(program, motion, program.part_a)


def _inside(program: Program, forces: Array) -> bool:
    along = np.einsum("ki,ki->k", forces, program.normal)
    aside = np.linalg.norm(forces - along[:, None] * program.normal, axis=1)
    weight = float(program.weight[program.free].max())
    return bool(((along > SLIPS * weight) & (aside < (1 - SLIPS) * program.mu * along)).all())


def _stiffness(program: Program, features: Features, forces: Array, basis: Array) -> Array:
    """E'' on the rollings of a basis, shape (d, d)."""
    dimension = basis.shape[1]
    inverse = _rolls_over(program, features)

    def bent(z: Array) -> float:
        motion = program.full(z)
        return -float(np.sum(forces * _turning(program, inverse, motion)))

    single = [bent(one) for one in basis.T]
    result = np.diag(single) if dimension else np.zeros((0, 0))
    for i in range(dimension):
        for j in range(i):
            both = bent(basis[:, i] + basis[:, j]) - single[i] - single[j]
            result[i, j] = result[j, i] = both / 2
    return result


def _turning(program: Program, inverse: Array, motion: Array) -> Array:
    """The g of a rolling, shape (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])
    a, b = padded[program.part_a], padded[program.part_b]
    turn = cross(program.normal, b[:, 3:] - a[:, 3:])
    at = _velocity(program, motion, program.part_a) - np.einsum("kij,kj->ki", inverse, turn)
    return np.asarray(cross(b[:, 3:], at - b[:, :3]) - cross(a[:, 3:], at - a[:, :3]))


def _rolls_over(program: Program, features: Features) -> Array:
    """(A + B)^-1 in the directions in which both features extend, shape (K, 3, 3), 0 in others."""
    total = features.curvature_a + features.curvature_b
    found = np.zeros_like(total)
    for k in range(len(total)):
        axes = _common(program, features, k)
        if axes.size:
            found[k] = axes.T @ np.linalg.inv(axes @ total[k] @ axes.T) @ axes
    return found


def _common(program: Program, features: Features, k: int) -> Array:
    """Unit directions in which both features of a contact extend, as rows."""
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
