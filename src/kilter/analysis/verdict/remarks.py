"""Warnings of an answer: remarks of the reader, parts that touch nothing, no free parts."""

from __future__ import annotations

from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.tell.contact_words import lone_warnings

__all__ = ["loose_parts", "remarks", "touching_nothing"]


def remarks(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Remarks of the reader, of the geometry and of the contacts, and if nothing can move."""
    found = contacts.of(assembly).remarks()
    if assembly.geometry.grounded.all():
        found.append("every part is held: nothing can move")
    return found


def loose_parts(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Parts that touch nothing, with what comes nearest to them; held ones apart."""
    return lone_warnings(contacts.of(assembly).nearest(), assembly.units)


def touching_nothing(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Names of the free parts that touch nothing and are joined to nothing."""
    return [one["part"] for one in contacts.of(assembly).nearest() if not one["grounded"]]
