"""Contacts of non-convex bodies, compared with moved bodies: no constraint lost or invented."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice

import numpy as np
import pytest
from first_order import CLEAR, Body, enters, pairs_of_cubes, tips_on_cubes
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from kilter import Assembly, Mesh, Part, Pose
from kilter.contact import ContactSet, detect
from kilter.mechanics.degenerate import allowed_program
from kilter.mechanics.program import build_program
from sampled import sampled

Array = NDArray[np.float64]
FAMILIES = {"cubes": pairs_of_cubes, "tips": tips_on_cubes}


@dataclass
class Examined:
    """The tests of a pair of bodies, and the errors."""

    counts: list[int]
    wrong: list[str]
    kinds: list[str]


def posed(a: Body, b: Body, rng: np.random.Generator) -> tuple[Assembly, Body, Body]:
    """Both bodies in the same random pose."""
    turn = Rotation.random(rng=rng)
    shift = rng.normal(size=3)
    parts = [
        Part(name, Mesh(body.vertices, body.triangles), Pose(shift, turn.as_quat()[[3, 0, 1, 2]]),
             grounded=name == "a")
        for name, body in (("a", a), ("b", b))
    ]  # fmt: skip
    rotation = turn.as_matrix()
    return Assembly(parts), a.moved(rotation, shift), b.moved(rotation, shift)


def rows_of(assembly: Assembly, contacts: ContactSet) -> tuple[Array, list[Array]]:
    """Constraints on the motion of b about its centre: rows, and clauses of rows."""
    program = build_program(assembly, contacts)
    center = assembly.geometry.center[1]
    sign = np.where(program.part_b == 1, 1.0, -1.0)[:, None]
    rows = sign * lever(program.point - center, program.normal)
    points = contacts.degenerate
    clauses = []
    for k in range(len(points)):
        normals = points.normals[points.start[k] : points.start[k + 1]]
        sense = 1.0 if points.part_b[k] == 1 else -1.0
        arm = np.tile(points.points[k] - center, (len(normals), 1))
        clauses.append(sense * lever(arm, normals))
    return rows, clauses


def lever(arm: Array, normal: Array) -> Array:
    return np.hstack([normal, np.cross(arm, normal)])


def motion_within(rows: Array, right: Array, aim: Array) -> Array | None:
    """The motion of size at most 1 furthest along `aim` with rows @ motion >= right."""
    answer = linprog(-aim, A_ub=-rows, b_ub=-right, bounds=[(-1, 1)] * 6, method="highs")
    return answer.x if answer.status == 0 else None


def examine(a: Body, b: Body, rng: np.random.Generator, motions: int = 12) -> Examined:
    """Motions that are allowed, and motions that break a single constraint, against the oracle."""
    assembly, a, b = posed(a, b, rng)
    contacts = detect.contacts(assembly)
    center = assembly.geometry.center[1]
    rows, clauses = rows_of(assembly, contacts)
    result = Examined([0, 0, 0, 0], [], contacts.patch_kind.tolist())
    result.counts[3] = len(clauses)

    def branch() -> Array:
        chosen = [clause[rng.integers(len(clause))] for clause in clauses]
        return np.vstack([rows, *(c[None] for c in chosen)])

    for _ in range(motions):
        free = branch()
        motion = motion_within(free, np.zeros(len(free)), rng.normal(size=6))
        if motion is None or np.abs(motion).max() < 0.5 or crosses(assembly, contacts, motion):
            continue
        result.counts[0] += 1
        if enters(a, b, motion, center):
            result.wrong.append(f"lost: {motion.round(3).tolist()} enters")
    for k in range(len(rows)):
        same = np.abs(branch() - rows[k]).max(axis=1) < 1e-6
        free = branch()
        right = np.where(same, -np.inf, 0.0)
        keep = ~same
        bound = np.vstack([free[keep], -rows[k][None]])
        right = np.append(np.zeros(int(keep.sum())), CLEAR)
        motion = motion_within(bound, right, rng.normal(size=6))
        if motion is not None:
            result.counts[1] += 1
            if not enters(a, b, motion, center):
                result.wrong.append(f"invented: row {k} {motion.round(3).tolist()} enters not")
    for clause in clauses:
        free = np.vstack([branch(), -clause])
        keep = ~(np.abs(free[:, None] - clause[None]).max(axis=2) < 1e-6).any(axis=1)
        right = np.where(np.arange(len(free)) >= len(free) - len(clause), CLEAR, 0.0)
        motion = motion_within(free[keep], right[keep], rng.normal(size=6))
        if motion is not None:
            result.counts[2] += 1
            if not enters(a, b, motion, center):
                result.wrong.append(f"invented clause: {motion.round(3).tolist()} enters not")
    return result


def crosses(assembly: Assembly, contacts: ContactSet, motion: Array) -> bool:
    """Whether a motion that all points allow enters on a line between degenerate points."""
    both = np.vstack([np.zeros(6), motion])
    program = allowed_program(assembly, contacts, both)
    return program is not None and program.velocities(both).min(initial=0.0) < -1e-7


@pytest.mark.slow
@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("seed", sampled(1, 3))
def test_no_constraint_is_lost_or_invented(name, seed):
    counts = np.zeros(4, dtype=int)
    wrong = []
    for k, (a, b) in enumerate(islice(FAMILIES[name](seed), 8)):
        result = examine(a, b, np.random.default_rng(k), 8)
        counts += result.counts
        wrong += [f"{name}/{seed}/{k}: {w}" for w in result.wrong]
    assert not wrong, "\n".join(wrong)
    assert (counts > 1).all()  # each question was asked
