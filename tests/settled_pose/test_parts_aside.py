"""Inexact held parts that no free part can reach do not make the pose at rest less exact."""

import numpy as np

from kilter import Assembly, Box, Mesh, Part, Pose, contacts
from kilter.analysis.settled_pose.rest_engine import come_to_rest
from kilter.analysis.settled_pose.rest_proof import closed_gap
from kilter.analysis.settled_pose.rest_verification import held_aside
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies

ACCURACY = 1e-6
"""Rounding of the corners of the inexact part [m]."""
TILT = 1e-6
"""Tilt of the falling box [rad]: less than the inexact part resolves."""


def inexact_block(name, at):
    """A held cube whose corners are rounded."""
    corners = np.array([[x, y, z] for z in (0, 0.2) for y in (0, 0.2) for x in (0, 0.2)])
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    triangles = [t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])]
    mesh = Mesh(corners, triangles, accuracy=ACCURACY)
    return Part(name, mesh, Pose(at), grounded=True)


def beside_a_table(*inexact):
    table = Part("table", Box(2, 2, 0.1), [0, 0, -0.05], grounded=True)
    box = Part("box", Box(0.2, 0.2, 0.2), Pose([0, 0, 0.15], [1, TILT / 2, 0, 0]))
    return Assembly([table, box, *inexact])


def test_parts_below_and_beside_a_falling_part_are_within_its_reach():
    assembly = beside_a_table(
        inexact_block("far", [3, 0, 0]),
        inexact_block("above", [0, 0, 2]),
        inexact_block("below", [0, 0, -5]),
        inexact_block("beside", [0.3, 0, 0]),
    )
    names = np.array(assembly.names)
    assert set(names[held_aside(assembly, moving=True)]) == {"far", "above"}
    assert set(names[held_aside(assembly)]) == {"far", "above", "below", "beside"}


def test_the_engine_is_as_exact_as_the_parts_that_may_touch():
    rest = closed_gap(beside_a_table())
    for block, exact in (("far", True), ("beside", False)):
        assembly = beside_a_table(inexact_block(block, [3 if exact else 0.3, 0, 0]))
        assert closed_gap(assembly) > 10 * rest
        found = come_to_rest(
            rigid_bodies(assembly, []), contacts(assembly), reach=None, tell=lambda stage: None
        )
        assert found.state == "at-rest"
        assert (found.points.gap.max() <= rest) or not exact
