"""Data of the answer of `kilter plan`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import (
    LevelWord,
    Lines,
    OpenPairData,
    PairNames,
    Seconds,
    Twist,
    Units,
    Vector,
    Word,
)

__all__ = ["PlanData"]

PlanWord = Annotated[
    str,
    Field(json_schema_extra={"enum": ["found", "none-found", "impossible", "undecided", "fails"]}),
]


class StepData(TypedDict):
    """A step of a plan."""

    parts: list[str]
    direction: Annotated[Vector | None, Field(description="motion of the insertion, unit")]
    path: Annotated[
        Lines,
        Field(description="positions of the part, relative to its final position [length unit]"),
    ]
    over: str | None
    touches: list[str]
    rubs: list[str]
    held: list[str]
    grips: list[str]
    releases: list[str]
    down: Vector
    verdict: Word
    level: LevelWord | None
    fails: list[str]


class FinishedData(TypedDict):
    """Verdict and level of the finished assembly."""

    verdict: Word
    level: LevelWord | None


class ImpossibleData(TypedDict):
    """Proof that no order of assembly exists, or none with so few held parts."""

    kind: Literal["falls", "locking", "exhaustion", "closure"]
    holds: int | None
    parts: list[str]
    motions: list[dict[str, Twist] | None] | None


class FewestData(TypedDict):
    """The minimised quantity, and the scope of the proof."""

    what: str
    least: Annotated[str, Field(json_schema_extra={"enum": ["always", "as-tried"]})] | None


class SearchData(TypedDict):
    """Numbers of states, programs and other steps of the search for a plan."""

    states: int
    programs: int
    sweeps: int
    no_goods: int
    exhausted: bool
    hold: int


class AssumesData(TypedDict):
    """Assumptions of a plan."""

    directions: list[str | Vector]
    tolerance: float
    screws: list[PairNames]
    groups: list[list[str]]
    together: bool
    press: Annotated[float, Field(description="[N]")]
    carried: Annotated[
        float | Vector | None,
        Field(description="horizontal size or vector of the carrier's acceleration [m/s^2]"),
    ]
    turn: bool


class PlanData(TypedDict):
    """Answer of plan: an order of assembly, or a proof that no order exists."""

    found: bool
    verdict: Annotated[
        str,
        Field(
            json_schema_extra={"enum": ["found", "none-found", "impossible", "undecided", "fails"]}
        ),
    ]
    level: LevelWord | None
    holds: bool
    require: LevelWord
    holds_max: int
    held_steps: int
    turns: int
    units: Units
    base: list[str]
    steps: list[StepData]
    finished: FinishedData
    open_pairs: list[OpenPairData]
    precedence: list[PairNames]
    impossible: ImpossibleData | None
    best: list[str]
    given: bool
    fewest: FewestData
    search: SearchData
    assumes: AssumesData
    interrupted: bool
    time_limit: Annotated[float | None, Field(description="[s]")]
    warnings: list[str]
    seconds: Seconds
    sentence: str
