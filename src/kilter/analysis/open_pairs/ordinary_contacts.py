"""Open pairs as ordinary contacts: does the guarantee of friction hold with them too?

More forces only help an equilibrium to exist, but with friction they may break a guarantee: a
block on a slope is held by it; with a second, smoother support in the same plane a motion obeys
the contact law. So a level above equilibrium is decided again with the open pairs as contacts
of the kind that they would be if they touched, in every subset of them. If there are too many,
or a pair has no such kind (a free form), only equilibrium is reported.

The contacts that open pairs would be are those that a detection finds whose tolerance takes
their gaps, depths and tilts in; a degenerate point pushes along the centre of its normals.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
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

__all__ = [
    "EQUILIBRIUM",
    "MOST_TRIED",
    "PROVED",
    "SETTLES",
    "OpenTrial",
    "trial_words",
    "try_ordinary",
    "with_ordinary_contacts",
]

EQUILIBRIUM, SETTLES, PROVED = range(3)
"""What friction guarantees: forces exist; it settles; no motion obeys the law."""
MOST_TRIED = 4
"""Open pairs of which every subset is tried."""
WIDER = 1.01
"""By so much the tolerance of the detection is wider than the widest gap."""


@dataclass(frozen=True, slots=True)
class OpenTrial:
    """The guarantee of friction if open pairs are ordinary contacts.

    Attributes
    ----------
    level : {EQUILIBRIUM, SETTLES, PROVED}
        The lowest of every subset of them.
    tried : int
        How many subsets.
    lowest : tuple of OpenPair
        The first subset of that level, if it is not PROVED.
    """

    level: int
    tried: int
    lowest: tuple[OpenPair, ...] = ()


def try_ordinary(
    assembly: Assembly, contacts: ContactSet, level_of: Callable[[Program], int]
) -> OpenTrial:
    """Ask the level of the program of each subset of the open pairs.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    level_of : callable
        Function that returns the level of a program.
    """
    pairs = still_open(contacts.open_pairs, assembly)
    if len(pairs) > MOST_TRIED or any(one.kind == "free-form" for one in pairs):
        return OpenTrial(EQUILIBRIUM if pairs else PROVED, 0)
    wide = _touching_all(assembly, contacts, pairs) if pairs else contacts
    found = OpenTrial(PROVED, 0)
    for tried, chosen in enumerate(_subsets(pairs), start=1):
        other = with_ordinary_contacts(contacts, wide, chosen)
        level = level_of(build_program(assembly, other))
        lower = level < found.level
        found = OpenTrial(min(level, found.level), tried, chosen if lower else found.lowest)
        if level == EQUILIBRIUM:
            break
    return found


def trial_words(trial: OpenTrial, assembly: Assembly, count: int) -> str:
    """Words about a trial of `count` open pairs."""
    if trial.level == PROVED:
        return (
            f"the guarantee of friction is valid for every subset of the {count} open pairs as "
            f"ordinary contacts, too ({trial.tried} subsets checked)"
        )
    word = "is not proved" if trial.level == SETTLES else "does not reach the level settles"
    if not trial.lowest:
        return f"it {word}, because {count} open pairs may touch in more ways than were checked"
    names = assembly.names
    pairs = [f"{names[p.parts[0]]!r} and {names[p.parts[1]]!r}" for p in trial.lowest]
    return f"it {word}, because it fails if these open pairs are ordinary contacts: {some(pairs)}"


def _subsets(pairs: tuple[OpenPair, ...]) -> Iterator[tuple[OpenPair, ...]]:
    for count in range(1, len(pairs) + 1):
        yield from combinations(pairs, count)


def _touching_all(
    assembly: Assembly, contacts: ContactSet, pairs: tuple[OpenPair, ...]
) -> ContactSet:
    """Contacts with a tolerance that closes the gaps of these pairs."""
    far = [abs(one.gap or 0.0) for one in pairs] + [one.depth or 0.0 for one in pairs]
    gap = max(WIDER * max(far), contacts.gap)
    angle = max(contacts.tolerance.angle, LOOSE_ANGLE)
    wide = dataclasses.replace(contacts.tolerance, gap=gap, angle=angle)
    return detect.contacts(assembly, tolerance=wide)


def with_ordinary_contacts(
    contacts: ContactSet, wide: ContactSet, pairs: tuple[OpenPair, ...]
) -> ContactSet:
    """The contact set with those of `wide` between some open pairs in place of its own.

    Parameters
    ----------
    contacts, wide : ContactSet
        Contacts of the same assembly.
    pairs : tuple of OpenPair
        A degenerate pair brings a push at each of its points.
    """
    faces = {frozenset(one.parts) for one in pairs if one.kind != "degenerate"}
    edges = {frozenset(one.parts) for one in pairs if one.kind == "degenerate"}
    keep = [frozenset(p) not in faces for p in contacts.patch_parts.tolist()]
    take = [frozenset(p) in faces for p in wide.patch_parts.tolist()]
    first, second = (_patches(c, np.flatnonzero(k)) for c, k in ((contacts, keep), (wide, take)))
    third = _pushes(contacts, edges)
    values: dict[str, Any] = {
        name: np.concatenate([x[name] for x in (first, second, third)]) for name in first
    }
    return dataclasses.replace(contacts, patch_start=starts(values.pop("count")), **values)


def _patches(contacts: ContactSet, rows: Index) -> dict[str, Any]:
    """Columns of some patches and of their points."""
    some = np.isin(contacts.point_patch, rows)
    names = ("parts", "normal", "area", "gap", "mu", "kind", "accuracy", "doubt")
    found = {f"patch_{name}": getattr(contacts, f"patch_{name}")[rows] for name in names}
    count = np.diff(contacts.patch_start)[rows]
    return {
        **found,
        "count": count,
        "points": contacts.points[some],
        "normals": contacts.normals[some],
    }


def _pushes(contacts: ContactSet, edges: set[frozenset[int]]) -> dict[str, Any]:
    """A patch with a single point at each degenerate point of some pairs."""
    points = contacts.approximate
    parts = np.column_stack([points.part_a, points.part_b])
    rows = np.array([k for k, p in enumerate(parts.tolist()) if frozenset(p) in edges], np.int64)
    points, parts, none = points.take(rows), parts[rows], np.zeros(len(rows))
    return {
        "patch_parts": parts,
        "patch_normal": points.normals,
        "patch_area": none,
        "patch_gap": np.zeros((len(rows), 2)),
        "patch_mu": friction_coefficients(contacts.assembly, parts),
        "patch_kind": np.full(len(rows), "edge-edge", dtype=contacts.patch_kind.dtype),
        "patch_accuracy": none,
        "patch_doubt": none,
        "count": np.ones(len(rows), dtype=np.int64),
        "points": points.points,
        "normals": points.normals,
    }
