"""Random linkages of one to four joints in equilibrium, with exact equations of their joints.

Chains hang from or stand on the ground. All that a joint carries has its centre of mass above or
below the joint, or beside it along the axis of a hinge, so that forces of equilibrium exist.
Four-bar linkages are symmetric about a vertical line.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from kilter import Assembly, Box, Joint, Part, Pose
from kilter.arrays import Array
from kilter.assembly.interactions import JointKind

UP = np.array([0.0, 0.0, 1.0])
STEP, ROUNDS = 2e-3, 50
"""Length of a motion along the joints, and largest number of Newton's steps."""
KINDS: tuple[JointKind, ...] = ("revolute", "revolute", "spherical", "cylindrical", "prismatic")


@dataclass
class Linkage:
    """An assembly with joints, the joints by numbers of parts (-1: ground), and its masses."""

    assembly: Assembly
    joints: list[tuple[int, int, JointKind, Array, Array]]
    centers: Array
    masses: Array

    def errors(self, z: Array) -> Array:
        """Errors of all joints after the motion z, shape (6 n,): shift and rotation vector."""
        six = np.vstack([z.reshape(-1, 6), np.zeros(6)])
        turns = Rotation.from_rotvec(six[:, 3:]).as_matrix()
        centers = np.vstack([self.centers, np.zeros(3)])
        found = []
        for a, b, kind, point, axis in self.joints:
            at = [centers[k] + six[k, :3] + turns[k] @ (point - centers[k]) for k in (a, b)]
            apart = at[1] - at[0]
            slides = kind in ("prismatic", "cylindrical")
            found.append(np.cross(turns[a] @ axis, apart) if slides else apart)
            if kind == "prismatic":
                over = turns[a].T @ turns[b]
                found.append((over - over.T)[[2, 0, 1], [1, 2, 0]])
            elif kind != "spherical":
                found.append(np.cross(turns[a] @ axis, turns[b] @ axis))
        return np.concatenate(found)

    def energy(self, z: Array) -> float:
        """Energy over gravity."""
        return float(self.masses @ z.reshape(-1, 6)[:, 2])

    def curvatures(self) -> Array:
        """Second derivatives of the energy along the joints, as eigenvalues."""
        size = 6 * len(self.masses)
        eye, small = np.eye(size), 1e-6
        slopes = np.array(
            [(self.errors(small * e) - self.errors(-small * e)) / (2 * small) for e in eye]
        ).T
        _, values, right = np.linalg.svd(slopes)
        rank = int((values > 1e-6 * values[0]).sum())
        along, inverse = right[rank:], np.linalg.pinv(slopes, rcond=1e-6)

        def bent(u: Array) -> float:
            ends = [self._closed(sense * STEP * u, inverse) for sense in (1, -1)]
            return sum(self.energy(end) for end in ends) / STEP**2

        return second_derivatives(bent, along)

    def _closed(self, z: Array, inverse: Array) -> Array:
        for _ in range(ROUNDS):
            error = self.errors(z)
            if np.abs(error).max() < 1e-14:
                break
            z = z - inverse @ error
        assert np.abs(self.errors(z)).max() < 1e-11
        return z


def second_derivatives(bent: Callable[[Array], float], along: Array) -> Array:
    """Eigenvalues of a quadratic form on the span of the rows of `along`."""
    count = len(along)
    form = np.diag([bent(u) for u in along]) if count else np.zeros((0, 0))
    for i in range(count):
        for j in range(i):
            both = bent(along[i] + along[j]) - form[i, i] - form[j, j]
            form[i, j] = form[j, i] = both / 2
    return np.linalg.eigvalsh(form)


def random_linkage(seed: int) -> Linkage:
    """The linkage of a seed."""
    random = np.random.default_rng(seed)
    return _four_bar(random) if seed % 5 == 0 else _chain(random)


def _chain(random: np.random.Generator) -> Linkage:
    count = int(random.integers(1, 5))
    kinds = [KINDS[k] for k in random.integers(0, len(KINDS), count)]
    points = np.cumsum(random.normal(size=(count, 3)), axis=0)
    masses = random.uniform(0.5, 3.0, count)
    axes, carried = [], []
    hangs = random.random() < 0.5
    for kind in kinds:
        angle = random.uniform(0, 2 * np.pi)
        axis = np.array([np.cos(angle), np.sin(angle), 0.0])
        axes.append(UP if kind == "revolute" and random.random() < 0.2 else axis)
        height = random.uniform(0.3, 2.0) * (-1 if hangs or random.random() < 0.3 else 1)
        aside = random.uniform(-0.5, 0.5) * (kind in ("revolute", "cylindrical"))
        # a slide carries its load wherever it is
        free = random.normal(size=3) * (kind == "prismatic" or axes[-1] is UP)
        carried.append(height * UP + aside * axes[-1] + free)
    centers = np.zeros((count, 3))
    mass, center = 0.0, np.zeros(3)
    for k in reversed(range(count)):
        whole = points[k] + carried[k]
        centers[k] = ((mass + masses[k]) * whole - mass * center) / masses[k]
        mass, center = mass + masses[k], whole
    joints = [(k - 1, k, kinds[k], points[k], axes[k]) for k in range(count)]
    return _linkage(random, joints, centers, masses)


def _four_bar(random: np.random.Generator) -> Linkage:
    low, high = random.uniform(0.5, 2.0, 2)
    height = random.uniform(0.5, 2.0) * random.choice([-1.0, 1.0])
    corners = [np.array([s * w, 0, z]) for w, z in ((low, 0), (high, height)) for s in (-1, 1)]
    y, share = np.array([0.0, 1.0, 0.0]), random.uniform(0.2, 0.8)
    bars = [corners[k] + share * (corners[k + 2] - corners[k]) for k in (0, 1)]
    coupler = np.array([0, 0.5, height + random.uniform(-1.5, 1.5)])
    joints: list[tuple[int, int, JointKind, Array, Array]] = [
        (-1, 0, "revolute", corners[0], y),
        (-1, 1, "revolute", corners[1], y),
        (0, 2, "revolute", corners[2], y),
        (1, 2, "revolute", corners[3], y),
    ]
    side, top = random.uniform(0.5, 2.0, 2)
    return _linkage(random, joints, np.array([*bars, coupler]), np.array([side, side, top]))


def _linkage(
    random: np.random.Generator,
    joints: list[tuple[int, int, JointKind, Array, Array]],
    centers: Array,
    masses: Array,
) -> Linkage:
    parts = [
        Part(
            f"link {k}",
            Box(random.uniform(0.01, 0.02, 3)),
            Pose(center, Rotation.random(random_state=random).as_quat(scalar_first=True)),
            mass=float(mass),
        )
        for k, (center, mass) in enumerate(zip(centers, masses, strict=True))
    ]
    names = [*(part.name for part in parts), "ground"]
    given = [
        Joint((names[a], names[b]), kind, point=point, axis=axis)
        for a, b, kind, point, axis in joints
    ]
    return Linkage(Assembly(parts, joints=given), joints, centers, masses)
