"""Open pairs: what the geometry does not settle, and the most that such a pair could do.

A verdict must hold for every contact set that the geometry leaves open. Open is a pair of
parts, of which one is free and which no fixed joints tie to each other, that is

    overlap      shares volume beyond the tolerance: a press fit, a thread, a sloppy model
    clearance    a round face inside of a wider hollow one
    near         has faces that do not count as touching, but come within `LOOSE_GAP` of the size
                 of the smaller part and within `LOOSE_ANGLE`: what `Tolerance.loose` takes
    free-form    touches at a curved face in a way without a formula
    degenerate   touches at edges or corners that have no one normal

Of several kinds a pair goes by the first. At the least nothing acts between the two parts but
their certain contacts. At the most a pair of the last two kinds brings the forces that
`kilter.contact.sharp` and `kilter.contact.curved.unmodelled` bound; one of the first three holds
its parts to each other by any force and torque: a near face may touch anywhere on its area, its
normal is off by up to gap over width, and its edges and corners may catch, which together leaves
no wrench out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from kilter.arrays import Array, Index, connected
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import LOOSE_ANGLE, LOOSE_GAP
from kilter.contact.gaps import THIN, Rejected
from kilter.contact.left_out import Overlap, PossibleContacts, Unsupported

__all__ = [
    "KINDS",
    "OpenKind",
    "OpenPair",
    "find_open_pairs",
    "open_forces",
    "rigid_groups",
    "still_open",
]

OpenKind = Literal["overlap", "clearance", "near", "free-form", "degenerate"]
KINDS: tuple[OpenKind, ...] = get_args(OpenKind)
"""In order of precedence."""
ANY_WRENCH = ("overlap", "clearance", "near")
"""Kinds that may hold their parts by any force and torque."""


@dataclass(frozen=True, slots=True)
class OpenPair:
    """A pair of parts, by position, between which the geometry leaves open what acts.

    Attributes
    ----------
    parts : pair of int
    kind : {"overlap", "clearance", "near", "free-form", "degenerate"}
    gap : float or None
        Of the nearest faces [length unit]; negative where they penetrate.
    depth, volume : float or None
        Of an overlap [length unit, its cube]; the volume where it was computed.
    why : str
    """

    parts: tuple[int, int]
    kind: OpenKind
    gap: float | None = None
    depth: float | None = None
    volume: float | None = None
    why: str = ""

    def to_dict(self, names: Sequence[str]) -> dict[str, Any]:
        """As JSON data."""
        return {
            "parts": [names[k] for k in self.parts],
            "kind": self.kind,
            "gap": self.gap,
            "depth": self.depth,
            "volume": self.volume,
            "why": self.why,
        }


def find_open_pairs(
    assembly: Assembly,
    overlaps: Iterable[Overlap],
    rejected: Iterable[Rejected],
    unsupported: Iterable[Unsupported],
) -> tuple[OpenPair, ...]:
    """What a detection left open, one entry a pair, in order of the pairs.

    Parameters
    ----------
    assembly : Assembly
    overlaps, rejected, unsupported
        As the detection records them.
    """
    size = assembly.geometry.size
    found = [_of_overlap(one) for one in overlaps]
    found += [one for r in rejected if (one := _of_rejected(r, size)) is not None]
    found += [_of_unsupported(one) for one in unsupported]
    found.sort(key=lambda one: (*sorted(one.parts), KINDS.index(one.kind), abs(one.gap or 0.0)))
    first: dict[frozenset[int], OpenPair] = {}
    for one in found:
        first.setdefault(frozenset(one.parts), one)
    return still_open(first.values(), assembly)


def still_open(pairs: Iterable[OpenPair], assembly: Assembly) -> tuple[OpenPair, ...]:
    """Those that no fixed joints tie, and of which one part is free."""
    pairs = tuple(pairs)
    if not pairs:
        return ()
    group = rigid_groups(assembly)
    return tuple(one for one in pairs if group[one.parts[0]] != group[one.parts[1]])


def _of_overlap(one: Overlap) -> OpenPair:
    return OpenPair(one.parts, "overlap", None, one.depth, one.volume, one.why)


def _of_rejected(one: Rejected, size: Array) -> OpenPair | None:
    """A rejected pair of faces as an open pair; None where it is not within what is loose."""
    kind: OpenKind = "clearance" if one.fit else "near"
    limit = LOOSE_GAP * float(size[list(one.parts)].min())
    close = one.fit or (abs(one.gap) <= limit and one.angle <= LOOSE_ANGLE)
    if one.why == THIN or not close:
        return None
    return OpenPair(one.parts, kind, gap=one.gap, why=one.why)


def _of_unsupported(one: Unsupported) -> OpenPair:
    kind: OpenKind = "free-form" if one.kind == "curved" else "degenerate"
    return OpenPair(one.parts, kind, why=f"{one.kind} contact without one normal")


def rigid_groups(assembly: Assembly) -> Index:
    """A number for each part, the same for parts that fixed joints tie, or that are held, (N,)."""
    count = len(assembly.parts)
    held = np.flatnonzero(assembly.geometry.grounded)
    first, second = [count] * len(held), held.tolist()
    for joint in assembly.joints:
        if joint.kind == "fixed":
            ends = [assembly.index.get(name, count) for name in joint.parts]
            first.append(ends[0])
            second.append(ends[1])
    label = connected(count + 1, np.array(first, np.int64), np.array(second, np.int64))
    return label[:-1]


def open_forces(pairs: Sequence[OpenPair], geometry: Geometry) -> PossibleContacts:
    """Any force and torque between the parts of each pair that may hold its parts by any.

    Six two-sided rows a pair: forces along x, y, z at the centre of the smaller part, and at
    points one radius of it beside, whose moments span the torques.
    """
    parts = np.array([p.parts for p in pairs if p.kind in ANY_WRENCH], dtype=np.int64)
    a, b = parts.reshape(-1, 2).T
    smaller = np.where(geometry.radius[a] <= geometry.radius[b], a, b)
    at, arm = geometry.center[smaller], geometry.radius[smaller][:, None]
    x, y, z = np.eye(3)
    rows = [(0 * x, x), (0 * x, y), (0 * x, z), (x, y), (x, z), (y, z)]
    count = 6 * len(a)
    return PossibleContacts(
        part_a=np.tile(a, 6),
        part_b=np.tile(b, 6),
        points=np.concatenate([at + arm * shift for shift, _ in rows]),
        normals=np.concatenate([np.tile(along, (len(a), 1)) for _, along in rows]),
        two_sided=np.ones(count, dtype=bool),
        mu=np.zeros(count),
        degenerate=np.full(count, -1),
    )
