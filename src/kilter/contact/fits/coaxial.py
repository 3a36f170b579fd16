"""Coaxial fits: a shaft of one part in a hole of another, from their exact cylinders.

A shaft and its hole share an axis; their radii say what the fit is: the shaft is thicker
(interference: a press fit, or a thread drawn as a cylinder), as thick within the gap
tolerance (size on size), or thinner (a clearance, which holds nothing).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER
from kilter.contact.contact_tolerances import ANGLE, FIT_LENGTH, INTERFERENCE
from kilter.contact.curved.coaxial_faces import shared_region
from kilter.contact.curved.coverage import bands_of
from kilter.contact.gaps import Tolerance

__all__ = ["Fit", "coaxial_fits", "is_tube"]


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A shaft in a hole; world frame.

    Attributes
    ----------
    parts : pair of int
        The part with the shaft, the part with the hole.
    point, axis : ndarray, shape (3,)
        The middle of the fit, and its unit axis.
    radius : float
        Of the shaft [length unit].
    interference : float
        Radius of the shaft over that of the hole [length unit]; negative: a clearance.
    length : float
        Along the axis [length unit].
    doubt : float
        What the gap tolerance explains of it [length unit].
    """

    parts: tuple[int, int]
    point: Array
    axis: Array
    radius: float
    interference: float
    length: float
    doubt: float

    @property
    def tight(self) -> bool:
        """The shaft is thicker than the gap tolerance explains."""
        return self.interference > self.doubt

    def to_dict(self, names: Sequence[str]) -> dict[str, Any]:
        """As JSON data; `parts` are the shaft and the part with the hole."""
        return {
            "parts": [names[k] for k in self.parts],
            "point": self.point.tolist(),
            "axis": self.axis.tolist(),
            "radius": self.radius,
            "clearance": -self.interference,
            "length": self.length,
            "fit": self.kind,
        }

    @property
    def kind(self) -> str:
        """What it is: "interference", "size on size" or "clearance"."""
        if self.tight:
            return "interference"
        return "clearance" if self.interference < -self.doubt else "size on size"


@dataclass(frozen=True, slots=True, eq=False)
class _Bore:
    """One cylinder, a row of the surfaces: solid or hollow, `low` to `high` along its axis."""

    row: int
    point: Array
    axis: Array
    radius: float
    hollow: bool
    doubt: float
    low: float
    high: float


def coaxial_fits(
    assembly: Assembly,
    pairs: Iterable[tuple[int, int]],
    tolerance: Tolerance,
    *,
    thickest: float = INTERFERENCE,
    thinnest: float = 0.0,
) -> list[Fit]:
    """Fits between pairs of parts: interfering, or size on size within the tolerance.

    Parameters
    ----------
    assembly : Assembly
    pairs : iterable of pairs of int
    tolerance : Tolerance
        Of the gap, the clearance and the angle.
    thickest : float
        The greatest interference, as a fraction of the radius of the shaft [-].
    thinnest : float
        The greatest clearance, where that of the tolerance is less, as such a fraction [-].
    """
    bores: dict[int, list[_Bore]] = {}
    found = []
    known = assembly.geometry.surfaces
    rounds = set(known.part[known.kind == CYLINDER].tolist())
    both = {(int(min(pair)), int(max(pair))) for pair in pairs if rounds.issuperset(pair)}
    for a, b in sorted(both):
        for part in (a, b):
            if part not in bores:
                bores[part] = _bores(assembly, part)
        gap = float(tolerance.gap_of(assembly.geometry.size[[a, b]]).min())
        for shaft, hole in ((a, b), (b, a)):
            fits = [
                fit
                for one in bores[shaft]
                for other in bores[hole]
                if not one.hollow and other.hollow
                for fit in _fit((shaft, hole), one, other, gap, tolerance, (thickest, thinnest))
                if _over_each_other(assembly.geometry, one, other)
            ]
            # of several steps of one shaft, the tightest, and of those the longest
            fits.sort(key=lambda fit: (not fit.tight, -fit.length))
            found += fits[:1]
    return found


def is_tube(assembly: Assembly, fit: Fit) -> bool:
    """Whether the shaft of a fit has a thinner bore on the same axis itself."""
    for bore in _bores(assembly, fit.parts[0]):
        apart = bore.point - fit.point
        offset = float(np.linalg.norm(apart - fit.axis * (fit.axis @ apart)))
        sine = float(np.linalg.norm(np.cross(bore.axis, fit.axis)))
        if bore.hollow and bore.radius < fit.radius and max(offset / fit.radius, sine) < ANGLE:
            return True
    return False


def _fit(
    parts: tuple[int, int],
    shaft: _Bore,
    hole: _Bore,
    gap: float,
    tolerance: Tolerance,
    widest: tuple[float, float],
) -> list[Fit]:
    gap += shaft.doubt + hole.doubt
    along = float(shaft.axis @ hole.axis)
    apart = hole.point - shaft.point
    offset = float(np.linalg.norm(apart - shaft.axis * (shaft.axis @ apart)))
    interference = shaft.radius - hole.radius
    sine = float(np.linalg.norm(np.cross(shaft.axis, hole.axis)))
    thickest, thinnest = (part * shaft.radius for part in widest)
    clearance = max(tolerance.clearance or 0.0, thinnest)
    if sine > tolerance.angle or offset > gap + abs(interference):
        return []
    if not -gap - clearance <= interference <= thickest:
        return []
    ends = float(shaft.axis @ apart) + along * np.array([hole.low, hole.high])
    low, high = max(shaft.low, float(ends.min())), min(shaft.high, float(ends.max()))
    if high - low <= FIT_LENGTH * shaft.radius:
        return []
    middle = shaft.point + shaft.axis * (low + high) / 2
    return [Fit(parts, middle, shaft.axis, shaft.radius, interference, high - low, gap)]


def _over_each_other(geometry: Geometry, one: _Bore, other: _Bore) -> bool:
    """Whether the faces reach over each other around the axis, and not only along it."""
    bands = bands_of(geometry, np.array([one.row, other.row]))
    return shared_region(geometry, bands, (one.row, other.row), (0, 1)) is not None


def _bores(assembly: Assembly, part: int) -> list[_Bore]:
    """The cylinders of a part, exact ones and those recognised in its mesh."""
    geometry = assembly.geometry
    known = geometry.surfaces
    rows = range(int(known.start[part]), int(known.start[part + 1]))
    return [_bore(geometry, row) for row in rows if known.kind[row] == CYLINDER]


def _bore(geometry: Geometry, row: int) -> _Bore:
    known = geometry.surfaces
    corners = geometry.vertices[geometry.triangles[known.triangles_of(row)]].reshape(-1, 3)
    height = (corners - known.point[row]) @ known.axis[row]
    return _Bore(
        row=row,
        point=known.point[row],
        axis=known.axis[row],
        radius=float(known.radius[row]),
        hollow=bool(known.hollow[row]),
        doubt=float(known.doubt[row]),
        low=float(height.min()),
        high=float(height.max()),
    )
