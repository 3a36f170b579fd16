"""The bodies of a state of MuJoCo: which are held, their parts, joints, loads and contacts.

    held        bodies welded to the world or to a mocap body, and robots
    robot       the bodies of a tree on the world of which a motor drives a joint
    pressing    the last body of a robot's branch, on a driven hinge or slide, if it touches a
                loose body and its motor pushes it: its contacts carry the rest of its force
    locked      driven joints of a tree on a free joint: its bodies move as one

All other bodies are parts. A pressing body is a part on its joint, with the force of its motor as a
load. The generalised forces of motors, springs and gravity compensation, and forces that the user
applies, are loads: a force along a slide, a torque about a hinge, and the opposite on the body
above. Bodies between several joints in sequence have almost no mass.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from kilter.analysis.engine_contacts.given_contacts import WORLD, ContactArrays, stand_in
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly, Feature, Part
from kilter.assembly.geometry import MassProperties
from kilter.assembly.interactions import Joint, Load
from kilter.assembly.part import GROUND, inertia_fault, inertia_numbers
from kilter.errors import InputError
from kilter.files.meshes.placed import distinct
from kilter.files.objects.mujoco_joints import BALL, CONNECT, FREE, HINGE, KINDS, SLIDE, WELD
from kilter.files.objects.mujoco_shapes import BOX, CAPSULE, CYLINDER, MESH, PLANE, SPHERE
from kilter.files.objects.mujoco_state import EngineState

BODY, SITE = 1, 6
"""MuJoCo's numbers for the objects that an equality ties."""
PRESSES = 0.05
"""A motor pushes if this share of its force is not balanced by the weight of its body [-]."""
LIGHT = 1e-6
"""Mass of a body between two joints in sequence, over that of the body behind them [-]."""
ALONG, ACROSS = 0.999, 1e-3
"""Cosine between a normal and the axis of a cylinder: above, it is that of a flat end; below, that
of the side [-]."""
FLAT = Feature("face")
"""Feature of a surface without curvature: a corner on a face counts as two faces."""
FLATS = (FLAT, FLAT)
"""Features of a contact without curvature."""


@dataclass(frozen=True, slots=True, eq=False)
class PressingBody:
    """A body that a motor presses against loose bodies."""

    body: int
    force: float
    """Force along the slide [N], or torque about the hinge [N m], without the weight."""
    slides: bool


