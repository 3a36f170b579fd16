"""Parts with flat faces that a motion without work tips: they stand exactly above an edge.

Contacts that press stay closed, and those with friction do not slip (`bending`). The other contacts
may open. A part between flat faces may slide, but if such a motion turns it about an axis that is
not vertical, it tips. For each turn c, multipliers l >= 0 exclude the sense c z > 0: with the rows
A z >= 0 of the contacts that may open, A^T l = -c.

Forces that friction squeezes between parts may press contacts that the load does not need; such a
contact counts as pressed, so that a tip may be missed beside it.

Parts that pressed points with friction fix to held parts do not move. Parts that pressed faces
connect to held parts only slide and spin about normals. Round and jointed parts count
as held: `bending` judges them. Bonded parts count as held, too.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array, Index, Mask, across, connected
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.clusters import clusters
from kilter.mechanics.nonnegative import nonnegative
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.gaps.fits import body_pairs
from kilter.second_order.motions.bending import Bending, round_rows
from kilter.second_order.second_order_tolerances import BENDS, SLIPS

__all__ = ["tipping_parts"]


def tipping_parts(
    assembly: Assembly, contacts: ContactSet, program: Program, forces: Array, held: Mask
) -> Mask:
    """Mask of the free parts between flat faces that may tip without work, shape (N,).

    Arguments: `forces` (K,): forces of an equilibrium along the rows [N]; `held` (N,): parts that
    count as held.
    """
    tips = np.zeros(len(program.names), dtype=bool)
    for cluster in clusters(replace(program, free=program.free & ~held)):
        part, mine = cluster.program, forces[cluster.rows]
        rounds = round_rows(part, contacts)
        search = Bending(assembly, contacts, part, mine, rounds)
        loose = part.free & ~search.steady
        if not loose.any():
            continue
        still = _stuck_parts(part, search.presses & (part.mu > 0))
        flat = _stuck_parts(part, search.presses)  # these slide, and spin about the normal
        bent = rounds & search.closed
        ends = np.concatenate([part.part_a[bent], part.part_b[bent]])
        still[ends[ends >= 0]] = True
        still &= part.free
        if not still.any():
            tips |= _tipping(search, loose & ~flat)
        elif (loose & ~still).any():
            tips |= tipping_parts(assembly, contacts, part, mine, still)
    return tips


def _stuck_parts(program: Program, presses: Mask) -> Mask:
    """Mask of the free parts that pressed faces connect to held parts, (N,)."""
    rows = np.flatnonzero(presses & (program.kind == CONTACT))
    if not len(rows):
        return np.zeros_like(program.free)
    count = len(program.free)
    body = np.append(np.where(program.free, np.arange(count), count), count)
    pair = body_pairs(program)[rows]
    order = np.argsort(pair, kind="stable")
    ends = np.flatnonzero(np.diff(pair[order])) + 1
    fixed = [mine[0] for mine in np.split(rows[order], ends) if _wide(program, mine)]
    label = connected(count + 1, body[program.part_a[fixed]], body[program.part_b[fixed]])
    return np.asarray((label[:-1] == label[-1]) & program.free)


def _wide(program: Program, rows: Index) -> bool:
    """True if points span a line, or in space a plane, so that two bodies stuck there move alike.

    Points count as apart if they are so by a small fraction of the bodies' size.
    """
    points = program.point[rows]
    free = np.append(program.free, False)
    ends = np.concatenate([program.part_a[rows], program.part_b[rows]])
    size = float(program.radius[ends[free[ends]]].min())
    if program.planar:
        points = points[:, [0, 2]]
    values = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    need = 1 if program.planar else 2
    return len(values) >= need and bool(values[need - 1] > SLIPS * size)


def _tipping(search: Bending, loose: Mask) -> Mask:
    """Mask of the loose parts that a neutral motion may turn about an axis that is not vertical."""
    program = search.program
    motions = search.neutral_motions()
    if motions is None:
        return loose
    tips, per = np.zeros_like(loose), len(program.freedoms)
    unpressed = np.flatnonzero((program.kind == CONTACT) & ~search.closed)
    opened = program.taking(unpressed).jacobian() @ (search.scale[:, None] * motions)
    size = np.linalg.norm(opened, axis=1, keepdims=True)
    opened = np.divide(opened, size, where=size > BENDS * size.max(initial=0.0), out=0 * opened)
    axes = np.array([[0.0, 1.0, 0.0]]) if program.planar else np.vstack(across(program.down[None]))
    for number, k in enumerate(np.flatnonzero(program.free).tolist()):
        if loose[k]:
            mine = motions[per * number : per * (number + 1)]
            turns = axes[:, 1:2] @ mine[2:] if program.planar else axes @ mine[3:]
            tips[k] = any(_possible(opened, sense * turn) for turn in turns for sense in (1, -1))
    return tips


def _possible(opened: Array, turn: Array) -> bool:
    """True if no multipliers prove that a motion z with `opened` z >= 0 has `turn` z <= 0."""
    size = float(np.linalg.norm(turn))
    if size <= BENDS:
        return False
    return nonnegative(opened, -turn)[1] > BENDS * size
