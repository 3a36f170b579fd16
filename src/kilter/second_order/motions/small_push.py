"""Answer about small pushes by rules alone: bending motions, and rolling without slip. No solver.

holds   no motion that keeps the pressed contacts bends, or friction holds all that roll
falls   the energy decreases along a rolling
open    a round or jointed part may roll, rock or swing, and nothing is proved about it
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Mask, read_only
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.clusters import Cluster, clusters
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, OF_JOINTS
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.joint_forms import slipping
from kilter.second_order.motions.bending import bending_bodies
from kilter.second_order.motions.rolling import Rolling, Rolls, find_rolling, worst_rolling
from kilter.second_order.parts.rigid_groups import RigidGroups

__all__ = ["SmallPush", "small_push"]


@dataclass(frozen=True, slots=True, eq=False)
class SmallPush:
    """Result of a small push on round and jointed parts.

    Attributes
    ----------
    state : {"holds", "falls", "open"}
    parts : ndarray of bool, shape (N,)
        Parts that fall, or about which nothing is proved; rigid groups count as their first part.
    rolling : Rolling or None
        Rolling of the first cluster with this state; None without friction there.
    """

    state: Rolls
    parts: Mask
    rolling: Rolling | None

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

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    program : Program
        Certain contacts, with their friction, and joints.
    forces : ndarray, shape (K,)
        Forces of an equilibrium along its rows [N].
    curves : bool
        Whether these forces have no friction.
    among : ndarray of bool, shape (N,), optional
        Parts whose clusters count; by default all.
    """
    groups = RigidGroups.of(assembly)
    whole = groups.merged(program, assembly)
    if groups.tied:
        forces = forces[groups.between(program, assembly)]
    certain = np.isin(whole.kind, (CONTACT, *OF_JOINTS)) & ~slipping(whole, forces)
    whole, forces = whole.taking(certain), forces[certain]
    bending = bending_bodies(contacts, assembly.joints, whole, forces, curves=curves)
    if among is not None:
        bending &= among
    results: list[tuple[Rolls, Rolling | None, Mask]] = []
    for cluster in clusters(whole) if bending.any() else []:
        mine = bending & cluster.program.free
        if not mine.any():
            continue
        rolling = _rolling(assembly, contacts, cluster, mine)
        results.append(("open" if rolling is None else rolling.state, rolling, mine))
    if not results:
        return SmallPush("holds", np.zeros_like(bending), None)
    state = worst_rolling(result[0] for result in results)
    same = [result for result in results if result[0] == state]
    parts = np.any([mine for _, _, mine in same], axis=0)
    return SmallPush(state, parts & (state != "holds"), same[0][1])


def _rolling(
    assembly: Assembly, contacts: ContactSet, cluster: Cluster, bending: Mask
) -> Rolling | None:
    """Rolling of the bending parts of a cluster while its other parts are held, else of all of it.

    Held parts only take motions away, so the first counts if it falls. None without friction.
    """
    program = cluster.program
    if not program.mu.any():
        return None
    features = features_of(program, contacts, recognised=True)
    for part in clusters(replace(program, free=bending)):
        found = find_rolling(part.program, features.take(part.rows), assembly.joints)
        if found.state == "falls":
            return found
    return find_rolling(program, features, assembly.joints)
