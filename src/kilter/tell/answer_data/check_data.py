"""Data of the answer of `kilter check`."""

from __future__ import annotations

from typing import Annotated, Literal, NotRequired

from pydantic import Field
from typing_extensions import TypedDict

from kilter.tell.answer_data.common_data import (
    Guarantee,
    JointData,
    LevelWord,
    Lines,
    LoneData,
    OpenPairData,
    PairNames,
    Seconds,
    ToleranceData,
    Twist,
    Units,
    UnsupportedData,
    Vector,
    Word,
)

__all__ = ["CheckData"]


class TriesData(TypedDict):
    """Number of tries (parts put down loosely) that came to rest, and number of all tries."""

    passed: int
    of: int


class RemedyData(TypedDict):
    """Options that were tried, and their result."""

    option: str
    leads_to: Word | None
    level: LevelWord | None
    moved: Annotated[
        float | None,
        Field(description="largest movement of a part [length unit]; null for other options"),
    ]
    words: str


class NeutralData(TypedDict):
    """Numbers of motions that cost no energy to first order."""

    two_sided: int
    one_sided: int | None


class SecondOrderData(TypedDict):
    """Answer of second order; counts are null if kilter did not count."""

    state: Literal["minimum", "free", "balanced", "open"]
    neutral: int | None
    free: int | None
    blocked: int | None
    undecided: int | None
    rate: Annotated[float | None, Field(description="angular frequency, or rate of growth [1/s]")]
    motion: Annotated[
        dict[str, Twist] | None, Field(description="a motion that falls or is free, by part")
    ]
    rolling: Literal["holds", "falls", "open"] | None
    why: str | None
    left_open: str | None
    bending: Annotated[
        list[str], Field(description="parts that a small push may make roll, rock or swing on")
    ]


class DensityData(TypedDict):
    """Densities from which masses of free parts are computed."""

    given: Annotated[
        Annotated[list[float], Field(min_length=2, max_length=2)] | None,
        Field(description="range of the stated densities [kg/m^3]"),
    ]
    default: Annotated[float | None, Field(description="[kg/m^3]")]


class PartData(TypedDict):
    """A part: its mass, and how it starts to move."""

    name: str
    grounded: bool
    mass: Annotated[float, Field(description="[kg]")]
    material: Annotated[str | None, Field(description="name of the material in the file")]
    layer: Annotated[str | None, Field(description="name of the layer in the file")]
    displacement: Annotated[Twist | None, Field(description="[length unit, rad]")]
    acceleration: Annotated[Twist | None, Field(description="[m/s^2, rad/s^2]")]
    relative: Annotated[
        Annotated[list[float], Field(min_length=2, max_length=2)] | None,
        Field(description="acceleration of translation and of rotation, relative to gravity [-]"),
    ]
    moves: bool
    moved_by_proof: bool
    motion: Annotated[str | None, Field(description="the motion in words")]
    slow_motion: str | None


class CountData(TypedDict):
    """Numbers of touching pairs, contact patches and contact points."""

    pairs: int
    patches: int
    points: int


class JoinedData(TypedDict):
    """Open pairs that decide, and the verdict with these pairs joined."""

    pairs: list[PairNames]
    verdict: Word
    smallest: bool
    irreducible: bool


class BondData(TypedDict):
    """A bond of two parts and its strength."""

    parts: PairNames
    pull: NotRequired[Annotated[float, Field(description="[N] at each point")]]
    pull_per_area: NotRequired[Annotated[float, Field(description="[N/length unit^2]")]]
    kind: NotRequired[Literal["glue", "mortar", "magnet", "suction", "press-fit"]]
    shear: Annotated[
        float | Annotated[str, Field(json_schema_extra={"enum": ["mu"]})] | None,
        Field(description='largest sideways force at each point [N]; "mu": by friction'),
    ]


class BondsNeededData(TypedDict):
    """Least share of bond strength that suffices, and the pairs that fail first below it."""

    share: float
    fail: list[PairNames]


class CertificateData(TypedDict):
    """Kind of the proof (forces or a motion), and its numerical errors; null for a missing part."""

    kind: Literal["forces", "motion"] | None
    residual: float | None
    power: Annotated[
        float | None, Field(description="of the motion if its fastest part moves at 1 m/s [W]")
    ]
    violation: float | None


class WitnessData(TypedDict):
    """A motion that obeys the contact law, although forces of equilibrium exist."""

    power: float
    residual: float
    found: str


