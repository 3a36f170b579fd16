"""The worst case over masses counts the loads, by corners and by following forces alike."""

import pytest

import kilter
from kilter import Assembly, Box, Load, Part, Pose
from kilter.analysis.margins.uncertainty import Ranges, _by_corners, _by_following
from kilter.mechanics.program import build_program


@pytest.mark.quick(2)
@pytest.mark.parametrize(("share", "held"), [(0.3, True), (0.4, True), (0.5, False), (1.0, False)])
def test_a_block_under_a_side_load_is_held_up_to_its_friction(share: float, held: bool) -> None:
    """Mu .5, masses down to .9 of the given: held while the load is below .45 of the weight."""
    table = Part("table", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    block = Part("block", Box([2, 2, 0.2]), Pose([0, 0, 0.1]), mass=10.0)
    load = Load("block", [share * 10.0 * 9.81, 0, 0])
    assembly = Assembly([table, block], friction=0.5, loads=[load])
    program = build_program(assembly, kilter.contacts(assembly))
    ranges = Ranges(mass=(0.9, 1.1))
    corners = _by_corners(program, ranges, None, "exact")
    following = _by_following(program, ranges, None)
    assert following is not None
    assert (corners.held, following.held) == (held, held)
