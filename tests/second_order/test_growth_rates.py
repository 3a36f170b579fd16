"""Growth rates of falls, against the modes of small bodies with the same few coordinates.

A ball of radius r on a held ball of radius R, with its centre of mass at e above its middle: the
angle p of the line of both middles and the turn q of the upper ball leave, for m g = 1 N,

    2 V = -(R + r) p^2 - e q^2,      2 T = ((R + r) p' + e q')^2 / g + I q'^2

without friction, in each vertical plane. The motion that falls fastest is a mode of both.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

import kilter
from kilter.scenes.pieces import block, turn

G = 9.81


def rate_of(assembly: kilter.Assembly) -> float:
    second = kilter.check(assembly, require="equilibrium").second_order_answer
    assert second is not None
    assert second.state == "balanced"
    assert second.rate is not None
    return second.rate


@pytest.mark.parametrize(
    ("under", "upper", "raised"),
    [(1.0, 0.2, 0.0), (0.5, 0.7, 0.0), (0.4, 0.3, 0.1), (2.0, 0.3, 0.25), (0.3, 0.8, -0.2)],
)
@pytest.mark.quick(1)
def test_a_ball_on_a_ball(under: float, upper: float, raised: float) -> None:
    ball = kilter.Part(
        "ball", kilter.Sphere(upper), [0, 0, under + upper], center_of_mass=[0, 0, raised]
    )
    held = kilter.Part("held", kilter.Sphere(under), [0, 0, 0], grounded=True)
    assembly = kilter.Assembly([held, ball])
    geometry = assembly.geometry
    mass, inertia = geometry.mass[1], geometry.inertia[1][0, 0]
    length = under + upper
    kinetic = mass * np.array([[length**2, length * raised], [length * raised, raised**2]])
    kinetic += np.diag([0.0, inertia])
    values = eigh(-mass * G * np.diag([length, raised]), kinetic, eigvals_only=True)
    assert rate_of(assembly) == pytest.approx(np.sqrt(-values.min()), rel=1e-5)
    if not raised:
        assert rate_of(assembly) == pytest.approx(np.sqrt(G / length), rel=1e-5)


@pytest.mark.parametrize("raised", [0.05, 0.3])
@pytest.mark.quick(1)
def test_a_curved_foot_turns_in_place(raised: float) -> None:
    """Without friction no force moves the centre of mass aside: I q'' = m g e q."""
    roller = kilter.Part(
        "foot",
        kilter.Cylinder(0.5, 1.0),
        kilter.Pose([0, 0, 0.5], turn([1, 0, 0], 90)),
        center_of_mass=[0, raised, 0],
    )
    table = block("table", [-2, -2, -1], [2, 2, 0], grounded=True)
    assembly = kilter.Assembly([table, roller])
    geometry = assembly.geometry
    rise = geometry.center[1][2] - 0.5
    expected = np.sqrt(geometry.mass[1] * G * rise / geometry.inertia[1][1, 1])
    assert rise == pytest.approx(raised)
    assert rate_of(assembly) == pytest.approx(expected, rel=1e-5)
