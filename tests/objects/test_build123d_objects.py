"""Objects of build123d: exact faces, and the same answer as through the STEP file it writes."""

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError

pytest.importorskip("build123d")

import build123d as b
from build123d import export_step

Agree = Callable[..., kilter.Assembly]


def labelled(label: str, shape: Any) -> Any:
    shape.label = label
    return shape


def compound(*children: Any) -> Any:
    return b.Compound(label="all", children=list(children))


def write(value: Any) -> Callable[..., Any]:
    return lambda path: export_step(value, str(path))


def test_a_rod_stands_on_a_base(agree):
    made = compound(
        labelled("base", b.Box(40, 40, 10)), labelled("rod", b.Pos(0, 0, 20) * b.Cylinder(5, 30))
    )
    found = agree(made, write(made), "rod.step", "stable", ground="base")
    assert (found.names, found.units) == (("base", "rod"), "mm")
    kinds = {surface.kind for surface in found["rod"].shape.surfaces}
    assert kinds == {"plane", "cylinder"}
    assert found.geometry.mass[1] == pytest.approx(1e-6 * np.pi * 25 * 30, rel=1e-10)


@pytest.mark.parametrize(("reach", "verdict"), [(9.9, "stable"), (10.1, "unstable")])
def test_a_box_tips_where_its_centre_passes_the_edge(agree, reach, verdict):
    made = compound(
        labelled("low", b.Box(20, 20, 20)),
        labelled("high", b.Pos(reach, 0, 20) * b.Box(20, 20, 20)),
    )
    agree(made, write(made), "boxes.step", verdict, ground="low")


def test_an_assembly_within_an_assembly_is_where_it_is_put(agree):
    pair = b.Compound(
        label="pair",
        children=[
            labelled("plate", b.Box(10, 10, 2)),
            labelled("pin", b.Pos(0, 0, 4) * b.Cylinder(1, 6)),
        ],
    )
    pair.location = b.Location((0, 0, 6), (0, 0, 45))
    made = compound(labelled("table", b.Box(40, 40, 10)), pair)
    found = agree(made, write(made), "pair.step", "stable", ground="table")
    assert found.geometry.center[found.index_of("pin")] == pytest.approx([0, 0, 10])


def test_a_part_of_several_solids_is_several_parts(agree):
    made = b.Pos(0, 0, 0) * b.Box(4, 4, 4) + b.Pos(10, 0, 0) * b.Box(4, 4, 4)
    made.label = "foot"
    found = agree(made, write(made), "feet.step", "stable", floor=True)
    assert found.names[:2] == ("foot_1", "foot_2")


def test_what_a_builder_made_is_its_part(agree):
    with b.BuildPart() as made:
        b.Box(10, 10, 10)
        b.Cylinder(2, 10, mode=b.Mode.SUBTRACT)
    made.part.label = "drilled"
    found = agree(made, write(made.part), "part.step", "stable", floor=True)
    assert found.names[0] == "drilled"
    assert found.geometry.volume[0] == pytest.approx(1000 - np.pi * 40)


def test_a_solid_that_is_used_twice_is_one_shape():
    bolt = b.Cylinder(2, 10)
    placed = [labelled("bolt", copy.copy(bolt)).moved(b.Location((x, 0, 0))) for x in (0, 10)]
    one, two = kilter.load(b.Compound(children=placed)).parts
    assert (one.name, two.name) == ("bolt_1", "bolt_2")
    assert one.shape is two.shape
    assert two.pose.position - one.pose.position == pytest.approx([10, 0, 0])


def test_its_triangles_are_left_alone():
    box = b.Box(1, 1, 1)
    before = box.tessellate(0.1)
    kilter.load(box)
    assert len(box.tessellate(0.1)[1]) == len(before[1])


def test_its_unit_is_the_millimetre_and_others_may_be_asked_for():
    found = kilter.load(b.Box(1, 1, 1), units="cm")
    assert found.units == "cm"
    assert "read as cm as asked" in found.notes[0]


@pytest.mark.parametrize("value", [b.Rectangle(1, 2), b.Edge.make_line((0, 0), (1, 0))])
def test_what_is_no_solid_is_refused(value):
    with pytest.raises(InputError, match=r"^no solid, only .*; export solids, not surfaces"):
        kilter.load(value)
