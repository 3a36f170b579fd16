"""Bolts with their nuts, as (bolt, nut, axis along which the nut comes off)."""

from __future__ import annotations

from collections.abc import Iterable

from kilter.analysis.planning.order.removal import Screw
from kilter.contact import ContactSet
from kilter.contact.contact_tolerances import THREAD
from kilter.contact.curved.coaxial_faces import coaxial_fits
from kilter.errors import InputError

__all__ = ["find_screws"]


def find_screws(contacts: ContactSet, named: Iterable[tuple[str, str]]) -> list[Screw]:
    """Match each named bolt with the nuts around it; return a screw for each pair.

    Raises `InputError` if a pattern matches no part, or no nut of a pair is round a bolt.
    """
    assembly = contacts.assembly
    screw_of: dict[tuple[int, int], Screw] = {}
    for pair in named:
        if isinstance(pair, str) or len(pair) != 2:
            raise InputError(f"screws have {pair!r:.60}", hint="give pairs of a bolt and a nut")
        bolts, nuts = (sorted(map(assembly.index_of, assembly.matching(entry))) for entry in pair)
        wanted = {(bolt, nut) for bolt in bolts for nut in nuts if bolt != nut}
        fits = coaxial_fits(assembly, wanted, contacts.searched, thickest=THREAD, thinnest=THREAD)
        screws = [(fit.ends, fit.axis) for fit in fits if fit.ends in wanted]
        if not screws:
            raise InputError(
                f"no {pair[1]!r} surrounds the shaft of a {pair[0]!r}",
                hint="name the bolt, then the nut",
            )
        for (bolt, nut), axis in screws:
            x, y, z = (float(entry) + 0.0 for entry in axis.round(12))
            screw_of.setdefault((bolt, nut), Screw(bolt, nut, (x, y, z)))
    return list(screw_of.values())
