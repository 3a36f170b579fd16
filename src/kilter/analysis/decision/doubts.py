"""Doubts: pairs of parts at which the real contacts may differ from the detected contacts.

    possible     further forces may act between the parts, by contacts not modelled or not certain
    degenerate   edges or corners meet at a point without a unique normal
    fitted       a fit gives the normal of a contact, with an error of some angle
    stated       the file of a part states that its coordinates are less accurate than rounding

Only this package reads these marks of a contact set. The array paths (`kilter.check_many`,
`kilter.states`, supports) decide all cases without doubts by proofs in arrays. They pass the
other cases on to `kilter.analysis.decision.cascade`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.decision.motion import explained_by_accuracy, stated_accuracy
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program


@dataclass(frozen=True, slots=True, eq=False)
class Doubts:
    """Pairs of parts of an assembly whose real contacts may differ from the detected contacts."""

    assembly: Assembly
    contacts: ContactSet
    degenerate: Index
    fitted: Index
    """Pairs of parts, one row for each degenerate point or fitted contact, shape (n, 2)."""
    stated: Array
    """Stated inaccuracy of the coordinates of each part [length unit], shape (N,); 0 if none is
    stated."""

    def normals_open(self, present: Mask) -> bool:
        """Whether two present parts meet at a point without a unique normal; `present` is (N,)."""
        return bool(present[self.degenerate].all(axis=1).any())

    @property
    def further_forces(self) -> bool:
        """Whether open pairs, or contacts that are not modelled, may exert further forces."""
        return len(self.contacts.possible) > 0 or len(self.contacts.open_pairs) > 0

    def explain_motion(self, program: Program, proved: Array | None = None) -> str:
        """Reason why even a proved motion leaves the verdict undecided; empty if it decides.

        Arguments: `proved` (N, 6): the motion, if it is known.
        """
        if not self.stated.any():
            return ""
        return explained_by_accuracy(self.assembly, self.contacts, program, proved)


def doubts_of(assembly: Assembly, contacts: ContactSet) -> Doubts:
    """Collect the pairs of an assembly whose real contacts may differ from the detected contacts.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> doubts = doubts_of(tower, contacts(tower))
    >>> len(doubts.degenerate), len(doubts.fitted), doubts.stated.any()
    (0, 0, np.False_)
    """
    points = contacts.degenerate
    return Doubts(
        assembly,
        contacts,
        degenerate=np.column_stack([points.part_a, points.part_b]),
        fitted=fitted_pairs(contacts),
        stated=stated_accuracy(assembly),
    )


def fitted_pairs(contacts: ContactSet) -> Index:
    """Pairs of parts whose contacts have normals fitted to two different meshes, shape (n, 2)."""
    pairs: Index = contacts.patch_parts[contacts.patch_doubt > 0]
    return pairs


def has_possible_contacts(contacts: ContactSet) -> bool:
    """Whether forces may act at contacts without a formula, in addition to the certain forces."""
    return len(contacts.possible.part_a) > 0
