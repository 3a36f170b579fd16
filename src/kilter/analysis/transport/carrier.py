"""Loads on the parts of an assembly that rides on an accelerated carrier.

The frame of the assembly is fixed in the carrier. Its reference point p has the acceleration a; the
carrier has the angular velocity o and the angular acceleration al, all in this frame. A part at
rest in the carrier (mass m, centre of mass c, inertia I about c) feels, with r = c - p,

    force     m (g - a - al x r - o x (o x r))
    torque    -(I al + o x I o)                    about c

With O = o o' these are linear in y = (a, al, O), twelve numbers, because

    o x (o x r) = (O - tr(O) 1) r,      o x I o = vector of the skew part of O I

The load is therefore w(g) + B y, and the set of y that contacts carry is convex.

Units: a [m/s^2], o [rad/s], al [rad/s^2], p and r in the length unit of the assembly.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.decision.motion import find_motion_with_friction, round_mantle
from kilter.analysis.load_limit import Limit, starting, with_more
from kilter.arrays import Array, Mask, cross
from kilter.assembly import Assembly, Load
from kilter.errors import InputError
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.program import Program
from kilter.rigid import skew
from kilter.tell.record import Record
from kilter.tell.words import motion_words
from kilter.units import metres_per_unit
from kilter.validate import frozen, in_range

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Entries (row, column) of the symmetric matrix O = o o' in the order of the load vector."""


@dataclass(frozen=True, slots=True, eq=False)
class CarrierMotion:
    """Accelerations and rotation of a carrier at an instant, in the frame of the assembly.

    Parameters
    ----------
    acceleration : array_like, shape (3,)
        Acceleration of the reference point [m/s^2].
    angular_velocity : array_like, shape (3,)
        [rad/s]
    angular_acceleration : array_like, shape (3,)
        [rad/s^2]
    about : array_like, shape (3,)
        Reference point [length unit of the assembly].

    Examples
    --------
    >>> CarrierMotion([1.0, 0, 0]).turns
    False
    """

    acceleration: ArrayLike = (0.0, 0.0, 0.0)
    angular_velocity: ArrayLike = (0.0, 0.0, 0.0)
    angular_acceleration: ArrayLike = (0.0, 0.0, 0.0)
    about: ArrayLike = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name, words in (
            ("acceleration", "the acceleration of the carrier"),
            ("angular_velocity", "the angular velocity of the carrier"),
            ("angular_acceleration", "the angular acceleration of the carrier"),
            ("about", "the reference point of the carrier"),
        ):
            vector = frozen(getattr(self, name), (3,), words)
            if not np.isfinite(vector).all():
                raise InputError(f"{words} is {vector.tolist()}", hint="give three finite numbers")
            in_range(vector, words)
            object.__setattr__(self, name, vector)

    @property
    def turns(self) -> bool:
        """True if the carrier has an angular velocity or an angular acceleration."""
        return bool(np.any(self.angular_velocity) or np.any(self.angular_acceleration))

    def require_in_plane(self, planar: bool) -> None:
        """Reject a carrier motion that leaves the x-z plane of a planar assembly.

        Raises
        ------
        InputError
            Naming the vector that leaves the plane.
        """
        if not planar:
            return
        along, spin = np.asarray(self.acceleration), np.asarray(self.angular_velocity)
        turn = np.asarray(self.angular_acceleration)
        if along[1] != 0.0:
            raise InputError(
                f"the acceleration {along.tolist()} leaves the x-z plane of this planar assembly",
                hint="give it y = 0",
            )
        if spin[[0, 2]].any() or turn[[0, 2]].any():
            raise InputError(
                "the carrier of a planar assembly turns about y only",
                hint="give angular vectors with x = z = 0",
            )


def carrier_wrench(program: Program, motion: CarrierMotion) -> Array:
    """Inertial load that a carrier motion adds to each part, shape (N, 6).

    Force [N] and torque about the centre of mass [N x length unit]; zero for held parts. Gravity is
    not included.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import stacks
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> pull = carrier_wrench(program, CarrierMotion([2.0, 0, 0]))[1]
    >>> bool(pull[0] == -2.0 * program.mass[1])
    True
    """
    return _wrench(
        program.center,
        program.mass,
        program.inertia,
        program.free,
        motion,
        metres_per_unit(program.units),
    )


def carried_assembly(assembly: Assembly, motion: CarrierMotion) -> Assembly:
    """A stationary assembly with the same loads as the assembly on its moving carrier.

    Gravity becomes g - a. If the carrier turns, each free part gets the further force and torque as
    a load at its centre of mass.

    Raises `InputError` if the carrier falls freely, so that no gravity remains.
    """
    felt = assembly.gravity - np.asarray(motion.acceleration)
    if not felt.any():
        raise InputError(
            "the carrier falls freely, so no part has weight", hint="give another acceleration"
        )
    if not motion.turns:
        return dataclasses.replace(assembly, gravity=felt)
    geometry = assembly.geometry
    turning = CarrierMotion(
        (0.0, 0.0, 0.0), motion.angular_velocity, motion.angular_acceleration, motion.about
    )
    wrench = _wrench(
        geometry.center,
        geometry.mass,
        geometry.inertia,
        ~geometry.grounded,
        turning,
        metres_per_unit(assembly.units),
    )
    loads = [
        Load(part.name, force=wrench[k, :3], torque=wrench[k, 3:])
        for k, part in enumerate(assembly.parts)
        if wrench[k].any()
    ]
    return dataclasses.replace(assembly, gravity=felt, loads=[*assembly.loads, *loads])


