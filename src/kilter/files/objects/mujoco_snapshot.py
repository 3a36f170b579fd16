"""Snapshot of a MuJoCo model in a pose: arrays that a process can send to another.

The module imports neither MuJoCo nor other modules that are slow, since the process that reads
MJCF should start fast.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from kilter.errors import InputError, nearest_name, some_names

COUNTS = ("nbody", "nflex", "ntendon")
ARRAYS = (
    "actuator_trnid", "actuator_trntype", "body_geomnum", "body_gravcomp", "body_inertia",
    "body_jntadr", "body_jntnum", "body_mass", "body_mocapid", "body_parentid", "body_weldid",
    "dof_bodyid", "dof_frictionloss", "eq_active0", "eq_data", "eq_obj1id", "eq_obj2id",
    "eq_objtype", "eq_type", "exclude_signature", "geom_bodyid", "geom_conaffinity", "geom_condim",
    "geom_contype", "geom_dataid", "geom_friction", "geom_margin", "geom_pos", "geom_priority",
    "geom_quat", "geom_size", "geom_type", "hfield_adr", "hfield_data", "hfield_ncol",
    "hfield_nrow", "hfield_size", "jnt_bodyid", "jnt_dofadr", "jnt_limited", "jnt_qposadr",
    "jnt_range", "jnt_stiffness", "jnt_type", "mesh_face", "mesh_faceadr", "mesh_facenum",
    "mesh_graph", "mesh_graphadr", "mesh_vert", "mesh_vertadr", "mesh_vertnum", "pair_dim",
    "pair_friction", "pair_geom1", "pair_geom2", "pair_margin", "qpos_spring", "site_bodyid",
    "tendon_adr", "tendon_limited", "tendon_num", "tendon_stiffness", "wrap_objid", "wrap_type",
)  # fmt: skip
"""Fields of a model that kilter reads."""
PLACES = ("qpos", "xpos", "xquat", "xipos", "ximat", "xanchor", "xaxis")
"""Fields of the data: positions of joints; poses and principal axes of bodies, and joints."""
NEWER = ("geom_adhesion", "geom_surfacevel", "pair_adhesion")
"""Fields that older versions of MuJoCo do not have."""
DISABLED = {
    "jnt_limited": ("LIMIT", "CONSTRAINT"),
    "jnt_stiffness": ("SPRING",),
    "tendon_limited": ("LIMIT", "CONSTRAINT"),
    "tendon_stiffness": ("SPRING",),
    "dof_frictionloss": ("FRICTIONLOSS", "CONSTRAINT"),
    "eq_active0": ("EQUALITY", "CONSTRAINT"),
}
"""Fields that flags of a model switch off."""
FLAGS = ("ACTUATION", "CONSTRAINT", "CONTACT", "FILTERPARENT", "GRAVITY")
"""Further flags of a model that kilter obeys if they are disabled."""


class Snapshot(SimpleNamespace):
    """Fields of a MuJoCo model and of its data, by the names that they have in MuJoCo.

    In addition: names of bodies and geoms, `gravity`, the disabled flags, the friction that
    overrides that of all contacts, and notes about the pose.
    """


def take_snapshot(mujoco: Any, model: Any, data: Any, keyframe: str | None) -> Snapshot:
    """Snapshot of a model in the pose of its data, of a keyframe, or of the first keyframe.

    Arguments: `data`: without data and without a keyframe, the pose is that of the first keyframe,
    if any. Raises `InputError` if there is no keyframe of this name.
    """
    notes: list[str] = []
    placed = mujoco.MjData(model) if data is None else data
    if data is None or keyframe is not None:
        _set_pose(mujoco, model, placed, keyframe, notes)
    mujoco.mj_kinematics(model, placed)
    mujoco.mj_comPos(model, placed)
    every = {*FLAGS, *(flag for flags in DISABLED.values() for flag in flags)}
    bits = {flag: int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}", 0)) for flag in every}
    disabled = {flag for flag, bit in bits.items() if model.opt.disableflags & bit}
    arrays = {name: np.array(getattr(model, name)) for name in ARRAYS}
    for name, flags in DISABLED.items():
        if not disabled.isdisjoint(flags):
            arrays[name][:] = 0
    bent = np.count_nonzero(getattr(model, "jnt_stiffnesspoly", 0))
    if bent:
        notes.append("the springs of joints count with their linear stiffness only")
    overrides = model.opt.enableflags & int(mujoco.mjtEnableBit.mjENBL_OVERRIDE)
    return Snapshot(
        **{name: int(getattr(model, name)) for name in COUNTS},
        **arrays,
        **{name: np.array(getattr(placed, name)) for name in PLACES},
        body_names=[model.body(k).name for k in range(model.nbody)],
        geom_names=[model.geom(k).name for k in range(model.ngeom)],
        **{name: np.array(getattr(model, name, ())) for name in NEWER},
        gravity=np.array(model.opt.gravity),
        disabled=disabled,
        common_friction=float(min(model.opt.o_friction[:2])) if overrides else None,
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
