"""Verify a statement about friction for every subset of open pairs in ordinary contact.

More contacts only help an equilibrium to exist. But with friction they may invalidate a guarantee:
a block holds on a slope, but with a second, smoother support in the same plane a motion may obey
the contact law. So the levels *proved* and *settles* are computed again for every subset of the
open pairs, as contacts of the kind that they would be if they touched. If there are too many open
pairs, or a pair has no such kind (a free form), only equilibrium is reported.

A detection with a wider tolerance, which includes their gaps, depths and tilts, gives these
contacts. A degenerate point pushes along the centre of its normals.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from kilter.arrays import Index, starts
from kilter.assembly import Assembly
from kilter.contact import ContactSet, detect
from kilter.contact.contact_tolerances import LOOSE_ANGLE
from kilter.contact.friction_coefficients import friction_coefficients
from kilter.contact.open_pairs import OpenPair, still_open
from kilter.errors import some
from kilter.mechanics.program import Program, build_program

EQUILIBRIUM, SETTLES, PROVED = range(3)
"""Levels of the guarantee of friction: forces of equilibrium exist; the parts also settle; no
motion obeys the contact law."""
MOST_TRIED = 4
"""Largest number of open pairs for which every subset is tried; with more, none is."""
WIDER = 1.01
"""Ratio of the detection's gap tolerance to the largest gap or depth of the open pairs [-]."""


@dataclass(frozen=True, slots=True)
class OpenTrial:
    """The friction level that is reached whichever of the open pairs are ordinary contacts."""

    level: int
    """One of EQUILIBRIUM, SETTLES, PROVED. The lowest level over all subsets tried."""
    tried: int
    """Number of subsets tried; 0 if there are no open pairs, or too many, or a free form."""
    lowest: tuple[OpenPair, ...] = ()
    """The first subset with that level; empty if the level is PROVED or no subset was tried."""


def can_be_tried(pairs: Sequence[OpenPair]) -> bool:
    """Whether the open pairs are few and simple enough to try every subset as contacts.

    If not, forces of equilibrium are the highest level that friction can reach.
    """
    return len(pairs) <= MOST_TRIED and all(
        pair.kind not in ("free-form", "unexamined") for pair in pairs
    )


def try_ordinary(
    assembly: Assembly, contacts: ContactSet, level_of: Callable[[Program], int]
) -> OpenTrial:
    """Compute the lowest friction level over all subsets of open pairs as ordinary contacts.

    Arguments: `level_of`: function that returns the level of a program: EQUILIBRIUM, SETTLES or
    PROVED.
    """
    pairs = still_open(contacts.open_pairs, assembly)
    if not can_be_tried(pairs):
        return OpenTrial(EQUILIBRIUM, 0)
    wide = _wide_contacts(assembly, contacts, pairs) if pairs else contacts
    trial = OpenTrial(PROVED, 0)
    for tried, chosen in enumerate(_subsets(pairs), start=1):
        other = with_ordinary_contacts(contacts, wide, chosen)
        level = level_of(build_program(assembly, other))
        lower = level < trial.level
        trial = OpenTrial(min(level, trial.level), tried, chosen if lower else trial.lowest)
        if level == EQUILIBRIUM:  # no subset can lower the level further
            break
    return trial


def trial_words(trial: OpenTrial, assembly: Assembly, count: int) -> str:
    """Describe the result of a trial with `count` open pairs, as a clause for the answer."""
    if trial.level == PROVED:
        return (
            f"friction also excludes every motion if any of the {count} open pairs are ordinary "
            f"contacts ({trial.tried} subsets checked)"
        )
    word = "is not proved" if trial.level == SETTLES else "does not reach the level settles"
    if not trial.lowest:
        return f"it {word}, because {count} open pairs may touch in more ways than were checked"
    names = assembly.names
    pairs = [f"{names[p.ends[0]]!r} and {names[p.ends[1]]!r}" for p in trial.lowest]
    return f"it {word}, because it fails if these open pairs are ordinary contacts: {some(pairs)}"


def _subsets(pairs: tuple[OpenPair, ...]) -> Iterator[tuple[OpenPair, ...]]:
    """Yield all nonempty subsets of the open pairs, the smallest first."""
    for count in range(1, len(pairs) + 1):
        yield from combinations(pairs, count)


def _wide_contacts(
    assembly: Assembly, contacts: ContactSet, pairs: tuple[OpenPair, ...]
) -> ContactSet:
    """Detect contacts with a tolerance that includes the gaps and depths of these open pairs."""
    far = [abs(pair.gap or 0.0) for pair in pairs] + [pair.depth or 0.0 for pair in pairs]
    gap = max(WIDER * max(far), contacts.gap)
    angle = max(contacts.searched.angle, LOOSE_ANGLE)
    wide = dataclasses.replace(contacts.searched, gap=gap, angle=angle)
    return detect.contacts(assembly, tolerance=wide)


def with_ordinary_contacts(
    contacts: ContactSet, wide: ContactSet, pairs: tuple[OpenPair, ...]
) -> ContactSet:
    """Copy of the contacts with the given open pairs replaced by the detected contacts `wide`."""
    faces = {frozenset(pair.ends) for pair in pairs if pair.kind != "degenerate"}
    edges = {frozenset(pair.ends) for pair in pairs if pair.kind == "degenerate"}
    keep = [frozenset(p) not in faces for p in contacts.patch_parts.tolist()]
    take = [frozenset(p) in faces for p in wide.patch_parts.tolist()]
    first, second = (
        _patch_columns(c, np.flatnonzero(k)) for c, k in ((contacts, keep), (wide, take))
    )
    third = _degenerate_patches(contacts, edges)
    values: dict[str, Any] = {
        name: np.concatenate([x[name] for x in (first, second, third)]) for name in first
    }
    return dataclasses.replace(contacts, patch_start=starts(values.pop("count")), **values)


def _patch_columns(contacts: ContactSet, rows: Index) -> dict[str, Any]:
    """Columns of the patches `rows` and of their points, by column name."""
    chosen = np.isin(contacts.point_patch, rows)
    names = ("parts", "normal", "area", "gap", "mu", "kind", "accuracy", "doubt", "pieces")
    columns = {f"patch_{name}": getattr(contacts, f"patch_{name}")[rows] for name in names}
    count = np.diff(contacts.patch_start)[rows]
    return {
        **columns,
        "count": count,
        "points": contacts.points[chosen],
        "normals": contacts.normals[chosen],
    }


def _degenerate_patches(contacts: ContactSet, edges: set[frozenset[int]]) -> dict[str, Any]:
    """Columns of patches with a single point, one per degenerate point of the given pairs."""
    points = contacts.approximate
    parts = np.column_stack([points.part_a, points.part_b])
    rows = np.array([k for k, p in enumerate(parts.tolist()) if frozenset(p) in edges], np.int64)
    points, parts, zeros = points.take(rows), parts[rows], np.zeros(len(rows))
    return {
        "patch_parts": parts,
        "patch_normal": points.normals,
        "patch_area": zeros,
        "patch_gap": np.zeros((len(rows), 2)),
        "patch_mu": friction_coefficients(contacts.assembly, parts),
        "patch_kind": np.full(len(rows), "edge-edge", dtype=contacts.patch_kind.dtype),
        "patch_accuracy": zeros,
        "patch_doubt": zeros,
        "patch_pieces": np.full((len(rows), 2), -1),
        "count": np.ones(len(rows), dtype=np.int64),
        "points": points.points,
        "normals": points.normals,
    }
