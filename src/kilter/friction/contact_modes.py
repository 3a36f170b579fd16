"""Contact modes: which case of the law a relaxed motion breaks most, and the cases to try.

At a point p the law asks un fn = 0, in a patch the sum of ft.ut + mu N |ut| over its groups to
be 0. Both are powers, not negative, and their sum is what a relaxed motion gains beyond what
the law allows. The largest is branched on:

    a point          touches (un = 0)  |  bears no force (fn = 0)
    a patch          sticks (t = 0)  |  its twist t lies in one of the 2^d orthants
    a patch in a cone                   the cone halved

Modes belong to patches, not to points: all groups of a patch share its twist, so one cone
tells the direction of sliding of each. The cases cover every solution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.friction.contact_law import ContactLaw
from kilter.friction.enclosure import Enclosure, apart, in_cone, touching
from kilter.friction.relaxation import Relaxation
from kilter.friction.twist_cones import STICK, halves, orthants, width

__all__ = ["Breach", "breach", "cases"]


NARROW = 1e-3
"""A cone of twists that is narrower than this is not halved [rad]."""


@dataclass(frozen=True, slots=True)
class Breach:
    """Where a relaxed motion breaks the law most.

    `point` or `patch` (-1: not that), the power that it gains there, and in all; forces and
    motions in units of the enclosure.
    """

    point: int
    patch: int
    largest: float
    total: float


def breach(law: ContactLaw, relaxation: Relaxation, bounds: Enclosure, x: Array) -> Breach:
    """Where the law is broken most, among what can still be branched on."""
    parts = relaxation.parts(x)
    normal = np.maximum(parts["fn"], 0.0) * np.maximum(parts["un"], 0.0)
    ft, ut = (parts[name].reshape(-1, law.directions) for name in ("ft", "ut"))
    speed = np.linalg.norm(ut, axis=1)
    loss = np.maximum((ft * ut).sum(axis=1) + law.mu * parts["total"] * speed, 0.0)
    slide = np.bincount(law.patch, loss, minlength=len(law.twist))
    total = float(normal.sum() + slide.sum())
    for patch, cone in enumerate(bounds.cones):
        narrow = cone is not None and (not cone.size or width(cone) < NARROW)
        slide[patch] = 0.0 if narrow else slide[patch]
    point = int(normal.argmax()) if len(normal) else -1
    patch = int(slide.argmax()) if len(slide) else -1
    most = float(normal[point]) if point >= 0 else 0.0
    slid = float(slide[patch]) if patch >= 0 else 0.0
    if most >= slid:
        return Breach(point, -1, most, total)
    return Breach(-1, patch, slid, total)


def cases(law: ContactLaw, bounds: Enclosure, where: Breach) -> list[Enclosure]:
    """The cases of a point or of a patch."""
    if where.point >= 0:
        return [touching(bounds, where.point), apart(bounds, where.point)]
    cone = bounds.cones[where.patch]
    size = law.twist[where.patch].shape[0]
    cones = halves(cone) if cone is not None else [STICK, *orthants(size)]
    return [in_cone(law, bounds, where.patch, cone) for cone in cones]
