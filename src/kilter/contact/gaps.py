"""What makes a gap a contact: the tolerance, the limits of each pair, and what is said of them.

Two opposed faces of a pair touch where the range [low, high] of the gap between them, over
the area in which they overlap, meets

    [-gap, closed],   gap    = the gap tolerance of the pair,
                      closed = the same, or the designed clearance where that is larger.

Penetration counts as negative gap. The gap tolerance of a pair is `relative_gap` times the
size of the smaller part (or the gap that is given), at most a tenth of the thickness of the
thinner part, at least what rounding of the coordinates explains.

A gap tolerance that falls inside a cluster of gaps parts what belongs together: then there
are patches in its upper third, and near pairs within three times of it.
"""

from __future__ import annotations

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
    LOOSE_ANGLE,
    LOOSE_GAP,
    ROUNDINGS,
    THICKNESS,
)
from kilter.contact.patches import Patches
from kilter.contact.planar.facets import Facets
from kilter.errors import InputError, some

__all__ = [
    "APART",
    "PENETRATES",
    "THIN",
    "TILTED",
    "UNKNOWN",
    "GapLimits",
    "Rejected",
    "Tolerance",
    "closed_by_clearance",
    "gap_limits",
    "gap_warnings",
    "nearest_gap",
    "reach_of",
    "touches",
]


