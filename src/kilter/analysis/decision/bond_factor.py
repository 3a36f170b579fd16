"""Bond factor: the least fraction of the strength of all bonds that holds the assembly.

    min s:  J^T f' + w + s c = 0,  f' in the cones          c: the wrenches of the bonds' pulls

If s is below 1, the bonds are strong enough; if s is above 1, the assembly falls. At the limit a
mechanism starts, and the bond that takes up most of its work breaks first.

If no share is enough, bonds of unlimited strength do not hold the assembly either. Their forces
have both signs along the normals of all bonded points and, with friction, any size across them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.analysis.analysis_tolerances import BEYOND_LIMIT, SIDES_NEAR
from kilter.analysis.decision.judge import find_strength, judge
from kilter.analysis.decision.refined_proofs import balanced_proof
from kilter.analysis.load_limit import Limit, NoLimit, find_limit
from kilter.contact import ContactSet
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, ForceRows, bonded_rows
from kilter.tell.record import InPython, OrNull, PairNames, Record, key

NEEDLESS = 1e-9
"""Bonds count as unneeded up to this sum of their pulls, divided by the weight [-]. A certificate
cannot resolve less."""
STRONG = 1e-3
"""A share below this is computed again with the weight as unit of force [-]. So is a share that is
not much larger than the gap of its proofs."""
GIVES = 1e-6
"""A bond gives way if it takes up more than this share of the work of the mechanism [-]."""


class OpeningBond(Record):
    """A bond that gives way in the mechanism, and its share of the work of all bonds."""

    parts: PairNames
    """Names of the bonded parts."""
    share: float
    """Share of the work [-]."""


class BondFactor(Record):
    """The least fraction of its strength that every bond needs; it is the same for all bonds."""

    value: InPython[float]
    """Share s [-]; 0 if the assembly holds without bonds."""
    limit: InPython[Limit]
    """Forces and mechanism at this share."""
    opens: tuple[OpeningBond, ...]
    """Bonds that give way in the mechanism, the largest share first."""

    @property
    @key
    def gap(self) -> OrNull:
        """Relative distance between the proved bounds [-]."""
        return self.limit.gap

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move below this share."""
        return self.limit.moves

    def __repr__(self) -> str:
        return f"BondFactor({self.value:.6g})"


