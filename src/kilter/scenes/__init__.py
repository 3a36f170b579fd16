"""The library of scenes: one source for examples, tests, benchmarks and documents.

Each scene is a function of its parameters that returns an `Assembly`; those that
`kilter example` offers are listed where they are made (`kilter.scenes.registry`), with the
parameters that make their answer known. `source` is the case or figure a scene comes from.

Examples
--------
>>> scene("tower").names[:2]
('base', 'cube-1')
>>> scene("towr")
Traceback (most recent call last):
kilter.errors.InputError: no scene is named 'towr'; did you mean 'tower'?
"""

from __future__ import annotations

import importlib
from typing import overload

from kilter.assembly import Assembly
from kilter.scenes.registry import SCENES, Answer, Example, scene

__all__ = ["SCENES", "Answer", "Example", "example", "scene"]

ROOMS = (
    "paper",
    "stacks",
    "accelerations",
    "walls",
    "mortar",
    "arches",
    "wedges",
    "packings",
    "friction",
    "rounds",
    "traps",
    "rails",
    "exported",
)
"""Modules that list examples, in the order in which they are listed."""

for _room in ROOMS:
    importlib.import_module(f"kilter.scenes.{_room}")


@overload
def example() -> list[Example]: ...
@overload
def example(name: str, *, size: tuple[int, int] | None = None) -> Assembly: ...
def example(
    name: str | None = None, *, size: tuple[int, int] | None = None
) -> list[Example] | Assembly:
    """A built-in example; without a name, the list of all.

    Parameters
    ----------
    name : str, optional
    size : tuple of int, optional
        Of a wall: bricks a course, and courses.

    Raises
    ------
    InputError
        If there is none of that name; it names the nearest.

    Examples
    --------
    >>> example("tower")
    <Assembly: 6 parts, 1 held, in m>
    >>> example("wall", size=(8, 5))
    <Assembly: 43 parts, 1 held, in m>
    >>> len(example()), example()[0]
    (51, <Example: paper-figure-1, unstable: a block drives another out of a right-angled one>)
    """
    return list(SCENES.values()) if name is None else scene(name, size=size)
