"""Read a state of an MJCF scene, in the process of `kilter.files.robots.scene_process`."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kilter.errors import InputError
from kilter.files.objects.mjcf_scenes import compiled_mjcf
from kilter.files.objects.mujoco_snapshot import set_pose
from kilter.files.objects.mujoco_state import EngineState, take_state
from kilter.files.reader_guard import reason_of

Run = tuple[int, float]
"""Time steps before the state is taken, and time of each simulation of its creep [s]."""


def read_state(
    path: Path,
    keyframe: str | None,
    row: tuple[float, ...] | None,
    run: Run,
    allow_time: Callable[[int], None],
) -> EngineState:
    """Read the state of an MJCF file in a pose, after a simulation.

    Arguments: `row`: numbers of the state in place of a keyframe; `allow_time`: called with the
    size of all files [bytes] before MuJoCo builds the scene. Raises `InputError` if the file is
    rejected, or the state does not belong to it.
    """
    mujoco, model = compiled_mjcf(path, allow_time)
    data, notes = mujoco.MjData(model), list[str]()
    set_pose(mujoco, model, data, keyframe, notes)
    if row is not None:
        set_row(model, data, row)
        notes = []
    for _ in range(run[0]):
        mujoco.mj_step(model, data)
    state = take_state(mujoco, model, data, run[1])
    state.notes = [*notes, *state.notes]
    return state


def set_row(model: Any, data: Any, row: Sequence[float]) -> None:
    """Set a state from its numbers: qpos; qpos and qvel; or time, qpos and qvel.

    Numbers after the velocities are activations. Raises `InputError` if the model has states of
    another length.
    """
    nq, nv, na = int(model.nq), int(model.nv), int(model.na)
    starts = {1 + nq + nv + na: 1, 1 + nq + nv: 1, nq + nv: 0, nq: 0}
    if len(row) not in starts or not nq:
        raise InputError(
            f"a state has {len(row)} numbers, but a state of the model has {nq} (qpos), {nq + nv} "
            f"(qpos, qvel) or {1 + nq + nv} (time, qpos, qvel)",
            hint="give states of this model",
        )
    first = starts[len(row)]
    data.qpos[:] = row[first : first + nq]
    rest = row[first + nq :]
    data.qvel[:] = rest[:nv] if rest else 0.0
    data.act[:] = rest[nv:] if len(rest) > nv else 0.0


def row_of_file(text: str) -> tuple[float, ...]:
    """The state that a text FILE or FILE:ROW names; the first row without a number.

    Raises `InputError` if the file is none of `numpy.save`, or has no such row.
    """
    match = re.fullmatch(r"(.+):(-?\d{1,9})", text)
    name, row = (match[1], int(match[2])) if match else (text, 0)
    try:
        rows = np.atleast_2d(np.load(name, allow_pickle=False).astype(float))
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"no states can be read: {reason_of(error)}", file=name, hint="write it by numpy.save"
        ) from None
    if rows.ndim != 2 or not -len(rows) <= row < len(rows):
        raise InputError(
            f"there is no state {row}", file=name, hint=f"the states are 0 to {len(rows) - 1}"
        )
    return tuple(rows[row].tolist())
