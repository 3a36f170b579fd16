"""Snapshot of a MuJoCo model in a pose: arrays that a process can send to another.

The module imports neither MuJoCo nor other modules that are slow, since the process that reads
MJCF should start fast.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from kilter.errors import InputError, nearest_name, some_names

__all__ = ["Snapshot", "take_snapshot"]

COUNTS = ("nbody", "nu", "ntendon")
ARRAYS = (
    "body_geomadr", "body_geomnum", "body_ipos", "body_jntadr", "body_jntnum", "body_mass",
    "body_parentid", "body_weldid", "dof_frictionloss", "eq_active0", "eq_data", "eq_obj1id",
    "eq_obj2id", "eq_objtype", "eq_type", "exclude_signature", "geom_bodyid", "geom_conaffinity",
    "geom_condim", "geom_contype", "geom_dataid", "geom_friction", "geom_pos", "geom_quat",
    "geom_size", "geom_type", "jnt_dofadr", "jnt_limited", "jnt_qposadr", "jnt_range",
    "jnt_stiffness", "jnt_type", "mesh_face", "mesh_faceadr", "mesh_facenum", "mesh_vert",
    "mesh_vertadr", "mesh_vertnum", "qpos_spring",
)  # fmt: skip
"""Fields of a model that kilter reads."""
PLACES = ("qpos", "xpos", "xquat", "xanchor", "xaxis")
"""Fields of the data: positions of joints, and poses of bodies, anchors and axes in the world."""
DISABLED = {
    "jnt_limited": "mjDSBL_LIMIT",
    "jnt_stiffness": "mjDSBL_SPRING",
    "dof_frictionloss": "mjDSBL_FRICTIONLOSS",
}
"""Fields that a flag of a model switches off."""


class Snapshot(SimpleNamespace):
    """Fields of a MuJoCo model and of its data, by the names that they have in MuJoCo.

    In addition: names of bodies and geoms, `gravity`, `disableflags`, and notes about the pose.
    """


def take_snapshot(mujoco: Any, model: Any, data: Any, keyframe: str | None) -> Snapshot:
    """Snapshot of a model in the pose of its data, of a keyframe, or of the first keyframe.

    Parameters
    ----------
    mujoco : module
    model : MjModel
    data : MjData or None
        Without data and without a keyframe, the pose is that of the first keyframe, if any.
    keyframe : str or None
        Name of a keyframe.

    Raises
    ------
    InputError
        If there is no keyframe of this name.
    """
    notes: list[str] = []
    placed = mujoco.MjData(model) if data is None else data
    if data is None or keyframe is not None:
        _set_pose(mujoco, model, placed, keyframe, notes)
    mujoco.mj_kinematics(model, placed)
    arrays = {name: np.array(getattr(model, name)) for name in ARRAYS}
    for name, flag in DISABLED.items():
        if model.opt.disableflags & int(getattr(mujoco.mjtDisableBit, flag, 0)):
            arrays[name][:] = 0
    bent = np.count_nonzero(getattr(model, "jnt_stiffnesspoly", 0))
    if bent:
        notes.append("the springs of joints count with their linear stiffness only")
    return Snapshot(
        **{name: int(getattr(model, name)) for name in COUNTS},
        **arrays,
        **{name: np.array(getattr(placed, name)) for name in PLACES},
        body_names=[model.body(k).name for k in range(model.nbody)],
        geom_names=[model.geom(k).name for k in range(model.ngeom)],
        gravity=np.array(model.opt.gravity),
        filters_parents=not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT),
        notes=notes,
    )


def _set_pose(mujoco: Any, model: Any, data: Any, keyframe: str | None, notes: list[str]) -> None:
    """Set the pose to the named keyframe, or to the first keyframe, if any."""
    keys = [model.key(k).name for k in range(model.nkey)]
    if keyframe is None and not keys:
        return
    if keyframe is not None and keyframe not in keys:
        near = nearest_name(keyframe, keys)
        known = f"the keyframes are {some_names(keys)}" if keys else "the model has none"
        hint = f"did you mean {near!r}?" if near else known
        raise InputError(f"there is no keyframe {keyframe!r:.80}", hint=hint)
    mujoco.mj_resetDataKeyframe(model, data, 0 if keyframe is None else keys.index(keyframe))
    if keyframe is None:
        notes.append(f"the pose is that of the first keyframe, {keys[0]!r:.80}")
