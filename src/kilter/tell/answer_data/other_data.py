"""Data of `kilter improve`, `kilter verify`, `kilter batch`, and of an incomplete answer."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import Units, Vector

__all__ = ["BatchData", "IncompleteData", "VerifyData"]


class VerifyData(TypedDict):
    """Answer of verify: whether the proof holds."""

    holds: Annotated[bool, Field(description="whether the required level was recomputed")]
    verdict: str
    level: Annotated[str | None, Field(description="level that was recomputed; null if it falls")]
    claimed: Annotated[str | None, Field(description="level that the file claims")]
    require: Annotated[str | None, Field(description="null: the claimed level")]
    residual: Annotated[float | None, Field(description="largest imbalance over the weight [-]")]
    power: Annotated[
        float | None, Field(description="of the motion if its fastest part moves at 1 m/s [W]")
    ]
    reasons: list[str]
    notes: list[str]
    held: list[str]
    gravity: Annotated[Vector, Field(description="[m/s^2]")]
    units: Units
    options: Annotated[
        dict[str, Any], Field(description="options with which the file was read for the proof")
    ]
    tolerance: dict[str, float | None]


class BatchErrorData(TypedDict):
    """A file without a verdict, and the reason."""

    file: str
    error: str


class BatchData(TypedDict):
    """Answer of batch: files with the rows, and the number of each verdict."""

    folder: str
    files: list[str]
    rows: int
    counts: dict[str, int]
    errors: list[BatchErrorData]
    found_there: int


class IncompleteData(TypedDict):
    """Data that a command prints if the time limit ended its computation without an answer."""

    verdict: Literal["undecided"]
    sentence: str
    time_limit: Annotated[float | None, Field(description="[s]; null without a --time-limit")]
    warnings: list[str]
