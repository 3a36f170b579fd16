"""Contact forces of equilibrium, pressure centres of patches, and utilisation of friction.

Forces of equilibrium are not unique: four legs of a rigid table can share its weight in many
ways. The answer shows the forces with the least sum of squares. They lie inside the set of all
equilibria and not at a corner of it, so equal contacts take equal shares. The resultant and the
pressure centre of a patch follow from the forces at its points.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from kilter.analysis.analysis_tolerances import PRESSES
from kilter.analysis.verdict.friction_share import PressedPatch, friction_shares
from kilter.analysis.verdict.part_answer import PointForces
from kilter.arrays import Array, Index, group_sums, sealed
from kilter.assembly import Joint
from kilter.contact import ContactSet
from kilter.errors import InputError, nearest_name, some_names
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.coulomb_cones import cone_problem, least_forces
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, DRAG, STOP
from kilter.tell.record import InPython, Lines, OrAbsent, Record, Vector

LIMIT = 3_000
"""Programs with more force rows than this keep the forces of the verdict's proof."""


class PatchForces(Record):
    """Contact forces of a patch on the second part of its pair [N]."""

    parts: tuple[str, str]
    """Names of the parts."""
    kind: str
    """Kind of the contact."""
    resultant: Vector
    """Sum of the forces [N]."""
    normal_force: float
    """Sum of the forces along the normals [N]; negative for a net pull."""
    center: Vector | None
    """Centre of pressure [length unit]; null without a normal force."""
    utilisation: float | None
    """Least share of the friction that its points need [-]."""
    bond_utilisation: float | None
    """Share of the bond [-]."""
    points: Lines
    """Contact points [length unit], world frame."""
    forces: Lines
    """Force at each point [N], world frame."""


class JointForces(Record):
    """Forces along the axis of a prismatic joint on its first part [N].

    Of a revolute joint, torques about the axis [N x length unit].
    """

    parts: tuple[str, str]
    """Names of the parts."""
    kind: Literal["revolute", "prismatic"]
    """Kind of the joint."""
    stop: float
    """Force or torque of the limit at which the joint stands, else 0."""
    friction: float
    """Force or torque of the friction of the joint."""
    spring: float
    """Force or torque of the spring of the joint."""


class ContactForces(Record):
    """Contact forces that balance every part, at contact points and summed over patches.

    The forces act on the second part of each contact, in the world frame.

    Examples
    --------
    >>> import kilter
    >>> forces = kilter.check(kilter.example("tower")).forces
    >>> forces.between("cube-1", "cube-2").resultant.round(6) + 0.0
    array([    0.,     0., 39240.])
    >>> forces.on("cube-2").resultant.round(6) + 0.0  # its own weight
    array([   0.,    0., 9810.])
    >>> forces["cube-2"].resultant.round(6) + 0.0  # the same
    array([   0.,    0., 9810.])
    """

    least: bool
    """True if these are the forces with the least sum of squares."""
    residual: float
    """Largest imbalance of a part over its weight [-]."""
    patches: tuple[PatchForces, ...]
    """Forces of each patch."""
    joints: OrAbsent[tuple[JointForces, ...]] = None
    """Forces of joints with limits, friction or a spring."""
    rows: InPython[Index]
    """Indices of the contact rows of the program, shape (C,); each row is a contact point."""
    force: InPython[Array]
    """Force at each point [N], shape (C, 3)."""
    patch: InPython[Index]
    """Indices of the patches in the contact set, shape (P,)."""
    patch_of: InPython[Index]
    """Position in `patch` of the patch of each point, shape (C,)."""
    resultant: InPython[Array]
    """Sum of the forces of each patch [N], shape (P, 3)."""
    normal_force: InPython[Array]
    """Sum of the forces along the normals [N], shape (P,); negative for a net pull."""
    center: InPython[Array]
    """Pressure centre [length unit], shape (P, 3): mean of the points, weighted by normal force.
    With a bond, the weight is the absolute normal force. NaN if the patch carries no normal
    force."""
    utilisation: InPython[Array]
    """Least share of the friction with which the points of the patch can carry its force and its
    moment [-], shape (P,) (`kilter.analysis.verdict.friction_share`). NaN without friction, for a
    patch that is not pressed, and for more than `LIMIT` rows."""
    bond_utilisation: InPython[Array]
    """Pull over the tensile strength of the bond, or shear over its limit [-], the largest of all
    points, shape (P,); NaN without a bond."""
    names: InPython[tuple[str, ...]]
    """Names of all parts."""
    pairs: InPython[Index]
    """Parts a and b of each point, by position, shape (C, 2); the force acts on b."""
    points: InPython[Array]
    """Contact points [length unit], shape (C, 3)."""
    pressures: InPython[Array]
    """Component of each force along the normal [N], shape (C,); negative for a pull."""

    def _position(self, name: str) -> int:
        """Index of a part, given its name."""
        if name in self.names:
            return self.names.index(name)
        near = nearest_name(name, self.names)
        hint = f"did you mean {near!r}?" if near else f"there are: {some_names(self.names, 8)}"
        raise InputError(f"no part is named {name!r}", hint=hint)

    def _selected(self, part: int, rows: Index) -> PointForces:
        """Contact forces on a part at the given rows, signed as they act on this part."""
        sign = np.where(self.pairs[rows, 1] == part, 1.0, -1.0)[:, None]
        return sealed(
            PointForces(
                part=self.names[part],
                points=self.points[rows],
                forces=sign * self.force[rows],
                pressures=self.pressures[rows],
            )
        )

    def __getitem__(self, part: str) -> PointForces:
        return self.on(part)

    def between(self, a: str, b: str) -> PointForces:
        """Contact forces of part `a` on part `b`; empty if they do not touch.

        Raises
        ------
        InputError
            If the assembly has no such part.
        """
        first, second = self._position(a), self._position(b)
        both = (np.sort(self.pairs, axis=1) == sorted((first, second))).all(axis=1)
        return self._selected(second, np.flatnonzero(both))

    def on(self, part: str) -> PointForces:
        """Contact forces of all other parts on a part, without joints and loads.

        Raises
        ------
        InputError
            If the assembly has no such part.
        """
        k = self._position(part)
        return self._selected(k, np.flatnonzero((self.pairs == k).any(axis=1)))


