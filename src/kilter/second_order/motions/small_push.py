"""Answer about small pushes by rules alone: bending motions, and rolling without slip. No solver.

holds   no motion that keeps the pressed contacts bends, or friction holds all that roll
falls   the energy decreases along a rolling
open    a round or jointed part may roll, rock or swing, and nothing is proved about it; or a part
        stands exactly above an edge (`edge_tips`)

If no other part of a cluster moves along a neutral motion, the bending parts are examined alone,
while the others are held: friction that others need does not matter to them. A ball in a bowl, on a
block that friction holds on a slope, has forces without friction, so it stays as on level ground.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Mask, read_only
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.certificate import check_forces
from kilter.mechanics.clusters import Cluster, clusters
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, OF_JOINTS
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.joint_forms import slipping
from kilter.second_order.motions.bending import bending_bodies, tipping_parts
from kilter.second_order.motions.rolling import (
    Rolling,
    Rolls,
    find_rolling,
    open_rolling,
    worst_rolling,
)
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import ROUNDED

ABOVE_EDGE = "the weight acts exactly above an edge, or a single point, of contact"


@dataclass(frozen=True, slots=True, eq=False)
class SmallPush:
    """Result of a small push on round and jointed parts."""

    state: Rolls
    """One of "holds", "falls", "open"."""
    parts: Mask
    """Parts that fall, or about which nothing is proved, shape (N,); rigid groups count as their
    first part."""
    rolling: Rolling | None
    """Rolling of the first cluster with this state; None if no part may fall."""
    rough: bool = False
    """Whether the parts touch with friction."""

    def __post_init__(self) -> None:
        read_only(self)


def small_push(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    forces: Array,
    *,
    curves: bool,
    among: Mask | None = None,
) -> SmallPush:
    """Decide by rules whether a small push may make round or jointed parts fall.

    Arguments: `forces` (K,): forces of an equilibrium along its rows [N]; `among` (N,): parts whose
    clusters count; by default all.
    """
    groups = RigidGroups.of(assembly)
    whole = groups.merged(program, assembly)
    if groups.tied:
        forces = forces[groups.between(program, assembly)]
    certain = np.isin(whole.kind, (CONTACT, *OF_JOINTS)) & ~slipping(whole, forces)
    bonded = np.zeros(len(whole.names) + 1, dtype=bool)
    glued = ~certain | (whole.pull > 0) | whole.tied | np.isfinite(whole.shear)
    bonded[np.concatenate([whole.part_a[glued], whole.part_b[glued]])] = True
    whole, forces = whole.taking(certain), forces[certain]
    bends = bending_bodies(assembly, contacts, whole, forces, curves=curves)
    bending = bends.bending.copy()
    held = bonded[:-1].copy()
    if among is not None:
        bending &= among
        held |= ~among
    results: list[tuple[Rolls, Rolling | None, Mask]] = []
    # coarse coordinates do not tell an edge from a place beside it
    exact = float(whole.tolerance[whole.free].max(initial=0.0)) <= ROUNDED
    tips = tipping_parts(assembly, contacts, whole, forces, held) if exact else np.zeros_like(held)
    if tips.any():
        results.append(("open", open_rolling(whole, ABOVE_EDGE), tips))
    for cluster in clusters(whole) if bending.any() else []:
        mine = bending & cluster.program.free
        if mine.any():
            isolated = not (bends.moved & cluster.program.free & ~mine).any()
            own = forces[cluster.rows]
            pushed = _Pushed(assembly, contacts, cluster.program, own, bonded[:-1])
            rolling = pushed.alone(mine) if isolated else pushed.beside(mine)
            results.append(("holds" if rolling is None else rolling.state, rolling, mine))
    if not results:
        return SmallPush("holds", np.zeros_like(bending), None)
    state = worst_rolling(result[0] for result in results)
    same = [result for result in results if result[0] == state]
    parts = np.any([mine for _, _, mine in same], axis=0)
    rough = whole.mu > 0
    ends = np.concatenate([whole.part_a[rough], whole.part_b[rough]])
    touched = bool(parts[ends[ends >= 0]].any())
    return SmallPush(state, parts & (state != "holds"), same[0][1], rough=touched)


class _Pushed:
    """Parts of a cluster that bend, and their rolling.

    Arguments: `forces` (K,): normal forces of an equilibrium [N]; `bonded` (N,): parts at bonds and
    straps, which are no rows of the program.
    """

    def __init__(
        self,
        assembly: Assembly,
        contacts: ContactSet,
        program: Program,
        forces: Array,
        bonded: Mask,
    ) -> None:
        self.assembly, self.contacts, self.program = assembly, contacts, program
        self.forces, self.bonded = forces, bonded
        self.features = features_of(program, contacts, recognised=True)

    def alone(self, bending: Mask) -> Rolling | None:
        """Rolling of the bending parts alone, the worst; None if they stay without friction.

        The other parts do not move along any neutral motion, so they count as held.
        """
        found = []
        for part in clusters(replace(self.program, free=bending)):
            if not self._stays_without_friction(part):
                found.append(self._rolling(part))
        state = worst_rolling([rolling.state for rolling in found] or ["holds"])
        return next((rolling for rolling in found if rolling.state == state), None)

    def beside(self, bending: Mask) -> Rolling:
        """Rolling of the bending parts beside others that move.

        Held parts only take motions away, so a fall of the bending parts alone counts.
        """
        for part in clusters(replace(self.program, free=bending)):
            rolling = self._rolling(part)
            if rolling.state == "falls":
                return rolling
        return self._rolling(Cluster(self.program, np.arange(len(self.program.kind))))

    def _rolling(self, part: Cluster) -> Rolling:
        """Rolling of a part of the cluster while all others are held."""
        if self.bonded[part.program.free].any():
            return open_rolling(part.program, "rolling is not modelled with bonds")
        return find_rolling(part.program, self.features.take(part.rows), self.assembly)

    def _stays_without_friction(self, part: Cluster) -> bool:
        """True if forces without friction balance a part of the cluster, and no motion bends it."""
        smooth = part.program.frictionless
        load = smooth.load[np.ix_(smooth.free, smooth.freedoms)].reshape(-1)
        least = np.linalg.lstsq(smooth.jacobian().T.toarray(), -load, rcond=None)[0]
        for forces in (self.forces[part.rows], least):
            if check_forces(smooth, forces).holds and not slipping(smooth, forces).any():
                bends = bending_bodies(self.assembly, self.contacts, smooth, forces, curves=True)
                return not bends.bending.any()
        return False
