"""USD scenes: shapes, transforms, units, bodies, masses, friction, joints, instances, layers."""

import hashlib
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Box, Cylinder, InputError, Mesh, Sphere
from kilter.cli import main
from kilter.shape.primitives import surface

pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")
from usd_maker import Stage, faulty_room

CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "s.usda"


def test_exact_shapes_keep_their_faces_under_rotation_and_scale(path):
    stage = Stage(path)
    body = stage.body("a", (1, 2, 3), turn=(30, 40, 50), scale=(2, 2, 2))
    stage.shape(f"{body}/shape", "Cylinder", radius=0.5, height=3.0, axis="X")
    other = stage.body("b", (0, 0, 0), scale=(1, 2, 3))
    stage.shape(f"{other}/shape", "Cube", size=2.0)
    third = stage.body("c", (5, 0, 0), scale=(2, 2, 2))
    stage.shape(f"{third}/shape", "Sphere", radius=1.5)
    stage.save()
    a, b, c = kilter.load(path)
    assert isinstance(a.shape, Cylinder)
    assert (a.shape.radius, a.shape.height) == pytest.approx((1.0, 6.0), rel=1e-12)
    assert isinstance(b.shape, Box)
    assert b.shape.size == pytest.approx([2, 4, 6], rel=1e-12)
    assert isinstance(c.shape, Sphere)
    assert c.shape.radius == pytest.approx(3.0, rel=1e-12)
    # the axis of the cylinder is the x axis of the turned frame (rotations about x, y, z in turn)
    angle = np.radians([30, 40, 50])
    axis = [
        np.cos(angle[1]) * np.cos(angle[2]),
        np.cos(angle[1]) * np.sin(angle[2]),
        -np.sin(angle[1]),
    ]
    assert a.pose.matrix[:, 2] == pytest.approx(axis, abs=1e-7)


@pytest.mark.parametrize("kind", ["Sphere", "Cylinder", "Cube"])
def test_a_sheared_or_stretched_shape_becomes_a_mesh_of_the_right_volume(kind, path):
    """Volumes: 4/3 pi a b c, pi a b h, size^3 by the determinant; the triangles are inscribed."""
    stage = Stage(path)
    values = {"Sphere": {"radius": 1.0}, "Cylinder": {"radius": 1.0, "height": 2.0}}
    outer = stage.body("a", (0, 0, 0), scale=(1, 2, 3))
    inner = stage.shape(f"{outer}/x", kind, **values.get(kind, {"size": 1.0}))
    from pxr import Gf, UsdGeom

    UsdGeom.Xformable(inner).AddRotateXYZOp().Set(Gf.Vec3f(20, 30, 40))
    stage.save()
    (part,) = kilter.load(path)
    assert isinstance(part.shape, Mesh)
    exact = {"Sphere": 4 / 3 * np.pi, "Cylinder": 2 * np.pi, "Cube": 1.0}[kind] * 6
    assert part.mass / 1000 == pytest.approx(exact, rel=2e-2 if kind != "Cube" else 1e-6)


@pytest.mark.parametrize(("scale", "orientation"), [(1, "rightHanded"), (-1, "rightHanded")])
def test_a_mesh_keeps_its_outside_when_it_is_mirrored(scale, orientation, path):
    stage = Stage(path)
    body = stage.body("a", (0, 0, 0), scale=(scale, 1, 1))
    stage.mesh(f"{body}/m", CUBE, QUADS, orientation=orientation)
    stage.save()
    (part,) = kilter.load(path)
    corners = surface(part.shape)[0][surface(part.shape)[1]]
    volume = np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume == pytest.approx(1.0)
    assert part.pose.apply(surface(part.shape)[0])[:, 0].mean() == pytest.approx(0.5 * scale)


def test_left_handed_faces_are_turned(path):
    stage = Stage(path)
    body = stage.body("a", (0, 0, 0))
    stage.mesh(f"{body}/m", CUBE, [face[::-1] for face in QUADS], orientation="leftHanded")
    stage.save()
    assert kilter.load(path).geometry.warnings == ()


