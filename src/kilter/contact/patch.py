"""Patch: a contact patch of a contact set, as a value with names."""

from __future__ import annotations

from dataclasses import dataclass

from kilter.arrays import Array

__all__ = ["Patch"]


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """An area, edge or point at which two parts touch; world frame, arrays read-only.

    Attributes
    ----------
    parts : pair of str
        Names of the parts a and b.
    kind : str
        Kind of the contact, as in `ContactSet.patch_kind`.
    area : float
        Area of contact [length unit^2].
    gap : tuple of float
        Least and greatest gap [length unit]; negative = penetration.
    normal : ndarray, shape (3,)
        Unit normal from a to b.
    mu : float
        Friction coefficient [-].
    points, normals : ndarray, shape (k, 3)
        Contact points [length unit], and the unit normal from a to b at each.
    pieces : pair of int or None
        Pieces of parts a and b that touch (`Mesh.pieces`); None if they are unknown.
    """

    parts: tuple[str, str]
    kind: str
    area: float
    gap: tuple[float, float]
    normal: Array
    mu: float
    points: Array
    normals: Array
    pieces: tuple[int, int] | None = None

    def __repr__(self) -> str:
        a, b = self.parts
        return f"<Patch: {self.kind}, {a!r} to {b!r}, area {self.area:.6g}>"
