"""Search for proofs that parts rest on horizontal faces.

The load of each part is spread over its supports, from the highest part down. If that leaves a part
without a footing, the forces of the verdict are tried, then those of a linear program. The motion
of the proof moves all parts away from their middle.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array

from kilter.arrays import TINY, Array, Index, Mask
from kilter.mechanics.program import Program
from kilter.second_order.gaps.joint_forms import on_joints
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.sharp_points import SharpPoints
from kilter.second_order.parts.bearing import (
    Bearing,
    bearing_of,
    by_depth,
    in_footing,
    level_axes,
    sums_by_part,
)
from kilter.second_order.proofs.level_rest import (
    Held,
    LevelRest,
    judge_held,
    scaled_rows,
    wrong_forces,
    wrong_motion,
)
from kilter.second_order.proofs.stopped import StopForms, Stopped, judge_stopped, stop_forms
from kilter.second_order.searches.counted_program import optimum
from kilter.second_order.searches.critical import carrying_forces
from kilter.second_order.second_order_tolerances import DROPS, SPREAD
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

# Search for equilibrium forces that exclude every neutral motion.


FULL = 1e-12
"""J has full rank if the least eigenvalue of J^T J over its largest entry is above this [-]."""
ROUNDS = 50
"""Largest number of rounds in which forces are redistributed over the contacts."""
SHARE = 0.02
"""Least force of a contact at which redistribution aims, over the mean force; half is enough."""


def find_held(program: Program, forces: Array) -> Held | None:
    """Make a proof of held parts from equilibrium forces, (K,) [N]; None if it would fail."""
    if len(forces) < int(program.free.sum()) * len(program.freedoms):
        return None  # fewer rows than freedoms: a motion opens no contact, whatever the forces
    if not judge_held(program, Held(forces)):
        return Held(forces)
    if not forces.any():
        return None
    spread = _spread_out(program, forces)
    return None if spread is None or judge_held(program, Held(spread)) else Held(spread)


def _spread_out(program: Program, forces: Array) -> Array | None:
    """Equilibrium forces near the given forces that push at every contact; None if not found."""
    if on_joints(program).any():
        return None  # the forces of joints are not to be made positive
    rows = scaled_rows(program)
    gram = (rows.T @ rows).toarray()
    try:
        np.linalg.cholesky(gram - FULL * gram.diagonal().max(initial=0.0) * np.eye(len(gram)))
    except np.linalg.LinAlgError:
        return None  # some motion opens no contact: it stays neutral under all forces
    inverse = np.linalg.inv(gram)
    least = SHARE * float(forces.mean())
    spread = forces
    for _ in range(ROUNDS):
        change = np.maximum(spread, least) - forces
        spread = forces + change - rows @ (inverse @ (rows.T @ change))
        if spread.min() > least / 2:
            return np.asarray(spread)
    return None


# Search for motions that open contacts, by a linear program.


MOST_CHOICES = 64
"""Largest number of combinations of normals, one for each pair."""


def opening_motion(rows: Array, work: Work | None) -> Array | None:
    """Motion, (f,), that opens all given rows as widely as possible; None if none opens all.

    Max t:  rows x >= t,  |x| <= 1.
    """
    count, freedoms = rows.shape
    x = optimum(
        LinearProgram(
            np.append(np.zeros(freedoms), -1.0),
            csc_array(np.hstack([rows, -np.ones((count, 1))])),
            np.zeros(count),
            np.full(count, np.inf),
            -np.ones(freedoms + 1),
            np.ones(freedoms + 1),
        ),
        work,
    )
    return x[:-1] if x is not None and x[-1] > 0 else None


def enough_to_open(points: SharpPoints, rows: Mask) -> Iterator[Mask]:
    """Yield subsets of the given rows that, if opened, separate every pair of parts.

    For a pair with sharp points the rows of a single normal suffice. There are at most
    `MOST_CHOICES` subsets.
    """
    sharp = rows & (points.along >= 0)
    pairs = np.unique(points.pair[sharp])
    normals = [np.unique(points.along[sharp & (points.pair == pair)]) for pair in pairs]
    others = rows & ~np.isin(points.pair, pairs)
    for chosen in itertools.islice(itertools.product(*normals), MOST_CHOICES):
        yield others | (rows & np.isin(points.along, chosen))


MOST_ASKED = 100
"""Largest number of free parts for which a linear program distributes the load."""
MOST_PARTED = 20
"""Largest number of free parts for which a linear program finds the opening motion."""
POLISHED = 2
"""Rounds of refinement that balance the forces of the program."""
PULLS = 1e-3
"""Share of a part's load below which a least-squares force leads to a new computation [-]."""
STEPS = 30
"""Largest number of Newton steps."""
ROUNDING = 1e-13
"""Relative residual at which Newton's method ends, and relative regularisation [-]."""


