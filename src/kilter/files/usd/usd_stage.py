"""Open a USD file: its stage with length unit, up axis and gravity, and one sentence for faults."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, some, visible
from kilter.files.file_tolerances import SAME_UNIT
from kilter.files.limits import (
    MOST_PARTS,
    SceneCount,
    is_restricted,
    require_below,
    require_count,
    require_regular,
)
from kilter.files.usd.usd_values import number_of, vector_of
from kilter.units import METRES

# Number of parts that a USD file would make, counted in its layers before they are composed.


MOST_PRIMS = 500_000
"""Largest number of prims of a stage."""
SHAPES = {"Capsule", "Cone", "Cube", "Cylinder", "Mesh", "Plane", "Sphere"}
"""Types of the prims that are shapes."""


def count_prims(path: Path) -> None:
    """Verify the number of prims of a stage, and the layers that it names.

    Raises `InputError` if the stage would have too many shapes or prims, or if a layer is a device,
    a pipe, or outside of the start folder.
    """
    census = _Census()
    count = census.of_layer(str(path))
    require_count("parts", count.parts, MOST_PARTS)
    require_count("prims", count.elements, MOST_PRIMS)


class _Census:
    """Counts of the prims of all layers; each is made once."""

    def __init__(self) -> None:
        self.layers: dict[str, Any] = {}
        self.counts: dict[tuple[str, str], SceneCount] = {}

    def layer(self, place: str) -> Any:
        """The layer at a place; None if it does not exist or is damaged."""
        if place not in self.layers:
            layer = self.layers[place] = self._open(place)
            for name in () if layer is None else layer.GetCompositionAssetDependencies():
                if name:  # every layer that it names is checked, also where no arc is counted
                    self.layer(layer.ComputeAbsolutePath(name))
        return self.layers[place]

    def _open(self, place: str) -> Any:
        """Open a layer after a check of its file."""
        from pxr import Sdf, Tf

        file = re.sub(r"\[.*\]$", "", place)  # a layer within a package
        require_below(file)
        require_regular(Path(file))
        if not os.path.isfile(file):
            return None
        try:
            layer = Sdf.Layer.FindOrOpen(place)
            if layer is not None:
                layer.Reload()  # a long-running process may hold an older version of the file
        except Tf.ErrorException:  # opening the stage reports the fault
            return None
        if layer is not None and is_restricted():
            for name in layer.GetExternalAssetDependencies():
                require_below(layer.ComputeAbsolutePath(name))
        return layer

    def of_layer(self, place: str) -> SceneCount:
        """Count of all prims of a layer and of its sublayers."""
        layer = self.layer(place)
        key = place, ""
        if layer is None or key in self.counts:
            return self.counts.get(key, SceneCount())
        self.counts[key] = total = SceneCount()  # the count of a loop, which USD reports
        for prim in filter(None, layer.rootPrims):  # a damaged layer lists prims without data
            total = total.plus(self.of_prim(place, str(prim.path)))
        for name in layer.subLayerPaths:
            total = total.plus(self.of_layer(layer.ComputeAbsolutePath(name)))
        self.counts[key] = total
        return total

    def of_prim(self, place: str, path: str) -> SceneCount:
        """Count of a prim, its children, and the targets of its arcs."""
        layer = self.layer(place)
        key = place, path
        prim = layer.GetPrimAtPath(path) if layer is not None and path else None
        if prim is None or key in self.counts:
            return self.counts.get(key, SceneCount())
        self.counts[key] = total = SceneCount()
        if "{" not in path.rpartition("/")[2]:
            total = SceneCount(int(prim.typeName in SHAPES), 1)
        for child in filter(None, prim.nameChildren):
            total = total.plus(self.of_prim(place, str(child.path)))
        for other, target in self._targets(layer, place, prim):
            total = total.plus(self.of_prim(other, target))
        for variants in filter(None, prim.variantSets.values()):
            specs = [variant.primSpec for variant in variants.variants.values() if variant]
            each = [self.of_prim(place, str(spec.path)) for spec in specs if spec]
            total = total.plus(max(each, default=SceneCount()))
        self.counts[key] = total
        return total

    def _targets(self, layer: Any, place: str, prim: Any) -> Iterator[tuple[str, str]]:
        """Layer and path of each prim that an arc of a prim names."""
        for arcs in (prim.inheritPathList, prim.specializesList):
            for target in arcs.GetAddedOrExplicitItems():
                yield place, str(target)
        for arcs in (prim.referenceList, prim.payloadList):
            for item in arcs.GetAddedOrExplicitItems():
                other = layer.ComputeAbsolutePath(item.assetPath) if item.assetPath else place
                named = self.layer(other)
                if named is None:
                    continue
                target = str(item.primPath) or named.defaultPrim
                target = target if not target or target.startswith("/") else f"/{target}"
                waiting, seen = [other], set[str]()
                while waiting:  # the sublayers of a layer contribute to its prims
                    one = waiting.pop()
                    if one not in seen and self.layer(one) is not None:
                        seen.add(one)
                        yield one, target
                        below = self.layer(one)
                        waiting += [below.ComputeAbsolutePath(name) for name in below.subLayerPaths]


USD = (".usda", ".usdc", ".usd", ".usdz")
"""Endings of USD files."""
EARTH = 9.81
"""Magnitude of gravity if the stage states none [m/s^2]."""


@dataclass(frozen=True, slots=True, eq=False)
class UsdScene:
    """An open stage and its conventions."""

    stage: Any
    units: str
    """One of "m", "cm", "mm", "in". Length unit of the assembly: that of the stage if kilter has
    it, else metres."""
    scale: float
    """Length of a unit of the stage [units]."""
    gravity: Array
    """[m/s^2], shape (3,)."""
    kilograms: float
    """Mass unit of the stage [kg]."""
    metres: float
    """Length of a unit of the stage [m]."""
    notes: tuple[str, ...]
    """Remarks about the file, such as another unit."""


def require_usd() -> None:
    """Raise `InputError` if usd-core is not installed."""
    try:
        import pxr.Usd  # noqa: F401
    except ImportError:
        raise InputError(
            "USD files need usd-core, which is not installed", hint='pip install "kilter[usd]"'
        ) from None


def open_stage(path: Path) -> UsdScene:
    """Open a USD file.

    Raises `InputError` if usd-core is not installed, or the file is missing, damaged or empty.
    """
    require_usd()
    from pxr import Tf, Usd, UsdGeom, UsdPhysics

    if not path.is_file():
        raise InputError("no such file", hint="check the path")
    count_prims(path)
    try:
        stage = Usd.Stage.Open(str(path))
        stage.Reload()  # a long-running process may hold an older version of the file
    except Tf.ErrorException as error:
        raise InputError(f"the USD is invalid: {_detail(error)}", hint="export it anew") from None
    metres = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not (math.isfinite(metres) and metres > 0):
        raise InputError(f"metersPerUnit is {metres}", hint="give the length of a unit in metres")
    kilograms = float(UsdPhysics.GetStageKilogramsPerUnit(stage))
    if not (math.isfinite(kilograms) and kilograms > 0):
        raise InputError(f"kilogramsPerUnit is {kilograms}", hint="give the mass of a unit in kg")
    units = next(
        (u for u, size in METRES.items() if math.isclose(metres, size, rel_tol=SAME_UNIT)), ""
    )
    scale = 1.0 if units else metres
    notes = []
    if not units:
        notes.append(f"the unit of the stage, {metres:g} m, was converted to metres")
    return UsdScene(
        stage,
        units or "m",
        scale,
        _gravity(stage, UsdGeom, UsdPhysics, metres),
        kilograms,
        metres,
        tuple(notes),
    )


@contextmanager
def caught_messages() -> Iterator[Callable[[], list[str]]]:
    """Catch the warnings of USD in place of their output on the error stream.

    Yields returns all warnings so far.
    """
    from pxr import UsdUtils

    messages: list[str] = []
    delegates = [UsdUtils.CoalescingDiagnosticDelegate()]

    def taken() -> list[str]:
        for delegate in delegates:
            messages.extend(entry.commentary for entry in delegate.TakeUncoalescedDiagnostics())
        return messages

    try:
        yield taken
    finally:
        taken()
        delegates.clear()  # its end restores the output


def _detail(error: Exception) -> str:
    """The cause in an error of USD, as a clause without paths of its source code."""
    causes = re.findall(r": '(.*?)'\s*(?:\n|$)", str(error), re.DOTALL)
    return " ".join((causes or [str(error)])[0].split())[:160]


def note_on_messages(messages: list[str]) -> list[str]:
    """A note on the warnings of USD: assets that could not be opened, else the first warning."""
    if not messages:
        return []
    assets = sorted({name for text in messages for name in re.findall(r"@([^@]+)@ for", text)})
    if assets:
        return [f"assets that could not be opened: {some([visible(name) for name in assets])}"]
    count = f"{len(messages)} faults, such as: " if len(messages) > 1 else ""
    return [f"USD reports {count}{visible(' '.join(messages[0].split()))[:160]}"]


def _gravity(stage: Any, geom: Any, physics: Any, metres: float) -> Array:
    """Gravity of the first physics scene, else that of the Earth against the up axis [m/s^2]."""
    axis = str(geom.GetStageUpAxis(stage))
    if axis not in ("Y", "Z"):
        raise InputError(f"upAxis is {visible(axis)!r:.40}", hint="use Y or Z")
    up = np.array([0.0, 1, 0] if axis == "Y" else [0.0, 0, 1])
    down, size = -up, EARTH
    for prim in stage.Traverse():
        if prim.IsA(physics.Scene):
            entry = physics.Scene(prim)
            direction = vector_of(entry.GetGravityDirectionAttr(), 3, (0, 0, 0))
            magnitude = number_of(entry.GetGravityMagnitudeAttr(), -math.inf)
            length = float(np.linalg.norm(direction))
            if not math.isfinite(length) or magnitude == math.inf:
                raise InputError("its gravity is not finite", hint="give a direction in numbers")
            if length > 0:
                down = direction / length
            if magnitude > 0:
                size = magnitude * metres
            break
    result: Array = down * size + 0.0
    return result
