"""Data of the answer of `kilter hold`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import (
    LevelWord,
    OpenPairData,
    Seconds,
    Units,
    Vector,
)

__all__ = ["HoldData"]


class SupportData(TypedDict):
    """A support of a part."""

    kind: str
    part: str
    point: Annotated[Vector | None, Field(description="[length unit]")]
    direction: Vector | None
    mu: float
    capacity: Annotated[float, Field(description="[N]")]
    on: str | None
    name: str


class LoadedSupportData(SupportData):
    """A support, and its force on the part."""

    force: Annotated[Vector | None, Field(description="[N]")]


class StoppedMotionData(TypedDict):
    """A motion without supports, and the candidate supports that stop it."""

    stopped_by: list[str]
    moving: list[str]


class ChosenStrapData(TypedDict):
    """A strap of the answer of hold, with its pull."""

    candidate: Annotated[int, Field(description="number in the list of candidates, from 1")]
    parts: list[str]
    tension: Annotated[float | None, Field(description="[N]")]
    capacity: Annotated[float | None, Field(description="[N]")]
    pull: Annotated[float | None, Field(description="tension, or largest computed pull [N]")]


class StrapCaseData(TypedDict):
    """A direction of a code of load securing, and the level with the straps of the answer."""

    name: str
    acceleration: Annotated[Vector, Field(description="of the carrier [m/s^2]")]
    level: LevelWord | None


class HoldData(TypedDict):
    """Answer of hold: the fewest supports."""

    verdict: Annotated[str, Field(json_schema_extra={"enum": ["held", "impossible", "undecided"]})]
    level: LevelWord | None
    require: LevelWord
    holds: bool
    why: str | None
    open_pairs: list[OpenPairData]
    supports: list[LoadedSupportData] | None
    straps: Annotated[
        list[ChosenStrapData] | None, Field(description="null: straps were no candidates")
    ]
    code: Annotated[
        str | None, Field(description="code of load securing; null: the load as it is given")
    ]
    cases: Annotated[list[StrapCaseData], Field(description="directions of the code")]
    least: int
    fewest: bool
    motions: list[StoppedMotionData]
    candidates: int
    most: int | None
    units: Units
    base: list[str]
    judged: int
    exhausted: bool
    interrupted: bool
    time_limit: Annotated[float | None, Field(description="[s]")]
    warnings: list[str]
    seconds: Seconds
    sentence: str
