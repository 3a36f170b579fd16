"""Given inertia in the accelerations and in copies of a part, against closed forms."""

import dataclasses

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


@pytest.mark.parametrize("units", ["m", "mm"])
@pytest.mark.parametrize("inertia", [0.05, 5.0, None])
def test_a_plate_tips_over_an_edge_as_its_inertia_states(units, inertia):
    """The acceleration is m g d / (I + m d^2) for d = 0.2 m beyond the edge: 43.6, 3.63 rad/s^2."""
    size, m, d = {"m": 1.0, "mm": 1000.0}[units], 10.0, 0.2
    table = Part("table", Box([2 * size] * 3), [-size, 0, -size], grounded=True)
    given = None if inertia is None else np.array([inertia, inertia, inertia, 0, 0, 0]) * size**2
    plate = Part("plate", Box([size, size, 0.2 * size]), [d * size, 0, 0.1 * size], mass=m)
    plate = dataclasses.replace(plate, inertia=given)
    verdict = judged(Assembly([table, plate], units=units))
    about = m * (1 + 0.2**2) / 12 if inertia is None else inertia
    assert verdict.motion.acceleration[1, 4] == pytest.approx(m * G * d / (about + m * d**2))
