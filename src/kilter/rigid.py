"""Rotations, poses of parts, and common frames of normals.

    x_world = R x_part + t,     R from the unit quaternion (w, x, y, z)

Angles are radians. A twist is (linear, angular), a wrench (force, torque).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index
from kilter.errors import InputError
from kilter.validate import finite, frozen, in_range
from kilter.values.guesses import guarded
from kilter.values.value import Value

UP: dict[str, tuple[float, float, float]] = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}
"""Unit vector of each value of the option `up`."""
SAMPLE = 2000
"""Approximate number of normals that are sampled for the common frame."""
ALL_PAIRS = 300
"""Largest number of normals for which every pair is compared."""
FRAME_SQUARE = 1e-3
"""Largest |cosine| at which a normal counts as perpendicular to the most common normal [-]."""
FRAME_ALIKE = 1e-10
"""Largest 1 - |cosine| at which two normals count as equal [-]."""
FRAME_TIE = 1e-12
"""Areas within this fraction of the largest count as equal [-]."""

ORTHOGONAL = 1e-6
"""Tolerance for the entries of R R^T - 1 of a rotation matrix R [-]."""


def skew(v: ArrayLike) -> Array:
    """Cross-product matrices: ``skew(v) @ u == cross(v, u)``; shape (..., 3, 3).

    Examples
    --------
    >>> skew([1.0, 2.0, 3.0]) @ [1.0, 2.0, 3.0]
    array([0., 0., 0.])
    """
    v = np.asarray(v, dtype=np.float64)
    matrix = np.zeros((*v.shape, 3))
    matrix[..., 0, 1], matrix[..., 0, 2] = -v[..., 2], v[..., 1]
    matrix[..., 1, 0], matrix[..., 1, 2] = v[..., 2], -v[..., 0]
    matrix[..., 2, 0], matrix[..., 2, 1] = -v[..., 1], v[..., 0]
    return matrix


def unit(v: ArrayLike, what: str = "direction") -> Array:
    """Normalise a vector to length 1, shape (3,); a zero vector raises an error.

    Raises
    ------
    InputError
        If the vector is zero or not finite.
    """
    v = frozen(v, (3,))
    largest = float(np.abs(v).max())
    if not np.isfinite(largest) or largest == 0.0:
        raise InputError(
            f"{what} is {v.tolist()}", hint="give three finite numbers, not all of them zero"
        )
    if not 1e-150 < largest < 1e150:  # the square would overflow or underflow
        v = frozen(v / largest)
    length = float(np.linalg.norm(v))
    # a unit vector is returned unchanged, so that writing and reading a file keeps every digit
    return v if abs(length - 1.0) <= 4e-16 else frozen(v / length)


def turn_of(rotation: Array) -> Array:
    """Rotation matrix, shape (3, 3), of a rotation vector [rad]."""
    angle = float(np.linalg.norm(rotation))
    if angle == 0.0:
        return np.eye(3)
    across = skew(rotation / angle)
    turn: Array = np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across
    return turn


def quaternion_to_matrix(quaternion: ArrayLike) -> Array:
    """Rotation matrices, shape (..., 3, 3), from quaternions (w, x, y, z) of any length.

    Examples
    --------
    >>> quaternion_to_matrix([2.0, 0.0, 0.0, 0.0])
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    """
    q = np.asarray(quaternion, dtype=np.float64)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    w, x, y, z = q.tolist() if q.ndim == 1 else np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.ascontiguousarray(np.moveaxis(np.array(rows), (0, 1), (-2, -1)))


def rotation_between(a: ArrayLike, b: ArrayLike) -> Array:
    """Quaternion (w, x, y, z) of the smallest rotation that takes direction `a` to `b`.

    For opposite directions it is a half turn about x, or about z if `a` is nearly along x.

    Examples
    --------
    >>> rotation_between([0, 0, 1], [0, 0, -1])
    array([0., 1., 0., 0.])
    """
    a, b = unit(a), unit(b)
    q = np.array([1.0 + a @ b, *np.cross(a, b)])
    if np.linalg.norm(q) < 1e-12:
        axis = np.array([1.0, 0, 0]) if abs(a[0]) < 0.9 else np.array([0, 0, 1.0])
        axis = axis - (axis @ a) * a
        q = np.array([0.0, *axis])
    return q / float(np.linalg.norm(q))


def in_brackets(values: ArrayLike) -> str:
    """Format a vector as text in brackets, with six digits.

    Examples
    --------
    >>> in_brackets([0.5, -0.0, 1 / 3])
    '(0.5, 0, 0.333333)'
    """
    return "(" + ", ".join(f"{value + 0.0:.6g}" for value in np.asarray(values).ravel()) + ")"


def matrix_to_quaternion(matrix: ArrayLike) -> Array:
    """Unit quaternion (w, x, y, z), w >= 0, of a rotation matrix, shape (3, 3).

    Raises `InputError` if the matrix is not a rotation: it scales, shears or mirrors.

    Examples
    --------
    >>> matrix_to_quaternion([[0, -1, 0], [1, 0, 0], [0, 0, 1]]).round(6)
    array([0.707107, 0.      , 0.      , 0.707107])
    """
    m = frozen(matrix, (3, 3))
    if not (np.abs(m @ m.T - np.eye(3)) <= ORTHOGONAL).all() or np.linalg.det(m) < 0:
        raise InputError(
            "the matrix is not a rotation",
            hint="give a matrix that neither scales, shears nor mirrors",
        )
    xx, yy, zz = np.diag(m)
    # (2 q_k)^2 of each component; dividing by the largest avoids cancellation
    squares = np.array([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz])
    skewed = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    products = m + m.T
    k = int(squares.argmax())
    q = np.array([squares[0], *skewed]) if k == 0 else np.array([skewed[k - 1], *products[k - 1]])
    if k:
        q[k] = squares[k]
    q = q / float(np.linalg.norm(q))
    return q if q[0] >= 0 else -q


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Pose(Value):
    """Pose of a part: the shape is rotated about its own origin, then shifted; x -> R x + p.

    Parameters
    ----------
    position : array_like, shape (3,), or (4, 4) without a rotation
        Position of the shape's origin, world frame [length unit], or a rigid transform.
    rotation : array_like, shape (4,)
        Quaternion w x y z of any length but zero.

    Raises
    ------
    InputError
        If a number is not finite or the quaternion is zero.

    Examples
    --------
    >>> Pose(position=[0, 0, 5]).apply([[1, 0, 0]])
    array([[1., 0., 5.]])
    >>> quarter = Pose.from_matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    >>> quarter
    Pose(position=(0, 0, 0), rotation=(0.707107, 0, 0, 0.707107))
    >>> Pose([0, 0, 5]) @ quarter
    Pose(position=(0, 0, 5), rotation=(0.707107, 0, 0, 0.707107))
    >>> (Pose([0, 0, 5]) @ quarter).inverse()
    Pose(position=(0, 0, -5), rotation=(0.707107, 0, 0, -0.707107))
    """

    position: Any = field(default=(0.0, 0.0, 0.0))
    rotation: Any = field(default=(1.0, 0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        if np.shape(self.position) == (4, 4):
            whole = Pose.from_matrix(self.position)
            object.__setattr__(self, "position", whole.position)
            object.__setattr__(self, "rotation", whole.rotation)
        position, rotation = frozen(self.position, (3,)), frozen(self.rotation, (4,))
        if not math.isfinite(sum(position.tolist()) + sum(rotation.tolist())):
            raise InputError("pose has a number that is not finite", hint="give finite numbers")
        in_range(position, "position of the pose", tiny=True)
        in_range(rotation, "rotation of the pose")
        if not rotation.any():
            raise InputError("rotation is the zero quaternion", hint="no turn is [1, 0, 0, 0]")
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rotation", rotation)

    @classmethod
    def of(cls, pose: Any) -> Pose:
        """Convert a pose, a position (3 numbers) or a matrix (3 x 3 or 4 x 4) to a `Pose`.

        Raises
        ------
        InputError
            If the argument is of another kind, or the matrix scales, shears or mirrors.
        """
        if isinstance(pose, Pose):
            return pose
        shape = np.shape(pose) if isinstance(pose, np.ndarray | list | tuple) else ()
        if shape == (3,):
            return cls(pose)
        if shape not in ((3, 3), (4, 4)):
            raise InputError(
                f"a pose is {repr(pose)[:60]}",
                hint="give a kilter.Pose, a position, a 3 x 3 rotation, or a 4 x 4 transform",
            )
        return cls.from_matrix(pose)

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> Pose:
        """Make a pose from a rotation matrix (3 x 3) or a rigid transform (4 x 4).

        Raises
        ------
        InputError
            If the matrix has another shape, or it scales, shears or mirrors.
        """
        shape = np.shape(matrix)
        rows = frozen(matrix, (4, 4) if shape == (4, 4) else (3, 3), "matrix of a pose")
        if shape == (4, 4) and rows[3].tolist() != [0, 0, 0, 1]:
            raise InputError(
                f"the last row of a transform is {rows[3].tolist()}", hint="give 0, 0, 0, 1"
            )
        position = rows[:3, 3] if shape == (4, 4) else (0.0, 0.0, 0.0)
        return cls(position, matrix_to_quaternion(rows[:3, :3]))

    @classmethod
    def from_euler(
        cls, angles: ArrayLike, position: ArrayLike = (0.0, 0.0, 0.0), *, axes: str = "xyz"
    ) -> Pose:
        """Make a pose from three turns about axes: roll, pitch and yaw by default.

        Parameters
        ----------
        angles : array_like, shape (3,)
            Angles of the turns [rad].
        position : array_like, shape (3,)
            Position of the shape's origin, world frame [length unit].
        axes : str
            Axes of the turns in order. Lower case: axes of the world, as in URDF; upper case: axes
            that turn with the part.

        Raises
        ------
        InputError
            If the axes are invalid, or a number is not finite.

        Examples
        --------
        >>> Pose.from_euler([0, 0, np.pi / 2]).apply([1, 0, 0]).round(12) + 0.0
        array([0., 1., 0.])
        """
        from scipy.spatial.transform import Rotation

        turns = finite(angles, (3,), "angles")
        try:
            x, y, z, w = Rotation.from_euler(axes, turns).as_quat().tolist()
        except (TypeError, ValueError):
            raise InputError(
                f"axes are {axes!r:.40}", hint='give three axes, as in "xyz" or "ZYX"'
            ) from None
        return cls(position, (w, x, y, z))

    def __matmul__(self, other: Pose) -> Pose:
        """Combined pose, which applies `other` first and then this pose."""
        if not isinstance(other, Pose):
            return NotImplemented
        p, q = (pose.rotation / np.linalg.norm(pose.rotation) for pose in (self, other))
        real = p[0] * q[0] - p[1:] @ q[1:]
        rotation = np.array([real, *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])
        return Pose(self.apply(other.position), rotation / np.linalg.norm(rotation))

    def inverse(self) -> Pose:
        """Inverse pose, which takes points of the world frame to the frame of the part."""
        back = self.rotation * [1.0, -1.0, -1.0, -1.0] / np.linalg.norm(self.rotation)
        return Pose(-self.position @ self.matrix, back)

    @property
    def matrix(self) -> Array:
        """Rotation matrix of the pose, shape (3, 3)."""
        return quaternion_to_matrix(self.rotation)

    def apply(self, points: ArrayLike) -> Array:
        """Transform points from the frame of the part to the world frame, shape (n, 3)."""
        world: Array = np.asarray(points, dtype=np.float64) @ self.matrix.T + self.position
        return world

    def __repr__(self) -> str:
        return f"Pose(position={in_brackets(self.position)}, rotation={in_brackets(self.rotation)})"


def common_frame(normals: Array, areas: Array) -> Array:
    """Rotation matrix whose first row is the most common normal by area, shape (3, 3).

    The second row is the most common normal perpendicular to the first.

    Examples
    --------
    >>> common_frame(np.eye(3), np.array([1., 1., 2.]))[0]
    array([0., 0., 1.])
    """
    step = max(1, len(normals) // SAMPLE)
    normals, areas = normals[::step], areas[::step]
    sound = np.linalg.norm(normals, axis=1) > 0.5  # a facet of zero area has the normal 0
    if not sound.any():
        return np.eye(3)
    normals, areas = normals[sound], areas[sound]
    strongest = np.take_along_axis(normals, np.abs(normals).argmax(axis=1)[:, None], axis=1)
    normals = normals * np.where(strongest < 0, -1.0, 1.0)
    first = _most_common(normals, areas)
    square = np.abs(normals @ first) < FRAME_SQUARE
    second = (
        _most_common(normals[square], areas[square])
        if square.any()
        else np.eye(3)[np.argmin(np.abs(first))]
    )
    second = second - (second @ first) * first
    second /= np.linalg.norm(second)
    return np.array([first, second, np.cross(first, second)])


def common_frames(normals: Array, areas: Array, start: Index) -> Array:
    """For each of M groups of normals, the frame (rotation matrix) of its most common normals.

    Normals that agree to about five digits count as equal. If all normals of all groups are along
    the axes, every frame is that of the axes.

    Arguments: `normals` (n, 3); `areas` (n,); `start` (M + 1,): first row of each run.

    Examples
    --------
    >>> normals = np.array([[0.6, 0.8, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    >>> common_frames(normals, np.array([1.0, 1.0, 2.0]), np.array([0, 1, 3]))[:, 0]
    array([[0.6, 0.8, 0. ],
           [0. , 0. , 1. ]])
    """
    count = len(start) - 1
    x, y, z = np.abs(normals).T
    if bool((np.maximum(np.maximum(x, y), z) == 1.0).all()):
        return np.tile(np.eye(3), (count, 1, 1))
    run = np.repeat(np.arange(count), np.diff(start))
    sound = np.linalg.norm(normals, axis=1) > 0.5
    normals, areas, run = normals[sound], areas[sound], run[sound]
    strongest = np.take_along_axis(normals, np.abs(normals).argmax(axis=1)[:, None], axis=1)
    normals = normals * np.where(strongest < 0, -1.0, 1.0)
    first = _most_common_of(normals, areas, run, np.tile([1.0, 0.0, 0.0], (count, 1)))
    square = np.abs(np.einsum("ij,ij->i", normals, first[run])) < FRAME_SQUARE
    other = np.eye(3)[np.abs(first).argmin(axis=1)]
    second = _most_common_of(normals[square], areas[square], run[square], other)
    second -= np.einsum("ij,ij->i", second, first)[:, None] * first
    second /= np.linalg.norm(second, axis=1)[:, None]
    return np.stack([first, second, np.cross(first, second)], axis=1)


def _most_common_of(normals: Array, areas: Array, run: Index, default: Array) -> Array:
    """The normal with the largest total area in each group, shape (M, 3).

    A run without normals gets its row of `default`, shape (M, 3).
    """
    key = _direction_keys(normals)
    order = np.lexsort((key, run))
    new = np.flatnonzero(np.diff(run[order], prepend=-1) | np.diff(key[order], prepend=-1))
    chosen = default.copy()
    if not len(new):
        return chosen
    total = np.add.reduceat(areas[order], new)
    owner = run[order][new]
    best = np.lexsort((-new, total, owner))  # the last of each run is its largest
    last = np.flatnonzero(np.diff(owner[best], append=-1))
    chosen[owner[best[last]]] = normals[order[new[best[last]]]]
    return chosen


def _direction_keys(normals: Array) -> Index:
    """Integer keys of normals, shape (n,); normals that agree to five digits have equal keys."""
    grid = np.rint(normals * 1e5).astype(np.int64) + 100_001
    keys: Index = (grid[:, 0] * 200_003 + grid[:, 1]) * 200_003 + grid[:, 2]
    return keys


def _most_common(normals: Array, areas: Array) -> Array:
    """Normal with the largest total area, shape (3,); n and -n count as the same normal."""
    if len(normals) <= ALL_PAIRS:
        alike = np.abs(normals @ normals.T) > 1 - FRAME_ALIKE
        total = np.where(alike, areas, 0.0).sum(axis=1)
    else:
        _, label = np.unique(_direction_keys(normals), return_inverse=True)
        total = np.bincount(label, weights=areas)[label]
    best = total >= total.max() * (1 - FRAME_TIE)
    chosen: Array = normals[np.argmax(np.where(best, areas, -1.0))]
    return chosen


def screwed(screw: ArrayLike, amounts: ArrayLike) -> tuple[Array, Array]:
    """Rotations and shifts of the centre of a body that moves along a screw by several amounts.

        shift = a v + (1 - cos t)/t^2 a^2 w x v + (t - sin t)/t^3 a^3 w x (w x v),    t = a |w|

    Bodies with a common screw keep their relative positions.

    Arguments: `screw` (6,): velocity v of the centre and angular velocity w, world frame; `amounts`
    (k,): amounts a of the screw [-]. Returns `turns` (k, 3, 3): rotation matrices; `shifts` (k, 3):
    shifts of the centre [length unit].

    Examples
    --------
    >>> turns, shifts = screwed([1, 0, 0, 0, 0, np.pi], [1.0])
    >>> np.round(turns[0] @ [1, 0, 0] + shifts[0], 6) + 0.0
    array([-1.     ,  0.63662,  0.     ])
    """
    from scipy.spatial.transform import Rotation

    six, amount = np.asarray(screw, dtype=np.float64), np.asarray(amounts, dtype=np.float64)
    v, w = six[:3], six[3:]
    t = amount * float(np.linalg.norm(w))
    small = np.abs(t) < 1e-4
    safe = np.where(small, 1.0, t)
    once = np.where(small, 0.5, (1 - np.cos(safe)) / safe**2)
    twice = np.where(small, 1 / 6, (safe - np.sin(safe)) / safe**3)
    across = np.cross(w, v)
    shifts = (
        amount[:, None] * v
        + (once * amount**2)[:, None] * across
        + (twice * amount**3)[:, None] * np.cross(w, across)
    )
    turns: Array = Rotation.from_rotvec(amount[:, None] * w).as_matrix()
    return turns, shifts
