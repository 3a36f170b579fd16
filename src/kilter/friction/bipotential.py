"""The contact law with its only awkward term held fixed: a convex conic program.

With s = mu |u_t| given, accelerations x and forces f that obey Coulomb's law are the optimum
and the multipliers of (De Saxce and Feng 1998; Acary, Cadoux, Lemaréchal and Malick 2011)

    min 1/2 |x|^2 - w.x,     u_n + s >= mu |u_t|   a point with friction       u = H x
                             u_n >= 0              a point without,  u_n = 0   a joint

so solutions of the law are the fixed points of s -> mu |H_t x(s)|. A *lubricated* point is one
without friction for once: it starts the iteration where parts slide that friction would hold.

References
----------
V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb
friction problem via convex optimization, ZAMM 91, 2011, section 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, eye_array

from kilter.arrays import Array, Index, Mask
from kilter.friction.frictional import Frictional
from kilter.solvers.problem import ConicProgram

__all__ = ["Bipotential", "bipotential"]


@dataclass(frozen=True, slots=True, eq=False)
class Bipotential:
    """The family of programs of one contact law.

    Attributes
    ----------
    law : Frictional
    tied, smooth, rough : ndarray of int
        Rows of joints, without friction, with friction.
    lines : csc_array
        Rows of H in the order of the program: joints, smooth, (n, u, v) of each rough row.
    identity : csc_array
    """

    law: Frictional
    tied: Index
    smooth: Index
    rough: Index
    lines: csc_array
    identity: csc_array

    def program(self, shift: Array, lubricated: Mask) -> ConicProgram:
        """The program for s = `shift`, shape (K,), and the rows that are lubricated."""
        law, before = self.law, len(self.tied) + len(self.smooth)
        scale, bound = np.ones(self.lines.shape[0]), np.zeros(self.lines.shape[0])
        friction = np.where(lubricated, 0.0, law.mu)[self.rough]
        scale[before + 1 :: 3] = friction
        scale[before + 2 :: 3] = friction
        bound[before::3] = np.where(lubricated, 0.0, shift)[self.rough]
        lines = self.lines
        entries = -lines.data * scale[lines.indices]
        return ConicProgram(
            self.identity,
            -law.load,
            csc_array((entries, lines.indices, lines.indptr), shape=lines.shape),
            bound,
            len(self.tied),
            len(self.smooth),
            np.full(len(self.rough), 3),
        )

    def forces(self, multipliers: Array, lubricated: Mask) -> Array:
        """Scaled forces (n, u, v), shape (K, 3), of the program's multipliers."""
        forces = np.zeros((len(self.law.mu), 3))
        before = len(self.tied) + len(self.smooth)
        forces[self.tied, 0] = multipliers[: len(self.tied)]
        forces[self.smooth, 0] = multipliers[len(self.tied) : before]
        own = multipliers[before:].reshape(-1, 3).copy()
        own[:, 1:] *= np.where(lubricated, 0.0, self.law.mu)[self.rough][:, None]
        forces[self.rough] = own
        return forces


def bipotential(law: Frictional) -> Bipotential:
    """The programs of a contact law."""
    tied = np.flatnonzero(law.tied)
    smooth = np.flatnonzero(~law.tied & (law.mu <= 0))
    rough = np.flatnonzero(~law.tied & (law.mu > 0))
    triples = (3 * rough[:, None] + np.arange(3)).reshape(-1)
    order = np.concatenate([3 * tied, 3 * smooth, triples])
    identity = csc_array(eye_array(len(law.load)))
    return Bipotential(law, tied, smooth, rough, csc_array(law.matrix[order]), identity)
