"""Limits of single parts: the weakest push, and the largest further load straight down."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kilter.analysis.analysis_tolerances import (
    BALANCED,
    HARDEST_PUSH,
    PUSH_AGREES,
    SIDES_NEAR,
)
from kilter.analysis.load_limit import (
    Limit,
    NoLimit,
    SharedCones,
    beyond_at,
    find_limit,
    held_at,
    motion_share,
)
from kilter.analysis.margins.tilt import held_limit
from kilter.analysis.regions.enclose import SupportPoint, nearest_face
from kilter.arrays import Array, across
from kilter.mechanics.clusters import Cluster, clusters, different_clusters
from kilter.mechanics.program import Program
from kilter.tell.record import InPython, OrNull, Record, Vector, key

# The largest further load straight down on a part that contact forces can balance.


class PartLoad(Record):
    """Additional load straight down, at its centre of mass, that a part carries."""

    part: str
    """Name of the part."""
    load: OrNull
    """Load that is proved to be held [N]; infinite without a limit."""
    mass: OrNull
    """Mass with this weight [kg]."""
    beyond: OrNull
    """Load that is proved not to be held [N]; infinite if that proof is missing."""
    limit: InPython[Limit]
    """Forces and mechanism at the limit, in units of `unit`."""
    unit: InPython[float]
    """Unit of the multiples [N]."""

    @property
    @key
    def residual(self) -> float:
        """Largest imbalance of a part at the limit, divided by its weight [-]."""
        return self.limit.residual

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move beyond the limit."""
        return self.limit.moves

    def __repr__(self) -> str:
        return f"PartLoad({self.part!r}, {self.load:.6g} N)"


def find_part_load(
    program: Program, part: int, *, shared: SharedCones | None = None
) -> PartLoad | NoLimit:
    """The largest load straight down on a part; no limit if the weight alone is not balanced.

    Examples
    --------
    A cube that hangs under another cube by a bond takes the strength of the bond, less its weight.

    >>> from kilter import Assembly, Bond, Box, Part, Pose
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> top = Part("top", Box([1, 1, 1]), Pose([0, 0, 1]), grounded=True)
    >>> bond = Bond(("low", "top"), pull=9810)
    >>> hung = Assembly([top, Part("low", Box([1, 1, 1]))], bonds=[bond])
    >>> round(find_part_load(build_program(hung, contacts(hung)), 1).load, 3)
    29430.0
    """
    shared = shared or SharedCones(program)
    unit = float(program.weight[program.free].sum() + program.pull.sum())
    limit = _largest_load(shared, part, unit)
    if isinstance(limit, NoLimit) or not 0 < limit.load < np.inf:
        return limit
    if limit.beyond - limit.load <= SIDES_NEAR * limit.load:
        return limit
    nearer = _largest_load(shared, part, limit.load)
    better = isinstance(nearer, PartLoad) and nearer.beyond < limit.beyond
    return nearer if better else limit


def _largest_load(shared: SharedCones, part: int, unit: float) -> PartLoad | NoLimit:
    """The largest load straight down on a part, computed in multiples of `unit`."""
    program = shared.program
    wrench = np.zeros((len(program.names), 6))
    wrench[part, :3] = unit * program.down
    limit = find_limit(program, wrench, shared=shared)
    if isinstance(limit, NoLimit) or limit.value < 0:
        return limit if isinstance(limit, NoLimit) else NoLimit("none")
    beyond = limit.value + limit.gap * max(limit.value, 1.0)
    load = limit.value * unit
    return PartLoad(
        part=program.names[part],
        load=load,
        mass=load / program.g,
        beyond=max(beyond * unit, load),
        limit=limit,
        unit=unit,
    )


# Largest push on a part that contacts hold: in a given direction, and in the weakest direction.


PROGRAMS = 80
"""Largest number of programs for the weakest push of a part; then the gap stays open."""


