"""Read MuJoCo models: bodies as parts, in the pose of a keyframe; the world is held.

A body is one part with its colliding geoms, or with all geoms if none collides; bodies without mass
or geoms belong to a part that moves with them (`kilter.files.objects.mujoco_objects`). Each geom of
the world is a held part, and a body fixed to the world is held. A plane is a table. Masses, centres
and inertia are those of the compiled model, and gravity compensation is a load. Hinges, slides and
balls are joints without motors. Hinges and slides have their limits, friction and springs. Friction
and filters of contacts are those of pairs of geoms (`kilter.files.objects.mujoco_contacts`). Meshes
keep their shape, although MuJoCo collides with their convex hulls. Lengths are metres.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from kilter.arrays import Mask
from kilter.assembly import Assembly, Part
from kilter.assembly.geometry import MassProperties
from kilter.assembly.interactions import Joint, Load
from kilter.assembly.part import GROUND
from kilter.errors import InputError
from kilter.files.file_tolerances import PARALLEL
from kilter.files.format_options import FormatOptions
from kilter.files.meshes.placed import distinct
from kilter.files.objects.mujoco_contacts import GeomRules, contact_entries
from kilter.files.objects.mujoco_snapshot import Snapshot, take_snapshot
from kilter.files.robots.one_body import capsule, compose, near_pairs, one_body
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere, surface

# Bodies of a MuJoCo model that move together, the parts that they form, and their masses.


def held_bodies(model: Snapshot) -> Mask:
    """Mask of the bodies that do not move: those welded to the world or to a mocap body."""
    weld = model.body_weldid
    held: Mask = (weld == 0) | (model.body_mocapid[weld] >= 0)
    return held


def owners(model: Snapshot) -> dict[int, int]:
    """For each body that moves with a part, the body whose part it is.

    It is the nearest body above it with geoms and mass that moves with it, or else the first of
    the bodies that move together. Without a mass of its own, it is the first with geoms.
    """
    solid, held = model.body_geomnum > 0, held_bodies(model)
    bears = solid & (held | (model.body_mass > 0))
    groups: dict[int, list[int]] = {}
    for body in range(1, model.nbody):
        root = -body if held[body] else int(model.body_weldid[body])
        groups.setdefault(root, []).append(body)
    owner = {}
    for bodies in groups.values():
        chosen = [body for body in bodies if bears[body]] or [b for b in bodies if solid[b]][:1]
        for body in bodies if chosen else ():
            above = body
            while above not in chosen and above in bodies:
                above = int(model.body_parentid[above])
            owner[body] = above if above in chosen else chosen[0]
    return owner


def mass_fields(model: Snapshot, bodies: list[int], pose: Pose, *, held: bool) -> dict[str, Any]:
    """Mass, centre and inertia of bodies that move together, as fields of a part with a pose.

    For massless bodies there are none. A held part needs no inertia.
    """
    masses = []
    for body in bodies:
        if model.body_mass[body] > 0:
            turn = model.ximat[body].reshape(3, 3)
            inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
            masses.append(MassProperties(float(model.body_mass[body]), model.xipos[body], inertia))
    if not masses:
        return {}
    fields = MassProperties.sum(masses).fields(pose)
    if held:
        del fields["inertia"]
    return fields


def relieving_loads(model: Snapshot, names: dict[int, str]) -> list[Load]:
    """Forces of the gravity compensation of free bodies, at their centres.

    `names` has the name of the part of each body.
    """
    held = held_bodies(model)
    return [
        Load(
            names[body],
            force=-model.body_gravcomp[body] * model.body_mass[body] * model.gravity,
            point=model.xipos[body],
        )
        for body in np.flatnonzero(model.body_gravcomp * model.body_mass).tolist()
        if body in names and not held[body]
    ]


PLANE, FIELD, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = range(8)
FREE, BALL, SLIDE, HINGE = range(4)
CONNECT, WELD = 0, 1
"""MuJoCo's numbers for the kinds of geoms, joints and equalities."""
KINDS = {BALL: "spherical", SLIDE: "prismatic", HINGE: "revolute"}
"""Kind of `Joint` for each kind of MuJoCo joint."""
SPACIOUS = 4.0
"""Margin of the table for an infinite plane around the parts [sizes of all parts]."""
REACH = 2.0
"""Distance of two parts up to which their friction is read [sums of their radii]; a larger value
gives more friction pairs."""


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