@dataclass(frozen=True, slots=True)
class Tolerance:
    """When two faces count as touching.

    Parameters
    ----------
    gap : float or None
        Largest gap [length unit]; None: `relative_gap` times the size of the smaller part.
    relative_gap : float
        As a fraction of the size of the smaller part [-].
    angle : float
        Largest angle between the faces [rad].
    clearance : float or None
        Designed clearance [length unit]: opposed faces that stand apart by up to this count
        as touching too, round ones in hollow ones as size on size; faces that penetrate do not.

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
        """For scanned, rounded or hand-made data: gaps to 1e-3, tilts to 2e-2 rad."""
        return cls(relative_gap=LOOSE_GAP, angle=LOOSE_ANGLE)

    def require_sound(self) -> None:
        """Refuse a gap, angle or clearance that means nothing.

        Raises
        ------
        InputError
            If one is not above zero and finite.
        """
        named = ("gap", self.gap), ("angle", self.angle), ("clearance", self.clearance)
        for name, value in named:
            if value is not None and not (np.isfinite(value) and value > 0):
                what = name if name == "clearance" else f"{name} tolerance"
                raise InputError(f"the {what} is {value}", hint="give a number above zero")

    def gap_of(self, size: Array) -> Array:
        """The gap tolerance of parts, or pairs, of these sizes [length unit]."""
        if self.gap is not None:
            return np.full(len(size), self.gap)
        return self.relative_gap * size


@dataclass(frozen=True, slots=True)
class Rejected:
    """A pair of faces that came near but does not count as touching, and why.

    `fit`: a round face inside of a hollow one.
    """

    parts: tuple[int, int]
    gap: float
    angle: float
    why: str
    fit: bool = False


APART = "gap above the tolerance"
PENETRATES = "penetrates by more than the gap tolerance"
TILTED = "tilted by more than the angle tolerance"
THIN = "thinner than twice the gap tolerance"
UNKNOWN = "the surface of one of them is not known there"


@dataclass(frozen=True, slots=True, eq=False)
class GapLimits(Rows):
    """Limits of pairs of parts, one row a pair [length unit].

    Attributes
    ----------
    gap : ndarray, shape (n,)
        Gap tolerance: the deepest penetration that is taken for contact.
    closed : ndarray, shape (n,)
        The widest gap that is: the tolerance, or the designed clearance.
    margin : ndarray, shape (n,)
        Up to this gap a pair is looked at.
    rounding : ndarray, shape (n,)
        What the accuracy of the coordinates explains.
    coarse : ndarray of bool, shape (n,)
        Rounding is not small against the thickness of a part.
    """

    gap: Array
    closed: Array
    margin: Array
    rounding: Array
    coarse: Mask


def reach_of(geometry: Geometry, tolerance: Tolerance) -> Array:
    """How far from each part others are looked for, shape (N,) [length unit]."""
    rough = tolerance.gap_of(geometry.size)
    if tolerance.gap is None:
        rough = np.maximum(rough, ROUNDINGS * geometry.accuracy)
    return np.maximum(LOOKED_AT_GAPS * rough / 2, CLUSTER * (tolerance.clearance or 0.0))


def gap_limits(geometry: Geometry, facets: Facets, pairs: Index, tolerance: Tolerance) -> GapLimits:
    """The limits of pairs of parts, shape (n, 2)."""
    a, b = pairs.T
    surface = np.bincount(facets.part, weights=facets.area, minlength=len(geometry.mass))
    thickness = 2 * geometry.volume / surface
    thin = THICKNESS * np.minimum(thickness[a], thickness[b])
    rounding = 2 * (geometry.accuracy[a] + geometry.accuracy[b])
    wanted = tolerance.gap_of(np.minimum(geometry.size[a], geometry.size[b]))
    gap = wanted
    if tolerance.gap is None:
        gap = np.maximum(np.minimum(wanted, thin), rounding)
    clearance = tolerance.clearance or 0.0
    return GapLimits(
        gap=gap,
        closed=np.maximum(gap, clearance + rounding) if clearance else gap,
        margin=np.maximum(LOOKED_AT_GAPS * wanted, np.maximum(gap, CLUSTER * clearance)),
        rounding=rounding,
        coarse=rounding > thin,
    )


def touches(gap: Array, deepest: Array, widest: Array) -> Mask:
    """Whether ranges of gaps, shape (n, 2), meet [-deepest, widest], shape (n,).

    Examples
    --------
    >>> touches(np.array([[0.0, 3.0], [2.0, 3.0], [-3.0, -2.0]]), np.ones(3), np.ones(3))
    array([ True, False, False])
    """
    low, high = gap.T
    result: Mask = (low <= widest) & (high >= -deepest)
    return result


def nearest_gap(gap: Array) -> Array:
    """Of ranges of gaps, shape (n, 2), the gap nearest to zero; 0 where it changes sign."""
    low, high = gap.T
    nearest: Array = np.where(low > 0, low, np.minimum(high, 0.0))
    return nearest


# what is said of them ---------------------------------------------------------------------


def gap_warnings(patches: Patches, rejected: list[Rejected], limits: GapLimits) -> list[str]:
    """A word where the tolerance cuts through gaps that belong together, or is all rounding."""
    return [*_cluster(patches, rejected, limits), *_coarse(limits)]


def _cluster(patches: Patches, rejected: list[Rejected], limits: GapLimits) -> list[str]:
    gap, closed = limits.gap, limits.closed
    near = nearest_gap(patches.gap)
    # a gap is held against the clearance, a penetration against the tolerance
    limit = np.where(near >= 0, closed[patches.pair], gap[patches.pair])
    below = int((np.abs(near) > limit / CLUSTER).sum())
    # of the kinds of limit, the one that the rejected piece fell to
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


def _coarse(limits: GapLimits) -> list[str]:
    """A word where rounding is not small against a part's thickness."""
    if not limits.coarse.any():
        return []
    return [
        "coordinates are too coarse for the thinnest parts: "
        f"{int(limits.coarse.sum())} pairs have rounding above a tenth of a part's thickness"
    ]


def closed_by_clearance(assembly: Assembly, patches: Patches, limits: GapLimits) -> list[str]:
    """Which pairs stand apart, and touch because a clearance was closed."""
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
        f"clearances taken as closed in {len(rows)} patches, {len(pairs)} pairs that stand apart: "
        f"{some(pairs)}; the answer is that of parts moved together there"
    ]
