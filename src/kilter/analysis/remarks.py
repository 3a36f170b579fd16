"""What an answer has to say beside itself: remarks of the reader, loose parts, what is held."""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import some_names

__all__ = ["loose_parts", "remarks", "touching_nothing"]


def remarks(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Remarks of the reader, of the geometry and of the contacts, and if nothing can move."""
    found = [*assembly.notes, *assembly.geometry.warnings, *contacts.warnings]
    if assembly.geometry.grounded.all():
        found.append("every part is held: nothing can move")
    return found


def loose_parts(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Parts that touch nothing, with what comes nearest to them; held ones apart."""
    found = []
    alone = touching_nothing(assembly, contacts)
    if alone:
        found.append(f"touches nothing: {some_names(alone)}{_nearest(assembly, contacts, alone)}")
    held = touching_nothing(assembly, contacts, held=True)
    if held:
        found.append(f"held, but touches nothing: {some_names(held)}")
    return found


def _nearest(assembly: Assembly, contacts: ContactSet, alone: list[str]) -> str:
    """The nearest face that was rejected, of the first of the parts."""
    names, unit = assembly.names, assembly.units
    for rejected in contacts.rejected:
        pair = [names[k] for k in rejected.parts]
        if set(pair) & set(alone):
            return (
                f"; {pair[0]!r} and {pair[1]!r} come within {abs(rejected.gap):.3g} {unit} "
                f"({rejected.why}): see the contacts, or loosen the tolerance"
            )
    return ""


def touching_nothing(assembly: Assembly, contacts: ContactSet, *, held: bool = False) -> list[str]:
    """Names of the free (or held) parts that touch nothing and are joined to nothing."""
    alone = assembly.geometry.grounded == held
    alone[contacts.patch_parts.ravel()] = False
    alone[[k for pair in contacts.unsupported for k in pair.parts]] = False
    joined = (name for joint in assembly.joints for name in joint.parts)
    alone[[assembly.index[name] for name in joined if name in assembly.index]] = False
    return [assembly.names[k] for k in np.flatnonzero(alone)]
