"""Read MuJoCo models: bodies as parts, in the pose of a keyframe; the world is held.

A body is one part with its colliding geoms. Bodies without them are no objects, unless joints
connect them to others; in a model in which nothing collides all geoms count. Each geom of the world
is a held part, and a body fixed to the world is held. A plane is a table. Robots, which are bodies
that motors move, are held by default. Masses, centres and inertia are those of the compiled model,
and gravity compensation is a load. Hinges, slides and balls are joints without motors
(`kilter.files.objects.mujoco_joints`). Friction and filters of contacts are those of pairs of geoms
(`kilter.files.objects.mujoco_contacts`), and shapes those that MuJoCo collides
(`kilter.files.objects.mujoco_shapes`). Lengths are metres.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from kilter.arrays import Mask
from kilter.assembly import Assembly, Part
from kilter.assembly.interactions import Load
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.meshes.placed import distinct
from kilter.files.objects.mujoco_bodies import (
    groups,
    held_bodies,
    mass_fields,
    relieving_loads,
    robots,
)
from kilter.files.objects.mujoco_contacts import GeomRules, contact_entries
from kilter.files.objects.mujoco_joints import ModelJoints
from kilter.files.objects.mujoco_shapes import PLANE, GeomShapes
from kilter.files.objects.mujoco_snapshot import Snapshot, take_snapshot
from kilter.files.robots.one_body import (
    REACH,
    compose,
    held_note,
    near_pairs,
    one_body,
    plane_table,
)
from kilter.rigid import Pose
from kilter.shape.primitives import Shape, Sphere

DEFAULT_GRAVITY = np.array([0.0, 0.0, -9.81])
"""Gravity of MuJoCo by default [m/s^2]."""
LEAST_MASS = 1e-6
"""Least mass of the ball that shows a body without geoms [kg]."""


def read(value: Any, choices: FormatOptions) -> Assembly:
    """Convert a MuJoCo MjModel, MjSpec, or pair (MjModel, MjData) to a kilter assembly.

    Raises
    ------
    InputError
        If the object is none of these, or has geoms or joints that kilter does not support.
    """
    import mujoco

    model, data = value if isinstance(value, tuple) and len(value) == 2 else (value, None)
    if isinstance(model, mujoco.MjSpec):
        model = model.compile()
    if not isinstance(model, mujoco.MjModel) or not isinstance(data, mujoco.MjData | None):
        raise InputError(
            f"a mujoco {type(model).__name__} is not a model",
            hint="give an MjModel, an MjSpec, or (model, data)",
        )
    snapshot = take_snapshot(mujoco, model, data, choices.keyframe, choices.states)
    return ModelScene(snapshot, choices).assembly("")


KnownShapes = dict[tuple[int, ...], tuple[Shape, Pose, tuple[str, ...], int]]
"""Shape and pose of each part in the frame of its body, notes, and number of meshes that are
replaced by their hulls, by the geoms of the part."""


class ModelScene:
    """A MuJoCo model in a given pose, during its conversion to an assembly."""

    def __init__(
        self, model: Snapshot, choices: FormatOptions, known: KnownShapes | None = None
    ) -> None:
        if choices.units not in (None, "m"):
            raise InputError(
                f"MuJoCo is in m, but the units given are {choices.units}",
                hint="leave the units out",
            )
        self.model, self.notes = model, list[str](model.notes)
        self.known: KnownShapes = {} if known is None else known
        self.names = distinct([name or f"body_{k}" for k, name in enumerate(model.body_names)])
        self.rules = GeomRules(model)
        self.collides: Mask = self.rules.collides
        self.robots = [] if choices.loose_robots else robots(model)
        self.held: Mask = held_bodies(model)
        self.held[[body for tree in self.robots for body in tree]] = True
        """Bodies that do not move."""
        self.owner, self.unseen, self.left = groups(model, self.held, self.collides)
        self.members: dict[int, list[int]] = {}
        """The bodies of each part, by its body."""
        for body, owner in self.owner.items():
            self.members.setdefault(owner, []).append(body)
        self.shapes = GeomShapes(model, self.collides)
        self.planes: list[int] = []
        """Geoms that are planes."""
        self.geoms = self._geoms()
        self.hulls = 0
        """Number of geoms whose mesh is replaced by its hull."""
        self._same: dict[tuple[Any, ...], tuple[Shape, Pose]] = {}
        """United shapes, by the shapes that they unite; `shapes` keeps these alive."""
        self.parts: list[Part] = []
        self.rows: list[list[int]] = []
        """The geoms of each part."""
        self.bodies: list[int] = []
        """The body of each part; 0 for geoms of the world and planes."""

    def _geoms(self) -> dict[int, list[int]]:
        """For each part, by its body, its geoms: those that collide, else all; without planes."""
        geoms: dict[int, list[int]] = {body: [] for body in range(self.model.nbody)}
        for geom, body in enumerate(self.model.geom_bodyid.tolist()):
            geoms[self.owner.get(body, body)].append(geom)
        for body, rows in geoms.items():
            solid = [geom for geom in rows if self.collides[geom]]
            if self.collides.any() and body not in self.unseen:
                self.left += body == 0 and len(rows) - len(solid)
                rows = solid
            flat = [geom for geom in rows if self.model.geom_type[geom] == PLANE]
            self.planes += flat
            geoms[body] = [geom for geom in rows if geom not in flat] if flat else rows
        return geoms

    def assembly(self, source: str) -> Assembly:
        """The MuJoCo model as a kilter assembly."""
        self._assume_gravity()
        model = self.model
        for geom in self.geoms[0]:
            self._add(self._geom_name(geom), [geom], body=0, held=True)
        for body in range(1, model.nbody):
            if self.geoms[body] or body in self.unseen:
                self._add(self.names[body], self.geoms[body], body=body, held=self.held[body])
        self._add_planes()
        if not self.parts:
            raise self._emptiness(source)
        names = distinct([part.name for part in self.parts])
        parts = [replace(part, name=name) for part, name in zip(self.parts, names, strict=True)]
        for name, body in zip(names, self.bodies, strict=True):
            self.names[body] = name
        joints = ModelJoints(model, self._with_parts(), dict(enumerate(self.names)), self.held)
        connections = joints.all()
        parts += joints.frames
        self.rows += [[] for _ in joints.frames]
        near = near_pairs(parts, REACH)
        detect = not model.disabled & {"CONTACT", "CONSTRAINT"}
        if not detect:
            self.notes.append("the model disables all contacts")
            near = near[0][:0], near[1][:0]
        friction, pairs, apart = contact_entries(self.rules, parts, self.rows, near, self.notes)
        loads = self._loads()
        self._note_choices(joints)
        left = self._ignored_features(joints)
        return Assembly(
            parts,
            units="m",
            gravity=model.gravity,
            friction=friction,
            friction_pairs=pairs,
            contacts=apart,
            detect=detect,
            joints=connections,
            loads=loads,
            source=source,
            notes=[*self.notes, *([f"ignored: {left}"] if left else [])],
        )

    def part_names(self) -> dict[int, str]:
        """Name of the part of each body that has one, after `assembly`."""
        return {body: self.names[owner] for body, owner in self._with_parts().items()}

    def _with_parts(self) -> dict[int, int]:
        """The body whose part each body belongs to, for bodies that have a part."""
        own = set(self.bodies) - {0}
        return {body: owner for body, owner in self.owner.items() if owner in own}

    def _assume_gravity(self) -> None:
        """Give a model without gravity the default of MuJoCo, with a note."""
        if "GRAVITY" in self.model.disabled or not self.model.gravity.any():
            self.model = Snapshot(**{**vars(self.model), "gravity": DEFAULT_GRAVITY})
            self.notes.append(
                "the model has no gravity: MuJoCo's default of 9.81 m/s^2 along -z is assumed"
            )

    def _loads(self) -> list[Load]:
        """The forces of gravity compensation, with a note."""
        loads = relieving_loads(self.model, self.part_names(), self.held)
        if loads:
            self.notes.append(f"bodies whose gravity compensation is a load: {len(loads)}")
        return loads

    def _note_choices(self, joints: ModelJoints) -> None:
        """Append notes about robots, bodies without colliders, hulls and equalities."""
        bodies = sum(len(tree) for tree in self.robots)
        unseen = sum(part.geometry == "visual" for part in self.parts)
        notes = {
            held_note(len(self.robots), bodies): bodies,
            f"no objects, since nothing can touch them: {self.left} bodies and geoms": self.left,
            f"bodies without colliding geoms, whose visible geoms count: {unseen}": unseen,
            f"meshes that collide as their convex hull: {self.hulls}": self.hulls,
            "frames between the joints of a body, as parts of a millionth of its mass: "
            f"{len(joints.frames)}": len(joints.frames),
            "ignored equalities other than welds and connections of bodies: "
            f"{joints.ignored}": joints.ignored,
        }
        self.notes += [note for note, count in notes.items() if count]

    def _emptiness(self, source: str) -> InputError:
        """Error for a model without parts."""
        if self.model.nflex:
            return InputError(
                "the model has soft bodies only", hint="kilter judges rigid bodies: give it some"
            )
        if self.model.nbody > 1:
            return InputError("no body has a geom", hint="give its bodies geoms")
        if not source:
            return InputError("the model has no bodies", hint="give it bodies with geoms")
        return InputError(
            "the file has no bodies: it is made to be included",
            hint="give the scene that includes it",
        )

    def _geom_name(self, geom: int, unnamed: str = "world") -> str:
        """Name of the geom with an index, for parts of the world body."""
        return distinct([self.model.geom_names[geom] or unnamed])[0]

    def _add(self, name: str, geoms: list[int], *, body: int, held: bool) -> None:
        """Add the part of a body with the given geoms, or of a geom of the world (body 0)."""
        model, pose = self.model, Pose(self.model.xpos[body], self.model.xquat[body])
        key = tuple(geoms) or (-body,)
        if key not in self.known:
            self.known[key] = self._united(name, geoms, body, pose)
        shape, inner, told, hulls = self.known[key]
        self.notes += told
        self.hulls += hulls
        placed = compose(pose, inner)
        kinds = {True: "collider", False: "visual"}
        geometry = kinds[bool(self.collides[geoms].any())] if geoms else ""
        fields = mass_fields(model, self.members.get(body, []), placed, held=bool(held))
        if not held and fields and "inertia" not in fields:
            self.notes.append(f"no body has the inertia of {name!r:.80}: that of its shape counts")
        part = Part(name, shape, placed, grounded=bool(held), geometry=geometry, **fields)
        self.parts.append(part)
        self.rows.append(geoms)
        self.bodies.append(body)

    def _united(
        self, name: str, geoms: list[int], body: int, pose: Pose
    ) -> tuple[Shape, Pose, tuple[str, ...], int]:
        """The shape of a part, its pose in the body, notes about it, and its number of hulls.

        Equal bodies share their shape.
        """
        notes: list[str] = []
        before = self.shapes.hulls
        try:
            shapes = [self._placed(geom, body, pose) for geom in geoms]
            shapes = shapes or [self._marker(body, pose)]
            pieces = self.rules.pieces(geoms)
            places = [(id(s), p.position.tobytes(), p.rotation.tobytes()) for s, p in shapes]
            key = (*places, *pieces)
            made = self._same.get(key) or one_body(shapes, name, notes, pieces)
            if not notes:  # notes name the body
                self._same[key] = made
        except InputError as error:
            raise error.located(part=name) from None
        return *made, tuple(notes), self.shapes.hulls - before

    def _placed(self, geom: int, body: int, pose: Pose) -> tuple[Shape, Pose]:
        """Shape of a geom, and its pose relative to the body of a part with a pose."""
        model = self.model
        shape, place = self.shapes.placed(geom)
        own = int(model.geom_bodyid[geom])
        if own == body:
            return shape, place
        outer = compose(pose.inverse(), Pose(model.xpos[own], model.xquat[own]))
        return shape, compose(outer, place)

    def _marker(self, body: int, pose: Pose) -> tuple[Shape, Pose]:
        """A ball of the density of water for a body without geoms that connects joints."""
        mass = max(float(self.model.body_mass[body]), LEAST_MASS)
        center = pose.inverse().apply(self.model.xipos[body][None])[0]
        return Sphere((mass / 1000.0 * 0.75 / np.pi) ** (1 / 3)), Pose(center)

    def _add_planes(self) -> None:
        """Add a held table for each plane geom, large enough for all parts."""
        model, parts = self.model, list(self.parts)
        for geom in self.planes:
            body = int(model.geom_bodyid[geom])
            pose = compose(
                Pose(model.xpos[body], model.xquat[body]),
                Pose(model.geom_pos[geom], model.geom_quat[geom]),
            )
            name = self._geom_name(geom, self.names[body] if body else "floor")
            part = plane_table(name, pose, np.array(model.geom_size[geom][:2]), parts)
            self.parts.append(part)
            self.rows.append([geom])
            self.bodies.append(0)

    def _ignored_features(self, joints: ModelJoints) -> str:
        """List, as text, the model's features that affect motion but that kilter ignores."""
        model = self.model
        apart = (model.geom_margin > 0) & self.collides
        moving = np.flatnonzero(~self.held[model.jnt_bodyid])
        left = np.setdiff1d(moving, joints.guided)
        moving_dofs = np.flatnonzero(~self.held[model.dof_bodyid])
        friction = model.dof_frictionloss[
            np.setdiff1d(moving_dofs, model.jnt_dofadr[joints.guided])
        ]
        holding = int(np.count_nonzero((model.tendon_limited != 0) | (model.tendon_stiffness > 0)))
        counts = {
            "motors": 0 if self.robots else len(model.actuator_trntype),
            "springs": int(np.count_nonzero(model.jnt_stiffness[left])),
            "joint limits": int(np.count_nonzero(model.jnt_limited[left])),
            "tendons with limits or springs, which may hold parts": holding,
            "other tendons": model.ntendon - holding,
            "joint frictions": int(np.count_nonzero(friction)),
            "margins of geoms": int(np.count_nonzero(apart)),
            "margins of pairs": int(np.count_nonzero(model.pair_margin)),
            "second sliding coefficients of pairs": self.rules.unequal,
            "adhesive geoms": int(np.count_nonzero(model.geom_adhesion)),
            "adhesive pairs": int(np.count_nonzero(model.pair_adhesion)),
            "moving surfaces": int(np.count_nonzero(np.any(model.geom_surfacevel, axis=-1))),
            "soft bodies": model.nflex,
        }
        return ", ".join(f"{count} {word}" for word, count in counts.items() if count)
