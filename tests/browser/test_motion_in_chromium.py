"""Playing stops before parts overlap, tested with the moved parts in Python."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

import kilter
from kilter import Assembly, Pose
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix
from kilter.scenes import SCENES, scene
from kilter.show.shapes import place_shapes

pytestmark = pytest.mark.browser

ENTERS = 1e-3
"""Tolerated depth [size of the smaller part]."""


def moved(assembly: Assembly, places: np.ndarray) -> Assembly:
    """The assembly in the poses of the page: quaternion x, y, z, w and middle of each shape."""
    rest = place_shapes(assembly)
    parts = []
    for k, part in enumerate(assembly.parts):
        turn = quaternion_to_matrix(places[k, [3, 0, 1, 2]])
        turn = turn @ quaternion_to_matrix(rest.rotation[k]).T
        position = places[k, 4:7] + turn @ (part.pose.position - rest.position[k])
        rotation = matrix_to_quaternion(turn @ quaternion_to_matrix(part.pose.rotation))
        parts.append(dataclasses.replace(part, pose=Pose(position, rotation)))
    return Assembly(parts, units=assembly.units, gravity=assembly.gravity)


def depths(assembly: Assembly) -> dict[tuple[int, int], float]:
    """Depth of overlap of pairs of parts [size of the smaller part]."""
    size = assembly.geometry.size
    found = kilter.contacts(assembly).overlaps
    return {one.ends: one.depth / size[list(one.ends)].min() for one in found}


BLOCKED = ("paper-figure-3-vertices", "cad-export")
"""Scenes whose motion closes an open pair at once, so that the page cannot show it."""


@pytest.mark.parametrize("name", SCENES)
def test_play_stops_before_parts_enter_each_other(name: str, opened: Callable) -> None:
    assembly = scene(name)
    if not kilter.check(assembly, effort=0).moving:
        pytest.skip("nothing moves")
    page = opened(name)
    rest = depths(assembly)
    rows = (
        "() => { const d = window.kilter.stage.parts.data; return Array.from({length:"
        " window.kilter.page.parts.names.length}, (_, k) => [...d.subarray(16 * k, 16 * k + 7)]); }"
    )
    before = np.array(page.js(rows))
    center = page.js("window.kilter.page.center")
    for share in (0.25, 0.5, 0.75, 1.0):
        page.slide("motion", share)
        places = np.array(page.js(rows))
        places[:, 4:7] += center
        for pair, depth in depths(moved(assembly, places)).items():
            assert depth <= rest.get(pair, 0.0) + ENTERS, (share, pair)
    blocked = "blocked" in page.text("motion-label")
    assert blocked == (name in BLOCKED)
    assert blocked or np.abs(np.array(page.js(rows)) - before).max() > 1e-3


def test_what_is_asked_sees_parts_that_enter() -> None:
    """The test fails for a motion that does not stop."""
    assembly = scene("paper-figure-8")
    rest = place_shapes(assembly)
    places = np.column_stack([rest.rotation[:, [1, 2, 3, 0]], rest.position])
    assert not depths(moved(assembly, places))
    places[2, 6] -= 0.2
    assert max(depths(moved(assembly, places)).values()) > 10 * ENTERS
