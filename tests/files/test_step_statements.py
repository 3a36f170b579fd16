"""Statements of a STEP file: materials, layers, its accuracy; faces on the wrong side."""

import pytest

pytest.importorskip("OCP")


from pathlib import Path

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS, TopoDS_Shape
from step_maker import placement, write_step

import kilter
from kilter import Box, Part
from kilter.analysis.check import check
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.cad import checked_solid as checking
from kilter.files.cad.checked_solid import checked_solid, has_doubled_faces
from kilter.files.cad.step_document import step_bodies
from kilter.files.cad.step_faces import _area, with_other_sides
from kilter.files.cad.step_solids import read_solid
from kilter.files.cad.step_statements import stated_accuracy, text_statements
from kilter.files.cad.step_surfaces import inside
from kilter.files.file_tolerances import DOUBLED
from kilter.files.formats import assembly_of
from kilter.files.own.kilter_json import from_dict, to_dict
from kilter.loading import load
from kilter.rigid import Pose, quaternion_to_matrix
from kilter.scenes.pieces import turn
from kilter.shape.solid import Solid, Surface
from kilter.show.colours import assembly_colours
from sampled import sampled

GRAM = "( MASS_UNIT() NAMED_UNIT(*) SI_UNIT($,.GRAM.) )"
KILOGRAM = "(MASS_UNIT()NAMED_UNIT(*)SI_UNIT(.KILO.,.GRAM.))"
METRE = "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))"
MILLIMETRE = "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))"
INCH = "(CONVERSION_BASED_UNIT('INCH',#95)LENGTH_UNIT()NAMED_UNIT(#96))"
POUND = "(CONVERSION_BASED_UNIT('POUND',#93)MASS_UNIT()NAMED_UNIT(#96))"
SHAPES = """
#1=PRODUCT_DEFINITION('design','',#70,#71);
#2=PRODUCT_DEFINITION_SHAPE('','',#1);
#3=SHAPE_DEFINITION_REPRESENTATION(#2,#4);
#4=SHAPE_REPRESENTATION('',(#72),#73);
#5=SHAPE_REPRESENTATION_RELATIONSHIP('','',#4,#6);
#6=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#7,#72),#73);
#7=MANIFOLD_SOLID_BREP('body; one',#74);
"""
PROPERTY = """
#10=PROPERTY_DEFINITION('material property','density of part',#1);
#11=PROPERTY_DEFINITION_REPRESENTATION(#10,#12);
"""
DESIGNATION = """
#10=MATERIAL_DESIGNATION('Steel',(#2));
#13=MATERIAL_DESIGNATION_CHARACTERIZATION('','',#10,#11);
#14=MATERIAL_PROPERTY('density','',#10);
#11=MATERIAL_PROPERTY_REPRESENTATION(#14,#12,#15);
"""
MEASURE = "#20=MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE({value}),#90);"
COMPLEX = (
    "#20=(MEASURE_REPRESENTATION_ITEM()MEASURE_WITH_UNIT(NUMERIC_MEASURE({value}),#90)"
    "QUALIFIED_REPRESENTATION_ITEM((#74))REPRESENTATION_ITEM('density'));"
)


def step_text(mass, length, value, *, owner=PROPERTY, measure=MEASURE, powers=("1.", "-3.")):
    units = f"""
#12=REPRESENTATION('density',(#20),#73);
{measure.format(value=value)}
#90=DERIVED_UNIT((#91,#92));
#91=DERIVED_UNIT_ELEMENT(#94,{powers[0]});
#92=DERIVED_UNIT_ELEMENT(#97,{powers[1]});
#94={mass};
#97={length};
#95=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#98);
#98={MILLIMETRE};
#93=MASS_MEASURE_WITH_UNIT(MASS_MEASURE(0.45359237),#99);
#99={KILOGRAM};
"""
    return SHAPES + owner + units


def densities_of(tmp_path: Path, text: str) -> list[float]:
    path = tmp_path / "part.step"
    path.write_text(text)
    stated = text_statements(path).values()
    return [one.density for one in stated if one.density is not None]


