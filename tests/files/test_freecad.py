"""FreeCAD documents: parts, placements, links, held parts, joints, notes and rejected files."""

import json
import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP")

from freecad_maker import Maker, at, flag, link, links, numbers_of, place, prop, rigid, xlink
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from step_maker import compound, moved, placement, write_step

from kilter.analysis.check import check
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.cad import step_process
from kilter.loading import load

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "freecad"
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="needs the folder shared")
EYE = np.eye(4)
PYTHON = prop(
    "Proxy",
    "PropertyPythonObject",
    "<Python value='bnVsbA==' module='a2p_importedPart_class' class='Proxy_importPart'/>",
)


def box(x: float = 10, y: float = 10, z: float = 10) -> Any:
    return BRepPrimAPI_MakeBox(float(x), float(y), float(z)).Shape()


def body(maker: Maker, name: str, matrix: Any = EYE, *more: str, solid: Any = None) -> str:
    """A body whose pad is hidden inside it."""
    pad = maker.add("PartDesign::Pad", f"{name}Pad", maker.shape(solid or box(), EYE))
    group = links("Group", [pad]) + link("Tip", pad)
    return maker.add("PartDesign::Body", name, group, maker.shape(solid or box(), matrix), *more)


def centres(assembly: Assembly) -> dict[str, list[float]]:
    rows = assembly.geometry.center
    return {
        part.name: np.round(row, 9).tolist() for part, row in zip(assembly.parts, rows, strict=True)
    }


def joined(assembly: Assembly) -> list[tuple[str, tuple[str, str]]]:
    return [(joint.kind, joint.parts) for joint in assembly.joints]


def notes(assembly: Assembly) -> str:
    return "\n".join(assembly.notes)


# real documents ---------------------------------------------------------------------------------


@needs_data
def test_a_document_of_the_assembly_workbench():
    assembly = load(DATA / "slider" / "assembly.FCStd")
    assert assembly.names == ("base", "carriage", "stone")
    assert [part.grounded for part in assembly.parts] == [True, False, False]
    assert joined(assembly) == [
        ("prismatic", ("carriage", "base")),
        ("fixed", ("stone", "base")),
    ]
    assert assembly.units == "mm"
    assert not assembly.notes


@needs_data
def test_a_document_of_a2plus():
    assembly = load(DATA / "a2plus" / "standoff_with_bearing.FCStd")
    heights = [part.pose.position[2] for part in assembly.parts]
    assert heights == pytest.approx([0, 17, 25, 26, 16, 16.5, 25, 26], abs=1e-5)
    assert [part.grounded for part in assembly.parts] == [True] + 7 * [False]
    assert "7 do not count" in notes(assembly)


@needs_data
def test_a_document_whose_linked_document_is_absent():
    assembly = load(DATA / "missing_link" / "TestAssembly.FCStd")
    assert assembly.names == ("Body",)
    absent = [note for note in assembly.notes if "Beatcycle.FCStd' is absent: 'DownTube'" in note]
    assert len(absent) == 1
    assert "Distance 'Distance003'" in notes(assembly)
    assert "'Slider001'" in notes(assembly)


# the same solids as STEP ------------------------------------------------------------------------


