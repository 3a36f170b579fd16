"""Path of a carrier on the flange of a robot, from the values of its joints over time.

Cubic splines of class C2 run through the values q of each joint. The motion of the flange follows
from q, q', q'' without differences, joint by joint from the root. A fixed transform moves the
reference point by d (world frame) with its link,

    v += o x d,      a += al x d + o x (o x d)

a turning joint with the axis z adds

    al += z q'' + o x z q',     o += z q'

and a sliding joint moves the point by d = z q and adds, beside the terms of d above,

    v += z q',       a += z q'' + 2 o x z q'

References
----------
J. Y. S. Luh, M. W. Walker, R. P. C. Paul, On-line computational scheme for mechanical manipulators,
1980: forward recursion of velocities and accelerations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.transport.carrier_path import (
    CarrierPath,
    require_samples,
    spline_derivatives,
)
from kilter.analysis.transport.path_table import read_table
from kilter.arrays import Array, cross
from kilter.errors import InputError
from kilter.files.robots.urdf_chain import ChainJoint, JointChain, read_joint_chain
from kilter.rigid import skew

ROUNDED = 1e-6
"""Distance by which a joint value may exceed its range, because tables are rounded [rad or m]."""


@dataclass(frozen=True, slots=True, eq=False)
class FlangeMotion:
    """Motion of a link over time, in the world frame of the robot."""

    rotation: Array
    """From the frame of the link to the world, shape (n, 3, 3)."""
    position: Array
    """Position of the origin of the link [m], shape (n, 3)."""
    velocity: Array
    """Velocity of this origin [m/s], shape (n, 3)."""
    acceleration: Array
    """Acceleration of this origin [m/s^2], shape (n, 3)."""
    spin: Array
    """Angular velocity [rad/s], shape (n, 3)."""
    turn: Array
    """Angular acceleration [rad/s^2], shape (n, 3)."""


def flange_motion(
    chain: JointChain,
    values: Mapping[str, Array],
    rates: Mapping[str, Array],
    accelerations: Mapping[str, Array],
) -> FlangeMotion:
    """Motion of the last link of a chain from joint values, their rates and accelerations.

    Arguments: `values`, `rates`, `accelerations` (n,): q [rad or m], q' and q'' [per s, per s^2] of
    each driving joint.
    """
    count = len(next(iter(values.values())))
    rotation = np.tile(np.eye(3), (count, 1, 1))
    place, velocity, along, spin, turn = np.zeros((5, count, 3))
    for joint in chain.joints:
        moves = joint.turns or joint.slides
        none = np.zeros(count)
        q = joint.multiplier * values[joint.driver] + joint.offset if moves else none
        rate = joint.multiplier * rates[joint.driver] if moves else none
        second = joint.multiplier * accelerations[joint.driver] if moves else none
        axis = rotation @ (joint.origin.matrix @ joint.axis)
        shift = rotation @ joint.origin.position + (axis * q[:, None] if joint.slides else 0.0)
        place = place + shift
        velocity = velocity + cross(spin, shift)
        along = along + cross(turn, shift) + cross(spin, cross(spin, shift))
        rotation = rotation @ joint.origin.matrix
        if joint.slides:
            along = along + axis * second[:, None] + 2 * cross(spin, axis * rate[:, None])
            velocity = velocity + axis * rate[:, None]
        if joint.turns:
            turn = turn + axis * second[:, None] + cross(spin, axis * rate[:, None])
            spin = spin + axis * rate[:, None]
            rotation = rotation @ _turns_about(joint.axis, q)
    return FlangeMotion(rotation, place, velocity, along, spin, turn)


def _turns_about(axis: Array, angle: Array) -> Array:
    """Rotations by angles, shape (n,), about a unit axis, shape (n, 3, 3): Rodrigues."""
    across = skew(axis)
    sine, rest = np.sin(angle)[:, None, None], (1.0 - np.cos(angle))[:, None, None]
    turns: Array = np.eye(3) + sine * across + rest * (across @ across)
    return turns


def path_from_joints(
    chain: JointChain, time: ArrayLike, values: Mapping[str, ArrayLike]
) -> CarrierPath:
    """Path of a carrier whose frame is that of the last link of a chain, by cubic splines.

    Parameters
    ----------
    chain : JointChain
    time : array_like, shape (n,)
        Increasing [s].
    values : mapping of str to array_like, shape (n,)
        Values of each driving joint [rad or m].

    Raises
    ------
    InputError
        If the times do not increase, there are fewer than three samples, values of a joint are
        missing, or a value is outside the range of its joint.
    """
    seconds = require_samples(time)
    if not chain.drivers:
        raise InputError(
            "no joint moves the flange", hint="give a link behind a joint that turns or slides"
        )
    missing = [name for name in chain.drivers if name not in values]
    if missing:
        raise InputError(
            f"the path has no column for the joint {missing[0]}",
            hint="give the values of every joint between the root and the flange",
        )
    given = {name: np.asarray(values[name], dtype=np.float64) for name in chain.drivers}
    for joint in chain.joints:
        _require_in_range(joint, seconds, given)
    derivatives = {name: spline_derivatives(seconds, value) for name, value in given.items()}
    values, rates, second = ({n: d[k] for n, d in derivatives.items()} for k in range(3))
    with np.errstate(all="ignore"):  # the path rejects numbers that are not finite
        motion = flange_motion(chain, values, rates, second)

    def in_carrier(vectors: Array) -> Array:
        turned: Array = np.einsum("nji,nj->ni", motion.rotation, vectors)
        return turned

    return CarrierPath(
        seconds,
        motion.rotation,
        in_carrier(motion.acceleration),
        in_carrier(motion.spin),
        in_carrier(motion.turn),
        np.zeros(3),
        linear=False,
        velocity=in_carrier(motion.velocity),
    )


def _require_in_range(joint: ChainJoint, time: Array, values: Mapping[str, Array]) -> None:
    """Reject values outside the range of a joint."""
    if not (joint.turns or joint.slides):
        return
    q = joint.multiplier * values[joint.driver] + joint.offset
    least, largest = joint.range
    outside = np.flatnonzero((q < least - ROUNDED) | (q > largest + ROUNDED))
    if len(outside):
        k = int(outside[0])
        kind = "radians" if joint.turns else "metres"
        raise InputError(
            f"the joint {joint.name} is at {q[k]:g} at {time[k]:g} s, outside its range of "
            f"{least:g} to {largest:g}",
            hint=f"give values in {kind}, within the range of the joint",
        )


def read_robot_path(file: str | Path, robot: str | Path, flange: str) -> CarrierPath:
    """Read a table of joint values over time, for a carrier that is the flange of a robot.

    The columns are time [s] and a column with the name of each joint between the root and the
    flange [rad or m]. Columns of other joints of the robot are ignored. The frame of the assembly
    is that of the flange.

    Parameters
    ----------
    file : str or Path
        Comma-separated values with a header.
    robot : str or Path
        URDF file.
    flange : str
        Name of the link on which the assembly stands.

    Raises
    ------
    InputError
        As `kilter.files.robots.urdf_chain.read_joint_chain`, or if the table is invalid.
    """
    chain = read_joint_chain(robot, flange)
    return read_table(
        file,
        ("time", *dict.fromkeys((*chain.movable, *chain.drivers))),
        lambda table: path_from_joints(chain, table["time"], table),
    )
