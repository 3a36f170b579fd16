"""Second-order cones x_0 >= |x_1..| as arrays, and their Nesterov-Todd scaling.

Points are columns, shape (d, K), of K cones in d dimensions. With d = 1 they are half lines, and
the same formulas hold. The scaling W of a pair x, s of inner points is the symmetric map with

    W s = W^-1 x = lambda,    W = eta V,  V^2 = 2 w w^T - J,  J = diag(1, -1, .., -1)

References
----------
Y. Nesterov, M. Todd, Self-scaled barriers and interior-point methods for convex programming, 1997.
L. Vandenberghe, The CVXOPT linear and quadratic cone program solvers, 2010.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array


def depth(x: Array) -> Array:
    """Distance measure x_0 - |x_1..| of each point in its cone, shape (K,); negative outside."""
    within: Array = x[0] - np.sqrt((x[1:] ** 2).sum(axis=0))
    return within


def _determinant(x: Array) -> Array:
    """Value x_0^2 - |x_1..|^2 of points inside second-order cones, at least `TINY`, shape (K,).

    It is computed as a product, which avoids the cancellation of the squares near the boundary.
    """
    length = np.sqrt((x[1:] ** 2).sum(axis=0))
    determinant: Array = np.maximum((x[0] - length) * (x[0] + length), TINY)
    return determinant


def product(x: Array, y: Array) -> Array:
    """Jordan product of points of second-order cones: (x.y, x_0 y_1.. + y_0 x_1..)."""
    result: Array = x[0] * y + y[0] * x
    result[0] = (x * y).sum(axis=0)
    return result


def divided(x: Array, y: Array) -> Array:
    """Jordan quotient in second-order cones: the z with product(x, z) = y.

    Examples
    --------
    >>> x, z = np.array([[3.0], [1.0], [2.0]]), np.array([[1.0], [-1.0], [4.0]])
    >>> divided(x, product(x, z)).ravel()
    array([ 1., -1.,  4.])
    """
    result = np.empty_like(y)
    result[0] = (x[0] * y[0] - (x[1:] * y[1:]).sum(axis=0)) / _determinant(x)
    result[1:] = (y[1:] - x[1:] * result[0]) / x[0]
    return result


def reach(x: Array, step: Array) -> float:
    """Largest t at which every x + t step is in its second-order cone, for x inside.

    Examples
    --------
    >>> reach(np.array([[2.0], [0.0]]), np.array([[0.0], [1.0]]))
    2.0
    """
    return float(reaches(x, step).min(initial=np.inf))


def reaches(x: Array, step: Array) -> Array:
    """Largest t of each group of cones, as `reach`; the last axis lists the cones of a group.

    Points and steps have the shape (d, ..., K), and the result (...).

    Examples
    --------
    >>> reaches(np.ones((1, 2, 1)), np.array([[[-1.0], [-2.0]]]))
    array([1. , 0.5])
    """
    a = step[0] ** 2 - (step[1:] ** 2).sum(axis=0)
    b = x[0] * step[0] - (x[1:] * step[1:]).sum(axis=0)
    c = _determinant(x)
    discriminant = b * b - a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        # the first positive root of a t^2 + 2 b t + c = 0, in the form without cancellation
        root = c / (np.sqrt(np.maximum(discriminant, 0.0)) - b)
        leaves = (discriminant >= 0) & ((b < 0) | (a < 0)) & (root > 0)
        # beyond the apex the quadratic is positive again: x_0 must also stay positive
        axis_limit = np.where(step[0] < 0, -x[0] / step[0], np.inf)
    limit: Array = np.minimum(np.where(leaves, root, np.inf), axis_limit).min(
        axis=-1, initial=np.inf
    )
    return limit


@dataclass(frozen=True, slots=True, eq=False)
class Scaling:
    """Nesterov-Todd scaling W of pairs of points inside second-order cones: W s = W^-1 x.

    Examples
    --------
    >>> x, s = np.array([[3.0], [1.0], [2.0]]), np.array([[2.0], [-1.0], [1.0]])
    >>> scaling = Scaling.of(x, s)
    >>> bool(np.allclose(scaling.times(s), scaling.over(x)))
    True
    >>> bool(np.allclose(scaling.twice(s), x))
    True
    """

    w: Array
    """Unit hyperbolic vector of each cone, shape (d, K)."""
    eta: Array
    """Scale of each cone, shape (K,)."""

    @classmethod
    def of(cls, x: Array, s: Array) -> Scaling:
        """The scaling W with W s = W^-1 x, for points x and s inside their cones, (d, K) each."""
        x_size, s_size = np.sqrt(_determinant(x)), np.sqrt(_determinant(s))
        a, b = x / x_size, s / s_size
        # w is (a + J b) over its hyperbolic length, J = diag(1, -1, ..), so that W s = W^-1 x
        half = np.sqrt((1 + (a * b).sum(axis=0)) / 2)
        w = a - b
        w[0] = a[0] + b[0]
        return cls(w / (2 * half), np.sqrt(x_size / s_size))

    def times(self, x: Array) -> Array:
        """Product W x with the scaling matrix W, shape (d, K)."""
        return _boost(self.w, x) * self.eta

    def over(self, x: Array) -> Array:
        """Product W^-1 x with the inverse of the scaling matrix W, shape (d, K)."""
        w = -self.w
        w[0] = self.w[0]
        return _boost(w, x) / self.eta

    def twice(self, x: Array) -> Array:
        """Product W^2 x with the square of the scaling matrix W, shape (d, K)."""
        # W^2 = eta^2 (2 w w^T - J), J = diag(1, -1, ..)
        result = 2 * (self.w * x).sum(axis=0) * self.w + x
        result[0] -= 2 * x[0]
        scaled: Array = result * self.eta**2
        return scaled


def _boost(w: Array, x: Array) -> Array:
    """Apply to x the hyperbolic rotation that takes the axis of each cone to w."""
    tail = (w[1:] * x[1:]).sum(axis=0)
    result: Array = x + (x[0] + tail / (1 + w[0])) * w
    result[0] = w[0] * x[0] + tail
    return result
