"""Data of the answers of `kilter orient` and `kilter region`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.check_data import CheckToleranceData, PartData
from kilter.tell.answer_data.common_data import (
    JointData,
    LevelWord,
    Lines,
    OpenPairData,
    Seconds,
    Twist,
    Units,
    UnsupportedData,
    Vector,
)

__all__ = ["OrientData", "RegionData"]


class OrientRegionData(TypedDict):
    """Kind and angular width of the region of stable directions."""

    kind: str
    half_angle_deg: Annotated[float | None, Field(description="[deg]")]
    friction: bool


class NearestDirectionData(TypedDict):
    """A direction of gravity nearest to stable by a measure, and the measured value."""

    direction: Vector
    value: float
    motion: list[Twist] | None
    programs: int


class BoundedDirectionData(NearestDirectionData):
    """A nearest direction as in the base class, with a proved bound of its value."""

    bound: float


class NearestData(TypedDict):
    """Directions of gravity that are nearest to stable, by three measures."""

    diamond: NearestDirectionData
    sphere: NearestDirectionData
    kappa: BoundedDirectionData | None


class OrientData(TypedDict):
    """Answer of orient: the stable direction of gravity with the widest margin."""

    verdict: Literal["found", "none", "undecided"]
    found: bool
    level: LevelWord | None
    sentence: str
    down: Vector
    rotation: Annotated[
        list[float], Field(min_length=4, max_length=4, description="quaternion w x y z")
    ]
    tilt_margin_deg: Annotated[float | None, Field(description="[deg]")]
    friction: bool
    residual: float | None
    z: Annotated[float | None, Field(description="z for gravity of length 1 [kg x length unit]")]
    instability: Annotated[float | None, Field(description="kappa [-]")]
    units: Units
    joints: list[JointData]
    parts: list[PartData]
    unsupported: list[UnsupportedData]
    open_pairs: list[OpenPairData]
    tolerance: CheckToleranceData | None
    region: OrientRegionData
    nearest: NearestData | None
    method: Literal["joint", "walk"]
    programs: int
    warnings: list[str]


class JoinedRegionData(TypedDict):
    """The region if the open pairs are joined."""

    kind: str
    lines: Lines
    rays: Lines
    equations: Lines
    facets: Lines
    half_angle_deg: Annotated[float | None, Field(description="[deg]")]


class WellData(TypedDict):
    """Width, depth and stiffness of the energy minimum of a body on a level table."""

    part: str
    over_deg: Annotated[float | None, Field(description="tilt from which it comes back [deg]")]
    barrier: Annotated[float | None, Field(description="[J]")]
    stiffness: Annotated[float | None, Field(description="[N m/rad]")]
    axis: Vector | None
    period: Annotated[float | None, Field(description="[s]")]


class RestData(TypedDict):
    """A place of rest: a direction of gravity and its state of second order."""

    down: Vector
    on: Annotated[list[str], Field(description="held parts that bear the weight")]
    state: Literal["minimum", "free", "balanced", "open"]
    tilt_deg: Annotated[float | None, Field(description="[deg]")]
    rate: Annotated[float | None, Field(description="[1/s]")]
    moving: list[str]
    why: str | None
    well: WellData | None


class RegionData(TypedDict):
    """Answer of region: all directions of gravity in which the assembly stays."""

    kind: str
    dimension: int
    lines: Lines
    rays: Lines
    equations: Lines
    facets: Lines
    center: Vector | None
    half_angle_deg: Annotated[float | None, Field(description="[deg]")]
    programs: int
    exact: bool
    complete: bool
    friction: bool
    joints: list[JointData]
    open_pairs: list[OpenPairData]
    level: LevelWord | None
    pairs_decide: bool
    if_joined: JoinedRegionData | None
    rests: list[RestData]
    gap_deg: Annotated[float | None, Field(description="[deg]")]
    proved: bool
    accuracy_deg: Annotated[float, Field(description="[deg]")]
    warnings: list[str]
    seconds: Seconds
