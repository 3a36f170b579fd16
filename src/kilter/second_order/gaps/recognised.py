"""Second derivatives of gaps that are valid for every surface that a mesh may represent.

A surface that was recognised in a mesh is a sphere, cylinder, cone or torus through its contact
points and across their normals. Its curvature there is only known within bounds. The form

    psi = min 2 sigma.s + s.B s + u.A u

grows with A and B. So no gap has a greater second derivative than with all curvatures at their
upper bounds, and none has a smaller one than at their lower bounds, if the surfaces separate there
too. Contact forces push, hence

    minimum     forces that curve the energy upward at the upper bounds do so for every surface
    balanced    a path that opens all gaps and falls at the lower bounds does so for every surface

Free motions are free for every surface of the same kind, so they are divided out first.
`searches.every_surface` decides by these bounds; this module uses no solver.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kilter.arrays import Array, Mask
from kilter.assembly import Joint
from kilter.mechanics.program import Program
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.gaps.joint_forms import of_joints
from kilter.second_order.gaps.stationary import Stationary, problem_of

__all__ = ["bounded", "formed_for_all"]


def formed_for_all(program: Program, features: Features) -> Mask:
    """Mask of rows whose gap has a second derivative whatever the true surfaces are, (K,)."""
    rows = formed(program, features)
    if features.doubted:
        rows &= formed(program, _bent(features, program.normal, -1.0))
    return rows | of_joints(program)


def bounded(
    program: Program, features: Features, sense: float, joints: Sequence[Joint] = ()
) -> Stationary:
    """Gaps and load to second order, at the upper (1) or lower (-1) bounds of curvature."""
    bent = _bent(features, program.normal, sense)
    return problem_of(program, bent, joints)


def _bent(features: Features, normal: Array, sense: float) -> Features:
    """Copy of the features with each curvature moved to its upper or lower bound."""
    plane = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    return replace(
        features,
        curvature_a=features.curvature_a + sense * features.doubt_a[:, None, None] * plane,
        curvature_b=features.curvature_b + sense * features.doubt_b[:, None, None] * plane,
    )