@pytest.mark.parametrize(
    ("metres", "units", "size"),
    [(1.0, "m", 2.0), (0.01, "cm", 2.0), (0.001, "mm", 2.0), (0.3048, "m", 0.6096)],
)
@pytest.mark.parametrize("up", ["Y", "Z"])
def test_units_and_up_axis(metres, units, size, up, path):
    stage = Stage(path, up=up, metres=metres)
    stage.box("a", (0, 0, 0), (2, 2, 2))
    stage.save()
    assembly = kilter.load(path)
    assert assembly.units == units
    assert isinstance(assembly["a"].shape, Box)
    assert assembly["a"].shape.size == pytest.approx([size] * 3, rel=1e-12)
    assert assembly["a"].mass == pytest.approx(1000 * (2 * metres) ** 3, rel=1e-9)
    assert assembly.gravity.tolist() == ([0, -9.81, 0] if up == "Y" else [0, 0, -9.81])


def test_gravity_of_a_physics_scene(path):
    from pxr import UsdPhysics

    stage = Stage(path, metres=0.01)
    stage.box("a", (0, 0, 0), (1, 1, 1))
    scene = UsdPhysics.Scene.Define(stage.stage, "/physics")
    scene.CreateGravityDirectionAttr((1, 0, 0))
    scene.CreateGravityMagnitudeAttr(162.0)
    stage.save()
    assert kilter.load(path).gravity == pytest.approx([1.62, 0, 0])


def test_bodies_colliders_and_decoration(path):
    stage = Stage(path)
    stage.box("floor", (0, 0, -0.5), (9, 9, 1), static=True)
    stage.box("lift", (3, 0, 0.5), (1, 1, 1), kinematic=True)
    body = stage.box("cup", (0, 0, 0.5), (1, 1, 1))
    stage.shape(f"{body}/handle", "Sphere", collider=False, radius=4.0)
    stage.body("lamp", (0, 0, 5), static=True)
    stage.shape("/World/lamp/bulb", "Sphere", collider=False, radius=0.1)
    vase = stage.body("vase", (-2, 0, 1))
    stage.shape(f"{vase}/look", "Sphere", collider=False, radius=1.0)
    stage.save()
    assembly = kilter.load(path)
    assert {p.name: (p.grounded, p.geometry) for p in assembly} == {
        "floor": (True, "collider"),
        "lift": (True, "collider"),
        "cup": (False, "collider"),
        "vase": (False, "visual"),
    }
    assert isinstance(assembly["cup"].shape, Box)
    assert any("1 ignored" in note for note in assembly.notes)
    report = kilter.scene(assembly)
    assert report.geometry == {"collider": 3, "visual": 1}
    assert report.at_rest


def test_guides_and_invisible_shapes_are_no_parts_unless_they_collide(path):
    stage = Stage(path)
    hull = stage.body("a", (0, 0, 0))
    stage.shape(f"{hull}/hull", "Cube", size=1.0, purpose="guide", visibility="invisible")
    stage.shape(f"{hull}/look", "Sphere", collider=False, radius=1.0)
    ghost = stage.body("b", (5, 0, 0))
    stage.shape(f"{ghost}/x", "Cube", collider=False, visibility="invisible")
    stage.save()
    (part,) = kilter.load(path)
    assert (part.name, part.geometry, type(part.shape)) == ("a", "collider", Box)


def test_a_stage_without_bodies_has_a_free_object_for_each_component(path):
    from pxr import Usd

    stage = Stage(path)
    for k in range(2):
        stage.body(f"chair_{k}", (3 * k, 0, 0), static=True)
        Usd.ModelAPI(stage.stage.GetPrimAtPath(f"/World/chair_{k}")).SetKind("component")
        stage.shape(f"/World/chair_{k}/seat", "Cube", collider=False, size=1.0)
        leg = stage.shape(f"/World/chair_{k}/leg", "Cube", collider=False, size=0.5)
        from pxr import UsdGeom

        UsdGeom.Xformable(leg).AddTranslateOp().Set((0, 0, -0.75))
    stage.shape("/World/ball", "Sphere", collider=False, radius=1.0)
    stage.save()
    assembly = kilter.load(path)
    assert assembly.names == ("chair_0", "chair_1", "ball")
    assert not assembly.geometry.grounded.any()
    assert assembly["chair_0"].mass == pytest.approx(1000 * (1 + 0.125))


