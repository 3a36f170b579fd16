"""Models and problems of compas_dem: blocks in place, supports, loads, faults."""

import math
from typing import Any

import pytest
from test_compas import block

import kilter
from kilter.errors import InputError
from kilter.loading import load


def shift(x: float, y: float, z: float) -> dict[str, Any]:
    matrix = [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]
    return {"dtype": "compas.geometry/Translation", "data": {"matrix": matrix}}


def quarter_turn() -> dict[str, Any]:
    """A turn of 90 degrees about z."""
    matrix = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    return {"dtype": "compas.geometry/Rotation", "data": {"matrix": matrix}}


def element(place: Any = None, *, support: bool = False, **data: Any) -> dict[str, Any]:
    mesh = {"dtype": "compas.datastructures/Mesh", "data": block()["data"]}
    return {
        "dtype": "compas_dem.elements/Block",
        "data": {"geometry": mesh, "transformation": place, "is_support": support, **data},
    }


GROUP = {"dtype": "compas_model.elements/Group", "data": {"geometry": None}}


def model(elements: dict[str, Any], tree: Any = None, **data: Any) -> dict[str, Any]:
    children = tree or [{"element": guid} for guid in elements]
    nodes = {str(k): {"element": guid} for k, guid in enumerate(elements)}
    content = {
        "transformation": None,
        "elements": elements,
        "materials": {},
        "tree": {"root": {"name": "root", "children": children}},
        "graph": {"node": nodes, "edge": {}},
        **data,
    }
    return {"dtype": "compas_dem.models/BlockModel", "data": content, "guid": "model-1"}


def tower(**data: Any) -> dict[str, Any]:
    """A held cube of edge 1 and a cube on it."""
    return model({"a": element(support=True), "b": element(shift(0, 0, 1))}, **data)


def problem(*entries: tuple[str, dict[str, Any]], **law: Any) -> dict[str, Any]:
    groups: dict[str, list[Any]] = {}
    for kind, entry in entries:
        groups.setdefault(kind, []).append({"dtype": "compas_dem.problem/Load", "data": entry})
    contact = {"dtype": "compas_dem.interactions/MohrCoulomb", "data": law} if law else None
    content = {
        "model_id": "model-1",
        "boundary_conditions": [{"dtype": "compas_dem.problem/Group", "data": groups}],
        "contact_properties": {"dtype": "x.y/Z", "data": {"contact_model": contact}},
    }
    return {"dtype": "compas_dem.problem/Problem", "data": content}


def test_blocks_stand_where_model_group_and_block_place_them(write):
    elements = {"g": {**GROUP, "data": {**GROUP["data"], "transformation": quarter_turn()}}}
    elements["b"] = element(shift(2, 0, 0))
    tree = [{"element": "g", "children": [{"element": "b"}]}]
    made = load(write("a.json", model(elements, tree, transformation=shift(0, 0, 5))))
    centre = made.geometry.center[0]
    origin = load(write("b.json", model({"b": element()}))).geometry.center[0]
    turned = [-origin[1], origin[0] + 2, origin[2] + 5]
    assert centre == pytest.approx(turned, abs=1e-12)
    assert made.names == ("1",)  # the group is no part


def test_supports_densities_and_names_are_those_of_the_model(write):
    stone = {"m": {"dtype": "compas_dem.material/Stone", "data": {"density": 2500}}}
    elements = {
        "a": element(support=True, name="Block"),
        "b": element(shift(0, 0, 1), material="m", name="Block"),
        "c": element(shift(0, 0, 2), name="key"),
    }
    made = load(write("a.json", model(elements, materials=stone)))
    assert [part.grounded for part in made.parts] == [True, False, False]
    assert made.names == ("0", "1", "key")
    assert made.geometry.mass == pytest.approx([1000, 2500, 1000])


