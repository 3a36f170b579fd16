"""Chain of joints of a URDF robot from its root to a link, for the motion of this link.

The pose of the link is the product over the chain of the fixed transform of each joint (`origin`)
and the motion of its value q about or along its axis:

    revolute, continuous     turn by q about the axis [rad]
    prismatic                shift by q along the axis [m]
    fixed                    none

A joint with `mimic` moves by multiplier q + offset of another joint.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, nearest_name, some_names
from kilter.files.robots.urdf import Element, joints_by_child, numbers_of, origin_of, text_of
from kilter.files.robots.xml_text import xml_root
from kilter.rigid import Pose, unit

TURNING, SLIDING = ("revolute", "continuous"), ("prismatic",)
"""Types of joints that turn, and that shift."""


@dataclass(frozen=True, slots=True, eq=False)
class ChainJoint:
    """A joint of a chain."""

    name: str
    origin: Pose
    """Pose of the joint in the frame of its parent link, at the value 0 [m]."""
    axis: Array
    """Unit, in the frame of the joint, shape (3,)."""
    turns: bool
    slides: bool
    """Both are False for a fixed joint."""
    driver: str
    """Joint whose value moves this one: itself, or that of `mimic`."""
    multiplier: float
    offset: float
    """The value is ``multiplier * q + offset`` [-], [rad or m]."""
    range: tuple[float, float]
    """Least and largest value [rad or m]."""


@dataclass(frozen=True, slots=True, eq=False)
class JointChain:
    """Joints from the root of a robot to a link, the nearest to the root first."""

    joints: tuple[ChainJoint, ...]
    movable: tuple[str, ...]
    """Names of all joints of the robot that move, also outside of the chain."""

    @property
    def drivers(self) -> tuple[str, ...]:
        """Names of the joints whose values the pose of the link depends on."""
        moving = [joint.driver for joint in self.joints if joint.turns or joint.slides]
        return tuple(dict.fromkeys(moving))


def read_joint_chain(file: str | Path, link: str) -> JointChain:
    """Read the chain of joints from the root of a URDF robot to a link.

    Raises `InputError` if the file is no URDF, the link does not exist, joints form a loop, or a
    joint of the chain is invalid.
    """
    path = Path(file)
    root = xml_root(path)
    try:
        if root.tag != "robot":
            raise InputError(f"the root element is {root.tag!r:.40}", hint="give a URDF <robot>")
        return _chain(root, link)
    except InputError as error:
        raise error.located(file=str(path)) from None


def _chain(root: Element, link: str) -> JointChain:
    """Chain of joints of the XML of a robot."""
    links = [text_of(element, "name") for element in root.findall("link")]
    if link not in links:
        near = nearest_name(link, links)
        raise InputError(
            f"the robot has no link {link!r:.60}",
            hint=f"did you mean {near}?" if near else f"the links are {some_names(links)}",
        )
    leads = joints_by_child(root.findall("joint"), lambda joint: _end(joint, "child"))
    chain: list[Element] = []
    above = link
    while above in leads:
        if leads[above] in chain:
            raise InputError("its joints form a loop", part=above, hint="a robot is a tree")
        chain.append(leads[above])
        above = _end(chain[-1], "parent")
    movable = [
        text_of(joint, "name")
        for joint in root.findall("joint")
        if joint.get("type") in (*TURNING, *SLIDING)
    ]
    return JointChain(tuple(_joint(element) for element in reversed(chain)), tuple(movable))


def _end(joint: Element, end: str) -> str:
    """Name of the link at an end ("parent" or "child") of a joint."""
    element = joint.find(end)
    if element is None:
        raise InputError(
            f"the joint {joint.get('name')!r:.60} has no {end}", hint=f"give <{end} link=...>"
        )
    return text_of(element, "link")


def _joint(element: Element) -> ChainJoint:
    """A joint of the chain from its XML element."""
    name, kind = text_of(element, "name"), text_of(element, "type")
    turns, slides = kind in TURNING, kind in SLIDING
    if not (turns or slides or kind == "fixed"):
        raise InputError(
            f"the joint {name!r:.60} has the type {kind!r:.40}",
            hint="use one of fixed, revolute, continuous, prismatic between root and flange",
        )
    axis = np.array([1.0, 0.0, 0.0])
    if turns or slides:
        words = f"axis of the joint {name!r:.60}"
        axis = unit(numbers_of(element.find("axis"), "xyz", 3, "1 0 0"), words)
    mimic, limit = element.find("mimic"), element.find("limit")
    least, largest = -np.inf, np.inf
    if limit is not None and kind != "continuous":
        least = numbers_of(limit, "lower", 1, "0")[0]
        largest = numbers_of(limit, "upper", 1, "0")[0]
    return ChainJoint(
        name=name,
        origin=origin_of(element),
        axis=axis,
        turns=turns,
        slides=slides,
        driver=name if mimic is None else text_of(mimic, "joint"),
        multiplier=1.0 if mimic is None else numbers_of(mimic, "multiplier", 1, "1")[0],
        offset=0.0 if mimic is None else numbers_of(mimic, "offset", 1, "0")[0],
        range=(least, largest),
    )
