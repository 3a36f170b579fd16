"""The contacts of some of the parts, from those of all: what a half-built assembly has.

A contact is found between two parts by themselves, whatever else is there. So the contacts of
an assembly without some parts are those between the parts that are left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from kilter.arrays import Index, Mask, ragged, starts
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet, Degenerate
from kilter.contact.left_out import PossibleContacts

__all__ = ["contacts_among"]

OfPair = TypeVar("OfPair", bound=Any)


def contacts_among(contacts: ContactSet, assembly: Assembly) -> ContactSet:
    """The contacts of an assembly of some of the parts, in the same poses.

    Parameters
    ----------
    contacts : ContactSet
        Of all the parts.
    assembly : Assembly
        Of some of them, by the same names; `Assembly.without` makes one.

    Raises
    ------
    InputError
        If a part of it is none of those.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> lower = tower.without(tower.names[-1])
    >>> len(contacts(tower)) - len(contacts_among(contacts(tower), lower))
    1
    """
    kept = np.array([contacts.assembly.index_of(name) for name in assembly.names])
    place = np.full(len(contacts.assembly), -1)
    place[kept] = np.arange(len(kept))
    patches = np.flatnonzero((place[contacts.patch_parts] >= 0).all(axis=1))
    _, rows = ragged(contacts.patch_start, patches)
    degenerate, points = _degenerate(contacts.degenerate, place)
    return replace(
        contacts,
        assembly=assembly,
        patch_parts=place[contacts.patch_parts[patches]],
        patch_start=starts(np.diff(contacts.patch_start)[patches]),
        points=contacts.points[rows],
        normals=contacts.normals[rows],
        unsupported=_between(contacts.unsupported, place),
        possible=_possible(contacts.possible, place, points),
        rejected=_between(contacts.rejected, place),
        overlaps=_between(contacts.overlaps, place),
        degenerate=degenerate,
        open_pairs=_still_free(_between(contacts.open_pairs, place), assembly),
        neighbours=(),
        fits=_between(contacts.fits, place),
        **{name: getattr(contacts, name)[patches] for name in PATCH_FIELDS},
    )


PATCH_FIELDS = (
    "patch_normal",
    "patch_area",
    "patch_gap",
    "patch_mu",
    "patch_kind",
    "patch_accuracy",
    "patch_doubt",
)
"""What a contact set has of each patch beside its parts and its points."""


def _between(pairs: Sequence[OfPair], place: Index) -> tuple[OfPair, ...]:
    """What is said of pairs that are left, by their new places."""
    found = []
    for one in pairs:
        a, b = (int(place[k]) for k in one.parts)
        if a >= 0 and b >= 0:
            found.append(replace(one, parts=(a, b)))
    return tuple(found)


def _still_free(pairs: tuple[OfPair, ...], assembly: Assembly) -> tuple[OfPair, ...]:
    """Open pairs of which one part is free."""
    return tuple(p for p in pairs if not all(assembly.parts[k].grounded for k in p.parts))


def _degenerate(given: Degenerate, place: Index) -> tuple[Degenerate, Index]:
    """Degenerate points that are left, and the new number of each point, -1 of others last."""
    left: Mask = (place[given.part_a] >= 0) & (place[given.part_b] >= 0)
    points = np.flatnonzero(left)
    _, normals = ragged(given.start, points)
    held = (place[given.held_parts] >= 0).all(axis=1)
    number = np.full(len(given) + 1, -1)
    number[points] = np.arange(len(points))
    return Degenerate(
        place[given.part_a[points]],
        place[given.part_b[points]],
        given.points[points],
        starts(np.diff(given.start)[points]),
        given.normals[normals],
        given.exact[points],
        place[given.held_parts[held]],
        given.held_points[held],
        given.held_normals[held],
    ), number


def _possible(given: PossibleContacts, place: Index, number: Index) -> PossibleContacts:
    """Possible forces between parts that are left; -1 is the ground, which stays."""
    ends = np.append(place, -1)
    a, b = ends[given.part_a], ends[given.part_b]
    left = np.flatnonzero(((a >= 0) | (given.part_a < 0)) & ((b >= 0) | (given.part_b < 0)))
    kept = given.take(left)
    return replace(kept, part_a=a[left], part_b=b[left], degenerate=number[kept.degenerate])