@pytest.mark.parametrize(
    ("mass", "length", "value", "density"),
    [
        (KILOGRAM, METRE, "7850.", 7850.0),
        (GRAM, MILLIMETRE, "7.85E-3", 7850.0),
        (KILOGRAM, INCH, "0.1", 0.1 / 0.0254**3),
        (POUND, INCH, "0.284", 0.284 * 0.45359237 / 0.0254**3),
    ],
)
def test_a_density_is_read_in_its_unit(tmp_path, mass, length, value, density):
    for owner in (PROPERTY, DESIGNATION):
        for measure in (MEASURE, COMPLEX):
            text = step_text(mass, length, value, owner=owner, measure=measure)
            assert densities_of(tmp_path, text) == pytest.approx([density], rel=1e-12)


def test_a_measure_of_another_kind_or_sign_is_no_density(tmp_path):
    assert densities_of(tmp_path, step_text(KILOGRAM, METRE, "7850.", powers=("1.", "-2."))) == []
    assert densities_of(tmp_path, step_text(KILOGRAM, METRE, "-7850.")) == []
    assert densities_of(tmp_path, step_text(KILOGRAM, METRE, "0.")) == []
    assert densities_of(tmp_path, step_text(KILOGRAM, "(LENGTH_UNIT())", "7850.")) == []


def cubes() -> list:
    base = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(10, 10, 10)).Solid()
    top = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 10), gp_Pnt(5, 5, 20)).Solid()
    return [("product", [("base", base, None), ("top", top, None)], None)]


def test_densities_and_colours_of_a_step_file_are_those_of_its_parts(tmp_path):
    path = write_step(
        tmp_path / "cubes.step",
        cubes(),
        colors={"base": (1, 0, 0), "top": (0, 0, 1)},
        densities={"top": 8.4},
    )
    base, top = assembly_of(step_bodies(path, (), lambda stage, key: None)).parts
    assert (base.density, base.color) == (None, "#ff0000")
    assert (top.density, top.color) == (pytest.approx(8400.0), "#0000ff")
    assert top.mass == pytest.approx(8400 * 0.005**2 * 0.01)


@pytest.mark.slow
def test_the_option_density_replaces_the_densities_of_a_step_file(tmp_path):
    path = write_step(tmp_path / "cubes.step", cubes(), densities={"top": 8.4})
    assert [part.density for part in kilter.load(path).parts] == [None, pytest.approx(8400.0)]
    base, top = kilter.load(path, density=500).parts
    assert base.density == top.density == 500
    verdict = kilter.check(kilter.load(path, ground="base"))
    assert verdict.to_dict()["density"]["given"] == pytest.approx([8400.0, 8400.0])


def test_parts_are_drawn_in_the_colours_that_they_state():
    red, blue = (
        Part(name, Box([1, 1, 1]), [k, 0, 0], color=color)
        for k, (name, color) in enumerate([("a", "#ff0000"), ("b", "#0000ff")])
    )
    assembly = kilter.Assembly([red, blue])
    # pure colours would hide arrows and edges, so pictures soften them
    assert assembly_colours(assembly, [0, 0]).tolist() == [[224, 95, 95], [95, 95, 224]]
    assert from_dict(to_dict(assembly)) == assembly
    # a colour that all parts share tells none of them apart
    grey = kilter.Assembly([Part(p.name, p.shape, p.pose, color="#888888") for p in (red, blue)])
    assert len(set(map(tuple, assembly_colours(grey, [0, 0]).tolist()))) == 2
    with pytest.raises(InputError, match=r"colour is 'red'; give .#rrggbb"):
        Part("a", Box([1, 1, 1]), color="red")


# materials, layers, hidden solids -----------------------------------------------------------------