def find_level_rest(
    program: Program,
    level: Mask,
    forces: Array | None,
    sharp: SharpPoints | None = None,
    *,
    work: Work | None = None,
) -> LevelRest | None:
    """Search for a proof that parts rest on horizontal faces; None if none was found.

    Arguments: `level` (K,): rows of level faces (`level_rest.level_rows`); `forces` (K,): forces of
    some equilibrium [N].
    """
    if not level.any():
        return None
    motion = find_parting(program, level, sharp, work)
    if motion is None:
        return None
    resting = resting_forces(program, level, forces, work)
    return None if resting is None else LevelRest(resting, motion)


def rests_level(program: Program, level: Mask, forces: Array) -> bool:
    """True if forces on horizontal faces alone fix the height and the tilts of every part.

    Then no motion lowers the energy to second order, so that the assembly is not only balanced.
    The condition is that of `level_rest`, without the motion that opens the other contacts.

    Arguments: `level` (K,): rows of level faces (`level_rest.level_rows`); `forces` (K,): forces of
    some equilibrium [N], which are tried if the load cannot be spread from above.
    """
    return resting_forces(program, level, forces, programs=False) is not None


def resting_forces(
    program: Program,
    level: Mask,
    forces: Array | None = None,
    work: Work | None = None,
    *,
    programs: bool = True,
) -> Array | None:
    """Forces [N] on horizontal faces that fix the height and tilts of every part; or None."""
    for candidate in _candidate_forces(program, level, forces, work, programs=programs):
        if not wrong_forces(program, level, candidate):
            return candidate
    return None


def _candidate_forces(
    program: Program,
    level: Mask,
    forces: Array | None,
    work: Work | None,
    *,
    programs: bool,
) -> Iterator[Array]:
    """Yield equilibrium forces [N] on horizontal faces, from the cheapest method first."""
    bearing = bearing_of(program, level)
    if bearing is None:
        return
    above, below = bearing.footings(program)
    grams = _grams(program, bearing.upper, above)
    if not _on_no_line(grams[program.free]):
        return
    from_above = _from_above(program, bearing, (above, below), grams)
    if from_above is not None:
        yield from_above
    if forces is not None:
        yield forces
    if programs and program.free.sum() <= MOST_ASKED:
        from_program = _from_program(program, level, work)
        if from_program is not None:
            yield from_program


def _from_program(program: Program, level: Mask, work: Work | None) -> Array | None:
    """Forces [N] on horizontal rows that can carry, by a linear program; None if it fails."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    units = units[:, program.freedoms].reshape(-1)
    weight = float(program.weight[program.free].max())
    load = program.load[np.ix_(program.free, program.freedoms)].reshape(-1) * units / weight
    rows = csr_array(program.jacobian()[level] @ diags_array(units))
    answer = carrying_forces(rows, load, work=work)
    if answer is None:
        return None
    forces, carries = answer
    carrying = rows[carries]
    gram = (carrying.T @ carrying).toarray() + ROUNDING * np.eye(len(load))
    for _ in range(POLISHED):
        miss = carrying.T @ forces[carries] + load
        forces[carries] -= carrying @ np.linalg.solve(gram, miss)
    on_all_rows = np.zeros(len(level))
    on_all_rows[level] = forces * weight
    return on_all_rows


def _grams(program: Program, part: Index, footing: Array) -> Array:
    """For each part, the sum of outer products of its support points, (N, 3, 3) or (N, 2, 2)."""
    return sums_by_part(part, footing[:, :, None] * footing[:, None, :], len(program.names))


def _on_no_line(grams: Array) -> bool:
    """True if the support points of each part are not collinear."""
    return bool((np.linalg.eigvalsh(grams)[:, 0] > SPREAD).all())


def _from_above(
    program: Program, bearing: Bearing, footings: tuple[Array, Array], grams: Array
) -> Array | None:
    """Forces [N] that distribute each part's load over its supports, from the top down; or None.

    They are the forces of least squares, or of the largest entropy if a least-squares force pulls.
    None if a part is lifted by its load.
    """
    rows, upper, lower = bearing.rows, bearing.upper, bearing.lower
    above, below = footings
    inverse = np.zeros_like(grams)
    inverse[program.free] = np.linalg.inv(grams[program.free])
    share = np.einsum("ki,kij->kj", above, inverse[upper])
    need = np.vstack([in_footing(program, -program.load), np.zeros((1, above.shape[1]))])
    forces = np.zeros(len(program.part_a))
    for level in by_depth(bearing.depth[upper]):
        if not (need[upper[level], 0] > 0).all():
            return None
        force = np.einsum("ki,ki->k", share[level], need[upper[level]])
        least = np.full(len(need), np.inf)
        np.minimum.at(least, upper[level], force)
        pulls = np.flatnonzero((least <= PULLS * need[:, 0])[upper[level]])
        if len(pulls):
            again = level[pulls]
            force[pulls] = _pushing_forces(upper[again], above[again], need)
        forces[rows[level]] = force
        need += sums_by_part(lower[level] % len(need), force[:, None] * below[level], len(need))
    return forces


def _pushing_forces(part: Index, footing: Array, need: Array) -> Array:
    """Positive forces [N] that carry the loads `need`, as exponentials of linear functions.

    Newton's method minimises the sum of exp(y . (1, u, v)) minus y . need for each part; a step
    changes no force by more than a factor of e.
    """
    parts, part = np.unique(part, return_inverse=True)
    weight = need[parts, 0]
    goal = need[parts] / weight[:, None]
    y = np.zeros_like(goal)
    y[:, 0] = -np.log(np.bincount(part))
    force: Array = np.zeros(len(part))
    for _ in range(STEPS):
        force = np.exp(np.einsum("ki,ki->k", footing, y[part]))
        gap = goal - sums_by_part(part, force[:, None] * footing, len(parts))
        if np.abs(gap).max() < ROUNDING:
            break
        gram = sums_by_part(
            part, force[:, None, None] * footing[:, :, None] * footing[:, None, :], len(parts)
        )
        gram += ROUNDING * np.eye(goal.shape[1])
        step = np.linalg.solve(gram, gap[:, :, None])[:, :, 0]
        change = np.zeros(len(parts))
        np.maximum.at(change, part, np.abs(np.einsum("ki,ki->k", footing, step[part])))
        y += step / np.maximum(change, 1.0)[:, None]
    scaled: Array = force * weight[part]
    return scaled


def find_parting(
    program: Program, level: Mask, sharp: SharpPoints | None, work: Work | None
) -> Array | None:
    """Horizontal shifts of all parts that open every other contact, (N, 6); None without one.

    All parts move away from a common point, or as a linear program finds. The largest shift is 1
    length unit. None if no such motion was found.
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
        opening = opening_motion(rows[chosen], work)
        if opening is None:
            continue
        motion = np.tensordot(opening, shifts, axes=1)
        motion /= max(float(np.linalg.norm(motion[:, :3], axis=1).max()), TINY)
        if not wrong_motion(program, level, motion, sharp):
            return motion
    return None