def find_contact_forces(
    program: Program, proof: ForceProof, contacts: ContactSet, *, shares: bool = True
) -> ContactForces:
    """Compute the contact forces that an answer shows, for a proved equilibrium.

    These are the forces with the least sum of squares. If the program has more than `LIMIT` rows,
    or if they do not pass as a proof, the forces of `proof` are shown instead. `shares`: whether
    the share of the friction that each patch needs is computed.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.analysis.check import check
    >>> verdict = check(scene("tower"))
    >>> found = find_contact_forces(verdict.program, verdict.judgement.forces, verdict.contact_set)
    >>> bool(np.allclose(found.force, found.force[0]) or len(set(found.patch_of)) > 1)
    True
    """
    least = _least_square_forces(program) if len(program.part_a) <= LIMIT else None
    used = proof if least is None else least
    rows = np.flatnonzero(program.kind == CONTACT)
    force = program.point_forces(used.forces, used.friction)
    along = np.einsum("ij,ij->i", force, program.normal[rows])
    across = force - along[:, None] * program.normal[rows]
    patch, patch_of = np.unique(program.source[rows], return_inverse=True)
    count = len(patch)
    normal_force = np.bincount(patch_of, along, minlength=count).astype(np.float64)
    center = _pressure_centers(program, patch_of, count, along)
    known = shares and len(program.part_a) <= LIMIT
    none = np.full(count, np.nan)
    utilisation = _friction_needed(program, rows, force, patch_of, along) if known else none
    found = {
        "resultant": group_sums(patch_of, force, count),
        "normal_force": normal_force,
        "center": center,
        "utilisation": utilisation,
        "bond_utilisation": _bond_shares(program, rows, patch_of, along, across),
    }
    points = program.point[rows]
    joints = tuple(
        _joint_forces(used.forces, program, joint, number)
        for number, joint in enumerate(contacts.assembly.joints)
        if joint.guide
    )
    return ContactForces(
        least=least is not None,
        residual=used.residual,
        patches=tuple(
            PatchForces(
                parts=(program.names[a], program.names[b]),
                kind=str(contacts.patch_kind[number]),
                points=points[members],
                forces=force[members],
                **dict(zip(found, values, strict=True)),
            )
            for number, (a, b), members, *values in zip(
                patch,
                contacts.patch_parts[patch].tolist(),
                _members(patch_of, count),
                *map(_entries, found.values()),
                strict=True,
            )
        ),
        joints=joints or None,
        rows=rows,
        force=force,
        patch=patch,
        patch_of=patch_of,
        names=tuple(program.names),
        pairs=np.column_stack([program.part_a[rows], program.part_b[rows]]),
        points=points,
        pressures=along,
        **found,
    )


