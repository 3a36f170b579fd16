"""Figures 2 and 3 of the paper: kinds of contact, each as the smallest assembly that has it.

The paper draws the two bodies m and n without dimensions, held parts or gravity. Assumed here: n is
held, m lies on n under gravity along -z, the contact is horizontal, and m is above its contact.

References
----------
Mattikalli, Khosla, Repetto and Baraff (1993), Stability of Assemblies, Figures 2 and 3.
"""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly, GivenContact, Part
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.scenes.pieces import block, prism
from kilter.scenes.registry import listed
from kilter.shape.primitives import Mesh, Prism

__all__ = ["figure_2", "figure_3"]

QUARTER = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
"""Quaternion of a quarter turn about z."""


@listed(
    "paper-figure-2",
    "a body on a held body, in contact along a segment ab",
    source="F2",
    answer="stable",
)
def figure_2() -> Assembly:
    """Figure 2 of the paper: bodies m and n touch over a segment, here from x = -1 to x = 1.

    Two constraint inequalities, at a and at b, keep m out of n in the plane.
    """
    n = block("n", [-2, -0.5, -1], [2, 0.5, 0])
    m = block("m", [-1, -0.5, 0], [1, 0.5, 1])
    return Assembly([Part("n", n.shape, n.pose, grounded=True), m], planar=True)


@listed(
    "paper-figure-3-plane",
    "two vertices that meet, with a plane assumed for their contact",
    source="F3(d)",
    answer="potentially-stable",
    kind="d",
)
@listed(
    "paper-figure-3-vertices",
    "two vertices that meet have no normal: the upper body slides off",
    source="F3(c)",
    answer="unstable",
    kind="c",
)
@listed(
    "paper-figure-3-edges",
    "an edge across a held edge: the slightest push makes it fall",
    source="F3(b)",
    answer="balanced",
    kind="b",
)
@listed(
    "paper-figure-3",
    "a polygonal contact, with a constraint at each of its five corners",
    source="F3(a)",
    answer="stable",
)
def figure_3(kind: str = "a") -> Assembly:
    """Figure 3 of the paper: contact over a polygon "a", of crossing edges "b", of vertices "c".

    (a) has five corners, as in the paper; a regular pentagon is assumed. In (b) the edges are
    perpendicular. The contact (c) has no normal of its own: m may slide off along any plane between
    the vertices, so that the assembly is unstable. The paper assumes a plane for it in "d"; here
    the plane is horizontal.
    """
    if kind == "a":
        angles = np.pi / 2 + 2 * np.pi * np.arange(5) / 5
        pentagon = np.column_stack([np.cos(angles), np.sin(angles)])
        lying = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]  # the prism along y stands up
        m = Part("m", Prism(pentagon, 1.0), Pose([0, 0, 0.5], lying))
        n = block("n", [-2, -2, -1], [2, 2, 0])
        return Assembly([Part("n", n.shape, n.pose, grounded=True), m])
    if kind == "b":
        ridge = prism("n", [[-1, -1], [1, -1], [0, 0]], 3.0, grounded=True)
        wedge = Prism([[0, 0], [1, 1], [-1, 1]], 3.0)
        return Assembly([ridge, Part("m", wedge, Pose(rotation=QUARTER))])
    if kind in ("c", "d"):
        angles = 2 * np.pi * np.arange(3) / 3
        base = np.column_stack([np.cos(angles), np.sin(angles), -np.ones(3)])
        corners = np.vstack([base, np.zeros(3)])
        faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        m = Part("m", Mesh(corners * [1, -1, -1], faces))
        plane = [GivenContact(("n", "m"), [[0, 0, 0]], [0, 0, 1])] if kind == "d" else []
        return Assembly([Part("n", Mesh(corners, faces), grounded=True), m], contacts=plane)
    raise InputError(f"Figure 3 has no contact {kind!r:.20}", hint="give 'a', 'b', 'c' or 'd'")
