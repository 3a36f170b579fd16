"""The register of examples: scenes with parameters under which their answer is known.

A function that makes a scene is listed by a decorator, once for each example of it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, TypeVar

from kilter.assembly import Assembly
from kilter.errors import InputError, nearest_name

__all__ = ["SCENES", "Answer", "Example", "listed", "scene"]

Answer = Literal["stable", "settles", "potentially-stable", "unstable"]
Builder = TypeVar("Builder", bound=Callable[..., Assembly])


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """A named scene.

    Attributes
    ----------
    name : str
        In kebab-case.
    title : str
        One line.
    build : callable
        Makes the assembly.
    source : str
        Case, figure or publication.
    answer : {"stable", "settles", "potentially-stable", "unstable"}
        The verdict. "settles": the proof that no motion obeys the contact law takes more than
        the usual effort. "potentially-stable": a motion obeys it as well.
    """

    name: str
    title: str
    build: Callable[..., Assembly]
    source: str
    answer: Answer

    def to_dict(self) -> dict[str, Any]:
        """An entry of `kilter example --json`."""
        return {
            "name": self.name,
            "title": self.title,
            "source": self.source,
            "answer": self.answer,
        }

    def __repr__(self) -> str:
        return f"<Example: {self.name}, {self.answer}: {self.title}>"


SCENES: dict[str, Example] = {}
"""Every example by name."""


def listed(
    name: str, title: str, *, source: str, answer: Answer, **parameters: Any
) -> Callable[[Builder], Builder]:
    """A decorator that lists the scene of a function, with these parameters, as an example."""

    def enter(build: Builder) -> Builder:
        SCENES[name] = Example(name, title, partial(build, **parameters), source, answer)
        return build

    return enter


def scene(name: str, *, size: tuple[int, int] | None = None) -> Assembly:
    """The assembly of the example of that name.

    Parameters
    ----------
    name : str
    size : tuple of int, optional
        Of a wall: bricks a course, and courses.

    Raises
    ------
    InputError
        If there is none, it names the nearest; if it has one size only.
    """
    if name not in SCENES:
        near = nearest_name(name, SCENES)
        hint = f"did you mean {near!r}?" if near else f"there are: {', '.join(SCENES)}"
        raise InputError(f"no scene is named {name!r:.60}", hint=hint)
    build = SCENES[name].build
    if size is None:
        return build()
    if not {"courses", "per_course"} <= set(inspect.signature(build).parameters):
        raise InputError(f"{name!r} has one size only", hint="walls have others")
    if min(size) < 1:
        raise InputError(f"a wall of size {size}", hint="give whole numbers above 0")
    return build(courses=size[1], per_course=size[0])