def _bond_shares(
    program: Program, rows: Index, patch_of: Index, along: Array, across: Array
) -> Array:
    """Largest used share of the strength of the bonds of each patch [-]; NaN without bonds."""
    share = np.full(int(patch_of.max(initial=-1)) + 1, np.nan)
    for used, strength in (
        (np.maximum(-along, 0.0), program.pull[rows]),
        (np.linalg.norm(across, axis=1), program.cohesion[rows]),
    ):
        bonded = np.flatnonzero(strength > 0)
        np.fmax.at(share, patch_of[bonded], used[bonded] / strength[bonded])
    return share


def _members(patch_of: Index, count: int) -> list[Index]:
    """Indices of the points of each patch."""
    ends = np.cumsum(np.bincount(patch_of, minlength=count))
    return np.split(np.argsort(patch_of, kind="stable"), ends[:-1]) if count else []


def _entries(values: Array) -> list[Any]:
    """The number or the vector of each patch; None if it is NaN."""
    known = np.isfinite(values if values.ndim == 1 else values.sum(axis=1))
    entries = values.tolist() if values.ndim == 1 else list(values)
    return [entry if is_known else None for entry, is_known in zip(entries, known, strict=True)]


def _joint_forces(forces: Array, program: Program, joint: Joint, number: int) -> JointForces:
    """Forces or torques along the axis of a joint on its first part, from those of all rows."""
    sizes = {}
    for name, kind in (("stop", STOP), ("friction", DRAG)):
        rows = np.flatnonzero((program.source == number) & (program.kind == kind))
        # the force of a row acts on the second part along its normal
        sizes[name] = 0.0 - float(program.normal[rows] @ joint.axis @ forces[rows])
    return JointForces(
        parts=joint.parts,
        kind="prismatic" if joint.kind == "prismatic" else "revolute",
        spring=joint.stiffness * joint.rest,
        **sizes,
    )


def _friction_needed(
    program: Program, rows: Index, force: Array, patch_of: Index, along: Array
) -> Array:
    """Least share of the friction that each patch needs, shape (P,); NaN without a share."""
    count = int(patch_of.max(initial=-1)) + 1
    mu, pull = program.mu[rows], program.pull[rows]
    # the strength of a bond clamps its contact: Coulomb's limit is mu (normal force + strength)
    extra = pull + np.divide(program.cohesion[rows], mu, out=np.zeros(len(rows)), where=mu > 0)
    pressed = np.bincount(patch_of, along + extra, minlength=count)
    rubs = np.bincount(patch_of, mu > 0, minlength=count) > 0
    rubs &= pressed > PRESSES * float(program.weight.max(initial=0.0))
    patches = []
    for k in np.flatnonzero(rubs):
        at = np.flatnonzero(patch_of == k)
        own = rows[at]
        patches.append(
            PressedPatch(
                program.point[own],
                program.normal[own],
                force[at],
                float(mu[at].max()),
                pull[at],
                extra[at],
            )
        )
    shares = np.full(count, np.nan)
    shares[rubs] = friction_shares(patches)
    return shares


def _pressure_centers(program: Program, patch_of: Index, count: int, along: Array) -> Array:
    """Centre of pressure of each patch from the normal forces at its points, shape (P, 3)."""
    rows = np.flatnonzero(program.kind == CONTACT)
    bonded = np.bincount(patch_of, program.pull[rows], minlength=count) > 0
    sizes = np.where(bonded[patch_of], np.abs(along), along)
    size = np.bincount(patch_of, sizes, minlength=count)
    weighted = group_sums(patch_of, sizes[:, None] * program.point[rows], count)
    presses = size > PRESSES * float(program.weight.max(initial=0.0))
    center = np.full((count, 3), np.nan)
    center[presses] = weighted[presses] / size[presses][:, None]
    return center


def _least_square_forces(program: Program) -> ForceProof | None:
    """Balancing forces with the least sum of squares; None if solver or verification fails."""
    from kilter.solvers.clarabel import solve_conic

    if not program.free.any():
        return None
    wide = cone_problem(program)
    answer = solve_conic(least_forces(wide))
    if not answer.found:
        return None
    judged = check_forces(program, *wide.decoded(answer.x))
    return judged if judged.holds else None
