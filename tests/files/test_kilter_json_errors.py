"""Faults of a kilter file: each gives a single message with file, part and remedy."""

# ruff: noqa: E501 (a row of a table is a line)
import contextlib
import copy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kilter.errors import InputError
from kilter.files import from_dict
from kilter.loading import load

BASE: dict[str, Any] = {
    "kilter": 1,
    "parts": [{"name": "C1", "box": [1, 1, 1]}, {"name": "C2", "box": [1, 1, 1]}],
}


def refused(data: Any) -> str:
    with pytest.raises(InputError) as caught:
        from_dict(data, folder=".", source="a.kilter.json")
    message = str(caught.value)
    assert message.startswith("a.kilter.json: ")
    assert caught.value.hint
    return message


PART = [
    ({"densty": 1}, "unknown key 'densty'; did you mean 'density'?"),
    ({"xyzzy": 1}, "unknown key 'xyzzy'; known keys are name, mesh, box,"),
    ({"pose": {"rotaton": [1, 0, 0, 0]}}, "unknown key 'pose.rotaton'; did you mean 'rotation'?"),
    ({"box": None, "cylinder": {"radius": 1, "hight": 1}}, "did you mean 'height'?"),
    ({"box": None, "mesh": {"vertices": [], "facs": []}}, "unknown key 'mesh.facs' (and 1 more faults); did you mean 'faces'"),
    ({"box": None, "step": "a.stl"}, "step 'a.stl': this file type cannot be read; give one of .step, .stp, .igs, .iges, .fcstd"),
    ({"box": None, "step": {"path": 1}}, "step.path is 1; give a text"),
    ({"box": None, "step": {"path": "a.stp", "nam": "b"}}, "unknown key 'step.nam'; did you mean 'name'?"),
    ({"mass": True}, "mass is true; give a number"),
    ({"mass": "5"}, 'mass is "5"; give a number'),
    ({"mass": -1}, "mass is -1; give a number above 0"),
    ({"mass": 0}, "mass is 0; give a number above 0"),
    ({"mass": float("nan")}, "mass is NaN; give a finite number"),
    ({"mass": 10**400}, "mass is 1000"),
    ({"density": [1]}, "density is a list; give a number"),
    ({"grounded": 1}, "grounded is 1; give true or false"),
    ({"grounded": "yes"}, 'grounded is "yes"; give true or false'),
    ({"box": [1, True, 1]}, "box[1] is true; give a number"),
    ({"box": [1, 1]}, "box has 2 entries; give 3"),
    ({"box": [1, 1, 1, 1]}, "box has 4 entries; give 3"),
    ({"box": [1, float("inf"), 1]}, "box[1] is Infinity; give a finite number"),
    ({"box": [1, 0, 1]}, "box[1] is 0; give a number above 0"),
    ({"box": {}}, "box is an object; give a list"),
    ({"box": None}, "has no shape; give exactly one of mesh, box, cylinder, sphere, polygon"),
    ({"sphere": {"radius": 1}}, "has box and sphere; give exactly one of"),
    ({"depth": 1}, "depth without polygon; a prism needs both"),
    ({"box": None, "polygon": [[0, 0], [1, 0], [0, 1]]}, "polygon without depth"),
    ({"box": None, "polygon": [[0, 0], [1, 0]], "depth": 1}, "polygon has 2 entries; give 3 or more"),
    ({"box": None, "polygon": [[0, 0, 0]], "depth": 1}, "polygon[0] has 3 entries; give 2"),
    ({"box": None, "polygon": [[0, 0], [1, 1], [1, 0], [0, 3]], "depth": 1}, "crosses itself"),
    ({"box": None, "cylinder": {"radius": 1}}, "cylinder.height is missing; add the key 'height'"),
    ({"box": None, "cylinder": [1, 2]}, "cylinder is a list; give an object"),
    ({"box": None, "sphere": {"radius": -2}}, "sphere.radius is -2; give a number above 0"),
    ({"pose": [0, 0, 0]}, "pose is a list; give an object"),
    ({"pose": {"position": [0, 0]}}, "pose.position has 2 entries; give 3"),
    ({"pose": {"rotation": [0, 0, 0, 0]}}, "rotation is the zero quaternion; no turn is"),
    ({"center_of_mass": [0, None, 0]}, "center_of_mass[1] is null; give a number"),
    ({"inertia": [1, 1, 1]}, "inertia has 3 entries; give 6"),
    ({"inertia": [1, 1, 3, 0, 0, 0]}, "1, 1, 3: the largest exceeds the sum of the others; give xx"),
    ({"inertia": [1, 1, 1, 2, 0, 0]}, "-1, 1, 3: the least is not positive; give xx, yy, zz, xy"),
    ({"inertia": [0, 1, 1, 0, 0, 0]}, "0, 1, 1: the least is not positive; give xx, yy, zz, xy"),
    ({"box": None, "mesh": 5}, "mesh is 5; give an object"),
    ({"box": None, "mesh": ""}, "mesh is \"\"; give a text"),
    ({"box": None, "mesh": "absent.stl"}, "mesh 'absent.stl': no such file; check the path"),
    ({"box": None, "mesh": "a.step"}, "mesh 'a.step': this file type cannot be read; give one of .obj"),
    ({"box": None, "mesh": {"vertices": [[0, 0, 0]], "faces": [[0, 1, 2]]}}, "face 0 names vertex 1"),
    ({"box": None, "mesh": {"vertices": [[0, 0, 0]], "faces": [[0, 0]]}}, "mesh.faces[0] has 2"),
    ({"box": None, "mesh": {"vertices": [[0, 0, 0]], "faces": [[0, True, 2]]}}, "is true; give a whole"),
    ({"box": None, "mesh": {"vertices": [[0, 0, 0]], "faces": [[0, 0.5, 2]]}}, "is 0.5; give a whole"),
    ({"box": None, "mesh": {"vertices": [[0, 0]], "faces": []}}, "mesh.vertices[0] has 2 entries"),
]  # fmt: skip


