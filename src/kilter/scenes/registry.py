"""Registry of the examples: scenes with parameters for which their answer is known.

The decorator `listed` registers a scene function, once for each of its examples.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, TypeVar

from kilter.assembly import Assembly
from kilter.errors import InputError, nearest_name

Answer = Literal["stable", "settles", "balanced", "potentially-stable", "unstable"]
Builder = TypeVar("Builder", bound=Callable[..., Assembly])


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """A built-in example: a named function that builds an assembly, with a known answer.

    Attributes
    ----------
    name : str
        Name in kebab-case.
    title : str
        Description in one line.
    build : callable
        Function that builds the assembly.
    source : str
        Case, figure or publication.
    answer : {"stable", "settles", "balanced", "potentially-stable", "unstable"}
        Known verdict. "settles": the proof that no motion obeys the contact law needs more than
        the default effort. "potentially-stable": a motion obeys the contact law, too.
    """

    name: str
    title: str
    build: Callable[..., Assembly]
    source: str
    answer: Answer

    def to_dict(self) -> dict[str, Any]:
        """JSON data of the example, as `kilter example --json` prints them."""
        return {
            "name": self.name,
            "title": self.title,
            "source": self.source,
            "answer": self.answer,
        }

    def __repr__(self) -> str:
        return f"<Example: {self.name}, {self.answer}: {self.title}>"


SCENES: dict[str, Example] = {}
"""All examples by name."""


def listed(
    name: str, title: str, *, source: str, answer: Answer, **parameters: Any
) -> Callable[[Builder], Builder]:
    """Decorator that registers a function, with the given parameters, as a built-in example."""

    def enter(build: Builder) -> Builder:
        SCENES[name] = Example(name, title, partial(build, **parameters), source, answer)
        return build

    return enter


def scene(name: str, *, size: tuple[int, int] | None = None) -> Assembly:
    """Build the built-in example with the given name.

    Parameters
    ----------
    name : str
    size : tuple of int, optional
        Size of a wall: bricks per course, and courses.

    Raises
    ------
    InputError
        If the name is unknown (the message contains the most similar name), or if the scene is
        not a wall and a size is given.
    """
    if name not in SCENES:
        near = nearest_name(name, SCENES)
        hint = f"did you mean {near!r}?" if near else f"use one of: {', '.join(SCENES)}"
        raise InputError(f"no scene is named {name!r:.60}", hint=hint)
    build = SCENES[name].build
    if size is None:
        return build()
    if not {"courses", "per_course"} <= set(inspect.signature(build).parameters):
        raise InputError(f"{name!r} has a fixed size", hint="only walls have a size")
    if min(size) < 1:
        raise InputError(f"a wall of size {size}", hint="give whole numbers above 0")
    return build(courses=size[1], per_course=size[0])
