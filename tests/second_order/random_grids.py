"""Random assemblies on a coarse grid, like CAD models: flush faces, centres over edges.

Boxes, cans, logs, balls and outlines (L, T, steps, wedges) with sizes in halves are lowered in turn
at places in halves, until their bounding boxes touch the floor or a part below. Some are held.
"""

import numpy as np
from transformations import scaled

from kilter import Assembly, Box, Cylinder, Part, Pose, Prism, Sphere
from kilter.arrays import Array
from kilter.scenes.pieces import moved

Shape = Box | Cylinder | Prism | Sphere

FLOOR = Part("floor", Box([12, 12, 1]), Pose([0, 0, -0.5]), grounded=True)
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
LYING = np.array([np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0])
"""A cylinder along y."""


def random_grid(seed: int, *, boxes: bool = False) -> Assembly:
    """An assembly of one to five parts on a floor; with `boxes` all parts are boxes."""
    random = np.random.default_rng(seed)
    parts, placed = [FLOOR], [np.zeros((0, 2, 3))]
    for k in range(int(random.integers(1, 6))):
        size = random.integers(1, 5, 3) * 0.5
        kind = "box" if boxes else random.choice(KINDS, p=SHARES)
        shape, turn, center = outline(kind, size)
        size = extent(shape, turn, size)
        low = np.append(random.integers(-3, 4, 2) * 0.5, 0.0)
        others = np.concatenate(placed)
        over = np.minimum(low + size, others[:, 1]) - np.maximum(low, others[:, 0]) > 1e-9
        low[2] = others[over[:, :2].all(axis=1), 1, 2].max(initial=0.0)
        placed.append(np.array([[low, low + size]]))
        held = bool(random.random() < 0.25)
        place = Pose(low + center * size, turn)
        parts.append(Part(f"{kind} {k}", shape, place, grounded=held))
    if all(part.grounded for part in parts):
        return random_grid(seed + 1_000_000, boxes=boxes)
    return Assembly(parts)


KINDS = ("box", "can", "log", "ball", "L", "T", "step", "wedge", "leaning")
SHARES = (0.44, 0.08, 0.08, 0.04, 0.1, 0.08, 0.08, 0.05, 0.05)


def outline(kind: str, size: Array) -> tuple[Shape, Array, Array]:
    """A shape, its turn, and the place of its origin in its bounding box, over the box size."""
    middle, (x, y, z) = np.full(3, 0.5), size
    if kind == "box":
        return Box(size), UPRIGHT, middle
    if kind == "can":
        return Cylinder(x / 2, z), UPRIGHT, middle
    if kind == "log":
        return Cylinder(x / 2, y), LYING, middle
    if kind == "ball":
        return Sphere(x / 2), UPRIGHT, middle
    corners = {
        "L": [[0, 0], [x, 0], [x, z / 2], [x / 2, z / 2], [x / 2, z], [0, z]],
        "T": [[x / 4, 0], [3 * x / 4, 0], [3 * x / 4, z / 2], [x, z / 2], [x, z], [0, z],
              [0, z / 2], [x / 4, z / 2]],
        "step": [[0, 0], [x, 0], [x, z], [x / 2, z], [x / 2, z / 2], [0, z / 2]],
        "wedge": [[0, 0], [x, 0], [0, z]],
        "leaning": [[0, 0], [x / 2, 0], [x, z], [x / 2, z]],
    }[kind]  # fmt: skip
    return Prism(corners, depth=y), UPRIGHT, np.array([0.0, 0.5, 0.0])


def extent(shape: Shape, turn: Array, size: Array) -> Array:
    """The size of its bounding box."""
    if isinstance(shape, Cylinder):
        across, length = 2 * shape.radius, shape.height
        return np.array([across, across, length] if turn is UPRIGHT else [across, length, across])
    return np.full(3, 2 * shape.radius) if isinstance(shape, Sphere) else size


def elsewhere(assembly: Assembly) -> Assembly:
    """The assembly turned with gravity, moved and scaled."""
    return moved(scaled(assembly, 37.0), [0.5, 0.3, -0.7, 0.41], [3, 1, -2])