@dataclass(frozen=True, eq=False)
class EngineBodies:
    """Bodies of a state, as parts of an assembly of given contacts."""

    state: EngineState
    loose_robots: bool = False
    """Whether robots move, with the forces of all their motors as loads."""
    notes: list[str] = field(default_factory=list)
    """Features that are left out."""

    def __post_init__(self) -> None:
        if not self.state.gravity.any():
            raise InputError(
                "the model has no gravity",
                hint="give it gravity, and enable gravity in its flags",
            )
        self.notes.extend(self.state.notes)

    # bodies that move together, trees and motors ----------------------------------------

    @cached_property
    def fixed(self) -> Mask:
        """Mask of the bodies that are welded to the world or to a mocap body, (N,)."""
        weld = self.state.body_weldid
        return np.asarray((weld == 0) | (self.state.body_mocapid[weld] >= 0))

    @cached_property
    def tree(self) -> list[int]:
        """The first moving body above each body; the body itself for a fixed body, N numbers."""
        tree = list(range(len(self.fixed)))
        for body in range(1, len(tree)):  # parents come first
            above = int(self.state.body_parentid[body])
            if not self.fixed[body] and not self.fixed[above]:
                tree[body] = tree[above]
        return tree

    def joints_of(self, body: int) -> list[int]:
        """The joints between a body and its parent."""
        first = int(self.state.body_jntadr[body])
        return list(range(first, first + int(self.state.body_jntnum[body])))

    def _driven(self, joint: int) -> bool:
        """Whether a motor drives a hinge or slide, or a freedom of a ball."""
        kind, first = int(self.state.jnt_type[joint]), int(self.state.jnt_dofadr[joint])
        if kind == FREE:
            return False
        return bool(self.state.driven[first : first + (3 if kind == BALL else 1)].any())

    @cached_property
    def robots(self) -> set[int]:
        """First bodies of the trees with driven joints."""
        if self.loose_robots:
            return set()
        driven = filter(self._driven, range(len(self.state.jnt_type)))
        return {self.tree[int(self.state.jnt_bodyid[joint])] for joint in driven}

    def _floats_free(self, body: int) -> bool:
        """Whether the first moving body above a body has a free joint."""
        rows = self.joints_of(self.tree[body])
        return bool(rows) and int(self.state.jnt_type[rows[0]]) == FREE

    @cached_property
    def pressing(self) -> dict[int, PressingBody]:
        """Bodies of robots that motors press against loose bodies, by body."""
        state = self.state
        weld = state.body_weldid
        parents = {int(weld[state.body_parentid[b]]) for b in np.unique(weld).tolist() if b}
        touching = weld[state.geom_bodyid[state.geoms]]
        result: dict[int, PressingBody] = {}
        for body in np.unique(weld).tolist():
            rows = self.joints_of(body)
            if self.tree[body] not in self.robots or self._floats_free(body) or body in parents:
                continue
            if len(rows) != 1 or not self._driven(rows[0]):
                continue
            if int(state.jnt_type[rows[0]]) not in (HINGE, SLIDE):
                continue
            ends = touching[(touching == body).any(axis=1)]
            loose = [b for b in np.unique(ends).tolist() if b != body and self._loose(b)]
            force, dof = self._force(rows[0]), int(state.jnt_dofadr[rows[0]])
            rest = force - state.qfrc_bias[dof]
            if loose and abs(rest) > PRESSES * abs(state.qfrc_actuator[dof]):
                slides = int(state.jnt_type[rows[0]]) == SLIDE
                result[body] = PressingBody(body, float(state.qfrc_actuator[dof]), slides)
        return result

    def _loose(self, body: int) -> bool:
        """Whether a body neither is fixed nor belongs to a robot on the world."""
        robot = self.tree[body] in self.robots and not self._floats_free(body)
        return not (self.fixed[body] or robot)

    @cached_property
    def held(self) -> Mask:
        """Mask of the bodies that are held, (N,)."""
        bodies = enumerate(self.state.body_weldid.tolist())
        return np.array([not (self._loose(b) or root in self.pressing) for b, root in bodies])

    @property
    def held_by_motors(self) -> list[str]:
        """Names of the bodies that are held as bodies of robots."""
        return [
            self.names[b] for b in np.flatnonzero(self.held & ~self.fixed).tolist()
            if self.state.body_weldid[b] == b
        ]  # fmt: skip

    # parts ------------------------------------------------------------------------------

    @cached_property
    def names(self) -> list[str]:
        """A name for each body; that of the world is not used."""
        given = self.state.names
        return distinct(["world", *(given[b] or f"body_{b}" for b in range(1, len(given)))])

    @cached_property
    def movers(self) -> list[int]:
        """First bodies of all moving groups of bodies, one for each part."""
        weld = self.state.body_weldid
        return [b for b in np.unique(weld).tolist() if not self.held[b]]

    @cached_property
    def _masses(self) -> dict[int, MassProperties]:
        """Mass properties of the bodies that move together, by their first body."""
        state, masses = self.state, dict[int, list[MassProperties]]()
        for body in range(1, len(state.names)):
            if state.body_mass[body] > 0 and not self.held[body]:
                turn = state.ximat[body].reshape(3, 3)
                inertia = turn @ np.diag(state.body_inertia[body]) @ turn.T
                own = MassProperties(float(state.body_mass[body]), state.xipos[body], inertia)
                masses.setdefault(int(state.body_weldid[body]), []).append(own)
        return {body: MassProperties.sum(each) for body, each in masses.items()}

    @cached_property
    def _places(self) -> dict[int, int]:
        """Index of the part of each moving group of bodies, in the contacts of `arrays`."""
        return {body: k for k, body in enumerate(self.movers)}

    @cached_property
    def _geom_parts(self) -> tuple[Index, list[str]]:
        """Index of the part of each geom, (ngeom,), and the names of the held parts, in order.

        Held parts follow the moving ones; only held bodies in a contact have a part.
        """
        state = self.state
        names: list[str] = []
        index = np.full(len(state.geom_bodyid), -1)
        known: dict[tuple[int, int], int] = {}
        for geom in np.unique(state.geoms).tolist():
            body = int(state.geom_bodyid[geom])
            root = int(state.body_weldid[body])
            if root in self._places:
                index[geom] = self._places[root]
                continue
            key = (body, geom if body == 0 else -1)
            if key not in known:
                known[key] = len(self.movers) + len(names)
                names.append(self.names[body] if body else state.geom_names[geom] or "world")
            index[geom] = known[key]
        return index, names

    @cached_property
    def kept(self) -> Index:
        """Indices of the contacts that a moving part has, shape (K,)."""
        index, _ = self._geom_parts
        ends = index[self.state.geoms]
        return np.flatnonzero((ends < len(self.movers)).any(axis=1) & (ends[:, 0] != ends[:, 1]))

    @cached_property
    def ends(self) -> Index:
        """Indices of the parts of each kept contact, shape (K, 2)."""
        ends: Index = self._geom_parts[0][self.state.geoms[self.kept]]
        return ends

    @cached_property
    def part_names(self) -> list[str]:
        """Names of the parts: the moving ones in the order of `movers`, then the held ones."""
        return distinct([*(self.names[b] for b in self.movers), *self._geom_parts[1]])

    @cached_property
    def _features(self) -> tuple[list[tuple[Feature, Feature] | None], Mask]:
        """Features of the kept contacts; mask of the parts with a contact of unknown curvature."""
        state = self.state
        odd = np.zeros(len(self.part_names), dtype=bool)
        pairs: list[tuple[Feature, Feature] | None] = []
        for row, ends in zip(self.kept.tolist(), self.ends.tolist(), strict=True):
            normal = state.normals[row]
            sides = [
                self._feature(int(geom), sense * normal)
                for geom, sense in zip(state.geoms[row], (1, -1), strict=True)
            ]
            odd[ends] |= None in sides
            first, second = sides
            if first is FLAT and second is FLAT:
                pairs.append(FLATS)
            else:
                pairs.append(None if first is None or second is None else (first, second))
        return pairs, odd

    def _feature(self, geom: int, outward: Array) -> Feature | None:
        """The feature of a geom at a contact; None if its curvature is not known."""
        state = self.state
        kind, radius = int(state.geom_type[geom]), float(state.geom_size[geom][0])
        axis = state.geom_xmat[geom].reshape(3, 3)[:, 2]
        slope = abs(float(axis @ outward))
        if kind in (PLANE, BOX, MESH) or (kind == CYLINDER and slope > ALONG):
            return FLAT
        if kind == SPHERE or (kind == CAPSULE and slope > ACROSS):
            return Feature("face", curvature=1 / radius)
        if kind in (CYLINDER, CAPSULE) and slope <= ACROSS:
            along = axis - (axis @ outward) * outward
            return Feature("face", along, (0.0, 1 / radius))
        return None

    # joints and loads -------------------------------------------------------------------

    def _force(self, joint: int) -> float:
        """Force of motor, springs, gravity compensation and user along a hinge or slide."""
        return float(self._forces[int(self.state.jnt_dofadr[joint])])

    @cached_property
    def _forces(self) -> Array:
        """Generalised forces beside weight and constraints, shape (V,)."""
        state = self.state
        return np.asarray(state.qfrc_passive + state.qfrc_actuator + state.qfrc_applied)

    def _end(self, body: int) -> str:
        """The name of the part that a body belongs to; that of the ground if it is held."""
        root = int(self.state.body_weldid[body])
        return self.part_names[self._places[root]] if root in self._places else GROUND

    def _mechanisms(self) -> tuple[list[Joint], list[Load], list[Part]]:
        """Joints between bodies and their parents, loads, and bodies between joints in sequence."""
        joints: list[Joint] = []
        loads: list[Load] = []
        between: list[Part] = []
        for body in self.movers:
            name = self._end(body)
            above = self._end(int(self.state.body_parentid[body]))
            rows = self.joints_of(body)
            # the joint of the body is the last in the sequence
            for n, row in enumerate(reversed(rows)):
                kind = int(self.state.jnt_type[row])
                if kind == FREE:
                    loads += self._free_loads(name, body, row)
                    continue
                last = n == len(rows) - 1
                next_name = above if last else f"{self._end(body)}/{len(rows) - 1 - n}"
                if not last:
                    between.append(self._link(next_name, body))
                joints.append(self._joint((name, next_name), row, locked=self._locked(row)))
                loads += self._joint_loads((name, next_name), row)
                name = next_name
        return joints, loads, between

    def _locked(self, joint: int) -> bool:
        """Whether a joint is driven, in a tree on a free joint."""
        body = int(self.state.jnt_bodyid[joint])
        return self._driven(joint) and self._floats_free(body) and not self.loose_robots

    def _link(self, name: str, body: int) -> Part:
        """A part of almost no mass at the anchor of a body's joints."""
        mass = self._masses[body].mass * LIGHT
        size = float(np.sqrt(np.trace(self._masses[body].inertia) / self._masses[body].mass))
        return Part(name, stand_in(size, curved=False), self._masses[body].center, mass=mass)

    def _joint(self, ends: tuple[str, str], row: int, *, locked: bool) -> Joint:
        """The joint of a row of the model; its limits contain the present position."""
        state, kind = self.state, int(self.state.jnt_type[row])
        point, axis = state.xanchor[row], state.xaxis[row]
        if locked:
            return Joint(ends, "fixed", point=point)
        if kind == BALL:
            return Joint(ends, "spherical", point=point)
        limits = None
        if state.jnt_limited[row]:
            low, high = (state.jnt_range[row] - state.qpos[state.jnt_qposadr[row]]).tolist()
            limits = (min(low, 0.0), max(high, 0.0))
        friction = float(state.dof_frictionloss[state.jnt_dofadr[row]])
        word: Any = KINDS[kind]
        return Joint(ends, word, point=point, axis=axis, limits=limits, friction=friction)

    def _free_loads(self, name: str, body: int, row: int) -> list[Load]:
        """The load of the generalised forces at a free joint."""
        first = int(self.state.jnt_dofadr[row])
        force = self._forces[first : first + 6]
        if not force.any():
            return []
        torque = self.state.xmat[body].reshape(3, 3) @ force[3:]
        return [Load(name, force=force[:3], torque=torque, point=self.state.xpos[body])]

    def _joint_loads(self, ends: tuple[str, str], row: int) -> list[Load]:
        """The loads of the generalised force of a joint on both of its parts."""
        state, kind = self.state, int(self.state.jnt_type[row])
        first = int(state.jnt_dofadr[row])
        if kind == BALL:
            turn = state.xmat[state.jnt_bodyid[row]].reshape(3, 3)
            torque, force = turn @ self._forces[first : first + 3], np.zeros(3)
        else:
            along = self._forces[first] * state.xaxis[row]
            force, torque = (along, np.zeros(3)) if kind == SLIDE else (np.zeros(3), along)
        return [
            Load(name, force=sense * force, torque=sense * torque, point=state.xanchor[row])
            for name, sense in zip(ends, (1.0, -1.0), strict=True)
            if name != GROUND and (force.any() or torque.any())
        ]

    def _applied(self) -> list[Load]:
        """Forces and torques at the centres of mass of bodies, as the user applies them."""
        state = self.state
        return [
            Load(
                self._end(body),
                force=state.xfrc_applied[body, :3],
                torque=state.xfrc_applied[body, 3:],
                point=state.xipos[body],
            )
            for body in np.flatnonzero(state.xfrc_applied.any(axis=1)).tolist()
            if self._end(body) != GROUND
        ]

    def _equalities(self) -> list[Joint]:
        """Joints for the active welds and connections of bodies."""
        state, joints, left = self.state, list[Joint](), 0
        for k in np.flatnonzero(state.active).tolist():
            kind, what = int(state.eq_type[k]), int(state.eq_objtype[k])
            ids = [int(state.eq_obj1id[k]), int(state.eq_obj2id[k])]
            if kind not in (CONNECT, WELD) or what not in (BODY, SITE):
                left += 1
                continue
            bodies = ids if what == BODY else [int(state.site_bodyid[n]) for n in ids]
            ends = [self._end(body) for body in bodies]
            if ends[0] == ends[1]:
                continue
            if what == SITE:
                point = state.site_xpos[ids[0]]
            else:
                anchor = state.eq_data[k][:3] if kind == CONNECT else np.zeros(3)
                point = state.xpos[ids[0]] + state.xmat[ids[0]].reshape(3, 3) @ anchor
            first, second = ends if ends[0] != GROUND else ends[::-1]
            joints.append(
                Joint((first, second), "spherical" if kind == CONNECT else "fixed", point=point)
            )
        if left:
            self.notes.append(f"ignored equalities other than welds and connections: {left}")
        return joints

    # the assembly -----------------------------------------------------------------------

    def assembly(self) -> Assembly | None:
        """The moving bodies with the engine's contacts; None if no body moves."""
        if not self.movers:
            return None
        state, kept = self.state, self.kept
        features, odd = self._features
        # an odd part has the shape of a ball, on which contacts without a feature are unknown
        contacts = ContactArrays(
            state.points[kept], state.normals[kept], state.mu[kept], self.ends, features
        )
        every = [self._masses[body] for body in self.movers]
        sizes = contacts.sizes(np.array([each.center for each in every]))
        parts = [
            Part(name, stand_in(size, curved=bool(round_)), each.center, mass=each.mass,
                 inertia=_possible_inertia(each))
            for name, size, round_, each in zip(
                self.part_names[: len(every)], sizes.tolist(), odd, every, strict=False)
        ]  # fmt: skip
        joints, loads, between = self._mechanisms()
        if state.turning:
            self.notes.append(
                f"torsional and rolling friction is left out, which may hold more: "
                f"{state.turning} contacts"
            )
        return contacts.assembly(
            parts,
            self.part_names[len(every) :] or [WORLD],
            more=between,
            gravity=state.gravity,
            joints=[*joints, *self._equalities()],
            loads=[*loads, *self._applied()],
        )


def _possible_inertia(body: MassProperties) -> Array | None:
    """The six moments of inertia of a body; None if no body can have them."""
    matrix = (body.inertia + body.inertia.T) / 2
    return None if inertia_fault(matrix) else inertia_numbers(matrix)
