"""Data of `kilter settle`: the pose at rest, or the reason why there is none."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import Units

__all__ = ["MovedData", "SettleData"]


class MovedData(TypedDict):
    """Movement of a part from the drawn to the settled pose."""

    part: str
    distance: Annotated[float, Field(description="of its centre of mass [length unit]")]
    angle_deg: Annotated[float, Field(description="of its rotation [deg]")]


class SettleData(TypedDict):
    """Answer of settle."""

    sentence: str
    state: Literal["at-rest", "does-not-fit", "falls", "not-found"]
    level: Annotated[str | None, Field(description="of the pose at rest; null in other states")]
    units: Units
    moved: Annotated[list[MovedData], Field(description="moved parts, the farthest first")]
    widest_gap: Annotated[
        float | None, Field(description="of a closed point [length unit]; null without a pose")
    ]
    deepest_overlap: Annotated[float | None, Field(description="of two parts [length unit]")]
    carries: Annotated[list[list[str]], Field(description="pairs that touch at closed points")]
    rounds: int
    reach: Annotated[float, Field(description="largest gap considered [length unit]")]
    tolerance: Annotated[float, Field(description="gap that counts as closed [length unit]")]
    dropped: Annotated[float, Field(description="largest fall before the search [length unit]")]
    parts: Annotated[list[str], Field(description="parts that fall, do not fit, are out of reach")]
    depth: Annotated[float, Field(description="of the overlap that remains [length unit]")]
    why: Annotated[str, Field(description="cause of a failure; empty at rest")]
    before: Annotated[str | None, Field(description="verdict on the drawn pose")]
    after: Annotated[str | None, Field(description="verdict on the pose at rest")]
    after_asked: Annotated[
        str | None, Field(description="level up to which the verdict on the pose at rest was asked")
    ]
    closed_level: Annotated[str | None, Field(description="level of forces at closed points alone")]
    require: str
    warnings: list[str]
    seconds: float
