"""The check of the contact law: accepted motions, and every kind of refusal."""

import numpy as np
import pytest
from held_or_not import program, worst_by_hand
from transformations import scaled

from kilter.assembly import Joint
from kilter.friction.law import coulomb_law
from kilter.friction.reduced_law import reduced_law
from kilter.mechanics.law_check import check_law, point_speeds
from kilter.scenes import friction, stacks, traps
from kilter.units import metres_per_unit

G = 9.81


def sliding(tilt, mu):
    """A block that slides down a slope, by hand: acceleration, and equal forces at its corners."""
    built = program(stacks.block_on_slope(tilt, friction=mu))
    t = np.radians(tilt)
    n = built.normal[0] if built.part_b[0] == np.flatnonzero(built.free)[0] else -built.normal[0]
    down = built.gravity - (built.gravity @ n) * n
    down /= np.linalg.norm(down)
    a = np.zeros((2, 6))
    a[built.free, :3] = G * (np.sin(t) - mu * np.cos(t)) * down
    (k,) = np.flatnonzero(built.free)
    push = built.mass[k] * G * np.cos(t) * (n - mu * down)
    # the same push at four corners, tilted so that its resultant goes through the centre
    arms = built.point - built.center[k]
    rows = np.vstack([np.ones(4), arms @ down, arms @ np.cross(n, down)])
    lean = -mu * (arms[0] @ n)
    share = np.linalg.pinv(rows) @ np.array([1.0, lean, 0.0])
    side = 1.0 if built.part_b[0] == k else -1.0
    return built, a, side * share[:, None] * push


def test_a_block_that_slides_by_the_closed_form():
    built, a, forces = sliding(40.0, 0.5)
    law = check_law(built, a, forces)
    assert law.holds
    assert law.residual < 1e-14
    expected = (np.sin(np.radians(40)) - 0.5 * np.cos(np.radians(40))) * np.sin(np.radians(40))
    assert law.power == pytest.approx(expected)
    assert worst_by_hand(built, a, forces) < 1e-14


@pytest.mark.parametrize("tilt", [20.0, 26.0])
def test_sliding_up_the_slope_of_its_friction_is_refused(tilt):
    """Below the limit friction would drive the block upward: its power is negative."""
    built, a, forces = sliding(tilt, 0.5)
    assert check_law(built, a, forces).power < 0
    assert not check_law(built, a, forces).holds


def test_each_component_flipped_is_refused():
    built, a, forces = sliding(40.0, 0.5)
    for array in (a, forces):
        for place in np.argwhere(np.abs(array) > 1e-3 * np.abs(array).max()):
            before = array[tuple(place)]
            array[tuple(place)] *= -1
            assert not check_law(built, a, forces).holds
            array[tuple(place)] = before
    assert check_law(built, a, forces).holds


def test_each_residual_speaks():
    built, a, forces = sliding(40.0, 0.5)
    (k,) = np.flatnonzero(built.free)
    n, away = built.normal[0], np.sign((built.part_b[0] == k) - 0.5)

    def law(motion=a, push=forces):
        return check_law(built, motion, push)

    lifted = a.copy()
    lifted[k, :3] += 0.1 * G * away * n
    assert law(lifted).normal > 1e-3
    sunk = a.copy()
    sunk[k, :3] -= 0.1 * G * away * n
    assert law(sunk).opening > 1e-3
    along = forces @ n
    smooth = along[:, None] * n
    assert law(push=smooth).stretch > 1e-3
    assert law(push=smooth + 1.5 * (forces - smooth)).cone > 1e-3
    assert law(push=smooth - (forces - smooth)).angle > 1e-3
    assert law(push=-forces).cone > 1e-3
    assert law(push=0 * forces).balance > 1e-3
    for bad in (np.nan, np.inf):
        wrong = a.copy()
        wrong[k, 0] = bad
        assert not law(wrong).holds
    assert not check_law(built, a[:1], forces).holds


def test_all_grows_with_gravity_and_no_unit_matters():
    for factor in (1e-3, 1e3):
        small = scaled(friction.h_block(), factor)
        built = program(small)
        fall = np.zeros((3, 6))
        fall[built.free, :3] = built.gravity
        law = check_law(built, fall, np.zeros((len(built.part_a), 3)))
        assert law.holds
        assert law.power == pytest.approx(1)
        assert law.size == pytest.approx(1)


