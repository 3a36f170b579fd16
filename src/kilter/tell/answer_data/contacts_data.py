"""Data of the answer of `kilter contacts`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import (
    JointData,
    Lines,
    LoneData,
    PairNames,
    PlainOpenPairData,
    ToleranceData,
    Units,
    UnsupportedData,
    Vector,
)

__all__ = ["ContactsData"]


class PatchData(TypedDict):
    """A contact patch."""

    parts: PairNames
    kind: str
    area: Annotated[float, Field(description="[length unit^2]")]
    gap: Annotated[float, Field(description="largest gap [length unit]; negative if they overlap")]
    gap_range: Annotated[list[float], Field(min_length=2, max_length=2)]
    normal: Annotated[Vector, Field(description="from the first part to the second")]
    mu: float
    pieces: Annotated[list[int] | None, Field(description="pieces of the parts; null if unknown")]
    pull: Annotated[float | None, Field(description="largest tension of a bond [N]")]
    points: Annotated[Lines, Field(description="[length unit], world frame")]


class RejectedData(TypedDict):
    """A near pair without a contact, and the reason."""

    parts: PairNames
    gap: Annotated[float | None, Field(description="[length unit]")]
    angle_deg: Annotated[float, Field(description="[deg]")]
    why: str


class OverlapData(TypedDict):
    """Two parts that penetrate each other."""

    parts: PairNames
    volume: Annotated[float | None, Field(description="[length unit^3]")]
    depth: Annotated[float | None, Field(description="[length unit]")]
    share: Annotated[float | None, Field(description="share of the smaller part [-]")]
    why: str


class FitData(TypedDict):
    """A shaft in a hole; the part with the shaft is first."""

    parts: PairNames
    point: Vector
    axis: Vector
    radius: Annotated[float, Field(description="[length unit]")]
    clearance: Annotated[float, Field(description="of the radius [length unit]")]
    length: Annotated[float, Field(description="[length unit]")]
    fit: Literal["interference", "clearance", "size on size"]


class HistogramData(TypedDict):
    """Numbers of gaps between edges [size of the smaller part]; null for an infinite edge."""

    edges: list[float | None]
    counts: list[int]


class ContactsData(TypedDict):
    """Answer of contacts: patches, rejected pairs, overlaps and open pairs."""

    units: Units
    patches: list[PatchData]
    unsupported: list[UnsupportedData]
    rejected: list[RejectedData]
    overlaps: list[OverlapData]
    open_pairs: list[PlainOpenPairData]
    nearest: list[LoneData]
    fits: list[FitData]
    joints: list[JointData]
    sizes: Annotated[
        list[float],
        Field(
            min_length=2,
            max_length=2,
            description="sizes of the smallest and the largest part [length unit]",
        ),
    ]
    histogram: HistogramData
    tolerance: ToleranceData
    warnings: list[str]
