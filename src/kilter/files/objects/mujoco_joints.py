"""Joints of a MuJoCo model, from the joints of each moving body and from equality constraints.

Several joints of a body act in sequence through massless frames. Their free directions make one
joint: the span of the slides, and the span of the axes of the hinges. This needs a common point of
the hinges, and slides before all hinges, which belong to the parent, or after all hinges, which
belong to the body; a slide may pass a hinge about its own direction, or any hinge if the slides
span space. The limits, friction and springs of such joints do not count. Else the frames are parts
of a millionth of the mass of the body, and each joint counts by itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from kilter.arrays import Array, Mask
from kilter.assembly.interactions import Joint
from kilter.assembly.part import GROUND, Part
from kilter.files.file_tolerances import PARALLEL
from kilter.files.objects.mujoco_snapshot import Snapshot
from kilter.rigid import Pose
from kilter.shape.primitives import Sphere

FREE, BALL, SLIDE, HINGE = range(4)
CONNECT, WELD = 0, 1
"""MuJoCo's numbers for the kinds of joints and equalities."""
KINDS = {BALL: "spherical", SLIDE: "prismatic", HINGE: "revolute"}
"""Kind of `Joint` for each kind of MuJoCo joint."""
FRAME = 1e-6
"""Mass of a frame between two joints of a body, over that of the body [-]."""
MEET = 1e-9
"""Largest distance of the axes of hinges from their common point, over that of anchors [-]."""


class ModelJoints:
    """The joints of a model between parts.

    Arguments: `owner`: the body whose part each body belongs to; `names`: the name of each body's
    part; `held` (nbody,): bodies that do not move.
    """

    def __init__(
        self, model: Snapshot, owner: dict[int, int], names: Mapping[int, str], held: Mask
    ) -> None:
        self.model, self.owner, self.names, self.held = model, owner, names, held
        self.guided: list[int] = []
        """MuJoCo joints whose limits, friction and springs are those of a joint."""
        self.frames: list[Part] = []
        """Frames between joints of a body."""
        self.ignored = 0
        """Number of equalities that are no welds and connections of bodies."""

    def all(self) -> list[Joint]:
        """All joints: those between bodies, and equality constraints."""
        model = self.model
        joints: list[Joint] = []
        for body, own in self.owner.items():
            if self.held[body]:
                continue
            first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
            rows = list(range(first, first + count))
            # the part that moves with the root of the bodies that move together
            anchor = self.owner[int(model.body_weldid[body])]
            if rows and model.jnt_type[rows[0]] == FREE:
                continue
            if rows:
                joints += self._of(self._ends(anchor, int(model.body_parentid[body])), rows)
            elif own == body != anchor:
                joints.append(Joint(self._ends(body, int(model.body_parentid[body]))))
        return joints + self._equalities()

    def _ends(self, body: int, parent: int) -> tuple[str, str]:
        """Names of the parts of a body and of its parent, which may be the ground."""
        return self._name(body), self._name(parent)

    def _name(self, body: int) -> str:
        """Name of the part of a body; the ground for a body without a part."""
        return self.names[self.owner[body]] if body in self.owner else GROUND

    def _of(self, ends: tuple[str, str], rows: list[int]) -> list[Joint]:
        """The joint of a body with its parent; none if it moves freely, several with frames."""
        if len(rows) == 1:
            return [self._single(ends, rows[0])]
        joints = _sequence(ends, *self._directions(rows))
        if joints is not None:
            return joints
        body = int(self.model.jnt_bodyid[rows[0]])
        mass = FRAME * float(self.model.body_mass[body] or 1.0)
        radius = (mass / 1000.0 * 0.75 / np.pi) ** (1 / 3)
        chain = [ends[1]]
        for number, row in enumerate(rows[:-1], 1):
            chain.append(f"{ends[0]}/frame {number}")
            place = Pose(self.model.xanchor[row])
            self.frames.append(Part(chain[-1], Sphere(radius), place, mass=mass))
        chain.append(ends[0])
        return [self._single((chain[k + 1], chain[k]), row) for k, row in enumerate(rows)]

    def _single(self, ends: tuple[str, str], row: int) -> Joint:
        """The joint of two parts for a MuJoCo joint."""
        kind = int(self.model.jnt_type[row])
        guide = self._guide(row) if kind in (SLIDE, HINGE) else {}
        point, axis = self.model.xanchor[row], self.model.xaxis[row]
        return Joint(ends, KINDS[kind], point=point, axis=axis, **guide)  # type: ignore[arg-type]

    def _directions(self, rows: list[int]) -> tuple[Array, Array, Array]:
        """Kinds (k,), anchors (k, 3) and axes (k, 3) of joints; a ball is three hinges."""
        kinds, points, axes = [], [], []
        for row in rows:
            kind, own = int(self.model.jnt_type[row]), self.model.xaxis[row]
            turns = np.eye(3) if kind == BALL else own[None]
            kinds += [HINGE if kind == BALL else kind] * len(turns)
            points += [self.model.xanchor[row]] * len(turns)
            axes += list(turns)
        return np.array(kinds), np.array(points), np.array(axes)

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
        joints = []
        for k in np.flatnonzero(model.eq_active0):
            kind = int(model.eq_type[k])
            ids = [int(model.eq_obj1id[k]), int(model.eq_obj2id[k])]
            if kind not in (CONNECT, WELD) or int(model.eq_objtype[k]) != 1:
                self.ignored += 1
                continue
            ends = [self._name(i) for i in ids]
            if self.held[ids].all():
                continue
            if ends[0] == ends[1]:
                self.ignored += 1
                continue
            first, second = ends if ends[0] != GROUND else ends[::-1]
            point = None
            if kind == CONNECT:
                pose = Pose(model.xpos[ids[0]], model.xquat[ids[0]])
                point = pose.apply(model.eq_data[k][:3][None])[0]
            joint = "fixed" if kind == WELD else "spherical"
            joints.append(Joint((first, second), joint, point=point))  # type: ignore[arg-type]
        return joints