def test_mass_density_and_centre(path):
    from pxr import UsdPhysics

    stage = Stage(path, metres=0.01)
    stage.box("heavy", (0, 0, 0), (10, 10, 10), mass=3.5)
    stage.box("dense", (50, 0, 0), (10, 10, 10), density=0.008)
    plain = stage.box("plain", (100, 0, 0), (10, 10, 10))
    values = UsdPhysics.MassAPI.Apply(stage.stage.GetPrimAtPath(plain))
    values.CreateCenterOfMassAttr((0, 0, -2))
    named = stage.box("named", (150, 0, 0), (10, 10, 10))
    stage.bind(named, stage.material("steel", density=0.0078))
    stage.save()
    assembly = kilter.load(path)
    masses = [part.mass for part in assembly]
    assert masses == pytest.approx([3.5, 8.0, 1.0, 7.8], rel=1e-6)
    assert assembly.geometry.center[2] == pytest.approx([100, 0, -2])


def test_friction_of_materials(path):
    """The mean of two materials; the only material; nothing."""
    stage = Stage(path)
    ice, wood = (
        stage.material("ice", staticFriction=0.1),
        stage.material("wood", staticFriction=0.5),
    )
    rubber = stage.material("rubber", dynamicFriction=0.9)
    floor = stage.box("floor", (0, 0, -0.5), (9, 9, 1), static=True)
    for k, material in enumerate((ice, wood, rubber, None)):
        body = stage.box(f"b{k}", (2 * k - 3, 0, 0.5), (1, 1, 1))
        if material is not None:
            stage.bind(body, material)
    stage.bind(floor, wood)
    stage.save()
    contacts = kilter.contacts(kilter.load(path))
    found = {p.parts[1]: p.mu for p in contacts}
    expected = {"b0": 0.3, "b1": 0.5, "b2": 0.7, "b3": 0.5}
    assert found == pytest.approx(expected, rel=1e-6)


def test_bare_pairs_have_the_friction_of_the_option(path):
    stage = Stage(path)
    stage.box("floor", (0, 0, -0.5), (9, 9, 1), static=True)
    stage.box("a", (0, 0, 0.5), (1, 1, 1))
    body = stage.box("b", (2, 0, 0.5), (1, 1, 1))
    stage.bind(body, stage.material("wood", staticFriction=0.5))
    stage.save()
    contacts = kilter.contacts(kilter.load(path, friction=0.2))
    assert {p.parts[1]: p.mu for p in contacts} == pytest.approx({"a": 0.2, "b": 0.5})


@pytest.mark.parametrize("kind", ["Fixed", "Revolute", "Prismatic", "Spherical"])
def test_joints(kind, path):
    from pxr import Gf, UsdPhysics

    stage = Stage(path)
    stage.box("base", (0, 0, 0.5), (1, 1, 1), kinematic=True)
    stage.box("arm", (2, 0, 0.5), (1, 1, 1), turn=(0, 0, 90))
    joint = getattr(UsdPhysics, f"{kind}Joint").Define(stage.stage, "/World/joint")
    joint.CreateBody0Rel().AddTarget("/World/arm")
    joint.CreateBody1Rel().AddTarget("/World/base")
    joint.CreateLocalPos0Attr(Gf.Vec3f(0, 1, 0.25))
    if kind in ("Revolute", "Prismatic"):
        joint.CreateAxisAttr("X")
    stage.save()
    (found,) = kilter.load(path).joints
    assert found.parts == ("arm", "base")
    assert found.kind == kind.lower()
    if kind in ("Revolute", "Spherical"):  # local (0, 1, .25) turned by 90 degrees about z
        assert found.point == pytest.approx([1, 0, 0.75], abs=1e-7)
    if kind in ("Revolute", "Prismatic"):
        assert abs(found.axis[1]) == pytest.approx(1.0)


def instanced(path: Path) -> None:
    """Two instances of a crate file, and three bricks of a point instancer."""
    from pxr import Gf, UsdGeom

    crate = Stage(path.with_name("crate.usda"))
    crate.shape("/World/shape", "Cube", size=1.0)
    crate.save()
    stage = Stage(path)
    stage.box("floor", (0, 0, -0.5), (40, 40, 1), static=True)
    for k in range(2):
        where = stage.body(f"crate_{k}", (3 * k, 0, 0.5 + 0.25 * k))
        prim = stage.stage.GetPrimAtPath(where)
        prim.GetReferences().AddReference("./crate.usda")
        prim.SetInstanceable(True)
    bricks = UsdGeom.PointInstancer.Define(stage.stage, "/World/bricks")
    proto = stage.box("bricks/brick", (0, 0, 0), (0.5, 0.25, 0.125), mass=0.5)
    bricks.CreatePrototypesRel().AddTarget(proto)
    bricks.CreateProtoIndicesAttr([0, 0, 0])
    bricks.CreatePositionsAttr([(0, 5, 0.0625), (2, 5, 0.0625), (4, 5, 1.0625)])
    bricks.CreateOrientationsAttr([Gf.Quath(1, 0, 0, 0)] * 3)
    stage.save()


