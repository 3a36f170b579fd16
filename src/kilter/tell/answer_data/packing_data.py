"""Data of `kilter check-plan`: the items of a packing plan, each with its verdict."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import Units

__all__ = ["OverloadData", "PackingData", "PackingItemData", "SupportShareData", "WallsData"]


class SupportShareData(TypedDict):
    """A part on which an item rests."""

    part: str
    share: Annotated[float, Field(description="share of the underside of the item [-]")]


class PackingItemData(TypedDict):
    """An item, and the verdict on the pile after it was put down."""

    name: str
    line: Annotated[int, Field(description="line of the table, or number in the order")]
    mass: Annotated[float, Field(description="[kg]")]
    verdict: str
    level: str | None
    support: list[SupportShareData]
    max_load: Annotated[float | None, Field(description="largest mass that its top may carry [kg]")]
    top_load: Annotated[
        float | None,
        Field(description="least mass that its top must carry in the finished pile [kg]"),
    ]


class OverloadData(TypedDict):
    """The first item whose top must carry more than its limit."""

    item: str
    after: Annotated[int, Field(description="the item that overloads it, counted from 1")]
    load: Annotated[float, Field(description="least mass that its top must carry [kg]")]
    max_load: Annotated[float, Field(description="[kg]")]


class WallsData(TypedDict):
    """Assumed smooth walls around the pile."""

    inner_size: Annotated[
        list[float], Field(min_length=2, max_length=2, description="along x and y [length unit]")
    ]
    stands: Annotated[bool, Field(description="whether each item stands between the walls")]
    first: Annotated[int | None, Field(description="the first item that falls nevertheless")]


class CarriedData(TypedDict):
    """Largest acceleration of the finished pile along a direction."""

    direction: str
    g: Annotated[float | None, Field(description="[g]; null: no limit up to 100 g")]


class PackingData(TypedDict):
    """Answer of check-plan."""

    sentence: str
    order: str | None
    units: Units
    require: str
    stands: bool
    level: str | None
    items: list[PackingItemData]
    first: Annotated[int | None, Field(description="the first item that falls, counted from 1")]
    why: str | None
    overload: OverloadData | None
    walls: WallsData | None
    friction: float
    carried: list[CarriedData]
    warnings: list[str]
    seconds: float
