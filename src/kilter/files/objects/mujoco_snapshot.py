"""Snapshot of a MuJoCo model in a pose: arrays that a process can send to another.

The module imports neither MuJoCo nor other modules that are slow, since the process that reads
MJCF should start fast.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, nearest_name, some_names

COUNTS = ("na", "nbody", "nflex", "nq", "ntendon", "nv")
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
    "pair_friction", "pair_geom1", "pair_geom2", "pair_margin", "qpos0", "qpos_spring",
    "site_bodyid", "tendon_adr", "tendon_limited", "tendon_num", "tendon_stiffness", "wrap_objid",
    "wrap_type",
)  # fmt: skip
"""Fields of a model that kilter reads."""
PLACES = ("qpos", "xpos", "xquat", "xipos", "ximat", "xanchor", "xaxis")
"""Fields of the data: positions of joints; poses and principal axes of bodies, and joints."""
NEWER = ("flex_nodebodyid", "flex_vertbodyid", "geom_adhesion", "geom_surfacevel", "pair_adhesion")
"""Fields that older versions of MuJoCo do not have."""
KEY_VALUES = ("act", "ctrl", "mpos", "mquat")
"""Values of a keyframe besides positions and velocities of joints."""
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


@dataclass(frozen=True, slots=True)
class StateRows:
    """Rows of states that are compared by content and sent to another process."""

    width: int
    data: bytes

    @classmethod
    def of(cls, rows: Array) -> StateRows:
        """Keep rows of numbers, shape (n, width)."""
        return cls(rows.shape[1], np.ascontiguousarray(rows, dtype=float).tobytes())

    @property
    def rows(self) -> Array:
        """The rows, shape (n, width)."""
        return np.frombuffer(self.data).reshape(-1, self.width)


class Snapshot(SimpleNamespace):
    """Fields of a MuJoCo model and of its data, by the names that they have in MuJoCo.

    In addition: names of bodies and geoms, `gravity`, the disabled flags, the friction that
    overrides that of all contacts, and notes about the pose. `keys` has the names of the keyframes,
    `key` the index of that of the pose or None, and `key_values` its values besides positions.
    `places` has the fields of the data for each of several states.
    """

    def at(self, k: int) -> Snapshot:
        """The snapshot in the state with an index."""
        places = {name: values[k] for name, values in self.places.items()}
        return Snapshot(**{**vars(self), **places, "notes": list(self.notes)})


def take_snapshot(
    mujoco: Any, model: Any, data: Any, keyframe: str | None, states: StateRows | None = None
) -> Snapshot:
    """Snapshot of a model in the pose of its data, of a keyframe, or of the first keyframe.

    Arguments: `data`: without data and without a keyframe, the pose is that of the first keyframe,
    if any; `states`: states in place of both. Raises `InputError` if there is no keyframe of this
    name, or states do not belong to the model.
    """
    notes: list[str] = []
    placed = mujoco.MjData(model) if data is None or states is not None else data
    key, places = None, {}
    if states is not None:
        key = set_pose(mujoco, model, placed, keyframe, []) if data is None else None
        places = _places_of(mujoco, model, placed, positions(model, states.rows))
    elif data is None or keyframe is not None:
        key = set_pose(mujoco, model, placed, keyframe, notes)
    if not places:
        places = _places_of(mujoco, model, placed, np.array(placed.qpos)[None])
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
        **{name: values[0] for name, values in places.items()},
        places=places,
        keys=[model.key(k).name for k in range(model.nkey)],
        key=key,
        key_values={
            name: np.array(getattr(model, f"key_{name}")[key])
            for name in KEY_VALUES
            if key is not None
        },
        body_names=[model.body(k).name for k in range(model.nbody)],
        geom_names=[model.geom(k).name for k in range(model.ngeom)],
        **{name: np.array(getattr(model, name, ())) for name in NEWER},
        gravity=np.array(model.opt.gravity),
        disabled=disabled,
        common_friction=float(min(model.opt.o_friction[:2])) if overrides else None,
        notes=notes,
    )


def positions(model: Any, rows: Array) -> Array:
    """The positions of joints in states of a model, shape (n, nq).

    A state is qpos; or qpos and qvel; or time, qpos and qvel, with or without the activations.
    Raises `InputError` if the rows have another length.
    """
    start = first_position(model, rows.shape[1])
    return rows[:, start : start + model.nq]


def first_position(model: Any, width: int) -> int:
    """Index of the first position of joints in a state with a number of values.

    Raises `InputError` if a state of the model has another number of values.
    """
    nq, nv, na = int(model.nq), int(model.nv), int(model.na)
    starts = {1 + nq + nv + na: 1, 1 + nq + nv: 1, nq + nv: 0, nq: 0}
    if not nq:
        raise InputError("the model has no joint", hint="give a body a free joint")
    if width not in starts:
        forms = f"{nq} (qpos), {nq + nv} (qpos, qvel) or {1 + nq + nv} (time, qpos, qvel)"
        more = f", or {1 + nq + nv + na} with activations" if na else ""
        raise InputError(
            f"a state has {width} numbers, but a state of the model has {forms}{more}",
            hint="give states of this model",
        )
    return starts[width]


def _places_of(mujoco: Any, model: Any, data: Any, qpos: Array) -> dict[str, Array]:
    """The fields `PLACES` of the data for each row of positions, with a row for each."""
    rows: dict[str, list[Array]] = {name: [] for name in PLACES}
    for row in qpos:
        data.qpos[:] = row
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        for name, values in rows.items():
            values.append(np.array(getattr(data, name)))
    return {name: np.array(values) for name, values in rows.items()}


def set_pose(
    mujoco: Any, model: Any, data: Any, keyframe: str | None, notes: list[str]
) -> int | None:
    """Set the pose to the named keyframe, or to the first keyframe, if any; return its index."""
    keys = [model.key(k).name for k in range(model.nkey)]
    if keyframe is None and not keys:
        return None
    if keyframe is not None and keyframe not in keys:
        near = nearest_name(keyframe, keys)
        known = f"the keyframes are {some_names(keys)}" if keys else "the model has none"
        hint = f"did you mean {near!r}?" if near else known
        raise InputError(f"there is no keyframe {keyframe!r:.80}", hint=hint)
    key = 0 if keyframe is None else keys.index(keyframe)
    mujoco.mj_resetDataKeyframe(model, data, key)
    if keyframe is None:
        notes.append(f"the pose is that of the first keyframe, {keys[0]!r:.80}")
    return key