def test_instances_are_objects(path):
    instanced(path)
    assembly = kilter.load(path)
    assert assembly.names == (
        "floor",
        "crate_0",
        "crate_1",
        "bricks_0",
        "bricks_1",
        "bricks_2",
    )
    assert [p.mass for p in assembly][1:] == pytest.approx([1000, 1000, 0.5, 0.5, 0.5])
    report = kilter.scene(assembly)
    assert {e.name: e.gap for e in report.faults} == pytest.approx(
        {"crate_1": 0.25, "bricks_2": 1.0}
    )


def settled(assembly: kilter.Assembly) -> kilter.Assembly:
    """The assembly after the falls that its scene report proposes."""
    report = kilter.scene(assembly)
    moves = {p.name: report[p.name].move for p in assembly}
    poses = {n: kilter.Pose(m.position, m.rotation) for n, m in moves.items() if m is not None}
    parts = [replace(p, pose=poses.get(p.name, p.pose)) for p in assembly]
    return replace(assembly, parts=parts)


@pytest.mark.parametrize("ending", [".usda", ".usdc", ".usd"])
def test_new_poses_are_a_layer_and_the_file_stays(ending, path):
    from kilter.files.usd.usd_assembly import write_usd_poses

    instanced(path)
    before = hashlib.sha256(path.read_bytes()).hexdigest()
    (path.parent / "out").mkdir()
    out = path.parent / "out" / f"rest{ending}"
    assembly = kilter.load(path)
    assert write_usd_poses(path, out, assembly, settled(assembly)) == 2
    assert hashlib.sha256(path.read_bytes()).hexdigest() == before
    again = kilter.load(out)
    assert kilter.scene(again).at_rest
    assert again.names == assembly.names
    assert [p.shape for p in again] == [p.shape for p in assembly]


def test_a_turned_object_in_scaled_and_turned_parents_lands_where_it_should(path):
    from pxr import Gf, UsdGeom

    from kilter.files.usd.usd_assembly import write_usd_poses

    stage = Stage(path, up="Y", metres=0.3048)
    outer = stage.body("group", (5, 6, 7), turn=(10, 20, 30), scale=(2, 2, 2), static=True)
    stage.shape(f"{outer}/a", "Cube", size=1.0, collider=False)
    stage.shape(f"{outer}/b", "Cube", size=9.0, collider=False)
    place = UsdGeom.Xformable(stage.stage.GetPrimAtPath(f"{outer}/a"))
    place.AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
    place.AddRotateXYZOp().Set(Gf.Vec3f(40, 50, 60))
    stage.save()
    assembly = kilter.load(path)
    target = kilter.Pose([0.1, 0.2, 0.3], [0.5, 0.5, -0.5, 0.5])
    moved = assembly.with_pose("a", target)
    write_usd_poses(path, path.with_name("o.usda"), assembly, moved)
    part = kilter.load(path.with_name("o.usda"))["a"]
    assert part.pose.position == pytest.approx(target.position, abs=1e-9)
    assert part.pose.matrix == pytest.approx(target.matrix, abs=1e-9)
    assert part.shape.size == pytest.approx(assembly["a"].shape.size)  # type: ignore[union-attr]


def test_a_prim_within_an_instance_cannot_be_moved(path):
    from kilter.files.usd.usd_assembly import write_usd_poses

    inner = Stage(path.with_name("pair.usda"))
    inner.box("a", (0, 0, 2), (1, 1, 1))
    inner.box("b", (3, 0, 2), (1, 1, 1))
    inner.save()
    stage = Stage(path)
    stage.box("floor", (0, 0, -0.5), (9, 9, 1), static=True)
    where = stage.body("pair", (0, 0, 0), static=True)
    prim = stage.stage.GetPrimAtPath(where)
    prim.GetReferences().AddReference("./pair.usda")
    prim.SetInstanceable(True)
    stage.save()
    assembly = kilter.load(path)
    assert set(assembly.names) == {"floor", "a", "b"}
    with pytest.raises(InputError, match="within an instance"):
        write_usd_poses(path, path.with_name("o.usda"), assembly, settled(assembly))


