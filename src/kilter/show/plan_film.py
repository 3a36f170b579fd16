"""A plan as an animated GLB: each part comes in along its way.

A part that is not there yet has the size zero, since core glTF hides nothing; while a part is
held, a small octahedron marks it. At rest all is put together, so that a viewer that plays
nothing shows the whole.
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
"""Before the first step, of a step, of its motion [s]."""
KEYS = 13
"""Places along a way, one after the other in time."""
NEAR = 1.2
"""How far away a part begins at most [size of the assembly]."""
TURNS = 3
"""Of a nut on its thread, for the picture alone."""
MARK = 0.28
"""Size of what marks a held part [bounding radius of the part]."""


def film_of_plan(assembly: Assembly, answer: Mapping[str, Any]) -> bytes:
    """The steps of a plan that was found, as the bytes of a GLB file.

    Parameters
    ----------
    assembly : Assembly
    answer : mapping
        Data of the plan.
    """
    film, index = Film(assembly), assembly.index
    places = film.places
    for k, step in enumerate(answer["steps"]):
        start = LEAD + k * STEP
        times = start + MOVES * np.linspace(0.0, 1.0, KEYS)
        path = _way(np.array(step["path"]), NEAR * film.size)
        for part in (index[name] for name in step["parts"]):
            film.animate(part, "scale", [0.0, start], [[0.0] * 3, [1.0] * 3], "STEP")
            film.animate(part, "translation", times, places.position[part] - film.center + path)
            if step["over"] is not None:
                turning = _turning(np.array(step["direction"]), places.rotation[part])
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


def _way(path: Array, reach: float) -> Array:
    """Places along a way at even times, gently at both ends, shape (KEYS, 3)."""
    first = path[0] - path[1]
    far = float(np.linalg.norm(first))
    path = np.vstack([path[1] + first * min(1.0, reach / far), path[1:]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    t = np.linspace(0.0, 1.0, KEYS)
    at = along[-1] * t * t * (3 - 2 * t)
    return np.column_stack([np.interp(at, along, path[:, i]) for i in range(3)])


def _turning(along: Array, rest: Array) -> Array:
    """Quaternions x, y, z, w of a nut that advances along a right-handed thread to its seat."""
    angles = np.linspace(-2 * np.pi * TURNS, 0.0, 4 * TURNS + 1)
    turns = np.column_stack([np.cos(angles / 2), np.sin(angles / 2)[:, None] * along])
    turned = quaternion_to_matrix(turns) @ quaternion_to_matrix(rest)
    return np.array([xyzw(matrix_to_quaternion(one)) for one in turned])


def _held_times(steps: list[dict[str, Any]]) -> dict[str, list[tuple[float, int]]]:
    """Of each part that is held, when it is and when no more, from the time 0 on."""
    found: dict[str, list[tuple[float, int]]] = {}
    for k, step in enumerate([*steps, {"held": []}]):
        for name in step["held"]:
            found.setdefault(name, [(0.0, 0)])
        for name, times in found.items():
            if (name in step["held"]) != bool(times[-1][1]):
                times.append((LEAD + k * STEP, int(name in step["held"])))
    return found
