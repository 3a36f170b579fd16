"""Attributes of the XML elements of a URDF robot: text, numbers and poses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from xml.etree import ElementTree

import numpy as np

from kilter.errors import InputError
from kilter.rigid import Pose

__all__ = ["Element", "has_size", "joints_by_child", "numbers_of", "origin_of", "text_of"]

Element = ElementTree.Element


def text_of(element: Element, key: str) -> str:
    """The value of a required XML attribute; raises `InputError` without it."""
    value = element.get(key, "")
    if not value:
        raise InputError(f"a {element.tag} has no {key}", hint=f'give {key}="..."')
    return value


def numbers_of(element: Element | None, key: str, count: int, default: str = "") -> list[float]:
    """The `count` numbers in an XML attribute; raises `InputError` if they are invalid."""
    words = (default if element is None else element.get(key, default)).split()
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if len(values) != count or not np.isfinite(values).all():
        tag = "element" if element is None else element.tag
        raise InputError(
            f"{key} of <{tag}> is {' '.join(words)!r:.60}", hint=f"give {count} numbers"
        )
    return values


def has_size(row: Element) -> bool:
    """Whether a shape is no mere point, such as a box of size 0 0 0 that marks a frame."""
    inner = row.find("geometry/*")
    words = [] if inner is None else f"{inner.get('size', '')} {inner.get('radius', '')}".split()
    return not words or any(word.strip("+-0.") for word in words)


def origin_of(element: Element) -> Pose:
    """The pose in the `origin` element of a URDF element."""
    origin = element.find("origin")
    r, p, y = numbers_of(origin, "rpy", 3, "0 0 0")
    cos, sin = np.cos([r, p, y]), np.sin([r, p, y])
    about_x = np.array([[1, 0, 0], [0, cos[0], -sin[0]], [0, sin[0], cos[0]]])
    about_y = np.array([[cos[1], 0, sin[1]], [0, 1, 0], [-sin[1], 0, cos[1]]])
    about_z = np.array([[cos[2], -sin[2], 0], [sin[2], cos[2], 0], [0, 0, 1]])
    turn = Pose.of(about_z @ about_y @ about_x)
    return Pose(numbers_of(origin, "xyz", 3, "0 0 0"), turn.rotation)


def joints_by_child(
    joints: Sequence[Element], child: Callable[[Element], str]
) -> dict[str, Element]:
    """The joint that carries each link; `child` returns the link that a joint carries.

    Raises `InputError` if two joints carry the same link.
    """
    leads: dict[str, Element] = {}
    for joint in joints:
        name = child(joint)
        if name in leads:
            raise InputError("it is the child of two joints", part=name, hint="a robot is a tree")
        leads[name] = joint
    return leads