class Push(Record):
    """Greatest push at the centre of mass of a part, in its weakest direction."""

    part: str
    """Name of the part."""
    direction: Vector
    """Unit."""
    force: OrNull
    """[N]; infinite without a limit."""
    lower: OrNull
    """Push that is proved to be resisted, for the weakest direction in every direction [N]."""
    limit: Limit
    """Forces and mechanism there."""
    along: InPython[Vector]
    """Direction of `limit`, unit; its mechanism bounds the push along `direction`."""
    programs: InPython[int]
    """Number of programs solved."""

    def __repr__(self) -> str:
        return f"Push({self.part!r}, {self.force:.6g} N)"


def find_push(
    program: Program, part: int, direction: Array, *, shared: SharedCones | None = None
) -> Push | NoLimit:
    """The largest push at a part's centre of mass in a direction that the assembly withstands.

    No limit if the weight alone is not balanced.

    Arguments: `direction` (3,).
    """
    direction = np.asarray(direction, dtype=np.float64)
    direction = direction / float(np.linalg.norm(direction))
    wrench = np.zeros((len(program.names), 6))
    weight = float(program.weight[program.free].sum())
    wrench[part, :3] = weight * direction
    limit = held_limit(wrench, shared=shared or SharedCones(program), most=HARDEST_PUSH)
    if isinstance(limit, NoLimit):
        return limit
    force = max(limit.value, 0.0) * weight
    return Push(
        part=program.names[part],
        direction=direction,
        force=force,
        lower=force,
        limit=limit,
        along=direction,
        programs=1,
    )


def find_weakest_push(
    program: Program, part: int, *, shared: SharedCones | None = None
) -> Push | NoLimit:
    """The smallest push at a part's centre of mass, over all directions, that starts a motion.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> cube = stacks.block_on_slope(0.0, friction=0.3)
    >>> found = find_weakest_push(build_program(cube, contacts(cube)), 1)
    >>> round(found.force / 9810, 4)  # sliding up a little: mu / sqrt(1 + mu^2)
    0.2873
    """
    shared = shared or SharedCones(program)
    cap = HARDEST_PUSH * float(program.weight[program.free].sum())
    axes = np.eye(3)[[0, 2]] if program.planar else np.eye(3)
    pushes: list[Push | NoLimit] = []

    def ask(direction: Array) -> SupportPoint | None:
        push = find_push(program, part, direction @ axes, shared=shared)
        pushes.append(push)
        if isinstance(push, NoLimit):
            return None
        normal, distance = _plane(program, part, push)
        return SupportPoint(min(push.force, cap) * direction, axes @ normal, min(distance, cap))

    first = _first(program.planar) @ axes.T
    face = nearest_face(ask, first, agree=PUSH_AGREES, limit=PROGRAMS, most=cap)
    if face is None or NoLimit("none") in pushes:
        return NoLimit("none" if NoLimit("none") in pushes else "failed")
    push = pushes[face.answer]
    assert isinstance(push, Push)
    unlimited = face.outer >= cap * (1 - PUSH_AGREES)
    force, lower = (np.inf, np.inf) if unlimited else (face.outer, face.inner)
    return replace(
        push, direction=face.normal @ axes, force=force, lower=lower, programs=face.asked
    )


def _first(planar: bool) -> Array:
    """Directions of a push that the search tries first: both signs of every axis."""
    axes = np.eye(3)[[0, 2]] if planar else np.eye(3)
    return np.concatenate([axes, -axes])


def _plane(program: Program, part: int, push: Push) -> tuple[Array, float]:
    """Plane in the space of pushes on a part, beyond which a part moves: unit normal, distance."""
    mechanism = push.limit.motion
    if mechanism is None:
        return push.direction, push.force
    step = mechanism.motion[part, :3]
    size = float(np.linalg.norm(step))
    if size == 0.0:
        return push.direction, push.force
    distance = -program.power(mechanism.motion) / size
    # where the plane is no support (its motion too coarse), the limit itself bounds
    if not 0.0 <= distance <= push.force * (1 + PUSH_AGREES):
        return push.direction, push.force
    return step / size, distance


