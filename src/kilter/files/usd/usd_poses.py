"""Write new poses of the objects of a USD file as a layer of their own.

The layer has the file as its sublayer and overrides only transforms, so the file stays unchanged.
The new transform of an object is its old transform, followed by the displacement D of its part:

    local' = parent^-1 D world        (column vectors)
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.usd.usd_objects import UsdObject, find_objects, matrix_of
from kilter.files.usd.usd_stage import UsdScene, caught_messages, open_stage, require_usd
from kilter.files.writing import write_bytes
from kilter.rigid import Pose, matrix_to_quaternion

__all__ = ["LAYERS", "write_usd_poses"]

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
