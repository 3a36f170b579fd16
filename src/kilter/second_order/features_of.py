"""The features of a program's contacts: those that the assembly gives, those that are found."""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Feature
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.rigid import unit
from kilter.second_order.features import FEATURES, OPEN, Features

__all__ = ["features_of"]


def features_of(program: Program, contacts: ContactSet) -> Features:
    """The feature of each row of a program, in their order.

    Parameters
    ----------
    program : Program
        Of these contacts, or of some of them; its rows are as they were made.
    contacts : ContactSet

    Returns
    -------
    Features
        Open: rows that are no contact points, given contacts without a feature, and what is
        not known exactly.
    """
    found = _nothing_known(program)
    _set_given(found, program, contacts)
    return Features(**found)


def _nothing_known(program: Program) -> dict[str, Any]:
    """Columns of `Features`, every row open."""
    count = len(program.part_a)
    return {
        "kind_a": np.full(count, OPEN),
        "kind_b": np.full(count, OPEN),
        "edge_a": np.zeros((count, 3)),
        "edge_b": np.zeros((count, 3)),
        "curvature_a": np.zeros((count, 3, 3)),
        "curvature_b": np.zeros((count, 3, 3)),
        "fibre": np.zeros((count, 3)),
        "conformal": np.zeros(count, dtype=bool),
        "group": np.where(program.kind == CONTACT, program.source, -1),
    }


def _set_given(found: dict[str, Any], program: Program, contacts: ContactSet) -> None:
    """Features of the contacts that the assembly lists: its "given" patches, in their order."""
    given = contacts.assembly.contacts
    patches = np.flatnonzero(contacts.patch_kind == "given")
    if len(patches) != len(given):  # not the contacts of this assembly
        return
    for patch, contact in zip(patches, given, strict=True):
        rows = np.flatnonzero(found["group"] == patch)
        if contact.feature is None or not len(rows):
            continue
        for side, feature in zip("ab", contact.feature, strict=True):
            _set_side(found, side, rows, feature, contact.normal)


def _set_side(
    found: dict[str, Any], side: str, rows: Index, feature: Feature, normal: Array
) -> None:
    """One part's feature at some rows of one normal; what a direction has along it is left out."""
    found[f"kind_{side}"][rows] = FEATURES[feature.kind]
    found[f"curvature_{side}"][rows] = feature.tensor(normal)
    if feature.kind == "edge":
        found[f"edge_{side}"][rows] = unit(feature.along - (feature.along @ normal) * normal)
