"""Coulomb's law for motions: closed forms, and each number by hand."""

import numpy as np
import pytest
from builders import given, hanging_pair
from cases import program
from held_or_not import worst_by_hand
from transformations import scaled

from kilter import Assembly, Joint
from kilter.friction.law import coulomb_law
from kilter.friction.reduced_law import reduced_law
from kilter.mechanics.law_check import (
    LawProof,
    check_balance,
    check_law,
    mobilities,
    point_speeds,
    point_wrenches,
)
from kilter.mechanics.mechanics_tolerances import (
    STILL,
    WITNESS_EXACT,
    WITNESS_POWER,
    WITNESS_SLIVER,
)
from kilter.mechanics.program import Program
from kilter.scenes import friction, paper, stacks, traps
from kilter.scenes.pieces import block, floor
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
    """Any accelerations and forces have the same rest and speeds, whether or not they obey the law.

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


def free_first(assembly: Assembly) -> Assembly:
    """The same program with its parts in the other order: the first is free."""
    return assembly._replace(parts=assembly.parts[::-1])


PROGRAMS = {
    "slope": lambda: stacks.block_on_slope(40.0, friction=0.5),
    "in cm": given,
    "free first": lambda: free_first(stacks.block_on_slope(40.0, friction=0.5)),
    "tower": lambda: stacks.tower(3, tilt=15.0, friction=0.5),
    "smooth": paper.figure_8,
    "planar": lambda: paper.figure_9(planar=True).with_friction(0.3),
    "joints": hanging_pair,
    "planar joints": lambda: hanging_pair()._replace(planar=True),
    "bracket": lambda: friction.bracket(1.1 / 1.2, pad=1e-3),
}
FIELDS = ("balance", "opening", "cone", "normal", "angle", "stretch")


@pytest.fixture(scope="module", params=PROGRAMS)
def built(request: pytest.FixtureRequest) -> Program:
    return program(PROGRAMS[request.param]())


def motion_and_forces(built: Program, seed: int, size: float = 1.0) -> tuple[np.ndarray, ...]:
    random = np.random.default_rng(seed)
    weight = float(built.weight[built.free].max())
    motion = size * random.normal(size=(len(built.names), 6))
    return motion, size * weight * random.normal(size=(len(built.part_a), 3))


def inverse(built: Program, part: int) -> np.ndarray:
    """Inverse of mass and inertia of a part in its counted freedoms; 0 for a held part."""
    whole = np.zeros((6, 6))
    if built.free[part]:
        whole[:3, :3] = built.mass[part] * np.eye(3)
        whole[3:, 3:] = built.inertia[part]
        count = np.ix_(built.freedoms, built.freedoms)
        small = np.linalg.inv(whole[count])
        whole = np.zeros((6, 6))
        whole[count] = small
    return whole


def lever(built: Program, row: int, part: int) -> np.ndarray:
    """Speed of a point of a part, shape (3, 6): v + omega x r; of an angular row omega."""
    if built.angular[row]:
        return np.hstack([np.zeros((3, 3)), np.eye(3)])
    x, y, z = built.point[row] - built.center[part]
    return np.hstack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]])


def sides(built: Program, row: int) -> list[tuple[int, float]]:
    pair = ((built.part_b[row], 1.0), (built.part_a[row], -1.0))
    return [(int(part), sign) for part, sign in pair if part >= 0]


def test_speeds_and_wrenches_are_those_of_levers(built):
    motion, forces = motion_and_forces(built, 1)
    speeds, wrenches = point_speeds(built, motion), point_wrenches(built, forces)
    total = np.zeros((len(built.names), 6))
    for row in range(len(built.part_a)):
        speed = sum(
            sign * lever(built, row, part) @ motion[part] for part, sign in sides(built, row)
        )
        assert np.allclose(speeds[row], speed, rtol=0, atol=1e-12 * (1 + np.abs(speed).max()))
        for part, sign in sides(built, row):
            total[part] += sign * lever(built, row, part).T @ forces[row]
    assert np.allclose(wrenches, total, rtol=0, atol=1e-12 * np.abs(total).max())


def solid_inverse(built: Program, part: int) -> np.ndarray:
    """The same with every freedom, as mobilities measure it."""
    whole = np.zeros((6, 6))
    if built.free[part]:
        whole[:3, :3] = np.eye(3) / built.mass[part]
        whole[3:, 3:] = np.linalg.inv(built.inertia[part])
    return whole


def test_mobility_is_force_in_acceleration_out(built):
    found = mobilities(built)
    for row in range(len(built.part_a)):
        arms = [(lever(built, row, part), part) for part, _ in sides(built, row)]
        whole = sum(arm @ solid_inverse(built, part) @ arm.T for arm, part in arms)
        trace = float(np.trace(whole))
        assert found[row] == pytest.approx(np.sqrt(trace / 3) if trace else 1.0, rel=1e-10)


def by_hand(built: Program, a: np.ndarray, forces: np.ndarray) -> dict[str, float]:
    """The numbers of `LawProof`, summed row by row."""
    unit = {"m": 1.0, "cm": 1e-2}[built.units]
    a = a * np.repeat([1.0, unit], 3)
    counted = np.zeros((len(built.names), 6))
    counted[np.ix_(built.free, built.freedoms)] = 1.0
    a, load = a * counted, built.load * counted
    heavy = [np.linalg.pinv(inverse(built, k)) for k in range(len(a))]
    rest = np.array([heavy[k] @ a[k] for k in range(len(a))]) - built.load
    for row in range(len(forces)):
        for part, sign in sides(built, row):
            rest[part] -= sign * lever(built, row, part).T @ forces[row]
    rest = rest * counted
    shares = np.array([load[k] @ inverse(built, k) @ load[k] for k in range(len(a))])
    total = np.sqrt(shares.sum())
    left = sum(rest[k] @ inverse(built, k) @ rest[k] for k in range(len(a)))
    energy = np.array([a[k] @ heavy[k] @ a[k] for k in range(len(a))])
    size = energy.sum() / total**2
    found = dict.fromkeys(FIELDS, 0.0) | {"balance": np.sqrt(left) / total, "size": size}
    for row, sigma in enumerate(mobilities(built)):
        u = sum(sign * lever(built, row, part) @ a[part] for part, sign in sides(built, row))
        u, f = u / sigma / total, forces[row] * sigma / total
        if built.planar:
            plane = np.array([0, 1, 0]) if built.angular[row] else np.array([1, 0, 1])
            u, f = u * plane, f * plane
        law = of_row(built, row, u, f, np.sqrt(size))
        found |= {key: max(found[key], value) for key, value in law.items()}
    pace = [
        energy[k] * built.mass[k] / built.weight[k] ** 2 if built.free[k] else 0.0
        for k in range(len(a))
    ]
    moving = [k for k in range(len(a)) if built.free[k] and pace[k] > STILL**2 * max(pace)]
    found["power"] = float((load * a).sum()) / shares[moving].sum() if moving else 0.0
    return found


def of_row(built: Program, row: int, u: np.ndarray, f: np.ndarray, fastest: float) -> dict:
    n, mu = built.normal[row], built.mu[row]
    u_n, f_n = u @ n, f @ n
    u_t, f_t = u - u_n * n, f - f_n * n
    if built.planar:
        u_t, f_t = u_t * [1, 0, 1], f_t * [1, 0, 1]
    slip, drag, limit = np.linalg.norm(u_t), np.linalg.norm(f_t), mu * max(f_n, 0.0)
    if built.two_sided[row]:
        return {"opening": abs(u_n), "cone": drag}
    law = {"opening": max(-u_n, 0.0), "cone": max(drag - limit, -f_n), "normal": abs(u_n * f_n)}
    if slip > STILL * fastest:
        law |= {
            "angle": float(np.linalg.norm(f_t + drag * u_t / slip)),
            "stretch": abs(drag - limit),
        }
    return law


@pytest.mark.parametrize("seed", range(4))
def test_each_number_is_the_sum_by_hand(built, seed):
    motion, forces = motion_and_forces(built, seed, 10.0 ** (seed - 2))
    if seed == 3:
        motion[np.flatnonzero(built.free)[:1]] *= 1e-9  # it does not count as moving
    found, expected = check_law(built, motion, forces), by_hand(built, motion, forces)
    for name in (*FIELDS, "size", "power"):
        assert getattr(found, name) == pytest.approx(expected[name], rel=1e-9, abs=1e-13), name
    assert found.residual == max(getattr(found, name) for name in FIELDS)
    assert not found.holds


@pytest.mark.parametrize("name", FIELDS)
def test_the_worst_of_the_six_counts(name):
    none = np.zeros((1, 6))
    values = dict.fromkeys(FIELDS, 0.25) | {name: 0.5}
    assert LawProof(none, none, 1.0, 1.0, **values, holds=True).residual == 0.5


def fallen(scale: float, sunk: float = 0.0) -> LawProof:
    """Parts above a distant table that fall at g, times a scale, off by a fraction."""
    one = program(stacks.block_on_slope(0.0, friction=0.5))
    lone = one.taking(np.arange(0))
    motion = np.where(lone.free[:, None], scale * np.r_[lone.gravity, 0, 0, 0], 0.0)
    motion[:, 0] += sunk * np.linalg.norm(lone.gravity) * lone.free
    return check_law(lone, motion, np.zeros((0, 3)))


def test_free_fall_obeys_the_law_up_to_its_tolerance():
    exact = fallen(1.0)
    assert exact.holds
    assert (exact.power, exact.size, exact.residual) == pytest.approx((1.0, 1.0, 0.0), abs=1e-14)
    assert fallen(1.0, 0.9 * WITNESS_EXACT).holds
    assert not fallen(1.0, 1.1 * WITNESS_EXACT).holds
    assert not fallen(-1.0).holds
    assert not fallen(0.0).holds


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_what_a_small_motion_may_leave_is_small(share):
    """A block on a slope just past its friction limit starts with 6e-5 of g."""
    built, a, forces = sliding(float(np.degrees(np.arctan(0.5))) + 3e-3, 0.5)
    exact = check_law(built, a, forces)
    assert exact.holds
    most = min(WITNESS_SLIVER * exact.size, WITNESS_EXACT * np.sqrt(exact.size))
    (k,) = np.flatnonzero(built.free)
    push = float(np.linalg.norm(forces.sum(axis=0))) / built.weight[k]
    judged = check_law(built, a, (1 + share * most / push) * forces)
    assert judged.balance == pytest.approx(share * most, rel=1e-3)
    assert judged.holds == (share < 1)


def test_a_motion_without_power_is_none():
    """Just past the limit of friction: a lawful motion with too little power."""
    for beyond, holds in ((0.9, False), (1.1, True)):
        tilt = np.arctan(0.5) + beyond * WITNESS_POWER / 0.5  # d(power)/d(tilt) is 1/2 there
        built, a, forces = sliding(float(np.degrees(tilt)), 0.5)
        law = check_law(built, a, forces)
        assert (law.power > WITNESS_POWER) == holds
        assert law.holds == holds


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_part_counts_as_moving_above_a_millionth_of_the_fastest(share):
    """At any weight: the power is relative to the moving parts."""
    lone = program(hanging_pair()).taking(np.arange(0))
    parts = np.flatnonzero(lone.free)
    for fast in parts:
        slow = parts != fast
        motion = np.zeros((len(lone.names), 6))
        motion[parts, 2] = lone.gravity[2] * np.where(slow, share * STILL, 1.0)
        heavy = float(lone.mass[parts[~slow]].sum() if share < 1 else lone.mass[parts].sum())
        power = float(lone.mass[fast] + share * STILL * lone.mass[parts[slow]].sum()) / heavy
        law = check_law(lone, motion, np.zeros((0, 3)))
        assert law.power == pytest.approx(power, rel=1e-9)


@pytest.mark.parametrize("share", [0.8, 1.2])
def test_a_sliver_of_a_motion_may_leave_a_sliver(share):
    """A speck falls beside a block at rest: the square of its share of the load counts."""
    side = 10.0 ** (-11 / 3)
    parts = [floor([-2, -2], [2, 2]), block("rock", [0, 0, 0], [1, 1, 1])]
    parts.append(block("speck", [1.5, 0, 0.5], [1.5 + side, side, 0.5 + side]))
    one = program(Assembly(parts))
    rock, speck = one.names.index("rock"), one.names.index("speck")
    up = np.where(one.part_b == rock, 1.0, -1.0)[:, None] * np.array([0.0, 0.0, 1.0])
    motion = np.zeros((3, 6))
    motion[speck, :3] = one.gravity
    size = float(one.mass[speck] / one.mass[[rock, speck]].sum())
    assert WITNESS_SLIVER * size < WITNESS_EXACT * np.sqrt(size) / 2
    off = 1 + share * WITNESS_SLIVER * size
    law = check_law(one, motion, off * one.weight[rock] / len(up) * up)
    assert law.balance == pytest.approx(share * WITNESS_SLIVER * size, rel=0.05)
    assert law.power == pytest.approx(1.0)
    assert law.holds == (share < 1)


def test_what_does_not_fit_is_no_motion(built):
    motion, forces = motion_and_forces(built, 0)
    for a, f in (
        (motion[1:], forces),
        (motion, forces[1:]),
        (np.where(np.arange(6) == 2, np.nan, motion), forces),
        (motion, np.where(np.arange(3) == 2, np.inf, forces)),
    ):
        law = check_law(built, a, f)
        assert (law.power, law.size, law.holds) == (0.0, 0.0, False)
        assert [getattr(law, name) for name in FIELDS] == [np.inf] * 6


# forces that are to balance ---------------------------------------------------------------------


def resting() -> tuple[Program, np.ndarray]:
    """A block on a table, with a quarter of its weight at each corner."""
    one = program(stacks.block_on_slope(0.0, friction=0.5))
    (k,) = np.flatnonzero(one.free)
    up = np.where(one.part_b == k, 1.0, -1.0)[:, None] * np.array([0.0, 0.0, 1.0])
    return one, one.weight[k] / 4 * up


def test_forces_that_balance_leave_nothing():
    one, forces = resting()
    assert check_balance(one, forces) == pytest.approx(0.0, abs=1e-14)
    assert check_balance(one, 1.25 * forces) == pytest.approx(0.25)
    assert check_balance(one, 0.5 * forces) == pytest.approx(0.5)
    assert check_balance(one, 0.0 * forces) == pytest.approx(1.0)


def test_a_torque_that_is_left_counts_over_the_radius():
    one, forces = resting()
    (k,) = np.flatnonzero(one.free)
    left = one.point[:, 0] < one.center[k, 0]
    moved = forces * np.where(left, 1.5, 0.5)[:, None]
    arm = float(np.abs(one.point[:, 0] - one.center[k, 0]).max())
    assert check_balance(one, moved) == pytest.approx(0.5 * arm / one.radius[k])


def test_a_force_outside_its_cone_balances_nothing():
    one, forces = resting()
    size = float(np.abs(forces[0]).max())
    for share, within in ((0.5 * (1 - 1e-9), True), (0.5 * (1 + 1e-9), False), (-0.6, False)):
        rubs = forces.copy()
        rubs[0, 0] += share * size
        rubs[1, 0] -= share * size
        assert np.isfinite(check_balance(one, rubs)) == within
    pulls = forces.copy()
    pulls[0] *= -1
    assert check_balance(one, pulls) == np.inf
    smooth = one.frictionless
    assert np.isfinite(check_balance(smooth, forces))
    assert check_balance(smooth, pulls) == np.inf
    rubs = forces.copy()
    rubs[0, 0] += 1e-9 * size
    assert check_balance(smooth, rubs) == np.inf


def test_joints_pull_but_carry_nothing_across_their_rows():
    built = program(hanging_pair())
    tied = built.two_sided
    assert tied.any()
    along = np.where(tied, -1.0, 0.0)[:, None] * built.normal
    assert np.isfinite(check_balance(built, along))
    k = int(np.flatnonzero(tied)[0])
    across = along.copy()
    across[k] += 1e-6 * np.cross(built.normal[k], [0.3, 0.5, 0.7])
    assert check_balance(built, across) == np.inf
