"""Open pairs: pairs whose contact the geometry does not determine, and their largest forces.

A verdict must hold for every contact set that the geometry leaves open. A pair of parts is open if
at least one of them is free, no fixed joints connect them, and the pair has one of these kinds:

    overlap      shares volume beyond the tolerance: a press fit, a thread, a sloppy model
    clearance    a round face inside a wider hollow face
    near         has faces that do not count as touching, but come within `LOOSE_GAP` of the size
                 of the smaller part and within `LOOSE_ANGLE`, as `Tolerance.loose` accepts
    free-form    touches at a curved face in a way without a formula
    degenerate   touches at edges or corners that have no unique normal
    unexamined   comes near, but a time limit ended the search before its contacts were examined

A pair with several kinds has the first of them. At the least, only the certain contacts act between
the two parts. At the most, a free-form or degenerate pair exerts the forces that
`kilter.contact.sharp` bounds. A pair of another kind holds
its parts to each other by any force and torque. Reason: a near face may touch anywhere on its area,
its normal is off by up to gap over width, and its edges and corners may catch. Together these
allow every wrench.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal, get_args

import numpy as np

from kilter.arrays import Array, Index, connected
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.common.gaps import THIN, RejectedPair
from kilter.contact.common.patches import Overlap, PairRecord, PossibleContacts, UnsupportedContact
from kilter.contact.contact_tolerances import LOOSE_ANGLE, LOOSE_GAP

OpenKind = Literal["overlap", "clearance", "near", "free-form", "degenerate", "unexamined"]
KINDS: tuple[OpenKind, ...] = get_args(OpenKind)
"""Kinds of open pairs, in order of precedence."""
ANY_WRENCH = ("overlap", "clearance", "near", "unexamined")
"""Kinds of open pairs whose contact may transmit any force and torque."""
UNEXAMINED = "the time limit was reached before its contacts were examined"
"""Reason of an open pair that the contact search did not examine."""


class OpenPair(PairRecord, kw_only=False):
    """Two parts of which the geometry does not show whether, or how, they touch."""

    kind: OpenKind
    """Kind of the open pair."""
    gap: float | None = None
    """Gap of the nearest faces [length unit]; negative if they penetrate."""
    depth: float | None = None
    """Depth of an overlap, if computed [length unit]."""
    volume: float | None = None
    """Volume of an overlap, if computed [length unit^3]."""
    why: str = ""
    """Reason, in words."""


def find_open_pairs(
    assembly: Assembly,
    overlaps: Iterable[Overlap],
    rejected: Iterable[RejectedPair],
    unsupported: Iterable[UnsupportedContact],
    unexamined: Index,
) -> tuple[OpenPair, ...]:
    """Pairs of parts whose contact the geometry leaves open; a single entry for each pair.

    `overlaps`, `rejected`, `unsupported`: records of the contact search. `unexamined`, shape (n,
    2): pairs that the search did not examine, because a time limit ended it.
    """
    size = assembly.geometry.size
    entries = [_from_overlap(overlap) for overlap in overlaps]
    entries += [pair for r in rejected if (pair := _from_rejected(r, size)) is not None]
    entries += [_from_unsupported(contact) for contact in unsupported]
    entries += [OpenPair((a, b), "unexamined", why=UNEXAMINED) for a, b in unexamined.tolist()]
    entries.sort(
        key=lambda pair: (*sorted(pair.ends), KINDS.index(pair.kind), abs(pair.gap or 0.0))
    )
    first: dict[frozenset[int], OpenPair] = {}
    for pair in entries:
        first.setdefault(frozenset(pair.ends), pair)
    return still_open(first.values(), assembly)


def still_open(pairs: Iterable[OpenPair], assembly: Assembly) -> tuple[OpenPair, ...]:
    """The open pairs with at least one free part and without fixed joints between the parts."""
    pairs = tuple(pairs)
    if not pairs:
        return ()
    group = rigid_groups(assembly)
    return tuple(pair for pair in pairs if group[pair.ends[0]] != group[pair.ends[1]])


def _from_overlap(overlap: Overlap) -> OpenPair:
    return OpenPair(overlap.ends, "overlap", None, overlap.depth, overlap.volume, overlap.why)


def _from_rejected(rejected: RejectedPair, size: Array) -> OpenPair | None:
    """The open pair for faces that nearly touch; None if even the loose tolerance rejects them."""
    kind: OpenKind = "clearance" if rejected.fit else "near"
    limit = LOOSE_GAP * float(size[list(rejected.ends)].min())
    close = rejected.fit or (abs(rejected.gap) <= limit and rejected.angle <= LOOSE_ANGLE)
    # a contact thinner than the tolerance has its edges and corners, which other searches find
    if rejected.why == THIN or not close:
        return None
    return OpenPair(rejected.ends, kind, gap=rejected.gap, why=rejected.why)


def _from_unsupported(contact: UnsupportedContact) -> OpenPair:
    kind: OpenKind = "free-form" if contact.kind == "curved" else "degenerate"
    return OpenPair(contact.ends, kind, why=f"{contact.kind} contact without a definite normal")


def rigid_groups(assembly: Assembly) -> Index:
    """Group of each part, shape (N,); held parts, and parts joined by fixed joints, share a group.

    All parts of a group move as a single body.
    """
    count = len(assembly.parts)
    second = [k for k, part in enumerate(assembly.parts) if part.grounded]
    first = [count] * len(second)
    for joint in assembly.joints:
        if joint.kind == "fixed":
            ends = [assembly.index.get(name, count) for name in joint.parts]
            first.append(ends[0])
            second.append(ends[1])
    label = connected(count + 1, np.array(first, np.int64), np.array(second, np.int64))
    return label[:-1]


def open_forces(pairs: Sequence[OpenPair], geometry: Geometry) -> PossibleContacts:
    """Six possible forces for each open pair, which together make any force and torque.

    Six two-sided rows for each pair: forces along x, y, z at the centre of the smaller part, and
    forces at a distance of its radius beside the centre, whose moments span the torques.
    """
    parts = np.array([p.ends for p in pairs if p.kind in ANY_WRENCH], dtype=np.int64)
    a, b = parts.reshape(-1, 2).T
    smaller = np.where(geometry.radius[a] <= geometry.radius[b], a, b)
    center, arm = geometry.center[smaller], geometry.radius[smaller][:, None]
    x, y, z = np.eye(3)
    rows = [(0 * x, x), (0 * x, y), (0 * x, z), (x, y), (x, z), (y, z)]
    count = 6 * len(a)
    return PossibleContacts(
        part_a=np.tile(a, 6),
        part_b=np.tile(b, 6),
        points=np.concatenate([center + arm * shift for shift, _ in rows]),
        normals=np.concatenate([np.tile(along, (len(a), 1)) for _, along in rows]),
        two_sided=np.ones(count, dtype=bool),
        mu=np.zeros(count),
        degenerate=np.full(count, -1),
    )
