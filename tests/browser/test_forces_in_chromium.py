"""Forces on the page: one per patch, in balance with the weights, hidden with their parts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, Cylinder, Part, Pose
from kilter.scenes import scene
from kilter.scenes.pieces import tube
from kilter.tell.palette import RAMP, rgb

pytestmark = pytest.mark.browser

BALANCED = [
    "tower",
    "wall",
    "arch",
    "arch-with-held-ends",
    "corner-wedges",
    "ladder",
    "bracket",
    "trough",
    "three-cylinders",
    "slope-with-friction",
    "laden-slab",
]
SHOWN = "window.kilter.shown"


@pytest.mark.parametrize("name", BALANCED)
def test_the_shown_forces_balance_every_weight(name: str, opened: Callable) -> None:
    assembly = scene(name)
    page = opened(name)
    page.js("() => { const s = document.getElementById('show-forces'); s.checked || s.click(); }")
    geometry = assembly.geometry
    total = geometry.mass[:, None] * assembly.gravity
    for load in assembly.loads:
        total[assembly.index[load.part]] += load.force
    for one in page.js(SHOWN):
        total[one["part"]] += one["force"]
        total[one["other"]] -= one["force"]
    free = ~geometry.grounded
    weight = np.linalg.norm(assembly.gravity) * geometry.mass[free].max()
    assert np.abs(total[free]).max() < 1e-4 * weight


@pytest.mark.parametrize("name", ["arch", "slope-with-friction", "three-cylinders"])
def test_resultants_are_those_of_python(name: str, opened: Callable) -> None:
    forces = kilter.check(scene(name)).forces
    page = opened(name)
    told = page.js(SHOWN)
    pressing = np.isfinite(forces.center).all(axis=1)
    assert len(told) == pressing.sum()
    sizes = sorted(np.linalg.norm(one["force"]) for one in told)
    expected = np.sort(np.linalg.norm(forces.resultant[pressing], axis=1))
    assert np.allclose(sizes, expected, rtol=1e-5)
    used = sorted(one["use"] for one in told if one["use"] is not None)
    assert np.allclose(
        used, np.sort(forces.utilisation[np.isfinite(forces.utilisation)]), atol=1e-4
    )
    middle = np.array(sorted([one["at"] for one in told])) + page.js("window.kilter.page.center")
    assert np.allclose(np.sort(middle, axis=0), np.sort(forces.center[pressing], axis=0), atol=1e-4)
    page.page.select_option("#force-mode", "point")
    assert len(page.js(SHOWN)) >= len(told)


def test_forces_follow_what_is_hidden_isolated_and_cut(opened: Callable) -> None:
    page = opened("tower")
    assert len(page.js(SHOWN)) == 5
    page.js("window.kilter.select(3)")
    page.page.click("#isolate")
    # the isolated part shows all its contact forces, from below and from above
    alone = page.js(SHOWN)
    assert {one["part"] for one in alone} == {3}
    assert sum(one["force"][2] for one in alone) == pytest.approx(
        scene("tower").geometry.mass[3] * 9.81, rel=1e-5
    )
    page.page.click("#show-all")
    page.page.select_option("#section-axis", "z")
    page.slide("section", 0)
    left = page.js(SHOWN)
    assert 0 < len(left) < 5
    assert all(one["at"][2] <= 1e-6 for one in left)
    page.slide("section", -1)
    assert page.js(SHOWN) == []


def test_the_line_of_thrust_goes_through_the_arch(opened: Callable) -> None:
    page = opened("arch")
    rods = "window.kilter.stage.forces.group.children.map(one => one.count)"
    before = sum(page.js(rods))
    page.page.check("#show-thrust")
    held = scene("arch").geometry.grounded
    # a rod per voussoir, and its halo
    assert sum(page.js(rods)) - before == 2 * (~held).sum()


def test_a_line_of_contact_is_a_line_without_beads(opened: Callable) -> None:
    page = opened("three-cylinders")
    counts = page.js(
        "window.kilter.stage.parts.patches.children.map(one => one.geometry.getIndex().count)"
    )
    assert counts[-2:] == [2 * 2 * 5, 0]  # five lines on both of their parts, no spots


def test_a_round_contact_is_a_surface_with_rings_and_no_beads(opened: Callable) -> None:
    sleeve = tube("sleeve", 1.0, 2.0, 3.0, grounded=True)
    page = opened(Assembly([sleeve, Part("shaft", Cylinder(1.0, 5.0), Pose([0, 0, 0.2]))]))
    counts = page.js(
        "window.kilter.stage.parts.patches.children.map(one => one.geometry.getIndex().count)"
    )
    through, filled, rims, spots = counts
    assert through == filled > 100
    assert rims > 100
    assert spots == 0
    with_patch = page.drawn()
    page.page.uncheck("#show-contacts")
    assert page.drawn() != with_patch


def test_parts_are_coloured_by_the_bond_that_they_use_most(opened: Callable) -> None:
    cubes = [Part(f"c{k}", Box([1, 1, 1]), Pose([0, 0, -k]), grounded=k == 0) for k in range(4)]
    bonds = [Bond((f"c{k + 1}", f"c{k}"), pull=9810.0) for k in range(3)]
    assembly = Assembly(cubes, bonds=bonds)
    page = opened(assembly)
    used = kilter.check(assembly).forces.bond_utilisation
    assert np.allclose(sorted(one["bond"] for one in page.js(SHOWN)), np.sort(used), atol=1e-5)
    assert page.js("document.getElementById('use-words').textContent") == "bond"
    data = "window.kilter.stage.parts.data"
    colour = f"Array.from({{length: 4}}, (_, k) => [...{data}.slice(16 * k + 8, 16 * k + 11)])"
    own = np.array(page.js(colour))
    choose = (
        "(of) => { const s = document.getElementById('colour-of'); s.value = of;"
        " s.dispatchEvent(new Event('change')); }"
    )
    page.page.evaluate(choose, "bond")
    assert page.js("document.getElementById('bond-key').innerText").endswith("9.81 kN per point")
    table = np.array([rgb(one) for one in RAMP]) / 255
    shares = [0, 0.75, 0.5, 0.25]  # held parts keep their colour
    painted = np.array(page.js(colour))
    for k in range(1, 4):
        at = shares[k] * (len(RAMP) - 1)
        expected = [np.interp(at, range(len(RAMP)), column) for column in table.T]
        assert np.allclose(painted[k], expected, atol=1 / 255)
    assert np.array_equal(painted[0], own[0])
    page.page.evaluate(choose, "own")
    assert np.array_equal(page.js(colour), own)
