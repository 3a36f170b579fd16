"""Data of `kilter scene`: the state of each object."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import Units

__all__ = ["MoveData", "SceneData", "SceneObjectData"]


class MoveData(TypedDict):
    """A pose of a part: the transform from its own frame to the world frame."""

    position: Annotated[list[float], Field(min_length=3, max_length=3, description="[length unit]")]
    rotation: Annotated[
        list[float], Field(min_length=4, max_length=4, description="quaternion w x y z")
    ]


class SceneObjectData(TypedDict):
    """An object and its state."""

    name: str
    state: Literal["at-rest", "held", "floats", "overlaps", "falls", "open"]
    level: Annotated[
        str | None, Field(description="level of the verdict on its cluster; null: not at rest")
    ]
    gap: Annotated[
        float | None,
        Field(description="height above `other`; negative: depth of an overlap [length unit]"),
    ]
    other: str | None
    move: Annotated[
        MoveData | None,
        Field(description="pose after a vertical move to the first contact"),
    ]
    motion: Annotated[str | None, Field(description="first motion of a falling object")]
    if_held: Annotated[
        list[str],
        Field(description="objects with a fault that were held as drawn for this state"),
    ]
    geometry: Annotated[
        Literal["collider", "visual", "as-drawn"], Field(description="kind of the shape used")
    ]
    words: str


class SceneData(TypedDict):
    """Answer of scene."""

    sentence: str
    objects: list[SceneObjectData]
    counts: Annotated[dict[str, int], Field(description="number of objects in each state")]
    at_rest: Annotated[
        bool, Field(description="whether every free object is at rest at the required level")
    ]
    level: Annotated[str | None, Field(description="lowest level of the objects")]
    require: str
    clusters: Annotated[int, Field(description="number of separately judged clusters")]
    moved: Annotated[
        dict[str, float],
        Field(description="distance by which --settle moved each object [length unit]"),
    ]
    geometry: Annotated[
        dict[str, int],
        Field(description="number of parts by the geometry used: collider, visual or as-drawn"),
    ]
    gravity: Annotated[list[float], Field(min_length=3, max_length=3, description="[m/s^2]")]
    friction: float
    units: Units
    warnings: list[str]
    seconds: float
