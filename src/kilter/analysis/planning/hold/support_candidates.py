"""Candidate supports by keyword: grips of every part, props under parts, fingers on faces.

grips     each free part may be gripped
props     a prop under the centre of mass of each free part, from the part below it or else
from the ground, where there is room for one
fingers   a finger at the centre of each flat face of a free part, with the friction of the
assembly, where nothing is as near as `ROOM` of the part's size
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from kilter.arrays import TINY, Array, cross, unit_rows
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.supports import Support
from kilter.errors import InputError

__all__ = ["WORDS", "candidates_of"]

ROOM = 0.1
"""Room that a finger needs before a face, over the size of its part."""
LEAST_FACE = 0.05
"""Smallest face that gets a finger, as a fraction of the surface area of its part [-]."""
SAME_FACE = 6
"""Decimal digits to which triangles of the same face share normal and height."""


def candidates_of(
    assembly: Assembly, contacts: ContactSet, asked: Iterable[str | Support]
) -> list[Support]:
    """Candidate supports, from keywords such as "grips" and given supports, in the given order.

    Raises `InputError` if no candidate is given, a word is unknown, or a support does not fit the
    assembly.
    """
    candidates: list[Support] = []
    words = list(asked)
    if not words:
        raise InputError("there are no candidates for supports", hint=f"give {', '.join(WORDS)}")
    for word in words:
        if isinstance(word, Support):
            word.require_of(assembly)
            candidates.append(word)
        elif word in WORDS:
            candidates += WORDS[word](assembly, contacts)
        else:
            raise InputError(f"a candidate is {word!r:.60}", hint=f"give {', '.join(WORDS)}")
    return candidates


def _grips(assembly: Assembly, contacts: ContactSet) -> Iterator[Support]:
    for part in assembly:
        if not part.grounded:
            yield Support("grip", part.name)


def _props(assembly: Assembly, contacts: ContactSet) -> Iterator[Support]:
    """Yield candidate props under the centre of mass of each free part."""
    geometry, down = assembly.geometry, assembly.down
    for k, part in enumerate(assembly):
        if part.grounded:
            continue
        along, owner = _hits(assembly, geometry.center[k], down)
        heights = along[owner == k]
        if not len(heights):
            continue  # its centre of mass is not above any of it
        foot, below = heights.max(), (owner != k) & (along > 0)
        gap = float(contacts.searched.gap_of(geometry.size[[k]])[0])
        below &= along > foot - gap
        if not below.any():
            on = None
        else:
            nearest = np.flatnonzero(below)[along[below].argmin()]
            if along[nearest] <= foot + gap:
                continue  # no room
            under = assembly[int(owner[nearest])]
            on = None if under.grounded else under.name
        yield Support("prop", part.name, geometry.center[k] + foot * down, on=on)


def _fingers(assembly: Assembly, contacts: ContactSet) -> Iterator[Support]:
    """Yield candidate fingers on the accessible faces of each free part."""
    geometry = assembly.geometry
    for k, part in enumerate(assembly):
        if part.grounded:
            continue
        for number, (point, outward) in enumerate(_faces(geometry.corners_of(k)), 1):
            if assembly.planar and abs(outward[1]) > 0:
                continue
            along, owner = _hits(assembly, point, outward)
            away = float(ROOM * geometry.size[k])
            gap = float(contacts.searched.gap_of(geometry.size[[k]])[0])
            if ((owner != k) & (along > -gap) & (along < away)).any():
                continue
            name = f"finger {number} on {part.name}"
            yield Support("finger", part.name, point, -outward, mu=assembly.friction, name=name)


WORDS = {"grips": _grips, "props": _props, "fingers": _fingers}


def _faces(corners: Array) -> Iterator[tuple[Array, Array]]:
    """Yield centroid and outward normal of each larger flat face of triangles, shape (m, 3, 3)."""
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area, normal = np.linalg.norm(normal, axis=1) / 2, unit_rows(normal)
    middle = corners.mean(axis=1)
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    height = np.einsum("ij,ij->i", middle, normal) / max(size, TINY)
    keys = np.column_stack([normal, height]).round(SAME_FACE) + 0.0
    _, first, face = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    total = np.bincount(face.reshape(-1), area)
    center = np.stack(
        [np.bincount(face.reshape(-1), area * middle[:, axis]) for axis in range(3)], axis=1
    )
    for label in np.flatnonzero(total > LEAST_FACE * area.sum()):
        yield center[label] / total[label], normal[first[label]]


def _hits(assembly: Assembly, point: Array, direction: Array) -> tuple[Array, Array]:
    """Distances along a line at which it enters or leaves parts, and the index of each part."""
    g = assembly.geometry
    count = len(assembly)
    corners = [g.corners_of(k) for k in range(count)]
    owner = np.repeat(np.arange(count), [len(ring) for ring in corners])
    a, b, c = np.concatenate(corners).transpose(1, 0, 2)
    side = cross(np.broadcast_to(direction, c.shape), c - a)
    det = np.einsum("ij,ij->i", b - a, side)
    flat = np.abs(det) <= TINY
    scale = 1 / np.where(flat, 1.0, det)
    off = point - a
    u = np.einsum("ij,ij->i", off, side) * scale
    q = cross(off, b - a)
    v = (q @ direction) * scale
    along = np.einsum("ij,ij->i", c - a, q) * scale
    hit = ~flat & (u >= 0) & (v >= 0) & (u + v <= 1)
    return along[hit], owner[hit]
