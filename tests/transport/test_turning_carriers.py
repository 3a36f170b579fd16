"""Turning carriers with given inertia, against the closed form of the torque of friction.

A part of mass m and inertia I about the vertical through its centre turns with the carrier while
I alpha is at most the largest torque of friction. The pressure under a rigid part is not known, so
the weight may rest on the points of the contact that are farthest from the axis:

    I alpha <= mu m g r,    r: radius of a disc, half the diagonal of a box.
"""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter import Box, CarrierMotion, Cylinder, Part

G = 9.81
ROUND = 0.02
"""Largest share of the friction of a round patch that its polygon may lack [-]."""


def carrier(seed: int) -> tuple[kilter.Assembly, float]:
    """A part at rest on a deck, at random, and its largest angular acceleration [rad/s^2]."""
    rng = np.random.default_rng(seed)
    metres = {"m": 1.0, "mm": 1e-3}[units := ("m", "mm")[seed % 2]]
    m, mu = rng.uniform(0.5, 50), rng.uniform(0.1, 1.2)
    x, y, z = rng.uniform(0.1, 1.0, 3)
    shape = Cylinder(x / metres, z / metres) if seed % 4 < 2 else Box(*np.array([x, y, z]) / metres)
    r = x if seed % 4 < 2 else np.hypot(x, y) / 2
    about = m * rng.uniform(0.02, 2.0, 3)
    about[2] = rng.uniform(abs(about[0] - about[1]), about[0] + about[1])
    part = Part("part", shape, [0, 0, z / 2 / metres], mass=m,
                inertia=[*about / metres**2, 0, 0, 0])  # fmt: skip
    deck = Part("deck", Box(np.array([4, 4, 1]) / metres), [0, 0, -0.5 / metres], grounded=True)
    return kilter.Assembly([deck, part], units=units, friction=mu), mu * m * G * r / about[2]


@pytest.mark.quick(4)
@pytest.mark.parametrize("seed", range(100))
def test_a_part_turns_with_its_carrier_up_to_the_torque_of_friction(seed: int) -> None:
    """Asked at 0.8 times the limit it is carried, at 1.01 times it is not, and the factor fits."""
    assembly, limit = carrier(seed)
    for share, carried in ((0.8, True), (1.01, False)):
        motion = CarrierMotion(angular_acceleration=[0, 0, share * limit])
        case = kilter.transport(assembly, turn=motion, require="equilibrium").cases[0]
        assert (case.level is not None) == carried
        assert case.factor is not None
        assert (1 - ROUND) / share <= case.factor <= (1 + 1e-6) / share
