"""Gap tolerances: the limits of each pair, the test for contact, and warnings about gaps.

Two opposed faces of a pair touch if the range [low, high] of the gap between them, over the area in
which they overlap, meets

    [-gap, closed],   gap    = the gap tolerance of the pair,
                      closed = the same, or the designed clearance if that is larger.

Penetration counts as negative gap. The gap tolerance of a pair is `relative_gap` times the size of
the smaller part, or the given gap. It is at most a tenth of the thickness of the thinner part, and
at least the rounding error of the coordinates.

A gap tolerance inside a cluster of gaps separates faces that belong together: then there are
patches in its upper third, and near pairs within three times the tolerance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import (
    ANGLE,
    CLUSTER,
    GAP,
    LOOKED_AT_GAPS,
    LOOKED_AT_SIZE,
    LOOSE_ANGLE,
    LOOSE_GAP,
    ROUNDINGS,
    THICKNESS,
)
from kilter.contact.left_out import PairRecord
from kilter.contact.patches import Patches
from kilter.contact.planar.facets import Facets
from kilter.errors import InputError, some
from kilter.tell.record import InPython, key
from kilter.values.guesses import guarded

__all__ = [
    "APART",
    "PENETRATES",
    "THIN",
    "TILTED",
    "UNKNOWN",
    "GapLimits",
    "RejectedPair",
    "Tolerance",
    "closed_by_clearance",
    "gap_limits",
    "gap_warnings",
    "nearest_gap",
    "reach_of",
    "touches",
]


@guarded
@dataclass(frozen=True, slots=True)
class Tolerance:
    """Largest gap and angle at which two faces count as touching.

    Parameters
    ----------
    gap : float or None
        Largest gap [length unit]; None: `relative_gap` times the size of the smaller part.
    relative_gap : float
        Largest gap as a fraction of the size of the smaller part [-].
    angle : float
        Largest angle between the faces [rad].
    clearance : float or None
        Designed clearance [length unit]. Opposed faces up to this distance apart also count as
        touching, and a shaft in its hole as size on size. Faces that penetrate do not.

    Examples
    --------
    >>> Tolerance.loose().angle
    0.02
    """

    gap: float | None = None
    relative_gap: float = GAP
    angle: float = ANGLE
    clearance: float | None = None

    @classmethod
    def loose(cls) -> Tolerance:
        """The contact tolerance for scanned, rounded or hand-made data.

        It allows gaps up to 1e-3 of the part's size and tilts up to 2e-2 rad.
        """
        return cls(relative_gap=LOOSE_GAP, angle=LOOSE_ANGLE)

    def require_sound(self) -> None:
        """Raise an InputError if the gap, angle or clearance is invalid.

        Raises
        ------
        InputError
            If a value is not positive and finite.
        """
        named = ("gap", self.gap), ("angle", self.angle), ("clearance", self.clearance)
        for name, value in named:
            if value is not None and not (np.isfinite(value) and value > 0):
                quantity = name if name == "clearance" else f"{name} tolerance"
                raise InputError(f"the {quantity} is {value}", hint="give a number above zero")

    def gap_of(self, size: Array) -> Array:
        """Largest gap that counts as contact, for parts of the given sizes [length unit]."""
        if self.gap is not None:
            return np.full(len(size), self.gap)
        return self.relative_gap * size


class RejectedPair(PairRecord, kw_only=False):
    """Two near faces that do not count as touching."""

    gap: float
    """Nearest gap [length unit]."""
    angle: InPython[float]
    """Tilt of the faces [rad]."""
    why: str
    """Reason, in words."""
    fit: InPython[bool] = False
    """True for a solid round face inside a hollow face."""

    @property
    @key
    def angle_deg(self) -> float:
        """Tilt of the faces [deg]."""
        return math.degrees(self.angle)


APART = "gap above the tolerance"
PENETRATES = "penetrates by more than the gap tolerance"
TILTED = "tilted by more than the angle tolerance"
THIN = "thinner than twice the gap tolerance"
UNKNOWN = "the surface of a part is unknown there"


@dataclass(frozen=True, slots=True, eq=False)
class GapLimits(Rows):
    """For each pair of parts, the gaps at which faces touch or count as near [length unit].

    Attributes
    ----------
    gap : ndarray, shape (n,)
        Gap tolerance: the deepest penetration that counts as contact.
    closed : ndarray, shape (n,)
        Widest gap that counts as contact: the tolerance, or the designed clearance.
    margin : ndarray, shape (n,)
        Widest gap at which faces are compared at all.
    rounding : ndarray, shape (n,)
        Largest gap that the accuracy of the coordinates explains.
    coarse : ndarray of bool, shape (n,)
        True if the rounding is not small compared with the thickness of a part.
    """

    gap: Array
    closed: Array
    margin: Array
    rounding: Array
    coarse: Mask


def reach_of(geometry: Geometry, tolerance: Tolerance) -> Array:
    """Distance from each part within which contacts are searched for [length unit], shape (N,)."""
    rough = tolerance.gap_of(geometry.size)
    if tolerance.gap is None:
        rough = np.maximum(rough, ROUNDINGS * geometry.accuracy)
    return np.maximum(_compared(rough, geometry.size) / 2, CLUSTER * (tolerance.clearance or 0.0))


def _compared(gap: Array, size: Array) -> Array:
    """Widest gap at which faces are compared, for a gap tolerance and the sizes of parts.

    A tolerance as wide as the play of a part only adds the gaps of its cluster: a hundred times
    such a tolerance would compare all faces of both parts.
    """
    return np.maximum(np.minimum(LOOKED_AT_GAPS * gap, LOOKED_AT_SIZE * size), CLUSTER * gap)


def gap_limits(geometry: Geometry, facets: Facets, pairs: Index, tolerance: Tolerance) -> GapLimits:
    """Gap limits for pairs of parts, shape (n, 2), from their sizes and the tolerance."""
    a, b = pairs.T
    surface = np.bincount(facets.part, weights=facets.area, minlength=len(geometry.mass))
    thickness = 2 * geometry.volume / surface
    thin = THICKNESS * np.minimum(thickness[a], thickness[b])
    rounding = 2 * (geometry.accuracy[a] + geometry.accuracy[b])
    smaller = np.minimum(geometry.size[a], geometry.size[b])
    wanted = tolerance.gap_of(smaller)
    gap = wanted
    if tolerance.gap is None:
        # not through thin plates, but never below the rounding of the coordinates
        gap = np.maximum(np.minimum(wanted, thin), rounding)
    clearance = tolerance.clearance or 0.0
    return GapLimits(
        gap=gap,
        closed=np.maximum(gap, clearance + rounding) if clearance else gap,
        margin=np.maximum(_compared(wanted, smaller), np.maximum(gap, CLUSTER * clearance)),
        rounding=rounding,
        coarse=rounding > thin,
    )


def touches(gap: Array, deepest: Array, widest: Array) -> Mask:
    """Mask of gap ranges, shape (n, 2), that overlap [-deepest, widest].

    Examples
    --------
    >>> touches(np.array([[0.0, 3.0], [2.0, 3.0], [-3.0, -2.0]]), np.ones(3), np.ones(3))
    array([ True, False, False])
    """
    low, high = gap.T
    result: Mask = (low <= widest) & (high >= -deepest)
    return result


def nearest_gap(gap: Array) -> Array:
    """The gap nearest to zero in each range of gaps, shape (n, 2); 0 if the range includes 0."""
    low, high = gap.T
    closest: Array = np.where(low > 0, low, np.minimum(high, 0.0))
    return closest


# warnings -----------------------------------------------------------------------------------


def gap_warnings(patches: Patches, rejected: list[RejectedPair], limits: GapLimits) -> list[str]:
    """Warnings about a doubtful gap tolerance: too close to actual gaps, or below the rounding."""
    return [*_cluster_warnings(patches, rejected, limits), *_coarse_warnings(limits)]


def _cluster_warnings(
    patches: Patches, rejected: list[RejectedPair], limits: GapLimits
) -> list[str]:
    """A warning if some gaps are just below the gap tolerance and others just above it."""
    gap, closed = limits.gap, limits.closed
    # gaps of patches near the limit are possibly cut off from a cluster beyond it
    near = nearest_gap(patches.gap)
    # a gap is compared with the clearance, a penetration with the tolerance
    limit = np.where(near >= 0, closed[patches.pair], gap[patches.pair])
    below = int((np.abs(near) > limit / CLUSTER).sum())
    # a rejected piece is compared with the limit that it exceeded
    open_edge = CLUSTER * float(closed.max(initial=0.0))
    deep_edge = CLUSTER * float(gap.max(initial=0.0))
    above = sum(r.gap < open_edge for r in rejected if r.why == APART)
    above += sum(-r.gap < deep_edge for r in rejected if r.why == PENETRATES)
    if not (below and above):
        return []
    option = "clearance" if (closed > gap).any() else "gap"
    return [
        f"the gap tolerance falls inside a cluster of gaps: {below} patches just below it, "
        f"{above} near pairs just above; see the histogram and set the {option}"
    ]


def _coarse_warnings(limits: GapLimits) -> list[str]:
    """A warning if coordinates are rounded too coarsely for the thickness of a part."""
    if not limits.coarse.any():
        return []
    return [
        "coordinates are too coarse for the thinnest parts: "
        f"{int(limits.coarse.sum())} pairs have rounding above a tenth of a part's thickness"
    ]


def closed_by_clearance(assembly: Assembly, patches: Patches, limits: GapLimits) -> list[str]:
    """A warning that names the pairs that touch only because the option closed a clearance."""
    apart = nearest_gap(patches.gap)
    gap, closed = limits.gap[patches.pair], limits.closed[patches.pair]
    rows = np.flatnonzero((apart > gap) & (closed > gap))
    if not len(rows):
        return []
    widest: dict[tuple[int, int], float] = {}
    for row in rows[np.argsort(-apart[rows], kind="stable")]:
        a, b = patches.parts[row]
        widest.setdefault((int(a), int(b)), float(apart[row]))
    names, unit = assembly.names, assembly.units
    pairs = [f"{names[a]!r} and {names[b]!r} ({g:.3g} {unit})" for (a, b), g in widest.items()]
    return [
        f"clearances counted as closed in {len(rows)} patches, {len(pairs)} separated pairs: "
        f"{some(pairs)}; the answer holds for parts that are moved together there"
    ]