def test_contacts_of_the_model_are_used_by_request(write):
    corners = [[x, y, 0.5] for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    frame = {"data": {"xaxis": [1, 0, 0], "yaxis": [0, 1, 0]}, "dtype": "compas.geometry/Frame"}
    contact = {"dtype": "compas_dem.interactions/FrictionContact"}
    contact |= {"data": {"points": corners, "frame": frame}}
    nodes = {"0": {"element": "a"}, "1": {"element": "b"}}
    graph = {"node": nodes, "edge": {"0": {"1": {"contacts": [contact]}}}}
    path = write("a.json", tower(graph=graph))
    assert "has 1 interfaces" in load(path).notes[0]
    given = load(path, contacts="file")
    assert len(given.contacts) == 1
    assert given.contacts[0].normal == pytest.approx([0, 0, 1])


def test_the_model_of_a_problem_is_found_beside_it(write):
    write("other.json", {**tower(), "guid": "model-2"})
    write("tower.json", tower())
    made = load(write("problem.json", problem(mu=0.4)))
    assert made.names == ("0", "1")
    assert made.friction == 0.4


def test_a_problem_without_its_model_names_it(write):
    write("other.json", {**tower(), "guid": "model-2"})
    path = write("problem.json", problem(mu=0.4))
    with pytest.raises(InputError, match=r"about the model model-1, and no \.json file beside it"):
        load(path)
    both = [{**tower(), "guid": "model-2"}, problem()]
    with pytest.raises(InputError, match="the file has another model"):
        load(write("both.json", both))


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_body_force_pushes_each_free_block_by_its_mass(write, share):
    mu = 0.3
    push = {"acceleration": [share * mu * 9.81, 0, 0]}
    made = load(write("a.json", [tower(), problem(("body_forces", push), mu=mu)]))
    verdict = kilter.check(made)
    assert (verdict.level is not None) == (share < 1)


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_load_at_a_point_tips_a_block_at_half_its_weight(write, share):
    # at the top of a cube of edge 1 the push tips it about the far edge: F * 1 = m g / 2
    size = share * 1000 * 9.81 / 2
    push = {"block_index": 1, "force": [size, 0, 0], "point": [0, 0, 1.5]}
    made = load(write("a.json", [tower(), problem(("point_loads", push), mu=2.0)]))
    assert (kilter.check(made).level is not None) == (share < 1)


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_moment_tips_a_block_at_half_its_weight(write, share):
    turn = {"block_index": 1, "moment": [0, share * 1000 * 9.81 / 2, 0]}
    made = load(write("a.json", [tower(), problem(("point_loads", turn), mu=2.0)]))
    assert (kilter.check(made).level is not None) == (share < 1)


def test_a_surface_load_acts_at_the_centroid_of_its_face(write):
    places = {"vertex": {str(k): p for k, p in enumerate([[0, 0], [4, 0], [1, 3], [0, 3]])}}
    corners = {k: {"x": x, "y": y, "z": 0} for k, (x, y) in places["vertex"].items()}
    corners |= {str(int(k) + 4): {**v, "z": 1} for k, v in corners.items()}
    faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    data = {"vertex": corners, "face": {str(k): face for k, face in enumerate(faces)}}
    mesh = {"dtype": "compas.datastructures/Mesh", "data": data}
    load_ = {"block_index": 0, "face_index": 1, "load": [0, 0, -10]}
    both = [model({"a": element(geometry=mesh)}), problem(("surface_loads", load_))]
    (found,) = load(write("a.json", both)).loads
    area = 7.5  # a trapezium with sides 4 and 1, height 3
    assert found.force == pytest.approx([0, 0, -10 * area])
    # its triangles (0 0, 4 0, 1 3) and (0 0, 1 3, 0 3)
    assert found.point == pytest.approx([(6 * 5 / 3 + 1.5 / 3) / area, (6 + 1.5 * 2) / area, 1])


def test_what_is_not_read_of_a_problem_is_noted(write):
    moved = {"block_index": 0, "translation": [0, 0, 0.1]}
    both = [tower(), problem(("displacements", moved), mu=0.5, c=1e4, t_c=0)]
    (note,) = load(write("a.json", both)).notes
    assert note == (
        "the problem also has prescribed displacements, cohesion, which kilter does not use"
    )


@pytest.mark.parametrize(
    ("data", "what"),
    [
        ([tower(), problem(("point_loads", {"block_index": 7}))], "loads the unknown block 7"),
        (
            [tower(), problem(("surface_loads", {"block_index": 1, "face_index": 9}))],
            "unknown face 9 of block '1'",
        ),
        (
            [tower(), problem(("body_forces", {"acceleration": [1, 2]}))],
            "not three numbers",
        ),
        (
            model(
                {"a": element(shift(1e308, 1e308, 0)), "b": element(shift(-2, 0, 0))},
                transformation=shift(1e308, 0, 0),
            ),
            "finite|large",
        ),
        (model({}), "has no blocks"),
        (model({"a": element({"dtype": "x.y/T", "data": {"matrix": [[1]]}})}), "4 x 4 numbers"),
        ([tower(), problem(), problem()], "has 2 problems"),
        (model({"a": element(geometry={"data": {}, "dtype": "a.b/Brep"})}), "no block with vert"),
    ],
)
def test_damaged_models_are_named(write, data, what):
    with pytest.raises(InputError, match=what):
        load(write("a.json", data))


def test_a_turned_tower_has_the_verdict_of_the_upright(write):
    angle = math.radians(3)
    c, s = math.cos(angle), math.sin(angle)
    turn = {"data": {"matrix": [[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]]}}
    turn["dtype"] = "compas.geometry/Rotation"
    made = load(write("a.json", tower(transformation=turn)), friction=0.1)
    assert kilter.check(made).level is not None
    assert kilter.check(made.with_friction(0.05)).level is None