# Search for the weights of stops in a proof that stops keep sliding parts from falling.


SHARES = (0.1, 1e-3, 1e-5)
"""Lower bounds of the weights, over the most even weights, while curvature is maximised [-]."""
MOST_WEIGHTS = 2_000
"""Largest number of products of a stop and a level contact."""


def find_stopped(
    problem: Stationary, level: Mask, motions: Array, free: Array, *, work: Work | None = None
) -> Stopped | None:
    """Search for a proof by stops that the energy has a minimum; None without a proof.

    The arguments are those of `judge_stopped`.
    """
    stops, count = int((~level).sum()), int(level.sum())
    if not count or not stops or stops * count > MOST_WEIGHTS:
        return None
    answer = carrying_forces(csr_array(problem.rows[level]), problem.load, work=work)
    opening = opening_motion(problem.rows[~level] @ motions, work)
    if answer is None or opening is None:
        return None
    forces = np.zeros(len(level))
    forces[level] = answer[0]
    forms = stop_forms(problem, level, motions, free, forces)
    for weights in _candidate_weights(forms, work):
        proof = Stopped(forces, weights, motions @ opening)
        if not judge_stopped(problem, level, motions, free, proof):
            return proof
    return None


def _candidate_weights(forms: StopForms, work: Work | None) -> Iterator[Array]:
    """Weights for a proof by stops, (s, m): first the most even, then the most effective."""
    if not len(forms.stops_level) * len(forms.rises):
        yield np.zeros((len(forms.stops_level), len(forms.rises)))
        return
    even = _weights(forms, None, work)
    if even is None:
        return
    yield even
    for share in SHARES:
        weights = _weights(forms, share * float(even.min()), work)
        if weights is not None:
            yield weights


def _weights(forms: StopForms, least: float | None, work: Work | None) -> Array | None:
    """Weights that match the coupling terms of the energy, each at least t, (s, m); or None.

    Without `least`, t is maximised; otherwise t = `least`, and the trace of S is maximised. None if
    the program is not solved.
    """
    stops, rises = len(forms.stops_level), len(forms.rises)
    count = stops * rises
    products = np.einsum("if,jd->fdij", forms.stops_level, forms.rises).reshape(-1, count)
    above = np.hstack([np.eye(count), -np.ones((count, 1))])
    right = forms.coupling.reshape(-1)
    taken = (forms.stops_tilts @ forms.rises.T).reshape(-1)  # by each weight from the trace of S
    low, high = (0.0, np.inf) if least is None else (least, least)
    x = optimum(
        LinearProgram(
            np.append(np.zeros(count), -1.0) if least is None else np.append(taken, 0.0),
            csc_array(np.vstack([np.hstack([products, np.zeros((len(products), 1))]), above])),
            np.concatenate([right, np.zeros(count)]),
            np.concatenate([right, np.full(count, np.inf)]),
            np.append(np.zeros(count), low),
            np.append(np.full(count, np.inf), high),
        ),
        work,
    )
    return None if x is None else x[:-1].reshape(stops, rises)
