"""Masses, inertia and friction of USD and of other formats."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from usd_maker import Stage

import kilter
from kilter.cli import main

pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")

DIGITS = 2e-5
"""Relative accuracy of usd-core, which computes with float32."""


def state(prim: Any, rng: np.random.Generator) -> None:
    """State a random choice of values of the mass of a prim."""
    from pxr import Gf, UsdPhysics

    values = UsdPhysics.MassAPI.Apply(prim)
    if rng.random() < 0.5:
        values.CreateMassAttr(float(rng.uniform(1, 20)))
    if rng.random() < 0.5:
        values.CreateDensityAttr(float(rng.uniform(1, 20)))
    if rng.random() < 0.5:
        values.CreateCenterOfMassAttr(Gf.Vec3f(*rng.normal(size=3).tolist()))
    if rng.random() < 0.5:
        a, b, c = rng.uniform(0.1, 1, 3).tolist()
        values.CreateDiagonalInertiaAttr(Gf.Vec3f(b + c, a + c, a + b))
        turn = rng.normal(size=4)
        axes = (turn / np.linalg.norm(turn)).tolist()
        values.CreatePrincipalAxesAttr(Gf.Quatf(axes[0], *axes[1:]))


def random_body(path: Path, seed: int) -> tuple[Any, dict[str, Any]]:
    """A stage with a body of several boxes, and the boxes by the path of their prim."""
    rng = np.random.default_rng(seed)
    stage = Stage(path, metres=(1.0, 0.01)[seed % 2])
    body = stage.body("body", rng.normal(size=3), turn=rng.uniform(-90, 90, 3).tolist())
    state(stage.stage.GetPrimAtPath(body), rng)
    heavy = stage.material("heavy", density=5.0)
    boxes = {}
    for k in range(int(rng.integers(1, 5))):
        name = f"{body}/box{k}"
        shape = stage.shape(name, size=1.0)
        place, size = [3.0 * k, *rng.normal(size=2)], rng.uniform(0.5, 2)
        shape.AddTranslateOp().Set(tuple(place))
        shape.AddRotateZOp().Set(float(angle := rng.uniform(-90, 90)))
        shape.GetSizeAttr().Set(size)
        if rng.random() < 0.5:
            state(shape.GetPrim(), rng)
        if rng.random() < 0.5:
            stage.bind(name, heavy)
        boxes[name] = (place, angle, float(size))
    stage.save()
    return stage, boxes


def computed(stage: Any, boxes: dict[str, Any]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre and inertia of the body in its own frame, by usd-core."""
    from pxr import Gf, UsdPhysics

    body = UsdPhysics.RigidBodyAPI(stage.stage.GetPrimAtPath("/World/body"))

    def shape(prim: Any) -> Any:
        place, angle, size = boxes[str(prim.GetPath())]
        found = body.MassInformation()
        found.volume = size**3
        found.inertia = Gf.Matrix3f(size**5 / 6)
        found.centerOfMass = Gf.Vec3f(0)
        found.localPos = Gf.Vec3f(*place)
        found.localRot = Gf.Quatf(Gf.Rotation(Gf.Vec3d(0, 0, 1), angle).GetQuat())
        return found

    mass, moments, center, axes = body.ComputeMassProperties(shape)
    turn = np.array(Gf.Matrix3d(Gf.Quatd(axes))).T
    return mass, np.array(center), turn @ np.diag(moments) @ turn.T


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(40))
def test_bodies_have_the_mass_that_usd_computes(seed, tmp_path):
    """Masses, densities, centres and moments are stated at random, on the body and its boxes."""
    from pxr import UsdGeom

    path = tmp_path / "a.usda"
    stage, boxes = random_body(path, seed)
    mass, center, inertia = computed(stage, boxes)
    geometry, body = kilter.load(path).geometry, stage.stage.GetPrimAtPath("/World/body")
    frame = np.array(UsdGeom.Xformable(body).ComputeLocalToWorldTransform(0)).T
    own = frame[:3, :3].T @ geometry.inertia[0] @ frame[:3, :3]
    assert geometry.mass[0] == pytest.approx(mass, rel=DIGITS)
    assert np.allclose(geometry.center[0], (frame @ [*center, 1.0])[:3], atol=10 * DIGITS)
    assert np.allclose(own, inertia, rtol=0, atol=DIGITS * np.abs(inertia).max())


def test_an_inertia_that_no_body_has_is_replaced_by_that_of_the_shape(tmp_path):
    from pxr import Gf, UsdPhysics

    stage = Stage(tmp_path / "a.usda")
    body = stage.box("a", (0, 0, 0), (1, 1, 1), mass=6.0)
    values = UsdPhysics.MassAPI(stage.stage.GetPrimAtPath(body))
    values.CreateDiagonalInertiaAttr(Gf.Vec3f(1, 1, 3))
    stage.save()
    found = kilter.load(tmp_path / "a.usda")
    assert np.allclose(found.geometry.inertia[0], np.eye(3))
    assert len(found.notes) == 1
    assert found.notes[0].startswith(
        "no body has the inertia of 'a', so that of its shapes is used"
    )


pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")

RULES = [("average", lambda a, b: (a + b) / 2), ("min", min), ("multiply", lambda a, b: a * b),
         ("max", max)]  # fmt: skip


def random_materials(stage: Stage, rng: np.random.Generator) -> list[Any]:
    """Materials with a static or a dynamic coefficient, and with or without a combine mode."""
    from pxr import Sdf

    materials: list[Any] = [None]
    for k in range(5):
        key = "staticFriction" if rng.random() < 0.7 else "dynamicFriction"
        materials.append(stage.material(f"m{k}", **{key: float(rng.uniform(0.1, 1))}))
        if rng.random() < 0.7:
            attribute = (
                materials[-1]
                .GetPrim()
                .CreateAttribute("physxMaterial:frictionCombineMode", Sdf.ValueTypeNames.Token)
            )
            attribute.Set(str(rng.choice([mode for mode, _ in RULES])))
    return materials


def coefficient(stage: Stage, path: str) -> tuple[float, str] | None:
    """The friction and combine mode of the material to which a collider is bound directly."""
    relation = stage.stage.GetPrimAtPath(path).GetRelationship("material:binding:physics")
    targets = relation.GetTargets() if relation else []
    if not targets:
        return None
    material = stage.stage.GetPrimAtPath(targets[0])
    values = [material.GetAttribute(f"physics:{kind}Friction") for kind in ("static", "dynamic")]
    mu = next(value.Get() for value in values if value.HasAuthoredValue())
    mode = material.GetAttribute("physxMaterial:frictionCombineMode")
    return mu, (mode.Get() if mode else None) or "average"


def combined(stage: Stage, first: str, second: str) -> float:
    """The friction of two colliders by the rules of the schema and of PhysX."""
    pair = [found for path in (first, second) if (found := coefficient(stage, path)) is not None]
    if len(pair) < 2:
        return pair[0][0] if pair else 0.0
    names = [mode for mode, _ in RULES]
    rule = RULES[max(names.index(mode) for _, mode in pair)][1]
    return float(rule(pair[0][0], pair[1][0]))


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(40))
def test_each_pair_of_colliders_has_the_friction_of_the_rules(seed, tmp_path):
    """A bench of two feet and a board stands with each foot on a tile of its own."""
    from pxr import UsdGeom

    rng = np.random.default_rng(seed)
    stage = Stage(tmp_path / "a.usda")
    materials = random_materials(stage, rng)

    def add(path: str, place: Any, size: Any) -> None:
        shape = UsdGeom.Xformable(stage.shape(path, size=1.0))
        shape.AddTranslateOp().Set(place)
        shape.AddScaleOp(precision=UsdGeom.XformOp.PrecisionDouble).Set(size)
        material = materials[rng.integers(len(materials))]
        if material is not None:
            stage.bind(path, material)

    floor = stage.body("floor", (0, 0, 0), kinematic=True)
    bench = stage.body("bench", (0, 0, 0), mass=3.0)
    for k, x in enumerate((-2.0, 2.0)):
        add(f"{floor}/tile{k}", (x, 0, -0.5), (3.0, 3.0, 1.0))
        add(f"{bench}/foot{k}", (x, 0, 0.5), (1.0, 1.0, 1.0))
    add(f"{bench}/board", (0, 0, 1.25), (6.0, 1.0, 0.5))
    stage.save()
    contacts = kilter.contacts(kilter.load(tmp_path / "a.usda"))
    found = {int(x > 0): patch.mu for patch in contacts for x in patch.points[:, 0]}
    expected = {k: combined(stage, f"{floor}/tile{k}", f"{bench}/foot{k}") for k in range(2)}
    assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("named", ["foot0", ""], ids=["collider", "body"])
def test_a_filtered_collider_touches_nothing_and_the_others_do(named, tmp_path):
    from pxr import UsdGeom, UsdPhysics

    stage = Stage(tmp_path / "a.usda")
    floor = stage.box("floor", (0, 0, -0.5), (9, 9, 1), static=True)
    bench = stage.body("bench", (0, 0, 0), mass=3.0)
    for k, x in enumerate((-2.0, 2.0)):
        foot = UsdGeom.Xformable(stage.shape(f"{bench}/foot{k}", size=1.0))
        foot.AddTranslateOp().Set((x, 0, 0.5))
    filtered = stage.stage.GetPrimAtPath(f"{bench}/{named}".rstrip("/"))
    UsdPhysics.FilteredPairsAPI.Apply(filtered).CreateFilteredPairsRel().AddTarget(floor)
    stage.save()
    contacts = kilter.contacts(kilter.load(tmp_path / "a.usda"))
    sides = {int(x > 0) for patch in contacts for x in patch.points[:, 0]}
    assert sides == ({1} if named else set())


