"""Arches of voussoirs with radial joints, in the x-z plane, centre of the circle at the origin.

Voussoir k lies between joint k and k + 1, counted from the right springing; its sides are
straight, so inside and outside are polygons inscribed in the circles. A ring sector of
angle 2 h between radii a < b has the area h (b^2 - a^2) and its centroid at the radius

    (2/3) (b^3 - a^3) / (b^2 - a^2) sin(h) / h
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.scenes.pieces import prism
from kilter.scenes.registry import listed

DENSITY = 1000.0
"""Density of the voussoirs [kg/m^3]."""


def voussoirs(
    joints: Array, inner: float, outer: float, *, depth: float = 1.0, sectors: bool = False
) -> list[Part]:
    """Build the blocks "voussoir-0", ... of an arch between joints at given angles from +x [rad].

    Arguments: `joints` (n + 1,): angles of the joints, ascending [rad]; `inner`, `outer`: radii
    [length unit]; `depth`: extent along y [length unit]; `sectors`: give the parts the mass and
    centre of mass of ring sectors instead of polyhedra.
    """
    spoke = np.column_stack([np.cos(joints), np.sin(joints)])
    spoke[np.abs(spoke) < 1e-15] = 0.0
    middles, halves = (joints[1:] + joints[:-1]) / 2, np.diff(joints) / 2
    parts = []
    for k, (middle, half) in enumerate(zip(middles, halves, strict=True)):
        quad = [inner * spoke[k], outer * spoke[k], outer * spoke[k + 1], inner * spoke[k + 1]]
        given: dict[str, Any] = {"density": DENSITY}
        if sectors:
            radius = 2 / 3 * (outer**3 - inner**3) / (outer**2 - inner**2) * np.sin(half) / half
            given = {
                "mass": DENSITY * half * (outer**2 - inner**2) * depth,
                "center_of_mass": [radius * np.cos(middle), 0.0, radius * np.sin(middle)],
            }
        parts.append(prism(f"voussoir-{k}", quad, depth, **given))
    return parts


@listed("arch", "a semicircular arch of 20 voussoirs", source="A1", answer="stable")
def arch(
    count: int = 20,
    *,
    ratio: float = 0.15,
    radius: float = 10.0,
    span: float = 180.0,
    friction: float = 0.7,
    sectors: bool = False,
    planar: bool = True,
) -> Assembly:
    """Cases A1, A2, A4: an arch on two held springers; least thickness 0.1075 of the radius.

    Parameters
    ----------
    count : int
        Number of voussoirs.
    ratio : float
        Thickness / centre-line radius [-].
    radius : float
        Radius of the centre line [m].
    span : float
        Angle of the arch [deg], symmetric about +z; at most 180.
    friction : float
        Friction coefficient [-].
    sectors : bool
        Masses of ring sectors instead of polyhedra. The least ratio for 20 voussoirs is 0.10746
        with sectors and 0.10735 with polyhedra.
    planar : bool
        Motions in the x-z plane only.

    Examples
    --------
    >>> heavy, light = (arch(8, sectors=s).geometry.mass[-1] for s in (True, False))
    >>> bool(heavy > light)
    True
    """
    if not (0 < span <= 180 and 0 < ratio < 2 and count >= 1):
        raise InputError(
            f"no arch has {count} voussoirs, ratio {ratio:g} and span {span:g} deg",
            hint="give 1 or more voussoirs, a ratio between 0 and 2, a span of up to 180 deg",
        )
    inner, outer = radius * (1 - ratio / 2), radius * (1 + ratio / 2)
    joints = np.pi / 2 + np.radians(span) * (np.arange(count + 1) / count - 0.5)
    parts = voussoirs(joints, inner, outer, sectors=sectors)
    held = [
        _springer("springer-right", joints[0], inner, outer, right=True),
        _springer("springer-left", joints[-1], inner, outer, right=False),
    ]
    return Assembly([*held, *parts], friction=friction, planar=planar)


def oppenheim_arch(count: int = 7, *, sectors: bool = False, friction: float = 10.0) -> Assembly:
    """Case A3: an arch of 157.5 degrees, thickness 0.15 of the radius, with a known load factor.

    The factor for a horizontal body force, without sliding and for 7 voussoirs, is 0.373612
    (0.370010 with sectors).
    """
    return arch(count, ratio=0.15, span=157.5, friction=friction, sectors=sectors)


@listed(
    "arch-with-held-ends",
    "a semicircular arch whose first and last voussoir are held",
    source="W6",
    answer="settles",
)
def arch_with_held_ends(
    count: int = 12, *, thickness: float = 1.0, inner: float = 5.0, friction: float = 0.7
) -> Assembly:
    """Case W6: a semicircular arch in 3D whose first and last voussoir are held.

    Equilibrium exists for 12 voussoirs at thickness 0.5, 1, 2; 20 at 0.5, 2; 6 at 2.
    """
    joints = np.pi * np.arange(count + 1) / count
    parts = voussoirs(joints, inner, inner + thickness)
    for k in (0, count - 1):
        parts[k] = dataclasses.replace(parts[k], grounded=True)
    return Assembly(parts, friction=friction)


def _springer(name: str, angle: float, inner: float, outer: float, *, right: bool) -> Part:
    """A held block below an arch, with a face in the joint at `angle` [rad] that is wider."""
    spoke = np.array([np.cos(angle), np.sin(angle)])
    spoke[np.abs(spoke) < 1e-15] = 0.0
    away = np.array([spoke[1], -spoke[0]]) * (1.0 if right else -1.0)
    past = (outer - inner) / 2
    low, high = (inner - past) * spoke, (outer + past) * spoke
    thick = 2 * past * away
    return prism(name, [low, high, high + thick, low + thick], grounded=True)
