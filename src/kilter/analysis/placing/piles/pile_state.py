"""State of a pile: its boxes, and the known loads it carries (forces, polygons, motions).

`Carried` entries are loads that forces carry beside the weights, as the change of all contact
forces for a load of 1 N:

    ray         a load at a point of a top that is carried however heavy it is. The points of a box
                make a convex polygon: the hull of the parts of its contacts that lie in the
                polygons of the boxes below, as in LBCP
    point       a load at a point of a top up to a largest force, found by a program
    pattern     loads on several tops at once, up to a largest force, found by a program

Convex combinations of entries are carried, since the pile itself is. Entries of rays do not depend
on the weights, so they stay valid when boxes are added.

References
----------
LBCP: arXiv 2507.09123 (load bearable convex polygons).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array, vstack

from kilter.analysis.placing.piles.pile_contacts import BoxRows, Touching, touching
from kilter.analysis.placing.piles.pile_hulls import fan_weights, lowest_planes
from kilter.analysis.placing.piles.pile_program import PlaceProgram
from kilter.analysis.placing.piles.pile_statics import (
    PileContacts,
    PileStatics,
    heights_of,
    rectangle_corners,
)
from kilter.arrays import TINY, Array, Index, Mask
from kilter.contact.common.polygons import clip_convex, convex_hull, polygon_area
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE
from kilter.mechanics.program import Program

FLAT_POLYGON = 1e-9
"""A polygon of loads with less area over the area of the top is not used [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Loads on several tops that the pile carries together."""

    entry: int
    """Entry of `Carried` with the forces."""
    most: float
    """Largest sum of the loads [N]."""
    resultant: Array
    """Place of their resultant, shape (2,)."""
    boxes: Index
    points: Array
    shares: Array
    """The boxes, the points of the loads on them, and the shares of the sum [-], shape (k,)."""


@dataclass(eq=False)
class Carried:
    """Loads that forces carry, as entries; see the docstring of the module."""

    point: Array
    """Place of the load, shape (e, 2); of a pattern, that of its resultant."""
    most: Array
    """Largest force of the load [N], shape (e,); infinite for rays."""
    change: csr_array
    """Change of the forces at the contacts for a load of 1 N, shape (e, 4 c)."""
    polygons: list[Index]
    """Entries of each box whose points are the corners of its polygon of rays, anticlockwise."""
    points: dict[int, list[int]] = field(default_factory=dict)
    """Entries of the kind point, by box."""
    patterns: list[Pattern] = field(default_factory=list)

    def add(self, point: Array, most: float, change: Array) -> int:
        """Append an entry, and return its number."""
        self.point = np.concatenate([self.point, point[None]])
        self.most = np.append(self.most, most)
        self.change = vstack([self.change, csr_array(change[None])], format="csr")
        return len(self.most) - 1

    def polygon(self, box: int, force: float) -> Index:
        """Entries of the polygon of a box in which a load is carried, anticlockwise."""
        rays = self.polygons[box]
        more = [k for k in self.points.get(box, []) if self.most[k] >= force]
        if not more:
            return rays
        entries = np.concatenate([rays, np.array(more)])
        hull = convex_hull(self.point[entries])
        # the corners of the hull are points of the entries
        nearest = np.abs(hull[:, None] - self.point[entries][None]).sum(axis=2).argmin(axis=1)
        corners: Index = entries[nearest]
        return corners


@dataclass(eq=False)
class Motions:
    """Motions of a pile that open no contact backwards."""

    motion: Array
    """Fields of heights, shape (k, n, 3)."""
    power: Array
    """Power of the weights [N], shape (k,)."""
    size: Array
    weight: Array
    violation: Array
    """Size of the fastest box, weight of the moving boxes [N], worst closing of a contact, shape
    (k,)."""
    sure: Mask
    """False if a motion moves a pair of unsure boxes against each other, shape (k,)."""


class PileState:
    """A pile of boxes, its equilibrium, and the known answers about further loads.

    - `forces` (4 c,): forces at the contacts that carry all boxes [N]; None if the pile falls or
      is not decided.
    - `falls`: a motion proves that the pile falls.
    """

    def __init__(
        self, statics: PileStatics, forces: Array | None, carried: Carried, motions: Motions
    ) -> None:
        self.statics = statics
        self.forces = forces
        self.carried = carried
        self.motions = motions
        self._programs: dict[bool, PlaceProgram] = {}
        self.rough: tuple[Program, bool] | None = None
        self.checked: tuple[bool | None] | None = None

    @classmethod
    def of_base(cls, base: BoxRows) -> PileState:
        """The state of a base without boxes."""
        statics = PileStatics(base, PileContacts.none(), np.zeros(1))
        corners = rectangle_corners(base.low[:, :2], base.high[:, :2])[0]
        carried = Carried(
            corners, np.full(4, np.inf), csr_array((4, 0), dtype=float), [np.arange(4)]
        )
        return cls(statics, np.empty(0), carried, _no_motions(1))

    def program(self, possible: bool) -> PlaceProgram:
        """The program of places on this pile; with contacts without a certain area if possible."""
        possible &= not self.statics.contacts.sure.all()
        if possible not in self._programs:
            self._programs[possible] = PlaceProgram(self.statics, self.forces is not None, possible)
        return self._programs[possible]

    @property
    def falls(self) -> bool:
        """Whether a motion proves that the pile falls."""
        motions = self.motions
        needed = np.maximum(
            TOLERANCE * motions.size * motions.weight,
            RULED_OUT * motions.violation * motions.weight,
        )
        return bool((motions.sure & (motions.power > needed)).any())

    def touching(self, size: Array, corner: Array) -> Touching:
        """Contacts of a box at places; the corners have shape (m, 2)."""
        return touching(self.statics.boxes, size, corner)

    def add_motion(self, motion: Array) -> bool:
        """Keep a motion if it closes no contact; return whether it was kept."""
        statics = self.statics
        size = statics.sizes(motion)
        largest = float(size.max(initial=0.0))
        if not np.isfinite(largest) or largest <= TINY:
            return False
        motion = motion / largest
        violation = float(np.maximum(-statics.openings(motion), 0.0).max(initial=0.0))
        weight = float(statics.weight[size > 0].sum())
        if violation * RULED_OUT * 1e-2 > 1.0:
            return False
        kept = self.motions
        self.motions = Motions(
            np.concatenate([kept.motion, motion[None]]),
            np.append(kept.power, float(statics.power(motion))),
            np.append(kept.size, 1.0),
            np.append(kept.weight, weight),
            np.append(kept.violation, violation),
            np.append(kept.sure, not statics.excluded(motion).any()),
        )
        return True

    def with_box(
        self,
        box: BoxRows,
        touch: Touching,
        weight: float,
        forces: Array | None,
    ) -> PileState:
        """The state after a box was put down.

        Arguments: `weight` [N]; `forces` (4 (c + new),): forces that carry all boxes.
        """
        below = np.flatnonzero(touch.may_carry[0])
        number = len(self.statics.boxes)
        near = np.flatnonzero(touch.near[0])
        unsure = np.stack([near, np.full(len(near), number)], axis=1)
        contacts = PileContacts(
            below,
            np.full(len(below), number),
            touch.low[0, below],
            touch.high[0, below],
            touch.carries[0, below],
            unsure,
        )
        statics = self.statics.with_box(box, contacts, weight)
        carried = _with_rays(self.carried, contacts, box)
        state = PileState(statics, forces, carried, _no_motions(number + 1))
        for motion in _ridden(self, contacts, box):
            state.add_motion(motion)
        return state


def _no_motions(count: int) -> Motions:
    none = np.empty(0)
    return Motions(np.empty((0, count, 3)), none, none, none, none, none > 0)


def _with_rays(carried: Carried, contacts: PileContacts, box: BoxRows) -> Carried:
    """The rays of the old entries, and those of a new box.

    The load at a corner of the new polygon goes to the corners of the contact in which it lies,
    and from there as the polygon of the box below carries it.
    """
    rays = np.flatnonzero(np.isinf(carried.most))
    number = np.full(len(carried.most), -1)
    number[rays] = np.arange(len(rays))
    old = carried.change[rays]
    columns = old.shape[1]
    pieces, weights, deltas = [], [], []
    for k in np.flatnonzero(contacts.sure).tolist():
        entries = carried.polygons[int(contacts.lower[k])]
        polygon = carried.point[entries]
        if len(entries) < 3:
            continue
        rectangle = rectangle_corners(contacts.low[k], contacts.high[k])
        clipped, count = clip_convex(
            rectangle[None], np.array([4]), polygon[None], np.array([len(polygon)])
        )
        points = clipped[0, : count[0]]
        if len(points) < 3:
            continue
        which, weight = fan_weights(
            points,
            np.broadcast_to(polygon, (len(points), *polygon.shape)),
            np.full(len(points), len(polygon)),
        )
        share = np.zeros((len(points), len(rays)))
        np.add.at(share, (np.arange(len(points))[:, None], number[entries[which]]), weight)
        corner = np.zeros((len(points), 4 * len(contacts.lower)))
        corner[:, 4 * k : 4 * k + 4] = corner_shares(points, contacts.low[k], contacts.high[k])
        pieces.append(points)
        weights.append(share)
        deltas.append(corner)
    kept = old.copy()
    kept.resize((len(rays), columns + 4 * len(contacts.lower)))
    polygons = [number[entries] for entries in carried.polygons]
    most = np.full(len(rays), np.inf)
    if not pieces:
        return Carried(carried.point[rays], most, kept, [*polygons, np.empty(0, np.int64)])
    points = np.concatenate(pieces)
    hull = convex_hull(points)
    area = float(np.prod((box.high - box.low)[0, :2]))
    if len(hull) < 3 or polygon_area(hull[None], np.array([len(hull)]))[0] < FLAT_POLYGON * area:
        return Carried(carried.point[rays], most, kept, [*polygons, np.empty(0, np.int64)])
    chosen = np.abs(hull[:, None] - points[None]).sum(axis=2).argmin(axis=1)
    change = csr_array(np.concatenate(weights)[chosen]) @ old
    change.resize((len(chosen), columns + 4 * len(contacts.lower)))
    new = csr_array(np.concatenate(deltas)[chosen])
    shifted = csr_array((new.data, new.indices + columns, new.indptr), shape=change.shape)
    return Carried(
        np.concatenate([carried.point[rays], points[chosen]]),
        np.full(len(rays) + len(chosen), np.inf),
        vstack([kept, change + shifted], format="csr"),
        [*polygons, len(rays) + np.arange(len(chosen))],
    )


def corner_shares(points: Array, low: Array, high: Array) -> Array:
    """Shares of the corners of a rectangle in a force at points of it, shape (..., 4)."""
    t = np.clip((points - low) / (high - low), 0.0, 1.0)
    x, y = t[..., 0], t[..., 1]
    return np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y], axis=-1)


def _ridden(state: PileState, contacts: PileContacts, box: BoxRows) -> list[Array]:
    """The motions of a pile with a new box that falls as far as its contacts permit."""
    motions = state.motions
    if not len(motions.power):
        return []
    center = box.center[0, :2]
    points = contacts.corners
    heights = heights_of(motions.motion[:, contacts.lower, :], points)
    planes = lowest_planes(
        (points - center).reshape(-1, 2), heights.reshape(len(motions.power), -1), center
    )
    return [
        np.concatenate([motion, plane[None]])
        for motion, plane in zip(motions.motion, planes, strict=True)
        if np.isfinite(plane).all()
    ]
