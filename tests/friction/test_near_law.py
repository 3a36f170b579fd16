"""The cheap test dismisses only candidates that the exact check dismisses too."""

import numpy as np
import pytest
from cases import planar, program
from transformations import tilted

from kilter.assembly import Joint
from kilter.friction.law import coulomb_law
from kilter.friction.motion_search import find_coulomb_motion
from kilter.friction.near_law import breach, may_obey
from kilter.mechanics.law_check import check_law
from kilter.scenes import friction, stacks

WITNESSED = {
    "H": friction.h_block(),
    "planar H": planar(friction.h_block()),
    "books": friction.books(2),
    "a slope too steep": stacks.block_on_slope(40.0, friction=0.5),
    "a planar slope": planar(stacks.block_on_slope(40.0, friction=0.5)),
    "joints": tilted(
        stacks.tower(2).with_friction(0.5)._replace(joints=[Joint(("cube-1", "cube-2"))]),
        [0, 1, 0],
        35.0,
    ),
}


@pytest.fixture(scope="module", params=WITNESSED)
def witnessed(request):
    """Law, and x and scaled forces of a motion that obeys it."""
    built = program(WITNESSED[request.param])
    law, witness = coulomb_law(built), find_coulomb_motion(built, work=1)
    assert witness.exact
    own = np.einsum("kij,kj->ki", law.basis, witness.forces)
    return law, law.columns(witness.acceleration), own * (law.sigma / law.strength)[:, None]


@pytest.mark.quick(1)
def test_a_witness_is_not_dismissed_and_has_no_breach(witnessed):
    law, x, forces = witnessed
    assert may_obey(law, x, forces)
    assert abs(breach(law, x, forces)) < 1e-8


@pytest.mark.quick(2)
def test_what_is_dismissed_would_not_pass(witnessed):
    """Errors of all sizes: the two checks differ by at most the allowance."""
    law, x, forces = witnessed
    rng, said = np.random.default_rng(0), []
    for size in np.geomspace(1e-13, 1e-2, 23):
        off = x + size * rng.normal(size=x.shape)
        pushes = forces + size * rng.normal(size=forces.shape) * (forces != 0)
        exact = check_law(law.program, law.acceleration(off), law.forces(pushes)).holds
        said.append((may_obey(law, off, pushes), exact))
    assert all(cheap or not exact for cheap, exact in said)
    assert said[0] == (True, True)
    assert said[-1] == (False, False)


def test_a_motion_that_loses_power_is_dismissed(witnessed):
    law, x, forces = witnessed
    assert not may_obey(law, -x, forces)
    assert not may_obey(law, 0 * x, forces)


def test_a_breach_is_the_power_of_a_force_where_it_may_not_push():
    """The breach of a falling block with forces f at its corners is their power."""
    law = coulomb_law(program(stacks.block_on_slope(0.0, friction=0.5)))
    pushes = np.zeros((len(law.mu), 3))
    pushes[:, 0] = 0.25
    up = -law.load
    assert breach(law, up, pushes) == pytest.approx(float((law.matrix @ up) @ pushes.ravel()))
    assert breach(law, up, pushes) > 0.1
    assert breach(law, 0 * up, pushes) == 0
