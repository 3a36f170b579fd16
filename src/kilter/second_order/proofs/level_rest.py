"""What stands on level faces is free by proof, at any size, without a form of a gap.

A level motion of a part moves it across gravity and turns it about the vertical. Where a level
face touches a face, an edge or a corner, no level motion changes the gap, and none changes the
energy. With forces f of equilibrium on such contacts alone, let S be those with f > 0:

    every part stands on points of S that are on no line, and no parts bear one another around

Then what bears a part holds its height and its tilts, from below to the top: J_S is one to one.

Near the place, at each choice x of level motions of all parts, there are forces f(x) > 0 on
S that still balance, and with t the heights and tilts

    E - E_0 = sum over S of f_k(x) J_k(x) t,     J_k(x) t >= -O(t^2),     J_S(x) one to one,

so that E > E_0 unless t = 0: the energy is least, and least on the level motions alone. One level
motion that opens all the other contacts shows that they span what is neutral.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kilter.arrays import TINY, Array, Mask, read_only
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import NUMBER, SIX, Form, keys, list_of, named
from kilter.second_order.gaps.features_of import FLAT, detected_rows
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
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Outcome
from kilter.second_order.proofs.held import unbalanced
from kilter.second_order.proofs.proof_numbers import named_motion, read_motion
from kilter.second_order.second_order_tolerances import (
    ACROSS,
    BALANCED,
    BEARS,
    CARRIES,
    DROPS,
    SPREAD,
)

__all__ = ["LevelRest", "judge_level_rest", "level_rows", "wrong_forces", "wrong_motion"]

MOST_CHANGED = 0.5
"""Share of a force that may be lacking for it to balance the load exactly."""
OPEN_TILT = "its forces leave the tilt of a part open"


@dataclass(frozen=True, slots=True, eq=False)
class LevelRest:
    """A proof that the level motions are what is neutral, and free.

    `forces`, shape (K,) [N]; `motion`, shape (N, 6): a level one, the part that moves most by 1
    length unit.
    """

    FORM: ClassVar[Form] = keys(level=list_of(NUMBER), motion=named(SIX))
    SURFACES: ClassVar[str] = "none"
    forces: Array
    motion: Array

    def __post_init__(self) -> None:
        read_only(self)

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """Data of a proof file."""
        return {"level": self.forces.tolist(), "motion": named_motion(program, self.motion)}

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> LevelRest:
        """The proof from its data."""
        motion = read_motion(facts.program, data["motion"])
        return cls(np.array(data["level"], dtype=float), motion)

    def judge(self, facts: ClusterFacts) -> str:
        """Why the proof does not hold; empty if it holds."""
        program, contacts = facts.program, facts.contacts
        level, sharp = level_rows(program, contacts), sharp_points(program, contacts)
        return judge_level_rest(program, level, self, sharp)

    def outcome(self, facts: ClusterFacts) -> Outcome:
        """Every part slides freely on its level faces, and turns about the vertical."""
        free = int(facts.program.free.sum()) * (1 if facts.program.planar else 3)
        return "free", free, free


def level_rows(program: Program, contacts: ContactSet) -> Mask:
    """Rows of level faces that were found, shape (K,)."""
    flat = [kind for kind in FLAT if kind != "edge-edge"]
    level = np.zeros(len(program.part_a), dtype=bool)
    rows = detected_rows(program, contacts)
    upright = np.linalg.norm(np.cross(program.normal[rows], program.down), axis=1) < BALANCED
    level[rows] = upright & np.isin(contacts.patch_kind[program.source[rows]], flat)
    return level


def judge_level_rest(
    program: Program, level: Mask, proof: LevelRest, sharp: SharpPoints | None = None
) -> str:
    """Why a proof does not hold; empty where it does.

    Parameters
    ----------
    program : Program
    level : ndarray of bool, shape (K,)
        Rows of level faces (`level_rows`).
    proof : LevelRest
    sharp : SharpPoints, optional
        Points of which one row is enough to open (`sharp_points`); without, each row is.
    """
    if proof.forces.shape != level.shape or proof.motion.shape != (len(program.names), 6):
        return "its numbers are not those of the parts and contacts"
    if not (np.isfinite(proof.forces).all() and np.isfinite(proof.motion).all()):
        return "its numbers are not finite"
    wrong = wrong_forces(program, level, proof.forces)
    return wrong or wrong_motion(program, level, proof.motion, sharp)


def wrong_forces(program: Program, level: Mask, forces: Array) -> str:
    """Why forces, shape (K,) [N], are not those of a rest on level faces; empty where they are."""
    if not (forces >= 0).all() or forces[~level].any():
        return "a force is none of a level face"
    if not unbalanced(program, forces) <= BALANCED:
        return "its forces do not balance the load"
    carries = forces > CARRIES * forces.max(initial=TINY)
    bearing = bearing_of(program, level & carries)
    if bearing is None:
        return "parts bear one another around"
    return _wrong_tilts(program, bearing, forces)


def _wrong_tilts(program: Program, bearing: Bearing, forces: Array) -> str:
    """Why forces that balance to the last digit, f (1 + y . (1, u, v)), do not all push.

    y of each part makes good what its own forces miss of its load and of what bears on it, the
    highest part first. What may be out of balance changes no force by more than that, either.
    """
    rows, upper, lower = bearing.rows, bearing.upper, bearing.lower
    above, below = bearing.footings(program)
    count, own = len(program.names), forces[rows, None]
    grams = sums_by_part(upper, own[:, :, None] * above[:, :, None] * above[:, None, :], count)
    size = np.trace(grams, axis1=1, axis2=2)
    spread = np.linalg.eigvalsh(grams[program.free])[:, 0]
    if not (spread > SPREAD * size[program.free]).all():
        return OPEN_TILT
    inverse = np.zeros_like(grams)
    inverse[program.free] = np.linalg.inv(grams[program.free])
    reach = np.linalg.norm(np.einsum("kij,kj->ki", inverse[upper], above), axis=1)
    if not (BEARS * BALANCED * size[upper] * reach < MOST_CHANGED).all():
        return OPEN_TILT
    load = in_footing(program, -program.load)
    miss = np.vstack([load, np.zeros(load.shape[1])])  # the ground is the last
    miss += sums_by_part(lower % len(miss), own * below, len(miss))
    miss -= sums_by_part(upper, own * above, len(miss))
    for some in by_depth(bearing.depth[upper]):
        y = np.einsum("kij,kj->ki", inverse[upper[some]], miss[upper[some]])
        change = np.einsum("ki,ki->k", above[some], y)
        if not (np.abs(change) < MOST_CHANGED).all():
            return OPEN_TILT
        more = own[some] * change[:, None] * below[some]
        miss += sums_by_part(lower[some] % len(miss), more, len(miss))
    return ""


def wrong_motion(
    program: Program, level: Mask, motion: Array, sharp: SharpPoints | None = None
) -> str:
    """Why a motion, shape (N, 6), is no level one that opens the other contacts."""
    if motion[~program.free].any():
        return "its motion moves what is held"
    moved = np.vstack([motion[:, :3], np.zeros(3)])  # the ground is the last
    size = float(np.abs(moved).max(initial=0.0))
    flat = level_axes(program)
    off = np.abs(moved - moved @ flat.T @ flat).max(initial=0.0)
    if size == 0 or off > ACROSS * size or motion[:, 3:].any():
        return "its motion is not a level shift of the parts"
    apart = moved[program.part_b] - moved[program.part_a]
    opens = np.einsum("ij,ij->i", program.normal, apart) > DROPS * size
    if sharp is not None:
        opens = sharp.opened(opens)
    return "" if opens[~level].all() else "its motion does not open the other contacts"
