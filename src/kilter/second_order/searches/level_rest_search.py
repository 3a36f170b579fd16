"""Forces and motions that prove what stands on level faces (`level_rest`).

Each part's load is spread over what it stands on, from above; where that leaves a part without a
footing, the forces of the verdict are tried, then those of a linear program. The motion takes all
parts away from their middle.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, Index, Mask
from kilter.mechanics.program import Program
from kilter.second_order.motions.sharp_points import SharpPoints
from kilter.second_order.parts.bearing import (
    Bearing,
    bearing_of,
    by_depth,
    in_footing,
    level_axes,
    sums_by_part,
)
from kilter.second_order.proofs.level_rest import LevelRest, wrong_forces, wrong_motion
from kilter.second_order.searches.critical import carrying_forces
from kilter.second_order.searches.opening_contacts import enough_to_open, opening_motion
from kilter.second_order.second_order_tolerances import DROPS, SPREAD
from kilter.work import Work

__all__ = ["find_level_rest", "find_parting"]

MOST_ASKED = 100
"""A linear program spreads the load of up to this many parts, where all else fails."""
MOST_PARTED = 20
"""One finds the shifts that part this many parts."""
POLISHED = 2
"""Times that its forces are balanced."""
PULLS = 1e-3
"""Forces of least squares below this share of a part's load are found again so that all push."""
STEPS = 30
"""Of Newton's method, ..."""
ROUNDING = 1e-13
"""... until this share of the load is left."""


def find_level_rest(
    program: Program,
    level: Mask,
    forces: Array | None,
    sharp: SharpPoints | None = None,
    *,
    work: Work | None = None,
) -> LevelRest | None:
    """A proof for a program of contacts without friction; None where none was found.

    Parameters
    ----------
    program : Program
    level : ndarray of bool, shape (K,)
    forces : ndarray, shape (K,), optional
        Of some equilibrium [N].
    sharp : SharpPoints, optional
        As the judge takes them.
    """
    if not level.any():
        return None
    motion = find_parting(program, level, sharp, work)
    if motion is None:
        return None
    for offered in _offered(program, level, forces, work):
        if not wrong_forces(program, level, offered):
            return LevelRest(offered, motion)
    return None


def _offered(
    program: Program, level: Mask, forces: Array | None, work: Work | None
) -> Iterator[Array]:
    """Forces of equilibrium [N], the cheapest first, where every part has a footing."""
    bearing = bearing_of(program, level)
    if bearing is None:
        return
    above, below = bearing.footings(program)
    grams = _grams(program, bearing.upper, above)
    if not _spread(grams[program.free]):
        return
    from_above = _from_above(program, bearing, (above, below), grams)
    if from_above is not None:
        yield from_above
    if forces is not None:
        yield forces
    if program.free.sum() <= MOST_ASKED:
        asked = _asked(program, level, work)
        if asked is not None:
            yield asked


def _asked(program: Program, level: Mask, work: Work | None) -> Array | None:
    """Forces on every level row that can carry [N], by a linear program, then balanced."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    units = units[:, program.freedoms].reshape(-1)
    weight = float(program.weight[program.free].max())
    load = program.load[np.ix_(program.free, program.freedoms)].reshape(-1) * units / weight
    rows = csr_array(program.jacobian()[level] @ diags_array(units))
    found = carrying_forces(rows, load, work=work)
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


def _grams(program: Program, part: Index, footing: Array) -> Array:
    """Of each part the sum of its footing times itself, shape (N, 3, 3) or (N, 2, 2)."""
    return sums_by_part(part, footing[:, :, None] * footing[:, None, :], len(program.names))


def _spread(grams: Array) -> bool:
    """Whether the points on which each part stands are on no line."""
    return bool((np.linalg.eigvalsh(grams)[:, 0] > SPREAD).all())


def _from_above(
    program: Program, bearing: Bearing, footings: tuple[Array, Array], grams: Array
) -> Array | None:
    """Forces [N], each part's load spread over what it stands on, the highest part first.

    Of all that balance it, the least squares; where one pulls, those of most entropy.
    """
    rows, upper, lower = bearing.rows, bearing.upper, bearing.lower
    above, below = footings
    inverse = np.zeros_like(grams)
    inverse[program.free] = np.linalg.inv(grams[program.free])
    share = np.einsum("ki,kij->kj", above, inverse[upper])
    need = np.vstack([in_footing(program, -program.load), np.zeros((1, above.shape[1]))])
    forces = np.zeros(len(program.part_a))
    for some in by_depth(bearing.depth[upper]):
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
        need += sums_by_part(lower[some] % len(need), force[:, None] * below[some], len(need))
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
        gap = goal - sums_by_part(part, force[:, None] * footing, len(own))
        if np.abs(gap).max() < ROUNDING:
            break
        gram = sums_by_part(
            part, force[:, None, None] * footing[:, :, None] * footing[:, None, :], len(own)
        )
        gram += ROUNDING * np.eye(goal.shape[1])
        step = np.linalg.solve(gram, gap[:, :, None])[:, :, 0]
        change = np.zeros(len(own))
        np.maximum.at(change, part, np.abs(np.einsum("ki,ki->k", footing, step[part])))
        y += step / np.maximum(change, 1.0)[:, None]
    found: Array = force * weight[part]
    return found


def find_parting(
    program: Program, level: Mask, sharp: SharpPoints | None, work: Work | None
) -> Array | None:
    """A level shift of each part that opens what is not level; None where none was found.

    All parts away from one place, or what a linear program finds.
    """
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
        if not wrong_motion(program, level, motion, sharp):
            return motion
    if free.sum() > MOST_PARTED:
        return None
    shifts = np.zeros((len(axes) * int(free.sum()), len(free), 6))
    places = np.repeat(np.flatnonzero(free), len(axes))
    shifts[np.arange(len(places)), places, :3] = np.tile(axes, (int(free.sum()), 1))
    rows = program.jacobian() @ shifts[:, free][:, :, program.freedoms].reshape(len(places), -1).T
    for chosen in [~level] if sharp is None else enough_to_open(sharp, ~level):
        found = opening_motion(rows[chosen], work)
        motion = np.zeros((len(free), 6)) if found is None else np.tensordot(found, shifts, axes=1)
        motion /= max(float(np.linalg.norm(motion[:, :3], axis=1).max()), TINY)
        if found is not None and not wrong_motion(program, level, motion, sharp):
            return motion
    return None
