"""Compare the verdict of a proof with its evidence about small pushes, without a solver.

Forces of equilibrium alone do not prove that a small push topples nothing. Second order proves it
cluster by cluster; the other clusters are judged by the rules of `motions.small_push`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from kilter.arrays import Array, Mask
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.errors import some
from kilter.mechanics.certificate import check_forces
from kilter.mechanics.clusters import clusters
from kilter.mechanics.program import Program, build_program
from kilter.second_order.motions.sharp_points import with_sharp
from kilter.second_order.motions.small_push import small_push
from kilter.second_order.parts.rigid_groups import RigidGroups


def wrong_about_push(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    forces: Array,
    verdict: str,
    second: Mapping[str, Any] | None,
    *,
    curves: bool,
) -> list[str]:
    """Errors if the stated verdict is stronger than the evidence about small pushes; else empty.

    Arguments: `forces` (K,): forces of the proof along its rows [N].
    """
    rolling = None if second is None else second.get("rolling")
    falls = second is not None and second["state"] == "balanced" and rolling != "holds"
    if falls:
        return _differs(verdict, "balanced", "")
    rough = build_program(assembly, contacts)
    rough = rough if len(rough.kind) == len(program.kind) else program
    among = _without_proof(assembly, contacts, program, second)
    push = small_push(assembly, contacts, rough, forces, curves=curves, among=among)
    if push.state == "holds":
        return _differs(verdict, "stable", "") if verdict == "balanced" else []
    names = some([repr(assembly.names[k]) for k in np.flatnonzero(push.parts)])
    if push.state == "falls":
        return _differs(verdict, "balanced", f": a small push makes {names} fall")
    why = f": a small push may make {names} roll, rock or swing on"
    return _differs(verdict, "potentially-stable", why)


def rests_without_friction(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    forces: Array,
    second: Mapping[str, Any],
) -> bool:
    """True if the normal forces of a proof balance every cluster that has a second-order proof.

    Arguments: `forces` (K,): forces of the proof along its rows [N].
    """
    groups, smooth = RigidGroups.of(assembly), program.frictionless
    left = _without_proof(assembly, contacts, program, second)
    whole = groups.merged(smooth, assembly)
    own = forces[groups.between(smooth, assembly)] if groups.tied else forces
    return all(
        check_forces(cluster.program, own[cluster.rows]).holds
        for cluster in clusters(whole)
        if left is None or not left[cluster.program.free].any()
    )


def _differs(verdict: str, proved: str, why: str) -> list[str]:
    """The error that a verdict differs from the proved verdict; none for a weaker verdict."""
    if verdict in (proved, "potentially-stable"):
        return []
    return [f"it states {verdict!r}, but its evidence proves {proved!r}{why}"]


def _without_proof(
    assembly: Assembly, contacts: ContactSet, program: Program, second: Mapping[str, Any] | None
) -> Mask | None:
    """Mask of the free parts of clusters without a second-order proof, (N,); None for all parts."""
    if second is None:
        return None
    entries = second.get("clusters", [second])
    smooth = with_sharp(program.frictionless, contacts)
    parted = clusters(RigidGroups.of(assembly).merged(smooth, assembly))
    left = np.zeros(len(assembly.parts), dtype=bool)
    for cluster, entry in zip(parted, entries, strict=False):
        if entry is None:
            left |= cluster.program.free
    return left
