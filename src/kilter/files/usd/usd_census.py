"""Number of parts that a USD file would make, counted in its layers before they are composed.

    n(prim) = own + sum of n(children) + sum of n(targets of its arcs)

Arcs are references, payloads, inherited and specialised prims; of the variants of a set, the
largest counts. A chain of prims with two references each doubles its number at each step.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from kilter.files.limits import require_count, require_regular
from kilter.files.start_folder import is_restricted, require_below

__all__ = ["MOST_PARTS", "count_prims"]

MOST_PARTS = 50_000
"""Largest number of shapes of a stage."""
MOST_PRIMS = 500_000
"""Largest number of prims of a stage."""
SHAPES = {"Capsule", "Cone", "Cube", "Cylinder", "Mesh", "Plane", "Sphere"}
"""Types of the prims that are shapes."""


class _Count(NamedTuple):
    """Number of shapes, and of all prims."""

    parts: int = 0
    prims: int = 0

    def plus(self, other: _Count) -> _Count:
        """The sum of two counts."""
        return _Count(self.parts + other.parts, self.prims + other.prims)


def count_prims(path: Path) -> None:
    """Verify the number of prims of a stage, and the layers that it names.

    Raises
    ------
    InputError
        If the stage would have too many shapes or prims, or if a layer is a device, a pipe, or
        outside of the start folder.
    """
    census = _Census()
    count = census.of_layer(str(path))
    require_count("parts", count.parts, MOST_PARTS)
    require_count("prims", count.prims, MOST_PRIMS)


class _Census:
    """Counts of the prims of all layers; each is made once."""

    def __init__(self) -> None:
        self.layers: dict[str, Any] = {}
        self.counts: dict[tuple[str, str], _Count] = {}

    def layer(self, place: str) -> Any:
        """The layer at a place; None if it does not exist or is damaged."""
        if place not in self.layers:
            self.layers[place] = self._open(place)
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

    def of_layer(self, place: str) -> _Count:
        """Count of all prims of a layer and of its sublayers."""
        layer = self.layer(place)
        key = place, ""
        if layer is None or key in self.counts:
            return self.counts.get(key, _Count())
        self.counts[key] = total = _Count()  # the count of a loop, which USD reports
        for prim in layer.rootPrims:
            total = total.plus(self.of_prim(place, str(prim.path)))
        for name in layer.subLayerPaths:
            total = total.plus(self.of_layer(layer.ComputeAbsolutePath(name)))
        self.counts[key] = total
        return total

    def of_prim(self, place: str, path: str) -> _Count:
        """Count of a prim, its children, and the targets of its arcs."""
        layer = self.layer(place)
        key = place, path
        prim = layer.GetPrimAtPath(path) if layer is not None and path else None
        if prim is None or key in self.counts:
            return self.counts.get(key, _Count())
        self.counts[key] = total = _Count()
        if "{" not in path.rpartition("/")[2]:
            total = _Count(int(prim.typeName in SHAPES), 1)
        for child in prim.nameChildren:
            total = total.plus(self.of_prim(place, str(child.path)))
        for other, target in self._targets(layer, place, prim):
            total = total.plus(self.of_prim(other, target))
        for variants in prim.variantSets.values():
            each = [self.of_prim(place, str(v.primSpec.path)) for v in variants.variants.values()]
            total = total.plus(max(each, default=_Count()))
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
