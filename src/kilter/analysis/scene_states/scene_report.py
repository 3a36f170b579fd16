"""SceneReport: the answer of `kilter.scene`, a state for each object of a scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal, get_args

import numpy as np

from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import InputError, nearest_name, some_names
from kilter.rigid import Pose
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import holds, level_rank
from kilter.tell.scene_words import object_words, scene_sentence

if TYPE_CHECKING:
    from kilter.tell.answer_data.scene_data import SceneData, SceneObjectData

__all__ = ["FAULTS", "STATES", "ObjectState", "SceneObject", "SceneReport"]

ObjectState = Literal["at-rest", "held", "floats", "overlaps", "falls", "open"]
STATES: tuple[ObjectState, ...] = get_args(ObjectState)
"""States of an object of a scene."""
FAULTS: tuple[ObjectState, ...] = ("floats", "overlaps", "falls")
"""States of an object that is not at rest."""


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An object of a scene and its state.

    Attributes
    ----------
    name : str
    state : {"at-rest", "held", "floats", "overlaps", "falls", "open"}
    level : str or None
        Level of the verdict on its cluster; None unless it is at rest.
    gap : float or None
        Height above `other`, negative for the depth of an overlap [length unit].
    other : str or None
        The part above which it floats, that it overlaps, or whose contact is open.
    move : Pose or None
        Pose of the part after a vertical move to its first contact, for a floating object, and for
        a round object that is sunk by less than the error of its triangles.
    motion : str
        First motion of a falling object, in words.
    if_held : tuple of str
        Objects with a fault that were held where they are drawn when this object was judged.
    """

    name: str
    state: ObjectState
    level: str | None = None
    gap: float | None = None
    other: str | None = None
    move: Pose | None = None
    motion: str = ""
    if_held: tuple[str, ...] = ()

    def to_dict(self, units: str, geometry: str = "as-drawn") -> SceneObjectData:
        """JSON data of the object.

        Parameters
        ----------
        units : {"m", "cm", "mm", "in"}
            Length unit of the scene, for the words.
        geometry : {"collider", "visual", "as-drawn"}
            Kind of the shape that was used.
        """
        move = self.move
        pose = None
        if move is not None:
            pose = {"position": move.position.tolist(), "rotation": move.rotation.tolist()}
        data: SceneObjectData = {
            "name": self.name,
            "state": self.state,
            "level": self.level,
            "gap": self.gap,
            "other": self.other,
            "move": pose,  # type: ignore[typeddict-item]
            "motion": self.motion or None,
            "if_held": list(self.if_held),
            "geometry": geometry,  # type: ignore[typeddict-item]
            "words": "",  # made below from the other data
        }
        data["words"] = object_words(data, units)
        return data


@dataclass(frozen=True, eq=False, repr=False)
class SceneReport(AnswerInWords):
    """Answer of `kilter.scene`: the state of each object of a scene.

    ``for entry in report`` yields each `SceneObject`; ``report["cup"]`` is that of a part.

    Attributes
    ----------
    assembly : Assembly
    contacts : ContactSet
    objects : tuple of SceneObject
        In the order of the assembly.
    verdicts : tuple of Verdict
        The verdict on each cluster of touching objects, with its certificate. An object without a
        contact that bears has no cluster: it floats.
    require : str
        Level from which an object counts as at rest.
    warnings : tuple of str
    seconds : float
    drawn : Assembly or None
        The assembly before a repair; None without a repair.
    """

    answer: ClassVar[str] = "scene"

    assembly: Assembly
    contacts: ContactSet
    objects: tuple[SceneObject, ...]
    verdicts: tuple[Verdict, ...]
    require: str
    warnings: tuple[str, ...]
    seconds: float
    drawn: Assembly | None = None

    def __iter__(self) -> Iterator[SceneObject]:
        return iter(self.objects)

    def __len__(self) -> int:
        return len(self.objects)

    def __getitem__(self, name: str) -> SceneObject:
        if name not in self._index:
            near = nearest_name(name, self._index)
            hint = f"did you mean {near!r}?" if near else f"there are: {some_names(self._names, 8)}"
            raise InputError(f"no object is named {name!r}", hint=hint)
        return self.objects[self._index[name]]

    @cached_property
    def _names(self) -> Sequence[str]:
        return [entry.name for entry in self.objects]

    @cached_property
    def _index(self) -> dict[str, int]:
        return {name: k for k, name in enumerate(self._names)}

    @property
    def counts(self) -> dict[str, int]:
        """Number of objects in each state that occurs."""
        counted = Counter(entry.state for entry in self.objects)
        return {state: counted[state] for state in STATES if counted[state]}

    @property
    def faults(self) -> tuple[SceneObject, ...]:
        """The objects that float, overlap or fall."""
        return tuple(entry for entry in self.objects if entry.state in FAULTS)

    @property
    def at_rest(self) -> bool:
        """Whether every free object is at rest at the required level."""
        free = [entry for entry in self.objects if entry.state != "held"]
        return all(entry.state == "at-rest" and holds(entry.level, self.require) for entry in free)

    @property
    def level(self) -> str | None:
        """Lowest level of the objects; None if an object is not at rest, or none is free."""
        free = [entry for entry in self.objects if entry.state != "held"]
        if not free or any(entry.state != "at-rest" for entry in free):
            return None
        return min((entry.level for entry in free), key=level_rank)

    @property
    def moved(self) -> dict[str, float]:
        """Distance by which a repair moved the centre of mass of each object [length unit]."""
        if self.drawn is None:
            return {}
        steps = self.assembly.geometry.center - self.drawn.geometry.center
        lengths = np.linalg.norm(steps, axis=1).tolist()
        before, after = self.drawn.parts, self.assembly.parts
        rows = zip(before, after, lengths, strict=True)
        return {old.name: length for old, new, length in rows if old.pose != new.pose}

    @property
    def geometry(self) -> dict[str, int]:
        """Number of objects by the geometry that was used: "collider", "visual" or "as-drawn"."""
        counted = Counter(part.geometry or "as-drawn" for part in self.assembly.parts)
        return dict(sorted(counted.items()))

    def to_dict(self) -> SceneData:
        """The states of the objects as JSON data, as ``kilter scene --json`` prints it."""
        units = self.assembly.units
        data: SceneData = {
            "sentence": "",  # made below from the other data
            "objects": [
                entry.to_dict(units, part.geometry or "as-drawn")
                for entry, part in zip(self.objects, self.assembly.parts, strict=True)
            ],
            "counts": self.counts,
            "at_rest": self.at_rest,
            "level": self.level,
            "require": self.require,
            "clusters": len(self.verdicts),
            "moved": self.moved,
            "geometry": self.geometry,
            "gravity": self.assembly.gravity.tolist(),
            "friction": self.assembly.friction,
            "units": units,
            "warnings": list(self.warnings),
            "seconds": self.seconds,
        }
        data["sentence"] = scene_sentence(data)
        return data

    def __repr__(self) -> str:
        words = ", ".join(f"{count} {state}" for state, count in self.counts.items())
        return f"<SceneReport: {len(self.objects)} objects, {words}>"