def _sequence(
    ends: tuple[str, str], kinds: Array, points: Array, axes: Array
) -> list[Joint] | None:
    """The joint of several joints in sequence, in a list; empty if they leave every motion free.

    None if no joint has their motions: the axes of the hinges do not meet, or a slide turns with a
    hinge before it and is followed by another hinge.
    """
    turning = kinds == HINGE
    slides, turns = _spanning(axes[~turning]), _spanning(axes[turning])
    point = _common_point(points[turning], axes[turning]) if turning.any() else None
    if point is None and turning.any():
        return None
    if len(slides) == len(turns) == 3:
        return []
    if not len(slides) and len(turns) == 3:
        return [Joint(ends, "spherical", point=point)]
    if len(slides) + len(turns) == 1:
        kind = "prismatic" if len(slides) else "revolute"
        return [Joint(ends, kind, point=point, axis=[*slides, *turns][0])]  # type: ignore[arg-type]
    if len(slides) == len(turns) == 1 and np.allclose(np.cross(slides, turns), 0, atol=PARALLEL):
        return [Joint(ends, "cylindrical", point=point, axis=turns[0])]
    if _first(turning, axes) or len(slides) in (0, 3):
        return [Joint(ends[::-1], "general", point=point, slides=slides, turns=turns)]
    if _first(turning[::-1], axes[::-1]):
        return [Joint(ends, "general", point=point, slides=slides, turns=turns[::-1])]
    return None


def _spanning(axes: Array) -> Array:
    """The directions that are independent of those before them, in their order, (k, 3)."""
    chosen = np.empty((0, 3))
    for axis in axes:
        longer = np.vstack([chosen, axis])
        if np.linalg.svd(longer, compute_uv=False)[min(len(longer), 3) - 1] > PARALLEL:
            chosen = longer if len(longer) <= 3 else chosen
    return chosen


def _first(turning: Mask, axes: Array) -> bool:
    """Whether all slides come first, or have the direction of each hinge before them."""
    return all(
        np.allclose(np.cross(axes[i], axes[k]), 0, atol=PARALLEL)
        for k in np.flatnonzero(~turning)
        for i in np.flatnonzero(turning[:k])
    )


def _common_point(points: Array, axes: Array) -> Array | None:
    """The point that lies on all axes of hinges, (3,); None without such a point."""
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    begin = points.mean(axis=0)
    offset = points - begin
    target = np.einsum("kij,kj->ki", across, offset)
    moved = np.linalg.lstsq(across.reshape(-1, 3), target.ravel(), rcond=MEET)[0]
    apart = np.abs(np.einsum("kij,kj->ki", across, moved - offset)).max()
    if apart > MEET * max(float(np.abs(points).max()), 1.0):
        return None
    point: Array = begin + moved
    return point
