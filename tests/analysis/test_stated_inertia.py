"""Given inertia in the accelerations and in copies of a part, against closed forms."""

import numpy as np
import pytest
from judged import judged, random_turn
from transformations import mirrored, scaled

from kilter.assembly import Assembly, Part
from kilter.assembly.inertia import inertia_matrix
from kilter.assembly.masses import reweighed
from kilter.files.reading_steps import with_density, with_masses
from kilter.rigid import Pose
from kilter.scenes.transform import moved
from kilter.shape.primitives import Box

SIX = [3.0, 4.0, 5.0, 0.3, -0.4, 0.5]
G = 9.81


def body(**more):
    """A turned box with a given inertia."""
    random = np.random.default_rng(4)
    return Part("body", Box([1, 2, 3]), Pose([1, -2, 3], random_turn(random)), inertia=SIX, **more)


@pytest.mark.parametrize("more", [{}, {"mass": 3.0}, {"mass": 3.0, "center_of_mass": [0.1, 0, 2]}])
def test_the_world_inertia_is_the_given_tensor_turned(more):
    part = body(**more)
    turned = part.pose.matrix @ inertia_matrix(np.array(SIX)) @ part.pose.matrix.T
    assert np.allclose(Assembly([part]).geometry.inertia[0], turned, atol=1e-14)


def test_copies_keep_the_inertia_of_the_body():
    """A turn Q I Q^T, a mirror image M I M, and lengths times k with masses times k^3: k^5 I."""
    assembly = Assembly([body(mass=3.0)])
    inertia = assembly.geometry.inertia[0]
    turn = Pose([0, 0, 0], random_turn(np.random.default_rng(8)))
    q, m = turn.matrix, np.diag([-1.0, 1, 1])
    copies = {
        "moved": (moved(assembly, turn.rotation, [1, 2, 3]), q @ inertia @ q.T),
        "mirrored": (mirrored(assembly), m @ inertia @ m),
        "scaled": (scaled(assembly, 2.0), 32 * inertia),
    }
    for name, (copy, expected) in copies.items():
        assert np.allclose(copy.geometry.inertia[0], expected, rtol=1e-13, atol=1e-12), name


def test_another_mass_changes_a_given_inertia_in_proportion():
    heavy = Assembly([body(mass=3.0)])
    assert np.allclose(with_masses(heavy, [("body", 6.0)])["body"].inertia, np.multiply(SIX, 2))
    light = Assembly([body()])  # 6 m^3 of the default density
    assert np.allclose(with_density(light, 500.0)["body"].inertia, np.divide(SIX, 2))
    assert np.allclose(reweighed(body(density=500.0), mass=6000.0).inertia, np.multiply(SIX, 2))


@pytest.mark.parametrize("given", [5.0, None])
def test_inertia_in_millimetres_is_that_of_the_same_body_in_metres(given):
    """A plate tips about an edge by m g d / (I + m d^2); without I, by that of its shape."""
    m, d = 10.0, 0.2
    table = Part("table", Box([2000] * 3), [-1000, 0, -1000], grounded=True)
    inertia = None if given is None else np.array([given, given, given, 0, 0, 0]) * 1e6
    plate = Part("plate", Box([1000, 1000, 200]), [200, 0, 100], mass=m, inertia=inertia)
    verdict = judged(Assembly([table, plate], units="mm"))
    about = m * (1 + 0.2**2) / 12 if given is None else given
    assert verdict.motion.acceleration[1, 4] == pytest.approx(m * G * d / (about + m * d**2))
