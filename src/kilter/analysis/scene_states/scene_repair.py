"""Repair of a scene: floating objects fall to their contact, and clusters with faults settle.

1. Each floating object gets the pose after its fall (`SceneObject.move`).
2. Each cluster that still has an object that is not at rest is settled by itself
   (`kilter.settle`, with a fall of hanging parts). Held parts stay.

Clusters that cannot settle keep their poses, so the report after the repair lists their faults.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from kilter.analysis.scene_states.scene_graph import SceneGraph
from kilter.analysis.settled_pose.settle import settle
from kilter.arrays import Index
from kilter.assembly import Assembly
from kilter.assembly.question import Question
from kilter.contact.detect import touching
from kilter.errors import InputError
from kilter.rigid import Pose

__all__ = ["chosen_parts", "settled_clusters"]


def settled_clusters(asked: Question, faulty: Collection[str]) -> Assembly:
    """The assembly of a scene after each cluster with objects that are not at rest has settled.

    Clusters that do not come to rest keep their poses.
    """
    assembly = asked.assembly
    graph = SceneGraph.of(assembly, touching(asked))
    names = np.array([part.name in faulty for part in assembly.parts])
    poses: dict[str, Pose] = {}
    for cluster in graph.clusters(~assembly.geometry.grounded, near=True):
        if not names[cluster].any():
            continue
        asked.tell(f"settling {assembly.names[int(cluster[0])]}")
        beside = graph.beside(cluster)
        held = beside[assembly.geometry.grounded[beside]]
        sub = chosen_parts(assembly, np.sort(np.concatenate([cluster, held])), [])
        try:
            answer = settle(sub, drop=True, require=asked.require, effort=asked.effort)
        except InputError:
            continue  # parts in the same place, which settle rejects
        if answer.state == "at-rest":
            poses |= {part.name: part.pose for part in answer.assembly if not part.grounded}
    parts = [replace(p, pose=poses[p.name]) if p.name in poses else p for p in assembly.parts]
    return replace(assembly, parts=parts)


def chosen_parts(assembly: Assembly, chosen: Index, held: list[int]) -> Assembly:
    """The assembly of some of the parts, of which some are also held.

    Arguments: `chosen` (n,): positions of the parts, ascending.
    """
    parts = [assembly.parts[k] for k in chosen.tolist()]
    names = {part.name for part in parts}
    still = {assembly.names[k] for k in held}
    if still:
        parts = [replace(p, grounded=True) if p.name in still else p for p in parts]
    inside = {*names, "ground"}
    return replace(
        assembly,
        parts=parts,
        notes=(),
        friction_pairs=[e for e in assembly.friction_pairs if names.issuperset(e.parts)],
        contacts=[e for e in assembly.contacts if names.issuperset(e.parts)],
        joints=[e for e in assembly.joints if inside.issuperset(e.parts)],
        bonds=[e for e in assembly.bonds if names.issuperset(e.parts)],
        straps=[e for e in assembly.straps if inside.issuperset(e.parts)],
        loads=[e for e in assembly.loads if e.part in names - still],
    )
