"""Coulomb's law by brute force: every contact mode of every point, tried separately.

In the plane a mode (apart, at rest, sliding either way) makes the law linear: the greatest power
over all 4^K modes decides. The relaxation is not used, and points do not share modes.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.optimize import linprog
from witnessed import bare, openings

from kilter.mechanics.rows import CONTACT


def standing(seed, *, planar, parts=1, points=3, spread=0.9):
    """A random program under gravity: parts on others, points below their centres."""
    rng = np.random.default_rng(seed)
    program = bare(rng, parts, 0, planar=planar)
    center = program.center.copy()
    center[:, 2] = 2.0 * np.arange(parts + 1)
    rows = []
    for k in range(points):
        b = 1 + k % parts
        lean = rng.uniform(-spread, spread)
        turn = 0.0 if planar else rng.uniform(0, 2 * np.pi)
        n = np.array([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)])
        place = rng.uniform(-1, 1, 3) * [1, 0 if planar else 1, 0.2] - [0, 0, 0.8]
        a = b - 1 if rng.random() < 0.7 else 0
        rows.append((a, b, center[b] + place, n, rng.choice([0.0, 0.3, 0.6, 1.0]), k))
    a, b, x, n, mu, source = (np.array(column) for column in zip(*rows, strict=True))
    return program.with_rows(
        center=center, part_a=a, part_b=b, point=x, normal=n, mu=mu, source=source,
        doubt=np.zeros(len(mu)), pull=np.zeros(len(mu)), tied=np.zeros(len(mu), dtype=bool),
        shear=np.full(len(mu), np.nan), capacity=np.full(len(mu), np.inf),
        kind=np.full(points, CONTACT), two_sided=np.zeros(points, dtype=bool),
        angular=np.zeros(points, dtype=bool),
    )  # fmt: skip


def _matrices(program):
    """Columns (part, freedom), M, w, and velocities of the points for unit motions."""
    freedoms = [0, 2, 4] if program.planar else list(range(6))
    columns = [(k, j) for k in np.flatnonzero(program.free) for j in freedoms]
    unit = np.zeros((len(columns), len(program.names), 6))
    for row, (k, j) in enumerate(columns):
        unit[row, k, j] = 1.0
    moved = np.array([openings(program, one) for one in unit])
    mass = np.zeros((len(columns),) * 2)
    for r, (k, j) in enumerate(columns):
        for c, (m, i) in enumerate(columns):
            if k == m and j < 3 and i == j:
                mass[r, c] = program.mass[k]
            if k == m and j > 2 and i > 2:
                mass[r, c] = program.inertia[k, j - 3, i - 3]
    load = np.array([program.load[k, j] for k, j in columns])
    return mass, load, moved


def greatest_power(program):
    """Largest w.a / |w|^2 over all motions that obey the law in the plane, and the mode count."""
    mass, load, moved = _matrices(program)
    points, n = len(program.part_a), len(load)
    normal = np.einsum("ckj,kj->kc", moved, program.normal)
    side = np.stack([program.normal[:, 2], 0 * program.mu, -program.normal[:, 0]], axis=1)
    slide = np.einsum("ckj,kj->kc", moved, side)
    scale = load @ np.linalg.solve(mass, load)
    balance = np.hstack([mass, -normal.T, -slide.T])
    best = 0.0
    for modes in product("arpm", repeat=points):
        equal, below = [balance], []
        value = [load]
        for k, mode in enumerate(modes):
            un, ut = (
                np.append(normal[k], np.zeros(2 * points)),
                np.append(slide[k], np.zeros(2 * points)),
            )
            fn, ft = np.eye(n + 2 * points)[[n + k, n + points + k]]
            if mode == "a":
                equal, below = [*equal, fn[None], ft[None]], [*below, -un]
            else:
                equal, below = [*equal, un[None]], [*below, -fn]
            if mode == "r":
                equal = [*equal, ut[None]]
                below = [*below, ft - program.mu[k] * fn, -ft - program.mu[k] * fn]
            if mode in "pm":
                sign = 1.0 if mode == "p" else -1.0
                equal, below = (
                    [*equal, (ft + sign * program.mu[k] * fn)[None]],
                    [*below, -sign * ut],
                )
        a_eq = np.vstack(equal)
        value = np.concatenate([load, np.zeros(len(a_eq) - n)])
        answer = linprog(
            np.concatenate([-load, np.zeros(2 * points)]), A_ub=np.array(below),
            b_ub=np.zeros(len(below)), A_eq=a_eq, b_eq=value, bounds=(None, None),
        )  # fmt: skip
        if answer.status == 0:
            best = max(best, -answer.fun / scale)
    return best