class Scene:
    """A random stack, as a FreeCAD document and as the placed solids of a STEP file."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.rng = np.random.default_rng(seed)
        self.folder = folder
        self.maker, self.other = Maker(), Maker()
        self.solids: list[Any] = []
        self.held: list[int] = []
        self.height = 0.0
        self.members: list[str] = []
        self.grounded: list[str] = []

    def goal(self) -> tuple[Any, Any]:
        """The next block of the stack: its size, and its place."""
        size = self.rng.integers(4, 12, 3).astype(float)
        turn = np.pi / 2 * self.rng.integers(4)
        matrix = at(*self.rng.uniform(-1.5, 1.5, 2), self.height)
        matrix[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        centre = at(-size[0] / 2, -size[1] / 2)
        self.height += size[2]
        return size, matrix @ centre

    def solid(self, size: Any, matrix: Any, *, held: bool = False) -> None:
        """Add a solid of the STEP file."""
        w_last = numbers_of(matrix)
        x, y, z, w = w_last[3:]
        self.solids.append(moved(box(*size), placement(w_last[:3], (w, x, y, z))))
        if held:
            self.held.append(len(self.solids) - 1)

    def located(self) -> bool:
        return bool(self.rng.integers(2))

    def a2plus(self, count: int) -> None:
        container = rigid(self.rng)
        for k in range(count):
            size, goal = self.goal()
            held = k == 0
            matrix = np.linalg.inv(container) @ goal
            shape = self.maker.shape(box(*size), matrix, located=self.located())
            self.members.append(
                self.maker.add(
                    "Part::FeaturePython", f"b{k}", PYTHON, shape, flag("fixedPosition", held)
                )
            )
            self.solid(size, goal, held=held)
        self.maker.add("App::Part", "Part", links("Group", self.members), place(container))

    def assembly(self, count: int) -> None:
        whole = rigid(self.rng)
        for k in range(count):
            held = k == 0
            way = self.rng.choice(
                ["link", "outside", "array", "elements", "container", "scale", "body"]
            )
            name = getattr(self, f"_{way}")(k, np.linalg.inv(whole), held)
            self.members.append(name)
            if held:
                self.grounded.append(self.maker.held(f"held{k}", name))
        group = self.maker.add("Assembly::JointGroup", "Joints", links("Group", self.grounded))
        self.maker.add(
            "Assembly::AssemblyObject",
            "Assembly",
            links("Group", [group, *self.members]),
            place(whole),
        )

    def _body(self, k: int, up: Any, held: bool) -> str:
        size, goal = self.goal()
        self.solid(size, goal, held=held)
        return body(self.maker, f"body{k}", up @ goal, solid=box(*size))

    def _link(self, k: int, up: Any, held: bool) -> str:
        """A link to a hidden body, whose own placement counts or not."""
        size, goal = self.goal()
        self.solid(size, goal, held=held)
        own, counts = rigid(self.rng), bool(self.rng.integers(2))
        target = body(self.maker, f"source{k}", own, flag("Visibility", False), solid=box(*size))
        matrix = up @ goal @ (np.linalg.inv(own) if counts else EYE)
        return self.maker.add(
            "App::Link", f"link{k}", xlink("LinkedObject", target), place(matrix, "LinkPlacement"),
            flag("LinkTransform", counts),
        )  # fmt: skip

    def _outside(self, k: int, up: Any, held: bool) -> str:
        """A link to a body of another document."""
        size, goal = self.goal()
        self.solid(size, goal, held=held)
        target = body(self.other, f"outer{k}", rigid(self.rng), solid=box(*size))
        target_link = xlink("LinkedObject", target, "parts/other.FCStd")
        return self.maker.add("App::Link", f"link{k}", target_link, place(up @ goal))

    def _array(self, k: int, up: Any, held: bool) -> str:
        """An array of two equal blocks without objects for its elements."""
        size, goal = self.goal()
        own = rigid(self.rng)
        places = [goal, goal @ at(0, 0, size[2])]
        self.height += size[2]
        for matrix in places:
            self.solid(size, matrix, held=held)
        target = body(self.maker, f"source{k}", EYE, flag("Visibility", False), solid=box(*size))
        rows = [numbers_of(np.linalg.inv(own) @ up @ matrix) for matrix in places]
        return self.maker.add(
            "App::Link", f"array{k}", xlink("LinkedObject", target), place(own),
            prop("ElementCount", "PropertyInteger", "<Integer value='2'/>"),
            flag("ShowElement", False), self.maker.rows("PlacementList", "PlacementList", rows),
        )  # fmt: skip

    def _elements(self, k: int, up: Any, held: bool) -> str:
        """An array of two equal blocks with objects for its elements."""
        size, goal = self.goal()
        own = rigid(self.rng)
        places = [goal, goal @ at(0, 0, size[2])]
        self.height += size[2]
        target = body(self.maker, f"source{k}", EYE, flag("Visibility", False), solid=box(*size))
        names = []
        for i, matrix in enumerate(places):
            self.solid(size, matrix, held=held)
            step = place(np.linalg.inv(own) @ up @ matrix)
            element = self.maker.add(
                "App::LinkElement", f"e{k}_{i}", xlink("LinkedObject", target), step
            )
            names.append(element)
        return self.maker.add(
            "App::Link",
            f"array{k}",
            xlink("LinkedObject", target),
            place(own),
            links("ElementList", names),
        )

    def _container(self, k: int, up: Any, held: bool) -> str:
        """A part container in a group, with a Boolean whose inputs are in the container, too."""
        size, goal = self.goal()
        self.solid(size, goal, held=held)
        own, inner = rigid(self.rng), rigid(self.rng)
        tools = [
            self.maker.add("Part::Box", f"tool{k}{i}", self.maker.shape(box(), EYE)) for i in "ab"
        ]
        matrix = np.linalg.inv(own @ inner) @ up @ goal
        cut = self.maker.add(
            "Part::Cut", f"cut{k}", self.maker.shape(box(*size), matrix, located=self.located()),
            link("Base", tools[0]), link("Tool", tools[1]),
        )  # fmt: skip
        sketch = self.maker.add(
            "Sketcher::SketchObject", f"sketch{k}", self.maker.shape(box(), EYE)
        )
        group = self.maker.add(
            "App::DocumentObjectGroup", f"group{k}", links("Group", [cut, sketch, *tools])
        )
        deep = self.maker.add("App::Part", f"deep{k}", links("Group", [group]), place(inner))
        return self.maker.add("App::Part", f"part{k}", links("Group", [deep]), place(own))

    def _scale(self, k: int, up: Any, held: bool) -> str:
        """A link with a scale, alike in all directions or not."""
        size, goal = self.goal()
        self.solid(size, goal, held=held)
        factors = 2.0 ** self.rng.integers(-2, 3, 3) if self.rng.integers(2) else np.full(3, 2.0)
        target = body(
            self.maker, f"source{k}", EYE, flag("Visibility", False), solid=box(*(size / factors))
        )
        values = " ".join(f"value{a}='{f!r}'" for a, f in zip("XYZ", factors.tolist(), strict=True))
        scale = prop("ScaleVector", "PropertyVector", f"<PropertyVector {values}/>")
        target_link = xlink("LinkedObject", target)
        return self.maker.add("App::Link", f"scaled{k}", target_link, place(up @ goal), scale)

    def write(self) -> tuple[Path, Path]:
        (self.folder / "parts").mkdir()
        if self.other.objects:
            self.other.write(self.folder / "parts" / "other.FCStd")
        rows = [(f"solid{k}", solid, None) for k, solid in enumerate(self.solids)]
        step = write_step(self.folder / "same.step", rows)
        return self.maker.write(self.folder / "scene.FCStd"), step


@pytest.mark.quick(4)
@pytest.mark.parametrize("seed", range(60))
def test_a_document_has_the_parts_of_the_step_file_of_its_solids(seed, tmp_path):
    scene = Scene(seed, tmp_path)
    (scene.a2plus if seed % 3 == 0 else scene.assembly)(2 + seed % 4)
    document, step = scene.write()
    found, same = load(document), load(step)
    assert len(found) == len(same) == len(scene.solids)
    assert [k for k, part in enumerate(found.parts) if part.grounded] == scene.held
    assert found.geometry.volume == pytest.approx(same.geometry.volume, rel=1e-9)
    assert found.geometry.center == pytest.approx(same.geometry.center, abs=1e-7)
    expected = check(same.with_grounded([same.names[k] for k in scene.held]))
    assert check(found).verdict == expected.verdict


# joints -----------------------------------------------------------------------------------------


def two_blocks(maker: Maker, *joints: str, group: tuple[str, ...] = ()) -> None:
    """Two linked blocks in an assembly, the lower one held."""
    target = body(maker, "source", at(3, 4, 5), flag("Visibility", False))
    target_link = xlink("LinkedObject", target)
    maker.add("App::Link", "low", target_link, place(EYE))
    maker.add("App::Link", "high", target_link, place(at(20, 0, 10)))
    held = maker.held("held", "low")
    joint_group = maker.add("Assembly::JointGroup", "Joints", links("Group", [held, *joints]))
    members = links("Group", [joint_group, "low", held, "high", *joints, *group])
    maker.add("Assembly::AssemblyObject", "Assembly", members, place(at(0, 0, 100)))


X_UP = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
"""A frame whose z is x."""


@pytest.mark.parametrize(
    ("word", "kind", "axis"),
    [
        ("Fixed", "fixed", None),
        ("Revolute", "revolute", [1, 0, 0]),
        ("Cylindrical", "cylindrical", [1, 0, 0]),
        ("Slider", "prismatic", [1, 0, 0]),
        ("Ball", "spherical", None),
    ],
)
def test_a_joint_has_the_frame_of_its_first_part(word, kind, axis, tmp_path):
    maker = Maker()
    ends = [
        ("Assembly", ["high.sourcePad.Face5"], at(-10, 1, 2) @ X_UP),
        ("Assembly", ["low.sourcePad.Face5"], at(10, 1, 12) @ X_UP),
    ]
    two_blocks(maker, maker.joint(word, "joint", ends))
    assembly = load(maker.write(tmp_path / "a.FCStd"))
    assert assembly.names == ("low", "high")
    (joint,) = assembly.joints
    assert (joint.kind, joint.parts) == (kind, ("high", "low"))
    assert joint.point == pytest.approx([10, 1, 112])
    assert joint.axis is None if axis is None else joint.axis == pytest.approx(axis)
    assert not [note for note in assembly.notes if "joint" in note or "solved" in note]


@pytest.mark.parametrize(
    ("rows", "count"),
    [
        ([flag("Activated", False)], 0),
        ([flag("Suppressed", True)], 0),
        ([flag("Activated", True), flag("Suppressed", False)], 1),
        ([], 1),
    ],
)
def test_only_active_joints_count(rows, count, tmp_path):
    maker = Maker()
    ends = [("high", ["sourcePad.Face1"], EYE), ("low", ["sourcePad.Face1"], EYE)]
    two_blocks(maker, maker.joint("Fixed", "joint", ends, *rows))
    assert len(load(maker.write(tmp_path / "a.FCStd")).joints) == count


def test_other_joints_limits_and_unsolved_frames_are_notes(tmp_path):
    maker = Maker()
    ends = [("high", ["sourcePad.Face1"], EYE), ("low", ["sourcePad.Face1"], EYE)]
    limited = maker.joint("Slider", "short", ends, flag("EnableLengthMax", True))
    turning = maker.joint("Revolute", "turning", ends)
    parallel = maker.joint("Parallel", "faces", ends)
    absent = maker.joint("Ball", "absent", [("gone", ["x.Face1"], EYE), ends[1]])
    two_blocks(maker, limited, turning, parallel, absent)
    assembly = load(maker.write(tmp_path / "a.FCStd"))
    assert [kind for kind, _ in joined(assembly)] == ["prismatic", "revolute"]
    assert "do not count: Parallel 'faces'" in notes(assembly)
    assert "the limits of joints do not count: 'short'" in notes(assembly)
    assert "the two frames of 'turning' differ" in notes(assembly)
    assert "absent or unknown part do not count: 'absent'" in notes(assembly)


def test_a_face_tells_which_of_several_solids_is_joined(tmp_path):
    """The faces of the first box have the numbers 1 to 6."""
    maker = Maker()
    pair = compound([box(), moved(box(), placement((0, 0, 30)))])
    maker.add("Part::Compound", "pair", maker.shape(pair, at(50, 0, 0)))
    ends = {
        name: [("Assembly", [f"pair.{face}"], EYE), ("Assembly", ["low.sourcePad.Face1"], EYE)]
        for name, face in [("first", "Face6"), ("second", "Face7"), ("none", "Face13"), ("all", "")]
    }
    joints = [maker.joint("Fixed", name, rows) for name, rows in ends.items()]
    two_blocks(maker, *joints, group=("pair",))
    assembly = load(maker.write(tmp_path / "a.FCStd"))
    assert [parts for _, parts in joined(assembly)] == [("pair_1", "low"), ("pair_2", "low")]
    assert "do not count: 'none', 'all'" in notes(assembly)


def test_joints_and_held_parts_of_a_linked_assembly(tmp_path):
    """The joints of the inner assembly count where it is shown, its held part does not."""
    inner, outer = Maker(), Maker()
    ends = [("high", ["sourcePad.Face1"], EYE), ("low", ["sourcePad.Face1"], EYE)]
    two_blocks(inner, inner.joint("Fixed", "joint", ends))
    inner.write(tmp_path / "inner.FCStd")
    shown = xlink("LinkedObject", "Assembly", "inner.FCStd")
    outer.add("App::Link", "left", shown, place(EYE))
    outer.add("App::Link", "right", shown, place(at(100)))
    ends = [
        ("Assembly", ["left.high.sourcePad.Face1"], EYE),
        ("Assembly", ["right.low.sourcePad.Face1"], EYE),
    ]
    across = outer.joint("Slider", "across", ends)
    held = outer.held("held", "right")
    group = outer.add("Assembly::JointGroup", "Joints", links("Group", [held, across]))
    outer.add("Assembly::AssemblyObject", "Assembly", links("Group", [group, "left", "right"]))
    assembly = load(outer.write(tmp_path / "outer.FCStd"))
    assert assembly.names == ("left/low", "left/high", "right/low", "right/high")
    assert [part.grounded for part in assembly.parts] == [False, False, True, True]
    assert sorted(joined(assembly)) == [
        ("fixed", ("left/high", "left/low")),
        ("fixed", ("right/high", "right/low")),
        ("prismatic", ("left/high", "right/low")),
    ]


# the tree ---------------------------------------------------------------------------------------


def test_labels_are_names_and_hidden_parts_have_a_note(tmp_path):
    maker = Maker()
    for name, x, shown in [("a", 0, True), ("b", 20, False), ("c", 40, True)]:
        maker.add(
            "Part::Box",
            name,
            maker.shape(box(), at(x)),
            flag("Visibility", shown),
            label=f"<{name}>",
        )
    inner = maker.add("Part::Box", "d", maker.shape(box(), at(60)))
    maker.add("App::Part", "group", links("Group", [inner]), label="hidden in view")
    assembly = load(maker.write(tmp_path / "a.FCStd", hidden_in_view=["group", "c"]))
    assert assembly.names == ("<a>", "<b>", "<c>", "d")
    assert "hidden in the file: '<b>', 'd'" in notes(assembly)
    left = load(tmp_path / "a.FCStd", without=["<b>"])
    assert left.names == ("<a>", "<c>", "d")
    all_hidden = load(tmp_path / "a.FCStd", without=["<a>", "<c>"])
    assert all_hidden.names == ("<b>", "d")
    assert "hidden in the file" not in notes(all_hidden)  # it says nothing about variants


def test_inputs_of_shapes_are_no_parts(tmp_path):
    maker = Maker()
    for k in range(4):
        maker.add("Part::Box", f"box{k}", maker.shape(box(), at(20 * k)), flag("Visibility", k > 1))
    whole = maker.shape(box(), EYE)
    maker.add("Part::MultiFuse", "fuse", whole, links("Shapes", ["box0", "box1"]))
    attached = prop(
        "AttachmentSupport", "PropertyLinkSubList", "<LinkSubList><Link obj='box3'/></LinkSubList>"
    )
    maker.add("Part::Box", "attached", maker.shape(box(), at(0, 40)), attached)
    maker.add(
        "Part::FeaturePython", "clone", maker.shape(box(), at(0, 80)), links("Objects", ["box2"])
    )
    maker.add("Part::Mirroring", "copy", maker.shape(box(), at(0, 60)), link("Source", "box3"))
    names = load(maker.write(tmp_path / "a.FCStd")).names
    assert names == ("box2", "box3", "fuse", "attached", "clone", "copy")


def test_the_visible_source_of_a_link_is_a_part_without_an_assembly(tmp_path):
    for assembled in (False, True):
        maker = Maker()
        target_link = xlink("LinkedObject", body(maker, "source"))
        maker.add("App::Link", "copy", target_link, place(at(30)))
        if assembled:
            maker.add("Assembly::AssemblyObject", "Assembly", links("Group", ["copy"]))
        assembly = load(maker.write(tmp_path / "a.FCStd"))
        assert assembly.names == (("copy",) if assembled else ("source", "copy"))
        assert (
            "shown only by links, so no parts themselves: 'source'" in notes(assembly)
        ) == assembled


def test_a_body_without_a_shape_has_that_of_its_tip(tmp_path):
    maker = Maker()
    pad = maker.add("PartDesign::Pad", "pad", maker.shape(box(), at(1)))
    maker.files["empty.brp"] = b""
    empty = prop("Shape", "PropertyPartShape", "<Part file='empty.brp'/>")
    maker.add(
        "PartDesign::Body", "body", links("Group", [pad]), link("Tip", pad), empty, place(at(0, 2))
    )
    assert centres(load(maker.write(tmp_path / "a.FCStd"))) == {"body": [6, 7, 5]}


def test_a_location_in_the_shape_counts_once(tmp_path):
    for located in (True, False):
        maker = Maker()
        maker.add("Part::Box", "b", maker.shape(box(), at(7, 8, 9), located=located))
        assert centres(load(maker.write(tmp_path / "a.FCStd"))) == {"b": [12, 13, 14]}


def test_a_link_may_name_an_object_inside_its_target(tmp_path):
    maker = Maker()
    inner = body(maker, "inner", at(5))
    maker.add("App::Part", "whole", links("Group", [inner]), flag("Visibility", False))
    named = prop("LinkedObject", "PropertyXLink", "<XLink file='' name='whole' sub='inner.'/>")
    maker.add("App::Link", "shown", named, place(at(100)), flag("LinkTransform", True))
    assert centres(load(maker.write(tmp_path / "a.FCStd"))) == {"shown": [110, 5, 5]}


@pytest.mark.parametrize(
    ("words", "density"),
    [("7900 kg/m^3", 7900), ("2.7 g/cm^3", 2700), ("7.9e-06 kg/mm^3", 7900), ("much", None)],
)
def test_material_and_density_of_a_container(words, density, tmp_path):
    maker = Maker()
    rows = f"<Item key='Name' value='Alloy'/><Item key='Density' value='{words}'/>"
    card = prop("Material", "PropertyMap", f"<Map count='2'>{rows}</Map>")
    maker.add("App::MaterialObject", "card", card)
    inner = maker.add("Part::Box", "b", maker.shape(box(), EYE))
    maker.add("App::Part", "whole", links("Group", [inner]), link("Material", "card"))
    part = load(maker.write(tmp_path / "a.FCStd")).parts[0]
    assert (part.density, part.material) == (density, "Alloy")


def test_shells_wires_and_meshes_are_notes(tmp_path):
    maker = Maker()
    maker.add("Part::Box", "b", maker.shape(box(), EYE))
    faces = compound([BRepPrimAPI_MakeCylinder(1.0, 2.0).Face()])
    maker.add("Part::Feature", "sheet", maker.shape(faces, EYE))
    mesh = prop("Mesh", "PropertyMeshKernel", "<Mesh file='MeshKernel.bms'/>")
    maker.add("Mesh::Feature", "scan", mesh, place(EYE))
    assembly = load(maker.write(tmp_path / "a.FCStd"))
    assert assembly.names == ("b",)
    assert "meshes are left out: 'scan'" in notes(assembly)
    assert "not solids: 'sheet' (1 face)" in notes(assembly)


def test_a_body_of_a_document_is_a_part_of_a_kilter_file(tmp_path):
    maker = Maker()
    body(maker, "one", at(1))
    body(maker, "two", at(2), solid=box(1, 1, 1))
    maker.write(tmp_path / "a.FCStd")
    part = {"name": "A", "step": {"path": "a.FCStd", "name": "two"}, "grounded": True}
    content = {"kilter": 1, "units": "mm", "parts": [part]}
    (tmp_path / "a.kilter.json").write_text(json.dumps(content))
    assembly = load(tmp_path / "a.kilter.json")
    assert centres(assembly) == {"A": [2.5, 0.5, 0.5]}
    assert assembly.geometry.volume == pytest.approx([1.0])


def test_a_held_body_is_never_the_copy_that_is_left_out(tmp_path):
    maker = Maker()
    maker.add("Part::FeaturePython", "loose", PYTHON, maker.shape(box(), EYE))
    fixed = flag("fixedPosition", True)
    maker.add("Part::FeaturePython", "held", PYTHON, maker.shape(box(), EYE), fixed)
    assembly = load(maker.write(tmp_path / "a.FCStd"))
    assert assembly.names == ("held",)
    assert "left out: 'loose' (as 'held')" in notes(assembly)


# rejected files ---------------------------------------------------------------------------------


def refused(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        load(path)
    assert str(caught.value).startswith(str(path))
    return str(caught.value)


def test_documents_without_parts_say_why(tmp_path):
    maker, path = Maker(), tmp_path / "a.FCStd"
    maker.add("Sketcher::SketchObject", "sketch", maker.shape(box(), EYE))
    assert "no solid" in refused(maker.write(path))
    maker.add("App::Link", "gone", xlink("LinkedObject", "Body", "C:\\parts\\none.FCStd"))
    assert "'C:\\\\parts\\\\none.FCStd' is absent: 'gone' cannot be read" in refused(
        maker.write(path)
    )
    path.write_bytes(b"PK")
    assert "damaged" in refused(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.txt", "")
    assert "has no Document.xml" in refused(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("Document.xml", "<!DOCTYPE x><Document/>")
    assert "document type definition" in refused(path)


def test_a_linked_document_that_was_moved_is_found_beside_the_document(tmp_path):
    other, maker = Maker(), Maker()
    body(other, "Body")
    other.write(tmp_path / "stone.FCStd")
    maker.add(
        "App::Link", "stone", xlink("LinkedObject", "Body", "../../old/stone.FCStd"), place(EYE)
    )
    assert load(maker.write(tmp_path / "a.FCStd")).names == ("stone",)


@pytest.mark.slow
def test_small_documents_make_no_endless_tree(tmp_path):
    maker, path = Maker(), tmp_path / "a.FCStd"
    maker.add("App::Link", "a", xlink("LinkedObject", "b"))
    maker.add("App::Link", "b", xlink("LinkedObject", "a"))
    maker.add("App::Part", "top", links("Group", ["a"]))
    assert "nested deeper than 200" in refused(maker.write(path))
    maker = Maker()
    body(maker, "level0")
    for k in range(1, 9):
        names = [
            maker.add(
                "App::Link", f"link{k}{i}", xlink("LinkedObject", f"level{k - 1}"), place(EYE)
            )
            for i in range(8)
        ]
        maker.add("App::Part", f"level{k}", links("Group", names))
    assert "more than 50,000 objects and links" in refused(maker.write(path))
    maker = Maker()
    count = prop("ElementCount", "PropertyInteger", "<Integer value='2000000000'/>")
    maker.add("App::Link", "many", xlink("LinkedObject", body(maker, "b")), count)
    assert "more than 50,000 elements of an array" in refused(maker.write(path))


def whole_document(folder: Path) -> bytes:
    maker = Maker()
    ends = [("high", ["sourcePad.Face1"], EYE), ("low", ["sourcePad.Face1"], EYE)]
    two_blocks(maker, maker.joint("Fixed", "joint", ends))
    return maker.write(folder / "whole.FCStd").read_bytes()


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(20))
def test_damaged_documents_are_rejected_or_read_in_part(seed, tmp_path, monkeypatch):
    """Damage in the zip, in its XML and in its shapes: 200 documents."""
    monkeypatch.setattr(step_process, "STALLS", 1.0)
    rng = np.random.default_rng(seed)
    data = whole_document(tmp_path)
    with zipfile.ZipFile(tmp_path / "whole.FCStd") as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    for k in range(10):
        path = tmp_path / f"{k}.FCStd"
        name = str(rng.choice(list(files))) if k % 4 else ""
        content = bytearray(files[name] if name else data)
        for _ in range(int(rng.integers(1, 4))):
            start = int(rng.integers(len(content)))
            content[start : start + int(rng.integers(1, 9))] = rng.bytes(int(rng.integers(5)))
        if name:
            with zipfile.ZipFile(path, "w") as archive:
                for each, whole in files.items():
                    archive.writestr(each, bytes(content) if each == name else whole)
        else:
            path.write_bytes(bytes(content))
        try:
            load(path)
        except InputError as error:
            message = str(error)
        else:
            message = f"{path}: "
        assert message.startswith(f"{path}: ")


@pytest.mark.slow
def test_a_shape_that_stalls_occt_is_left_out(tmp_path, monkeypatch):
    """A count of a billion curves keeps OCCT busy."""
    monkeypatch.setattr(step_process, "STALLS", 1.0)
    maker = Maker()
    maker.add("Part::Box", "good", maker.shape(box(), EYE))
    maker.add("Part::Box", "bad", maker.shape(box(), at(20)))
    whole = maker.files["PartShape1.brp"]
    maker.files["PartShape1.brp"] = re.sub(rb"Curves \d+", b"Curves 1000000000", whole)
    assembly = load(maker.write(tmp_path / "a.FCStd"))
    assert assembly.names == ("good",)
    assert "damaged shapes are left out: 'bad'" in notes(assembly)
