"""What stands on level faces is free by proof, at any size, without a form of a gap.

A level motion of a part moves it across gravity and turns it about the vertical. Where a level
face touches a face, an edge or a corner, no level motion changes the gap, and none changes the
energy. With forces f of equilibrium on such contacts alone, let S be those with f > 0:

    every part stands on points of S that are on no line, and no parts bear one another around

Then what bears a part holds its height and its tilts, from below to the top: J_S is one to one.

Near the place, at each choice x of level motions of all parts, there are forces f(x) > 0 on
S that still balance, and with t the heights and tilts

    E - E_0 = sum over S of f_k(x) J_k(x) t,     J_k(x) t >= -O(t^2),     J_S(x) one to one,

so that E > E_0 unless t = 0: the energy is least, and least on the level motions alone. One level
motion that opens all the other contacts shows that they span what is neutral.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, Index, Mask, across, read_only
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.second_order.critical import carrying_forces
from kilter.second_order.features_of import FLAT, detected_rows
from kilter.second_order.held import unbalanced
from kilter.second_order.second_order_tolerances import (
    ACROSS,
    BALANCED,
    BEARS,
    CARRIES,
    DROPS,
    SPREAD,
)

__all__ = ["LevelRest", "find_level_rest", "judge_level_rest", "level_axes", "level_rows"]

MOST_ASKED = 100
"""A linear program spreads the load of up to this many parts, where all else fails."""
POLISHED = 2
"""Times that its forces are balanced."""
PULLS = 1e-3
"""Forces of least squares below this share of a part's load are found again so that all push."""
MOST_CHANGED = 0.5
"""Share of a force that may be lacking for it to balance the load exactly."""
STEPS = 30
"""Of Newton's method, ..."""
ROUNDING = 1e-13
"""... until this share of the load is left."""


@dataclass(frozen=True, slots=True, eq=False)
class LevelRest:
    """A proof that the level motions are what is neutral, and free.

    `forces`, shape (K,) [N]; `motion`, shape (N, 6): a level one, the part that moves most by 1
    length unit.
    """

    forces: Array
    motion: Array

    def __post_init__(self) -> None:
        read_only(self)


def level_rows(program: Program, contacts: ContactSet) -> Mask:
    """Rows of level faces that were found, shape (K,)."""
    flat = [kind for kind in FLAT if kind != "edge-edge"]
    level = np.zeros(len(program.part_a), dtype=bool)
    rows = detected_rows(program, contacts)
    upright = np.linalg.norm(np.cross(program.normal[rows], program.down), axis=1) < BALANCED
    level[rows] = upright & np.isin(contacts.patch_kind[program.source[rows]], flat)
    return level


def find_level_rest(program: Program, level: Mask, forces: Array | None) -> LevelRest | None:
    """A proof for a program of contacts without friction; None where none was found.

    Parameters
    ----------
    program : Program
    level : ndarray of bool, shape (K,)
    forces : ndarray, shape (K,), optional
        Of some equilibrium [N].
    """
    if not level.any():
        return None
    motion = _opening(program, level)
    if motion is None:
        return None
    for offered in _offered(program, level, forces):
        if not _wrong_forces(program, level, offered):
            return LevelRest(offered, motion)
    return None


def _offered(program: Program, level: Mask, forces: Array | None) -> Iterator[Array]:
    """Forces of equilibrium [N], the cheapest first, where every part has a footing."""
    bearing = _bearing(program, level)
    if bearing is None:
        return
    above, below = bearing.both_footings(program)
    grams = _grams(program, bearing.upper, above)
    if not _spread(grams[program.free]):
        return
    from_above = _from_above(program, bearing, (above, below), grams)
    if from_above is not None:
        yield from_above
    if forces is not None:
        yield forces
    if program.free.sum() <= MOST_ASKED:
        asked = _asked(program, level)
        if asked is not None:
            yield asked


