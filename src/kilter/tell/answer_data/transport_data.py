"""Data of the answer of `kilter transport`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import (
    Guarantee,
    JointData,
    LevelWord,
    LimitData,
    OpenPairData,
    Reason,
    Seconds,
    Units,
    Vector,
    Word,
)

__all__ = ["TransportData"]


class FirstMotionData(TypedDict):
    """How a part starts to move, in words."""

    part: str
    words: str


class DirectionLimitData(TypedDict):
    """Largest acceleration of the carrier in a direction at which forces can hold the parts."""

    name: str
    direction: Vector
    acceleration: Annotated[
        float | None, Field(description="largest carried [m/s^2]; null: unlimited")
    ]
    upper: Annotated[float | None, Field(description="proved not to be carried beyond [m/s^2]")]
    g: Annotated[float | None, Field(description="upper, in units of g; null: unlimited")]
    moves: Annotated[list[str], Field(description="parts that move first, the fastest first")]
    how: Annotated[str, Field(description="slides, tips, or other words: the first of them")]
    least: Annotated[bool, Field(description="whether it is the weakest horizontal direction")]
    motion: list[FirstMotionData]
    limit: LimitData


class CarrierMotionData(TypedDict):
    """A motion of the carrier."""

    acceleration: Annotated[Vector, Field(description="[m/s^2]")]
    angular_velocity: Annotated[Vector, Field(description="[rad/s]")]
    angular_acceleration: Annotated[Vector, Field(description="[rad/s^2]")]
    about: Annotated[Vector, Field(description="point of the carrier [length unit]")]


class CaseData(CarrierMotionData):
    """Whether the parts stay in place at a motion of the carrier, and how surely."""

    name: str
    g: Annotated[float, Field(description="size of the acceleration [g]")]
    carried: Annotated[bool | None, Field(description="at the required level; null: undecided")]
    verdict: Word
    level: LevelWord | None
    guarantee: Guarantee
    factor: Annotated[float | None, Field(description="largest factor of the motion [-]")]
    motion: list[FirstMotionData]
    limit: LimitData | None


class PolarData(TypedDict):
    """Boundary of the horizontal accelerations at which contact forces can hold the parts."""

    axes: list[Vector]
    points: Annotated[list[list[float]], Field(description="along the axes [g]")]
    limited: list[bool]
    proved: list[bool]
    normals: list[list[float]]
    reach: Annotated[list[float], Field(description="farthest acceleration along each normal [g]")]
    gap: Annotated[float | None, Field(description="from the points to the bounding lines [g]")]


class CollapseData(TypedDict):
    """Multiplier of horizontal forces at which a mechanism starts, with its participating mass."""

    name: str
    direction: Annotated[Vector, Field(description="of the forces, unit")]
    alpha0: Annotated[float | None, Field(description="[-]; null: unlimited")]
    upper: Annotated[float | None, Field(description="multiplier proved not to be carried [-]")]
    participating_mass: Annotated[float | None, Field(description="M* [kg]")]
    e: Annotated[float | None, Field(description="M* over the mass of all free parts [-]")]
    a0: Annotated[float | None, Field(description="spectral acceleration a0* for e [m/s^2]")]
    e_moving: Annotated[float | None, Field(description="M* over the mass of moving parts [-]")]
    a0_moving: Annotated[
        float | None, Field(description="spectral acceleration a0* for e_moving [m/s^2]")
    ]
    unique: Annotated[
        bool | None, Field(description="false: other mechanisms at alpha0 have a smaller M*")
    ]
    moves: list[str]


class StrapUseData(TypedDict):
    """A strap and its pull in the forces that prove that the assembly holds."""

    name: str
    tension: Annotated[float | None, Field(description="[N]; null: the strap has a capacity")]
    capacity: Annotated[float | None, Field(description="[N]; null: the strap has a tension")]
    used: Annotated[
        float | None,
        Field(description="largest pull over the cases [N]; null: not known"),
    ]


class PathData(TypedDict):
    """Largest factor on the speed along a path at which contact forces can hold the parts."""

    samples: int
    duration: Annotated[float, Field(description="[s]")]
    factor: Annotated[float | None, Field(description="largest speed factor [-]")]
    lower: Annotated[float | None, Field(description="factor proved to be carried [-]")]
    slowest: Annotated[float, Field(description="factor below which a part slides [-]")]
    time: Annotated[float | None, Field(description="time of the first motion [s]")]
    between_samples: bool
    moves: list[str]
    factors: list[float | None]
    times: Annotated[list[float], Field(description="[s]")]


class TransportData(TypedDict):
    """Answer of transport: accelerations of the carrier that the assembly withstands."""

    sentence: str
    carried: bool | None
    verdict: Word
    level: LevelWord | None
    require: LevelWord
    units: Units
    down: Vector
    gravity: Annotated[float, Field(description="[m/s^2]")]
    friction: bool
    mu_range: Annotated[
        list[float] | None, Field(description="factors on every mu; the limits are of the least")
    ]
    joints: list[JointData]
    open_pairs: list[OpenPairData]
    exact: bool
    limits: Annotated[
        list[DirectionLimitData],
        Field(description="along +x -x +y -y +z -z; then the weakest horizontal direction"),
    ]
    polar: PolarData | None
    alpha: list[CollapseData]
    fc: Annotated[float | None, Field(description="confidence factor FC [-]")]
    code: str | None
    forward: Annotated[Vector | None, Field(description="direction of travel of the code")]
    cases: list[CaseData]
    straps: list[StrapUseData]
    speed: Annotated[PathData | None, Field(description="of a path")]
    missing: dict[str, Reason]
    warnings: list[str]
    seconds: Seconds
