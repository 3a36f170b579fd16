"""Forces and motions that come nearest to a proof of the opposite, by optimisation.

Forces: the combination of the rays of all cones that leaves the least imbalance, and self-stresses
of up to 1e14 weights upon it. Motions: the largest power for an allowed violation of contacts, with
the active rows met to the last place, and motions that open contacts upon it.
"""

from collections.abc import Iterator

import numpy as np
from scipy.optimize import linprog, nnls

from kilter.arrays import Array
from kilter.mechanics.program import Program

SIDES = 8
"""Directions across a contact into which its cone is divided."""
SQUEEZES = [10.0**k for k in range(-2, 15, 2)]
"""Sizes of the self-stresses upon the forces of least imbalance, over the total weight [-]."""
VIOLATIONS = [0.0, *(10.0**k for k in range(-16, -2, 2))]
"""Allowed violations of the contacts by a motion of size 1 [-]."""
LIFTS = [10.0**k for k in range(-12, -1, 2)]
"""Shares of the motion that opens contacts, upon a motion of size 1 [-]."""


def forged_forces(program: Program, rng: np.random.Generator) -> Iterator[tuple[Array, Array]]:
    """Yield forces along the rows, (K,), and across them, (K, 3), that nearly balance the load."""
    rays, forces, friction = _rays(program)
    if not len(rays):
        yield np.zeros(len(program.part_a)), np.zeros((len(program.part_a), 3))
        return
    matrix, load = _scaled(program, rays), _scaled(program, program.load[None])[:, 0]
    total = float(program.weight[program.free].sum())
    nearest = _least(matrix, -load)
    rows = np.vstack([matrix, rng.uniform(0.5, 2.0, size=len(rays))])
    stress = nnls(rows, np.append(np.zeros(len(load)), 1.0), maxiter=30 * rows.shape[1])[0]
    stress /= max(float(stress.sum()), 1e-300)
    alike = np.abs(program.normal @ program.normal[int(rng.integers(len(forces[0])))]) > 1 - 1e-9
    alike &= ~program.two_sided & ~program.angular & np.isinf(program.capacity)
    for size in SQUEEZES:  # equal forces along one line are an exact self-stress of many parts
        squeezed = nearest @ forces + size * total * alike
        yield squeezed, np.einsum("r,rki->ki", nearest, friction)
    for shares in [nearest, *(nearest + size * total * stress for size in SQUEEZES)]:
        yield shares @ forces, np.einsum("r,rki->ki", shares, friction)


def _least(matrix: Array, wanted: Array) -> Array:
    """Shares >= 0 of the columns that are nearest to a vector."""
    found = nnls(matrix, wanted, maxiter=30 * matrix.shape[1])[0]
    used = np.flatnonzero(found)
    if len(used):  # once more among the used columns, to the last place
        refined = np.linalg.lstsq(matrix[:, used], wanted, rcond=None)[0]
        if (refined >= 0).all():
            found[used] = refined
    return np.asarray(found)


def _rays(program: Program) -> tuple[Array, Array, Array]:
    """Wrenches of the rays of all cones, (R, N, 6), with their row forces and friction."""
    count = len(program.part_a)
    wrenches, forces, friction = [], [], []
    grips = {int(k): program.mu[k] for k in program.rough}
    for k in range(count):
        signs = (1.0, -1.0) if program.two_sided[k] else (1.0,)
        normal = program.normal[k]
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        angles = 2 * np.pi * np.arange(SIDES) / SIDES
        second = np.cross(normal, first)
        ways = [np.cos(a) * first + np.sin(a) * second for a in angles] if k in grips else []
        for sign in signs:
            for way in [np.zeros(3), *ways]:
                row, across = np.zeros(count), np.zeros((count, 3))
                row[k] = sign
                across[k] = grips.get(k, 0.0) * way
                wrenches.append(program.wrenches(row, across))
                forces.append(row)
                friction.append(across)
    return np.array(wrenches), np.array(forces), np.array(friction)


def _scaled(program: Program, wrenches: Array) -> Array:
    """Wrenches of the free parts over their weights, torques over the radius, shape (6N, R)."""
    six = wrenches / program.weight[:, None].clip(1e-300)
    six[..., 3:] /= program.radius[:, None]
    return six[:, program.free].reshape(len(wrenches), -1).T


def forged_motions(program: Program, rng: np.random.Generator) -> Iterator[Array]:
    """Yield motions, shape (N, 6), that nearly violate no contact and gain the most power."""
    levers, names = _levers(program), int(program.free.sum())
    gain = _columns(program, program.load)
    lift = _lifting(levers, 6 * names)
    for allowed in VIOLATIONS:
        motion = _fastest(levers, gain, allowed)
        if motion is None:
            continue
        shares = [0.0, *LIFTS] if lift is not None else [0.0]
        for share in shares:
            yield _motion(program, motion if lift is None else motion + share * lift)
    yield _motion(program, rng.normal(size=6 * names))


def _columns(program: Program, six: Array) -> Array:
    """Load of the free parts per unit of each scaled freedom, shape (6N,)."""
    lengths = np.repeat([1.0, 1.0], 3)[None] * np.ones((len(program.names), 6))
    lengths[:, 3:] = 1 / program.radius[:, None]
    return (six * lengths)[program.free].reshape(-1)


def _motion(program: Program, scaled: Array) -> Array:
    """Motion of all parts, shape (N, 6), from scaled freedoms of the free parts."""
    motion = np.zeros((len(program.names), 6))
    motion[program.free] = scaled.reshape(-1, 6)
    motion[:, 3:] /= program.radius[:, None]
    return motion


def _levers(program: Program) -> tuple[Array, Array]:
    """Rows of u_n - mu d.u_t >= 0, (R, 6N), and rows of u = 0, over scaled freedoms."""
    rays, forces, _ = _rays(program)
    if not len(rays):
        return np.zeros((0, 6 * int(program.free.sum()))), np.zeros((0, 0))
    rows = np.stack([_columns(program, wrench) for wrench in rays])
    limited = forces @ np.isfinite(program.capacity)  # straps may lengthen
    return rows[limited == 0], rows


def _lifting(levers: tuple[Array, Array], size: int) -> Array | None:
    """The motion that opens all contacts the most; None if none opens."""
    rows = levers[0]
    if not len(rows):
        return None
    cost = np.append(np.zeros(size), -1.0)
    found = linprog(
        cost,
        A_ub=np.column_stack([-rows, np.ones(len(rows))]),
        b_ub=np.zeros(len(rows)),
        bounds=[(-1, 1)] * size + [(0, 1)],
    )
    return found.x[:-1] if found.status == 0 and found.x[-1] > 1e-6 else None


def _fastest(levers: tuple[Array, Array], gain: Array, allowed: float) -> Array | None:
    """The motion with the largest power that closes no row by more than `allowed`."""
    rows, size = levers[0], len(gain)
    worth = gain / max(float(np.abs(gain).max()), 1e-300)
    found = linprog(-worth, A_ub=-rows, b_ub=np.full(len(rows), allowed), bounds=[(-1, 1)] * size)
    if found.status != 0:
        return None
    motion = np.asarray(found.x)
    active = np.abs(rows @ motion + allowed) < 1e-6
    if active.any():
        short = -allowed - rows[active] @ motion
        motion = motion + np.linalg.lstsq(rows[active], short, rcond=None)[0]
    return motion
