"""Largest push on a part that contacts hold: in a given direction, and in the weakest direction.

The forces F at its centre of mass with which an equilibrium exists are a convex set around 0
(if it is in balance without a push). In a direction e the limit is a conic program, max
t with F = t e; its mechanism gives a supporting plane of the set. The weakest push is the
distance from 0 to the boundary: the hull of the limits found so far lies inside the set, the
planes outside (`kilter.analysis.regions.enclose`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.analysis.load_limit import Limit, NoLimit
from kilter.analysis.margins.tilt import held_limit
from kilter.analysis.regions.enclose import SupportPoint, nearest_face
from kilter.analysis.turning_tolerances import (
    HARDEST_PUSH,
    PUSH_AGREES,
)
from kilter.arrays import Array
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.tell.record import InPython, OrNull, Record, Vector

__all__ = ["Push", "find_push", "find_weakest_push"]


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
    programs: InPython[int]
    """Number of programs solved."""

    def __repr__(self) -> str:
        return f"Push({self.part!r}, {self.force:.6g} N)"


def find_push(
    program: Program, part: int, direction: Array, *, opening: Opening | None = None
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
    limit = held_limit(
        program, wrench, opening=opening or Opening(cone_problem(program)), most=HARDEST_PUSH
    )
    if isinstance(limit, NoLimit):
        return limit
    force = max(limit.value, 0.0) * weight
    return Push(
        part=program.names[part],
        direction=direction,
        force=force,
        lower=force,
        limit=limit,
        programs=1,
    )


def find_weakest_push(
    program: Program, part: int, *, opening: Opening | None = None
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
    opening = opening or Opening(cone_problem(program))
    cap = HARDEST_PUSH * float(program.weight[program.free].sum())
    axes = np.eye(3)[[0, 2]] if program.planar else np.eye(3)
    pushes: list[Push | NoLimit] = []

    def ask(direction: Array) -> SupportPoint | None:
        push = find_push(program, part, direction @ axes, opening=opening)
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