G = 9.81
FORMATS = ["kilter", "urdf", "usd"]


def written(
    folder: Path, kind: str, size: Any, at: Any, mass: float, moments: Any, mu: float = 0.0
) -> Path:
    """A box with principal moments about its middle, on the half space x, z < 0 that is held."""
    table, below = [4.0, 4.0, 1.0], [-2.0, 0.0, -0.5]
    if kind == "kilter":
        parts = [
            kilter.Part("table", kilter.Box(table), below, grounded=True),
            kilter.Part("body", kilter.Box(size), at, mass=mass, inertia=[*moments, 0, 0, 0]),
        ]
        path = folder / "a.kilter.json"
        kilter.dump(kilter.Assembly(parts, friction=mu), path)
        return path
    if kind == "urdf":
        six = dict(zip(("ixx", "iyy", "izz"), moments, strict=True))
        tensor = " ".join(f'{key}="{value:.17g}"' for key, value in six.items())
        inertial = f'<inertial><mass value="{mass}"/><inertia {tensor}/></inertial>'
        links = "".join(
            f'<link name="{name}">{inner}<collision><origin xyz="{place}"/><geometry>'
            f'<box size="{" ".join(map(str, box))}"/></geometry></collision></link>'
            for name, inner, place, box in (
                ("table", "", " ".join(map(str, below)), table),
                ("body", inertial, "0 0 0", size),
            )
        )
        joint = '<joint name="j" type="floating"><parent link="table"/><child link="body"/>'
        joint += f'<origin xyz="{" ".join(map(str, at))}"/></joint>'
        path = folder / "a.urdf"
        path.write_text(f"<robot>{links}{joint}</robot>")
        return path
    pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")
    from pxr import Gf, UsdPhysics
    from usd_maker import Stage

    path = folder / "a.usda"
    stage = Stage(path)
    stage.box("table", below, table, static=True)
    body = stage.box("body", at, size, mass=mass)
    values = UsdPhysics.MassAPI(stage.stage.GetPrimAtPath(body))
    # the axes of the moments are z, x, y of the body
    values.CreateDiagonalInertiaAttr(Gf.Vec3f(moments[2], moments[0], moments[1]))
    values.CreatePrincipalAxesAttr(Gf.Quatf(0.5, -0.5, -0.5, -0.5))
    stage.save()
    return path


@pytest.mark.slow
@pytest.mark.parametrize("kind", FORMATS)
def test_a_heavy_rim_does_not_turn_with_its_carrier(kind, tmp_path, capsys):
    """3 kg m2 need 24 N m at 8 rad/s2; mu m g r gives at most 8.3 with all weight at corners."""
    path = written(tmp_path, kind, [0.4, 0.4, 0.1], [-2, 0, 0.05], 10.0, [1.6, 1.6, 3.0])
    words = ["--turn-faster", "0", "0", "8", "--about", "-2", "0", "0", "--friction", "0.3"]
    assert main(["transport", str(path), *words, "--json"]) == 1
    case = json.loads(capsys.readouterr().out)["cases"][0]
    assert case["factor"] == pytest.approx(0.3 * 10 * G * 0.2 * np.sqrt(2) / 24, rel=1e-6)
    assert case["factor"] <= 0.35


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize(
    ("size", "beyond", "mass", "inertia", "expected"),
    [
        ([1.0, 1.0, 0.2], 0.2, 10.0, 0.05, 43.6),
        ([1.0, 1.0, 0.2], 0.2, 10.0, 5.0, 3.63),
        ([2.0, 0.25, 0.25], 0.45, 1.0, 1.0 + 0.25**2 / 6, 3.64),
    ],
    ids=["light-plate", "heavy-plate", "bar-with-heavy-ends"],
)
def test_a_body_tips_over_an_edge_as_its_inertia_states(
    kind, size, beyond, mass, inertia, expected, tmp_path
):
    """The acceleration is m g d / (I + m d^2), with the centre d beyond the edge."""
    moments = [0.9 * inertia, inertia, inertia]
    path = written(tmp_path, kind, size, [beyond, 0, size[2] / 2], mass, moments)
    verdict = kilter.check(kilter.load(path))
    row = verdict.assembly.index_of("body")
    found = verdict.motion.acceleration[row, 4]
    assert found == pytest.approx(mass * G * beyond / (inertia + mass * beyond**2), rel=1e-6)
    assert found == pytest.approx(expected, abs=0.05)
