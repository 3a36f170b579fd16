"""Objects of COMPAS: the same answer as through the file that COMPAS writes."""

from collections.abc import Callable
from typing import Any

import pytest

import kilter
from kilter import InputError

pytest.importorskip("compas")
pytest.importorskip("compas_assembly")

import compas
from compas.datastructures import Mesh
from compas.geometry import Box, Frame
from compas_assembly.datastructures import Assembly, Block, Interface

Agree = Callable[..., kilter.Assembly]


def block(size: tuple[float, float, float], at: tuple[float, float, float], name: str = "") -> Any:
    shape = Box(*size, frame=Frame(at, [1, 0, 0], [0, 1, 0]))
    made = Block.from_shape(shape)
    if name:
        made.name = name
    return made


def assembled(*blocks: tuple[Any, bool]) -> Any:
    made = Assembly()
    for one, support in blocks:
        made.add_block(one)
        if support:
            made.graph.node_attribute(list(made.graph.nodes())[-1], "is_support", True)
    return made


def write(value: Any) -> Callable[..., None]:
    return lambda path: compas.json_dump(value, str(path))


def test_a_tower_stands(agree):
    made = assembled((block((1, 1, 1), (0, 0, 0)), True), (block((1, 1, 1), (0, 0, 1)), False))
    assert agree(made, write(made), "tower.json", "stable").names == ("0", "1")


@pytest.mark.parametrize(("reach", "verdict"), [(0.49, "stable"), (0.51, "unstable")])
def test_a_block_tips_where_its_centre_passes_the_edge(agree, reach, verdict):
    made = assembled((block((1, 1, 1), (0, 0, 0)), True), (block((1, 1, 1), (reach, 0, 1)), False))
    agree(made, write(made), "block.json", verdict)


def test_blocks_keep_their_names_and_densities(agree):
    low, high = block((1, 1, 1), (0, 0, 0), "low"), block((1, 1, 1), (0.2, 0, 1), "high")
    high.attributes["density"] = 2400.0
    made = assembled((low, True), (high, False))
    found = agree(made, write(made), "named.json", "stable")
    assert found.names == ("low", "high")
    assert found["high"].density == 2400


@pytest.mark.parametrize(("share", "verdict"), [(0.99, "unstable"), (1.01, "stable")])
def test_densities_decide_a_lever_in_millimetres(share, verdict):
    """A plank of 1.2 kg, 100 mm past the edge, and a weight 150 mm behind it; volumes by COMPAS."""
    base = block((1000, 1000, 100), (-500, 0, -50), "base")
    plank = block((600, 200, 20), (100, 0, 10), "plank")
    weight = block((100, 100, 100), (-150, 0, 70), "weight")
    plank.attributes["density"], weight.attributes["density"] = 500.0, share * 800.0
    made = assembled((base, True), (plank, False), (weight, False))
    answer = kilter.check(kilter.load(made, units="mm")).to_dict()
    assert answer["verdict"] == verdict
    assert answer["density"]["given"] == [500, share * 800]
    expected = [one.volume() * 1e-9 * one.attributes["density"] for one in (plank, weight)]
    assert [part["mass"] for part in answer["parts"][1:]] == pytest.approx(expected)


def test_one_block_stands_on_a_floor_and_a_list_of_meshes_is_named_apart(agree):
    one = block((2, 1, 1), (0, 0, 0))
    agree(one, write(one), "block.json", "stable", floor=True)
    two = [Mesh.from_shape(Box(1)), Mesh.from_shape(Box(1).translated([0, 0, 1]))]
    found = kilter.load(two, ground="Box")
    assert found.names == ("Box", "Box_2")
    assert kilter.check(found).stable


def test_interfaces_are_the_contacts_where_that_is_asked():
    made = assembled((block((1, 1, 1), (0, 0, 0)), True), (block((1, 1, 1), (0, 0, 1)), False))
    points = [[-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5], [-0.5, 0.5, 0.5]]
    frame = Frame([0, 0, 0.5], [1, 0, 0], [0, 1, 0])
    made.graph.add_edge(0, 1, interfaces=[Interface(size=1.0, points=points, frame=frame)])
    found = kilter.load(made, contacts="file")
    assert len(found.contacts) == 1
    assert not found.detect
    assert kilter.check(found).stable


def test_a_shape_of_its_geometry_is_told_what_is_taken():
    with pytest.raises(InputError, match=r"has no blocks; give a compas_assembly Assembly or"):
        kilter.load(Box(1))
