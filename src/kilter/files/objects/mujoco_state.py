"""State of a MuJoCo simulation: its contacts, joints and forces, as arrays that a process can send.

The state is that of the given positions at rest: velocities count as zero, so that dampers carry
nothing. The engine's own forward dynamics then gives the acceleration a of each contact along its
normal. With the stiffness k and the impedance d of a contact of depth r (`mjData.efc_KBIP`), the
engine demands the acceleration d k r, and to first order

    a = d^2 k (r - r0),    r0: the depth at which the load is carried and nothing accelerates

so that r - r0 = a / (d^2 k) is the part of the depth that the contact parameters do not explain.

The module imports neither MuJoCo nor other modules that are slow, as `mujoco_snapshot`.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import numpy as np

MODEL = (
    "body_inertia", "body_jntadr", "body_jntnum", "body_mass", "body_mocapid", "body_parentid",
    "body_weldid", "dof_frictionloss", "eq_data", "eq_obj1id", "eq_obj2id", "eq_objtype", "eq_type",
    "geom_bodyid", "geom_size", "geom_type", "jnt_bodyid", "jnt_dofadr", "jnt_limited",
    "jnt_qposadr", "jnt_range", "jnt_type", "site_bodyid",
)  # fmt: skip
"""Fields of the model in a state."""
DATA = (
    "geom_xmat", "geom_xpos", "qfrc_actuator", "qfrc_applied", "qfrc_bias", "qfrc_passive", "qpos",
    "site_xpos", "xanchor", "xaxis", "xfrc_applied", "ximat", "xipos", "xmat", "xpos",
)  # fmt: skip
"""Fields of the data in a state."""
FREE, ADHESION = 0, 5
"""MuJoCo's numbers of free joints, and of actuators that act at contacts."""
FARTHEST = 10.0
"""Distance up to which the body nearest to a floating body is searched [m]."""
TOUCHES = 1e-6
"""Distance below which bodies count as touching [m]. Without it, bodies that touch exactly, as
drawn, would have no contact in the engine."""
SHORT = 1e-12
"""Push of a contact below which it has no acceleration of its own [m/s^2]."""


class EngineState(SimpleNamespace):
    """Fields of a MuJoCo model and its data, by the names that they have in MuJoCo.

    In addition, for K contacts, V degrees of freedom and N bodies:

    - `names`, `geom_names`: names of bodies and geoms, "" without a name.
    - `gravity` (3,) [m/s^2]; zero if it is disabled.
    - `points`, `normals` (K, 3), `mu` (K,), `geoms` (K, 2), `depth`, `unexplained` (K,) [m],
      `push` (K,) [m/s^2]: contacts, the normal from the first to the second geom; how deep they
      are; the part of this depth that their parameters do not explain; and the acceleration with
      which they separate.
    - `turning`: number of contacts with torsional or rolling friction.
    - `driven` (V,): whether an actuator acts on each degree of freedom.
    - `active` (neq,): whether each equality is active.
    - `speed` (N,): speed of each body before its velocity counted as zero [m/s].
    - `near`: for each body without a contact in a tree on a free joint, a pair: the nearest geom,
      -1 for none, and its distance [m].
    - `creep`: how far each body moves in simulations, by the changed settings (`simulated_creep`).
    - `notes`: features that are left out.
    """


def take_state(mujoco: Any, model: Any, data: Any, creep: float = 0.0) -> EngineState:
    """The state of a simulation, without a change of `data`.

    Arguments: `creep`: time for which the engine simulates the state in variants [s]; 0: not.
    """
    placed = copy.copy(data)
    mujoco.mj_kinematics(model, placed)
    mujoco.mj_comPos(model, placed)
    mujoco.mj_comVel(model, placed)
    speed = _speeds(mujoco, model, placed)
    placed.qvel[:] = 0
    with _wide_margins(model):
        mujoco.mj_forward(model, placed)
        contacts = _contacts(mujoco, model, placed)
    off = model.opt.disableflags
    gravity = np.array(model.opt.gravity)
    if off & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY):
        gravity[:] = 0
    active = np.array(getattr(placed, "eq_active", getattr(model, "eq_active0", ())), dtype=bool)
    if off & int(mujoco.mjtDisableBit.mjDSBL_EQUALITY):
        active[:] = False
    return EngineState(
        **{name: np.array(getattr(model, name)) for name in MODEL},
        **{name: np.array(getattr(placed, name)) for name in DATA},
        **contacts,
        names=[model.body(k).name for k in range(model.nbody)],
        geom_names=[model.geom(k).name for k in range(model.ngeom)],
        gravity=gravity,
        driven=_driven(model, placed),
        active=active,
        speed=speed,
        near=_nearest(mujoco, model, placed),
        creep=simulated_creep(mujoco, model, data, creep) if creep > 0 else {},
        notes=_notes(mujoco, model, placed),
    )


