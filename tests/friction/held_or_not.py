"""Shared by the tests of friction: programs, and an independent check of the contact law."""

import numpy as np

from kilter.assembly import GivenContact
from kilter.mechanics.coulomb_cones import cone_problem, load_factor_in_cones
from kilter.scenes import friction, stacks
from kilter.scenes import traps as rounds
from kilter.solvers.clarabel import solve_conic


def equilibrium(built):
    """True if forces of equilibrium exist, by the cone program."""
    return bool(solve_conic(load_factor_in_cones(cone_problem(built))).x[-1] > 0.5)


def cylinders(between, ground):
    """Case R1: a cylinder on two others, with two given points on each line of contact."""
    pile = rounds.three_cylinders(friction_between=between, friction_ground=ground)
    center, names = pile.geometry.center, pile.names
    pairs = [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)]
    contacts = []
    for a, b in pairs:
        normal = center[b] - center[a] if a else np.array([0.0, 0.0, 1.0])
        normal = normal * [1, 0, 1] / np.linalg.norm(normal * [1, 0, 1])
        middle = center[b] - normal
        points = [middle + np.array([0.0, y, 0.0]) for y in (-0.4, 0.4)]
        mu = between if a else ground
        contacts.append(GivenContact((names[a], names[b]), points, normal, mu=mu))
    return pile._replace(contacts=contacts)


def thin_bracket(factor):
    """A bracket with thin pads at `factor` times the least offset with equilibrium."""
    return friction.bracket(factor * 0.5 / 0.6, friction=0.6, pad=1e-3)


def slope(tilt, mu=0.5):
    return stacks.block_on_slope(tilt, friction=mu)


def worst_by_hand(built, acceleration, forces):
    """Worst residual of the contact law over gravity, mass and size, point by point in loops.

    Units of metres; contacts only. Independent of `kilter.mechanics.law_check`.
    """
    g = float(np.linalg.norm(built.gravity))
    worst = [0.0]
    total = np.zeros((len(built.names), 6))
    for k in range(len(built.part_a)):
        a, b, x, n = built.part_a[k], built.part_b[k], built.point[k], built.normal[k]
        f, u = forces[k], np.zeros(3)
        for part, sign in ((b, 1.0), (a, -1.0)):
            arm = x - built.center[part]
            u += sign * (acceleration[part, :3] + np.cross(acceleration[part, 3:], arm))
            total[part] += sign * np.concatenate([f, np.cross(arm, f)])
        weight = g * built.mass[built.free].sum()
        if built.planar:
            u, f = u * [1, 0, 1], f * [1, 0, 1]
        u_n, f_n = u @ n, f @ n
        u_t, f_t = u - u_n * n, f - f_n * n
        slip = float(np.linalg.norm(u_t))
        worst += [-u_n / g, -f_n / weight, abs(u_n * f_n) / g / weight]
        worst.append((np.linalg.norm(f_t) - built.mu[k] * f_n) / weight)
        if slip > 1e-8 * g:
            worst.append(np.linalg.norm(f_t + built.mu[k] * f_n * u_t / slip) / weight)
    for i in np.flatnonzero(built.free):
        force = total[i, :3] + built.mass[i] * built.gravity + built.applied[i, :3]
        force -= built.mass[i] * acceleration[i, :3]
        torque = total[i, 3:] + built.applied[i, 3:] - built.inertia[i] @ acceleration[i, 3:]
        if built.planar:
            force, torque = force * [1, 0, 1], torque * [0, 1, 0]
        worst.append(np.linalg.norm(force) / built.mass[i] / g)
        worst.append(np.linalg.norm(torque) / built.mass[i] / g / built.radius[i])
    return max(worst)
