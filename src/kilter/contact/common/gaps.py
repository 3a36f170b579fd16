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

A stand-in (a box or hull in place of a solid that could not be read) may touch every part that
comes near its box; an open mesh every part that comes near the box of a hole. The kind of contact
is unknown: such a pair is listed among the rejected pairs, with a gap of 0, and is open.

The position of a joint is 0 in the drawn pose. A limit counts as reached if its distance from 0,
times the radius of the larger free part for a turn, is at most the tolerance of gaps of the smaller
one. A joint beyond a limit has no stop there: no admissible motion leads to this pose.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, extents
from kilter.assembly import Assembly, Joint
from kilter.assembly.geometry import Geometry
from kilter.contact.common.facets import Facets
from kilter.contact.common.patches import PairRecord, Patches
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
from kilter.errors import InputError, some
from kilter.tell.numbers import rounded_up
from kilter.tell.record import InPython, key
from kilter.values.guesses import guarded


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
    """For each pair of parts, the gaps at which faces touch or count as near [length unit]."""

    gap: Array
    """Gap tolerance, shape (n,): the deepest penetration that counts as contact."""
    closed: Array
    """Widest gap that counts as contact, shape (n,): the tolerance, or the designed clearance."""
    margin: Array
    """Widest gap at which faces are compared at all, shape (n,)."""
    rounding: Array
    """Largest gap that the accuracy of the coordinates explains, shape (n,)."""
    coarse: Mask
    """True if the rounding is not small compared with the thickness of a part, shape (n,)."""


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
    """Warnings about a doubtful gap tolerance: too close to actual gaps, or below the rounding.

    It is too close if some gaps are just below it and others just above.
    """
    warnings = []
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
    if below and above:
        option = "clearance" if (closed > gap).any() else "gap"
        warnings.append(
            f"the gap tolerance falls inside a cluster of gaps: {below} patches just below it, "
            f"{above} near pairs just above; see the histogram and set the {option}"
        )
    if limits.coarse.any():
        warnings.append(
            "coordinates are too coarse for the thinnest parts: "
            f"{int(limits.coarse.sum())} pairs have rounding above a tenth of a part's thickness"
        )
    return warnings


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


def unknown_pairs(geometry: Geometry, pairs: Index, reach: Array) -> tuple[Index, Index]:
    """Split near pairs into pairs to search, and pairs that may touch at an unknown surface.

    `reach`, shape (N,): distance from each part within which others are searched for [length unit].
    Returns `looked_at`, `unknown`, shape (k, 2) and (m, 2): a pair with a stand-in is only in the
    second array; a pair with a hole may be in both.
    """
    places = geometry.unknown
    stand_in = places.stand_ins(len(geometry.mass))
    blind: Mask = stand_in[pairs[:, 0]] | stand_in[pairs[:, 1]]
    meets: Mask = blind.copy()
    for k in range(len(places)):
        for side in (0, 1):
            rows = np.flatnonzero(~meets & (pairs[:, side] == places.part[k]))
            other = pairs[rows, 1 - side]
            grown = reach[places.part[k]] + reach[other]
            low, high = places.low[k] - grown[:, None], places.high[k] + grown[:, None]
            meets[rows] = [
                _meets_box(geometry, *box) for box in zip(other.tolist(), low, high, strict=True)
            ]
    return pairs[~blind], pairs[meets]


def _meets_box(geometry: Geometry, part: int, low: Array, high: Array) -> bool:
    """Whether the bounding box of any triangle of a part meets the box from `low` to `high`."""
    rows = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    corners = geometry.vertices[geometry.triangles[rows]]
    least, greatest = extents(corners)
    apart = (greatest < low) | (least > high)
    return bool((~apart.any(axis=1)).any())


def reached_limits(assembly: Assembly, joint: Joint, tolerance: Tolerance) -> tuple[bool, bool]:
    """Whether a joint stands at its lower and at its upper limit."""
    if joint.limits is None:
        return False, False
    gap, arm = _gap_and_arm(assembly, joint, tolerance)
    low, high = (abs(limit) * arm <= gap for limit in joint.limits)
    return low, high


def joints_beyond(assembly: Assembly, tolerance: Tolerance) -> list[str]:
    """Notes about joints that are drawn beyond their limits, with the gap that would count."""
    notes = []
    for joint in assembly.joints:
        low, high = joint.limits or (0.0, 0.0)
        beyond = max(low, -high)
        gap, arm = _gap_and_arm(assembly, joint, tolerance)
        if beyond * arm > gap:
            unit = assembly.units if joint.kind == "prismatic" else "rad"
            notes.append(
                f"the {joint.kind} joint of {' and '.join(map(repr, joint.parts))} is drawn "
                f"{beyond:.3g} {unit} beyond its limits, so its stop is left out (--gap "
                f"{rounded_up(beyond * arm, 3)} counts it)"
            )
    return notes


def _gap_and_arm(assembly: Assembly, joint: Joint, tolerance: Tolerance) -> tuple[float, float]:
    """Tolerance of gaps of the smaller free part, and gap per unit of the position of a joint."""
    geometry, index = assembly.geometry, assembly.index
    ends = [index[name] for name in joint.parts if name in index]
    free = [k for k in ends if not geometry.grounded[k]] or ends
    arm = float(geometry.radius[free].max()) if joint.kind == "revolute" else 1.0
    return float(tolerance.gap_of(geometry.size[free]).min()), arm
