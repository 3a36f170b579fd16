"""Open a USD file: its stage with length unit, up axis and gravity, and one sentence for faults."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, some
from kilter.files.file_tolerances import SAME_UNIT
from kilter.files.start_folder import is_restricted, require_below
from kilter.units import METRES

__all__ = ["USD", "UsdScene", "open_stage"]

USD = (".usda", ".usdc", ".usd", ".usdz")
"""Endings of USD files."""
EARTH = 9.81
"""Magnitude of gravity if the stage states none [m/s^2]."""


@dataclass(frozen=True, slots=True, eq=False)
class UsdScene:
    """An open stage and its conventions.

    Attributes
    ----------
    stage : pxr.Usd.Stage
    units : {"m", "cm", "mm", "in"}
        Length unit of the assembly: that of the stage if kilter has it, else metres.
    scale : float
        Length of a unit of the stage [units].
    gravity : ndarray, shape (3,)
        [m/s^2].
    kilograms : float
        Mass unit of the stage [kg].
    metres : float
        Length of a unit of the stage [m].
    notes : tuple of str
        Remarks about the file, such as missing assets.
    """

    stage: Any
    units: str
    scale: float
    gravity: Array
    kilograms: float
    metres: float
    notes: tuple[str, ...]


def open_stage(path: Path) -> UsdScene:
    """Open a USD file.

    Raises
    ------
    InputError
        If usd-core is not installed, or the file is missing, damaged or empty.
    """
    try:
        from pxr import Tf, Usd, UsdGeom, UsdPhysics
    except ImportError:
        raise InputError(
            "USD files need usd-core, which is not installed", hint='pip install "kilter[usd]"'
        ) from None
    if not path.is_file():
        raise InputError("no such file", hint="check the path")
    with _quiet() as messages:
        try:
            if is_restricted():
                _require_layers_below(path)
            stage = Usd.Stage.Open(str(path))
            stage.Reload()  # a long-running process may hold an older version of the file
        except Tf.ErrorException as error:
            raise InputError(
                f"the USD is invalid: {_detail(error)}", hint="export it anew"
            ) from None
    metres = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not (math.isfinite(metres) and metres > 0):
        raise InputError(f"metersPerUnit is {metres}", hint="give the length of a unit in metres")
    units = next(
        (u for u, size in METRES.items() if math.isclose(metres, size, rel_tol=SAME_UNIT)), ""
    )
    scale = 1.0 if units else metres
    notes = [_missing(messages)] if messages else []
    if not units:
        notes.append(f"the unit of the stage, {metres:g} m, was converted to metres")
    return UsdScene(
        stage,
        units or "m",
        scale,
        _gravity(stage, UsdGeom, UsdPhysics, metres),
        float(UsdPhysics.GetStageKilogramsPerUnit(stage)),
        metres,
        tuple(notes),
    )


def _require_layers_below(path: Path) -> None:
    """Verify that all layers of a stage are below the start folder, before any is composed.

    Raises
    ------
    InputError
        If a layer, or a file that it names, is outside.
    """
    from pxr import Sdf

    waiting, seen = [str(path)], set[str]()
    while waiting:
        place = waiting.pop()
        file = re.sub(r"\[.*\]$", "", place)  # a layer within a package
        if place in seen:
            continue
        seen.add(place)
        require_below(file)
        layer = Sdf.Layer.FindOrOpen(place) if Path(file).is_file() else None
        if layer is not None:
            named = {
                *layer.GetCompositionAssetDependencies(),
                *layer.GetExternalAssetDependencies(),
            }
            waiting += [layer.ComputeAbsolutePath(name) for name in sorted(named) if name]


@contextmanager
def _quiet() -> Iterator[list[str]]:
    """Collect the warnings of USD in place of their output on the error stream."""
    from pxr import UsdUtils

    messages: list[str] = []
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield messages
    finally:
        messages += [entry.commentary for entry in delegate.TakeUncoalescedDiagnostics()]
        del delegate


def _detail(error: Exception) -> str:
    """The cause in an error of USD, as a clause without paths of its source code."""
    causes = re.findall(r": '(.*?)'\s*(?:\n|$)", str(error), re.DOTALL)
    return " ".join((causes or [str(error)])[0].split())[:160]


def _missing(messages: list[str]) -> str:
    """A note about assets that the stage names but that could not be opened."""
    assets = sorted({name for text in messages for name in re.findall(r"@([^@]+)@ for", text)})
    if assets:
        return f"assets that could not be opened: {some(assets)}"
    return f"USD reports: {' '.join(messages[0].split())[:160]}"


def _gravity(stage: Any, geom: Any, physics: Any, metres: float) -> Array:
    """Gravity of the first physics scene, else that of the Earth against the up axis [m/s^2]."""
    up = np.array([0.0, 1, 0] if geom.GetStageUpAxis(stage) == geom.Tokens.y else [0.0, 0, 1])
    down, size = -up, EARTH
    for prim in stage.Traverse():
        if prim.IsA(physics.Scene):
            entry = physics.Scene(prim)
            direction = np.array(entry.GetGravityDirectionAttr().Get() or (0, 0, 0), dtype=float)
            magnitude = float(entry.GetGravityMagnitudeAttr().Get())
            if np.linalg.norm(direction) > 0:
                down = direction / np.linalg.norm(direction)
            if math.isfinite(magnitude) and magnitude > 0:
                size = magnitude * metres
            break
    result: Array = down * size + 0.0
    return result
