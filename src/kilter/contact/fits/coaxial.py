"""Coaxial fits: a shaft of a part in a hole of another part, from their exact cylinders.

A shaft and its hole share an axis; their radii determine the fit. The shaft is thicker
(interference: a press fit, or a thread drawn as a cylinder), equally thick within the gap tolerance
(size on size), or thinner (a clearance, which holds nothing).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER
from kilter.contact.contact_tolerances import ANGLE, FIT_LENGTH, INTERFERENCE
from kilter.contact.curved.coaxial_faces import shared_region
from kilter.contact.curved.coverage import bands_of
from kilter.contact.gaps import Tolerance
from kilter.contact.left_out import PairRecord
from kilter.tell.record import InPython, Vector, key

__all__ = ["Fit", "coaxial_fits", "is_tube"]


class Fit(PairRecord, kw_only=False):
    """A shaft of the first part in a hole of the second part, about the same axis; world frame."""

    point: Vector
    """Middle of the fit [length unit]."""
    axis: Vector
    """Unit axis."""
    radius: float
    """Radius of the shaft [length unit]."""
    interference: InPython[float]
    """Radius of the shaft minus that of the hole [length unit]; negative: a clearance."""
    length: float
    """Length along the axis [length unit]."""
    doubt: InPython[float]
    """Largest interference that the gap tolerance explains [length unit]."""

    @property
    def tight(self) -> bool:
        """Whether the shaft is thicker than its hole by more than the gap tolerance."""
        return self.interference > self.doubt

    @property
    @key
    def clearance(self) -> float:
        """Radius of the hole minus that of the shaft [length unit]."""
        return -self.interference

    @property
    @key
    def fit(self) -> Literal["interference", "clearance", "size on size"]:
        """Kind of the fit."""
        if self.tight:
            return "interference"
        return "clearance" if self.interference < -self.doubt else "size on size"


@dataclass(frozen=True, slots=True, eq=False)
class _Cylinder:
    """A cylindrical face, solid or hollow, from `low` to `high` along its axis."""

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
    """Find shafts in holes among pairs of parts, if they are about equally thick.

    Parameters
    ----------
    assembly : Assembly
    pairs : iterable of pairs of int
    tolerance : Tolerance
        Tolerance of the gap, the clearance and the angle.
    thickest : float
        Largest interference, as a fraction of the radius of the shaft [-].
    thinnest : float
        Largest clearance, as a fraction of the radius of the shaft, if the clearance of the
        tolerance is smaller [-].
    """
    cylinders: dict[int, list[_Cylinder]] = {}
    result = []
    surfaces = assembly.geometry.surfaces
    rounds = set(surfaces.part[surfaces.kind == CYLINDER].tolist())
    candidates = {(int(min(pair)), int(max(pair))) for pair in pairs if rounds.issuperset(pair)}
    for a, b in sorted(candidates):
        for part in (a, b):
            if part not in cylinders:
                cylinders[part] = _cylinders_of(assembly, part)
        gap = float(tolerance.gap_of(assembly.geometry.size[[a, b]]).min())
        for shaft, hole in ((a, b), (b, a)):
            fits = [
                fit
                for solid in cylinders[shaft]
                for hollow in cylinders[hole]
                if not solid.hollow and hollow.hollow
                for fit in _fits_of(
                    (shaft, hole), solid, hollow, gap, tolerance, (thickest, thinnest)
                )
                if _over_each_other(assembly.geometry, solid, hollow)
            ]
            # a stepped shaft has several fits: keep the tightest, and of these the longest
            fits.sort(key=lambda fit: (not fit.tight, -fit.length))
            result += fits[:1]
    return result


def is_tube(assembly: Assembly, fit: Fit) -> bool:
    """Whether the shaft of a fit is hollow: it has a thinner bore about the same axis."""
    for bore in _cylinders_of(assembly, fit.ends[0]):
        apart = bore.point - fit.point
        offset = float(np.linalg.norm(apart - fit.axis * (fit.axis @ apart)))
        sine = float(np.linalg.norm(np.cross(bore.axis, fit.axis)))
        if bore.hollow and bore.radius < fit.radius and max(offset / fit.radius, sine) < ANGLE:
            return True
    return False


def _fits_of(
    parts: tuple[int, int],
    shaft: _Cylinder,
    hole: _Cylinder,
    gap: float,
    tolerance: Tolerance,
    widest: tuple[float, float],
) -> list[Fit]:
    """A list with the fit of a shaft and a hole; an empty list if they form no fit.

    `gap` is the gap tolerance [length unit]; `widest` holds the largest interference and clearance
    as fractions of the radius [-].
    """
    gap += shaft.doubt + hole.doubt
    along = float(shaft.axis @ hole.axis)
    apart = hole.point - shaft.point
    offset = float(np.linalg.norm(apart - shaft.axis * (shaft.axis @ apart)))
    interference = shaft.radius - hole.radius
    sine = float(np.linalg.norm(np.cross(shaft.axis, hole.axis)))
    thickest, thinnest = (share * shaft.radius for share in widest)
    clearance = max(tolerance.clearance or 0.0, thinnest)
    # the axes must coincide up to the play of the fit
    if sine > tolerance.angle or offset > gap + abs(interference):
        return []
    if not -gap - clearance <= interference <= thickest:
        return []
    # ends of the hole along the axis of the shaft, which may point the other way
    ends = float(shaft.axis @ apart) + along * np.array([hole.low, hole.high])
    low, high = max(shaft.low, float(ends.min())), min(shaft.high, float(ends.max()))
    if high - low <= FIT_LENGTH * shaft.radius:
        return []
    middle = shaft.point + shaft.axis * (low + high) / 2
    return [Fit(parts, middle, shaft.axis, shaft.radius, interference, high - low, gap)]


def _over_each_other(geometry: Geometry, shaft: _Cylinder, hole: _Cylinder) -> bool:
    """Whether the faces of shaft and hole cover a common range of angles about the axis."""
    bands = bands_of(geometry, np.array([shaft.row, hole.row]))
    return shared_region(geometry, bands, (shaft.row, hole.row), (0, 1)) is not None


def _cylinders_of(assembly: Assembly, part: int) -> list[_Cylinder]:
    """Cylindrical faces of a part, exact or recognised in its mesh."""
    geometry = assembly.geometry
    surfaces = geometry.surfaces
    rows = range(int(surfaces.start[part]), int(surfaces.start[part + 1]))
    return [_cylinder(geometry, row) for row in rows if surfaces.kind[row] == CYLINDER]


def _cylinder(geometry: Geometry, row: int) -> _Cylinder:
    """The cylindrical face with the given index, with its extent from the triangles."""
    surfaces = geometry.surfaces
    corners = geometry.vertices[geometry.triangles[surfaces.triangles_of(row)]].reshape(-1, 3)
    height = (corners - surfaces.point[row]) @ surfaces.axis[row]
    return _Cylinder(
        row=row,
        point=surfaces.point[row],
        axis=surfaces.axis[row],
        radius=float(surfaces.radius[row]),
        hollow=bool(surfaces.hollow[row]),
        doubt=float(surfaces.doubt[row]),
        low=float(height.min()),
        high=float(height.max()),
    )
