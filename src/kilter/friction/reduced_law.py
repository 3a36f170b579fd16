"""Coulomb's contact law of a program, scaled so that the mass matrix is the unit matrix.

With a the acceleration times the root of the mass matrix over the length of the load, f the
contact forces in units of about the weight of all free parts, and |w| = 1:

    a = w + Jn^T fn + Jt^T ft                                     dynamics
    un = Jn a >= 0,  fn >= 0,  un fn = 0                          at each point
    |ft| <= mu N,   ft.ut = -mu N |ut|,   ut = Jt a               in each group, N = sum of fn

    so   w.a = |a|^2 + sum of mu N |ut|   and   |a|^2 <= w.a <= 1.

Points that share ut form a *group*: in the plane all points of a straight patch, whose
tangential forces lie on one line, so that one ft stands for them; in space each point alone.
Groups that share one *twist* form a *patch*: t = ut of a single point or of a patch in the
plane, t = (v, length x omega about the normal) of a flat patch in space; ut = L t. This is
exact: nothing is relaxed here.

Joints are taken out by restricting a to the motions that they allow, which leaves out their
forces without loss.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, Index
from kilter.friction.friction_tolerances import FLAT, JOINT_RANK
from kilter.mechanics.program import CONTACT, JOINT, POSSIBLE, Program, tangents

__all__ = ["ReducedLaw", "reduced_law", "refusal"]


@dataclass(frozen=True, slots=True, eq=False)
class ReducedLaw:
    """The law in scaled unknowns; n freedoms, K points, G groups, P patches, T = 1 or 2.

    Attributes
    ----------
    load : ndarray, shape (n,)
        w, of length 1 (or 0 without load).
    normal : csr_array, shape (K, n)
        Jn.
    group : ndarray of int, shape (K,)
        Group of each point; -1 without friction.
    mu : ndarray, shape (G,)
    tangent : csr_array, shape (G * T, n)
        Jt.
    patch : ndarray of int, shape (G,)
        Patch of each group.
    twist : tuple of csr_array, shape (d, n)
        t of each patch.
    lever : ndarray, shape (G, T, 3)
        L: ut = L t of the patch of the group; columns from d on are 0.
    back : ndarray, shape (freedoms of the program, n)
        From a to accelerations in the order of `Program.columns`.
    """

    load: Array
    normal: csr_array
    group: Index
    mu: Array
    tangent: csr_array
    patch: Index
    twist: tuple[csr_array, ...]
    lever: Array
    back: csr_array

    @property
    def directions(self) -> int:
        """T: directions across a normal that count."""
        return int(self.lever.shape[1])


def refusal(program: Program) -> str:
    """Why the law of this program cannot be written, or ""."""
    if (program.kind == POSSIBLE).any():
        return "contacts that are not modelled"
    contact = program.kind == CONTACT
    if (program.two_sided & contact).any() or (program.mu[contact] < 0).any():
        return "a contact that pulls"
    if program.planar and (np.abs(program.normal[contact & (program.mu > 0), 1]) > FLAT).any():
        return "friction on a face in the plane of the motion"
    free = program.free
    if not (program.mass[free] > 0).all() or not np.isfinite(program.load[free]).all():
        return "a part without mass"
    if free.any() and not (np.linalg.eigvalsh(program.inertia[free]) > 0).all():
        return "a part without inertia"
    return ""


def reduced_law(program: Program) -> ReducedLaw:
    """The contact law of a program of which `refusal` has nothing to say."""
    contact = np.flatnonzero(program.kind == CONTACT)
    label = _patches(program, contact)
    keep, group, patch_of_group, first = _groups(program, contact, label)
    points = contact[keep]
    root, load = _root(program), program.load[np.ix_(program.free, program.freedoms)].reshape(-1)
    back = _allowed(program, root)
    w = back.T @ load
    size = float(np.linalg.norm(w)) or 1.0
    unit = float(np.sqrt(program.mass[program.free].sum())) or 1.0
    across = tangents(program.normal[contact[first]])
    count = 1 if program.planar else 2
    if program.planar:  # the one tangent in the plane of the motion
        n = program.normal[contact[first]]
        across = np.stack([n[:, 2], 0 * n[:, 0], -n[:, 0]], axis=1)[:, None]
    rows = np.repeat(contact[first], count)
    sideways = program.with_rows(
        **_some_rows(program, rows, program.point[rows], across.reshape(-1, 3))
    )
    normal = csr_array(_some(program, points).jacobian() @ back) * unit
    tangent = csr_array(sideways.jacobian() @ back) * unit
    twist, lever = _twists(program, contact[first], patch_of_group, across, tangent, back, unit)
    return ReducedLaw(
        w / size, normal, group, program.mu[contact[first]], tangent, patch_of_group, twist,
        lever, back,
    )  # fmt: skip


def _some_rows(program: Program, rows: Index, point: Array, normal: Array) -> dict[str, object]:
    return {
        "part_a": program.part_a[rows],
        "part_b": program.part_b[rows],
        "point": point,
        "normal": normal,
        "kind": program.kind[rows],
        "two_sided": program.two_sided[rows],
        "angular": program.angular[rows],
        "mu": program.mu[rows],
        "source": program.source[rows],
    }


def _some(program: Program, rows: Index) -> Program:
    return program.with_rows(**_some_rows(program, rows, program.point[rows], program.normal[rows]))


def _root(program: Program) -> csr_array:
    """M^(-1/2) in the order of `Program.columns`: blocks of one part each."""
    free = np.flatnonzero(program.free)
    per = len(program.freedoms)
    mass = np.zeros((len(free), 6, 6))
    mass[:, range(3), range(3)] = program.mass[free][:, None]
    mass[:, 3:, 3:] = program.inertia[free]
    values, vectors = np.linalg.eigh(mass[:, program.freedoms][:, :, program.freedoms])
    blocks = np.einsum("kij,kj,klj->kil", vectors, 1 / np.sqrt(values), vectors)
    at = np.arange(len(free))[:, None, None] * per
    row = np.broadcast_to(at + np.arange(per)[:, None], blocks.shape).ravel()
    col = np.broadcast_to(at + np.arange(per)[None, :], blocks.shape).ravel()
    matrix = csr_array((blocks.ravel(), (row, col)), shape=(per * len(free),) * 2)
    matrix.eliminate_zeros()
    return matrix


def _allowed(program: Program, root: csr_array) -> csr_array:
    """M^(-1/2) Z, the columns of Z an orthonormal basis of what the joints allow."""
    joints = np.flatnonzero(program.kind == JOINT)
    if not len(joints):
        return root
    rows = (_some(program, joints).jacobian() @ root).toarray()
    length = np.linalg.norm(rows, axis=1)
    rows = rows[length > 0] / length[length > 0][:, None]
    _, values, vectors = np.linalg.svd(rows)
    rank = int((values > JOINT_RANK * values.max(initial=0.0)).sum())
    return csr_array(root @ vectors[rank:].T)


def _patches(program: Program, rows: Index) -> Index:
    """Number of the flat patch of each contact row: same source, parts, mu, normal, plane."""
    size = float(program.radius[program.free].max(initial=1.0))
    along = np.einsum("ki,ki->k", program.normal[rows], program.point[rows])
    exact = np.column_stack([program.source, program.part_a, program.part_b, program.mu])[rows]
    _, label = np.unique(exact, axis=0, return_inverse=True)
    label = np.where(
        program.source[rows] < 0, label.max(initial=-1) + 1 + np.arange(len(rows)), label
    )
    order = np.argsort(label, kind="stable")
    starts = np.unique(label[order], return_index=True)[1]
    for members in np.split(order, starts[1:]):
        first = members[:1]
        turned = np.abs(program.normal[rows[members]] - program.normal[rows[first]]).max(axis=1)
        off = np.abs(along[members] - along[first])
        curved = (turned > FLAT) | (off > FLAT * size)
        if curved.any():  # every point on its own
            label[members] = label.max() + 1 + np.arange(len(members))
    return np.unique(label, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _groups(program: Program, contact: Index, label: Index) -> tuple[Index, Index, Index, Index]:
    """Points kept, group of each (-1 without friction), patch of each group, its first row.

    In the plane only the two ends of a straight patch are kept: the forces of points between
    them are sums of forces at the ends, and where such a point touches under force the whole
    patch touches.
    """
    if not program.planar:
        rough = np.flatnonzero(program.mu[contact] > 0)
        own = np.full(len(contact), -1)
        own[rough] = np.arange(len(rough))
        patch = np.unique(label[rough], return_inverse=True)[1].reshape(-1)
        return np.arange(len(contact)), own, patch, rough
    normal, point = program.normal[contact], program.point[contact]
    along = normal[:, 2] * point[:, 0] - normal[:, 0] * point[:, 2]
    kept: list[Index] = []
    group: list[Index] = []
    ends_of: list[int] = []
    for members in _members(label):
        ends = np.sort(members[[along[members].argmin(), along[members].argmax()]])
        size = FLAT * float(program.radius.max(initial=1.0))
        ends = ends[:1] if np.ptp(along[members]) <= size else ends
        rough = program.mu[contact[ends[0]]] > 0
        kept.append(ends)
        group.append(np.full(len(ends), len(ends_of) if rough else -1))
        ends_of += [int(ends[0])] if rough else []
    empty = [np.empty(0, dtype=np.int64)]
    return (
        np.concatenate(kept or empty),
        np.concatenate(group or empty),
        np.arange(len(ends_of)),
        np.array(ends_of, dtype=np.int64),
    )


def _members(label: Index) -> list[Index]:
    order = np.argsort(label, kind="stable")
    starts = np.unique(label[order], return_index=True)[1]
    return np.split(order, starts[1:]) if len(order) else []


def _twists(
    program: Program,
    rows: Index,
    patch: Index,
    across: Array,
    tangent: csr_array,
    back: csr_array,
    unit: float,
) -> tuple[tuple[csr_array, ...], Array]:
    """The twist t of each patch and L of each group."""
    count = across.shape[1]
    lever = np.zeros((len(rows), count, 3))
    lever[:, range(count), range(count)] = 1.0
    found = []
    for members in _members(patch):
        at = program.point[rows[members]]
        arm = at - at.mean(axis=0)
        length = float(np.linalg.norm(arm, axis=1).max())
        own = (members[0] * count + np.arange(count)).astype(np.int64)
        if count == 1 or len(members) == 1:
            found.append(csr_array(tangent[own]))
            continue
        one = np.repeat(rows[members[0]], 3)
        spin = _some_rows(program, one, np.tile(at.mean(axis=0), (3, 1)), program.normal[one])
        spin["normal"] = np.vstack([across[members[0]], program.normal[one[:1]]])
        spin["angular"] = np.array([False, False, True])
        scale = diags_array([unit, unit, unit * max(length, TINY)])
        found.append(csr_array(scale @ program.with_rows(**spin).jacobian() @ back))
        # ut(x) = v + omega n x r: n x r along tangents (e1, e2, n right-handed) is (-r2, r1)
        basis = across[members[0]]
        plane = arm @ basis.T / max(length, TINY)
        turn = np.einsum("gij,kj->gik", across[members], basis)
        lever[members, :, :2] = turn
        lever[members, :, 2] = np.einsum(
            "gik,gk->gi", turn, np.stack([-plane[:, 1], plane[:, 0]], axis=1)
        )
    return tuple(found), lever
