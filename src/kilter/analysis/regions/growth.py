"""Compute a cone from queries to an oracle: first its span, then a hull inside it with its facets.

An oracle answers "how far does the cone reach in the direction c?" with a point of the cone
or with a witness that it does not reach there at all. The span grows by a dimension
whenever a direction orthogonal to it, of either sign, is reached; a direction that is not reached
is an equation. Inside the span every facet of the hull of the known points is examined in
turn: it is a facet of the cone, or there is a point beyond it. So every question finds a
point, a facet or a sign of an equation, and thin cones are found as surely as wide cones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kilter.analysis.regions.cone_hull import facets_of
from kilter.arrays import Array, unit_rows

WIDE = 0.1
"""A cone is truncated across the mean of its points if all their cosines to it exceed this [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Answer of an oracle in a unit direction c: the farthest unit point of the cone, with proofs.

    `angle`: c.g / |g| for the best g of the cone, 0 if there is no such g [rad]; `point`: that
    g, unit, shape (d,); `forces` that balance it; `witness`: multipliers that prove the bound.
    """

    angle: float
    point: Array
    forces: Array
    witness: Array


class Oracle(Protocol):
    """Oracle that describes a cone in R^d by its farthest points in given directions."""

    dimension: int

    def support(self, direction: Array) -> Reach:
        """Farthest direction of the cone along a unit direction, and the cosine between them."""

    def focus(self, axis: Array) -> None:
        """Truncate the cone by a plane across an axis; then farthest points are extreme rays."""


@dataclass(frozen=True, slots=True, eq=False)
class Grown:
    """A computed cone in R^d: basis of its span, points, equations and facets, with proofs."""

    span: Array
    """Orthonormal basis, shape (D, d)."""
    points: list[Reach]
    """Unit points of the cone, its rays among them."""
    equations: list[tuple[Array, Reach, Reach]]
    """Unit normals of the span, with the reach on either side, which is 0."""
    facets: list[tuple[Array, Reach]]
    """Unit inward normals within the span, with the reach beyond, which is 0."""


def grow(oracle: Oracle, first: Array, blur: float, tell: Callable[[], None]) -> Grown:
    """Compute the span and the facets of a cone from queries to its oracle.

    Arguments: `first` (d,): a direction to ask first; `blur`: the cone does not reach a direction
    if its reach is less than this [rad].
    """
    span, points, equations = _span(oracle, first, blur, tell)
    facets = _close(oracle, span, points, blur, tell)
    return Grown(span, points, equations, facets)


def _span(
    oracle: Oracle, first: Array, blur: float, tell: Callable[[], None]
) -> tuple[Array, list[Reach], list[tuple[Array, Reach, Reach]]]:
    """Orthonormal basis of a cone's span, points of the cone that span it, and its equations.

    The equations come with their proofs.
    """
    span = np.empty((0, oracle.dimension))
    points: list[Reach] = []
    equations: list[tuple[Array, Reach, Reach]] = []
    while len(span) + len(equations) < oracle.dimension:
        known = np.vstack([span, *[e[None] for e, _, _ in equations]])
        direction = _orthogonal_unit(known, first)
        sides = []
        for sign in (1.0, -1.0):
            tell()
            sides.append(oracle.support(sign * direction))
        reached = [side for side in sides if side.angle > blur]
        if not reached:
            equations.append((direction, sides[0], sides[1]))
            continue
        points += [side for side in reached if _is_new(side, points, blur)]
        farthest = max(reached, key=lambda side: side.angle).point
        span = np.vstack([span, _orthogonal_part(known, farthest)])
    return span, points, equations


def _orthogonal_unit(known: Array, first: Array) -> Array:
    """A unit vector orthogonal to the rows `known`; near `first` unless that is in their span."""
    rest = first - known.T @ (known @ first)
    if np.linalg.norm(rest) > 0.1:
        return _orthogonal_part(known, rest)
    _, _, vectors = np.linalg.svd(np.vstack([known, np.zeros((1, known.shape[1]))]))
    return _orthogonal_part(known, vectors[len(known)])


def _orthogonal_part(known: Array, vector: Array) -> Array:
    """Component of a vector orthogonal to the orthonormal rows `known`, scaled to length 1."""
    for _ in range(2):
        vector = vector - known.T @ (known @ vector)
        vector = vector / np.linalg.norm(vector)
    return vector


def _is_new(reach: Reach, points: list[Reach], blur: float) -> bool:
    return all(np.linalg.norm(reach.point - other.point) > blur for other in points)


def _close(
    oracle: Oracle, span: Array, points: list[Reach], blur: float, tell: Callable[[], None]
) -> list[tuple[Array, Reach]]:
    """Facets of a cone within its span, with proofs; every extreme ray is added to `points`."""
    if not len(span):
        return []
    _focus(oracle, points)
    proved: list[tuple[Array, Reach]] = []
    held: list[frozenset[int]] = []
    while True:
        inside = _span_coordinates(span, points)
        normals, tight = facets_of(inside, blur)
        sets = [frozenset(np.flatnonzero(row).tolist()) for row in tight]
        # a proved facet holds all the points that an unknown one does not
        unknown = [
            k for k, members in enumerate(sets) if not any(members <= other for other in held)
        ]
        if not unknown:
            break
        q, members = normals[unknown[0]], sets[unknown[0]]
        tell()
        reach = oracle.support(-(q @ span))
        if reach.angle > blur and _is_new(reach, points, blur):
            points.append(reach)
        else:
            proved.append((q, reach))
            held.append(members)
    chosen = [_match(q, proved) for q in normals]
    return [(q @ span, reach) for q, reach in zip(normals, chosen, strict=True)]


def _match(normal: Array, proved: list[tuple[Array, Reach]]) -> Reach:
    """The oracle's answer for the proved facet whose normal is nearest to `normal`."""
    return max(proved, key=lambda entry: float(entry[0] @ normal))[1]


def _focus(oracle: Oracle, points: list[Reach]) -> None:
    """Truncate the cone across the mean of its points, if all points are near the mean."""
    rows = np.array([reach.point for reach in points])
    mean = rows.mean(axis=0)
    length = float(np.linalg.norm(mean))
    if length > WIDE and (rows @ mean / length).min() > WIDE:
        oracle.focus(mean / length)


def _span_coordinates(span: Array, points: list[Reach]) -> Array:
    """Unit coordinates, shape (n, D), of given points in the basis of the cone's span."""
    return unit_rows(np.array([reach.point for reach in points]) @ span.T)
