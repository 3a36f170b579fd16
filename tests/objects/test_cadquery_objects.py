"""Objects of CadQuery: exact faces, and the same answer as through the STEP file it writes."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError

pytest.importorskip("cadquery")

import cadquery as cq

Agree = Callable[..., kilter.Assembly]


def write(value: Any) -> Callable[..., Any]:
    if isinstance(value, cq.Assembly):
        return lambda path: value.export(str(path))
    return lambda path: cq.exporters.export(value, str(path))


def at(x: float = 0, y: float = 0, z: float = 0) -> Any:
    return cq.Location((x, y, z))


def box(x: float, y: float, z: float) -> Any:
    return cq.Workplane().box(x, y, z)


def test_a_rod_stands_on_a_base(agree):
    made = cq.Assembly(name="all").add(box(40, 40, 10), name="base")
    made = made.add(cq.Workplane().cylinder(30, 5), name="rod", loc=at(z=20))
    found = agree(made, write(made), "rod.step", "stable", ground="base")
    assert (found.names, found.units) == (("base", "rod"), "mm")
    assert {surface.kind for surface in found["rod"].shape.surfaces} == {"plane", "cylinder"}
    assert found.geometry.mass[1] == pytest.approx(1e-6 * np.pi * 25 * 30, rel=1e-10)


@pytest.mark.parametrize(("reach", "verdict"), [(9.9, "stable"), (10.1, "unstable")])
def test_a_box_tips_where_its_centre_passes_the_edge(agree, reach, verdict):
    made = cq.Assembly(name="all").add(box(20, 20, 20), name="low")
    made = made.add(box(20, 20, 20), name="high", loc=at(reach, z=20))
    agree(made, write(made), "boxes.step", verdict, ground="low")


def test_an_assembly_within_an_assembly_is_where_it_is_put(agree):
    pair = cq.Assembly(name="pair", loc=cq.Location((0, 0, 6), (0, 0, 1), 45))
    pair = pair.add(box(10, 10, 2), name="plate")
    pair = pair.add(cq.Workplane().cylinder(6, 1), name="pin", loc=at(z=4))
    made = cq.Assembly(name="all").add(box(40, 40, 10), name="table").add(pair)
    found = agree(made, write(made), "pair.step", "stable", ground="table")
    assert found.geometry.center[found.index_of("pin")] == pytest.approx([0, 0, 10])


def test_a_workplane_and_a_shape(agree):
    made = box(10, 10, 10).faces(">Z").workplane().hole(4)
    one = cq.Assembly(name="all").add(made, name="drilled")
    found = agree(one, write(one), "part.step", "stable", floor=True)
    assert found.geometry.volume[0] == pytest.approx(1000 - np.pi * 40)
    assert kilter.load(made.val()).geometry.volume[0] == pytest.approx(1000 - np.pi * 40)
    assert kilter.check(found).stable


def test_shapes_by_name(agree):
    found = kilter.load({"table": box(9, 9, 1), "cup": box(1, 1, 1).translate((0, 0, 1))},
                        ground="table")  # fmt: skip
    assert found.names == ("table", "cup")
    assert kilter.check(found).stable


def test_what_is_no_solid_is_refused():
    with pytest.raises(InputError, match=r"^no solid, only .*; export solids, not surfaces"):
        kilter.load(cq.Workplane().rect(1, 1))
