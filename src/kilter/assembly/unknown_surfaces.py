"""Regions where the surface of a part is unknown: mesh holes, and replaced unreadable solids.

Contacts in these regions are undecided; `kilter.contact` reports them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, read_only
from kilter.assembly.mesh_surface import MeshSurface
from kilter.assembly.part import Part
from kilter.shape.solid import Solid

__all__ = ["UnknownSurfaces", "unknown_surfaces"]


@dataclass(frozen=True, slots=True, eq=False)
class UnknownSurfaces(Rows):
    """Boxes around regions of parts whose true surface is unknown; world frame."""

    part: Index
    """Shape (n,)."""
    low: Array = columns(3)
    high: Array = columns(3)
    """Lower and upper corner of the box [length unit], shape (n, 3)."""
    whole: Mask = columns()
    """Whether the whole surface of the part is unknown, because its shape is a stand-in, shape
    (n,)."""

    def __post_init__(self) -> None:
        read_only(self)

    def stand_ins(self, count: int) -> Mask:
        """Mask of the parts whose shape is a mere replacement of an unreadable solid, (count,)."""
        stands_in = np.zeros(count, dtype=bool)
        stands_in[self.part[self.whole]] = True
        return stands_in


def unknown_surfaces(
    parts: Sequence[Part], meshes: dict[int, MeshSurface], poses: tuple[Array, Array]
) -> UnknownSurfaces:
    """Regions of parts whose true surface is unknown: holes, and replaced unreadable solids.

    Arguments: `poses`: rotation matrices, shape (N, 3, 3), and positions, shape (N, 3) [length
    unit].
    """
    places: list[tuple[int, Array, bool]] = []
    for k, part in enumerate(parts):
        shape = part.shape
        if k in meshes and meshes[k].stand_in:
            box = np.array([meshes[k].vertices.min(axis=0), meshes[k].vertices.max(axis=0)])
            places.append((k, box, True))
        elif k in meshes:
            places += [(k, np.array(box), False) for box in meshes[k].holes]
        elif isinstance(shape, Solid) and shape.stand_in:
            box = np.array([shape.vertices.min(axis=0), shape.vertices.max(axis=0)])
            places.append((k, box, True))
        elif isinstance(shape, Solid):
            places += [(k, box, False) for box in shape.holes]
    if not places:
        return UnknownSurfaces.none()
    owner = np.array([k for k, _, _ in places])
    rotation, position = (pose[owner] for pose in poses)
    box = np.array([box for _, box, _ in places])
    middle, half = box.mean(axis=1), np.ptp(box, axis=1) / 2
    center = np.einsum("nij,nj->ni", rotation, middle) + position
    reach = np.einsum("nij,nj->ni", np.abs(rotation), half)
    whole = np.array([whole for _, _, whole in places])
    return UnknownSurfaces(owner, center - reach, center + reach, whole)
