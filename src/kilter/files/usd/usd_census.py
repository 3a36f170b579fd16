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
from typing import Any

from kilter.files.limits import MOST_PARTS, SceneCount, require_count, require_regular
from kilter.files.start_folder import is_restricted, require_below

__all__ = ["count_prims"]

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
