"""Bodies of a MuJoCo model: those that do not move, robots, and bodies that move together.

A robot is a kinematic tree (a body that can move with respect to the world, and all bodies above
it in the chain) of which a motor moves a joint, a tendon or a site. Adhesion is no motor. In a
model with colliding geoms, bodies without them are no objects.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from kilter.arrays import Index, Mask
from kilter.assembly.geometry import MassProperties
from kilter.assembly.interactions import Load
from kilter.assembly.part import inertia_fault, inertia_matrix
from kilter.files.objects.mujoco_snapshot import Snapshot
from kilter.rigid import Pose

FREE = 0
"""MuJoCo's number of a free joint."""
AT_JOINT, AT_CRANK, AT_TENDON, AT_SITE = (0, 1), 2, 3, 4
"""MuJoCo's numbers for the places at which an actuator acts; 5 is adhesion of a body."""
WRAP_JOINT, WRAP_SITE = 1, 3
"""MuJoCo's numbers for joints and sites in the path of a tendon."""


def held_bodies(model: Snapshot) -> Mask:
    """Mask of the bodies that do not move: those welded to the world or to a mocap body."""
    weld = model.body_weldid
    held: Mask = (weld == 0) | (model.body_mocapid[weld] >= 0)
    return held


def tree_tops(model: Snapshot) -> Index:
    """For each body, the body at the top of its kinematic tree, shape (nbody,); 0: it is held."""
    held, top = held_bodies(model), np.zeros(model.nbody, dtype=np.int64)
    for body in range(1, model.nbody):  # parents have smaller numbers
        above = int(top[model.body_parentid[body]])
        top[body] = 0 if held[body] else above or body
    return top


def robots(model: Snapshot) -> list[Index]:
    """The bodies of each kinematic tree that motors move."""
    if "ACTUATION" in model.disabled:
        return []
    top = tree_tops(model)
    moved = {
        int(top[body]) for k in range(len(model.actuator_trntype)) for body in _driven(model, k)
    } - {0}
    return [np.flatnonzero(top == each) for each in sorted(moved)]


def _driven(model: Snapshot, motor: int) -> list[int]:
    """The bodies on which an actuator acts."""
    kind, place = int(model.actuator_trntype[motor]), int(model.actuator_trnid[motor, 0])
    if kind in AT_JOINT:
        return [int(model.jnt_bodyid[place])]
    if kind in (AT_CRANK, AT_SITE):
        return [int(model.site_bodyid[place])]
    if kind != AT_TENDON:
        return []
    first = int(model.tendon_adr[place])
    path = range(first, first + int(model.tendon_num[place]))
    owner = {WRAP_JOINT: model.jnt_bodyid, WRAP_SITE: model.site_bodyid}
    return [
        int(owner[int(model.wrap_type[k])][model.wrap_objid[k]])
        for k in path
        if int(model.wrap_type[k]) in owner
    ]


class Groups(NamedTuple):
    """Bodies that move together, as parts."""

    owner: dict[int, int]
    """The body whose part each body belongs to."""
    unseen: list[int]
    """Bodies of parts that cannot touch: they only connect joints."""
    left: int
    """Number of bodies with visible geoms that are no objects: nothing can touch them."""


def groups(model: Snapshot, held: Mask, collides: Mask) -> Groups:
    """Assign the bodies to parts.

    The part is that of the nearest body above with colliding geoms and mass that moves with it, or
    else of the first of the bodies that move together; without such a mass, of the first with
    colliding geoms. In a model without colliding geoms all geoms count as such.

    Arguments: `held` (nbody,): bodies that do not move; `collides` (ngeom,).
    """
    counts = model.geom_bodyid[collides] if collides.any() else model.geom_bodyid
    solid = np.bincount(counts, minlength=model.nbody) > 0
    bears = solid & (held | (model.body_mass > 0))
    together: dict[int, list[int]] = {}
    for body in range(1, model.nbody):
        root = -body if held[body] else int(model.body_weldid[body])
        together.setdefault(root, []).append(body)
    needed = _connecting(model, held)
    found = Groups({}, [], 0)
    left = 0
    for root, bodies in together.items():
        chosen = [body for body in bodies if bears[body]] or [b for b in bodies if solid[b]][:1]
        if not chosen and root in needed:
            chosen = [body for body in bodies if model.body_geomnum[body]][:1] or bodies[:1]
            found.unseen.append(chosen[0])
        elif not chosen:
            left += sum(bool(model.body_geomnum[body]) for body in bodies)
        for body in bodies if chosen else ():
            above = body
            while above not in chosen and above in bodies:
                above = int(model.body_parentid[above])
            found.owner[body] = above if above in chosen else chosen[0]
    return found._replace(left=left)


def _connecting(model: Snapshot, held: Mask) -> set[int]:
    """The first bodies of the groups that joints or equalities connect to others.

    Bodies of the points of soft objects do not count.
    """
    weld = model.body_weldid
    parent = weld[model.body_parentid]
    jointed = (model.body_jntnum > 0) & ~held
    free = np.zeros(model.nbody, dtype=bool)
    rows = np.flatnonzero(jointed)
    free[rows] = model.jnt_type[model.body_jntadr[rows]] == FREE
    needed = {*weld[jointed & ~free].tolist(), *parent[jointed & ~free].tolist()}
    tied = np.flatnonzero((model.eq_active0 != 0) & (model.eq_objtype == 1))
    for ends in (model.eq_obj1id, model.eq_obj2id):
        needed.update(weld[ends[tied]].tolist())
    for soft in (model.flex_vertbodyid, model.flex_nodebodyid):
        needed.difference_update(weld[soft[soft >= 0].astype(np.int64)].tolist())
    return needed - {0}


def mass_fields(model: Snapshot, bodies: list[int], pose: Pose, *, held: bool) -> dict[str, Any]:
    """Mass, centre and inertia of bodies that move together, as fields of a part with a pose.

    For massless bodies there are none. A held part needs no inertia, and an inertia that no body
    has is left out.
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
    if held or inertia_fault(inertia_matrix(fields["inertia"])):
        del fields["inertia"]
    return fields


def relieving_loads(model: Snapshot, names: dict[int, str], held: Mask) -> list[Load]:
    """Forces of the gravity compensation of free bodies, at their centres.

    `names` has the name of the part of each body.
    """
    return [
        Load(
            names[body],
            force=-model.body_gravcomp[body] * model.body_mass[body] * model.gravity,
            point=model.xipos[body],
        )
        for body in np.flatnonzero(model.body_gravcomp * model.body_mass).tolist()
        if body in names and not held[body]
    ]
