"""Derivatives of the accelerations of a carrier: closed forms, differences, wrong input."""

from dataclasses import replace

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Load, Part, Pose, Strap
from kilter.errors import InputError

B, H = 0.5, 1.0
"""Half base and half height of the box."""


def box(friction: float, shift: float = 0.0, **more: object) -> Assembly:
    table = Part("table", Box(9, 9, 1), [0, 0, -0.5], grounded=True)
    return Assembly([table, Part("box", Box(2 * B, 3, 2 * H), [shift, 0, H], **more)],
                    friction=friction)  # fmt: skip


def limits(assembly: Assembly) -> kilter.Transport:
    return kilter.transport(assembly, polar=False, effort=0)


@pytest.mark.parametrize("name", ["+x", "-x"])
def test_a_box_that_tips_on_its_carrier(name):
    """The limit is b/h in g: 1/h by b (half of the size), -b/h^2 by the height of the centre."""
    gradient = limits(box(0.9)).gradient(name)
    assert (gradient.of, gradient.unit, gradient.value) == (name, "g", pytest.approx(B / H))
    assert gradient.sizes("box")["x"] == pytest.approx((1 / (2 * H),) * 2)
    assert gradient.center[1, 2] == pytest.approx([-B / H**2] * 2)
    toward = 1 / H if name == "+x" else -1 / H  # the box tips against the acceleration
    assert gradient.center[1, 0] == pytest.approx([toward] * 2)
    assert gradient.mass == pytest.approx(np.zeros((2, 2)), abs=1e-9)


def test_the_weakest_direction_of_a_centred_box_is_one_sided():
    """Both sides have the limit b/h: a moved centre always loses one of them."""
    gradient = limits(box(0.9)).gradient("least")
    assert gradient.value == pytest.approx(B / H)
    assert gradient.center[1, 0] == pytest.approx([1 / H, -1 / H])
    assert gradient.center[1, 2] == pytest.approx([-B / H**2] * 2)
    assert gradient.friction == pytest.approx(np.zeros((1, 2)), abs=1e-9)


def test_a_box_that_slides_on_its_carrier_has_the_slope_of_its_friction():
    answer = limits(box(0.3))
    assert answer.gradient("+y").friction == pytest.approx(np.ones((1, 2)), rel=1e-6)
    # up or down, the limit is that of free fall: nothing changes it
    assert answer.gradient("-z").value == pytest.approx(1)
    assert answer.gradient("-z").friction == pytest.approx(np.zeros((1, 2)), abs=1e-9)


def test_a_load_is_fixed_in_the_carrier():
    """A force F down at the top: mu (1 + F/(m g)) in g, so mu/(m g) by the force."""
    given = replace(box(0.3, mass=10.0), loads=[Load("box", [0, 0, -20.0])])
    gradient = limits(given).gradient("+x")
    weight = 10 * 9.81
    assert gradient.value == pytest.approx(0.3 * (1 + 20 / weight), rel=1e-4)
    size = float(np.linalg.norm(given.gravity))
    assert gradient.load[1, 2] == pytest.approx([-0.3 / (10 * size)] * 2, rel=1e-6)
    assert gradient.mass[1] == pytest.approx([-0.3 * 20 / (size * 100)] * 2, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["+x", "-y", "least"])
@pytest.mark.parametrize("seed", range(3))
def test_differences_of_the_limits_of_a_stack(seed, name):
    """Random boxes, masses, centres and loads: central differences of the limits themselves."""
    random = np.random.default_rng(seed)
    parts = [Part("table", Box(9, 9, 1), [0, 0, -0.5], grounded=True)]
    height, ways = 0.0, []
    for k in range(3):
        size = np.append(random.uniform(0.8, 1.2, 2), random.uniform(0.4, 0.7))
        center = np.append(random.uniform(-0.1, 0.1, 2), height + size[2] / 2)
        height += float(size[2])
        part = Part(f"b{k}", Box(*size), Pose(center), mass=float(random.uniform(500, 900)))
        parts.append(part)
        ways.append((np.append(random.normal(size=2), 0.0), random.normal() * 100))
    given = Assembly(parts, friction=0.4, loads=[Load("b1", [300.0, -100, -500])])

    def at(step: float) -> Assembly:
        moved = [
            replace(part, pose=Pose(np.asarray(part.pose.position) + step * way),
                    given_mass=part.given_mass + step * mass)
            for part, (way, mass) in zip(given.parts[1:], ways, strict=True)
        ]  # fmt: skip
        return replace(given, parts=[given.parts[0], *moved], friction=0.4 * (1 + step))

    def limit(step: float) -> float:
        return limits(at(step)).gradient(name).cases[0].solved.value

    small = 1e-4
    slope = limits(given).gradient(name).along(at(small))
    expected = (limit(small) - limit(-small)) / 2
    assert [slope.left, slope.right] == pytest.approx([expected] * 2, rel=1e-6, abs=1e-12)


def test_limits_that_have_no_derivatives_are_errors():
    answer = limits(box(0.3))
    with pytest.raises(InputError, match="the answer has no limit 'up'; name"):
        answer.gradient("up")
    with pytest.raises(InputError, match=r"the limit '\+z' is not finite"):
        answer.gradient("+z")
    with pytest.raises(InputError, match="ask no other question"):
        kilter.transport(box(0.3), accelerate=[1, 0, 0]).gradient("least")
    with pytest.raises(InputError, match="leave mu_range out"):
        kilter.transport(box(0.3), polar=False, mu_range=(0.9, 1.1)).gradient("+x")
    strap = Strap([("table", [-1, 0, 0]), ("box", [-0.5, 0, 1])], tension=100.0)
    with pytest.raises(InputError, match="bonds, straps, springs"):
        limits(replace(box(0.3), straps=[strap])).gradient("+x")
