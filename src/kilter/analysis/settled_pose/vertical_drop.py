"""Drop of hanging parts: each group falls straight down until a part of it meets another part.

A group is a set of bodies that touch each other, directly or through others, and touch no held
part. The groups fall one after the other, the lowest first. The collision test of straight paths
(`kilter.analysis.planning.order.sweeps`) and bisection give the distance to within its tolerance;
the search for a pose at rest closes the remaining gap.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.arrays import Index, connected
from kilter.contact import ContactSet, detect

HALVINGS = 40
"""Number of bisections of the distance of a fall."""


def drop_hanging(bodies: RigidBodies) -> tuple[RigidBodies, float]:
    """Let hanging groups of bodies fall straight down until they meet other parts.

    Groups with nothing below them stay in place.

    Returns `bodies`: the bodies after the fall; `farthest`: largest distance of a fall [length
    unit].
    """
    down = bodies.drawn.down
    landed: set[int] = set()
    farthest = 0.0
    for _ in range(len(bodies.mass)):
        assembly = bodies.assembly()
        contacts = detect.contacts(assembly)
        group = _hanging_groups(bodies, contacts)
        depth = assembly.geometry.vertices @ down
        lowest = np.maximum.reduceat(depth, assembly.geometry.vertex_start[:-1])
        waiting = [k for k in np.unique(group[group > 0]).tolist() if k not in landed]
        if not waiting:
            break
        first = max(waiting, key=lambda k: float(lowest[group == k].max()))
        distance = _free_fall(contacts, np.flatnonzero(group == first), group == first, down)
        moving = np.unique(bodies.of_part[group == first])
        if distance == 0.0 or not bodies.moves[moving].all():
            landed.add(first)
            continue
        step = np.zeros((len(bodies.mass), 6))
        step[moving, :3] = distance * down
        bodies = bodies.moved(step)
        farthest = max(farthest, distance)
        landed = set()
        if distance <= float(np.ptp(depth)) * 2.0**-HALVINGS:
            landed.add(first)
    return bodies, farthest


def _hanging_groups(bodies: RigidBodies, contacts: ContactSet) -> Index:
    """Group of each part: 0 if it touches the ground, directly or through others; shape (N,)."""
    pairs = [contacts.patch_parts, *(np.array([o.ends]) for o in contacts.overlaps)]
    touching = bodies.of_part[np.concatenate(pairs)]
    joined = [[bodies.body_of(name) for name in joint.parts] for joint in bodies.drawn.joints]
    ends = np.concatenate([touching, np.array(joined, dtype=np.int64).reshape(-1, 2)])
    label = connected(len(bodies.mass), ends[:, 0], ends[:, 1])
    group = label[bodies.of_part] + 1
    group[group == label[0] + 1] = 0
    return group


def _free_fall(contacts: ContactSet, parts: Index, inside: np.ndarray, down: np.ndarray) -> float:
    """Distance that parts fall together until other parts stop them; 0 if nothing does."""
    sweeps = Sweeps(contacts)
    direction = (float(down[0]), float(down[1]), float(down[2]))
    others = np.flatnonzero(~inside).tolist()
    stopping = [
        (part, other)
        for part in parts.tolist()
        for other in others
        if sweeps.pair_stops(part, other, direction)
    ]
    if not stopping:
        return 0.0
    low, high = 0.0, float(np.ptp(contacts.assembly.geometry.vertices @ down))
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        blocked = any(
            sweeps.pair_stops(part, other, direction, distance=middle) for part, other in stopping
        )
        low, high = (low, middle) if blocked else (middle, high)
    return low
