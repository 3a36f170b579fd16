"""Merge rigidly joined parts of a program to single bodies, so that it has fewer freedoms.

A fixed joint adds six unknown forces and six equations between the freedoms of its parts. If the
parts always move together, a single body is sufficient. The mass, centre and inertia of the body of
parts i are

    m = sum m_i,   c = sum m_i c_i / m,   I = sum I_i + m_i (|d_i|^2 - d_i d_i^T),   d_i = c_i - c

and rows between two parts of the same body are removed. Forces and motions are those of the joined
parts.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Index, cross, group_sums
from kilter.mechanics.program import Program

__all__ = ["merge_parts"]


def merge_parts(program: Program, group: Index) -> Program:
    """Copy of a program in which each group of rigidly joined parts is a single part.

    Arguments: `group` (N,).

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import scene
    >>> assembly = scene("tower")
    >>> program = build_program(assembly, contacts(assembly))
    >>> merged = merge_parts(program, np.minimum(np.arange(len(assembly)), 1))
    >>> len(merged.names), bool(merged.mass[1] == program.mass[1:].sum())
    (2, True)
    """
    count = int(group.max(initial=-1)) + 1
    mass = np.bincount(group, program.mass, minlength=count)
    center = group_sums(group, program.mass[:, None] * program.center, count) / mass[:, None]
    arm = program.center - center[group]
    square = np.einsum("ij,ij->i", arm, arm)[:, None, None] * np.eye(3)
    steiner = program.mass[:, None, None] * (square - arm[:, :, None] * arm[:, None, :])
    applied, clamp = program.applied.copy(), program.clamp.copy()
    for load in (applied, clamp):
        load[:, 3:] += cross(arm, load[:, :3])
    radius, tolerance = np.zeros(count), np.zeros(count)
    np.maximum.at(radius, group, program.radius + np.linalg.norm(arm, axis=1))
    np.maximum.at(tolerance, group, program.tolerance)
    free = np.ones(count, dtype=bool)
    free[group[~program.free]] = False
    group_or_ground = np.append(group, -1)
    a, b = group_or_ground[program.part_a], group_or_ground[program.part_b]
    still = ~np.append(free, False)
    rows = np.flatnonzero((a != b) & ~(still[a] & still[b]))
    first_part = np.unique(group, return_index=True)[1]
    return program.taking(rows).with_rows(
        names=tuple(program.names[k] for k in first_part),
        free=free,
        center=center,
        mass=mass,
        inertia=group_sums(group, program.inertia + steiner, count),
        radius=radius,
        applied=group_sums(group, applied, count),
        clamp=group_sums(group, clamp, count),
        part_a=a[rows],
        part_b=b[rows],
        tolerance=tolerance,
    )
