"""Random programs with a known motion: parts, contacts, motion, forces, then the load.

Contacts are drawn first, then a motion that keeps some points closed and some at rest, then forces
that obey Coulomb's law for it; the load is what makes them balance: w = M a - J^T f. So (a, f)
obeys the contact law exactly, and no proof may exclude it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, JOINT


@dataclass(frozen=True)
class Witnessed:
    program: Program
    motion: np.ndarray  # (N, 6) accelerations
    forces: np.ndarray  # (K, 3) on the second part of each contact row, world frame


def bare(rng, parts, points, *, planar):
    """A program without rows: a held part and free parts, at random places, without load."""
    count = parts + 1
    turn = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    inertia = np.einsum("kij,kj,klj->kil", turn, rng.uniform(0.2, 2.0, (count, 3)), turn)
    if planar:
        inertia = np.tile(np.eye(3), (count, 1, 1)) * rng.uniform(0.2, 2.0, (count, 1, 1))
    empty = np.zeros((0, 3))
    ints, mask = np.zeros(0, dtype=int), np.zeros(0, dtype=bool)
    center = rng.normal(size=(count, 3)) * [1, 0 if planar else 1, 1]
    return Program(
        names=tuple(f"part-{k}" for k in range(count)),
        free=np.arange(count) > 0, center=center, mass=rng.uniform(0.5, 2.0, count),
        inertia=inertia, radius=np.ones(count), gravity=np.array([0.0, 0, -9.81]),
        applied=np.zeros((count, 6)), clamp=np.zeros((count, 6)), part_a=ints, part_b=ints,
        point=empty, normal=empty, kind=ints, two_sided=mask, angular=mask, mu=np.zeros(0),
        source=ints, doubt=np.zeros(0), pull=np.zeros(0), tied=mask, shear=np.zeros(0),
            capacity=np.zeros(0),
        tolerance=np.full(count, 1e-9), planar=planar, units="m",
    )  # fmt: skip


def openings(program, motion):
    """Velocity of part b relative to a at each contact row, (K, 3), by the cross product."""

    def velocity(part):
        arm = program.point - program.center[part]
        v = motion[part, :3] + np.cross(motion[part, 3:], arm)
        return np.where((part >= 0)[:, None], v, 0.0)

    return velocity(program.part_b) - velocity(program.part_a)


def mass_matrix(program, motion):
    spin = np.einsum("kij,kj->ki", program.inertia, motion[:, 3:])
    return np.hstack([program.mass[:, None] * motion[:, :3], spin])


def wrenches(program, forces):
    total = np.zeros((len(program.names), 6))
    for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
        arm = program.point - program.center[part]
        six = sign * np.hstack([forces, np.cross(arm, forces)])
        np.add.at(total, part[part >= 0], six[part >= 0])
    return total


def contacts(rng, program, patches, *, planar, corners):
    """Rows of flat patches between random pairs of parts."""
    count = len(program.names)
    rows = []
    for source in range(patches):
        a, b = rng.choice(count, 2, replace=False)
        n = rng.normal(size=3) * [1, 0 if planar else 1, 1]
        n /= np.linalg.norm(n)
        at = rng.normal(size=3) * [1, 0 if planar else 1, 1]
        u = np.array([n[2], 0, -n[0]]) if planar else np.linalg.svd(n[None])[2][1]
        v = np.zeros(3) if planar else np.cross(n, u)
        ring = 2 * np.pi * np.arange(corners) / corners
        mu = rng.choice([0.0, rng.uniform(0.1, 1.2)], p=[0.15, 0.85])
        for k in range(corners):
            if planar:
                x = at + (k / max(corners - 1, 1) - 0.5) * u * (corners > 1)
            else:
                x = at + 0.5 * (corners > 1) * (np.cos(ring[k]) * u + np.sin(ring[k]) * v)
            rows.append((a, b, x, n, mu, source))
    a, b, x, n, mu, source = (np.array(column) for column in zip(*rows, strict=True))
    size = len(rows)
    return program.with_rows(
        part_a=a, part_b=b, point=x, normal=n, mu=mu, source=source,
        doubt=np.zeros(len(mu)),
        kind=np.full(size, CONTACT), two_sided=np.zeros(size, dtype=bool),
        angular=np.zeros(size, dtype=bool),
        pull=np.zeros(size), tied=np.zeros(size, dtype=bool),
        shear=np.full(size, np.nan), capacity=np.full(size, np.inf),
    )  # fmt: skip


def witnessed(seed, *, planar=False, parts=2, patches=3, corners=1):
    """A random program and a motion and forces that obey its contact law, or None."""
    rng = np.random.default_rng(seed)
    program = contacts(
        rng, bare(rng, parts, 0, planar=planar), patches, planar=planar, corners=corners
    )
    size = len(program.part_a)
    freedoms = [0, 2, 4] if planar else range(6)
    columns = [(k, j) for k in range(1, parts + 1) for j in freedoms]
    basis = np.zeros((len(columns), parts + 1, 6))
    for row, (k, j) in enumerate(columns):
        basis[row, k, j] = 1.0
    u = np.array([openings(program, one) for one in basis])  # (columns, K, 3)
    mode = rng.integers(0, 3, size)  # 0 free, 1 closed, 2 at rest
    held = [np.einsum("ck,k->c", u[:, p], program.normal[p]) for p in np.flatnonzero(mode == 1)]
    held += [u[:, p, j] for p in np.flatnonzero(mode == 2) for j in range(3)]
    free = np.eye(len(columns))
    if held:
        _, s, vt = np.linalg.svd(np.array(held))
        free = vt[int((s > 1e-9).sum()) :]
    if not len(free):
        return None
    motion = np.einsum("c,ckj->kj", rng.normal(size=len(free)) @ free, basis)
    speed = openings(program, motion)
    opening = (speed * program.normal).sum(axis=1)
    if (opening < -1e-12).any():
        flip = opening < -1e-12  # a contact from the other side
        bad = [
            (flip[program.source == s].any() and not flip[program.source == s].all())
            and (opening[program.source == s] > 1e-12).any()
            for s in set(program.source)
        ]
        if any(bad):
            return None
        turned = np.array([flip[program.source == s].any() for s in program.source])
        program = program.with_rows(
            normal=np.where(turned[:, None], -program.normal, program.normal)
        )
        opening = np.where(turned, -opening, opening)
    across = speed - opening[:, None] * program.normal
    closed = np.abs(opening) <= 1e-12
    slides = closed & (np.linalg.norm(across, axis=1) > 1e-9)
    push = np.where(closed, rng.uniform(0.0, 3.0, size) * (rng.random(size) < 0.9), 0.0)
    forces = push[:, None] * program.normal
    pace = np.linalg.norm(across, axis=1, keepdims=True)
    forces -= (
        np.where(slides[:, None], across / np.maximum(pace, 1e-300), 0.0)
        * (program.mu * push)[:, None]
    )
    stick = closed & ~slides
    side = rng.normal(size=(size, 3)) * [1, 0 if planar else 1, 1]
    side -= (side * program.normal).sum(axis=1, keepdims=True) * program.normal
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-300)
    forces += np.where(stick, program.mu * push * rng.random(size), 0.0)[:, None] * side
    load = mass_matrix(program, motion) - wrenches(program, forces)
    load[0] = 0.0
    if planar:
        load *= [1, 0, 1, 0, 1, 0]
    weight = np.zeros_like(load)
    weight[:, :3] = program.mass[:, None] * program.gravity
    program = program.with_rows(applied=load - weight)
    return Witnessed(program, motion, forces)


def jointed(program, a, b, at):
    """The program with a fixed joint of two parts."""

    def more(old, new):
        return np.concatenate([old, new])

    return program.with_rows(
        part_a=more(program.part_a, np.full(6, a)), part_b=more(program.part_b, np.full(6, b)),
        point=more(program.point, np.tile(at, (6, 1))),
        normal=more(program.normal, np.vstack([np.eye(3)] * 2)),
        kind=more(program.kind, np.full(6, JOINT)),
        two_sided=more(program.two_sided, np.ones(6, dtype=bool)),
        angular=more(program.angular, np.arange(6) >= 3),
        mu=more(program.mu, np.zeros(6)), doubt=more(program.doubt, np.zeros(6)),
        source=more(program.source, np.zeros(6, dtype=int)),
        pull=more(program.pull, np.zeros(6)), tied=more(program.tied, np.zeros(6, dtype=bool)),
        shear=more(program.shear, np.full(6, np.nan)),
        capacity=more(program.capacity, np.full(6, np.inf)),
    )  # fmt: skip
