"""Compute masses, centres and second moments of parts, from shapes, densities and overrides."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask, ragged, starts
from kilter.assembly.inertia import inertia_matrix
from kilter.assembly.part import Part
from kilter.assembly.polyhedra import polyhedron_moments
from kilter.errors import some_names
from kilter.shape.primitives import Box, Cylinder, Sphere
from kilter.shape.solid import Solid
from kilter.units import metres_per_unit

__all__ = [
    "DEFAULT_DENSITY",
    "box_sizes",
    "density_warnings",
    "part_masses",
    "part_moments",
    "reweighed",
]

DEFAULT_DENSITY = 1000.0
"""Density of a part without density and mass [kg/m^3]."""


def part_moments(
    parts: Sequence[Part],
    boxes: Mask,
    local: tuple[Array, Index, Index, Index],
) -> tuple[Array, Array, Array, Array]:
    """Volume, centroid, second moment about it, and surface centroid of parts, in their frames.

    Boxes, cylinders and spheres are computed by closed forms.

    Arguments: `boxes` (N,): whether each part is a box; `local`: vertices, first vertex of each
    part, triangles, first triangle of each part.
    """
    vertices, _, triangles, triangle_start = local
    count = len(parts)
    volume, center = np.zeros(count), np.zeros((count, 3))
    second, area_center = np.zeros((count, 3, 3)), np.zeros((count, 3))
    if boxes.any():
        chosen = np.flatnonzero(boxes)
        sizes = box_sizes(parts, chosen)
        volume[chosen] = sizes.prod(axis=1)
        second[chosen[:, None], range(3), range(3)] = volume[chosen][:, None] * sizes**2 / 12
    chosen = np.flatnonzero(~boxes)
    if len(chosen):
        _, rows = ragged(triangle_start, chosen)
        start = starts(np.diff(triangle_start)[chosen])
        result = polyhedron_moments(vertices, triangles[rows], start)
        volume[chosen], center[chosen], second[chosen], area_center[chosen] = result
    for k in chosen.tolist():
        shape = parts[k].shape
        if isinstance(shape, Cylinder):
            volume[k] = np.pi * shape.radius**2 * shape.height
            moments = [shape.radius**2 / 4, shape.radius**2 / 4, shape.height**2 / 12]
        elif isinstance(shape, Sphere):
            volume[k] = 4 / 3 * np.pi * shape.radius**3
            moments = [shape.radius**2 / 5] * 3
        elif isinstance(shape, Solid):
            volume[k], center[k], second[k] = shape.volume, shape.centroid, shape.second_moment
            continue
        else:
            continue
        center[k], area_center[k] = 0.0, 0.0
        second[k] = volume[k] * np.diag(moments)
    return volume, center, second, area_center


def part_masses(
    parts: Sequence[Part],
    units: str,
    moments: tuple[Array, Array, Array],
    warnings: list[str],
) -> tuple[Array, Array, Array]:
    """Masses [kg], centres and mass-weighted second moments of parts; given values override.

    Arguments: `warnings`: a warning is appended if the default density is used beside given masses.
    """
    volume, center, second = moments
    cubic_metres = volume * metres_per_unit(units) ** 3
    density = np.array([part.density or DEFAULT_DENSITY for part in parts])
    given = np.array([part.given_mass is not None for part in parts])
    mass = density * cubic_metres
    mass[given] = [part.given_mass for part in parts if part.given_mass is not None]
    warnings += density_warnings(parts)
    second = second * (mass / volume)[:, None, None]
    center = center.copy()
    for k, part in enumerate(parts):
        if part.center_of_mass is not None:
            center[k] = part.center_of_mass
        if part.inertia is not None:
            inertia = inertia_matrix(part.inertia)
            second[k] = np.trace(inertia) / 2 * np.eye(3) - inertia
    return mass, center, second


def reweighed(part: Part, **changes: Any) -> Part:
    """A copy of a part with another mass or density; given inertia changes in proportion to mass.

    Examples
    --------
    >>> part = Part("bar", Box([1, 1, 1]), mass=2, inertia=[1, 1, 1, 0, 0, 0])
    >>> reweighed(part, mass=6).inertia.tolist()
    [3.0, 3.0, 3.0, 0.0, 0.0, 0.0]
    """
    if part.inertia is None:
        return dataclasses.replace(part, **changes)
    copy = dataclasses.replace(part, **changes, inertia=None)
    return dataclasses.replace(copy, inertia=part.inertia * (copy.mass / part.mass))


def density_warnings(parts: Sequence[Part]) -> list[str]:
    """The warning about the default density beside given masses; empty if it is not needed."""
    free = [part for part in parts if not part.grounded]
    without = [part for part in free if part.given_mass is None and part.density is None]
    assumed = [part.name for part in without]
    if len(assumed) in (0, len(free)):
        return []
    materials = [part.material for part in without if part.material]
    named = f" (material {some_names(list(dict.fromkeys(materials)))})" if materials else ""
    return [
        f"density {DEFAULT_DENSITY:g} kg/m^3 assumed for {some_names(assumed)}{named}, although "
        "other parts have a given mass or density: the verdict may depend on the ratios; "
        "--density sets it"
    ]


def box_sizes(parts: Sequence[Part], which: Index) -> Array:
    """Edge lengths along x, y, z of the boxes among the parts, by index `which`, shape (n, 3)."""
    shapes = (parts[k].shape for k in which.tolist())
    return np.array([shape.size for shape in shapes if isinstance(shape, Box)])
