"""Does the weight itself produce the friction that holds? Measured and closed-form limits."""

import numpy as np
import pytest
from cases import random_block
from held_or_not import cylinders, equilibrium, program, slope, thin_bracket

from kilter.assembly import Joint
from kilter.friction.seating import find_seating
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.law_check import check_balance
from kilter.scenes import arches, friction, stacks, traps, walls, wedges


def in_cones_and_balanced(built, seating):
    """Check the forces by explicit formulas."""
    along = (built.normal * seating.forces).sum(axis=1)
    across = np.linalg.norm(seating.forces - along[:, None] * built.normal, axis=1)
    inside = (along >= 0) & (across <= built.mu * along * (1 + 1e-12) + 1e-12 * along.max())
    total = np.zeros((len(built.names), 6))
    for part, sign in ((built.part_b, 1.0), (built.part_a, -1.0)):
        torque = np.cross(built.point - built.center[part], seating.forces)
        np.add.at(total, part, sign * np.hstack([seating.forces, torque]))
    rest = part_sizes(built, total + built.load, per_radius=True)[built.free]
    return bool(inside.all() and (rest <= 1e-9 * built.weight[built.free]).all())


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("assembly", "seated"),
    [
        (slope(26.5), True),
        (slope(26.6), False),  # atan 0.5 = 26.565
        (friction.trough(30, tilt=44.10, friction=0.84), True),
        (friction.trough(30, tilt=44.15, friction=0.84), False),
        (friction.trough(60, tilt=59.2, friction=0.84), True),
        (friction.trough(60, tilt=59.3, friction=0.84), False),
        (thin_bracket(1.02), True),
        (thin_bracket(1.1), True),
        (thin_bracket(0.98), False),
        (friction.ladder(51.36, planar=False), True),
        (friction.ladder(51.32, planar=False), False),  # 51.3402
        (friction.ladder(51.36), True),
        (friction.ladder(51.32), False),
        (cylinders(0.2681, 0.0895), True),
        (cylinders(0.2678, 0.0895), False),  # 2 - sqrt 3 = 0.267949
        (cylinders(0.2681, 0.0892), False),  # (2 - sqrt 3) / 3 = 0.089316
    ],
)
def test_both_sides_of_a_limit(assembly, seated):
    built = program(assembly)
    seating = find_seating(built)
    assert seating.holds == seated
    assert (seating.residual <= 1e-9) == seated
    assert (seating.runaway is None) == seated
    assert seating.seated == ("yes" if seated else "runs-away")
    assert in_cones_and_balanced(built, seating) == seated


@pytest.mark.slow
@pytest.mark.parametrize("pad", [0.1, 0.3])
def test_wide_pads_press_evenly_and_so_need_more(pad):
    """Elastic pads from z = h/2 to h/2 + p press in proportion to z: the bracket is higher."""
    ends = np.array([0.5, 0.5 + pad])
    least = 2 * (ends**2).sum() / ends.sum() * 0.5 / 0.6
    for factor, seated in ((1.02, True), (0.99, False)):
        built = program(friction.bracket(factor * least, friction=0.6, pad=pad))
        assert equilibrium(built)
        assert find_seating(built, starts=12).holds == seated


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "assembly",
    [
        friction.h_block(),
        friction.h_block(planar=True),
        friction.a_block(),
        friction.squeezed_row(4),
        friction.squeezed_row(5, thickness=0.3, height=0.4, friction=0.7),
    ],
    ids=["H", "planar H", "A", "books", "flat arch"],
)
def test_held_by_squeeze_alone_is_not_seated(assembly):
    built = program(assembly)
    assert equilibrium(built)
    seating = find_seating(built)
    assert not seating.holds
    assert seating.starts == 6
    assert float((built.load * seating.runaway).sum()) > 0


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    "assembly",
    [
        friction.v_block(),
        friction.v_block(friction=0.5),
        stacks.tower(10),
        arches.arch(20, ratio=0.15, friction=0.7),
        arches.arch(20, ratio=0.11, friction=0.7),
        wedges.keystone(15, friction=0.1),
        walls.wall(6, 6, friction=0.6),
        walls.tilted_wall(5.0),
        friction.books(4),
    ],
    ids=["V", "V rough", "tower", "arch", "thin arch", "keystone", "wall", "tilted", "pressed"],
)
def test_what_rests_is_seated(assembly):
    built = program(assembly)
    seating = find_seating(built)
    assert seating.holds
    assert in_cones_and_balanced(built, seating)


@pytest.mark.slow
def test_seated_implies_equilibrium_for_blocks_at_random():
    rng = np.random.default_rng(5)
    counts = {True: 0, False: 0}
    for _ in range(20):
        assembly = random_block(rng, 3).with_down([rng.normal(), 0, -1])
        built = program(assembly)
        seated = find_seating(built).holds
        counts[seated] += 1
        assert equilibrium(built) or not seated
    assert min(counts.values()) >= 4


def test_a_joint_carries():
    floating = traps.floating_block(2)
    assert not find_seating(program(floating)).holds
    loose = [part.name for part in floating.parts if not part.grounded]
    tied = floating._replace(joints=[Joint(("ground", name)) for name in loose])
    seating = find_seating(program(tied))
    assert seating.holds
    assert seating.starts == 1


def test_one_force_flipped_does_not_balance():
    built = program(slope(20))
    seating = find_seating(built)
    assert check_balance(built, seating.forces) <= 1e-9
    most = np.abs(seating.forces).max()
    for k, axis in np.argwhere(np.abs(seating.forces) > 1e-3 * most):
        forces = seating.forces.copy()
        forces[k, axis] *= -1
        assert check_balance(built, forces) > 1e-3


def test_nothing_free_is_seated_and_no_work_leaves_one_start():
    held = friction.h_block().with_grounded(["*"])
    assert find_seating(program(held)).holds
    assert find_seating(program(friction.h_block()), work=0).starts == 1
