"""Bodies of a MuJoCo model that move together, the parts that they form, and their masses.

MuJoCo welds a body without joints to its parent. A body with geoms and mass is a part of its own.
Other bodies belong to a part that moves with them: their geoms and their mass are those of it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.arrays import Mask
from kilter.assembly.interactions import Load
from kilter.assembly.mass_properties import MassProperties
from kilter.files.objects.mujoco_snapshot import Snapshot
from kilter.rigid import Pose

__all__ = ["held_bodies", "mass_fields", "owners", "relieving_loads"]


def held_bodies(model: Snapshot) -> Mask:
    """Mask of the bodies that do not move: those welded to the world or to a mocap body."""
    weld = model.body_weldid
    held: Mask = (weld == 0) | (model.body_mocapid[weld] >= 0)
    return held


def owners(model: Snapshot) -> dict[int, int]:
    """For each body that moves with a part, the body whose part it is.

    It is the nearest body above it with geoms and mass that moves with it, or else the first of
    the bodies that move together. Without a mass of its own, it is the first with geoms.
    """
    solid, held = model.body_geomnum > 0, held_bodies(model)
    bears = solid & (held | (model.body_mass > 0))
    groups: dict[int, list[int]] = {}
    for body in range(1, model.nbody):
        root = -body if held[body] else int(model.body_weldid[body])
        groups.setdefault(root, []).append(body)
    owner = {}
    for bodies in groups.values():
        chosen = [body for body in bodies if bears[body]] or [b for b in bodies if solid[b]][:1]
        for body in bodies if chosen else ():
            above = body
            while above not in chosen and above in bodies:
                above = int(model.body_parentid[above])
            owner[body] = above if above in chosen else chosen[0]
    return owner


def mass_fields(model: Snapshot, bodies: list[int], pose: Pose, *, held: bool) -> dict[str, Any]:
    """Mass, centre and inertia of bodies that move together, as fields of a part with a pose.

    For massless bodies there are none. A held part needs no inertia.
    """
    masses = []
    for body in bodies:
        if model.body_mass[body] > 0:
            turn = model.ximat[body].reshape(3, 3)
            inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
            masses.append(MassProperties(float(model.body_mass[body]), model.xipos[body], inertia))
    if not masses:
        return {}
    fields = MassProperties.sum(masses).fields(pose)
    if held:
        del fields["inertia"]
    return fields


def relieving_loads(model: Snapshot, names: dict[int, str]) -> list[Load]:
    """Forces of the gravity compensation of free bodies, at their centres.

    `names` has the name of the part of each body.
    """
    held = held_bodies(model)
    return [
        Load(
            names[body],
            force=-model.body_gravcomp[body] * model.body_mass[body] * model.gravity,
            point=model.xipos[body],
        )
        for body in np.flatnonzero(model.body_gravcomp * model.body_mass).tolist()
        if body in names and not held[body]
    ]
