"""Data that several answers share: vectors, levels, open pairs, joints and limits."""

from __future__ import annotations

from typing import Annotated, Literal, NotRequired

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.levels import LEVELS, VerdictWord

__all__ = [
    "JointData",
    "LevelWord",
    "Lines",
    "MechanismData",
    "OpenPairData",
    "PairNames",
    "Reason",
    "Seconds",
    "ToleranceData",
    "Twist",
    "Units",
    "UnsupportedData",
    "Vector",
    "WarnedData",
    "Word",
]

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Twist = Annotated[
    list[float],
    Field(min_length=6, max_length=6, description="motion of the centre of mass, and rotation"),
]
PairNames = Annotated[list[str], Field(min_length=2, max_length=2)]
Lines = list[Vector]
Word = Annotated[str, Field(json_schema_extra={"enum": [word.value for word in VerdictWord]})]
LevelWord = Annotated[str, Field(json_schema_extra={"enum": list(LEVELS)})]
Units = Annotated[str, Field(json_schema_extra={"enum": ["m", "cm", "mm", "in"]})]
Guarantee = Annotated[str, Field(json_schema_extra={"enum": ["proved", "refuted", "open"]})]
Reason = Annotated[
    str,
    Field(
        json_schema_extra={"enum": ["none", "failed", "time", "effort"]},
        description="none: proved that no value is held; failed: the solvers gave no proof; time, "
        "effort: the limit was reached",
    ),
]
Seconds = Annotated[dict[str, float], Field(description="duration of each stage [s]")]
MechanismData = Annotated[
    dict[str, Twist],
    Field(description="motion of each free part at the limit [length unit, rad]"),
]


class JointData(TypedDict):
    """A joint of two parts, or of a part and "ground"."""

    parts: PairNames
    kind: Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical"]
    why: NotRequired[Annotated[str, Field(description="reason for a fastened joint")]]
    limits: NotRequired[
        Annotated[
            list[float], Field(description="least and largest position [rad] or [length unit]")
        ]
    ]
    friction: NotRequired[
        Annotated[float, Field(description="largest friction [N x length unit] or [N]")]
    ]
    stiffness: NotRequired[
        Annotated[
            float,
            Field(description="of the spring [N x length unit / rad] or [N / length unit]"),
        ]
    ]
    rest: NotRequired[
        Annotated[
            float,
            Field(description="position without a force of the spring [rad] or [length unit]"),
        ]
    ]


class PlainOpenPairData(TypedDict):
    """A pair of parts whose contact the geometry does not determine."""

    parts: PairNames
    kind: Literal["overlap", "clearance", "near", "free-form", "degenerate", "unexamined"]
    gap: Annotated[float | None, Field(description="[length unit]; negative if they penetrate")]
    depth: Annotated[float | None, Field(description="[length unit]")]
    volume: Annotated[float | None, Field(description="[length unit^3]")]
    why: str


class OpenPairData(PlainOpenPairData):
    """An open pair, and whether it decides the verdict."""

    decides: bool


class UnsupportedData(TypedDict):
    """A contact of a kind that is not modelled."""

    parts: PairNames
    kind: str
    point: Annotated[Vector, Field(description="[length unit], world frame")]


class ToleranceData(TypedDict):
    """Tolerances of contact detection."""

    gap: Annotated[float, Field(description="[length unit]")]
    angle_deg: Annotated[float, Field(description="[deg]")]
    clearance: Annotated[float | None, Field(description="[length unit]")]


class NeighbourData(TypedDict):
    """A part that touches nothing, and the part nearest to it."""

    part: str
    nearest: str | None
    gap: Annotated[float | None, Field(description="[length unit]")]
    accuracy: Annotated[float | None, Field(description="largest error of the gap [length unit]")]


class LoneData(NeighbourData):
    """A part that touches nothing, its nearest part, and whether it is held."""

    grounded: bool


class LimitData(TypedDict):
    """Errors of the proofs on both sides of a limit, and the parts that move beyond it."""

    residual: Annotated[
        float, Field(description="largest imbalance of a part, divided by its weight [-]")
    ]
    gap: Annotated[
        float | None, Field(description="relative distance between the proved bounds [-]")
    ]
    moves: Annotated[list[str], Field(description="parts that move beyond the limit")]
    mechanism: MechanismData | None


class WarnedData(TypedDict):
    """The key of warnings, which most answers have."""

    warnings: list[str]
