"""Proof that parts on horizontal faces can move freely without losing height.

A level motion shifts a part across gravity and turns it about the vertical. At a contact of a level
face with a face, an edge or a corner, no level motion changes the gap or the energy. Let f be
forces of equilibrium on such contacts alone, and S the contacts with f > 0, such that

    every part is supported at points of S that are not collinear, and no parts support each
    other in a ring

Then the supports fix height and tilts of each part, from below to the top: J_S is one to one.

Near the configuration, for each choice x of level motions of all parts, there are forces f(x) > 0
on S that still balance. With the heights and tilts t

    E - E_0 = sum over S of f_k(x) J_k(x) t,     J_k(x) t >= -O(t^2),     J_S(x) one to one,

so that E > E_0 unless t = 0: the energy is least exactly on the level motions. A level motion that
opens all other contacts shows that the level motions span the neutral ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, Index, Mask, cross, read_only
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import NUMBER, SIX, Form, keys, list_of, named
from kilter.mechanics.rows import POSSIBLE
from kilter.second_order.gaps.features_of import FLAT, detected_rows
from kilter.second_order.gaps.joint_forms import on_joints, slipping
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.sharp_points import SharpPoints, sharp_points
from kilter.second_order.parts.bearing import (
    Bearing,
    bearing_of,
    by_depth,
    in_footing,
    level_axes,
    sums_by_part,
)
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Judged
from kilter.second_order.proofs.minimum_proof import all_carry, named_motion, read_motion
from kilter.second_order.second_order_tolerances import (
    ACROSS,
    BALANCED,
    BEARS,
    CARRIES,
    DROPS,
    SPREAD,
)

# Proof that parts are held to first order: equilibrium forces leave no motion neutral.


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """Equilibrium forces, (K,) [N], that prove that no neutral motion exists.

    Rows of joints about turns have torques [N x length unit].
    """

    FORM: ClassVar[Form] = keys(held=list_of(NUMBER))
    SURFACES: ClassVar[str] = "none"
    forces: Array

    def __post_init__(self) -> None:
        read_only(self)

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof of held parts, for a proof file."""
        return {"held": self.forces.tolist()}

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> Held:
        """Read a proof of held parts from JSON data."""
        return cls(np.array(data["held"], dtype=float))

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof of held parts: why it fails, or the state and counts it proves."""
        certain = facts.program.taking(facts.program.kind != POSSIBLE)
        return judge_held(certain, self) or ("minimum", 0, 0)


def judge_held(program: Program, proof: Held) -> str:
    """Reason why a proof of held parts (without friction) fails; empty if it is valid."""
    forces = proof.forces
    if forces.shape != program.part_a.shape or not np.isfinite(forces).all():
        return "it does not have a finite force for each contact"
    joined = on_joints(program)
    if (forces[~joined] < 0).any():
        return "a contact force pulls"
    if slipping(program, forces).any():
        return "the friction of a joint is at its limit"
    limit = max(BALANCED, float(program.tolerance.max(initial=0.0)))
    if not unbalanced(program, forces) <= limit:
        return "its forces do not balance the load"
    over_arm = forces / program.arm  # torques of joints as forces
    carries = joined | (over_arm > BEARS * limit * np.abs(over_arm).max(initial=TINY))
    sizes = np.maximum(program.weight, program.force_sums(forces))[program.free]
    per = len(program.freedoms)
    rows = scaled_rows(program)[carries] @ diags_array(np.repeat(1 / sizes, per))
    missing = 2 * limit * np.sqrt(per * len(sizes))
    if not all_carry(csr_array(rows), over_arm[carries], missing, joined=joined[carries]):
        return "its forces leave a motion neutral"
    return ""


def unbalanced(program: Program, forces: Array) -> float:
    """Largest imbalance |J^T f + w| of a part, relative to its load and forces [-]."""
    return float(imbalances(program, forces).max(initial=0.0))


def imbalances(program: Program, forces: Array) -> Array:
    """Imbalance |J^T f + w| of each part, relative to its load and forces [-], shape (N,)."""
    left = np.abs(program.wrenches(forces) + program.load)
    left[:, 3:] /= program.radius[:, None]
    size = np.maximum(program.weight, program.force_sums(forces))
    left = left[:, program.freedoms]
    relative: Array = np.where(program.free, left.max(axis=1) / np.maximum(size, TINY), 0.0)
    return relative


def scaled_rows(program: Program) -> csr_array:
    """Matrix J of the rows, with turns in units of 1 / part radius, shape (K, n).

    Rows about turns are multiplied by their lever length.
    """
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    scale = diags_array(units[:, program.freedoms].reshape(-1))
    return csr_array(diags_array(program.arm) @ program.jacobian() @ scale)


MOST_CHANGED = 0.5
"""Largest relative change of a force by the correction that balances the load exactly [-]."""
OPEN_TILT = "its forces do not exclude a tilt of a part"


@dataclass(frozen=True, slots=True, eq=False)
class LevelRest:
    """Proof that the neutral motions are exactly the horizontal motions, which are free.

    `forces`, shape (K,) [N], of equilibrium on level contacts; `motion`, shape (N, 6): a level
    motion that opens all other contacts, by up to 1 length unit.
    """

    FORM: ClassVar[Form] = keys(level=list_of(NUMBER), motion=named(SIX))
    SURFACES: ClassVar[str] = "none"
    forces: Array
    motion: Array

    def __post_init__(self) -> None:
        read_only(self)

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof of rest on horizontal faces, for a proof file."""
        # imported late: only a written proof needs these modules

        return {"level": self.forces.tolist(), "motion": named_motion(program, self.motion)}

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> LevelRest:
        """Read a proof of rest on horizontal faces from JSON data."""
        # imported late: only a written proof needs these modules

        motion = read_motion(facts.program, data["motion"])
        return cls(np.array(data["level"], dtype=float), motion)

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof of rest on horizontal faces: why it fails, or the state and counts."""
        program, contacts = facts.program, facts.contacts
        level, sharp = level_rows(program, contacts), sharp_points(program, contacts)
        free = int(program.free.sum()) * (1 if program.planar else 3)
        return judge_level_rest(program, level, self, sharp) or ("free", free, free)


def level_rows(program: Program, contacts: ContactSet) -> Mask:
    """Mask of the detected contact rows at a horizontal face, shape (K,)."""
    flat = [kind for kind in FLAT if kind != "edge-edge"]
    level = np.zeros(len(program.part_a), dtype=bool)
    rows = detected_rows(program, contacts)
    upright = np.linalg.norm(cross(program.normal[rows], program.down), axis=1) < BALANCED
    level[rows] = upright & np.isin(contacts.patch_kind, flat)[program.source[rows]]
    return level


def judge_level_rest(
    program: Program, level: Mask, proof: LevelRest, sharp: SharpPoints | None = None
) -> str:
    """Reason why a proof of rest on horizontal faces fails; empty if it is valid.

    Arguments: `level` (K,): rows of level faces (`level_rows`); `sharp`: sharp points, which a
    single normal may open; without them every row has to open.
    """
    if proof.forces.shape != level.shape or proof.motion.shape != (len(program.names), 6):
        return "its numbers do not match the parts and contacts"
    if not (np.isfinite(proof.forces).all() and np.isfinite(proof.motion).all()):
        return "its numbers are not finite"
    wrong = wrong_forces(program, level, proof.forces)
    return wrong or wrong_motion(program, level, proof.motion, sharp)


def wrong_forces(program: Program, level: Mask, forces: Array) -> str:
    """Reason why forces, (K,) [N], do not prove a rest on horizontal faces; empty if they do."""
    if not (forces >= 0).all() or forces[~level].any():
        return "a force acts at a face that is not horizontal"
    if not unbalanced(program, forces) <= BALANCED:
        return "its forces do not balance the load"
    carries = forces > CARRIES * forces.max(initial=TINY)
    bearing = bearing_of(program, level & carries)
    if bearing is None:
        return "parts support each other in a ring"
    return OPEN_TILT if _unsteady(program, bearing, forces).any() else ""


def rest_on_level(program: Program, level: Mask, forces: Array, owner: Index) -> Mask:
    """Mask of independent assemblies whose forces fix the height and the tilts of every part.

    The result is that of `wrong_forces` for each assembly, except that none is known to rest if
    parts of any assembly support each other in a ring.

    Arguments: `level` (K,): rows of level faces (`level_rows`); `forces` (K,): forces of an
    equilibrium [N]; `owner` (N,): assembly of each part, 0 to M - 1.
    """
    rests = np.zeros(int(owner.max(initial=-1)) + 1, dtype=bool)
    row_owner = owner[np.maximum(program.part_a, program.part_b)]
    largest = np.full(len(rests), TINY)
    np.maximum.at(largest, row_owner, forces)
    bearing = bearing_of(program, level & (forces > CARRIES * largest[row_owner]))
    if bearing is None:
        return rests
    wrong = ~(imbalances(program, forces) <= BALANCED) | _unsteady(program, bearing, forces)
    rests[:] = True
    rests[owner[wrong]] = False
    rests[row_owner[(forces < 0) | ((forces != 0) & ~level)]] = False
    return rests


def _unsteady(program: Program, bearing: Bearing, forces: Array) -> Mask:
    """Mask of the parts for which an exact correction of the forces may make a force negative.

    The y of each part corrects the balance of its load and of the parts above it, the highest part
    first. The imbalance that the tolerance allows changes no force by more than half, either.
    """
    rows, upper, lower = bearing.rows, bearing.upper, bearing.lower
    above, below = bearing.footings(program)
    count, force = len(program.names), forces[rows, None]
    grams = sums_by_part(upper, force[:, :, None] * above[:, :, None] * above[:, None, :], count)
    size = np.trace(grams, axis1=1, axis2=2)
    free = np.flatnonzero(program.free)
    unsteady = np.zeros(count, dtype=bool)
    unsteady[free] = ~(np.linalg.eigvalsh(grams[free])[:, 0] > SPREAD * size[free])
    fixed = np.flatnonzero(program.free & ~unsteady)
    inverse = np.zeros_like(grams)
    inverse[fixed] = np.linalg.inv(grams[fixed])
    reach = np.linalg.norm(np.einsum("kij,kj->ki", inverse[upper], above), axis=1)
    unsteady[upper[~(BEARS * BALANCED * size[upper] * reach < MOST_CHANGED)]] = True
    load = in_footing(program, -program.load)
    miss = np.vstack([load, np.zeros(load.shape[1])])  # the ground is the last
    miss += sums_by_part(lower % len(miss), force * below, len(miss))
    miss -= sums_by_part(upper, force * above, len(miss))
    for level in by_depth(bearing.depth[upper]):
        y = np.einsum("kij,kj->ki", inverse[upper[level]], miss[upper[level]])
        change = np.einsum("ki,ki->k", above[level], y)
        unsteady[upper[level][~(np.abs(change) < MOST_CHANGED)]] = True
        more = force[level] * change[:, None] * below[level]
        miss += sums_by_part(lower[level] % len(miss), more, len(miss))
    return unsteady


def wrong_motion(
    program: Program, level: Mask, motion: Array, sharp: SharpPoints | None = None
) -> str:
    """Reason why a motion, (N, 6), is not horizontal or opens too few contacts; else empty."""
    if motion[~program.free].any():
        return "its motion moves held parts"
    moved = np.vstack([motion[:, :3], np.zeros(3)])  # the ground is the last
    size = float(np.abs(moved).max(initial=0.0))
    flat = level_axes(program)
    off = np.abs(moved - moved @ flat.T @ flat).max(initial=0.0)
    if size == 0 or off > ACROSS * size or motion[:, 3:].any():
        return "its motion is not a horizontal shift of the parts"
    apart = moved[program.part_b] - moved[program.part_a]
    opens = np.einsum("ij,ij->i", program.normal, apart) > DROPS * size
    if sharp is not None:
        opens = sharp.opened(opens)
    return "" if opens[~level].all() else "its motion does not open the other contacts"
