"""The impending motion of an assembly, or its fall, as an animated GLB."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import Array
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix, screwed
from kilter.show.glb_film import Film, xyzw

if TYPE_CHECKING:
    from kilter.assembly import Assembly

__all__ = ["film_of_fall", "film_of_motion"]

MOVES, RESTS = 2.0, 1.0
"""Duration of the motion, and of the pause before it is shown again [s]."""
KEYS = 25
"""Number of key frames of a track along the motion."""


def film_of_motion(assembly: Assembly, travel: Array) -> bytes:
    """Encode the start of a motion as a GLB film: the parts accelerate, then pause.

    Arguments: `travel` (N, 6): finite screw motion of each part (`kilter.rigid.screwed`): shift
    [length unit] and rotation vector [rad].
    """
    film, share = Film(assembly), np.linspace(0.0, 1.0, KEYS)
    times, amounts = np.append(MOVES * share, MOVES + RESTS), np.append(share**2, 1.0)
    for part in np.flatnonzero(travel.any(axis=1)).tolist():
        _move(film, assembly, part, times, *screwed(travel[part], amounts))
    return film.to_bytes("motion")


def film_of_fall(assembly: Assembly, motions: Array, lengths: Array) -> bytes:
    """Encode the fall of parts along a path as a GLB film: the parts accelerate, then pause.

    Arguments: `motions` (k, N, 6): shifts of the centres of mass [length unit] and rotation vectors
    [rad]; the first row is the rest position; `lengths` (k,): length of the path up to each row
    [length unit].
    """
    from scipy.spatial.transform import Rotation

    film, share = Film(assembly), np.sqrt(lengths / lengths[-1])
    times, path = np.append(MOVES * share, MOVES + RESTS), np.append(motions, motions[-1:], axis=0)
    for part in np.flatnonzero(motions.any(axis=(0, 2))).tolist():
        turns = Rotation.from_rotvec(path[:, part, 3:]).as_matrix()
        _move(film, assembly, part, times, turns, path[:, part, :3])
    return film.to_bytes("fall")


def _move(
    film: Film, assembly: Assembly, part: int, times: Array, turns: Array, shifts: Array
) -> None:
    """Add tracks of rotation and position to the node of a part.

    `turns`, shape (k, 3, 3), rotate about the centre of mass; `shifts`, shape (k, 3), move it.
    """
    center, places = assembly.geometry.center[part], film.places
    arm, rest = places.position[part] - center, quaternion_to_matrix(places.rotation[part])
    film.animate(part, "translation", times, center - film.center + turns @ arm + shifts)
    quaternions = [xyzw(matrix_to_quaternion(turn @ rest)) for turn in turns]
    film.animate(part, "rotation", times, _continuous(np.array(quaternions)))


def _continuous(quaternions: Array) -> Array:
    """Choose the signs of quaternions, (k, 4), so that interpolation takes the shorter rotation."""
    agree = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1])
    signs = np.cumprod(np.append(1.0, np.where(agree < 0, -1.0, 1.0)))
    return quaternions * signs[:, None]
