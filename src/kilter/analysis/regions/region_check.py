"""Verify that the proofs in the file of a region enclose it: forces from inside, motions outside.

Forces at rays and lines hold every direction of the cone that these generate. Motions exclude every
direction beyond facets and equations. The file proves a region if the cone of the facets and
equations reaches at most the stated angle beyond the cone of the rays and lines. Without such an
angle, the file proves only the directions between its rays, and the answer says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kilter.arrays import TINY, Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.nonnegative import nonnegative
from kilter.mechanics.program import build_program
from kilter.mechanics.proof_form import (
    NUMBER,
    SIX,
    VECTOR,
    keys,
    list_of,
    named,
    nullable,
    one_of,
)
from kilter.tell.numbers import number

Entry = Mapping[str, Any]
STAYS = {"ray": True, "line": True, "facet": False, "equation": False}
"""Subjects of the proofs of a region, and whether the assembly stays in such a direction."""
TURNED = keys(about=one_of(*STAYS), vector=VECTOR, change=keys(down=VECTOR))
FALLS = keys(proof=keys(motion=named(SIX)))


def _statement(entry: Any, place: str) -> str:
    fault = TURNED(entry, place)
    return fault if fault or STAYS[entry["about"]] else FALLS(entry, place)


REGION = keys(gap_deg=nullable(NUMBER), proofs=list_of(_statement))
"""Statements of a region."""
ON_BOUNDARY = 1e-7
"""A direction counts as within a facet if it lies at most so far beyond it [-]."""
BEYOND_FACET = 0.5
"""Largest angle beyond a facet up to which its motion may have less power than it needs [deg]."""
GAP_ROUNDING = 1e-4
"""Rounding of the angle between both cones [deg]: facets meet at small angles."""


def wrong_region(
    assembly: Assembly, contacts: ContactSet, bundle: Entry, verdicts: Sequence[str]
) -> Iterator[str]:
    """Yield the reasons why proofs that are valid one by one do not enclose the stated region."""
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        if STAYS[entry["about"]] != (verdict != "unstable"):
            yield f"{entry['about']} {entry['vector']}: its proof is {verdict}"
        if set(entry["change"]) != {"down"}:
            yield f"{entry['about']} {entry['vector']}: more than the direction of gravity differs"
    if bundle["gap_deg"] is None:
        return
    gap, beyond = _gaps_deg(assembly, contacts, bundle)
    if beyond > BEYOND_FACET:
        yield f"its motions fall only {number(beyond, 3)} deg beyond its facets"
    if gap > float(bundle["gap_deg"]) + GAP_ROUNDING:
        yield (
            f"its rays and facets differ by {number(gap, 3)} deg, and it states at most "
            f"{number(float(bundle['gap_deg']), 3)} deg"
        )


def region_notes(assembly: Assembly, contacts: ContactSet, bundle: Entry) -> Iterator[str]:
    """Yield the largest angle between the directions that are held and those that fall."""
    if bundle["gap_deg"] is None:
        yield "only the directions between the rays are proved: no other direction is excluded"
        return
    gap = number(sum(_gaps_deg(assembly, contacts, bundle)), 3)
    yield f"a direction without a proof lies at most {gap} deg from the held directions"


def _gaps_deg(assembly: Assembly, contacts: ContactSet, bundle: Entry) -> tuple[float, float]:
    """Largest angle from the cone of the facets and equations to that of the rays and lines [deg].

    It is attained at a generator of the outer cone, since the distance is convex. A motion excludes
    the directions in which its power exceeds the power that a proof needs: the second angle is the
    largest by which these lie beyond their facet.
    """
    held = _directions(bundle, ("ray", "line"))
    normals, beyond = _excluded_sides(assembly, contacts, bundle)
    worst = 0.0
    for direction in _generators(assembly, normals):
        distance = nonnegative(held, direction)[1]
        worst = max(worst, float(np.arcsin(min(distance, 1.0))))
    return float(np.degrees(worst)), float(np.degrees(beyond))


def _directions(bundle: Entry, subjects: Sequence[str]) -> Array:
    """Unit directions of gravity of the proofs of these subjects, shape (n, 3).

    A proof by forces is for its direction, so a line counts with the signs that are proved.
    """
    found = [entry["change"]["down"] for entry in bundle["proofs"] if entry["about"] in subjects]
    return _unit(np.asarray(found, dtype=float).reshape(-1, 3))


def _excluded_sides(assembly: Assembly, contacts: ContactSet, bundle: Entry) -> tuple[Array, float]:
    """Inward normals of the half spaces of all directions that no motion excludes, shape (n, 3).

    Also the largest angle beyond these, up to which a motion has less power than it needs [rad].
    """
    program = build_program(assembly, contacts, possible=True)
    index = {name: k for k, name in enumerate(program.names)}
    normals, beyond = [], 0.0
    for entry in bundle["proofs"]:
        if STAYS[entry["about"]]:
            continue
        motion = np.zeros((len(index), 6))
        for name, six in entry["proof"]["motion"].items():
            if name in index:  # the motion of an unknown part is an objection to its own proof
                motion[index[name]] = six
        proof = check_motion(program.turned(np.asarray(entry["change"]["down"])), motion)
        gain = program.mass @ proof.motion[:, :3]
        size = max(float(np.linalg.norm(gain)), TINY)
        normals.append(-gain / size)
        # a motion without power excludes nothing
        needed = proof.power / proof.ratio / (size * program.g) if proof.ratio > 0 else 1.0
        beyond = max(beyond, float(np.arcsin(min(needed, 1.0))))
    return np.asarray(normals).reshape(-1, 3), beyond


def _generators(assembly: Assembly, normals: Array) -> Array:
    """Unit generators of the cone within inward normals, shapes (m, 3) and (n, 3)."""
    if assembly.planar:
        normals = np.vstack([normals, [[0.0, 1, 0], [0, -1, 0]]])
    if len(normals) == 0:
        return np.vstack([np.eye(3), -np.eye(3)])
    _, sizes, basis = np.linalg.svd(normals, full_matrices=True)
    rank = int((sizes > ON_BOUNDARY).sum())
    lines = basis[rank:]
    candidates = [lines, -lines]
    if rank == 1:
        candidates += [normals]
    elif rank == 2:
        candidates += [np.cross(lines[0], normals), -np.cross(lines[0], normals)]
    else:
        first, second = np.triu_indices(len(normals), 1)
        edges = np.cross(normals[first], normals[second])
        candidates += [edges, -edges]
    found = np.vstack(candidates)
    found = _unit(found[np.linalg.norm(found, axis=1) > ON_BOUNDARY])
    inside = np.ones(len(found), dtype=bool)
    for normal in normals:
        inside &= found @ normal >= -ON_BOUNDARY
    kept: Array = found[inside]
    return kept


def _unit(vectors: Array) -> Array:
    """The vectors, shape (n, 3), scaled to length 1."""
    unit: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=1), TINY)[:, None]
    return unit
