"""Masses and friction of USD."""

import pytest

pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")


from pathlib import Path
from typing import Any

import numpy as np
from usd_maker import Stage

import kilter

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