NAMED = """
#10=PROPERTY_DEFINITION('material property','material name',#1);
#11=PROPERTY_DEFINITION_REPRESENTATION(#10,#12);
#12=REPRESENTATION('material name',(#13),#73);
#13=DESCRIPTIVE_REPRESENTATION_ITEM('{name}','of a table');
"""
MADE_FROM = """
#10=MAKE_FROM_USAGE_OPTION('material','make from','',#1,#11,1,'',#14);
#11=PRODUCT_DEFINITION('part definition','',#12,#71);
#12=PRODUCT_DEFINITION_FORMATION('','',#13);
#13=PRODUCT('AMS 5662','Inconel 718','',(#70));
"""
OTHER = """
#10=PROPERTY_DEFINITION('surface finish','',#1);
#11=PROPERTY_DEFINITION_REPRESENTATION(#10,#12);
#12=REPRESENTATION('finish',(#13),#73);
#13=DESCRIPTIVE_REPRESENTATION_ITEM('polished','');
#14=REPRESENTATION('material name',(),#73);
"""


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (NAMED.format(name="Steel"), "Steel"),
        (NAMED.format(name=r"Stahl \X2\00E40020FFFD\X0\ S\S\d"), "Stahl \u00e4 \ufffd S\u00e4"),
        (NAMED.format(name=r"10'' \X\B0 a\\b"), "10' \u00b0 a\\b"),
        (NAMED.format(name=""), "of a table"),
        ("#10=MATERIAL_DESIGNATION('EN AW-6060',(#2));", "EN AW-6060"),
        (MADE_FROM, "AMS 5662 Inconel 718"),
        (OTHER, None),
    ],
)
def test_the_name_of_a_material_is_read_in_each_form(text, name, tmp_path):
    path = tmp_path / "part.step"
    path.write_text(SHAPES + text)
    assert [one.material for one in text_statements(path).values()] == [name] * (name is not None)


LAYER = "#30=PRESENTATION_LAYER_ASSIGNMENT('walls','visible',({item}));"


@pytest.mark.parametrize(
    ("text", "layer", "hidden"),
    [
        (LAYER.format(item="#7"), "walls", False),
        (LAYER.format(item="#6"), "walls", False),
        (LAYER.format(item="#31") + "#31=STYLED_ITEM('',(#74),#7);", "walls", False),
        (LAYER.format(item="#7") + "#32=INVISIBILITY((#30));", "walls", True),
        ("#31=STYLED_ITEM('',(#74),#7);#32=INVISIBILITY((#31));", None, True),
        (LAYER.format(item="#74") + "#32=INVISIBILITY((#30));", None, False),
    ],
)
def test_layers_and_hidden_solids(text, layer, hidden, tmp_path):
    path = tmp_path / "part.step"
    path.write_text(SHAPES + text)
    stated = [(one.layer, one.hidden) for one in text_statements(path).values()]
    assert stated == ([(layer, hidden)] if layer or hidden else [])


def test_material_layer_and_visibility_of_a_file_of_occt(tmp_path):
    nodes = [
        (name, BRepPrimAPI_MakeBox(1.0 + k, 2.0, 3.0).Solid(), None)
        for k, name in enumerate("abcd")
    ]
    path = write_step(
        tmp_path / "file.step",
        [("all", nodes, None)],
        densities={"a": 7.85},
        layers={"a": "W\u00e4nde", "b": "off", "c": "on"},
        hidden_layers=["off"],
        hidden=["d"],
    )
    assembly = kilter.load(path)
    assert [part.material for part in assembly.parts] == ["material of a", None, None, None]
    assert [part.layer for part in assembly.parts] == ["W\u00e4nde", "off", "on", None]
    hidden = [note for note in assembly.notes if note.startswith("hidden in the file")]
    assert len(hidden) == 1
    assert "'b', 'd'" in hidden[0]
    assert "--without" in hidden[0]
    again = from_dict(to_dict(assembly))
    assert [part.material for part in again.parts] == [part.material for part in assembly.parts]
    assert [part.layer for part in again.parts] == [part.layer for part in assembly.parts]
    answer = kilter.check(kilter.load(path, ground="a")).to_dict()
    assert [part["material"] for part in answer["parts"]] == ["material of a", None, None, None]


def test_the_message_on_a_missing_density_names_the_material():
    free = [
        Part("light", Box([1, 1, 1]), [0, 0, 2], material="oak"),
        Part("heavy", Box([1, 1, 1]), [0, 0, 1], density=7850.0, material="steel"),
    ]
    table = Part("table", Box([3, 3, 1]), grounded=True, material="stone")
    warning = next(w for w in kilter.Assembly([table, *free]).geometry.warnings if "assumed" in w)
    assert "'light' (material 'oak')" in warning
    assert "steel" not in warning


@pytest.mark.parametrize("label", ["", 3])
def test_a_label_that_is_no_name_is_refused(label):
    with pytest.raises(InputError, match=r"part 'p': layer is .*; give a name"):
        Part("p", Box([1, 1, 1]), layer=label)  # type: ignore[arg-type]


DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if"
MILLI = "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))"
PLAIN = "( LENGTH_UNIT ( ) NAMED_UNIT ( * ) SI_UNIT ( $ , .METRE. ) )"
INCHES = "(CONVERSION_BASED_UNIT('INCH',#9)LENGTH_UNIT()NAMED_UNIT(#8))"


@pytest.mark.parametrize(("unit", "units", "factor"), [
    (MILLI, "mm", 1), (MILLI, "cm", 0.1), (PLAIN, "mm", 1000),
    (INCHES, "in", 1), (INCHES, "mm", 25.4),
    ("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MICRO.,.METRE.))", "mm", 1e-3),
    ("(CONVERSION_BASED_UNIT('cubit',#9)LENGTH_UNIT())", "mm", 0),
    ("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.HECTO.,.METRE.))", "mm", 0),
])  # fmt: skip
def test_it_is_read_in_its_unit(unit, units, factor, tmp_path):
    path = tmp_path / "a.step"
    measure = "#7={}(LENGTH_MEASURE({}),#5,'distance_accuracy_value','');\n"
    name = "UNCERTAINTY_MEASURE_WITH_UNIT"
    rows = [measure.format(name, number) for number in ("2.E-3", "1.E-002", "-1.", "x", "1.E400")]
    path.write_text(f"#5={unit};\n" + "".join(rows))
    assert stated_accuracy([path], units) == pytest.approx(0.01 * factor)
    assert stated_accuracy([tmp_path / "none.step"], units) == 0


def leaning(path: Path, beyond: float, accuracy: str) -> Assembly:
    """A cube whose centre of mass is `beyond` the edge of the block below it."""
    roots = [
        ("base", BRepPrimAPI_MakeBox(20.0, 20.0, 20.0).Shape(), None),
        ("cube", BRepPrimAPI_MakeBox(10.0, 10.0, 10.0).Shape(), placement([15 + beyond, 5, 20])),
    ]
    text = write_step(path, [("all", roots, None)]).read_text()
    assert "LENGTH_MEASURE(1.E-07)" in text
    path.write_text(text.replace("LENGTH_MEASURE(1.E-07)", f"LENGTH_MEASURE({accuracy})"))
    return load(path, ground="base")


@pytest.mark.quick(2)
@pytest.mark.parametrize(("beyond", "accuracy", "verdict"), [
    (-0.004, "1.E-07", "stable"),
    (-0.004, "0.01", "stable"),  # a stable nominal position is reported as stable
    (0.004, "1.E-07", "unstable"),
    (0.004, "0.01", "undecided"),
    (0.1, "0.01", "unstable"),
    (0.1, "100.", "undecided"),
    (1.0, "100.", "unstable"),  # whatever accuracy the file states
])  # fmt: skip
def test_what_it_explains_is_not_proved_unstable(beyond, accuracy, verdict, tmp_path):
    assembly = leaning(tmp_path / "a.step", beyond, accuracy)
    found = check(assembly)
    assert found.verdict == verdict
    assert ("coordinates are not accurate enough" in found.own_sentence) == (verdict == "undecided")
    written = to_dict(assembly)
    assert to_dict(from_dict(written)) == written
    assert check(from_dict(written)).verdict == verdict


def test_what_falls_falls(tmp_path):
    """A part without contacts falls, however coarse the stated accuracy is."""
    assembly = leaning(tmp_path / "a.step", 0.004, "0.01")
    base, cube = assembly.parts
    stray = Part("stray", cube.shape, Pose([100, 0, 0]))
    assert check(Assembly([base, cube, stray], units="mm")).verdict == "unstable"


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here")
def test_bolts_whose_heads_are_off_by_less_than_the_file_knows():
    assembly = load(DATA / "dm1-id-214.stp", floor=True)
    stated = [getattr(part.shape, "uncertainty", 0) for part in assembly.parts[:7]]
    assert stated == pytest.approx([0.01 / 25.4] * 7)
    found = check(assembly)
    assert found.verdict == "undecided"
    assert "0.000394 in" in found.own_sentence


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here")
def test_files_that_a_file_names_state_it_too():
    assembly = load(DATA / "s1-tu-203" / "s1-tu-203.stp")
    assert assembly.parts[0].shape.uncertainty == pytest.approx(0.000785973431)


