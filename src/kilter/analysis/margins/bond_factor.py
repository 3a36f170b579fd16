"""Required share of the bond strength: the least share with which forces hold the assembly.

    min s:  J^T f' + w + s c = 0,  f' in the cones          c: the clamps of all bonds

Below 1 the assembly stands, above 1 it falls. The bond that takes up most work in the motion that
starts there breaks first. If no share is enough, bonds of unlimited strength do not hold
either: then forces have both signs along the normals of all bonded points, and with
friction any size across them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.decision.strength import find_strength
from kilter.analysis.margins.load_limit import Limit, NoLimit, find_limit, finite, starting
from kilter.analysis.turning_tolerances import BEYOND_LIMIT, SIDES_NEAR
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, ForceRows, bonded_rows

__all__ = ["BondFactor", "find_bond_factor"]

NEEDLESS = 1e-9
"""Pulls of all bonds, over the weight, up to which they are not needed: a certificate tells no
less [-]."""
STRONG = 1e-3
"""A share below this, or near its gap, is asked again with the weight as unit [-]."""
GIVES = 1e-6
"""Share of the work from which on a bond counts as one that gives way [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class BondFactor:
    """The share of its strength that every bond needs at least, all alike.

    Attributes
    ----------
    value : float
        s [-]; 0 if no strength is needed.
    limit : Limit
        Forces and mechanism there.
    opens : tuple of pairs (int, float)
        Bonds that give way in the mechanism, by position in the assembly, and the share of the
        work that each takes up [-]; the greatest first.
    """

    value: float
    limit: Limit
    opens: tuple[tuple[int, float], ...]

    def to_dict(self, program: Program, assembly: Assembly) -> dict[str, Any]:
        """As JSON data of the answer of margins."""
        return {
            "gap": finite(self.limit.gap),
            "moves": starting(program, self.limit.mechanism),
            "opens": [
                {"parts": list(assembly.bonds[k].parts), "share": share} for k, share in self.opens
            ],
        }


def find_bond_factor(program: Program, contacts: ContactSet) -> BondFactor | NoLimit:
    """The least share of the strength of all bonds with which an assembly holds.

    Parameters
    ----------
    program : Program
        ``build_program(assembly, contacts)``.
    contacts : ContactSet

    Examples
    --------
    >>> from kilter import Assembly, Bond, Box, Part, Pose
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> top = Part("top", Box([1, 1, 1]), Pose([0, 0, 1]), grounded=True)
    >>> hung = Assembly([top, Part("low", Box([1, 1, 1]))], bonds=[Bond(("low", "top"), pull=9810)])
    >>> touching = contacts(hung)
    >>> round(find_bond_factor(build_program(hung, touching), touching).value, 8)
    0.25
    """
    if program.cohesion.any():
        return _by_strength(program, contacts)
    limit = find_limit(program, -program.clamp, most=1.0)
    if isinstance(limit, NoLimit):
        if limit.why == "failed" and judge(unbreakable(program)).stable is False:
            return NoLimit("none")
        return limit
    value = 0.0 if np.isinf(limit.value) else 1.0 - limit.value
    if program.clamp.any() and (value < STRONG or limit.gap > SIDES_NEAR * value):
        nearer = _by_weight(program)
        if isinstance(nearer, NoLimit) and value < STRONG:
            return nearer
        if isinstance(nearer, Limit) and (value < STRONG or nearer.gap < limit.gap):
            limit, value = nearer, -nearer.value
    return BondFactor(value, limit, _opens(program, contacts, limit) if value else ())


def _by_weight(program: Program) -> Limit | NoLimit:
    """The limit of minus the share, asked of pulls that are together as large as the weight."""
    unit = float(program.weight[program.free].sum() / program.pull.sum())
    loose = program.with_rows(clamp=np.zeros_like(program.clamp))
    found = find_limit(loose, -unit * program.clamp, most=1.0)
    if isinstance(found, NoLimit):
        return found
    value = 0.0 if found.value >= -NEEDLESS else found.value * unit
    gap = found.gap * max(abs(found.value), 1.0) * unit / max(abs(value), 1.0)
    return replace(found, value=value, gap=gap)


def unbreakable(program: Program) -> Program:
    """The program with bonds of unlimited strength: the limit of ever stronger bonds."""
    held = program.pull > 0
    rows = replace(
        program.force_rows,
        two_sided=program.two_sided | held,
        mu=np.where(held, 0.0, program.mu),
        pull=np.zeros(len(held)),
        shear=np.full(len(held), np.nan),
    )
    across = bonded_rows(replace(rows, tied=held & (program.mu > 0) | (program.cohesion > 0)))
    loose = program.with_rows(clamp=np.zeros_like(program.clamp))
    return loose.with_force_rows(ForceRows.join([rows, across]))


def _by_strength(program: Program, contacts: ContactSet) -> BondFactor | NoLimit:
    """The same if bonds carry shear up to a force, which is a share of the strength, too."""
    wide = cone_problem(program)
    found = find_strength(wide)
    if found is None or np.isinf(found.share):
        none = found is not None or judge(unbreakable(program)).stable is False
        return NoLimit("none" if none else "failed")
    held = check_forces(program.with_strength(found.share), found.forces, found.friction)
    limit, share = Limit(found.share, held, None, np.inf), found.share
    used = share * float(program.pull.sum() + program.cohesion.sum())
    if held.holds and used <= NEEDLESS * float(program.weight[program.free].sum()):
        return BondFactor(0.0, limit, ())
    for step in BEYOND_LIMIT:
        below = share - step * max(share, 1.0)
        moved = check_motion(program.with_strength(below), found.motion)
        if below >= 0 and moved.holds:
            limit = Limit(share, held, moved, (share - below) / max(share, 1.0))
            break
    if not held.holds:
        return NoLimit("failed")
    return BondFactor(share, limit, _opens(program, contacts, limit))


def _opens(program: Program, contacts: ContactSet, limit: Limit) -> tuple[tuple[int, float], ...]:
    """Bonds that give way in the mechanism at a limit."""
    if limit.mechanism is None:
        return ()
    strong = (program.pull > 0) | (program.cohesion > 0)
    rows = np.flatnonzero((program.kind == CONTACT) & strong)
    opening = np.maximum(program.velocities(limit.mechanism.motion)[rows], 0.0)
    slip = np.linalg.norm(program.slips(limit.mechanism.motion, rows), axis=1)
    bond = contacts.patch_bond[program.source[rows]]
    taken = program.pull[rows] * opening + program.cohesion[rows] * slip
    work = np.bincount(bond, taken).astype(np.float64)
    share = work / max(float(work.sum()), np.finfo(float).tiny)
    order = np.argsort(-share, kind="stable")
    return tuple((int(k), float(share[k])) for k in order if share[k] > GIVES)