def _wrench(
    center: Array, mass: Array, inertia: Array, free: Mask, motion: CarrierMotion, metres: float
) -> Array:
    """Inertial load that a carrier motion causes on each part, shape (N, 6).

    The parts are given by centre, mass [kg] and inertia.
    """
    spin, turn = np.asarray(motion.angular_velocity), np.asarray(motion.angular_acceleration)
    arm = center - np.asarray(motion.about)
    centripetal = cross(np.broadcast_to(spin, arm.shape), cross(spin, arm))
    tangential = cross(np.broadcast_to(turn, arm.shape), arm)
    wrench = np.zeros((len(mass), 6))
    acceleration = np.asarray(motion.acceleration) + metres * (tangential + centripetal)
    wrench[:, :3] = -mass[:, None] * acceleration
    # inertia is in kg x length unit^2 and a torque in N x length unit, so one length becomes metres
    momentum = inertia @ spin
    gyroscopic = cross(np.broadcast_to(spin, momentum.shape), momentum)
    wrench[:, 3:] = -metres * (inertia @ turn + gyroscopic)
    wrench[~free] = 0.0
    return wrench


def load_matrix(program: Program, about: Array) -> Array:
    """Matrix from gravity and carrier motion to the load of each part, shape (N, 6, 12).

    It acts on z = (g - a, al, O) and is zero for held parts.

    Arguments: `about` (3,): reference point of the motion [length unit].

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import stacks
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> matrix = load_matrix(program, np.zeros(3))
    >>> motion = CarrierMotion([1.0, 2, 3], [0.3, -0.2, 0.5], [0.7, 0.1, -0.4])
    >>> spin = np.asarray(motion.angular_velocity)
    >>> squares = [spin[i] * spin[j] for i, j in PAIRS]
    >>> z = np.concatenate([-np.asarray(motion.acceleration), motion.angular_acceleration, squares])
    >>> bool(np.allclose(matrix @ z, carrier_wrench(program, motion)))
    True
    """
    metres = metres_per_unit(program.units)
    count = len(program.names)
    mass, inertia = program.mass[:, None, None], program.inertia
    arm = program.center - about
    matrix = np.zeros((count, 6, 12))
    matrix[:, :3, :3] = mass * np.eye(3)
    matrix[:, :3, 3:6] = metres * mass * skew(arm)  # -al x r = r x al
    matrix[:, 3:, 3:6] = -metres * inertia
    for k, (i, j) in enumerate(PAIRS, start=6):
        square = np.zeros((3, 3))
        square[i, j] = square[j, i] = 1.0
        matrix[:, :3, k] = -metres * mass[:, 0] * (arm @ (square - np.trace(square) * np.eye(3)))
        skewed = square @ inertia
        matrix[:, 3:, k] = metres * np.stack(
            [
                skewed[:, 2, 1] - skewed[:, 1, 2],
                skewed[:, 0, 2] - skewed[:, 2, 0],
                skewed[:, 1, 0] - skewed[:, 0, 1],
            ],
            axis=1,
        )
    matrix[~program.free] = 0.0
    return matrix


# How parts start to move just beyond a limit of transport.


BEYOND = 1e-3
"""Excess of the load over the limit at which the motion is computed [-]."""
MOST_POINTS = 150
"""Number of contact points above which the motion is not computed; it would take seconds."""
EFFORT = 0.2
"""Effort of the search for the motion at a limit: an answer has up to eight."""


class FirstMotion(Record):
    """How a part starts to move, in words."""

    part: str
    """Name of the part."""
    words: str
    """The motion, such as "slides +x"."""


def first_motions(assembly: Assembly, limit: Limit, carried: CarrierMotion) -> list[FirstMotion]:
    """How the parts start to move beyond a limit of a carrier motion, the fastest first."""
    program = limit.program
    if limit.motion is None:
        return []
    found = _by_the_law(program, limit, carried)
    dilates = found is None and bool(program.mu.any())
    motion = limit.motion.motion if found is None else found
    names = set(starting(program, limit.motion))
    size = part_sizes(program, motion, per_radius=False)
    if found is not None:
        names = {name for k, name in enumerate(program.names) if size[k] > 0}
    order = [k for k in np.argsort(-size, kind="stable") if program.names[k] in names]
    metres = metres_per_unit(program.units)
    words = []
    for k in order:
        turn = float(np.linalg.norm(motion[k, 3:])) * program.radius[k]
        relative = np.array([np.linalg.norm(motion[k, :3]), turn])
        twist = np.concatenate([motion[k, :3] * metres, motion[k, 3:]])
        phrase = motion_words(
            twist,
            relative,
            program.down,
            center=program.center[k],
            unit=metres,
            sizes=False,
            mantle=round_mantle(assembly.parts[k]),
        )
        phrase = kind_of_motion(phrase) if dilates else phrase
        words.append(FirstMotion(part=program.names[k], words=phrase))
    return words


def kind_of_motion(words: str) -> str:
    """Name of a motion, such as "slides" or "tips", without its direction."""
    return words.split(maxsplit=1)[0]


def _by_the_law(program: Program, limit: Limit, carried: CarrierMotion) -> Array | None:
    """Motion that obeys the law of friction just beyond a limit, shape (N, 6), or None.

    Translations [length unit] and rotations [rad] of any common size; 0 for parts at rest.
    """
    modelled = not (len(program.bounded) or program.cohesion.any() or program.tied.any())
    few = 0 < len(program.part_a) <= MOST_POINTS
    if not (modelled and few and program.mu.any() and np.isfinite(limit.value)):
        return None
    share = limit.value + BEYOND * max(abs(limit.value), BEYOND)
    beyond = with_more(program, carrier_wrench(program, carried), share)
    found = find_motion_with_friction(beyond, EFFORT)
    if found is None or not found.moves.any():
        return None
    return found.screws(metres_per_unit(program.units))