RADIUS = 2.0
SPHERE = GeomAbs_SurfaceType.GeomAbs_Sphere


def cap(height: float, *, rest: bool) -> TopoDS_Shape:
    """The part of a sphere above `height`, or the rest of the sphere, as a face."""
    angle, axes = np.arcsin(height / RADIUS), gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    ends = (-np.pi / 2, angle) if rest else (angle, np.pi / 2)
    ball = BRepPrimAPI_MakeSphere(axes, RADIUS, *ends).Shape()
    faces = map(TopoDS.Face, inside(ball, TopAbs_ShapeEnum.TopAbs_FACE))
    return next(f for f in faces if BRepAdaptor_Surface(f).GetType() == SPHERE)


@pytest.mark.parametrize("height", [0.2, 0.9, 1.7])
def test_the_other_side_has_the_rest_of_the_area(height):
    whole, small = 4 * np.pi * RADIUS**2, 2 * np.pi * RADIUS * (RADIUS - height)
    other = with_other_sides(cap(height, rest=True))
    assert _area(cap(height, rest=True)) == pytest.approx(whole - small)
    assert _area(other) == pytest.approx(small)
    assert with_other_sides(cap(height, rest=False)) is None


def test_solids_without_such_faces_are_not_changed():
    assert with_other_sides(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape()) is None
    assert ball_of(RADIUS).volume == pytest.approx(4 / 3 * np.pi * RADIUS**3)


def ball_of(radius: float) -> Solid:
    ball = BRepPrimAPI_MakeSphere(radius).Shape()
    return read_solid(TopoDS.Solid(next(inside(ball, TopAbs_ShapeEnum.TopAbs_SOLID)))).solid


def two_hemispheres(angle: float, *, hollow: bool = True) -> Solid:
    """Half a sphere, and half of the same sphere turned by `angle` degrees with its faces inwards.

    They share the part 1 - angle / 180 of their area.
    """
    solid = ball_of(1.0)
    middles = solid.vertices[solid.triangles].mean(axis=1)
    half = solid.triangles[middles[:, 2] > 0]
    turned = solid.vertices @ quaternion_to_matrix(turn([1, 0, 0], angle)).T
    triangles = np.concatenate([half, half[:, ::-1] + len(turned)])
    on = np.repeat([0, 1], len(half))
    sphere = Surface("sphere", [0, 0, 0], radius=1.0)
    inner = Surface("sphere", [0, 0, 0], radius=1.0, hollow=hollow)
    return Solid(
        np.concatenate([solid.vertices, turned]), triangles, (sphere, inner), on,
        1.0, [0, 0, 0], np.eye(3), sagitta=solid.sagitta,
    )  # fmt: skip


@pytest.mark.parametrize("angle", sampled(3, [60.0, 80.0, 100.0, 5.0, 120.0, 175.0]))
def test_faces_on_each_other_are_recognised_by_the_shared_area(angle):
    assert has_doubled_faces(two_hemispheres(angle)) == (1 - angle / 180 > DOUBLED)


def test_faces_with_material_on_the_same_side_are_no_error():
    assert not has_doubled_faces(two_hemispheres(5.0, hollow=False))


def test_a_solid_with_doubled_faces_is_rejected(monkeypatch):
    ball = ball_of(1.0)
    assert checked_solid(ball) is ball
    monkeypatch.setattr(checking, "has_doubled_faces", lambda solid: True)
    with pytest.raises(InputError, match="lie on each other"):
        checked_solid(ball)


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here: ../shared/data")
def test_the_head_of_the_spaceship_has_the_mass_of_its_other_export():
    wrong = load(DATA / "s1-c5-214" / "s1-c5-214.stp")
    right = load(DATA / "s1-tu-203" / "s1-tu-203.stp")
    mass = dict(zip(wrong.names, wrong.geometry.mass, strict=True))
    known = dict(zip(right.names, right.geometry.mass, strict=True))
    assert mass["HEAD_FRONT"] == pytest.approx(known["headfront"], rel=1e-4)
    assert mass["HEAD_BACK"] == pytest.approx(known["headback"], rel=0.03)
    assert any("HEAD_BACK" in note and "other side" in note for note in wrong.notes)
