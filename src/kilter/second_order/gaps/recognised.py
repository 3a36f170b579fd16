"""What holds for every surface that a mesh may stand for.

A sphere, cylinder, cone or torus that was recognised in a mesh is one of its kind, through the
points of contact and across their normals; how it curves there is known to a doubt. The form

    psi = min 2 sigma.s + s.B s + u.A u

grows with A and B, so that with all curvatures at their upper bounds no gap has a greater second
derivative, and at their lower bounds none a less, if the surfaces part there too. Forces push, so

    minimum     its forces curve the energy upward with the upper bounds: so they do with any
    balanced    its path opens all gaps and falls with the lower bounds: so it does with any

Motions that are free are so of every surface of its kind: they are divided out first. What is
decided so is in `kilter.second_order.searches.every_surface`; nothing here needs a solver.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array, Mask
from kilter.mechanics.program import Program
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.gaps.stationary import Stationary, problem_of

__all__ = ["bounded", "formed_for_all"]


def formed_for_all(program: Program, features: Features) -> Mask:
    """Rows whose gap has a second derivative whatever the surfaces within their doubt."""
    found = formed(program, features)
    if features.doubted:
        found &= formed(program, _bent(features, program.normal, -1.0))
    return found


def bounded(program: Program, features: Features, sense: float) -> Stationary:
    """The place with the upper (1) or lower (-1) bounds of all curvatures."""
    bent = _bent(features, program.normal, sense)
    return problem_of(program, bent)


def _bent(features: Features, normal: Array, sense: float) -> Features:
    """With every curvature off by its doubt, in all directions of the tangent plane."""
    plane = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    return replace(
        features,
        curvature_a=features.curvature_a + sense * features.doubt_a[:, None, None] * plane,
        curvature_b=features.curvature_b + sense * features.doubt_b[:, None, None] * plane,
    )
