"""Friction of USD colliders against a second reader, which knows only the rules of the schema."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter

pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")
from usd_maker import Stage

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
def test_each_pair_of_colliders_has_the_friction_of_the_rules(seed: int, tmp_path: Path) -> None:
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
def test_a_filtered_collider_touches_nothing_and_the_others_do(named: str, tmp_path: Path) -> None:
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
