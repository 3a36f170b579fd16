"""Proof that parts fall: a path that leads down, and an exact lower place on it.

All parts are apart at that place, and all joints are closed. Parts that touch at a plane may also
have shifted along it: then the plane separates them no less than before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kilter.arrays import TINY, Array
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import SIX, Form, keys, named, nullable
from kilter.second_order.gaps.joint_forms import (
    close_joints,
    joints_closed,
    of_joints,
    on_joints,
    spring_excess,
)
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_motions import scaled_columns
from kilter.second_order.motions.sharp_points import opens_points
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.parts.separation import least_separation
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Judged
from kilter.second_order.proofs.minimum_proof import (
    by_part,
    named_motion,
    read_columns,
    read_motion,
)
from kilter.second_order.proofs.paths import Path, judge_path
from kilter.second_order.second_order_tolerances import (
    ACROSS,
    APART,
    KEEPS,
)

# Falling paths z(t) = t dp + t^2 d2 / 2 along which no gap closes and energy decreases.


STEPS = (0.004, 0.002, 0.001, 0.01, 0.02, 0.05)
"""Steps t along a path at which a configuration is tried, in this order [-]."""
BENT = 0.5
"""Largest second-order part of a step, over its first-order part [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Configuration:
    """Exact configuration on a falling path, with lower energy and without penetration."""

    motion: Array
    """Shift of each centre of mass [length unit] and rotation vector [rad], shape (N, 6); a
    rigid group moves as its first part."""
    apart: float
    """Least separation of two parts that have not only shifted along a plane [length unit]."""
    energy: float
    """Energy of the loads, relative to the start [N x length unit]."""


@dataclass(frozen=True, slots=True, eq=False)
class Fall:
    """Proof that parts fall: a path of decreasing energy, and an exact configuration on it.

    The motion has shape (N, 6). It is None if the path alone is the proof (`by_path_alone`).
    """

    FORM: ClassVar[Form] = keys(
        first=named(SIX), second=named(SIX), configuration=nullable(named(SIX))
    )
    SURFACES: ClassVar[str] = "all"
    path: Path
    place: Array | None

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof of a fall, for a proof file."""
        assert problem is not None
        return {
            "first": by_part(program, problem, self.path.first),
            "second": by_part(program, problem, self.path.second),
            "configuration": None if self.place is None else named_motion(program, self.place),
        }

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> Fall:
        """Read a proof of a fall from JSON data; its path is judged at the least curvatures."""
        program, problem = facts.program, facts.certain.bounded(-1.0)
        first, second = (read_columns(program, problem, data[key]) for key in ("first", "second"))
        place = data["configuration"]
        return cls(
            judge_path(problem, first, second),
            None if place is None else read_motion(program, place),
        )

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof of a fall: the reason of failure, or the state and counts it proves."""
        path, wrong = self.path, []
        if abs(float(np.linalg.norm(path.first)) - 1) > ACROSS or not path.falls:
            wrong.append("the energy does not decrease along its path")
        wrong += self._wrong_place(facts.certain)
        if facts.certain is not facts:
            scale = facts.certain.problem.scale
            assert scale is not None
            motion = facts.program.full(path.first * scale)
            if not opens_points(facts.program, facts.contacts, motion):
                wrong.append("its path does not open edges and corners without a unique normal")
        return "; ".join(wrong) or ("balanced", None, None)

    def _wrong_place(self, facts: ClusterFacts) -> list[str]:
        """Reasons why the configuration is not on the path, not lower or penetrates; else empty."""
        program, problem = facts.program, facts.bounded(-1.0)
        if self.place is None:
            if by_path_alone(facts) and self.path.one_form:
                return []
            return ["it has no configuration with lower energy and without penetration"]
        columns = scaled_columns(program, problem, self.place[None])[:, 0]
        joints = facts.assembly.joints
        if not is_on(self.path, columns, jointed=bool(on_joints(program).any())):
            return ["its configuration is not on its path"]
        wrong = []
        if not joints_closed(program, joints, self.place, problem.length):
            wrong.append("a joint is open in its configuration")
        apart = separation_at(facts.assembly, facts.contacts, program, problem, self.place)
        if apart is None or not apart > APART * problem.length:
            wrong.append("parts penetrate each other in its configuration")
        if not -_energy(facts.assembly, program, problem, columns, self.place) > APART:
            wrong.append("the energy of its configuration is not lower")
        return wrong


def by_path_alone(facts: ClusterFacts) -> bool:
    """True if the bodies are not known exactly, so that only the path can be the proof.

    So it is for given contacts, and for surfaces that were recognised in meshes.
    """
    patches = facts.program.source[~of_joints(facts.program)]
    given = facts.contacts.patch_kind[patches] == "given"
    return facts.features.doubted or bool(len(given) and given.all())


def separation_at(
    assembly: Assembly, contacts: ContactSet, program: Program, problem: Stationary, motion: Array
) -> float | None:
    """Least separation of neighbouring parts after a motion [length unit]; None if unknown.

    Rigid groups move as their first parts. None if the separation of some surfaces is unknown.
    """
    groups = RigidGroups.of(assembly)
    touching = ~of_joints(program)
    return least_separation(
        assembly,
        groups.apart(program.taking(touching), assembly, contacts),
        groups.placed(motion),
        beyond=0.01 * problem.length,
        planes=None if problem.on_plane is None else problem.on_plane[touching],
        tied=groups.first,
        jointed=groups.jointed_pairs(assembly),
    )


def is_on(path: Path, columns: Array, *, jointed: bool = False) -> bool:
    """True if a configuration, shape (n,) in scaled unknowns, is on a path near its start.

    With joints it may be beside the path by less than the second-order part of the path.
    """
    along, bend = columns @ path.first, path.second @ path.first
    if not (along > 0 and 1 + 2 * along * bend >= 0):
        return False
    step = 2 * along / (1 + np.sqrt(1 + 2 * along * bend))  # along = step + bend step^2 / 2
    bent = step**2 * path.second / 2
    near = min(max(STEPS), 2 * BENT / max(float(np.linalg.norm(path.second)), TINY))
    off = np.abs(columns - step * path.first - bent).max()
    far = step**2 if jointed else KEEPS * step  # joints are closed by a change of third order
    return bool(step <= near * (1 + ACROSS) and off <= far)


def _energy(
    assembly: Assembly, program: Program, problem: Stationary, columns: Array, place: Array
) -> float:
    """Energy of loads and springs at a place, over the weight and the length [-].

    `columns`, shape (n,), are the scaled unknowns of `place`, shape (N, 6).
    """
    springs = spring_excess(program, assembly.joints, place)
    return springs / (problem.weight * problem.length) - float(problem.load @ columns)


def find_configuration(
    assembly: Assembly, contacts: ContactSet, program: Program, problem: Stationary, path: Path
) -> tuple[Configuration | None, str]:
    """Find a configuration on a falling path without penetration; else None and the reason.

    Returns None if no examined configuration has these properties; the reason for None; otherwise
    empty.
    """
    assert problem.scale is not None
    for step in STEPS:
        bent = step**2 * path.second / 2
        if np.linalg.norm(bent) > BENT * step:
            continue
        columns = step * path.first + bent
        placed = program.full(columns * problem.scale)
        motion = close_joints(program, assembly.joints, placed, problem.length)
        if motion is None:
            continue
        columns = scaled_columns(program, problem, motion[None])[:, 0]
        if not is_on(path, columns, jointed=bool(on_joints(program).any())):
            continue
        if not joints_closed(program, assembly.joints, motion, problem.length):
            continue
        energy = _energy(assembly, program, problem, columns, motion)
        apart = separation_at(assembly, contacts, program, problem, motion)
        if apart is None:
            return (
                None,
                "a path leads down, but the separation of some surfaces is not known exactly",
            )
        if apart > APART * problem.length and energy < -APART:
            return Configuration(motion, apart, energy * problem.weight * problem.length), ""
    return None, "a path leads down, but no exact configuration without penetration was found on it"
