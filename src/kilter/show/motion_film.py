"""The first motion of an assembly, as far as it is free, or its fall, as an animated GLB."""

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
"""Of the motion, and of its end before it begins again [s]."""
KEYS = 25
"""Places along it."""


def film_of_motion(assembly: Assembly, travel: Array) -> bytes:
    """Parts that start to move, as the bytes of a GLB file: ever faster, then at rest for a while.

    Parameters
    ----------
    assembly : Assembly
    travel : ndarray, shape (N, 6)
        Screws of the parts (`kilter.rigid.screwed`): shifts [length unit] and turns [rad].
    """
    film, share = Film(assembly), np.linspace(0.0, 1.0, KEYS)
    times, amounts = np.append(MOVES * share, MOVES + RESTS), np.append(share**2, 1.0)
    for part in np.flatnonzero(travel.any(axis=1)).tolist():
        _move(film, assembly, part, times, *screwed(travel[part], amounts))
    return film.to_bytes("motion")


def film_of_fall(assembly: Assembly, motions: Array, lengths: Array) -> bytes:
    """Parts that fall from place to place, in the same way, as the bytes of a GLB file.

    Parameters
    ----------
    assembly : Assembly
    motions : ndarray, shape (k, N, 6)
        Shifts of the centres of mass [length unit] and rotation vectors [rad], at rest first.
    lengths : ndarray, shape (k,)
        How far along each place is [length unit].
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
    """Tracks of a part that turns about its centre of mass, and shifts."""
    center, places = assembly.geometry.center[part], film.places
    arm, rest = places.position[part] - center, quaternion_to_matrix(places.rotation[part])
    film.animate(part, "translation", times, center - film.center + turns @ arm + shifts)
    turned = [xyzw(matrix_to_quaternion(turn @ rest)) for turn in turns]
    film.animate(part, "rotation", times, _continuous(np.array(turned)))


def _continuous(quaternions: Array) -> Array:
    """The same turns, each with the sign that is nearer to the one before, shape (k, 4)."""
    agree = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1])
    signs = np.cumprod(np.append(1.0, np.where(agree < 0, -1.0, 1.0)))
    return quaternions * signs[:, None]
