"""States of a MuJoCo model as assemblies, and poses of parts as states of the model.

The shapes of the parts are made once for all states. A part that moves rigidly from one pose to
another by x -> R x + t takes the body of its free joint along. Of a hinge, a slide and a ball, the
position changes by the motion of the body relative to the body above it. Bodies with several joints
keep their positions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.objects.mujoco_joints import BALL, FREE, SLIDE
from kilter.files.objects.mujoco_objects import KnownShapes, ModelScene
from kilter.files.objects.mujoco_snapshot import Snapshot, StateRows, take_snapshot
from kilter.files.robots.scene_process import is_mjcf, read_scene
from kilter.rigid import Pose

AT_ONCE = 500
"""Number of states whose poses are computed together; it bounds the memory."""


@dataclass(slots=True, eq=False)
class StateScene:
    """A MuJoCo model whose states become assemblies."""

    snapshot: Snapshot
    options: FormatOptions
    source: str = ""
    known: KnownShapes = field(default_factory=dict)
    """Shapes of the parts, which all states share."""
    names: dict[int, str] = field(default_factory=dict)
    """Name of the part of each body, known after the first assembly."""

    def assembly(self, places: dict[str, Array] | None = None) -> Assembly:
        """The assembly in a state, given by its places; by default that of the snapshot."""
        if places is not None:
            self.snapshot = Snapshot(**{**vars(self.snapshot), **places})
        scene = ModelScene(self.snapshot, self.options, self.known)
        assembly = scene.assembly(self.source)
        self.names = scene.part_names()
        return assembly

    def positions(self, drawn: Assembly, settled: Assembly) -> Array:
        """Positions of joints after parts have moved from the state of the snapshot, shape (nq,).

        Parts that only one of the assemblies has do not move.
        """
        from scipy.spatial.transform import Rotation

        model = self.snapshot
        qpos = np.array(model.qpos)
        motions = self._motions(drawn, settled)
        still = Pose()
        for joint, kind in enumerate(model.jnt_type.tolist()):
            body = int(model.jnt_bodyid[joint])
            motion, start = motions.get(body, still), int(model.jnt_qposadr[joint])
            if kind == FREE:
                if motion != still:
                    moved = motion @ Pose(model.xpos[body], model.xquat[body])
                    qpos[start : start + 7] = [*moved.position, *moved.rotation]
                continue
            above = self._motion_above(body, motions)
            if motion == above or model.body_jntnum[body] > 1:
                continue
            relative = above.inverse() @ motion
            if kind == BALL:
                turn = Pose((0, 0, 0), model.xquat[body])
                inner = turn.inverse() @ Pose((0, 0, 0), relative.rotation) @ turn
                whole = Pose((0, 0, 0), qpos[start : start + 4]) @ inner
                qpos[start : start + 4] = whole.rotation
            elif kind == SLIDE:
                anchor, axis = model.xanchor[joint], model.xaxis[joint]
                qpos[start] += (relative.apply(anchor) - anchor) @ axis
            else:
                qpos[start] += (
                    Rotation.from_matrix(relative.matrix).as_rotvec() @ model.xaxis[joint]
                )
        return qpos

    def _motions(self, drawn: Assembly, settled: Assembly) -> dict[int, Pose]:
        """Motion in the world frame of each body whose part has moved."""
        poses = {part.name: part.pose for part in settled.parts}
        moved = {
            part.name: poses[part.name] @ part.pose.inverse()
            for part in drawn.parts
            if poses.get(part.name, part.pose) != part.pose
        }
        return {body: moved[name] for body, name in self.names.items() if name in moved}

    def _motion_above(self, body: int, motions: dict[int, Pose]) -> Pose:
        """Motion of the nearest body with a part above a body; that of the world is none."""
        parent = int(self.snapshot.body_parentid[body])
        while parent and parent not in self.names:
            parent = int(self.snapshot.body_parentid[parent])
        return motions.get(parent, Pose())


def open_scene(source: Any, options: FormatOptions) -> StateScene:
    """Open an MJCF file or an MjModel, in the pose that the options name.

    Raises `InputError` if the source is neither, cannot be read, or has no joints.
    """
    if isinstance(source, str | Path):
        path = Path(source)
        if path.suffix.lower() not in (".xml", ".mjcf") or (path.is_file() and not is_mjcf(path)):
            raise InputError(
                "states belong to an MJCF scene, and this is another file",
                file=str(path),
                hint="give the MJCF file of the states",
            )
        return StateScene(read_scene("mjcf", path, options), options, str(path))
    import mujoco

    if isinstance(source, mujoco.MjSpec):
        source = source.compile()
    if not isinstance(source, mujoco.MjModel):
        raise InputError(
            f"states belong to a MuJoCo model, not to {type(source).__name__}",
            hint="give the path of an MJCF file, or an MjModel",
        )
    snapshot = take_snapshot(mujoco, source, None, options.keyframe, options.states)
    return StateScene(snapshot, options)


def places_of(
    source: Any, options: FormatOptions, states: Array
) -> Iterator[tuple[StateScene, dict[str, Array]]]:
    """For each state of a model a scene, which is the same for many, and the places of its bodies.

    Arguments: `states` (n, width): states of the model.
    """
    scene: StateScene | None = None
    for start in range(0, len(states), AT_ONCE):
        rows = StateRows.of(states[start : start + AT_ONCE])
        opened = open_scene(source, replace(options, states=rows))
        places, opened.snapshot.places = opened.snapshot.places, {}
        scene = opened if scene is None else scene
        for k in range(len(rows.rows)):
            yield scene, {name: values[k] for name, values in places.items()}
