"""The first motion of an assembly as an animated GLB: what moves, as far as it is free."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import Array
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix, screwed
from kilter.show.glb_film import Film, xyzw

if TYPE_CHECKING:
    from kilter.assembly import Assembly

__all__ = ["film_of_motion"]

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
    center, places = assembly.geometry.center, film.places
    for part in np.flatnonzero(travel.any(axis=1)).tolist():
        arm = places.position[part] - center[part]
        rest = quaternion_to_matrix(places.rotation[part])
        turns, shifts = screwed(travel[part], amounts)
        film.animate(part, "translation", times, center[part] - film.center + turns @ arm + shifts)
        turned = [xyzw(matrix_to_quaternion(turn @ rest)) for turn in turns]
        film.animate(part, "rotation", times, _continuous(np.array(turned)))
    return film.to_bytes("motion")


def _continuous(quaternions: Array) -> Array:
    """The same turns, each with the sign that is nearer to the one before, shape (k, 4)."""
    agree = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1])
    signs = np.cumprod(np.append(1.0, np.where(agree < 0, -1.0, 1.0)))
    return quaternions * signs[:, None]