def find_bond_factor(program: Program, contacts: ContactSet) -> BondFactor | NoLimit:
    """Compute the least fraction of the strength of all bonds with which an assembly holds.

    The result is a `NoLimit` with the reason "none" if bonds of any strength do not hold it, or
    "failed" if the solvers give no proof.

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
    if program.has_limits:
        return _by_strength(program, contacts)
    # the program contains the full strength, of which the limit removes the largest share
    limit = find_limit(program, -program.clamp, most=1.0)
    if isinstance(limit, NoLimit):
        # an unbreakable program has no straps, which might hold the assembly with more tension
        loose = not contacts.assembly.straps
        if limit.why == "failed" and loose and judge(unbreakable(program)).stable is False:
            return NoLimit("none")
        return limit
    value = 0.0 if np.isinf(limit.value) else 1.0 - limit.value
    # 1 - limit cancels for bonds far stronger than the weight
    if program.clamp.any() and (value < STRONG or limit.gap > SIDES_NEAR * value):
        nearer = _by_weight(program)
        if isinstance(nearer, NoLimit) and value < STRONG:
            return nearer
        if isinstance(nearer, Limit) and (value < STRONG or nearer.gap < limit.gap):
            limit, value = nearer, -nearer.value
    opens = _yielding_bonds(program, contacts, limit) if value else ()
    return BondFactor(value=value, limit=limit, opens=opens)


def _by_weight(program: Program) -> Limit | NoLimit:
    """The load limit whose value is minus the bond factor, accurate for strong bonds, too."""
    # without bonds the clamps are those of straps
    clamped = np.linalg.norm(program.clamp[program.free, :3], axis=1).sum()
    unit = float(program.weight[program.free].sum() / (program.pull.sum() or clamped or 1.0))
    loose = program.with_rows(clamp=np.zeros_like(program.clamp))
    scaled = find_limit(loose, -unit * program.clamp, most=1.0)
    if isinstance(scaled, NoLimit):
        return scaled
    value = 0.0 if scaled.value >= -NEEDLESS else scaled.value * unit
    gap = scaled.gap * max(abs(scaled.value), 1.0) * unit / max(abs(value), 1.0)
    return replace(scaled, value=value, gap=gap)


def unbreakable(program: Program) -> Program:
    """Copy of a program in which bonds have unlimited strength, in tension and compression.

    With friction, or if a bond takes shear, they also take any force across the normal.
    """
    bonded = program.pull > 0
    rows = replace(
        program.force_rows,
        two_sided=program.two_sided | bonded,
        mu=np.where(bonded, 0.0, program.mu),
        pull=np.zeros(len(bonded)),
        shear=np.full(len(bonded), np.nan),
    )
    across = bonded_rows(replace(rows, tied=bonded & (program.mu > 0) | (program.cohesion > 0)))
    loose = program.with_rows(clamp=np.zeros_like(program.clamp))
    return loose.with_force_rows(ForceRows.join([rows, across]))


def _by_strength(program: Program, contacts: ContactSet) -> BondFactor | NoLimit:
    """Compute the least common fraction of tension and shear strength that holds an assembly."""
    wide = cone_problem(program)
    strength = find_strength(wide)
    if strength is None or np.isinf(strength.share):
        loose = not contacts.assembly.straps
        hopeless = strength is not None or (loose and judge(unbreakable(program)).stable is False)
        return NoLimit("none" if hopeless else "failed")
    # at the limit itself rounding may leave no balanced forces: a little more strength does
    for step in (0.0, *BEYOND_LIMIT[:3]):
        share = strength.share + step * max(strength.share, 1.0)
        held = program.with_strength(share)
        # a stronger bond clamps its contact points harder, and its forces stay as they are
        forces = strength.forces + (share - strength.share) * program.pull
        balance = balanced_proof(held, check_forces(held, forces, strength.friction))
        if balance.holds:
            break
    limit = Limit(value=share, gap=np.inf, forces=balance, motion=None, program=program)
    used = share * program.strength
    if balance.holds and used <= NEEDLESS * float(program.weight[program.free].sum()):
        return BondFactor(value=0.0, limit=limit, opens=())
    # the motion gains power only below the limit; the nearest share with a proof sets the gap
    for step in BEYOND_LIMIT:
        below = share - step * max(share, 1.0)
        mechanism = check_motion(program.with_strength(below), strength.motion)
        if below >= 0 and mechanism.holds:
            limit = replace(limit, motion=mechanism, gap=(share - below) / max(share, 1.0))
            break
    if not balance.holds:
        return NoLimit("failed")
    opens = _yielding_bonds(program, contacts, limit)
    return BondFactor(value=share, limit=limit, opens=opens)


def _yielding_bonds(
    program: Program, contacts: ContactSet, limit: Limit
) -> tuple[OpeningBond, ...]:
    """Bonds that break in the limit mechanism, the largest fraction of the work first."""
    if limit.motion is None:
        return ()
    strong = (program.pull > 0) | (program.cohesion > 0)
    rows = np.flatnonzero((program.kind == CONTACT) & strong)
    opening = np.maximum(program.velocities(limit.motion.motion)[rows], 0.0)
    slip = np.linalg.norm(program.slips(limit.motion.motion, rows), axis=1)
    bond = contacts.patch_bond[program.source[rows]]
    taken = program.pull[rows] * opening + program.cohesion[rows] * slip
    work = np.bincount(bond, taken).astype(np.float64)
    share = work / max(float(work.sum()), np.finfo(float).tiny)
    order = np.argsort(-share, kind="stable")
    bonds = contacts.assembly.bonds
    return tuple(
        OpeningBond(parts=bonds[k].parts, share=float(share[k])) for k in order if share[k] > GIVES
    )
