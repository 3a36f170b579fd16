"""The features of a program's contacts: those that the assembly gives, those that are found."""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.arrays import Array, Index, unit_rows
from kilter.assembly import Feature
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.rigid import unit
from kilter.second_order.gaps.features import EDGE, FACE, FEATURES, OPEN, Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.gaps.part_features import part_features
from kilter.second_order.second_order_tolerances import CROSSING

__all__ = ["FLAT", "detected_rows", "features_of"]


def features_of(program: Program, contacts: ContactSet, *, recognised: bool = False) -> Features:
    """The feature of each row of a program, in their order.

    Parameters
    ----------
    program : Program
        Of these contacts, or of some of them; its rows are as they were made.
    contacts : ContactSet
    recognised : bool
        Surfaces that were recognised in meshes are known too, to their doubt.

    Returns
    -------
    Features
        Open: rows that are no contact points, given contacts without a feature, and what is
        not known exactly (fitted normals, closed clearances, surfaces recognised in meshes but
        where they are asked for).
    """
    found = _nothing_known(program)
    _set_given(found, program, contacts)
    rows = detected_rows(program, contacts)
    if len(rows):
        _set_detected(found, program, contacts, rows, recognised)
        _set_conformal(found, program, contacts, rows)
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
        "axis_a": np.zeros((count, 6)),
        "axis_b": np.zeros((count, 6)),
        "doubt_a": np.zeros(count),
        "doubt_b": np.zeros(count),
        "flush": np.zeros(count, dtype=bool),
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
    if feature.axis is not None:
        found[f"axis_{side}"][rows] = np.append(feature.point, feature.axis)


FLAT = ("plane", "edge-edge", "edge-face", "vertex-face")
ROUND = ("sphere", "cylinder", "cone", "torus")


def detected_rows(program: Program, contacts: ContactSet) -> Index:
    """Rows of contacts that were found where the parts are, with exact normals."""
    rows = np.flatnonzero((program.kind == CONTACT) & (program.doubt == 0))
    patch = program.source[rows]
    known = np.isin(contacts.patch_kind[patch], (*FLAT, *ROUND))
    closed = np.abs(contacts.patch_gap[patch]).max(axis=1, initial=0.0) <= contacts.gap
    detected: Index = rows[known & closed]
    return detected


def _set_detected(
    found: dict[str, Any], program: Program, contacts: ContactSet, rows: Index, recognised: bool
) -> None:
    """What touches of either part at points that were found."""
    geometry = contacts.assembly.geometry
    reach = 2 * (contacts.tolerance.gap_of(geometry.size) + geometry.accuracy)
    parts = contacts.patch_parts[program.source[rows]]
    region = contacts.patch_area[program.source[rows]] > 0
    meshes = np.isin(contacts.patch_kind[program.source[rows]], ROUND) & recognised
    for side, part, sense in (("a", parts[:, 0], 1.0), ("b", parts[:, 1], -1.0)):
        outward = sense * program.normal[rows]
        point = program.point[rows]
        one = part_features(geometry, part, point, outward, reach, region, meshes)
        found[f"kind_{side}"][rows] = one.kind
        found[f"edge_{side}"][rows] = one.edge
        found[f"curvature_{side}"][rows] = one.curvature
        found[f"doubt_{side}"][rows] = one.doubt


def _set_conformal(
    found: dict[str, Any], program: Program, contacts: ContactSet, rows: Index
) -> None:
    """Points of faces that fit each other, where no feature of either gives a form.

    Corners of a flat patch that lie on an edge of both parts, or within a rim; points of round
    patches all along which the surfaces touch; and lines that end within both faces, or on both
    parts at once: their ends are points of the lines within.
    """
    left = rows[~formed(program, Features(**found))[rows]]
    patch = program.source[left]
    flat = contacts.patch_kind[patch] == "plane"
    count = np.diff(contacts.patch_start)[patch]
    faces = (found["kind_a"][left] == FACE) & (found["kind_b"][left] == FACE)
    fit = np.isin(contacts.patch_kind[patch], ROUND) & (count > 2) & faces
    fit &= (found["doubt_a"][left] == 0) & (found["doubt_b"][left] == 0)
    found["conformal"][left[flat | fit]] = True
    first = contacts.patch_start[patch]
    last = np.minimum(first + count, len(contacts.points)) - 1
    line = unit_rows(contacts.points[last] - contacts.points[first])
    ends = np.isin(contacts.patch_kind[patch], ROUND) & (count == 2)
    for side in "ab":
        across = np.abs(np.einsum("ij,ij->i", found[f"edge_{side}"][left], line))
        own = found[f"kind_{side}"][left]
        ends &= (own == FACE) | ((own == EDGE) & (across < CROSSING))
    found["fibre"][left[ends]] = line[ends]
    found["flush"][left[(flat | ends) & ~faces]] = True
    for side in "ab":
        found[f"kind_{side}"][left[flat | ends]] = FACE
        found[f"edge_{side}"][left[flat | ends]] = 0.0
        found[f"curvature_{side}"][left[flat]] = 0.0
