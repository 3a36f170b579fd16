"""SceneReport: the answer of `kilter.scene`, a state for each object of a scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cached_property
from typing import Annotated, ClassVar, Literal, get_args

import numpy as np

from kilter.analysis.settled_pose.settle import Way
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.assumption import DRAWN, RungWord
from kilter.assembly.supported_answer import SupportedAnswer
from kilter.contact import ContactSet
from kilter.errors import InputError, nearest_name, some_names
from kilter.rigid import Pose
from kilter.tell.levels import holds, level_rank
from kilter.tell.record import InPython, Record, Shape, UnitWord, Vector, key
from kilter.tell.scene_words import object_words, scene_sentence

ObjectState = Literal["at-rest", "held", "floats", "overlaps", "falls", "open"]
STATES: tuple[ObjectState, ...] = get_args(ObjectState)
"""States of an object of a scene."""
FAULTS: tuple[ObjectState, ...] = ("floats", "overlaps", "falls")
"""States of an object that is not at rest."""


class Move(Record):
    """A pose of a part: the transform from its own frame to the world frame."""

    position: Vector
    """[length unit]"""
    rotation: Annotated[Array, Shape(4)]
    """Quaternion w x y z."""


class SceneObject(Record):
    """An object of a scene and its state."""

    name: str
    """Name of the part."""
    state: ObjectState
    """Its state."""
    level: str | None = None
    """Level of the verdict on its cluster; null: not at rest."""
    gap: float | None = None
    """Height above `other`; negative: depth of an overlap [length unit]."""
    other: str | None = None
    """The part above which it floats, that it overlaps, or whose contact is open."""
    motion: str | None = None
    """First motion of a falling object."""
    if_held: tuple[str, ...] = ()
    """Objects with a fault that were held as drawn for this state."""
    geometry: Literal["collider", "visual", "as-drawn"] = "as-drawn"
    """Kind of the shape used."""
    way: tuple[Way, ...] = ()
    """The pieces of its way, in time, if the scene was settled."""
    units: InPython[str] = "m"
    """Length unit of the scene."""
    pose: InPython[Pose | None] = None
    """The pose `move`."""

    @property
    @key
    def move(self) -> Move | None:
        """Pose after a vertical move to the first contact.

        Floating objects have it, and round objects that are sunk by less than the error of their
        triangles.
        """
        pose = self.pose
        return None if pose is None else Move(position=pose.position, rotation=pose.rotation)

    @property
    @key
    def words(self) -> str:
        """The state in words."""
        return object_words(self.data_without("words"), self.units)


class SceneReport(SupportedAnswer):
    """Answer of `kilter.scene`: the state of each object of a scene.

    ``for entry in report`` yields each `SceneObject`; ``report["cup"]`` is that of a part.
    """

    answer: ClassVar[str] = "scene"

    objects: tuple[SceneObject, ...]
    """In the order of the assembly."""
    require: str
    """Level from which an object counts as at rest."""
    clusters: int
    """Number of separately judged clusters."""
    gravity: Vector
    """Gravity as used [m/s^2]."""
    friction: float
    """Coefficient of the contacts without a coefficient of their own [-]."""
    units: UnitWord
    """Length unit."""
    assume: RungWord = DRAWN
    """The rung of the ladder of assumptions that moved or joined objects; else drawn."""
    settled: bool = False
    """Whether the objects were brought to rest first."""
    warnings: tuple[str, ...]
    """Warnings about file, geometry and contacts."""
    seconds: float
    """Duration [s]."""
    assembly: InPython[Assembly]
    """The scene, in the pose at rest if it was settled."""
    contacts: InPython[ContactSet]
    """Its contacts."""
    verdicts: InPython[tuple[Verdict, ...]]
    """The verdict on each cluster of touching objects, with its certificate.

    An object without a contact that bears has no cluster: it floats.
    """
    drawn: InPython[Assembly | None] = None
    """The assembly before it was settled; None otherwise."""

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence."""
        return scene_sentence(self.data_without("sentence"))

    def __iter__(self) -> Iterator[SceneObject]:
        return iter(self.objects)

    def __len__(self) -> int:
        return len(self.objects)

    def __getitem__(self, name: str) -> SceneObject:
        if name not in self._index:
            near = nearest_name(name, self._index)
            there = some_names(list(self._index), 8)
            hint = f"did you mean {near!r}?" if near else f"there are: {there}"
            raise InputError(f"no object is named {name!r}", hint=hint)
        return self.objects[self._index[name]]

    @cached_property
    def _index(self) -> dict[str, int]:
        return {entry.name: k for k, entry in enumerate(self.objects)}

    @property
    @key
    def counts(self) -> dict[str, int]:
        """Number of objects in each state that occurs."""
        counted = Counter(entry.state for entry in self.objects)
        return {state: counted[state] for state in STATES if counted[state]}

    @property
    def faults(self) -> tuple[SceneObject, ...]:
        """The objects that float, overlap or fall."""
        return tuple(entry for entry in self.objects if entry.state in FAULTS)

    @property
    @key
    def at_rest(self) -> bool:
        """Whether every free object is at rest at the required level."""
        free = [entry for entry in self.objects if entry.state != "held"]
        return all(entry.state == "at-rest" and holds(entry.level, self.require) for entry in free)

    @property
    @key
    def level(self) -> str | None:
        """Lowest level of the objects; None if an object is not at rest, or none is free."""
        free = [entry for entry in self.objects if entry.state != "held"]
        if not free or any(entry.state != "at-rest" for entry in free):
            return None
        return min((entry.level for entry in free), key=level_rank)

    @property
    @key
    def moved(self) -> dict[str, float]:
        """Distance from the drawn centre of mass of each object that moved [length unit]."""
        if self.drawn is None:
            return {}
        steps = self.assembly.geometry.center - self.drawn.geometry.center
        lengths = np.linalg.norm(steps, axis=1).tolist()
        before, after = self.drawn.parts, self.assembly.parts
        rows = zip(before, after, lengths, strict=True)
        return {old.name: length for old, new, length in rows if old.pose != new.pose}

    @property
    @key
    def geometry(self) -> dict[str, int]:
        """Number of objects by the geometry that was used: "collider", "visual" or "as-drawn"."""
        counted = Counter(part.geometry or "as-drawn" for part in self.assembly.parts)
        return dict(sorted(counted.items()))

    def __repr__(self) -> str:
        words = ", ".join(f"{count} {state}" for state, count in self.counts.items())
        return f"<SceneReport: {len(self.objects)} objects, {words}>"
