"""Brick models judged independently of kilter, by a linear program with scipy.

A brick is a row (x, y, z, across, along, mass): lowest cell, size in cells along x and y, mass
[kg]. Every stud below a brick is a bond. At each of its points it resists pull up to T, and
compression and shear without limit. Neighbours in a layer push each other at their lower edge.
Bricks in layer 0 are on studs of a baseplate. The least share s of T at equilibrium is

    min s    A f + w = 0,    f_n >= -s T at the points of studs,    f >= 0 at sides
"""

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_array

UNIT, LAYER, GRAVITY, PULL = 7.8, 9.6, 9.8, 0.98
NARROW = np.array([(0, -1 / 4), (-1 / 4, 0), (0, 1 / 4), (1 / 4, 0)])
WIDE = np.array([(1 / 8, -1 / 8), (-1 / 4, 0), (1 / 8, 1 / 8)])


def cells_of(brick):
    x, y, _, across, along, _ = brick
    return [(x + i, y + j) for i in range(int(across)) for j in range(int(along))]


def forces_of(bricks):
    """All possible forces as (lower, upper or None, point, direction, kind)."""
    at = {}
    for k, brick in enumerate(bricks):
        for x, y in cells_of(brick):
            assert (x, y, brick[2]) not in at
            at[x, y, brick[2]] = k
    found = []
    for (x, y, z), upper in at.items():
        lower = -1 if z == 0 else at.get((x, y, z - 1))
        if lower is not None:
            offsets = NARROW if min(bricks[upper][3:5]) == 1 else WIDE
            for dx, dy in offsets:
                place = ((x + 0.5 + dx) * UNIT, (y + 0.5 + dy) * UNIT, z * LAYER)
                found.append((lower, upper, place, (0, 0, 1), "stud"))
                found.append((lower, upper, place, (1, 0, 0), "shear"))
                found.append((lower, upper, place, (0, 1, 0), "shear"))
        for i, j in ((1, 0), (0, 1)):
            beside = at.get((x + i, y + j, z))
            if beside is None or beside == upper:
                continue
            for end in (0, 1):
                place = ((x + max(i, end)) * UNIT, (y + max(j, end)) * UNIT, z * LAYER)
                found.append((upper, beside, place, (i, j, 0), "side"))
    return found


def least_share(bricks, *, pull=PULL):
    """The least share s: inf if no strength suffices, 0 if none is needed."""
    bricks = [tuple(brick) for brick in bricks]
    centre = np.array(
        [((x + a / 2) * UNIT, (y + b / 2) * UNIT, (z + 0.5) * LAYER) for x, y, z, a, b, _ in bricks]
    )
    load = np.zeros((len(bricks), 6))
    load[:, 2] = [-GRAVITY * brick[5] for brick in bricks]
    rows, columns, values, lowest, slack = [], [], [], [], []
    found = forces_of(bricks)
    for column, (lower, upper, place, direction, kind) in enumerate(found):
        for part, sign in ((lower, -1.0), (upper, 1.0)):
            if part < 0:
                continue
            arm = np.array(place) - centre[part]
            wrench = sign * np.concatenate([direction, np.cross(arm, direction) / UNIT])
            rows += range(6 * part, 6 * part + 6)
            columns += [column] * 6
            values += wrench.tolist()
        lowest.append(None if kind == "shear" else 0.0)
        slack.append(pull if kind == "stud" else 0.0)
    # f_n = f' - s T
    balance = coo_array((values, (rows, columns)), shape=(load.size, len(found))).tocsr()
    pulled = -(balance @ np.array(slack))
    matrix = coo_array(np.hstack([balance.toarray(), pulled[:, None]]))
    answer = linprog(
        np.append(np.zeros(len(found)), 1.0),
        A_eq=matrix,
        b_eq=-load.ravel(),
        bounds=[*((low, None) for low in lowest), (0.0, None)],
        method="highs",
    )
    if answer.status == 2:
        return np.inf
    assert answer.status == 0, answer.message
    return float(answer.fun)