class SeatingData(TypedDict):
    """Result of the search for a seat (a state of rest with slightly elastic contacts)."""

    seated: Literal["yes", "runs-away", "not-found"]
    residual: float
    direction: list[Twist] | None


class SettlingData(TypedDict):
    """How each try (parts put down loosely) ended, and the number of tries."""

    ends: list[Literal["balance", "runs-away", "not-found"]]
    of: int


class ExclusionData(TypedDict):
    """Result of the attempt to prove that no motion can start."""

    proved: bool
    kind: Literal["moments", "contraction", "modes", "sectors"] | None
    programs: int
    bound: float
    assumes: str


class FrictionData(TypedDict):
    """Guarantee of friction, with the evidence for and against a motion."""

    witness: WitnessData | None
    seating: SeatingData
    settling: SettlingData
    exclusion: ExclusionData | None
    effort: float
    work: float


class PatchForceData(TypedDict):
    """Contact forces of a patch on the second part of its pair [N]."""

    parts: PairNames
    kind: str
    resultant: Vector
    normal_force: float
    center: Annotated[Vector | None, Field(description="centre of pressure [length unit]")]
    utilisation: Annotated[
        float | None, Field(description="least share of the friction that its points need [-]")
    ]
    bond_utilisation: Annotated[float | None, Field(description="share of the bond [-]")]
    points: Annotated[Lines, Field(description="[length unit], world frame")]
    forces: Annotated[Lines, Field(description="[N], world frame")]


class JointForceData(TypedDict):
    """Forces along the axis of a prismatic joint on its first part [N].

    Of a revolute joint, torques about the axis [N x length unit].
    """

    parts: PairNames
    kind: Literal["revolute", "prismatic"]
    stop: Annotated[float, Field(description="of the limit at which the joint stands, else 0")]
    friction: float
    spring: float


class ForcesData(TypedDict):
    """Contact forces that balance every part, and forces of joints with limits and the like."""

    least: bool
    residual: float
    patches: list[PatchForceData]
    joints: NotRequired[list[JointForceData]]


class CheckToleranceData(ToleranceData):
    """Tolerances of contact detection and of the verdict."""

    verdict: Annotated[
        float, Field(description="limit of the residual and of the power of a proof [-]")
    ]
    moves: Annotated[float, Field(description="smallest relative size of a motion that counts [-]")]


class SuggestionData(TypedDict):
    """A pair that looks fastened, and the option that fastens it."""

    parts: PairNames
    kind: Literal["thread", "press fit", "insert", "overlap", "same body", "size on size"]
    why: str
    option: str
    joint: Annotated[
        dict[str, object] | None,
        Field(description="entry to add to the joints of an assembly file"),
    ]


class CheckData(TypedDict):
    """Answer of check: the verdict, its level and proof, the moving parts and the forces."""

    verdict: Word
    level: LevelWord | None
    require: LevelWord
    holds: bool
    first_order: Word
    why: (
        Literal["refuted", "jams", "squeeze", "not-found", "not-asked", "push-open", "balanced"]
        | None
    )
    guarantee: Guarantee
    seated: str | None
    tries: TriesData | None
    sentence: str
    summary: str
    remedies: list[RemedyData]
    neutral: NeutralData | None
    second_order: SecondOrderData | None
    down: Vector
    gravity: Annotated[Vector, Field(description="[m/s^2]")]
    units: Units
    density: DensityData
    instability: Annotated[float | None, Field(description="kappa [-]")]
    z: Annotated[
        float | None, Field(description="value of the displacement program [kg x length unit]")
    ]
    parts: list[PartData]
    contacts: CountData
    unsupported: list[UnsupportedData]
    open_pairs: list[OpenPairData]
    counted_gap: Annotated[float | None, Field(description="[length unit]")]
    if_joined: JoinedData | None
    nearest: list[LoneData]
    joints: list[JointData]
    bonds: list[BondData]
    bonds_needed: BondsNeededData | None
    certificate: CertificateData
    friction: FrictionData | None
    forces: ForcesData | None
    tolerance: CheckToleranceData
    warnings: list[str]
    time_limit: Annotated[float | None, Field(description="[s]")]
    seconds: Seconds
    suggested_joints: NotRequired[
        Annotated[list[SuggestionData], Field(description="of the option --suggest-joints")]
    ]
