"""Second derivative of a contact gap by the motions of both parts, by a single formula.

Part i moves by x -> c_i + r_i + exp(theta_i) (x - c_i). With n from a to b, p_i = x - c_i,
v_i = r_i + theta_i x p_i, v = v_b - v_a, v_t its tangential part, sigma = n x (theta_b - theta_a),
the features' tangent directions T_i and curvatures A (of a) and B (of b), the gap is

    phi   = n . v + phi'' / 2 + O(3)
    phi'' = n . (theta_b x (theta_b x p_b)) - n . (theta_a x (theta_a x p_a))
            + 2 (theta_a x n) . v + psi
    psi   = min 2 sigma . s + s . B s + u . A u   over s in T_b with u = s + v_t in T_a:

s is the path of the contact point on b, and u its path on a. The minimiser is linear in
(sigma, v_t): it solves a symmetric system of six unknowns for each contact, the step s and the two
multipliers of each constraint. N_i projects the tangent plane onto the complement of T_i, and
P_i = I - N_i:

    [A + B   N_b    N_a ] [s   ]     [sigma + A v_t]
    [N_b    -P_b     0  ] [mu_b] = - [      0      ]
    [N_a      0    -P_a ] [mu_a]     [  N_a v_t    ]

Each lower row states its constraint on the range of N, and a multiplier of zero on that of P.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, across
from kilter.mechanics.program import Program
from kilter.rigid import skew
from kilter.second_order.gaps.features import EDGE, FACE, Features
from kilter.second_order.second_order_tolerances import CROSSING, ROUND


def gap_forms(program: Program, features: Features) -> Array:
    """Second derivatives of the gap of each row, as symmetric matrices, shape (K, 12, 12).

    The unknowns are (r_a, theta_a, r_b, theta_b) about the centres of mass [length unit, rad], in
    the world frame. The first derivative is `Program.lever` of b minus that of a. The caller leaves
    out the columns of held parts and of the ground.

    Returns (K, 12, 12): not a number for rows without a form (`formed`).
    """
    result = np.full((len(features), 12, 12), np.nan)
    rows = np.flatnonzero(formed(program, features))
    if len(rows):
        result[rows] = _forms(program, features.take(rows), rows)
    return result


def formed(program: Program, features: Features) -> Mask:
    """Mask of the rows whose gap has a known second derivative, shape (K,).

    Both features are known, and together they span the tangent plane (unlike an edge along an edge
    or a vertex on a vertex). In the directions in which both extend the surfaces separate: the sum
    of the curvatures is positive, relative to the larger of them and to the size of the smaller
    part. This is not required along a fibre or of conformal points.
    """
    frame = _frame(program.normal)
    span_a, span_b = _spans(features, frame)
    extent = span_a.trace(axis1=1, axis2=2), span_b.trace(axis1=1, axis2=2)
    crossing = np.linalg.eigvalsh(span_a + span_b)[:, 0] > 1 - np.cos(CROSSING)
    common = np.where(
        (extent[0] > EDGE + 0.5)[:, None, None],
        span_b,
        np.where((extent[1] > EDGE + 0.5)[:, None, None], span_a, 0.0),
    )
    a, b = _curvatures(features, frame, span_a, span_b)
    size = np.append(program.radius, np.inf)  # the ground is the last
    scale = 1 / np.minimum(size[program.part_a], size[program.part_b])
    scale = np.maximum(scale, np.maximum(np.abs(a).max(axis=(1, 2)), np.abs(b).max(axis=(1, 2))))
    filled = (np.eye(2) - common) * scale[:, None, None]
    apart = common @ (a + b) @ common + filled
    rounded = np.linalg.eigvalsh(apart)[:, 0] > ROUND * scale
    result: Mask = ~features.open & crossing & rounded
    return result


def _forms(program: Program, features: Features, rows: Index) -> Array:
    """Second derivatives as in `gap_forms`, for rows that have them, shape (k, 12, 12)."""
    normal, frame = program.normal[rows], _frame(program.normal[rows])
    arm_a, arm_b = arms_of(program, rows)
    slip, turn = relative_motion(arm_a, arm_b)
    form = np.zeros((len(rows), 12, 12))
    form[:, 3:6] += skew(normal) @ slip
    form += form.swapaxes(1, 2).copy()
    form[:, 3:6, 3:6] -= swing(normal, arm_a)
    form[:, 9:, 9:] += swing(normal, arm_b)
    tangential = np.concatenate([frame @ skew(normal) @ turn, frame @ slip], axis=1)
    form += tangential.swapaxes(1, 2) @ _rolling(features, frame) @ tangential
    result: Array = (form + form.swapaxes(1, 2)) / 2
    return result


def corner_slips(program: Program, features: Features) -> Array:
    """Matrices from part motions to turn and slip at corners on edges of both parts, (K, 4, 12).

    If two faces end together, the corner of b touches the face of a as long as it stays on it: the
    form of the row is that of this gap. If it has slipped off, the corner of a touches the face of
    b instead. The parts are apart if either gap is open, and the second gap curves more by

        -2 sigma . v_t

    with the turn sigma (rows 0 and 1) and the slip v_t (rows 2 and 3) in a frame across the normal.
    If lines of contact end together, both are taken along the line only. Both are 0 for all other
    rows.
    """
    result = np.zeros((len(features), 4, 12))
    rows = np.flatnonzero(features.flush)
    if len(rows):
        slip, turn = relative_motion(*arms_of(program, rows))
        normal, frame = program.normal[rows], _frame(program.normal[rows])
        fibre = features.fibre[rows]
        line = fibre[:, :, None] * fibre[:, None, :]
        ends = np.linalg.norm(fibre, axis=1) > 0
        along = np.where(ends[:, None, None], line, np.eye(3))
        result[rows] = np.concatenate(
            [frame @ along @ skew(normal) @ turn, frame @ along @ slip], 1
        )
    return result


def arms_of(program: Program, rows: Index) -> tuple[Array, Array]:
    """Vectors from the centres of mass of parts a and b to the contact points, (k, 3) each."""
    center = np.vstack([program.center, np.zeros(3)])  # the ground is the last
    point = program.point[rows]
    return point - center[program.part_a[rows]], point - center[program.part_b[rows]]


def relative_motion(arm_a: Array, arm_b: Array) -> tuple[Array, Array]:
    """Matrices from motions of both parts to slip and turn of part b past part a, (k, 3, 12)."""
    eye, none = np.tile(np.eye(3), (len(arm_a), 1, 1)), np.zeros((len(arm_a), 3, 3))
    slip = np.concatenate([-eye, skew(arm_a), eye, -skew(arm_b)], axis=2)
    return slip, np.concatenate([none, -eye, none, eye], axis=2)


def _frame(normal: Array) -> Array:
    """Two orthonormal tangent vectors for each normal, shape (K, 2, 3)."""
    return np.stack(across(normal), axis=1)


def swing(normal: Array, arm: Array) -> Array:
    """Matrix of the quadratic form n . (theta x (theta x p)) in theta, shape (K, 3, 3)."""
    product = normal[:, :, None] * arm[:, None, :]
    along = np.einsum("ki,ki->k", normal, arm)
    form: Array = (product + product.swapaxes(1, 2)) / 2 - along[:, None, None] * np.eye(3)
    return form


def _spans(features: Features, frame: Array) -> tuple[Array, Array]:
    """Projectors on the tangent directions in which each feature extends, (K, 2, 2) each.

    A face extends in both directions, an edge along itself, and a vertex in none.
    """
    spans = []
    for kind, edge in ((features.kind_a, features.edge_a), (features.kind_b, features.edge_b)):
        along = np.einsum("kij,kj->ki", frame, edge)
        line = along[:, :, None] * along[:, None, :]
        full = np.where((kind == FACE)[:, None, None], np.eye(2), 0.0)
        spans.append(np.where((kind == EDGE)[:, None, None], line, full))
    span_a, span_b = spans
    fibre = np.einsum("kij,kj->ki", frame, features.fibre)
    off = np.eye(2) - fibre[:, :, None] * fibre[:, None, :]
    span_b = np.where(features.conformal[:, None, None], 0.0, off @ span_b @ off)
    return span_a, span_b


def _curvatures(
    features: Features, frame: Array, span_a: Array, span_b: Array
) -> tuple[Array, Array]:
    """Curvatures of both features in the tangent frame, shape (K, 2, 2) each."""
    across_ = frame.swapaxes(1, 2)
    a = span_a @ frame @ features.curvature_a @ across_ @ span_a
    b = span_b @ frame @ features.curvature_b @ across_ @ span_b
    return a, b


def _rolling(features: Features, frame: Array) -> Array:
    """Matrix of the rolling term in the variables (turn, slip) of each row, shape (K, 4, 4)."""
    span_a, span_b = _spans(features, frame)
    a, b = _curvatures(features, frame, span_a, span_b)
    scale = np.maximum(np.abs(a).max(axis=(1, 2)), np.abs(b).max(axis=(1, 2)))
    scale = np.where(scale > 0, scale, 1.0)[:, None, None]  # so that the system has no unit
    eye, none = np.eye(2), np.zeros_like(a)
    off_a, off_b = eye - span_a, eye - span_b
    system = np.block(
        [[(a + b) / scale, off_b, off_a], [off_b, -span_b, none], [off_a, none, -span_a]]
    )
    whole = np.broadcast_to(eye, a.shape)
    right = np.block([[-whole / scale, -a / scale], [none, none], [none, -off_a]])
    on_b = np.linalg.solve(system, right)[:, :2]
    on_a = on_b + np.block([none, whole])
    lag = np.concatenate([on_b, np.zeros_like(on_b)], axis=1)  # sigma . s
    up = on_b.swapaxes(1, 2) @ b @ on_b + on_a.swapaxes(1, 2) @ a @ on_a
    form: Array = lag + lag.swapaxes(1, 2) + up
    return form