KnownShapes = dict[tuple[int, ...], tuple[Shape, Pose, tuple[str, ...]]]
"""Shape and pose of each part in the frame of its body, and notes, by the geoms of the part."""


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
        self.owner = owners(model)
        """The body whose part each body belongs to."""
        self.members: dict[int, list[int]] = {}
        """The bodies of each part, by its body."""
        for body, owner in self.owner.items():
            self.members.setdefault(owner, []).append(body)
        self.geoms = self._geoms()
        self.parts: list[Part] = []
        self.rows: list[list[int]] = []
        """The geoms of each part."""
        self.bodies: list[int] = []
        """The body of each part; 0 for geoms of the world."""
        self.guided: list[int] = []
        """MuJoCo joints whose limits, friction and springs are those of a joint."""

    def _geoms(self) -> dict[int, list[int]]:
        """For each part, by its body, its geoms: those that collide, else all."""
        geoms: dict[int, list[int]] = {body: [] for body in range(self.model.nbody)}
        for geom, body in enumerate(self.model.geom_bodyid.tolist()):
            geoms[self.owner.get(body, body)].append(geom)
        for body, rows in geoms.items():
            solid = [geom for geom in rows if self.collides[geom]]
            geoms[body] = solid if solid or body == 0 else rows
        return geoms

    def assembly(self, source: str) -> Assembly:
        """The MuJoCo model as a kilter assembly."""
        model = self.model
        planes = [k for k in self.geoms[0] if model.geom_type[k] == PLANE]
        for geom in self.geoms[0]:
            if geom not in planes:
                self._add(self._geom_name(geom), [geom], body=0, held=True)
        held = held_bodies(model)
        for body in range(1, model.nbody):
            if self.geoms[body]:
                self._add(self.names[body], self.geoms[body], body=body, held=bool(held[body]))
        self._add_planes(planes)
        if not self.parts:
            raise self._emptiness(source)
        names = distinct([part.name for part in self.parts])
        parts = [replace(part, name=name) for part, name in zip(self.parts, names, strict=True)]
        for name, body in zip(names, self.bodies, strict=True):
            self.names[body] = name
        self._require_gravity()
        joints = self._joints()
        near = near_pairs(parts, REACH)
        detect = not model.disabled & {"CONTACT", "CONSTRAINT"}
        if not detect:
            self.notes.append("the model disables all contacts")
            near = near[0][:0], near[1][:0]
        friction, pairs, apart = contact_entries(self.rules, parts, self.rows, near, self.notes)
        if unseen := sum(part.geometry == "visual" for part in parts):
            self.notes.append(
                f"bodies without colliding geoms, whose visible geoms count: {unseen}"
            )
        loads = relieving_loads(model, {b: self.names[k] for b, k in self.owner.items()})
        if loads:
            self.notes.append(f"bodies whose gravity compensation is a load: {len(loads)}")
        left = self._ignored_features()
        return Assembly(
            parts,
            units="m",
            gravity=model.gravity,
            friction=friction,
            friction_pairs=pairs,
            contacts=apart,
            detect=detect,
            joints=joints,
            loads=loads,
            source=source,
            notes=[*self.notes, *([f"ignored: {left}"] if left else [])],
        )

    def part_names(self) -> dict[int, str]:
        """Name of the part of each body that has one, after `assembly`."""
        with_parts = set(self.bodies) - {0}
        return {b: self.names[own] for b, own in self.owner.items() if own in with_parts}

    def _require_gravity(self) -> None:
        """Raise an InputError for a model without gravity."""
        if "GRAVITY" in self.model.disabled or not self.model.gravity.any():
            raise InputError(
                "the model has no gravity",
                hint='give <option gravity="0 0 -9.81"/>, and enable gravity in its flags',
            )

    def _emptiness(self, source: str) -> InputError:
        """Error for a model without parts."""
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
        key = tuple(geoms)
        if key not in self.known:
            notes: list[str] = []
            try:
                shapes = [self._placed(geom, body, pose) for geom in geoms]
                known = one_body(shapes, name, notes, self.rules.pieces(geoms))
            except InputError as error:
                raise error.located(part=name) from None
            self.known[key] = *known, tuple(notes)
        shape, inner, told = self.known[key]
        self.notes += told
        placed = compose(pose, inner)
        collides = bool(self.collides[geoms].any())
        fields = mass_fields(model, self.members.get(body, []), placed, held=held)
        geometry = "collider" if collides else "visual"
        self.parts.append(Part(name, shape, placed, grounded=held, geometry=geometry, **fields))
        self.rows.append(geoms)
        self.bodies.append(body)

    def _placed(self, geom: int, body: int, pose: Pose) -> tuple[Shape, Pose]:
        """Shape of a geom, and its pose relative to the body of a part with a pose."""
        model = self.model
        shape, place = self._shape(geom)
        own = int(model.geom_bodyid[geom])
        if own == body:
            return shape, place
        outer = compose(pose.inverse(), Pose(model.xpos[own], model.xquat[own]))
        return shape, compose(outer, place)

    def _shape(self, geom: int) -> tuple[Shape, Pose]:
        """Shape of a geom, and its pose relative to its body."""
        model = self.model
        kind, size = int(model.geom_type[geom]), np.array(model.geom_size[geom])
        pose = Pose(model.geom_pos[geom], model.geom_quat[geom])
        if kind == SPHERE:
            return Sphere(float(size[0])), pose
        if kind == CYLINDER:
            return Cylinder(float(size[0]), 2 * float(size[1])), pose
        if kind == BOX:
            return Box(2 * size), pose
        if kind == CAPSULE:
            return capsule(float(size[0]), 2 * float(size[1])), pose
        if kind == ELLIPSOID:
            vertices, triangles = surface(Sphere(1.0))
            return Mesh(vertices * size, triangles), pose
        if kind == MESH:
            mesh = int(model.geom_dataid[geom])
            first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
            start, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
            corners = np.array(model.mesh_vert[first : first + count], dtype=np.float32)
            return Mesh(corners, np.array(model.mesh_face[start : start + faces])), pose
        raise InputError("it has a height field or a distance field", hint="replace it by a mesh")

    def _add_planes(self, planes: list[int]) -> None:
        """Add a held table for each plane geom, large enough for all parts."""
        points = [part.pose.apply(surface(part.shape)[0]) for part in self.parts]
        corners = np.vstack(points) if points else np.zeros((1, 3))
        size = float(np.ptp(corners, axis=0).max()) or 1.0
        for geom in planes:
            pose = Pose(self.model.geom_pos[geom], self.model.geom_quat[geom])
            half = np.array(self.model.geom_size[geom][:2])
            local = np.abs((corners - pose.position) @ pose.matrix)[:, :2].max(axis=0)
            half = np.where(half > 0, half, local + SPACIOUS * size)
            box = Box([2 * half[0], 2 * half[1], size])
            part = Part(
                self._geom_name(geom, "floor"),
                box,
                compose(pose, Pose([0, 0, -size / 2])),
                grounded=True,
                density=1000.0,
                table=True,
                geometry="collider",
            )
            self.parts.append(part)
            self.rows.append([geom])
            self.bodies.append(0)

    # joints --------------------------------------------------------------------------

    def _joints(self) -> list[Joint]:
        """All joints of the model: those between bodies, and its equality constraints."""
        model = self.model
        joints = []
        held = held_bodies(model)
        for body in range(1, model.nbody):
            if held[body]:
                continue
            first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
            rows = list(range(first, first + count))
            if rows and model.jnt_type[rows[0]] == FREE:
                continue
            # the part that moves with the root of the bodies that move together
            anchor = self.owner.get(int(model.body_weldid[body]))
            if rows and anchor is None:
                raise self._shapeless(body)
            if anchor is None or not (rows or self.owner[body] == body != anchor):
                continue
            above = self.owner[int(model.body_parentid[body])] if not rows else self._parent(body)
            ends = (self.names[anchor if rows else body], self.names[above] if above else GROUND)
            joints.append(self._joint(ends, rows))
        return joints + self._equalities()

    def _parent(self, body: int) -> int:
        """The body of the nearest part above a body; 0 for the world. Fixed frames are passed.

        Raises `InputError` if a body in between has a joint, but neither it nor a body fixed to it
        has a geom.
        """
        parent = int(self.model.body_parentid[body])
        while parent and parent not in self.owner:
            if self.model.body_jntnum[parent]:
                raise self._shapeless(parent)
            parent = int(self.model.body_parentid[parent])
        return self.owner.get(parent, 0)

    def _shapeless(self, body: int) -> InputError:
        """Error for a body that moves without a shape."""
        return InputError(
            "it has a joint but no geom", part=self.names[body], hint="give it a geom"
        )

    def _joint(self, ends: tuple[str, str], rows: list[int]) -> Joint:
        """The joint between a body and its parent: fixed, cylindrical, or as in MuJoCo."""
        kinds = [int(self.model.jnt_type[k]) for k in rows]
        if not rows:
            return Joint(ends)
        point, axes = self.model.xanchor[rows[0]], [self.model.xaxis[k] for k in rows]
        if len(rows) == 1:
            guide = self._guide(rows[0]) if kinds[0] in (SLIDE, HINGE) else {}
            return Joint(ends, KINDS[kinds[0]], point=point, axis=axes[0], **guide)  # type: ignore[arg-type]
        along = len(rows) == 2 and np.allclose(np.cross(*axes), 0.0, atol=PARALLEL)
        if sorted(kinds) == [SLIDE, HINGE] and along:
            turn = rows[kinds.index(HINGE)]
            return Joint(ends, "cylindrical", point=self.model.xanchor[turn], axis=axes[0])
        raise InputError(
            f"it has {len(rows)} joints",
            part=ends[0],
            hint="give it a single hinge, slide, ball or free joint, or a slide along its hinge",
        )

    def _guide(self, row: int) -> dict[str, Any]:
        """Limits, friction and spring of a hinge or slide, as arguments of `Joint`.

        Positions count from that of the pose.
        """
        model = self.model
        self.guided.append(row)
        at = float(model.qpos[model.jnt_qposadr[row]])
        limits = tuple((model.jnt_range[row] - at).tolist()) if model.jnt_limited[row] else None
        return {
            "limits": limits,
            "friction": float(model.dof_frictionloss[model.jnt_dofadr[row]]),
            "stiffness": float(model.jnt_stiffness[row]),
            "rest": float(model.qpos_spring[model.jnt_qposadr[row]]) - at,
        }

    def _equalities(self) -> list[Joint]:
        """Joints for the model's equality constraints between bodies (welds and connections)."""
        model = self.model
        joints, ignored = [], 0
        for k in np.flatnonzero(model.eq_active0):
            kind = int(model.eq_type[k])
            ids = [int(model.eq_obj1id[k]), int(model.eq_obj2id[k])]
            ends = [self.names[self.owner[i]] if i in self.owner else GROUND for i in ids]
            if kind not in (CONNECT, WELD) or int(model.eq_objtype[k]) != 1 or ends[0] == ends[1]:
                ignored += 1
                continue
            first, second = ends if ends[0] != GROUND else ends[::-1]
            point = None
            if kind == CONNECT:
                pose = Pose(self.model.xpos[ids[0]], self.model.xquat[ids[0]])
                point = pose.apply(model.eq_data[k][:3][None])[0]
            joint = "fixed" if kind == WELD else "spherical"
            joints.append(Joint((first, second), joint, point=point))  # type: ignore[arg-type]
        if ignored:
            self.notes.append(
                f"ignored equalities other than welds and connections of bodies: {ignored}"
            )
        return joints

    def _ignored_features(self) -> str:
        """List, as text, the model's features that affect motion but that kilter ignores."""
        model = self.model
        apart = (model.geom_margin > 0) & self.collides
        left = np.delete(np.arange(len(model.jnt_type)), self.guided)
        friction = np.delete(model.dof_frictionloss, model.jnt_dofadr[self.guided])
        holding = int(np.count_nonzero((model.tendon_limited != 0) | (model.tendon_stiffness > 0)))
        counts = {
            "motors": model.nu,
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
