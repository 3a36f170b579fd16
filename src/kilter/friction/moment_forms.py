"""Linear forms of the contact law, whose products occur in a moment relaxation.

The law of `kilter.friction.reduced_law` at a scale e of motions, b = a / e and s = |ut| / e, in

    z = (1, b, f, s),     f = (fn, ft)

The forms, each a row over z, are 1, the coordinates of z themselves, and

    un = Jn b,   ut = Jt b,   mu N,   d = e b - w - Jn^T fn - Jt^T ft

with d = 0. A product of two forms is linear in the monomials z_i z_j. Only monomials within a
*clique* are used: the motion of a body with all forces on it; the motions of the bodies of a patch
with its forces and speeds. A *body* is a block of freedoms that no joint couples to others: those
of a part, or all freedoms if there are joints.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array, eye_array, hstack, vstack

from kilter.arrays import Index, Mask, starts
from kilter.friction.reduced_law import ReducedLaw


@dataclass(frozen=True, slots=True, eq=False)
class MomentForms:
    """Linear forms (speeds, forces ...) of the contact law in the unknowns z = (1, b, f, s)."""

    law: ReducedLaw
    scale: float
    """e."""
    rows: csr_array
    """The forms, shape (., 1 + n + K + G T + G); the other members are indices of its rows."""
    one: int
    """Row of the form 1."""
    motion: Index
    fn: Index
    un: Index
    total: Index
    slip: Index
    zero: Index
    """Rows of b, shape (n,); fn and un, (K,); mu N and s, (G,); d, (n,)."""
    ft: Index
    ut: Index
    """Rows of ft and ut, shape (G, T)."""
    push: Index
    """Rows of Jn^T fn + Jt^T ft of the points of each patch, shape (P, n)."""
    patch: Index
    """Patch of each point, shape (K,); a point without friction has its own patch."""
    bodies: tuple[Index, ...]
    """Freedoms of each body."""
    touching: Mask
    """True if a patch acts on a body, shape (P, bodies)."""

    @property
    def width(self) -> int:
        """Number of unknowns z; the first forms are these unknowns themselves."""
        return int(self.rows.shape[1])

    def forces_of(self, patch: int) -> Index:
        """Indices of the unknowns z that are forces of a patch."""
        groups = self.law.patch == patch
        return np.concatenate([self.fn[self.patch == patch], self.ft[groups].ravel()])

    def cliques(self) -> list[Index]:
        """Groups (cliques) of the unknowns z; products are formed only within a group."""
        cliques = []
        for body, freedoms in enumerate(self.bodies):
            forces = [self.forces_of(int(k)) for k in np.flatnonzero(self.touching[:, body])]
            cliques.append(np.concatenate([[self.one], self.motion[freedoms], *forces]))
        for patch in range(len(self.touching)):
            slips = self.slip[self.law.patch == patch]
            cliques.append(np.concatenate([self.pair_of(patch), self.forces_of(patch), slips]))
        return [clique.astype(np.int64) for clique in cliques]

    def pair_of(self, patch: int) -> Index:
        """Indices of the constant 1 and of the motions of the bodies that touch at a patch."""
        moved = [self.motion[self.bodies[k]] for k in np.flatnonzero(self.touching[patch])]
        return np.concatenate([[self.one], *moved]).astype(np.int64)

    def pushes_on(self, body: int) -> Index:
        """Indices of the constant 1, the motion of a body, and the push of all but one patch on it.

        The last push follows from the others and the motion.
        """
        patches = np.flatnonzero(self.touching[:, body])[:-1]
        freedoms = self.bodies[body]
        pushes = [self.push[patch][freedoms] for patch in patches]
        return np.concatenate([[self.one], self.motion[freedoms], *pushes]).astype(np.int64)


def moment_forms(law: ReducedLaw, scale: float) -> MomentForms:
    """Linear forms of the reduced contact law, for motions of size at most `scale`."""
    count, points, groups = len(law.load), len(law.group), len(law.mu)
    wide = groups * law.directions
    ends = starts([1, count, points, wide, groups])
    ones, motion, fn, ft, slip = (np.arange(a, b) for a, b in pairwise(ends))
    width = int(ends[-1])
    unit = eye_array(width, format="csr")
    forces = csr_array(vstack([law.normal, law.tangent]))
    patch, patches = _point_patches(law)
    rough = np.flatnonzero(law.group >= 0)
    weights = (law.mu[law.group[rough]], (law.group[rough], fn[rough]))
    load = csr_array(law.load[:, None])
    dynamics = hstack([-load, scale * eye_array(count), -forces.T, csr_array((count, groups))])
    # the rows of the dynamics, with the forces of a single patch
    owner = np.concatenate([patch, np.repeat(law.patch, law.directions)])
    pushes = [_pad_columns(forces.T.multiply(owner == k), 1 + count, width) for k in range(patches)]
    speeds = [_pad_columns(block, 1, width) for block in (law.normal, law.tangent)]
    blocks = [unit, *speeds, csr_array(weights, shape=(groups, width)), dynamics, *pushes]
    at = starts([block.shape[0] for block in blocks])
    un, ut, total, zero = (np.arange(at[k], at[k + 1]) for k in range(1, 5))
    bodies = _bodies(law)
    touching = _pushed_bodies(forces, owner, bodies, patches)
    return MomentForms(
        law, scale, csr_array(vstack(blocks, format="csr")), int(ones[0]), motion, fn, un, total,
        slip, zero, ft.reshape(groups, law.directions), ut.reshape(groups, law.directions),
        np.arange(at[5], at[-1]).reshape(patches, count), patch, bodies, touching,
    )  # fmt: skip


def width_of(law: ReducedLaw) -> int:
    """Number of unknowns z of the moment relaxation of a contact law."""
    return 1 + len(law.load) + len(law.group) + (law.directions + 1) * len(law.mu)


def bodies_of(law: ReducedLaw) -> int:
    """Number of bodies (blocks of freedoms that no joint couples) in a contact law."""
    return len(_bodies(law))


def _pushed_bodies(
    forces: csr_array, owner: Index, bodies: tuple[Index, ...], patches: int
) -> Mask:
    """Mask of the bodies on which each patch acts, shape (patches, bodies)."""
    entries = forces.tocoo()
    pushed = np.zeros((patches, forces.shape[1]), dtype=np.int64)
    pushed[owner[entries.coords[0]], entries.coords[1]] = 1
    membership = np.zeros((forces.shape[1], len(bodies)), dtype=np.int64)
    for number, columns in enumerate(bodies):
        membership[columns, number] = 1
    touching: Mask = (pushed @ membership) > 0
    return touching


def _pad_columns(rows: csr_array, before: int, width: int) -> csr_array:
    """Sparse rows with zero columns added before and after, to a total `width`."""
    entries = csr_array(rows)
    entries.eliminate_zeros()  # stored zeros would multiply in products of forms
    entries = entries.tocoo()
    places = (entries.coords[0], entries.coords[1] + before)
    return csr_array((entries.data, places), shape=(rows.shape[0], width))


def _point_patches(law: ReducedLaw) -> tuple[Index, int]:
    """Patch of each point (a separate one without friction), and the number of patches."""
    count = int(law.patch.max(initial=-1)) + 1
    smooth = law.group < 0
    patch = np.empty(len(law.group), dtype=np.int64)
    patch[~smooth] = law.patch[law.group[~smooth]]
    patch[smooth] = count + np.arange(int(smooth.sum()))
    return patch, count + int(smooth.sum())


def _bodies(law: ReducedLaw) -> tuple[Index, ...]:
    """Indices of the freedoms of each body; joints make all parts a single body."""
    count, per = len(law.load), len(law.law.program.freedoms)
    if law.law.tied.any() or count % per:
        return (np.arange(count),)
    return tuple(np.arange(count).reshape(-1, per))
