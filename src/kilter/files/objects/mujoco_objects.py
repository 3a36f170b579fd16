"""Read MuJoCo models: bodies as parts, in the pose of a keyframe; the world is held.

A body is one part with its colliding geoms, or with all geoms if none collides. Each geom of the
world is a held part, and a body fixed to the world is held. A plane is a table. Masses and centres
are those of the model. Hinges, slides and balls are joints without motors. Hinges and slides have
their limits, friction and springs. The friction coefficient of a pair is the larger of the two, as
in MuJoCo, and 0 if both have `condim` 1. Meshes keep their shape, although MuJoCo collides with
their convex hulls. Pairs whose contacts the model filters do not touch: by the bits of their geoms,
as parent and child, or as excluded pairs. Lengths are metres.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np

from kilter.arrays import Index, Mask
from kilter.assembly import Assembly, Part
from kilter.assembly.interactions import FrictionPair, GivenContact, Joint
from kilter.errors import InputError
from kilter.files.file_tolerances import PARALLEL
from kilter.files.format_options import FormatOptions
from kilter.files.naming import distinct
from kilter.files.near_parts import near_pairs
from kilter.files.objects.mujoco_snapshot import Snapshot, take_snapshot
from kilter.files.one_body import compose, one_body
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere, surface

__all__ = ["ModelScene", "read"]

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
    snapshot = take_snapshot(mujoco, model, data, choices.keyframe)
    return ModelScene(snapshot, choices).assembly("")


class ModelScene:
    """A MuJoCo model in a given pose, during its conversion to an assembly."""

    def __init__(self, model: Snapshot, choices: FormatOptions) -> None:
        if choices.units not in (None, "m"):
            raise InputError(
                f"MuJoCo is in m, but the units given are {choices.units}",
                hint="leave the units out",
            )
        self.model, self.notes = model, list[str](model.notes)
        self.names = distinct([name or f"body_{k}" for k, name in enumerate(model.body_names)])
        self.collides: Mask = (model.geom_contype | model.geom_conaffinity) != 0
        self.geoms = self._geoms()
        self.parts: list[Part] = []
        self.rows: list[list[int]] = []
        """The geoms of each part."""
        self.guided: list[int] = []
        """MuJoCo joints whose limits, friction and springs are those of a joint."""

    def _geoms(self) -> dict[int, list[int]]:
        """For each body, the geoms that form its part: those that collide, else all."""
        model, collides = self.model, self.collides
        geoms = {}
        for body in range(model.nbody):
            rows = int(model.body_geomadr[body]) + np.arange(int(model.body_geomnum[body]))
            solid = rows[collides[rows]]
            geoms[body] = (solid if len(solid) or body == 0 else rows).tolist()
        return geoms

    def assembly(self, source: str) -> Assembly:
        """The MuJoCo model as a kilter assembly."""
        model = self.model
        planes = [k for k in self.geoms[0] if model.geom_type[k] == PLANE]
        for geom in self.geoms[0]:
            if geom not in planes:
                self._add(self._geom_name(geom), [geom], Pose(), held=True)
        for body in range(1, model.nbody):
            if self.geoms[body]:
                pose = Pose(self.model.xpos[body], self.model.xquat[body])
                held = int(model.body_weldid[body]) == 0
                self._add(self.names[body], self.geoms[body], pose, held=held, body=body)
        self._add_planes(planes)
        if not self.parts:
            raise self._emptiness(source)
        names = distinct([part.name for part in self.parts])
        parts = [replace(part, name=name) for part, name in zip(self.parts, names, strict=True)]
        joints = self._joints({part.name for part in parts})
        near = near_pairs(parts, REACH)
        friction, pairs = self._friction(parts, near)
        left = self._ignored_features()
        return Assembly(
            parts,
            units="m",
            gravity=model.gravity,
            friction=friction,
            friction_pairs=pairs,
            contacts=self._filtered(parts, near),
            joints=joints,
            source=source,
            notes=[*self.notes, *([f"ignored: {left}"] if left else [])],
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

    def _add(
        self, name: str, geoms: list[int], pose: Pose, *, held: bool, body: int | None = None
    ) -> None:
        """Add a part of the given geoms; with `body`, it has the mass and centre of that body."""
        model = self.model
        try:
            shape, inner = one_body([self._shape(geom) for geom in geoms], name, self.notes)
        except InputError as error:
            raise error.located(part=name) from None
        mass = None if body is None else float(model.body_mass[body])
        center = None
        if mass:
            center = (np.array(model.body_ipos[body]) - inner.position) @ inner.matrix
        part = Part(
            name,
            shape,
            compose(pose, inner),
            grounded=held,
            mass=mass or None,
            center_of_mass=center,
            geometry="collider" if self.collides[geoms].any() else "visual",
        )
        self.parts.append(part)
        self.rows.append(geoms)

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
            ends = [(Sphere(float(size[0])), Pose([0, 0, z])) for z in (-size[1], size[1])]
            side = Cylinder(float(size[0]), 2 * float(size[1]))
            return one_body([(side, Pose()), *ends], "capsule", self.notes)[0], pose
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

    # joints --------------------------------------------------------------------------

    def _joints(self, parts: set[str]) -> list[Joint]:
        """All joints of the model: those between bodies, and its equality constraints."""
        model = self.model
        joints = []
        for body in range(1, model.nbody):
            if int(model.body_weldid[body]) == 0:
                continue
            first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
            rows = list(range(first, first + count))
            if rows and model.jnt_type[rows[0]] == FREE:
                continue
            ends = (self.names[body], self._parent(body, parts))
            if self.names[body] not in parts:
                if rows:
                    raise InputError(
                        "it has a joint but no geom", part=self.names[body], hint="give it a geom"
                    )
                continue
            joints.append(self._joint(ends, rows))
        return joints + self._equalities(parts)

    def _parent(self, body: int, parts: set[str]) -> str:
        """Name of the nearest ancestor body that is a part; "ground" without such a body.

        Fixed bodies without geoms in between are passed.
        """
        parent = int(self.model.body_parentid[body])
        while parent and self.names[parent] not in parts and not self.model.body_jntnum[parent]:
            parent = int(self.model.body_parentid[parent])
        return self.names[parent] if self.names[parent] in parts and parent else "ground"

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

    def _equalities(self, parts: set[str]) -> list[Joint]:
        """Joints for the model's equality constraints between bodies (welds and connections)."""
        model = self.model
        joints = []
        for k in np.flatnonzero(model.eq_active0):
            kind = int(model.eq_type[k])
            ids = [int(model.eq_obj1id[k]), int(model.eq_obj2id[k])]
            ends = [self.names[i] if self.names[i] in parts and i else "ground" for i in ids]
            if kind not in (CONNECT, WELD) or int(model.eq_objtype[k]) != 1 or ends[0] == ends[1]:
                self.notes.append(
                    "an equality other than a weld or connection of bodies is ignored"
                )
                continue
            first, second = ends if ends[0] != "ground" else ends[::-1]
            point = None
            if kind == CONNECT:
                pose = Pose(self.model.xpos[ids[0]], self.model.xquat[ids[0]])
                point = pose.apply(model.eq_data[k][:3][None])[0]
            joint = "fixed" if kind == WELD else "spherical"
            joints.append(Joint((first, second), joint, point=point))  # type: ignore[arg-type]
        return joints

    # friction ------------------------------------------------------------------------

    def _friction(
        self, parts: list[Part], near: tuple[Index, Index]
    ) -> tuple[float, list[FrictionPair]]:
        """The most frequent friction coefficient, and the pairs with another coefficient."""
        model = self.model
        part_mu = np.array([max(self._mu(geom) for geom in geoms) for geoms in self.rows])
        condim = [max(int(model.geom_condim[geom]) for geom in geoms) for geoms in self.rows]
        slick = np.array(condim) == 1
        first, second = near
        mu = np.maximum(part_mu[first], part_mu[second])
        mu[slick[first] & slick[second]] = 0.0
        free = np.array([not part.grounded for part in parts])
        counts = free[first] | free[second]
        first, second, mu = first[counts], second[counts], mu[counts]
        usual = Counter(mu.tolist()).most_common(1)
        friction = usual[0][0] if usual else 0.0
        return friction, [
            FrictionPair((parts[a].name, parts[b].name), value)
            for a, b, value in zip(first.tolist(), second.tolist(), mu.tolist(), strict=True)
            if value != friction
        ]

    def _filtered(self, parts: list[Part], near: tuple[Index, Index]) -> list[GivenContact]:
        """Near pairs with a free part that never touch in the model, as contacts without points."""
        model = self.model
        bits = np.zeros((2, len(self.rows)), dtype=np.int64)
        for k, geoms in enumerate(self.rows):
            bits[0, k] = np.bitwise_or.reduce(model.geom_contype[geoms])
            bits[1, k] = np.bitwise_or.reduce(model.geom_conaffinity[geoms])
        solid: Mask = (bits != 0).any(axis=0)  # parts without a collider have their visual shapes
        weld = model.body_weldid[model.geom_bodyid[[geoms[0] for geoms in self.rows]]]
        above = model.body_weldid[model.body_parentid[weld]]
        free = np.array([not part.grounded for part in parts])
        a, b = near
        common: Index = (bits[0, a] & bits[1, b]) | (bits[0, b] & bits[1, a])
        masked: Mask = solid[a] & solid[b] & (common == 0)
        family = (weld[a] == weld[b]) & (weld[a] != 0)
        if model.filters_parents:
            family |= (above[a] == weld[b]) & (weld[b] != 0)
            family |= (above[b] == weld[a]) & (weld[a] != 0)
        bodies = model.geom_bodyid[[geoms[0] for geoms in self.rows]].astype(np.int64)
        signs = np.minimum(bodies[a], bodies[b]) << 16 | np.maximum(bodies[a], bodies[b])
        excluded = np.isin(signs, model.exclude_signature)
        never: Mask = (masked | family | excluded) & (free[a] | free[b])
        if never.any():
            self.notes.append(f"pairs whose contacts the model filters: {int(never.sum())}")
        return [
            GivenContact((parts[i].name, parts[k].name), [], [0, 0, 1])
            for i, k in zip(a[never].tolist(), b[never].tolist(), strict=True)
        ]

    def _mu(self, geom: int) -> float:
        """Sliding friction coefficient of the geom with an index [-]."""
        return float(self.model.geom_friction[geom][0])

    def _ignored_features(self) -> str:
        """List, as text, the model's features that affect motion but that kilter ignores."""
        model = self.model
        left = np.delete(np.arange(len(model.jnt_type)), self.guided)
        friction = np.delete(model.dof_frictionloss, model.jnt_dofadr[self.guided])
        counts = {
            "motors": model.nu,
            "springs": int(np.count_nonzero(model.jnt_stiffness[left])),
            "joint limits": int(np.count_nonzero(model.jnt_limited[left])),
            "tendons": model.ntendon,
            "joint frictions": int(np.count_nonzero(friction)),
        }
        return ", ".join(f"{count} {word}" for word, count in counts.items() if count)
