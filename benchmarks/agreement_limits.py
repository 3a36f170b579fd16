"""Assemblies just inside and just outside each limit of a margin, for the census of agreement."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from kilter.assembly import Assembly
from kilter.assembly.interactions import Load

__all__ = ["NEAR", "beside_level_limits", "beside_limits"]

NEAR = 1e-3
"""Distance of the tests from a limit: relative, or of a direction [rad]."""


def beside_limits(
    assembly: Assembly, margin: Any, push: Any
) -> Iterator[tuple[str, Assembly, str, bool]]:
    """Words, an assembly beside a limit, the level of the limit, and whether it must hold."""
    if margin.tilt is not None and margin.tilt_down is not None:
        lower = float(margin.tilt.lower)
        for angle, expected in ((lower - NEAR, True), (np.radians(margin.tilt_deg) + NEAR, False)):
            if angle > 0:
                down = _toward(assembly.down, margin.tilt.toward, angle)
                yield f"tilt {angle:.6f}", assembly.with_down(down), "equilibrium", expected
    if margin.friction is not None and margin.friction > 0 and not assembly.friction_pairs:
        least = float(margin.friction)
        for mu, expected in ((least * (1 + NEAR), True), (least * (1 - NEAR), False)):
            if expected or mu < margin.friction_limit.lower:
                rough = assembly.with_friction(mu)
                yield f"mu {mu:.6f}", rough, "equilibrium", expected
    ends = margin.load_factor
    if ends is not None and np.isfinite(ends[1]):
        most = ends[1]
        for factor, expected in ((most * (1 - NEAR), True), (most * (1 + NEAR) + 1e-6, False)):
            if most > NEAR and margin.check.level is not None:
                gravity = assembly.gravity + factor * np.linalg.norm(assembly.gravity) * push
                loaded = replace(assembly, gravity=gravity)
                yield f"load factor {factor:.6f}", loaded, "equilibrium", expected
    for weakest in margin.pushes:
        # a limit of zero is left by a share of the weight
        outside = float(weakest.force) * (1 + NEAR) + NEAR * _weight(assembly, weakest.part)
        for size, expected in ((weakest.lower * (1 - NEAR), True), (outside, False)):
            if np.isfinite(size) and (expected or weakest.limit.motion is not None):
                loaded = _pushed(assembly, weakest, size)
                yield f"push {weakest.part} {size:.6g} N", loaded, "equilibrium", expected


def _weight(assembly: Assembly, name: str) -> float:
    """Weight of a part [N]."""
    return float(assembly[name].mass * np.linalg.norm(assembly.gravity))


def _pushed(assembly: Assembly, weakest: Any, size: float) -> Assembly:
    """The assembly with a force of a size [N] on a part, in the weakest direction of its push."""
    load = Load(weakest.part, force=size * weakest.direction)
    return replace(assembly, loads=[*assembly.loads, load])


def beside_level_limits(
    assembly: Assembly, margin: Any, push: Any
) -> Iterator[tuple[str, Assembly, str, bool]]:
    """As `beside_limits`, for the limits of a level above equilibrium; `push` may be None."""
    limits, size = margin.at_level, float(np.linalg.norm(assembly.gravity))

    def turned(degrees: float) -> Assembly:
        down = _toward(assembly.down, margin.tilt.toward, np.radians(degrees))
        return assembly.with_down(down)

    def loaded(factor: float) -> Assembly:
        return replace(assembly, gravity=assembly.gravity + factor * size * push)

    ways: list[tuple[str, Any, Callable[[float], Assembly]]] = [
        ("tilt", limits.tilt_deg, turned),
        *(("load factor", end, loaded) for end in limits.load_factor or () if push is not None),
        *(
            (f"push {w.part}", limits.pushes.get(w.part), partial(_pushed, assembly, w))
            for w in margin.pushes
        ),
    ]
    if not assembly.friction_pairs:
        ways.append(("mu", limits.friction, assembly.with_friction))
    for name, limit, changed in ways:
        if limit is None or limit.why is not None:
            continue
        toward = -1.0 if name == "mu" else 1.0
        for value, shift, expected in (
            (limit.inside, 1 - toward * NEAR, True),
            (limit.outside, 1 + toward * NEAR, False),
        ):
            if np.isfinite(value) and abs(value) > NEAR:
                words = f"{name} at {limits.level} {value * shift:.6g}"
                yield words, changed(value * shift), limits.level, expected


def _toward(down: Any, across: Any, angle: float) -> Any:
    """The direction `down` turned by an angle [rad] toward a direction across it."""
    return np.cos(angle) * down + np.sin(angle) * across
