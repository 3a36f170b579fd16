"""Patch: a contact patch of a contact set, as a value with names."""

from __future__ import annotations

from kilter.arrays import Array
from kilter.tell.record import InPython, Lines, Record, Vector, key

__all__ = ["Patch"]


class Patch(Record):
    """An area, edge or point at which two parts touch; world frame, arrays read-only."""

    parts: tuple[str, str]
    """Names of the parts a and b."""
    kind: str
    """Kind of the contact, as in `ContactSet.patch_kind`."""
    area: float
    """Area of contact [length unit^2]."""
    gap_range: tuple[float, float]
    """Least and greatest gap [length unit]; negative = penetration."""
    normal: Vector
    """Unit normal from the first part to the second."""
    mu: float
    """Friction coefficient [-]."""
    pieces: tuple[int, int] | None = None
    """Pieces of the parts that touch (`Mesh.pieces`); null if they are unknown."""
    pull: float | None = None
    """Largest tension of a bond [N]; null without a bond."""
    points: Lines
    """Contact points [length unit]."""
    normals: InPython[Array]
    """Unit normal from a to b at each point, shape (k, 3)."""

    @property
    @key
    def gap(self) -> float:
        """Largest gap [length unit]; negative if the parts overlap."""
        return max(self.gap_range, key=abs)

    def __repr__(self) -> str:
        a, b = self.parts
        return f"<Patch: {self.kind}, {a!r} to {b!r}, area {self.area:.6g}>"
