"""Groups of parts that are equal up to a shift and a turn about the vertical."""

from __future__ import annotations

from collections.abc import Hashable, Iterable

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.rigid import quaternion_to_matrix

COPY_DIGITS = 8
"""Digits to which the places of the parts of equal groups agree, over the size of the parts."""


def equal_groups(assembly: Assembly, groups: Iterable[Index]) -> dict[int, tuple[int, Array]]:
    """For each group that is equal to an earlier one: its number, and the turn (3, 3) from there.

    Equal groups have the same shapes in the same order, in the same places up to a shift and a turn
    about the vertical. Their contacts, loads and masses may differ.

    Arguments: `groups`: parts of each group, ascending.
    """
    parts, down = assembly.parts, assembly.down
    turns = quaternion_to_matrix(np.array([part.pose.rotation for part in parts]))
    places = np.array([part.pose.position for part in parts])
    first: dict[Hashable, tuple[int, int]] = {}
    found = {}
    for number, own in enumerate(groups):
        back, size = turns[own[0]].T, float(assembly.geometry.size[own].max())
        arms = (places[own] - places[own[0]]) @ back.T / size
        data = np.concatenate([arms.ravel(), (back @ turns[own]).ravel(), back @ down])
        shapes = tuple(id(parts[k].shape) for k in own.tolist())
        key = shapes, (data.round(COPY_DIGITS) + 0.0).tobytes()
        source, leader = first.setdefault(key, (number, int(own[0])))
        if source != number:
            found[number] = source, turns[own[0]] @ turns[leader].T
    return found
