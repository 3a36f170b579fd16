"""Read a state of an MJCF scene, in the process of `kilter.files.robots.scene_process`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from kilter.files.objects.mjcf_scenes import compiled_mjcf
from kilter.files.objects.mujoco_snapshot import StateRows, first_position, set_pose
from kilter.files.objects.mujoco_state import EngineState, take_state


def read_state(
    path: Path,
    keyframe: str | None,
    states: StateRows | None,
    run: tuple[int, float],
    allow_time: Callable[[int], None],
) -> EngineState:
    """Read the state of an MJCF file in a pose, after a simulation.

    Arguments: `states`: the state in place of that of a keyframe; `run`: time steps before the
    state is taken, and time of simulations after it [s]; `allow_time`: called with the size of all
    files [bytes] before MuJoCo builds the scene. Raises `InputError` if the file is rejected, or
    the state does not belong to it.
    """
    mujoco, model, _ = compiled_mjcf(path, allow_time)
    data, notes = mujoco.MjData(model), list[str]()
    set_pose(mujoco, model, data, keyframe, notes)
    if states is not None:
        row, notes = states.rows[0], []
        first, nq, nv = first_position(model, len(row)), int(model.nq), int(model.nv)
        data.qpos[:] = row[first : first + nq]
        rest = row[first + nq :]
        data.qvel[:] = rest[:nv] if len(rest) else 0.0
        data.act[:] = rest[nv:] if len(rest) > nv else 0.0
    for _ in range(run[0]):
        mujoco.mj_step(model, data)
    state = take_state(mujoco, model, data, run[1])
    state.notes = [*notes, *state.notes]
    return state