# errors ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("broken.usda", b'#usda 1.0\ndef Xform "a" {\n oops\n', r"the USD is invalid: .*oops"),
        ("other.usda", b"hello", "not a valid usda layer"),
        ("short.usdc", b"PXR-USDC" + b"\0" * 40, "too small"),
        ("zip.usdz", b"PK" + b"\0" * 40, "Failed to open"),
        ("empty.usda", b"#usda 1.0\n", "the stage is empty"),
        ("missing.usda", b'#usda 1.0\ndef "a" (references = @no.usda@) {\n}\n', "no.usda"),
    ],
)
def test_a_fault_of_a_file_is_one_sentence_on_one_line(name, data, words, tmp_path, capfd):
    (tmp_path / name).write_bytes(data)
    assert main(["scene", str(tmp_path / name), "--floor"]) == 2
    output = capfd.readouterr()
    assert output.out == ""
    assert len(output.err.strip().splitlines()) == 1
    with pytest.raises(InputError, match=words):
        kilter.load(tmp_path / name)


def test_faults_of_objects_name_the_object(path):
    stage = Stage(path)
    body = stage.body("odd", (0, 0, 0))
    stage.mesh(f"{body}/m", CUBE, [(0, 1, 99)])
    stage.save()
    with pytest.raises(InputError, match=r"odd.*inconsistent"):
        kilter.load(path)


@pytest.mark.slow
def test_without_usd_core_the_sentence_has_the_command(path):
    Stage(path).save()
    (path.parent / "pxr.py").write_text("raise ImportError")
    code = (
        f"import sys; sys.path.insert(0, {str(path.parent)!r})\n"
        "from kilter.cli import main\n"
        f"sys.exit(main(['check', {str(path)!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert 'pip install "kilter[usd]"' in done.stderr
    assert "Traceback" not in done.stderr


def test_other_units_are_rejected(path):
    stage = Stage(path)
    stage.box("a", (0, 0, 0), (1, 1, 1))
    stage.save()
    with pytest.raises(InputError, match="the stage is in m, but the units given are mm"):
        kilter.load(path, units="mm")


@pytest.mark.slow
def test_every_command_reads_usd(path, capsys):
    stage = Stage(path)
    stage.box("floor", (0, 0, -0.5), (9, 9, 1), static=True)
    stage.box("a", (0, 0, 0.5), (1, 1, 1))
    stage.save()
    for command in ("check", "contacts", "margin", "scene", "plan"):
        assert main([command, str(path), "--quiet"]) == 0, command
    assert "All" in capsys.readouterr().out or True


def test_a_changed_file_is_read_anew(path):
    stage = Stage(path)
    stage.box("a", (0, 0, 0), (1, 1, 1))
    stage.save()
    assert len(kilter.load(path)) == 1
    stage.box("b", (4, 0, 0), (1, 1, 1))
    stage.save()
    assert len(kilter.load(path)) == 2


# whole scenes ---------------------------------------------------------------------------------


def found_faults(path: Path, **how: Any) -> None:
    faults = faulty_room(path, **how)
    room = kilter.load(path)
    report = kilter.scene(room, assume="drawn")
    assert {entry.name: entry.gap for entry in report.faults} == pytest.approx(faults, rel=1e-6)
    others = [e for e in report if e.name not in faults and e.state != "held"]
    assert {entry.state for entry in others} == {"at-rest"}
    assert len(report.faults) == how["floating"] + how["overlapping"]
    # unasked, objects that float within their play come down by their gap
    settled = kilter.scene(room)
    remain = {entry.name for entry in settled.faults}
    for name in faults.keys() - remain:
        assert settled.moved[name] >= abs(faults[name]) - 1e-6, name  # 1e-5 of an object


@pytest.mark.slow
def test_a_small_room_with_two_faults(path):
    found_faults(path, count=12, floating=1, overlapping=1, seed=1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_all_faults_of_a_room_are_found_and_no_others(seed, path):
    found_faults(path, count=200, floating=5, overlapping=5, seed=seed)