@pytest.mark.quick(36)
@pytest.mark.parametrize(("change", "message"), PART)
def test_a_fault_of_a_part_names_it(change, message):
    data = copy.deepcopy(BASE)
    data["parts"][1] |= change
    if change.get("box", 1) is None:
        del data["parts"][1]["box"]
    said = refused(data)
    assert said.startswith("a.kilter.json: part 'C2': "), said
    assert message in said


TOP = [
    ({"kilter": 2}, "the file version (key 'kilter') is 2; this program reads version 1"),
    ({"kilter": True}, "the file version (key 'kilter') is True"),
    ({"kilter": "1"}, "the file version (key 'kilter') is '1'"),
    ({"unit": "mm"}, "unknown key 'unit'; did you mean 'units'?"),
    ({"units": "ft"}, "units is \"ft\"; use 'm', 'cm', 'mm' or 'in'"),
    ({"gravity": [0, 0, 0]}, "gravity is [0.0, 0.0, 0.0]; give a vector that is not zero"),
    ({"gravity": -9.81}, "gravity is -9.81; give a list"),
    ({"friction": -1}, "friction is -1; give a number of at least 0"),
    ({"planar": "no"}, 'planar is "no"; give true or false'),
    ({"planar": True, "gravity": [0, 1, 0]}, "gravity leaves the x-z plane"),
    ({"parts": []}, "parts has 0 entries; give 1 or more"),
    ({"parts": {}}, "parts is an object; give a list"),
    ({"parts": [5]}, "parts[0] is 5; give an object"),
    ({"parts": [{"box": [1, 1, 1]}]}, "parts[0].name is missing; add the key 'name'"),
    ({"parts": [{"name": "", "box": [1, 1, 1]}]}, "parts[0].name is \"\"; give a text"),
    ({"parts": [{"name": 5, "box": [1, 1, 1]}]}, "parts[0].name is 5; give a text"),
    ({"parts": [{"nme": "a", "box": [1, 1, 1]}]}, "unknown key 'parts[0].nme' (and 1 more faults); did"),
    ({"parts": [{"name": "a", "box": [1, 1, 1]}] * 2}, "two parts are named 'a'; give each"),
    ({"parts": [{"name": "ground", "box": [1, 1, 1]}]}, "the name 'ground' is reserved for the world in joints and straps; give another"),
    ({"friction_pairs": [{"parts": ["C1"], "mu": 1}]}, "friction_pairs[0].parts has 1 entries; give 2"),
    ({"friction_pairs": [{"parts": ["C1", "C3"], "mu": 1}]}, "no part is named 'C3'; there are: 'C1', 'C2'"),
    ({"friction_pairs": [{"parts": ["C1", "C2"]}]}, "friction_pairs[0].mu is missing; add the key"),
    ({"loads": [{"part": "C9"}]}, "no part is named 'C9'; there are: 'C1', 'C2'"),
    ({"loads": [{"part": "C1", "frce": [0, 0, 1]}]}, "unknown key 'loads[0].frce'; did you mean 'force'"),
    ({"contacts": [{"parts": ["C1", "C2"], "points": [[0, 0, 0]], "normal": [0, 0, 0]}]},
     "contacts[0]: normal of a contact is [0.0, 0.0, 0.0]; give three finite numbers"),
    ({"joints": [{"parts": ["C1", "C2"], "kind": "revolute", "axis": [0, 0, 1]}]},
     "joints[0]: revolute joint of 'C1' and 'C2' has no point; give \"point\", a point on"),
    ({"joints": [{"parts": ["C1", "C2"], "kind": "prismatic"}]},
     "joints[0]: prismatic joint of 'C1' and 'C2' has no axis; give \"axis\""),
    ({"joints": [{"parts": ["C1", "C2"], "kind": "glue"}]},
     "joints[0].kind is \"glue\"; use 'fixed', 'revolute'"),
    ({"joints": [{"parts": ["C1", "C1"], "kind": "fixed"}]}, "a joint names ['C1', 'C1']; name two"),
    ({"joints": [{"parts": ["C1", "C2"], "kind": "fixed", "axis": [0, 0, 0]}]}, "joints[0]: axis of"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "message"), TOP)
