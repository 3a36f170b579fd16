"""Data of the answer of `kilter margin`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import (
    Guarantee,
    JointData,
    LevelWord,
    LimitData,
    OpenPairData,
    PairNames,
    Reason,
    Seconds,
    Units,
    Vector,
    Word,
)

__all__ = ["MarginData"]

Interval = Annotated[
    list[float | None],
    Field(min_length=2, max_length=2, description="least and greatest; null: unlimited"),
]


class LevelLimitData(TypedDict):
    """A limit at a level of stability: values on both sides of it, or why they are unknown."""

    inside: float | None
    outside: float | None
    why: Reason | None


class LevelLimitsData(TypedDict):
    """For each margin, the limit up to which the assembly reaches the required level."""

    level: LevelWord
    tilt_deg: Annotated[LevelLimitData | None, Field(description="[deg]")]
    about_deg: Annotated[LevelLimitData | None, Field(description="[deg]")]
    friction: LevelLimitData | None
    load_factor: list[LevelLimitData | None] | None
    pushes: Annotated[dict[str, LevelLimitData | None], Field(description="by part [N]")]
    loads: Annotated[dict[str, LevelLimitData | None], Field(description="by part [N]")]


class AboutData(TypedDict):
    """Limit of a turn of gravity about an axis."""

    axis: Annotated[Vector, Field(description="the other sense has the opposite axis")]
    tilt_deg: Annotated[
        float | None, Field(description="by the right-hand rule [deg]; null: a full turn is held")
    ]
    limit: LimitData


class FrictionLimitData(TypedDict):
    """Proof of the least friction coefficient."""

    lower: float
    attained: bool
    residual: float
    moves: list[str]


class OpeningBondData(TypedDict):
    """A bond that gives way in the mechanism, and its share of the work of all bonds."""

    parts: PairNames
    share: float


class BondLimitData(TypedDict):
    """Proof of the least share of the bond strength."""

    gap: float | None
    moves: list[str]
    opens: list[OpeningBondData]


class BracketData(TypedDict):
    """Bounds of the least and of the greatest load factor, if slipping contacts do not dilate."""

    least: Interval | None
    greatest: Interval | None


class PushData(TypedDict):
    """Greatest push at the centre of mass of a part, in its weakest direction."""

    part: str
    direction: Vector
    force: Annotated[float | None, Field(description="[N]; null: unlimited")]
    lower: Annotated[float | None, Field(description="force that is proved to be held [N]")]
    limit: LimitData


class PartLoadData(TypedDict):
    """Additional load straight down that a part carries."""

    part: str
    load: Annotated[float | None, Field(description="[N]; null: unlimited")]
    mass: Annotated[float | None, Field(description="[kg]")]
    beyond: Annotated[float | None, Field(description="load that is proved not to be held [N]")]
    residual: float
    moves: list[str]


class WorstData(TypedDict):
    """Mass factor and shift of the centre of mass of a part in the worst case."""

    mass_factor: float
    shift: Annotated[Vector, Field(description="shift of the centre of mass [length unit]")]


class UncertaintyData(TypedDict):
    """Limits for the worst case of inexact data."""

    mass: Annotated[list[float], Field(min_length=2, max_length=2)]
    com: Annotated[float, Field(description="[length unit]")]
    mu: Annotated[list[float], Field(min_length=2, max_length=2)]
    normal_deg: Annotated[float, Field(description="[deg]")]
    kind: Literal["exact", "inner"]
    held: bool
    tilt_deg: Annotated[float | None, Field(description="[deg]")]
    load_factor: Interval | None
    missing: dict[str, Reason]
    corners: int
    worst: dict[str, WorstData] | None


class HelpData(TypedDict):
    """A part to hold or another change that widens a margin, and the gain."""

    of: Literal["tilt", "load factor"]
    what: Literal["hold", "friction", "mass"]
    parts: list[str]
    by: Annotated[
        float | None, Field(description="more mu, or share of the mass; null: a part is held")
    ]
    gain: Annotated[float | None, Field(description="of a second margin; null: unlimited")]
    sentence: str


class MarginData(TypedDict):
    """Answer of margin: limits of tilt, friction, load factor and pushes."""

    verdict: Word
    sentence: str
    guarantee: Guarantee
    units: Units
    down: Vector
    joints: list[JointData]
    open_pairs: list[OpenPairData]
    exact: bool
    level: LevelWord
    require: LevelWord
    tilt_deg: Annotated[float | None, Field(description="[deg]")]
    tilt_outside: Annotated[Word | None, Field(description="verdict beyond the tilt limit")]
    at_level: LevelLimitsData | None
    tilt_lower_deg: Annotated[float | None, Field(description="[deg]")]
    tilt_upper_deg: Annotated[float | None, Field(description="[deg]")]
    tilt_down: Vector | None
    tilt_limit: LimitData | None
    about: AboutData | None
    friction: Annotated[float | None, Field(description="least coefficient [-]")]
    friction_limit: FrictionLimitData | None
    clamped_by: Annotated[
        list[str], Field(description="bonds and straps, of which `bond` is the needed share")
    ]
    bond: Annotated[
        float | None,
        Field(description="least share of the strength of bonds and straps that is enough [-]"),
    ]
    bond_limit: BondLimitData | None
    load_factor: Interval | None
    load_factor_bracket: BracketData | None
    load_limits: list[LimitData | None] | None
    pushes: list[PushData]
    loads: list[PartLoadData]
    missing: Annotated[dict[str, Reason], Field(description="limits without a value, and why")]
    uncertainty: UncertaintyData | None
    helps: list[HelpData]
    warnings: list[str]
    seconds: Seconds
