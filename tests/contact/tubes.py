"""Tubes with an exact bore, and pins for them."""

from __future__ import annotations

import numpy as np

from kilter.assembly import Part
from kilter.rigid import Pose
from kilter.shape.primitives import Cylinder
from kilter.shape.solid import Solid, Surface

__all__ = ["pin", "tube"]


def pin(name, radius, height, at=(0, 0, 0), **options):
    """A solid cylinder about z."""
    return Part(name, Cylinder(radius, height), Pose(at), **options)


def tube(name, bore, outer, height, at=(0, 0, 0), sides=48, **options):
    """A tube about z, its bore and its outside exact cylinders."""
    angle = np.arange(sides) * (2 * np.pi / sides)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    rings = [
        np.column_stack([radius * circle, np.full(sides, z)])
        for radius in (bore, outer)
        for z in (-height / 2, height / 2)
    ]
    k, j = np.arange(sides), (np.arange(sides) + 1) % sides
    low_in, high_in, low_out, high_out = (k + n * sides for n in range(4))
    a, b, c, d = (j + n * sides for n in range(4))
    quads = [
        (low_in, high_in, b, a),  # the bore, its normals inwards
        (low_out, c, d, high_out),
        (high_in, high_out, d, b),
        (low_in, a, c, low_out),
    ]
    triangles = np.concatenate(
        [np.column_stack(three) for p, q, r, s in quads for three in ((p, q, r), (p, r, s))]
    )
    surface = np.repeat([0, 1, -1, -1], 2 * sides)
    area = np.pi * (outer**2 - bore**2)
    volume = area * height
    across = volume * ((outer**2 + bore**2) / 4)
    faces = [
        Surface("cylinder", [0, 0, 0], [0, 0, 1], radius=bore, hollow=True),
        Surface("cylinder", [0, 0, 0], [0, 0, 1], radius=outer),
    ]
    solid = Solid(
        np.concatenate(rings),
        triangles,
        tuple(faces),
        surface,
        volume,
        [0, 0, 0],
        np.diag([across, across, volume * height**2 / 12]),
        sagitta=outer * (1 - np.cos(np.pi / sides)),
    )
    return Part(name, solid, Pose(at), **options)
