"""Path of a carrier: its position and orientation over time, and the accelerations on it.

A path has samples. Each sample has the orientation R of the carrier in the world and, in the frame
of the carrier, the acceleration a of its reference point [m/s^2], its angular velocity o [rad/s]
and its angular acceleration al [rad/s^2]. They come from one of two sources:

    poses            position and orientation at given times: cubic splines through them, of class
                     C2 in position (`scipy.interpolate.CubicSpline`) and in rotation
                     (`scipy.spatial.transform.RotationSpline`)
    accelerations    given beside the orientation, for instance by the planner of a robot

References
----------
F. Landis Markley, Attitude interpolation (RotationSpline of scipy).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.transport.carrier import PAIRS
from kilter.analysis.transport.path_table import columns_of, read_table
from kilter.arrays import Array
from kilter.errors import InputError
from kilter.mechanics.program import Program
from kilter.rigid import quaternion_to_matrix
from kilter.units import metres_per_unit
from kilter.validate import finite

POSITION, ORIENTATION = ("x", "y", "z"), ("qw", "qx", "qy", "qz")
ACCELERATION, SPIN, TURN = ("ax", "ay", "az"), ("ox", "oy", "oz"), ("alx", "aly", "alz")
VELOCITY = ("vx", "vy", "vz")
COLUMNS = ("time", *POSITION, *ORIENTATION, *VELOCITY, *ACCELERATION, *SPIN, *TURN)
"""Columns of a table of a path."""
LEAST = 3
"""Least number of samples through which a spline has an acceleration."""
FIXED = 1e-9
"""Orientations that differ by at most this are equal [-]."""
UNIT = 1e-3
"""Largest difference of the length of a quaternion from 1 [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class CarrierPath:
    """Accelerations of a carrier over time, as vectors in the frame of the carrier.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Increasing [s].
    rotation : ndarray, shape (n, 3, 3)
        From the frame of the carrier to the world.
    acceleration, angular_velocity, angular_acceleration : ndarray, shape (n, 3)
        Accelerations of the reference point [m/s^2], [rad/s], [rad/s^2].
    about : ndarray, shape (3,)
        Reference point in the frame of the carrier [length unit of the assembly].
    linear : bool
        True if the orientation is fixed and the acceleration changes linearly between samples.
    velocity : ndarray, shape (n, 3), optional
        Velocity of the reference point, in the frame of the carrier [m/s]; only the constraints for
        a planner of speeds need it (`Transport.rows`).
    """

    time: Array
    rotation: Array
    acceleration: Array
    angular_velocity: Array
    angular_acceleration: Array
    about: Array
    linear: bool
    velocity: Array | None = None

    def __post_init__(self) -> None:
        count = len(self.time)
        for name, shape in (
            ("time", (count,)),
            ("rotation", (count, 3, 3)),
            ("acceleration", (count, 3)),
            ("angular_velocity", (count, 3)),
            ("angular_acceleration", (count, 3)),
            ("about", (3,)),
        ):
            object.__setattr__(self, name, finite(getattr(self, name), shape, name))
        if self.velocity is not None:
            object.__setattr__(self, "velocity", finite(self.velocity, (count, 3), "velocity"))
        _require_times(self.time)

    def loads(self, program: Program) -> tuple[Array, Array]:
        """Load vector of each sample at rest, and its change per squared speed, (n, 12) each."""
        still, move = np.zeros((len(self.time), 12)), np.zeros((len(self.time), 12))
        still[:, :3] = np.einsum("nji,j->ni", self.rotation, program.gravity)
        move[:, :3] = -self.acceleration
        move[:, 3:6] = self.angular_acceleration
        spin = self.angular_velocity
        move[:, 6:] = np.column_stack([spin[:, i] * spin[:, j] for i, j in PAIRS])
        return still, move

    def starting_loads(self) -> Array:
        """Change of the load vector of each sample per unit of s'', shape (n, 12).

        s is the time of the path as a function of the true time: the carrier runs along the path
        with the speed s'. Its acceleration then contains s'' times the velocity of the path.

        Raises
        ------
        InputError
            If the velocities are not known.
        """
        if self.velocity is None:
            raise InputError(
                "the path has no velocities",
                hint="give its poses, or vx, vy, vz beside the accelerations",
            )
        start = np.zeros((len(self.time), 12))
        start[:, :3] = -self.velocity
        start[:, 3:6] = self.angular_velocity
        return start


def path_from_poses(
    time: ArrayLike, position: ArrayLike, orientation: ArrayLike | None = None, *, units: str = "m"
) -> CarrierPath:
    """Carrier path through given poses of the reference point, by cubic splines.

    Parameters
    ----------
    time : array_like, shape (n,)
        Increasing [s].
    position : array_like, shape (n, 3)
        Position of the origin of the carrier's frame, in the world [`units`].
    orientation : array_like, shape (n, 4), optional
        Quaternions w x y z from the frame of the carrier to the world; by default none turns.
    units : str
        Unit of the positions.

    Raises
    ------
    InputError
        If the times do not increase, or there are fewer than three samples.

    Examples
    --------
    >>> time = np.linspace(0, 1, 5)
    >>> position = np.column_stack([time**2, 0 * time, 0 * time])
    >>> path_from_poses(time, position).acceleration[:, 0].round(9)
    array([2., 2., 2., 2., 2.])
    """
    from scipy.spatial.transform import Rotation, RotationSpline

    time = require_samples(time)
    place = np.asarray(position, dtype=np.float64) * metres_per_unit(units)
    _, velocity, world = spline_derivatives(time, place)
    turning = np.tile([1.0, 0.0, 0.0, 0.0], (len(time), 1))
    if orientation is not None:
        turning = np.asarray(orientation, dtype=np.float64)
    rotation = np.stack(
        [quaternion_to_matrix(_unit_quaternion(q, k)) for k, q in enumerate(turning)]
    )
    fixed = bool(np.abs(rotation - rotation[0]).max() <= FIXED)
    spin = turn = np.zeros((len(time), 3))
    if not fixed:
        with finite_motion():
            turning_spline = RotationSpline(time, Rotation.from_matrix(rotation))
            # both in the frame of the carrier
            spin, turn = turning_spline(time, 1), turning_spline(time, 2)
    return CarrierPath(
        time,
        rotation,
        np.einsum("nji,nj->ni", rotation, world),
        spin,
        turn,
        np.zeros(3),
        linear=fixed,
        velocity=np.einsum("nji,nj->ni", rotation, velocity),
    )


def read_path(file: str | Path, *, units: str = "m") -> CarrierPath:
    """Read a carrier path from a table of comma-separated values with a header.

    Columns: time [s]; x y z [`units`]; optionally the orientation qw qx qy qz. Instead of x y z, or
    beside them, the accelerations ax ay az [m/s^2], with ox oy oz [rad/s] and alx aly alz
    [rad/s^2] if it turns, all in the frame of the carrier: given accelerations are used as they
    are, and splines through the poses are not computed. Velocities vx vy vz [m/s] beside the
    accelerations serve `Transport.rows` alone.

    Raises
    ------
    InputError
        If a column is unknown or missing, or a row is not a row of numbers; the message names the
        line.
    """
    return read_table(file, COLUMNS, lambda table: _path_of(table, units))


def _path_of(table: Mapping[str, Array], units: str) -> CarrierPath:
    """Carrier path of a table, from its accelerations if it has them, else from its poses."""
    turning = columns_of(table, ORIENTATION)
    along = columns_of(table, ACCELERATION)
    if along is None:
        place = columns_of(table, POSITION)
        if place is None:
            raise InputError(
                "the path has neither x, y, z nor ax, ay, az", hint="add three of these columns"
            )
        if any(columns_of(table, names) is not None for names in (VELOCITY, SPIN, TURN)):
            raise InputError(
                "vx, ox or alx come without ax, ay, az",
                hint="add the accelerations, or remove them",
            )
        return path_from_poses(table["time"], place, turning, units=units)
    time = table["time"]
    if turning is None:
        turning = np.tile([1.0, 0.0, 0.0, 0.0], (len(time), 1))
    rotation = np.stack(
        [quaternion_to_matrix(_unit_quaternion(q, k)) for k, q in enumerate(turning)]
    )
    none = np.zeros((len(time), 3))
    spin, turn = columns_of(table, SPIN), columns_of(table, TURN)
    fixed = bool(np.abs(rotation - rotation[0]).max() <= FIXED)
    spin, turn = none if spin is None else spin, none if turn is None else turn
    linear = fixed and not spin.any() and not turn.any()
    velocity = columns_of(table, VELOCITY)
    return CarrierPath(time, rotation, along, spin, turn, np.zeros(3), linear, velocity)


def _unit_quaternion(quaternion: Array, row: int) -> Array:
    """Scale a quaternion to length 1; raises an error if its length is not about 1."""
    size = float(np.linalg.norm(quaternion))
    if abs(size - 1.0) > UNIT:
        raise InputError(
            f"the quaternion of sample {row + 1} has the length {size:.4g}",
            hint="give qw, qx, qy, qz of length 1",
        )
    unit: Array = quaternion / size
    return unit


@contextmanager
def finite_motion() -> Iterator[None]:
    """Turn the errors of splines through samples that are too far apart into an `InputError`.

    The errors are those of scipy: numbers that are not finite, and singular matrices.
    """
    try:
        with np.errstate(all="ignore"):
            yield
    except (ValueError, np.linalg.LinAlgError):
        raise InputError(
            "the path has no finite accelerations", hint="check the units of its times and poses"
        ) from None


def spline_derivatives(time: Array, values: Array) -> tuple[Array, Array, Array]:
    """Values, first and second derivatives at the samples of a cubic spline, each of one shape.

    Arguments: `time` (n,); `values` (n, ...). Raises `InputError` if the derivatives are not
    finite.
    """
    from scipy.interpolate import CubicSpline

    with finite_motion():
        spline = CubicSpline(time, values)
        derivatives = np.array([spline(time, order) for order in range(3)])
        if not np.isfinite(derivatives).all():
            raise ValueError
    return derivatives[0], derivatives[1], derivatives[2]


def require_samples(time: ArrayLike) -> Array:
    """Times of the samples of a spline, shape (n,): increasing, and enough for an acceleration.

    Raises `InputError` if the times do not increase, or there are fewer than three.
    """
    seconds = np.asarray(time, dtype=np.float64)
    _require_times(seconds)
    if len(seconds) < LEAST:
        raise InputError(
            f"a path of {len(seconds)} samples has no acceleration", hint=f"give at least {LEAST}"
        )
    return seconds


def _require_times(time: Array) -> None:
    """Reject the times of a path if they do not increase."""
    if not len(time) or not np.isfinite(time).all():
        raise InputError("the path has no times", hint="give finite times in seconds")
    late = np.flatnonzero(np.diff(time) <= 0.0)
    if len(late):
        k = int(late[0])
        raise InputError(
            f"the time of sample {k + 2} is {time[k + 1]:g} s, after {time[k]:g} s",
            hint="give increasing times",
        )