@contextmanager
def _wide_margins(model: Any) -> Iterator[None]:
    """Let bodies of a model touch that are nearer than `TOUCHES`, while the context lasts."""
    margins = {name: getattr(model, name) for name in ("geom_margin", "pair_margin")}
    kept = {name: margin.copy() for name, margin in margins.items()}
    try:
        for margin in margins.values():
            np.maximum(margin, TOUCHES, out=margin)
        yield
    finally:
        for name, margin in margins.items():
            margin[:] = kept[name]


def _speeds(mujoco: Any, model: Any, data: Any) -> Any:
    """Speed of the centre of mass of each body, shape (N,) [m/s]."""
    speeds, twist = np.zeros(model.nbody), np.zeros(6)
    for body in range(1, model.nbody):
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, twist, 0)
        speeds[body] = np.linalg.norm(twist[3:])
    return speeds


def _contacts(mujoco: Any, model: Any, data: Any) -> dict[str, Any]:
    """The active contacts of geoms, as fields of a state."""
    listed = data.contact
    geoms = np.array(listed.geom, dtype=np.int64).reshape(-1, 2)
    row = np.array(listed.efc_address, dtype=np.int64).reshape(-1)
    kept = np.flatnonzero((row >= 0) & (geoms >= 0).all(axis=1))
    friction = np.array(listed.friction).reshape(-1, 5)[kept]
    dim, row = np.array(listed.dim).reshape(-1)[kept], row[kept]
    depth = np.maximum(-np.array(listed.dist).reshape(-1)[kept], 0.0)
    push, unexplained = np.zeros(len(kept)), np.zeros(len(kept))
    if len(kept):
        speed_up = np.zeros(data.nefc)
        mujoco.mj_mulJacVec(model, data, speed_up, data.qacc)
        # the rows of a pyramid come in pairs along normal + tangent and normal - tangent
        pyramid = (dim > 1) & (model.opt.cone == int(mujoco.mjtCone.mjCONE_PYRAMIDAL))
        push = np.where(pyramid, (speed_up[row] + speed_up[row + pyramid]) / 2, speed_up[row])
        stiffness, _, impedance = np.array(data.efc_KBIP).reshape(-1, 4)[row, :3].T
        yields = impedance**2 * stiffness
        unexplained = np.where(push > SHORT, push / np.maximum(yields, SHORT), 0.0)
    return {
        "points": np.array(listed.pos).reshape(-1, 3)[kept],
        "normals": np.array(listed.frame).reshape(-1, 9)[kept, :3],
        "mu": np.where(dim > 1, friction[:, :2].min(axis=1, initial=np.inf), 0.0),
        "geoms": geoms[kept],
        "depth": depth,
        "push": push,
        "unexplained": np.minimum(unexplained, depth),
        "turning": int(np.count_nonzero(dim > 3)),
    }


def _driven(model: Any, data: Any) -> Any:
    """Mask of the degrees of freedom on which actuators act, shape (V,)."""
    driven = np.zeros(model.nv, dtype=bool)
    joints = np.flatnonzero(np.asarray(model.actuator_trntype) != ADHESION)
    moment = np.asarray(data.actuator_moment)
    if not hasattr(data, "moment_rownnz"):
        driven |= (moment.reshape(model.nu, model.nv)[joints] != 0).any(axis=0)
        return driven
    count, start = np.asarray(data.moment_rownnz), np.asarray(data.moment_rowadr)
    for k in joints.tolist():
        rows = slice(int(start[k]), int(start[k] + count[k]))
        columns = np.asarray(data.moment_colind).reshape(-1)[rows]
        driven[columns[moment.reshape(-1)[rows] != 0]] = True
    return driven


