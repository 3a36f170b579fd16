"""What an answer has to say beside itself: remarks of the reader, loose parts, what is held."""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly
from kilter.contact import ContactSet

__all__ = ["remarks", "touching_nothing"]


def remarks(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Remarks of the reader, of the geometry and of the contacts, and if nothing can move."""
    found = [*assembly.notes, *assembly.geometry.warnings, *contacts.warnings]
    if assembly.geometry.grounded.all():
        found.append("every part is held: nothing can move")
    return found


def touching_nothing(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Names of the free parts that touch nothing and are joined to nothing."""
    alone = ~assembly.geometry.grounded
    alone[contacts.patch_parts.ravel()] = False
    alone[[k for pair in contacts.unsupported for k in pair.parts]] = False
    joined = (name for joint in assembly.joints for name in joint.parts)
    alone[[assembly.index[name] for name in joined if name in assembly.index]] = False
    return [assembly.names[k] for k in np.flatnonzero(alone)]
