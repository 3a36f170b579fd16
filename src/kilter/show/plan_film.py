"""A plan as an animated GLB film: each part is inserted along its path.

A part has scale zero before its step, because core glTF cannot hide nodes. A small octahedron
marks a part while a hand holds it. Without animation, a viewer shows the complete assembly.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix
from kilter.show.glb_film import Film, xyzw

if TYPE_CHECKING:
    from kilter.assembly import Assembly

__all__ = ["film_of_plan"]

LEAD, STEP, MOVES = 0.8, 1.25, 1.0
"""Time before the first step, duration of a step, and duration of the motion in it [s]."""
KEYS = 13
"""Number of key frames of a track along a path."""
NEAR = 1.2
"""Greatest distance of a part from its first corner at the start [size of the assembly]."""
TURNS = 3
"""Number of turns that a nut makes on its thread in the film."""
MARK = 0.28
"""Size of the mark of a held part [bounding radius of the part]."""


def film_of_plan(assembly: Assembly, answer: Mapping[str, Any]) -> bytes:
    """Encode the steps of a plan as a GLB film."""
    film, index = Film(assembly), assembly.index
    places = film.places
    for k, step in enumerate(answer["steps"]):
        start = LEAD + k * STEP
        times = start + MOVES * np.linspace(0.0, 1.0, KEYS)
        path = _sampled_path(np.array(step["path"]), NEAR * film.size)
        for part in (index[name] for name in step["parts"]):
            film.animate(part, "scale", [0.0, start], [[0.0] * 3, [1.0] * 3], "STEP")
            film.animate(part, "translation", times, places.position[part] - film.center + path)
            if step["over"] is not None:
                turning = _nut_rotations(np.array(step["direction"]), places.rotation[part])
                film.animate(
                    part, "rotation", np.linspace(start, start + MOVES, len(turning)), turning
                )
    for name, changes in _held_times(answer["steps"]).items():
        part = index[name]
        mark = film.add_mark(f"hold {name}", assembly.geometry.center[part])
        reach = MARK * float(assembly.geometry.radius[part])
        sizes = [[reach * on] * 3 for _, on in changes]
        film.animate(mark, "scale", [at for at, _ in changes], sizes, "STEP")
    return film.to_bytes("plan")


def _sampled_path(path: Array, reach: float) -> Array:
    """Points of an insertion path at equal times, slow at both ends, shape (KEYS, 3).

    `path`, shape (k, 3), ends at the seat; its first segment is cut to `reach` [length unit].
    """
    first = path[0] - path[1]
    far = float(np.linalg.norm(first))
    path = np.vstack([path[1] + first * min(1.0, reach / far), path[1:]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    t = np.linspace(0.0, 1.0, KEYS)
    at = along[-1] * t * t * (3 - 2 * t)
    return np.column_stack([np.interp(at, along, path[:, i]) for i in range(3)])


def _nut_rotations(along: Array, rest: Array) -> Array:
    """Quaternions x, y, z, w, (k, 4), of a nut that turns on a right-handed thread to its seat.

    `along`, shape (3,), is the direction of insertion; `rest` is the quaternion in the seat.
    """
    angles = np.linspace(-2 * np.pi * TURNS, 0.0, 4 * TURNS + 1)
    turns = np.column_stack([np.cos(angles / 2), np.sin(angles / 2)[:, None] * along])
    turned = quaternion_to_matrix(turns) @ quaternion_to_matrix(rest)
    return np.array([xyzw(matrix_to_quaternion(matrix)) for matrix in turned])


def _held_times(steps: list[dict[str, Any]]) -> dict[str, list[tuple[float, int]]]:
    """For each part that is ever held, the times [s] at which it is gripped (1) or released (0).

    Each list begins at the time 0.
    """
    changes: dict[str, list[tuple[float, int]]] = {}
    for k, step in enumerate([*steps, {"held": []}]):
        for name in step["held"]:
            changes.setdefault(name, [(0.0, 0)])
        for name, times in changes.items():
            if (name in step["held"]) != bool(times[-1][1]):
                times.append((LEAD + k * STEP, int(name in step["held"])))
    return changes
