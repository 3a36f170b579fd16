"""A part whose mass and centre of mass are uncertain: the cases that decide for all of them.

The load of a part of mass m, whose centre is shifted by d, consists of m g at its middle and the
moment of m d. The loads that given contacts carry are a convex set, and

    {(m, m d) : m in [m_1, m_2], d in a rectangle D}  is the hull of  {(m_i, m_i d_j)},

where d_j are the corners of D. So a stack carries the part for each mass and centre within
the limits exactly if it carries it in each of these cases (equilibrium). The height of the centre
has no effect.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.assembly.masses import reweighed
from kilter.errors import InputError
from kilter.shape.primitives import Box
from kilter.validate import finite, number

__all__ = ["mass_limits", "part_cases"]

MOST_SHARE = 0.5
"""Largest shift of the centre of mass from the middle [sizes of the part]: it lies inside."""


def mass_limits(mass: float | Sequence[float] | None, part: Part) -> tuple[float, float]:
    """Least and largest mass of a part [kg].

    Raises `InputError` if a mass is not positive, or the limits are reversed.
    """
    if mass is None:
        return part.mass, part.mass
    if np.ndim(mass) == 0:
        value = number(mass, "mass", lowest=0, above=True)
        return value, value
    low, high = finite(mass, (2,), "mass").tolist()
    if not 0 < low <= high:
        raise InputError(
            f"the mass is {low:g} to {high:g} kg", hint="give the least, then the largest mass"
        )
    return low, high


def part_cases(part: Part, mass: tuple[float, float], center_within: float) -> list[Part]:
    """The part with each corner of its masses and centres of mass.

    Arguments: `mass`: least and largest mass [kg]; `center_within`: largest horizontal shift of the
    centre of mass along each axis of the part [sizes of the part along this axis]; a box has its
    own axes, another part those of the world.

    Examples
    --------
    >>> crate = Part("crate", Box([4, 2, 1]), mass=5)
    >>> [(case.mass, case.center_of_mass.tolist()) for case in part_cases(crate, (5, 5), 0.1)]
    ... # doctest: +NORMALIZE_WHITESPACE
    [(5.0, [-0.4, -0.2, 0.0]), (5.0, [-0.4, 0.2, 0.0]), (5.0, [0.4, -0.2, 0.0]),
     (5.0, [0.4, 0.2, 0.0])]
    """
    share = number(center_within, "center_within", lowest=0)
    if share >= MOST_SHARE:
        raise InputError(
            f"the centre of mass lies within {share:g} sizes of the middle",
            hint=f"give less than {MOST_SHARE:g}",
            option="give less than 50%",
        )
    masses = sorted(set(mass))
    if not share:
        return [reweighed(part, given_mass=value, density=None) for value in masses]
    geometry = Assembly([part]).geometry
    turned = part.pose.matrix
    own = turned.T @ (geometry.center[0] - np.asarray(part.pose.position))
    return [
        reweighed(part, given_mass=value, density=None, center_of_mass=own + turned.T @ shift)
        for value in masses
        for shift in _shifts(part, geometry.vertices, share)
    ]


def _shifts(part: Part, vertices: Array, share: float) -> list[Array]:
    """The corners of the shifts of a centre of mass, world frame, each of shape (3,)."""
    level: list[Array] = []
    if isinstance(part.shape, Box):
        axes = (part.pose.matrix * np.asarray(part.shape.size)).T
        level = [axis for axis in axes if abs(axis[2]) <= UPRIGHT * float(np.linalg.norm(axis))]
    if len(level) != 2:
        size = np.ptp(vertices, axis=0)
        level = [np.array([size[0], 0, 0]), np.array([0, size[1], 0])]
    return [
        share * (first * level[0] + second * level[1])
        for first, second in product((-1, 1), (-1, 1))
    ]


UPRIGHT = 1e-6
"""Largest slope of a side of a box that counts as horizontal [-]."""
