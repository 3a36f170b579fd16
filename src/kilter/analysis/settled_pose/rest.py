"""The result of the engine that brings bodies to rest, and the way of each body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kilter.analysis.settled_pose.near_points import NearPoints
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies

RestState = Literal["at-rest", "partly", "does-not-fit", "falls", "not-found"]
"""State in which the engine ended: all bodies rest | some rest, the others leave the scene or have
no pose | overlaps that nothing opens | all free bodies leave | no pose within the limits."""
WayKind = Literal["pushed-out", "fell", "tipped", "slid", "rolled"]


@dataclass(frozen=True, slots=True)
class WayStep:
    """A piece of the way of a body: all movements of a kind that follow each other."""

    how: WayKind
    distance: float
    """Way of the centre of mass [length unit]."""
    angle_deg: float
    """Angle of the rotation [deg]."""


@dataclass(frozen=True, slots=True, eq=False)
class RestResult:
    """Where the bodies came to rest, and how they got there."""

    state: RestState
    bodies: RigidBodies
    """The bodies in their last poses; those that leave the scene stay where they left it."""
    ways: tuple[tuple[WayStep, ...], ...]
    """Way of each body, in time; shape (B,)."""
    leaves: tuple[str, ...] = ()
    """Parts that fall out of the scene."""
    parts: tuple[str, ...] = ()
    """Parts that overlap, or that found no rest."""
    depth: float = 0.0
    """Depth of an overlap that nothing opens [length unit]."""
    why: str = ""
    """Cause of a failure as a clause."""
    rounds: int = 0
    aside: RigidBodies | None = None
    """The bodies after their overlaps were opened, before any fall."""
    points: NearPoints | None = None
    """Points that the engine regards as closed."""
    sunk: bool = False
    """Whether bodies that were sunk into each other came to rest by the least motion."""
    eased: bool = False
    """Whether resting bodies slid on to where they need little friction."""
