"""Library of scenes: functions that build assemblies with known answers.

Each scene is a function of its parameters that returns an `Assembly`. The decorator `listed` of
`kilter.scenes.registry` adds a scene to the examples of `kilter example`, with parameters for
which the answer is known. `source` is the case or figure from which a scene comes.

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
from kilter.values.guesses import guarded

__all__ = ["SCENES", "Answer", "Example", "example", "scene"]

ROOMS = (
    "paper",
    "stacks",
    "walls",
    "mortar",
    "arches",
    "wedges",
    "random_bricks",
    "friction",
    "traps",
    "rails",
)
"""Modules with examples, in the order of `kilter example`."""

for _room in ROOMS:
    importlib.import_module(f"kilter.scenes.{_room}")


@overload
def example() -> list[Example]: ...
@overload
def example(name: str, *, size: tuple[int, int] | None = None) -> Assembly: ...
@guarded
def example(
    name: str | None = None, *, size: tuple[int, int] | None = None
) -> list[Example] | Assembly:
    """Build a built-in example assembly; without a name, return the list of all examples.

    Parameters
    ----------
    name : str, optional
        Name of the example.
    size : tuple of int, optional
        Size of a wall: bricks per course, and courses.

    Raises
    ------
    InputError
        If the name is unknown; the message contains the most similar name.

    See Also
    --------
    kilter.load : reads an assembly from a file.
    kilter.check : the verdict on the assembly.

    Examples
    --------
    >>> example("tower")
    <Assembly: 6 parts, 1 held, in m>
    >>> example("wall", size=(8, 5))
    <Assembly: 43 parts, 1 held, in m>
    >>> len(example()), example()[0]
    (59, <Example: paper-figure-1, unstable: a sinking block pushes another block out of an L>)
    """
    return list(SCENES.values()) if name is None else scene(name, size=size)