def test_a_speck_that_falls_beside_a_mountain_counts():
    tower = traps.floating_block(2)
    mass = [1e-3 if name == tower.names[2] else 1e6 for name in tower.names]
    parts = [
        type(part)(part.name, part.shape, part.pose, grounded=part.grounded, mass=m)
        for part, m in zip(tower.parts, mass, strict=True)
    ]
    built = program(tower._replace(parts=parts))
    fall = np.zeros((len(mass), 6))
    fall[2, :3] = built.gravity
    law = coulomb_law(built)
    assert law.columns(fall) @ law.load < 1e-8
    moving = check_law(built, fall, np.zeros((len(built.part_a), 3)))
    assert moving.power == pytest.approx(1)


def test_scaled_unknowns_go_there_and_back():
    built = program(scaled(friction.squeezed_row(3), 10.0))
    law = coulomb_law(built)
    x = np.random.default_rng(0).normal(size=len(law.load))
    assert law.columns(law.acceleration(x)) == pytest.approx(x, abs=1e-12)
    assert np.linalg.norm(law.load) == pytest.approx(1)
    assert law.load @ law.load == pytest.approx(law.columns(_free_fall(built)) @ law.load)


@pytest.mark.parametrize("planar", [False, True])
def test_the_scaled_law_is_the_law(planar):
    """Of any accelerations and forces, whether they obey it or not: the same rest, the same speeds.

    `check_law` is written apart; its rest is in the metric of the masses over |w|, as x is.
    """
    built = program(scaled(friction.ladder(50.0, planar=planar), 100.0))
    law = coulomb_law(built)
    rng = np.random.default_rng(1)
    x, g = rng.normal(size=len(law.load)), rng.normal(size=(len(law.mu), 3))
    g[:, 2] *= not planar
    acceleration, forces = law.acceleration(x), law.forces(g)
    rest = x - law.load - law.matrix.T @ g.reshape(-1)
    assert check_law(built, acceleration, forces).balance == pytest.approx(np.linalg.norm(rest))
    assert np.einsum("kij,kj->ki", law.basis, forces) == pytest.approx(
        g * (law.strength / law.sigma)[:, None]
    )
    motion = acceleration * np.repeat([1.0, metres_per_unit(built.units)], 3)
    speeds = np.einsum("kij,kj->ki", law.basis, point_speeds(built, motion))
    speeds[:, 2] *= not planar  # across the plane nothing counts
    own = (law.matrix @ x).reshape(-1, 3) * (law.strength * law.sigma)[:, None]
    assert own == pytest.approx(speeds, abs=1e-9 * np.abs(speeds).max())


def test_no_row_is_large_or_small():
    built = program(friction.books(4))
    law = coulomb_law(built)
    sizes = np.linalg.norm(law.matrix.toarray().reshape(-1, 3, len(law.load)), axis=(1, 2))
    assert sizes == pytest.approx(np.sqrt(3.0))


def test_in_the_plane_the_first_tangent_is_in_it_and_the_second_does_not_move():
    law = coulomb_law(program(friction.ladder(50.0)))
    assert law.basis[:, 1, 1] == pytest.approx(0)
    assert not law.matrix[2::3].nnz
    assert np.linalg.det(law.basis) == pytest.approx(1)


@pytest.mark.parametrize("planar", [False, True])
def test_the_reduced_law_is_the_law(planar):
    tower = friction.squeezed_row(3, planar=planar)
    built = program(tower._replace(joints=[Joint(("block-0", "block-1"))]))
    law, reduced = coulomb_law(built), reduced_law(built)
    basis = reduced.allowed.toarray()
    joint = law.matrix[3 * np.flatnonzero(law.tied)].toarray()
    assert len(joint)
    assert basis.T @ basis == pytest.approx(np.eye(basis.shape[1]))
    assert joint @ basis == pytest.approx(0, abs=1e-12)
    assert basis.shape[1] == len(law.load) - np.linalg.matrix_rank(joint)
    assert np.linalg.norm(reduced.load) == pytest.approx(1)
    a = np.random.default_rng(0).normal(size=basis.shape[1])
    u = (law.matrix @ (basis @ a)).reshape(-1, 3)
    u *= (law.sigma * np.sqrt(built.mass[built.free].sum()))[:, None]
    assert reduced.normal @ a == pytest.approx(u[reduced.rows, 0])
    ut = (reduced.tangent @ a).reshape(-1, reduced.directions)
    for group, patch in enumerate(reduced.patch):
        twist = reduced.twist[patch] @ a
        assert reduced.lever[group][:, : len(twist)] @ twist == pytest.approx(ut[group])
        row = reduced.rows[np.flatnonzero(reduced.group == group)]
        assert ut[group] == pytest.approx(u[row[0], 1 : 1 + reduced.directions])
    # the faces are flat: in space one spin each beside two speeds
    assert {rows.shape[0] for rows in reduced.twist} == {1 if planar else 3}


def _free_fall(built):
    fall = np.zeros((len(built.names), 6))
    fall[built.free, :3] = built.gravity
    return fall
