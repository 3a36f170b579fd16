"""Blocks that meet in a smooth face, divided into other triangles on each side; exact normals.

The joint is z = f(x, y) over a rectangle: a wave, an arc, a saddle. Each side is divided along its
own lines, which are moved at random, with random diagonals.
"""

from dataclasses import dataclass

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.rigid import Pose
from kilter.shape.primitives import Mesh

__all__ = ["JOINTS", "Joint", "blocks", "exact_normals"]


@dataclass(frozen=True)
class Joint:
    """z = f(x, y), its slopes, and whether it is ruled along y."""

    height: object
    slope: object
    ruled: bool


def wave(rng, lean=0.0):
    """Half a wave or more along x."""
    size, number = rng.uniform(0.05, 0.15), rng.uniform(2.5, 5.0)
    phase = rng.uniform(0, 2 * np.pi)
    return Joint(
        lambda x, y: size * np.sin(number * x + phase) + lean * x,
        lambda x, y: (size * number * np.cos(number * x + phase) + lean, 0 * x),
        True,
    )


def arc(rng, lean=0.0):
    """A piece of an ellipse, which no cylinder fits."""
    width, height = rng.uniform(1.6, 3.0), rng.uniform(0.3, 0.6)
    sign = rng.choice([-1.0, 1.0])
    middle = rng.uniform(0.3, 0.7)

    def root(x):
        return np.sqrt(1 - ((x - middle) / width) ** 2)

    return Joint(
        lambda x, y: sign * height * root(x) + lean * x,
        lambda x, y: (-sign * height * (x - middle) / width**2 / root(x) + lean, 0 * x),
        True,
    )


def saddle(rng, lean=0.0):
    """A surface with curvature in both directions."""
    a, b, c = rng.uniform(0.1, 0.25), -rng.uniform(0.1, 0.25), rng.uniform(-0.1, 0.1)

    def slope(x, y):
        return 2 * a * (x - 0.5) + c * (y - 0.5) + lean, 2 * b * (y - 0.5) + c * (x - 0.5)

    return Joint(
        lambda x, y: a * (x - 0.5) ** 2 + b * (y - 0.5) ** 2 + c * (x - 0.5) * (y - 0.5) + lean * x,
        slope,
        False,
    )


JOINTS = {"wave": wave, "arc": arc, "saddle": saddle}


def cut(rng, span, count):
    """Positions along a side, including its ends, moved at random between."""
    step = (span[1] - span[0]) / count
    places = np.linspace(*span, count + 1)
    places[1:-1] += rng.uniform(-0.25, 0.25, count - 1) * step
    return places


def body(rng, joint, span, level, count):
    """A block over `span` in x and 0 to 1 in y, from the joint to the plane z = level."""
    x, y = cut(rng, span, count), cut(rng, (0.0, 1.0), count)
    rows, columns = len(x), len(y)
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2).reshape(-1, 2)
    index = np.arange(rows * columns).reshape(rows, columns)
    inner = index[1:-1, 1:-1].ravel()
    grid[inner] += rng.uniform(-0.2, 0.2, (len(inner), 2)) / count
    face = np.column_stack([grid, joint.height(*grid.T)])
    far = np.column_stack([grid, np.full(len(grid), level)])
    a, b, c, d = (
        q.ravel() for q in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    )
    turned = rng.random(len(a)) < 0.5
    one = np.where(turned[:, None], np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    two = np.where(turned[:, None], np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    up = np.concatenate([one, two])
    loop = np.concatenate([index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]])
    after, n = np.roll(loop, -1), len(grid)
    side = np.concatenate(
        [np.column_stack([loop, loop + n, after + n]), np.column_stack([loop, after + n, after])]
    )
    # the joint faces up, the far plane down; a block above its joint is turned inside out
    faces = np.concatenate([up, up[:, ::-1] + n, side])
    return Mesh(np.concatenate([face, far]), faces if level < face[:, 2].min() else faces[:, ::-1])


def blocks(rng, joint, *, count=(12, 15), pose=None, alike=False, lift=0.0):
    """A held block below and a free block above, equally deep but less wide.

    `alike`: both have the same triangles; `lift`: height of the upper block over the joint.
    """
    pose = pose or Pose()
    seed, span = int(rng.integers(1 << 30)), (0.0, 1.0) if alike else (-0.2, 1.2)
    below = body(np.random.default_rng(seed), joint, span, -1.5, count[0])
    again = np.random.default_rng(seed + (not alike))
    above = body(again, joint, (0.0, 1.0), 1.5, count[0 if alike else 1])
    up = Pose(pose.apply([[0.0, 0.0, lift]])[0], pose.rotation)
    return Assembly([Part("below", below, pose, grounded=True), Part("above", above, up)])


def exact_normals(joint, points, pose):
    """Exact unit normals, from below to above, at contact points in the world."""
    local = (points - pose.position) @ pose.matrix
    x, y = local[:, 0], local[:, 1]
    slope_x, slope_y = joint.slope(x, y)
    normal = np.column_stack([-slope_x, -slope_y, np.ones(len(x))])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return normal @ pose.matrix.T