def test_a_fault_of_the_file_names_the_place(change, message):
    assert message in refused({**copy.deepcopy(BASE), **change})


FACE = {"kind": "face", "curvature": 1.0}
FEATURE = [
    ([FACE], "feature has 1 entries"),
    ([FACE, None], "feature[1] is null"),
    ([{"kind": "edge", "curvature": 1}, FACE], "the direction of the feature 'edge' is missing"),
    (
        [{"kind": "face", "curvature": [0, 1]}, FACE],
        "the direction of the feature 'face' is missing",
    ),
    ([{"kind": "face", "radius": 2}, FACE], "feature[0].radius'; give its curvature, 1 / radius"),
    ([{"kind": "face", "curvature": "round"}, FACE], 'feature[0].curvature is "round"; give a num'),
    ([{**FACE, "along": [1, 0, 0], "curvature": [0, 1, 2]}, FACE], "curvature is a list; give a n"),
    ([{"kind": "vertex", "curvature": 1}, FACE], "a vertex cannot have a curvature or a direction"),
    ([{**FACE, "axis": [0, 0, 1]}, FACE], "has only one of point and axis"),
    ([{**FACE, "along": [0, 0, 1]}, FACE], "is not perpendicular to the normal"),
]


@pytest.mark.parametrize(("feature", "message"), FEATURE)
def test_a_fault_of_a_feature_is_one_sentence(feature, message):
    contact = {"parts": ["C1", "C2"], "points": [[0, 0, 0]], "normal": [0, 0, 1]}
    said = refused({**copy.deepcopy(BASE), "contacts": [{**contact, "feature": feature}]})
    assert message in said
    assert "more faults" not in said


@pytest.mark.parametrize("data", [[], 5, None, "text", {}, {"kilte": 1}, {"parts": []}])
def test_what_is_no_kilter_file(data):
    said = refused(data)
    assert "not a JSON object" in said or "key 'kilter' is missing" in said


def test_a_mesh_file_of_a_part_that_is_damaged(write):
    write("c.obj", "o tip\nv 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n")
    path = write("a.json", {"kilter": 1, "parts": [{"name": "C1", "mesh": "c.obj"}]})
    with pytest.raises(
        InputError,
        match=r"a\.json: part 'C1': mesh 'c\.obj': object 'tip': line 4: vertex 3 is \[nan",
    ):
        load(path)


TEXT = [
    (b'{"kilter": 1,\n "parts": [}', "not JSON: Expecting value at line 2, column 12; correct"),
    (b"", "the file is empty; give a file with contents"),
    (b" \n", "the file is empty"),
    (b'{"kilter": 1, "parts": "\xff"}', "not UTF-8 at byte 24; save it as UTF-8"),
    ('{"kilter": 1}'.encode("utf-16"), "not UTF-8 at byte 0"),
    (b'{"kilter": 1, "kilter": 1}', "duplicate key 'kilter' in an object; keep a single value"),
    (b'{"kilter": 1, "parts": [{"name": "C1", "box": [1,1,NaN]}]}', "part 'C1': box[2] is NaN; give"),
    (b'{"kilter": 1, "parts": [{"name": "C1", "box": [1,1,1e999]}]}', "box[2] is Infinity; give"),
    (b'{"kilter": 1, "parts": [{"name": "C1", "mass": -Infinity}]}', "mass is -Infinity"),
    (b'{"kilter": ' + b"[" * 200_000, "nested too deeply; flatten them"),
    (b'{"kilter": ' + b"1" * 5000 + b"}", "not a number: "),
    (b'{"kilter": 1, "parts": [{"name": "\\ud800", "box": [1,1,1]}]}', "half of a surrogate"),
    (b'{"kilter": 1} x', "not JSON: Extra data at line 1, column 15"),
    (b'{"nodes": []}', "the key 'kilter' is missing: this is not a kilter file; begin with"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), TEXT, ids=range(len(TEXT)))
def test_a_fault_of_the_text(text, message, write):
    path = write("a.kilter.json", text)
    with pytest.raises(InputError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert caught.value.hint


json_value = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["name", "mesh", "box", "vertices", "x"]), inner, max_size=4
        )
    ),
    max_leaves=12,
)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(
    st.sampled_from(["parts", "loads", "contacts", "joints", "gravity", "units", "friction_pairs"])
    | st.sampled_from(["mesh", "box", "cylinder", "pose", "polygon", "name", "mass"]),
    json_value,
)
def test_no_value_anywhere_gives_another_exception(key, value):
    data = copy.deepcopy(BASE)
    target = (
        data
        if key in ("parts", "loads", "contacts", "joints", "gravity", "units", "friction_pairs")
        else data["parts"][0]
    )
    target[key] = value
    message = "a.json: "
    with contextlib.suppress(InputError):
        try:
            from_dict(data, folder=".", source="a.json")
        except InputError as error:
            message = str(error)
            raise
    assert message.startswith("a.json: ")