class PartClusters:
    """Pushes and loads of single parts, each computed for the cluster of its part alone.

    Clusters that are equal up to a shift are computed once; the proofs are checked for each.
    """

    def __init__(self, program: Program) -> None:
        whole = [Cluster(program, np.arange(len(program.part_a)))]
        self._clusters = whole if program.has_limits else clusters(program)
        self._first = different_clusters(self._clusters)
        self._number = np.zeros(len(program.names), dtype=np.int64)
        for k, cluster in enumerate(self._clusters):
            self._number[cluster.program.free] = k
        self._shared: dict[int, SharedCones] = {}
        self._pushes: dict[int, Push | NoLimit] = {}

    def push(self, part: int) -> Push | NoLimit:
        """The weakest push that moves a part."""
        number = int(self._number[part])
        shared, own = self._of(int(self._first[number])), self._clusters[number].program
        first = shared.program
        copied = int(np.flatnonzero(first.free)[own.free[:part].sum()])
        if copied not in self._pushes:
            self._pushes[copied] = find_weakest_push(first, copied, shared=shared)
        push = self._pushes[copied]
        if part == copied or isinstance(push, NoLimit):
            return push
        limit = _shifted_limit(push, first, own, part)
        if limit is None:
            return find_weakest_push(own, part, shared=self._of(number))
        return replace(push, part=own.names[part], limit=limit)

    def load(self, part: int) -> PartLoad | NoLimit:
        """The largest further load straight down that a part carries."""
        shared = self._of(int(self._number[part]))
        return find_part_load(shared.program, part, shared=shared)

    def _of(self, number: int) -> SharedCones:
        """Program of a cluster, with what its limits have in common."""
        if number not in self._shared:
            self._shared[number] = SharedCones(self._clusters[number].program)
        return self._shared[number]


def _shifted_limit(push: Push, first: Program, own: Program, part: int) -> Limit | None:
    """The limit of a push for an equal cluster elsewhere; None if its proofs do not hold there."""
    limit, wrench = push.limit, np.zeros((len(own.names), 6))
    wrench[part, :3] = float(first.weight[first.free].sum()) * push.along
    share = min(limit.value, HARDEST_PUSH)
    sides = held_at(own, wrench, share, limit.forces.forces, limit.forces.friction)
    if limit.motion is not None:
        motion = np.zeros((len(own.names), 6))
        motion[own.free] = limit.motion.motion[first.free]
        sides = sides.better(beyond_at(own, wrench, motion_share(own, wrench, motion), motion))
    if sides.forces is None or (limit.motion is None) != (sides.motion is None):
        return None
    return replace(limit, forces=sides.forces, motion=sides.motion, program=own)


def easily_moved(program: Program, parts: Sequence[int]) -> list[int]:
    """Parts by the least push that moves each along a straight line if all others are held.

    Each part is tried along the normals of its contacts and along the edges of their friction
    cones. Parts that no such line moves come last.
    """
    order = np.argsort(np.concatenate([program.part_a, program.part_b]), kind="stable")
    owner = np.concatenate([program.part_a, program.part_b])[order]
    normal = np.concatenate([-program.normal, program.normal])[order]
    mu = np.tile(program.mu, 2)[order]
    first = np.searchsorted(owner, np.arange(len(program.names) + 1))
    ease = {}
    for part in parts:
        rows = slice(first[part], first[part + 1])
        ease[part] = _straight_push(normal[rows], mu[rows], program.load[part, :3])
    return sorted(parts, key=lambda part: (ease[part], program.mass[part]))


def _straight_push(normal: Array, mu: Array, load: Array) -> float:
    """Least push that moves a part along a line suggested by its contacts, (k, 3) [N]; or inf."""
    if not len(normal):
        return float(np.linalg.norm(load))
    u, v = across(normal)
    lines = np.concatenate([mu[:, None] * normal + t for t in (u, -u, v, -v)] + [normal])
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    along = lines @ normal.T
    aside = np.sqrt(np.maximum(1.0 - along * along, 0.0))
    free = (along - mu * aside >= -BALANCED).all(axis=1)
    return float(-(lines[free] @ load).max(initial=-np.inf))
