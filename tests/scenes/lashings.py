"""Lashed loads on a deck, for tests: a box, a stack, or a row of boxes under one strap."""

from __future__ import annotations

import itertools

import numpy as np

import kilter
from kilter.scenes.pieces import block

__all__ = ["DEPTH", "lashed", "over", "random_lashing"]

DEPTH = 1.0
"""Depth of all boxes along y."""


def over(width: float, height: float, angle: float, tension: float, **more: object) -> kilter.Strap:
    """A strap over the top of a load from -width / 2 to width / 2, at an angle to the deck.

    It runs over every box whose top edge is named "left" and "right" in `more`.
    """
    left, right = str(more.pop("left", "box-0")), str(more.pop("right", "box-0"))
    run = height / np.tan(np.radians(angle))
    path = [
        ("ground", [-width / 2 - run, 0, 0]),
        (left, [-width / 2, 0, height]),
        (right, [width / 2, 0, height]),
        ("ground", [width / 2 + run, 0, 0]),
    ]
    return kilter.Strap(path, tension, **more)  # type: ignore[arg-type]


def lashed(
    boxes: list[tuple[list[float], list[float]]],
    mass: float,
    strap: kilter.Strap,
    friction: float,
    pairs: float | None = None,
) -> kilter.Assembly:
    """Boxes, each from a low to a high corner in x and z, with a strap; `pairs`: their own mu."""
    parts = [block("deck", [-9, -9, -1], [9, 9, 0], grounded=True)]
    for k, (low, high) in enumerate(boxes):
        corners = [low[0], -DEPTH / 2, low[1]], [high[0], DEPTH / 2, high[1]]
        parts.append(block(f"box-{k}", *corners, mass=mass))
    names = [part.name for part in parts[1:]]
    own = [] if pairs is None else [
        kilter.FrictionPair(pair, pairs) for pair in itertools.pairwise(names)
    ]  # fmt: skip
    return kilter.Assembly(parts, friction=friction, friction_pairs=own, straps=[strap])


def random_lashing(seed: int) -> kilter.Assembly:
    """Two to four boxes in a row or a stack, with one to three straps of random paths and forces.

    Gravity is inclined at random, as if the carrier accelerated.
    """
    rng = np.random.default_rng([3838, seed])
    count, tall = int(rng.integers(2, 5)), bool(rng.random() < 0.5)
    sizes = rng.uniform([0.4, 0.4, 0.4], [1.2, 1.2, 1.2], (count, 3))
    width = sizes[:, 0] if not tall else np.full(count, sizes[0, 0])
    parts = [block("deck", [-9, -9, -1], [9, 9, 0], grounded=True)]
    across, up, edges = 0.0, 0.0, []
    for k, (size, wide) in enumerate(zip(sizes, width, strict=True)):
        low = np.array([0.0 if tall else across, -size[1] / 2, up if tall else 0.0])
        high = low + np.array([wide, size[1], size[2]])
        mass = float(rng.uniform(50, 800))
        parts.append(block(f"box-{k}", low, high, mass=mass))
        edges.append((low, high))
        across, up = across + wide, up + size[2]
    straps = []
    for _ in range(int(rng.integers(1, 4))):
        k = count - 1 if tall else int(rng.integers(count))
        low, high = edges[k]
        y = float(rng.uniform(low[1], high[1]))
        reach = rng.uniform(1.2, 3.0, 2)
        # along y a strap is clear of the other boxes of a row
        if tall:
            lean = float(rng.uniform(-0.5, 0.5))
            path = [("ground", [low[0] - reach[0], y + lean, 0.0]),
                    (f"box-{k}", [low[0], y, high[2]]), (f"box-{k}", [high[0], y, high[2]]),
                    ("ground", [high[0] + reach[1], y + lean, 0.0])]  # fmt: skip
        else:
            x = float(rng.uniform(low[0], high[0]))
            path = [("ground", [x, low[1] - reach[0], 0.0]),
                    (f"box-{k}", [x, low[1], high[2]]), (f"box-{k}", [x, high[1], high[2]]),
                    ("ground", [x, high[1] + reach[1], 0.0])]  # fmt: skip
        mu = float(rng.choice([0.0, 0.15, 0.3]))
        end = str(rng.choice(["first", "last"]))
        tension = float(10 ** rng.uniform(2.0, 4.0))
        straps.append(kilter.Strap(path, tension, mu=mu, tensioned=end))  # type: ignore[arg-type]
    tilt, turn = rng.uniform(0.3, 0.8), rng.uniform(0, 2 * np.pi)
    gravity = 9.81 * np.array([tilt * np.cos(turn), tilt * np.sin(turn), -1.0])
    return kilter.Assembly(
        parts, friction=float(rng.uniform(0.2, 0.7)), gravity=gravity, straps=straps
    )
