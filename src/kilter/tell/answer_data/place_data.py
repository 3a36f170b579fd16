"""Data of `kilter place`: the places at which a part stands."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import Units

__all__ = ["AtPlaceData", "LevelPlacesData", "PlaceData"]

Polygons = Annotated[
    list[list[list[list[float]]]],
    Field(description="polygons, each a list of rings (outline, holes) of points [length unit]"),
]


class LevelPlacesData(TypedDict):
    """Places of the centre of the part at one height."""

    height: Annotated[float, Field(description="of the centre of the part [length unit]")]
    stands: Polygons
    falls: Polygons
    open: Polygons
    open_strip: Annotated[float, Field(description="area of the open places [length unit^2]")]
    area: Annotated[float, Field(description="area of the places that stand [length unit^2]")]


class AtPlaceData(TypedDict):
    """The decision at a given place."""

    x: float
    y: float
    height: Annotated[float, Field(description="of the centre of the part [length unit]")]
    verdict: str
    level: str | None
    moving: list[str]
    heaviest: Annotated[float | None, Field(description="largest mass carried there [kg]")]
    unlimited: Annotated[bool, Field(description="whether any mass is carried")]


class PlaceData(TypedDict):
    """Answer of place."""

    sentence: str
    units: Units
    levels: list[LevelPlacesData]
    best: Annotated[
        dict[str, float] | None, Field(description="x, y, height, margin [length unit]")
    ]
    at: AtPlaceData | None
    heaviest: float | None
    mass: Annotated[
        list[float], Field(min_length=2, max_length=2, description="least and largest mass [kg]")
    ]
    center_within: Annotated[
        float,
        Field(
            description="largest shift of the centre of mass along each axis [sizes of the part]"
        ),
    ]
    stands: bool
    undecided: Annotated[bool, Field(description="whether open places or contacts remain")]
    level: str | None
    require: str
    accuracy: Annotated[float, Field(description="[length unit]")]
    programs: int
    warnings: list[str]
    seconds: float
