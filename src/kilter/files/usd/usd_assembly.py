"""Read USD scenes: rigid bodies as free parts, static colliders and kinematic bodies as held parts.

Units, up axis, gravity, masses and friction materials are those of the stage. An object has the
geometry of its colliders, or of its visual shapes without colliders. An infinite plane is a table.
The stage is read at its default time.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.limits import Tally
from kilter.files.robots.one_body import compose, one_body
from kilter.files.usd.usd_masses import collider_pieces, friction_of_parts, mass_of_object
from kilter.files.usd.usd_objects import UsdObject, find_objects, matrix_of
from kilter.files.usd.usd_physics import filtered_ends, filtered_pairs, find_joints
from kilter.files.usd.usd_shapes import AXES, rigid_part, shape_of_prim
from kilter.files.usd.usd_stage import (
    UsdScene,
    caught_messages,
    note_on_messages,
    open_stage,
    require_usd,
)
from kilter.files.usd.usd_values import token_of
from kilter.files.writing import write_bytes
from kilter.rigid import Pose, matrix_to_quaternion
from kilter.shape.primitives import Box, Mesh, Shape, surface

SPACIOUS = 4.0
"""Margin of the table for an infinite plane around the parts [sizes of all parts]."""


def read_usd(
    path: Path, shown: str, units: str | None, allow_time: Callable[[int], None]
) -> Assembly:
    """Read a USD file as an assembly; `kilter.files.robots.scene_process` runs this.

    Arguments: `allow_time`: called with the size of the file [bytes] before its layers are
    composed. Raises `InputError` if usd-core is not installed, the file is damaged or has no
    shapes, or a shape is of a kind that kilter does not have; the error names the object.
    """
    allow_time(path.stat().st_size)
    require_usd()
    with caught_messages() as messages:
        assembly = _assembly(open_stage(path), shown, units, messages)
        notes = note_on_messages(messages())
    return replace(assembly, notes=[*notes, *assembly.notes]) if notes else assembly


def _assembly(
    scene: UsdScene, shown: str, units: str | None, messages: Callable[[], list[str]]
) -> Assembly:
    """Build the assembly of an open stage; `messages` returns the warnings of USD so far."""
    if units not in (None, scene.units):
        raise InputError(
            f"the stage is in {scene.units}, but the units given are {units}",
            hint="leave the units out",
        )
    objects, decoration = find_objects(scene.stage)
    if not objects:
        raise InputError(
            "; ".join(
                [
                    "the stage is empty: it has no visible mesh, cube, sphere or cylinder",
                    *note_on_messages(messages()),
                    *scene.notes,
                ]
            ),
            hint="check its references and the visibility of its prims",
        )
    notes = list(scene.notes)
    if decoration:
        notes.append(f"shapes outside of rigid bodies and without a collider: {decoration} ignored")
    tally = Tally()
    parts: list[Part] = []
    materials = []
    pieces_of: dict[str, list[int]] = {}
    ends = filtered_ends(scene)
    named = {path for each in ends for path in each}
    for entry in sorted(objects, key=_is_plane):
        pieces, own = collider_pieces(entry, named)
        pieces_of[entry.path] = pieces
        if _is_plane(entry):
            parts.append(_table(scene, entry, parts))
        else:
            parts.append(_part(scene, entry, pieces, notes, tally))
        materials.append(own)
    friction, pairs = friction_of_parts(parts, materials)
    bodies = {entry.path: entry for entry in objects if entry.instance < 0}
    return Assembly(
        parts,
        units=scene.units,
        gravity=scene.gravity,
        friction=friction,
        friction_pairs=pairs,
        joints=find_joints(scene, bodies, notes),
        contacts=filtered_pairs(ends, bodies, pieces_of),
        source=shown,
        notes=notes,
    )


def _is_plane(entry: UsdObject) -> bool:
    """Whether an object is an infinite plane."""
    return all(shape.prim.GetTypeName() == "Plane" for shape in entry.chosen)


def _part(
    scene: UsdScene, entry: UsdObject, pieces: list[int], notes: list[str], tally: Tally
) -> Part:
    """The part of an object; its colliders belong to these pieces."""
    try:
        frame = _scaled(entry.matrix, scene.scale)
        pose = rigid_part(frame)
        inverse = np.eye(4)
        inverse[:3, :3] = pose.matrix.T
        inverse[:3, 3] = -pose.matrix.T @ pose.position
        shapes: list[tuple[Shape, Pose]] = []
        for each in entry.chosen:
            # a shape keeps its own numbers; lengths of the stage become those of the assembly
            matrix = inverse @ _scaled(each.matrix, scene.scale)
            shapes.append(shape_of_prim(each.prim, matrix))
            shape = shapes[-1][0]
            tally.add(len(shape.triangles) if isinstance(shape, Mesh) else 1)
        in_world = [(shape, compose(pose, place)) for shape, place in shapes]
        shape, inner = one_body(shapes, entry.name, notes, pieces)
        placed = compose(pose, inner)
        stated = mass_of_object(scene, entry, placed, in_world, notes)
        return Part(
            entry.name, shape, placed, grounded=entry.held, geometry=entry.geometry, **stated
        )
    except InputError as error:
        raise error.located(part=entry.name) from None


def _scaled(matrix: Any, scale: float) -> Any:
    """A transform to the world of the stage as one to the world of the assembly."""
    return np.diag([scale, scale, scale, 1.0]) @ matrix


def _table(scene: UsdScene, entry: UsdObject, parts: list[Part]) -> Part:
    """A held table for a plane, large enough for all parts."""
    from pxr import UsdGeom

    shape = entry.chosen[0]
    pose = rigid_part(_scaled(shape.matrix, scene.scale))
    axis = token_of(UsdGeom.Plane(shape.prim).GetAxisAttr(), AXES, "Z")
    upright = compose(pose, Pose.of(AXES[axis]))
    points = [part.pose.apply(surface(part.shape)[0]) for part in parts]
    corners = np.vstack(points) if points else np.zeros((1, 3))
    size = float(np.ptp(corners, axis=0).max()) or 1.0
    half = np.abs((corners - upright.position) @ upright.matrix)[:, :2].max(axis=0)
    box = Box([*(2 * (half + SPACIOUS * size)), size])
    return Part(
        entry.name,
        box,
        compose(upright, Pose([0, 0, -size / 2])),
        grounded=True,
        density=1000.0,
        table=True,
        geometry=entry.geometry,
    )


# Write new poses of the objects of a USD file as a layer of their own.


LAYERS = (".usda", ".usdc", ".usd")
"""Endings of layers that can be written."""


def write_usd_poses(source: str | Path, path: str | Path, before: Assembly, after: Assembly) -> int:
    """Write a layer with the poses of the moved parts over the USD file that they come from.

    Returns number of moved objects. Raises `InputError` if a file cannot be read or written, or a
    moved object is within an instance.
    """
    source, path = Path(source), Path(path)
    if path.suffix.lower() not in LAYERS:
        raise InputError(
            f"cannot write a layer of type {path.suffix or '(no ending)'}",
            file=str(path),
            hint=f"use {', '.join(LAYERS)}",
        )
    if path.exists() and path.resolve() == source.resolve():
        raise InputError("would be overwritten", file=str(path), hint="write to another file")
    require_usd()
    with caught_messages():
        try:
            scene = open_stage(source)
        except InputError as error:
            raise error.located(file=str(source)) from None
        layer, moved = _layer(scene, before, after)
    layer.subLayerPaths.append(
        Path(os.path.relpath(source.resolve(), path.resolve().parent)).as_posix()
    )
    with tempfile.TemporaryDirectory() as folder:
        draft = Path(folder) / f"layer{path.suffix.lower()}"
        layer.Export(str(draft))
        write_bytes(path, draft.read_bytes())
    return moved


def _layer(scene: UsdScene, before: Assembly, after: Assembly) -> tuple[Any, int]:
    """A layer with the transforms of the moved objects and the conventions of the stage."""
    from pxr import Sdf, Usd

    stage = scene.stage
    layer = Sdf.Layer.CreateAnonymous(".usda")
    stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
    stage.SetEditTarget(Usd.EditTarget(layer))
    objects, _ = find_objects(stage)
    instances: dict[str, dict[int, Array]] = {}
    moved = 0
    for entry in objects:
        if entry.name not in before.index or entry.name not in after.index:
            continue
        step = _displacement(before[entry.name].pose, after[entry.name].pose, scene.scale)
        if step is None:
            continue
        moved += 1
        if entry.instance >= 0:
            instances.setdefault(entry.path, {})[entry.instance] = step
        else:
            _move(stage, entry, step)
    for where, steps in instances.items():
        _move_instances(stage, where, steps)
    root = stage.GetRootLayer()
    for key in ("defaultPrim", "upAxis", "metersPerUnit", "kilogramsPerUnit"):
        if root.pseudoRoot.HasInfo(key):
            layer.pseudoRoot.SetInfo(key, root.pseudoRoot.GetInfo(key))
    return layer, moved


def _displacement(before: Pose, after: Pose, scale: float) -> Array | None:
    """Rigid displacement between two poses in the lengths of the stage, (4, 4); None if equal."""
    if before == after:
        return None
    step = np.eye(4)
    step[:3, :3] = after.matrix @ before.matrix.T
    step[:3, 3] = (after.position - step[:3, :3] @ before.position) / scale
    return step


def _move(stage: Any, entry: UsdObject, step: Array) -> None:
    """Override the transform of a prim so that it is displaced in the world."""
    from pxr import Gf, UsdGeom

    prim = stage.GetPrimAtPath(entry.path)
    if prim.IsInstanceProxy():
        raise InputError(
            "it is within an instance, whose prims cannot be moved",
            part=entry.name,
            hint="make the instance not instanceable",
        )
    place = UsdGeom.Xformable(prim)
    resets = place.GetResetXformStack()
    above = np.eye(4) if resets else matrix_of(place.ComputeParentToWorldTransform(0.0))
    local = np.linalg.inv(above) @ step @ entry.matrix
    place.MakeMatrixXform().Set(Gf.Matrix4d(local.T.tolist()))
    if resets:
        place.SetResetXformStack(True)


def _move_instances(stage: Any, path: str, steps: dict[int, Array]) -> None:
    """Override positions and orientations of instances of a point instancer."""
    from pxr import Gf, Usd, UsdGeom, Vt

    prim = stage.GetPrimAtPath(path)
    instancer, time = UsdGeom.PointInstancer(prim), Usd.TimeCode.Default()
    above = matrix_of(UsdGeom.XformCache(time).GetLocalToWorldTransform(prim))
    within = instancer.ComputeInstanceTransformsAtTime(
        time, time, instancer.ExcludeProtoXform, instancer.IgnoreMask
    )
    positions = np.array(instancer.GetPositionsAttr().Get(), dtype=np.float32)
    turned = any(np.abs(step[:3, :3] - np.eye(3)).max() > 0 for step in steps.values())
    turns = []
    for k, matrix in enumerate(within):
        local = matrix_of(matrix)
        if k in steps:
            local = np.linalg.inv(above) @ steps[k] @ above @ local
            positions[k] = local[:3, 3]
        axes = local[:3, :3] / np.linalg.norm(local[:3, :3], axis=0)
        w, x, y, z = matrix_to_quaternion(axes).tolist()
        turns.append(Gf.Quatf(w, x, y, z))
    instancer.GetPositionsAttr().Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(positions)))
    if turned:
        instancer.CreateOrientationsfAttr().Set(Vt.QuatfArray(turns))
