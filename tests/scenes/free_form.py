"""A free form on a floor, and a tower with a gap."""

import math

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Sphere, surface
from kilter.shape.solid import Solid

RADIUS = 0.5
SAGITTA = 1e-2


def free_form_ball() -> Solid:
    """A ball of radius `RADIUS` whose face is given only as a free form."""
    vertices, triangles = surface(Sphere(RADIUS))
    volume = 4 / 3 * math.pi * RADIUS**3
    second_moment = volume * RADIUS**2 / 5 * np.eye(3)
    kind = np.full(len(triangles), -1)
    return Solid(vertices, triangles, (), kind, volume, np.zeros(3), second_moment, sagitta=SAGITTA)


def free_form_on_a_floor() -> Assembly:
    """A free-form ball on a held plate; their contact is an open pair."""
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([floor, Part("ball", free_form_ball(), Pose([0, 0, RADIUS]))])


def tower() -> Assembly:
    """Blocks a, b and c above each other; a gap of 0.01 is below c, which is 0.2 off the middle."""
    a = Part("a", Box([2, 2, 1]), Pose([0, 0, 0.5]))
    b = Part("b", Box([1, 1, 1]), Pose([0, 0, 1.5]))
    c = Part("c", Box([1, 1, 1]), Pose([0.2, 0, 2.51]))
    return Assembly([a, b, c])
