"""Features at the contacts of a program, as stated in the assembly or found from geometry."""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.arrays import Array, Index, across, unit_rows
from kilter.assembly import Feature
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.rigid import unit
from kilter.second_order.gaps.features import EDGE, FACE, FEATURES, OPEN, Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.gaps.part_features import part_features
from kilter.second_order.second_order_tolerances import CROSSING, ROUND


def features_of(program: Program, contacts: ContactSet, *, recognised: bool = False) -> Features:
    """Features (face, edge, vertex) of both parts at each row of a program.

    Arguments: `recognised`: whether surfaces that were recognised in meshes count as known, within
    their doubt. Returns in the order of the rows. Open are rows that are no contact points, given
    contacts without a feature, and inexact contacts (fitted normals, closed clearances, and, unless
    `recognised`, surfaces recognised in meshes).
    """
    columns = _nothing_known(program)
    _set_given(columns, program, contacts)
    rows = detected_rows(program, contacts)
    if len(rows):
        _set_detected(columns, program, contacts, rows, recognised)
        _set_conformal(columns, program, contacts, rows)
    return Features(**columns)


def _nothing_known(program: Program) -> dict[str, Any]:
    """Columns of `Features` with unknown features in every row."""
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


def _set_given(columns: dict[str, Any], program: Program, contacts: ContactSet) -> None:
    """Fill in the features that the assembly states for its given contacts."""
    stated = contacts.stated_features
    for patch in np.unique(columns["group"]).tolist() if stated else []:
        if patch not in stated:
            continue
        contact, rows = stated[patch], np.flatnonzero(columns["group"] == patch)
        for side, feature in zip("ab", contact.feature or (), strict=True):
            _set_side(columns, side, rows, feature, contact.normal)


def _set_side(
    columns: dict[str, Any], side: str, rows: Index, feature: Feature, normal: Array
) -> None:
    """Fill in the stated feature of one side, at rows that have the same normal.

    The component of an edge along the normal is removed.
    """
    columns[f"kind_{side}"][rows] = FEATURES[feature.kind]
    columns[f"curvature_{side}"][rows] = feature.tensor(normal)
    if feature.kind == "edge":
        columns[f"edge_{side}"][rows] = unit(feature.along - (feature.along @ normal) * normal)
    if feature.axis is not None:
        columns[f"axis_{side}"][rows] = np.append(feature.point, feature.axis)


FLAT = ("plane", "edge-edge", "edge-face", "vertex-face")
"""Kinds of patch between flat faces, straight edges and corners."""
ROUND_KINDS = ("sphere", "cylinder", "cone", "torus")
"""Kinds of patch on curved surfaces."""


def detected_rows(program: Program, contacts: ContactSet) -> Index:
    """Indices of rows of detected contacts with a closed gap and an exact normal, shape (k,)."""
    rows = np.flatnonzero((program.kind == CONTACT) & (program.doubt == 0))
    patch = program.source[rows]
    known = np.isin(contacts.patch_kind, (*FLAT, *ROUND_KINDS))
    closed = np.abs(contacts.patch_gap).max(axis=1, initial=0.0) <= contacts.gap
    detected: Index = rows[(known & closed)[patch]]
    return detected


def _set_detected(
    columns: dict[str, Any], program: Program, contacts: ContactSet, rows: Index, recognised: bool
) -> None:
    """Fill in the features of both parts at contact points that were detected."""
    geometry = contacts.assembly.geometry
    reach = 2 * (contacts.searched.gap_of(geometry.size) + geometry.accuracy)
    parts = contacts.patch_parts[program.source[rows]]
    region = contacts.patch_area[program.source[rows]] > 0
    meshes = np.isin(contacts.patch_kind[program.source[rows]], ROUND_KINDS) & recognised
    for side, part, sense in (("a", parts[:, 0], 1.0), ("b", parts[:, 1], -1.0)):
        outward = sense * program.normal[rows]
        point = program.point[rows]
        features = part_features(geometry, part, point, outward, reach, region, meshes)
        columns[f"kind_{side}"][rows] = features.kind
        columns[f"edge_{side}"][rows] = features.edge
        columns[f"curvature_{side}"][rows] = features.curvature
        columns[f"doubt_{side}"][rows] = features.doubt


def _set_conformal(
    columns: dict[str, Any], program: Program, contacts: ContactSet, rows: Index
) -> None:
    """Mark contact points of faces that fit each other (shaft in hole) as conformal.

    These are corners of a flat patch on an edge of both parts or within a rim, and points of round
    patches along which the surfaces touch everywhere. If they touch along a curve only, as a ball
    in a cone, the curve is a line of contact. Straight lines of contact that end within both faces,
    or on both parts at once, get the feature of their inner points at the ends.
    """
    left = rows[~formed(program, Features(**columns))[rows]]
    patch = program.source[left]
    flat = contacts.patch_kind[patch] == "plane"
    count = np.diff(contacts.patch_start)[patch]
    faces = (columns["kind_a"][left] == FACE) & (columns["kind_b"][left] == FACE)
    fit = np.isin(contacts.patch_kind[patch], ROUND_KINDS) & (count > 2) & faces
    fit &= (columns["doubt_a"][left] == 0) & (columns["doubt_b"][left] == 0)
    along = _common_directions(columns, program.normal[left], left)
    curve = fit & along.any(axis=1)
    columns["fibre"][left[curve]] = along[curve]
    columns["conformal"][left[flat | (fit & ~curve)]] = True
    first = contacts.patch_start[patch]
    last = np.minimum(first + count, len(contacts.points)) - 1
    line = unit_rows(contacts.points[last] - contacts.points[first])
    ends = np.isin(contacts.patch_kind[patch], ROUND_KINDS) & (count == 2)
    for side in "ab":
        crossing = np.abs(np.einsum("ij,ij->i", columns[f"edge_{side}"][left], line))
        kind = columns[f"kind_{side}"][left]
        ends &= (kind == FACE) | ((kind == EDGE) & (crossing < CROSSING))
    columns["fibre"][left[ends]] = line[ends]
    columns["flush"][left[(flat | ends) & ~faces]] = True
    for side in "ab":
        columns[f"kind_{side}"][left[flat | ends]] = FACE
        columns[f"edge_{side}"][left[flat | ends]] = 0.0
        columns[f"curvature_{side}"][left[flat]] = 0.0


def _common_directions(columns: dict[str, Any], normal: Array, rows: Index) -> Array:
    """Unit tangents along which alone the surfaces of both parts curve alike, (k, 3); else 0."""
    total = columns["curvature_a"][rows] + columns["curvature_b"][rows]
    size = np.abs(columns["curvature_a"][rows]).max(axis=(1, 2))
    frame = np.stack(across(normal), axis=1)
    values, vectors = np.linalg.eigh(frame @ total @ frame.swapaxes(1, 2))
    lone = (np.abs(values[:, 0]) <= ROUND * size) & (values[:, 1] > ROUND * size)
    along = np.einsum("ki,kij->kj", vectors[:, :, 0], frame)
    return np.asarray(np.where(lone[:, None], along, 0.0))
