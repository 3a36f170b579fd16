"""Linear forms of the contact law, whose products a moment relaxation is made of.

The law of `kilter.friction.reduced_law` at a scale e of motions, b = a / e and s = |ut| / e, in

    z = (1, b, f, s),     f = (fn, ft)

The forms, each a row over z, are 1, the coordinates of z themselves, and

    un = Jn b,   ut = Jt b,   mu N,   d = e b - w - Jn^T fn - Jt^T ft

of which d is 0. A product of two forms is linear in the monomials z_i z_j. Only those within a
*clique* are thought of: the motion of one body with all forces on it; the motions of the
bodies of a patch with its forces and speeds. A *body* is a block of freedoms that no joint
couples to others: of one part, or of all where there are joints.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array, eye_array, hstack, vstack

from kilter.arrays import Index, Mask, starts
from kilter.friction.reduced_law import ReducedLaw

__all__ = ["MomentForms", "bodies_of", "moment_forms", "width_of"]


@dataclass(frozen=True, slots=True, eq=False)
class MomentForms:
    """Forms over z of a law with n freedoms, K points, G groups, P patches, T directions.

    Attributes
    ----------
    law : ReducedLaw
    scale : float
        E.
    rows : csr_array, shape (., 1 + n + K + G T + G)
        The forms; below are the numbers of their rows.
    one : int
    motion, fn, un, total, slip, zero : ndarray of int
        B, shape (n,); fn and un, (K,); mu N and s, (G,); d, (n,).
    ft, ut : ndarray of int, shape (G, T)
    push : ndarray of int, shape (P, n)
        Of each patch, Jn^T fn + Jt^T ft of its points alone.
    patch : ndarray of int, shape (K,)
        Of each point; those without friction have one of their own.
    bodies : tuple of ndarray of int
        Freedoms of each body.
    touching : ndarray of bool, shape (P, bodies)
        Which bodies a patch moves.
    """

    law: ReducedLaw
    scale: float
    rows: csr_array
    one: int
    motion: Index
    fn: Index
    un: Index
    total: Index
    slip: Index
    zero: Index
    ft: Index
    ut: Index
    push: Index
    patch: Index
    bodies: tuple[Index, ...]
    touching: Mask

    @property
    def width(self) -> int:
        """Coordinates of z, which are the first forms."""
        return int(self.rows.shape[1])

    def forces_of(self, patch: int) -> Index:
        """Coordinates of the forces of a patch."""
        own = self.law.patch == patch
        return np.concatenate([self.fn[self.patch == patch], self.ft[own].ravel()])

    def cliques(self) -> list[Index]:
        """Coordinates of z whose products are thought of, a list a clique."""
        found = []
        for body, freedoms in enumerate(self.bodies):
            near = [self.forces_of(int(k)) for k in np.flatnonzero(self.touching[:, body])]
            found.append(np.concatenate([[self.one], self.motion[freedoms], *near]))
        for patch in range(len(self.touching)):
            slips = self.slip[self.law.patch == patch]
            found.append(np.concatenate([self.pair_of(patch), self.forces_of(patch), slips]))
        return [one.astype(np.int64) for one in found]

    def pair_of(self, patch: int) -> Index:
        """1 and the motions of the bodies of a patch."""
        moved = [self.motion[self.bodies[k]] for k in np.flatnonzero(self.touching[patch])]
        return np.concatenate([[self.one], *moved]).astype(np.int64)

    def pushes_on(self, body: int) -> Index:
        """1, the motion of a body, and the pushes of all its patches but one on it.

        The last push follows from the others and the motion.
        """
        patches = np.flatnonzero(self.touching[:, body])[:-1]
        own = self.bodies[body]
        pushes = [self.push[patch][own] for patch in patches]
        return np.concatenate([[self.one], self.motion[own], *pushes]).astype(np.int64)


def moment_forms(law: ReducedLaw, scale: float) -> MomentForms:
    """The forms of a law at a scale."""
    count, points, groups = len(law.load), len(law.group), len(law.mu)
    wide = groups * law.directions
    ends = starts([1, count, points, wide, groups])
    one, motion, fn, ft, slip = (np.arange(a, b) for a, b in pairwise(ends))
    width = int(ends[-1])
    unit = eye_array(width, format="csr")
    forces = csr_array(vstack([law.normal, law.tangent]))
    patch, patches = _patches(law)
    rough = np.flatnonzero(law.group >= 0)
    weights = (law.mu[law.group[rough]], (law.group[rough], fn[rough]))
    load = csr_array(law.load[:, None])
    dynamics = hstack([-load, scale * eye_array(count), -forces.T, csr_array((count, groups))])
    # the same rows, of the forces of one patch
    owner = np.concatenate([patch, np.repeat(law.patch, law.directions)])
    pushes = [_spread(forces.T.multiply(owner == k), 1 + count, width) for k in range(patches)]
    speeds = [_spread(one_of, 1, width) for one_of in (law.normal, law.tangent)]
    blocks = [unit, *speeds, csr_array(weights, shape=(groups, width)), dynamics, *pushes]
    at = starts([one_of.shape[0] for one_of in blocks])
    un, ut, total, zero = (np.arange(at[k], at[k + 1]) for k in range(1, 5))
    bodies = _bodies(law)
    touching = _touching(forces, owner, bodies, patches)
    return MomentForms(
        law, scale, csr_array(vstack(blocks, format="csr")), int(one[0]), motion, fn, un, total,
        slip, zero, ft.reshape(groups, law.directions), ut.reshape(groups, law.directions),
        np.arange(at[5], at[-1]).reshape(patches, count), patch, bodies, touching,
    )  # fmt: skip


def width_of(law: ReducedLaw) -> int:
    """How many coordinates z has."""
    return 1 + len(law.load) + len(law.group) + (law.directions + 1) * len(law.mu)


def bodies_of(law: ReducedLaw) -> int:
    """How many bodies a law has."""
    return len(_bodies(law))


def _touching(forces: csr_array, owner: Index, bodies: tuple[Index, ...], patches: int) -> Mask:
    """Which patch pushes which body, shape (patches, bodies)."""
    entries = forces.tocoo()
    pushed = np.zeros((patches, forces.shape[1]), dtype=np.int64)
    pushed[owner[entries.coords[0]], entries.coords[1]] = 1
    own = np.zeros((forces.shape[1], len(bodies)), dtype=np.int64)
    for number, columns in enumerate(bodies):
        own[columns, number] = 1
    found: Mask = (pushed @ own) > 0
    return found


def _spread(rows: csr_array, before: int, width: int) -> csr_array:
    """Rows with columns of zeros before and behind."""
    entries = csr_array(rows)
    entries.eliminate_zeros()  # products of forms multiply what is stored
    entries = entries.tocoo()
    places = (entries.coords[0], entries.coords[1] + before)
    return csr_array((entries.data, places), shape=(rows.shape[0], width))


def _patches(law: ReducedLaw) -> tuple[Index, int]:
    """The patch of each point, one of its own where it has no friction; how many there are."""
    count = int(law.patch.max(initial=-1)) + 1
    smooth = law.group < 0
    patch = np.empty(len(law.group), dtype=np.int64)
    patch[~smooth] = law.patch[law.group[~smooth]]
    patch[smooth] = count + np.arange(int(smooth.sum()))
    return patch, count + int(smooth.sum())


def _bodies(law: ReducedLaw) -> tuple[Index, ...]:
    """The freedoms of each part, or all in one body where joints couple them."""
    count, per = len(law.load), len(law.law.program.freedoms)
    if law.law.tied.any() or count % per:
        return (np.arange(count),)
    return tuple(np.arange(count).reshape(-1, per))
