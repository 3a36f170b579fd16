"""Derivatives of the heaviest mass at a place: closed forms, differences, wrong input."""

from dataclasses import replace

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Load, Part, Pose
from kilter.errors import InputError

MASS, BACK, OUT = 6.0, 0.3, 0.15
"""Mass of a shelf [kg], and distances of its centre and of the jar from the edge below it [m]."""


def at_edge(*, jar: float = 1.0, out: float = OUT, more: tuple[Load, ...] = (), **given: object):
    table = Part("table", Box(1, 1, 1), [-0.5, 0, -0.5], grounded=True)
    shelf = Part("shelf", Box(1, 0.5, 0.1), [-BACK, 0, 0.05], mass=MASS)
    assembly = Assembly([table, shelf], loads=more)
    part = kilter.box_to_place([0.1, 0.1, 0.1], jar, name="jar")
    return kilter.place(assembly, part, at=[out, 0], **given).at


@pytest.mark.parametrize("jar", [1.0, 20.0])
def test_a_shelf_over_an_edge_carries_the_moment_of_its_weight(jar):
    """M = m c/d, whatever the mass of the part that is tried, also beyond the limit."""
    at = at_edge(jar=jar)
    gradient = at.gradient()
    assert (gradient.of, gradient.unit) == ("heaviest", "kg")
    assert gradient.value == at.heaviest == pytest.approx(MASS * BACK / OUT)
    table, shelf, placed = (gradient.parts.index(name) for name in ("table", "shelf", "jar"))
    assert gradient.mass[shelf] == pytest.approx([BACK / OUT] * 2)
    assert gradient.mass[placed] == pytest.approx([0, 0])
    by_x = gradient.position[:, 0]
    assert by_x[placed] == pytest.approx([-MASS * BACK / OUT**2] * 2)
    assert by_x[shelf] == pytest.approx([-MASS / OUT] * 2)
    assert by_x.sum(axis=0) == pytest.approx([0, 0], abs=1e-6)
    assert by_x[table] == pytest.approx([MASS / OUT + MASS * BACK / OUT**2] * 2)


def test_a_load_at_a_point_does_not_move_with_its_part():
    """A force F down at a point a behind the edge: M = (m c + F a/g)/d."""
    force, back = 50.0, 0.6
    at = at_edge(more=(Load("shelf", [0, 0, -force], point=[-back, 0, 0.1]),))
    size = float(np.linalg.norm(at.worst.assembly.gravity))
    gradient = at.gradient()
    assert at.heaviest == pytest.approx((MASS * BACK + force * back / size) / OUT)
    assert gradient.position[1, 0] == pytest.approx([-MASS / OUT] * 2)
    assert gradient.position[2, 0] == pytest.approx([-at.heaviest / OUT] * 2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_differences_of_the_heaviest_mass_on_a_stack(seed):
    """Random stacks with friction: central differences of the heaviest mass by all data at once."""
    random = np.random.default_rng(seed)
    parts, height = [Part("table", Box(1, 1, 1), [-0.5, 0, -0.5], grounded=True)], 0.0
    for k in range(3):
        size = np.append(random.uniform(0.8, 1.2, 2), random.uniform(0.1, 0.3))
        center = np.append(random.uniform([-0.35, -0.1], [-0.2, 0.1]), height + size[2] / 2)
        height += float(size[2])
        parts.append(Part(f"b{k}", Box(*size), Pose(center), mass=float(random.uniform(5, 9))))
    ways = [(np.append(random.normal(size=2), 0.0), random.normal()) for _ in parts[1:]]
    place, way = np.array([0.1, 0.03]), random.normal(size=2)

    def moved(step: float):
        changed = [
            replace(
                part,
                pose=Pose(np.asarray(part.pose.position) + step * shift),
                given_mass=part.mass + step * heavier,
            )
            for part, (shift, heavier) in zip(parts[1:], ways, strict=True)
        ]
        box = kilter.box_to_place([0.1, 0.1, 0.1], 1.0)
        assembly = Assembly([parts[0], *changed], friction=0.4)
        return kilter.place(assembly, box, at=place + step * way, effort=0).at

    middle, step = moved(0.0), 1e-4
    gradient = middle.gradient()
    assert gradient.unique["position"].all()
    expected = sum(
        gradient.position[k + 1, :, 1] @ shift + gradient.mass[k + 1, 1] * heavier
        for k, (shift, heavier) in enumerate(ways)
    ) + float(gradient.position[4, :2, 1] @ way)
    difference = (moved(step).heaviest - moved(-step).heaviest) / (2 * step)
    assert difference == pytest.approx(expected, rel=1e-5)


def test_wrong_input_of_the_gradient_of_a_place():
    with pytest.raises(InputError, match="uncertain centre"):
        at_edge(center_within=0.1).gradient()
    with pytest.raises(InputError, match="unlimited"):
        at_edge(out=-0.4).gradient()
    assert at_edge(mass=(1.0, 2.0)).gradient().value == pytest.approx(MASS * BACK / OUT)
