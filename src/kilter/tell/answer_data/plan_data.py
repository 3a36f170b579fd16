<<<<<<< HEAD
"""Data of the answer of `kilter plan`."""
=======
"""Data of the answer of `kilter hold`."""
>>>>>>> ans3

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

<<<<<<< HEAD
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
=======
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
>>>>>>> ans3
    interrupted: bool
    time_limit: Annotated[float | None, Field(description="[s]")]
    warnings: list[str]
    seconds: Seconds
    sentence: str