def _nearest(mujoco: Any, model: Any, data: Any) -> dict[int, Any]:
    """Nearest geom and its distance, for bodies without contact in trees on free joints."""
    if not hasattr(mujoco, "mj_geomDistance"):
        return {}
    weld = np.asarray(model.body_weldid)
    welded = weld[np.asarray(model.geom_bodyid)]
    root = np.asarray(model.body_rootid)[np.asarray(model.geom_bodyid)]
    geoms = np.array(data.contact.geom, dtype=np.int64).reshape(-1, 2)
    acts = np.array(data.contact.efc_address).reshape(-1) >= 0
    touching = set(welded[geoms[acts & (geoms >= 0).all(axis=1)]].reshape(-1).tolist())
    solid = (np.asarray(model.geom_contype) | np.asarray(model.geom_conaffinity)) != 0
    near: dict[int, Any] = {}
    reach, at = np.asarray(model.geom_rbound), np.asarray(data.geom_xpos)
    first = np.asarray(model.body_jntadr)[np.asarray(model.body_rootid)]
    loose = (first >= 0) & (np.asarray(model.jnt_type)[first] == FREE) if model.njnt else first > 0
    for body in sorted(set(weld[loose].tolist()) - touching - {0}):
        others = np.flatnonzero((root != model.body_rootid[body]) & solid)
        best: tuple[int, float] = (-1, FARTHEST)
        for geom in np.flatnonzero((welded == body) & solid).tolist():
            # bounding balls give a lower bound of the distance; a plane has none
            bound = np.linalg.norm(at[others] - at[geom], axis=1) - reach[others] - reach[geom]
            bound[reach[others] == 0] = -np.inf
            for k in np.argsort(bound).tolist():
                if bound[k] >= best[1]:
                    break
                other = int(others[k])
                way = mujoco.mj_geomDistance(model, data, geom, other, best[1], None)
                best = (other, float(way)) if way < best[1] else best
        near[body] = best
    return near


def _notes(mujoco: Any, model: Any, data: Any) -> list[str]:
    """Features of a model that hold or move bodies, but that are left out."""
    flex = sum(min(entry) < 0 for entry in np.asarray(data.contact.geom).reshape(-1, 2).tolist())
    ends = np.asarray(model.jnt_type) == int(mujoco.mjtJoint.mjJNT_BALL)
    counts = {
        "soft bodies": int(getattr(model, "nflex", 0)),
        "contacts of soft bodies": flex,
        "limits of tendons": int(np.count_nonzero(model.tendon_limited)),
        "frictions of tendons": int(np.count_nonzero(model.tendon_frictionloss)),
        "limits of ball joints": int(np.count_nonzero(np.asarray(model.jnt_limited)[ends])),
    }
    left = ", ".join(f"{count} {word}" for word, count in counts.items() if count)
    return [f"ignored: {left}"] if left else []


# Simulations of a state with other settings of the solver, to see which one creeps least.


SETTINGS: dict[str, dict[str, Any]] = {
    "as is": {},
    "cone elliptic": {"cone": 1},
    "cone elliptic, impratio 10": {"cone": 1, "impratio": 10.0},
    "cone elliptic, impratio 100": {"cone": 1, "impratio": 100.0},
    "noslip_iterations 10": {"noslip_iterations": 10},
}
"""Options of the engine in each simulation, by their words in MJCF."""


def simulated_creep(mujoco: Any, model: Any, data: Any, seconds: float) -> dict[str, Any]:
    """Way of the centre of mass of each body in simulations from rest, shape (N,) [m].

    There is one simulation for each entry of `SETTINGS`. Neither model nor data change.
    """
    ways = {}
    for words, options in SETTINGS.items():
        trial, start = copy.copy(model), copy.copy(data)
        for name, value in options.items():
            setattr(trial.opt, name, value)
        start.qvel[:] = 0
        mujoco.mj_forward(trial, start)
        before = np.array(start.xipos)
        for _ in range(max(round(seconds / trial.opt.timestep), 1)):
            mujoco.mj_step(trial, start)
        mujoco.mj_kinematics(trial, start)
        mujoco.mj_comPos(trial, start)
        ways[words] = np.linalg.norm(start.xipos - before, axis=1)
    return ways
