"""Every contact mode of a tiny planar problem by a linear program: a second method.

In the plane each point separates, sticks, or slides to either side, so the contact law is linear in
each of 4^K modes. The greatest power over all modes is zero exactly if no motion obeys the law. The
module uses `Program` alone and shares nothing with the search.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.optimize import linprog

from kilter.assembly import Assembly, GivenContact, Part
from kilter.scenes.pieces import block
from kilter.shape.primitives import Box


def greatest_power(program) -> float:
    """Largest w.a / |w|^2 of a motion of the single free part, over all modes."""
    (k,) = np.flatnonzero(program.free)
    assert program.planar
    mass = np.diag([program.mass[k], program.mass[k], program.inertia[k, 1, 1]])
    load = program.load[k][[0, 2, 4]]
    normals, tangents = [], []
    for x, n, b in zip(program.point, program.normal, program.part_b, strict=True):
        side = 1.0 if b == k else -1.0
        rx, rz = (x - program.center[k])[[0, 2]]
        for rows, (dx, dz) in ((normals, n[[0, 2]]), (tangents, (n[2], -n[0]))):
            rows.append(side * np.array([dx, dz, rz * dx - rx * dz]))
    scale = load @ np.linalg.solve(mass, load)
    best = 0.0
    for mode in product("p+-s", repeat=len(normals)):
        best = max(best, _power(mode, mass, load, normals, tangents, program.mu))
    return best / scale


def _power(mode, mass, load, normals, tangents, mu) -> float:
    """Largest power in a mode; unknowns a (3), f_n (K), f_t (K)."""
    count = len(mode)
    equal, right = [np.hstack([mass, -np.array(normals).T, -np.array(tangents).T])], [load]
    above = []  # rows that are not negative
    for p, (what, n, t) in enumerate(zip(mode, normals, tangents, strict=True)):
        u_n, u_t = (np.concatenate([row, np.zeros(2 * count)]) for row in (n, t))
        f_n, f_t = np.eye(3 + 2 * count)[[3 + p, 3 + count + p]]
        above.append(f_n)
        if what == "p":
            equal += [f_n[None], f_t[None]]
            above.append(u_n)
        else:
            equal.append(u_n[None])
        if what == "s":
            equal.append(u_t[None])
            above += [mu[p] * f_n - f_t, mu[p] * f_n + f_t]
        elif what != "p":
            sign = 1.0 if what == "+" else -1.0
            equal.append((f_t + sign * mu[p] * f_n)[None])
            above.append(sign * u_t)
    matrix = np.vstack(equal)
    right = np.concatenate([load, np.zeros(len(matrix) - 3)])
    cost = np.concatenate([-load, np.zeros(2 * count)])
    # |a| is bounded by the law, forces may be as large as they like
    answer = linprog(cost, -np.array(above), np.zeros(len(above)), matrix, right, (None, None))
    return -answer.fun if answer.status == 0 else 0.0


def random_block(rng: np.random.Generator, points: int) -> Assembly:
    """A block in the plane against a held part, at points with random normals."""
    at = rng.uniform(-1, 1, (points, 2))
    angle = rng.uniform(0, 2 * np.pi, points)
    contacts = [
        GivenContact(
            ("held", "block"), [[x, 0.0, z]], [np.cos(a), 0.0, np.sin(a)],
            mu=float(rng.uniform(0.2, 1.2)),
        )
        for (x, z), a in zip(at, angle, strict=True)
    ]  # fmt: skip
    held = block("held", [-1, -1, -9], [1, 1, -8], grounded=True)
    return Assembly([held, Part("block", Box([2, 1, 2]))], contacts=contacts, planar=True,
                    detect=False)  # fmt: skip