def _asked(program: Program, level: Mask) -> Array | None:
    """Forces on every level row that can carry [N], by a linear program, then balanced."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    units = units[:, program.freedoms].reshape(-1)
    weight = float(program.weight[program.free].max())
    load = program.load[np.ix_(program.free, program.freedoms)].reshape(-1) * units / weight
    rows = csr_array(program.jacobian()[level] @ diags_array(units))
    found = carrying_forces(rows, load)
    if found is None:
        return None
    forces, carries = found
    own = rows[carries]
    gram = (own.T @ own).toarray() + ROUNDING * np.eye(len(load))
    for _ in range(POLISHED):
        miss = own.T @ forces[carries] + load
        forces[carries] -= own @ np.linalg.solve(gram, miss)
    spread = np.zeros(len(level))
    spread[level] = forces * weight
    return spread


def judge_level_rest(program: Program, level: Mask, proof: LevelRest) -> str:
    """Why a proof does not hold; empty where it does."""
    if proof.forces.shape != level.shape or proof.motion.shape != (len(program.names), 6):
        return "its numbers are not those of the parts and contacts"
    if not (np.isfinite(proof.forces).all() and np.isfinite(proof.motion).all()):
        return "its numbers are not finite"
    wrong = _wrong_forces(program, level, proof.forces)
    return wrong or _wrong_motion(program, level, proof.motion)


def _wrong_forces(program: Program, level: Mask, forces: Array) -> str:
    if not (forces >= 0).all() or forces[~level].any():
        return "a force is none of a level face"
    if not unbalanced(program, forces) <= BALANCED:
        return "its forces do not balance the load"
    carries = forces > CARRIES * forces.max(initial=TINY)
    bearing = _bearing(program, level & carries)
    if bearing is None:
        return "parts bear one another around"
    if not _bear_all(program, bearing, forces):
        return "its forces leave the tilt of a part open"
    return ""


def _bear_all(program: Program, bearing: _Bearing, forces: Array) -> bool:
    """Whether forces that balance to the last digit, f (1 + y . (1, u, v)), all push.

    y of each part makes good what its own forces miss of its load and of what bears on it, the
    highest part first. What may be out of balance changes no force by more than that, either.
    """
    rows, upper, lower = bearing.rows, bearing.upper, bearing.lower
    above, below = bearing.both_footings(program)
    count, own = len(program.names), forces[rows, None]
    grams = _sums(upper, own[:, :, None] * above[:, :, None] * above[:, None, :], count)
    need = np.vstack([_in_footing(program, -program.load), np.zeros((1, above.shape[1]))])
    need += _sums(lower % len(need), own * below, len(need))
    borne = np.trace(grams, axis1=1, axis2=2)[program.free]
    spread = np.linalg.eigvalsh(grams[program.free])[:, 0]
    if not (spread > SPREAD * borne).all():
        return False
    inverse = np.zeros_like(grams)
    inverse[program.free] = np.linalg.inv(grams[program.free])
    most = BEARS * BALANCED * np.trace(grams, axis1=1, axis2=2)[upper]
    reach = np.linalg.norm(np.einsum("kij,kj->ki", inverse[upper], above), axis=1)
    if not (most * reach < MOST_CHANGED).all():
        return False
    miss = need[:-1] - _sums(upper, own * above, count)
    miss = np.vstack([miss, np.zeros((1, miss.shape[1]))])
    for some in _by_depth(bearing.depth[upper]):
        y = np.einsum("kij,kj->ki", inverse[upper[some]], miss[upper[some]])
        change = np.einsum("ki,ki->k", above[some], y)
        if not (np.abs(change) < MOST_CHANGED).all():
            return False
        more = own[some] * change[:, None] * below[some]
        miss += _sums(lower[some] % len(miss), more, len(miss))
    return True


def _in_footing(program: Program, wrench: Array) -> Array:
    """Forces up and their (1, u, v), of wrenches about the centres of mass, shape (N, 3 or 2)."""
    up = -program.down
    moment = np.cross(up, wrench[:, 3:]) / program.radius[:, None]
    return np.column_stack([wrench[:, :3] @ up, moment @ level_axes(program).T])


def _wrong_motion(program: Program, level: Mask, motion: Array) -> str:
    if motion[~program.free].any():
        return "its motion moves what is held"
    moved = np.vstack([motion[:, :3], np.zeros((1, 3))])
    size = float(np.abs(moved).max(initial=0.0))
    flat = level_axes(program)
    off = np.abs(moved - moved @ flat.T @ flat).max(initial=0.0)
    if size == 0 or off > ACROSS * size or motion[:, 3:].any():
        return "its motion is not a level shift of the parts"
    apart = (moved[program.part_b] - moved[program.part_a])[~level]
    if not (np.einsum("ij,ij->i", program.normal[~level], apart) > DROPS * size).all():
        return "its motion does not open the other contacts"
    return ""


def level_axes(program: Program) -> Array:
    """Unit directions across gravity in which parts move, as rows."""
    if program.planar:
        return np.cross(program.down, [0.0, 1.0, 0.0])[None]
    return np.array(across(program.down))


# what bears what ---------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class _Bearing:
    """Rows in which an upper part stands on a lower one, and how deep the parts stand.

    `rows`, `upper`, `lower`: (k,). `depth`, shape (N + 1,): of a part, one more than of the
    deepest that bears it; 0 of what is held; the last is the ground.
    """

    rows: Index
    upper: Index
    lower: Index
    depth: Index

    def footing(self, program: Program, part: Index) -> Array:
        """(1, u, v) about the centre of mass of a part over its radius, shape (k, 2 or 3)."""
        arm = (program.point[self.rows] - program.center[part]) / program.radius[part, None]
        return np.column_stack([np.ones(len(part)), arm @ level_axes(program).T])

    def both_footings(self, program: Program) -> tuple[Array, Array]:
        """Of the upper parts, and of the lower ones, 0 where these are held."""
        above = self.footing(program, self.upper)
        below = np.zeros_like(above)
        free = np.append(program.free, False)[self.lower]
        own = replace(self, rows=self.rows[free])
        below[free] = own.footing(program, self.lower[free])
        return above, below


def _bearing(program: Program, rows: Mask) -> _Bearing | None:
    """What bears what by these rows; None where parts bear one another around."""
    own = np.flatnonzero(rows)
    up = program.normal[own] @ program.down < 0  # a bears b
    a, b = program.part_a[own], program.part_b[own]
    upper, lower = np.where(up, b, a), np.where(up, a, b)
    free = np.append(program.free, False)
    own, upper, lower = (x[free[upper]] for x in (own, upper, lower))
    count = len(free)
    pairs = np.unique(upper * count + lower % count)
    above, below = pairs // count, pairs % count
    depth = free.astype(np.int64)
    for _ in range(count):
        deeper = depth.copy()
        np.maximum.at(deeper, above, depth[below] + 1)
        if (deeper == depth).all():
            return _Bearing(own, upper, lower, depth)
        depth = deeper
    return None


def _grams(program: Program, part: Index, footing: Array) -> Array:
    """Of each part the sum of its footing times itself, shape (N, 3, 3) or (N, 2, 2)."""
    return _sums(part, footing[:, :, None] * footing[:, None, :], len(program.names))


def _sums(part: Index, values: Array, count: int) -> Array:
    """Values (k, ...) summed by part, shape (count, ...)."""
    flat = values.reshape(len(part), int(np.prod(values.shape[1:])))
    total = np.empty((count, flat.shape[1]))
    for k, column in enumerate(flat.T):
        total[:, k] = np.bincount(part, column, minlength=count)
    return total.reshape(count, *values.shape[1:])


def _spread(grams: Array) -> bool:
    """Whether the points on which each part stands are on no line."""
    return bool((np.linalg.eigvalsh(grams)[:, 0] > SPREAD).all())


def _from_above(
    program: Program, bearing: _Bearing, footings: tuple[Array, Array], grams: Array
) -> Array | None:
    """Forces [N], each part's load spread over what it stands on, the highest part first.

    Of all that balance it, the least squares; where one pulls, those of most entropy.
    """
    rows, upper, lower = bearing.rows, bearing.upper, bearing.lower
    above, below = footings
    inverse = np.zeros_like(grams)
    inverse[program.free] = np.linalg.inv(grams[program.free])
    share = np.einsum("ki,kij->kj", above, inverse[upper])
    need = np.vstack([_in_footing(program, -program.load), np.zeros((1, above.shape[1]))])
    forces = np.zeros(len(program.part_a))
    for some in _by_depth(bearing.depth[upper]):
        if not (need[upper[some], 0] > 0).all():
            return None  # a load lifts it
        force = np.einsum("ki,ki->k", share[some], need[upper[some]])
        least = np.full(len(need), np.inf)
        np.minimum.at(least, upper[some], force)
        pulls = np.flatnonzero((least <= PULLS * need[:, 0])[upper[some]])
        if len(pulls):
            again = some[pulls]
            force[pulls] = _pushing(upper[again], above[again], need)
        forces[rows[some]] = force
        need += _sums(lower[some] % len(need), force[:, None] * below[some], len(need))
    return forces


def _pushing(part: Index, footing: Array, need: Array) -> Array:
    """Forces exp(y . (1, u, v)), y by part, that bear what each part needs, where any push.

    Newton's method on the sum of exp(y . (1, u, v)) less y . need, for each part by itself; a step
    changes no force by more than a factor of e.
    """
    own, part = np.unique(part, return_inverse=True)
    weight = need[own, 0]
    goal = need[own] / weight[:, None]
    y = np.zeros_like(goal)
    y[:, 0] = -np.log(np.bincount(part))
    force: Array = np.zeros(len(part))
    for _ in range(STEPS):
        force = np.exp(np.einsum("ki,ki->k", footing, y[part]))
        gap = goal - _sums(part, force[:, None] * footing, len(own))
        if np.abs(gap).max() < ROUNDING:
            break
        gram = _sums(
            part, force[:, None, None] * footing[:, :, None] * footing[:, None, :], len(own)
        )
        gram += ROUNDING * np.eye(goal.shape[1])
        step = np.linalg.solve(gram, gap[:, :, None])[:, :, 0]
        change = np.zeros(len(own))
        np.maximum.at(change, part, np.abs(np.einsum("ki,ki->k", footing, step[part])))
        y += step / np.maximum(change, 1.0)[:, None]
    found: Array = force * weight[part]
    return found


def _by_depth(depth: Index) -> list[Index]:
    """Places of each depth, the deepest last, from the highest on."""
    order = np.argsort(depth, kind="stable")
    _, first = np.unique(depth[order], return_index=True)
    return np.split(order, first[1:])[::-1]


# what opens the other contacts -------------------------------------------------------------


def _opening(program: Program, level: Mask) -> Array | None:
    """All parts away from one place, level: it opens what is not; None where it does not."""
    free = program.free
    middle = program.center[free].mean(axis=0)
    axes = level_axes(program)
    away = (program.center[free] - middle) @ axes.T
    reach = 2 * float(np.abs(away).max(initial=0.0) + program.radius[free].max())
    held = np.append(~free, True)
    steep = np.flatnonzero(~level)
    out = program.normal[steep] @ axes.T
    out = out * (1.0 * held[program.part_a[steep]] - 1.0 * held[program.part_b[steep]])[:, None]
    along = out.sum(axis=0)
    size = float(np.linalg.norm(along))
    along = along / size if size > DROPS else np.eye(len(axes))[0]
    for shift in (0.0, reach):
        motion = np.zeros((len(free), 6))
        motion[free, :3] = (away + shift * along) @ axes
        motion /= max(float(np.linalg.norm(motion[:, :3], axis=1).max()), TINY)
        if not _wrong_motion(program, level, motion):
            return motion
    return None
