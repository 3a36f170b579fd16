"""The contacts among a subset of the parts, such as those of a half-built assembly.

A contact between two parts does not depend on other parts. So the contacts of an assembly without
some parts are those between the remaining parts.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from kilter.arrays import ragged, starts
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.kept_pairs import KeptPairs
from kilter.contact.open_pairs import OpenPair

__all__ = ["contacts_among", "without_overlaps"]


def contacts_among(contacts: ContactSet, assembly: Assembly) -> ContactSet:
    """The contacts that remain if an assembly is reduced to some of its parts in place.

    Parameters
    ----------
    contacts : ContactSet
        Contacts of all parts.
    assembly : Assembly
        Assembly of the subset, with the same names, as `Assembly.without` returns.

    Raises
    ------
    InputError
        If the assembly has a part that the contacts do not know.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> lower = tower.without(tower.names[-1])
    >>> len(contacts(tower)) - len(contacts_among(contacts(tower), lower))
    1
    """
    old = np.array([contacts.assembly.index_of(name) for name in assembly.names])
    new_part = np.full(len(contacts.assembly), -1)
    new_part[old] = np.arange(len(old))
    patches = np.flatnonzero((new_part[contacts.patch_parts] >= 0).all(axis=1))
    _, rows = ragged(contacts.patch_start, patches)
    kept = KeptPairs(new_part, np.empty(0, dtype=np.int64))
    degenerate, points = kept.degenerate(contacts.degenerate)
    return replace(
        contacts,
        assembly=assembly,
        patch_parts=new_part[contacts.patch_parts[patches]],
        patch_start=starts(np.diff(contacts.patch_start)[patches]),
        points=contacts.points[rows],
        normals=contacts.normals[rows],
        unsupported=kept.records(contacts.unsupported),
        possible=kept.possible(contacts.possible, points),
        near=kept.records(contacts.near),
        overlaps=kept.records(contacts.overlaps),
        degenerate=degenerate,
        open_pairs=_still_free(kept.records(contacts.open_pairs), assembly),
        neighbours=(),
        fits=kept.records(contacts.fits),
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
    "patch_pieces",
)
"""Fields of a contact set with a row for each patch, except its parts and its points."""


def _still_free(pairs: tuple[OpenPair, ...], assembly: Assembly) -> tuple[OpenPair, ...]:
    """The open pairs that still have at least one free part."""
    return tuple(p for p in pairs if not all(assembly.parts[k].grounded for k in p.ends))


def without_overlaps(contacts: ContactSet, parts: Collection[int]) -> ContactSet:
    """Contacts in which the overlaps of some parts exert no force.

    Parameters
    ----------
    contacts : ContactSet
    parts : collection of int
        Parts whose overlaps, as open pairs, are left out.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> from kilter.contact import contacts
    >>> held = Part("held", Box(1, 1, 1), grounded=True)
    >>> overlapping = contacts(Assembly([held, Part("in it", Box(1, 1, 1), [0, 0, 0.9])]))
    >>> overlapping, without_overlaps(overlapping, [1])
    (<ContactSet: overlapping 1, left open 1>, <ContactSet: nothing touches>)
    """
    chosen = set(parts)
    gone = {
        frozenset(pair.ends)
        for pair in contacts.open_pairs
        if pair.kind == "overlap" and not chosen.isdisjoint(pair.ends)
    }
    return replace(
        contacts,
        overlaps=tuple(pair for pair in contacts.overlaps if frozenset(pair.ends) not in gone),
        open_pairs=tuple(pair for pair in contacts.open_pairs if frozenset(pair.ends) not in gone),
        possible=contacts.possible.without_wrenches(gone),
    )
