"""`kilter.orient`: the stable orientation with the widest margin, or the nearest to stable.

The region says which directions of gravity are stable, or with friction have forces that hold
it, and which of them lies farthest from the boundary. The verdict there is proved anew by
contact forces. If the cone without friction is empty, a motion for each facet of the diamond
proves that no direction is stable: it gains energy at every corner of the facet, hence
everywhere on it. Then the nearest direction without friction is given.

The region is that of the contacts that are modelled; more contacts can only make it wider. So
a direction that is found is held. If no direction is found and such contacts exist, or the region
with friction does not prove that it is empty, "none" is tested again with every force they
might bring, else it is undecided.

References
----------
Mattikalli, Khosla, Repetto and Baraff (1993), sections 2.3 and 3.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from kilter.analysis.analysis_tolerances import OPPOSITE
from kilter.analysis.check import check, given_direction_known
from kilter.analysis.decision.judge import Judgement, judge
from kilter.analysis.decision.motion import NO_MOTION
from kilter.analysis.decision.open_question import open_pair_names
from kilter.analysis.regions.polyhedral_cone import Cone, plain_direction
from kilter.analysis.regions.region import LARGE, Region, region_of
from kilter.analysis.regions.stable_cone import stable_cone
from kilter.analysis.turning.facet_program import DiamondOptimum, Method, Nearest, joint, nearest
from kilter.analysis.verdict.answers import OfAssembly
from kilter.analysis.verdict.part_answer import PartAnswer
from kilter.analysis.verdict.verdict import Verdict
from kilter.analysis.verdict.verdict_answer import VerdictTolerance
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.bonds import NO_CONE, require_no_bonds
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.contact.common.patches import UnsupportedContact
from kilter.errors import InputError
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.clusters import clusters, different_clusters
from kilter.mechanics.program import Program, bounding_program, build_program
from kilter.rigid import rotation_between
from kilter.tell.numbers import vector
from kilter.tell.record import InPython, LevelWord, Record, Shape, Vector, key
from kilter.tell.words import found_sentence
from kilter.validate import frozen
from kilter.work import seconds_left

OF_REGION = 0.7
"""Fraction of a time limit for the region; the rest is for the verdict of its direction."""


class RegionWidth(Record):
    """Kind and angular width of the region of stable directions."""

    kind: str
    """Kind of the region (`kilter.region`)."""
    half_angle_deg: float | None
    """Half angle of the widest circular cone inside [deg]."""
    friction: bool
    """Whether forces of friction were counted."""


class Orientation(OfAssembly):
    """Answer of `kilter.orient`: the stable direction of gravity with the widest margin.

    Without a stable direction, the direction nearest to stable.
    """

    answer: ClassVar[str] = "orient"

    verdict: Literal["found", "none", "undecided"]
    """Whether a stable direction was found, or is proved not to exist."""
    sentence: str
    """The verdict in words."""
    level: LevelWord | None = None
    """Level at `down`, with second order and without the guarantee of friction."""
    direction: InPython[Vector]
    """The direction `down`."""
    rotation: Annotated[Array, Shape(4)]
    """Quaternion w x y z of the least turn that takes `down` to the gravity of the file."""
    tilt_margin_deg: float | None = None
    """From `down` to the nearest direction that is not stable [deg]; 0 if the region is thinner
    than space (than the plane, if planar); None if no direction was found."""
    friction: bool
    """Whether forces of friction were counted: then forces hold the found direction, and `check`
    reports the guarantee of friction there."""
    z: float | None = None
    """z at `down` for gravity of length 1 [kg x length unit]; None if no solver finished it."""
    instability: float | None = None
    """kappa at `down` [-]; None if no solver finished it."""
    nearest: Nearest | None = None
    """Directions nearest to stable, if no direction was found."""
    method: Method
    """Method for the direction nearest on the paper's diamond."""
    programs: int
    """Number of programs solved, verdicts left out."""
    judgement: InPython[Judgement]
    """The proof at `down`."""
    check: InPython[Verdict | None] = None
    """Verdict at `down`, if no direction was found."""
    stable_region: InPython[Region]
    """All stable directions. With friction and more than 1,000 contact points, only the widest
    circular cone in it is known to within 0.1 deg."""
    region: RegionWidth
    """Kind and angular width of the region of stable directions."""
    warnings: tuple[str, ...]
    """Warnings about the assembly and its contacts."""

    @property
    @key
    def down(self) -> Vector:
        """Unit direction of gravity in the frame of the assembly.

        It is stable if found, else the nearest on the paper's diamond.
        """
        return self.direction

    @property
    @key
    def residual(self) -> float | None:
        """Largest imbalance of a part in the found direction, divided by its weight [-]."""
        forces = self.judgement.forces
        return forces.residual if self.found and forces is not None else None

    @property
    @key
    def parts(self) -> tuple[PartAnswer, ...]:
        """How each part starts to move, if no direction was found."""
        return () if self.check is None else self.check.parts

    @property
    @key
    def unsupported(self) -> tuple[UnsupportedContact, ...]:
        """Contacts of kinds that are not modelled, if no direction was found."""
        return () if self.check is None else self.check.unsupported

    @property
    @key
    def tolerance(self) -> VerdictTolerance | None:
        """Tolerances of the verdict, if no direction was found."""
        return None if self.check is None else self.check.tolerance

    @property
    @key
    def found(self) -> bool:
        """Whether the direction `down` is stable, proved by contact forces."""
        return self.verdict == "found"

    def __str__(self) -> str:
        return self.sentence

    def __repr__(self) -> str:
        margin = self.tilt_margin_deg
        width = "" if margin is None else f", tilt margin {margin:.6g} deg"
        return f"Orientation({self.verdict}, down {vector(self.down)}{width})"


@question(lacks="require effort")
def orient(
    asked: Question,
    *,
    method: Method = "joint",
) -> Orientation:
    """Find the stable direction of gravity with the widest margin, or the nearest to stable.

    With friction: so that forces that hold it exist, in the middle of those directions.

    Parameters
    ----------
    assembly : Assembly, or path
        It has at least one held part, and no loads.
    method : {"joint", "walk"}
        For the nearest direction on the paper's diamond.

    Raises
    ------
    TimeLimitReached
        At the time limit, with the verdict of the given direction.
    InputError
        If nothing is held, loads are given, or the geometry is not usable.

    See Also
    --------
    kilter.region : every stable direction of gravity.
    kilter.check : the verdict on a direction, with ``down``.

    Examples
    --------
    >>> from kilter.scenes import scene, stacks
    >>> orient(scene("paper-figure-11"))
    Orientation(found, down (-0.707107, 0, -0.707107), tilt margin 0 deg)
    >>> round(orient(stacks.block_on_slope(40.0, friction=0.5)).tilt_margin_deg, 1)
    26.5
    """
    _require_turnable(asked.assembly, method)
    contacts = detect.touching(asked)
    with given_direction_known(asked.assembly, contacts, asked.seconds_left):
        return _orient(asked.but(contacts=contacts), method)


def _orientation(every: Region, down: Array, method: Method, **known: Any) -> Orientation:
    """The answer with a direction of gravity and a region."""
    assembly = every.assemblies[0]
    given: dict[str, Any] = {"programs": every.programs, "warnings": every.warnings} | known
    return Orientation(
        assembly=assembly,
        contacts=every.contacts[0],
        direction=down,
        rotation=frozen(_least_turn(assembly, down)),
        friction=every.friction,
        method=method,
        stable_region=every,
        region=RegionWidth(
            kind=every.kind, half_angle_deg=every.half_angle_deg, friction=every.friction
        ),
        **given,
    )


def _orient(asked: Question, method: Method) -> Orientation:
    """Find the orientation of an assembly with given contacts, as `orient`."""
    contacts, left, tell = detect.touching(asked), asked.seconds_left, asked.tell
    program = build_program(asked.assembly, contacts)
    tell("stable region")
    part = asked.within(None if left is None else OF_REGION * left)
    # of a large region only the facets around its widest cone matter
    widest = len(contacts.points) > LARGE
    every = region_of(part if program.mu.any() else part.but(progress=None), widest=widest)
    if every.kind == "none" and every.joined_holds:
        return _open_pairs_decide(program, every, method)
    tell("orientation")
    smooth = program.frictionless
    for turned_program, cone in _sides(program, every):
        for candidate in cone.candidates(program.down):
            for direction in _plain_first(candidate):
                judgement = judge(turned_program.turned(direction))
                if judgement.stable:
                    return _answer_of_direction(program, every, direction, judgement, method)
    best = joint(smooth, every=True)
    judgement = judge(smooth.turned(best.gravity))
    if judgement.stable:
        return _answer_of_direction(program, every, best.gravity, judgement, method)
    tell("nearest to stable")
    near = nearest(smooth, method=method, solved=best)
    why = [] if every.friction and every.none else _open_questions(contacts, every, smooth, best)
    answer = _not_found(every, judgement, near, method, why)
    seconds_left(None)  # an answer whose last steps were cut short is no answer
    return answer


def _plain_first(direction: Array) -> list[Array]:
    """The direction without components that come from rounding, if it has any, and itself."""
    plain = plain_direction(direction)
    return [direction] if np.array_equal(plain, direction) else [plain, direction]


def _require_turnable(assembly: Assembly, method: str) -> None:
    """Reject an assembly without held parts, or with loads: loads do not turn with the parts."""
    if method not in ("joint", "walk"):
        raise InputError(f"the method {method!r} does not exist", hint="give 'joint' or 'walk'")
    require_no_bonds(assembly, "orient", NO_CONE)
    assembly.require_grounded()
    if assembly.loads:
        raise InputError(
            "a load is fixed in the world and does not turn with the assembly",
            file=assembly.source or None,
            part=assembly.loads[0].part,
            hint="leave the loads out to look for an orientation",
        )


def _open_pairs_decide(program: Program, every: Region, method: Method) -> Orientation:
    """The answer for a large assembly that no direction holds as drawn, but open pairs may hold.

    The direction nearest to stable is not searched for, since open pairs may change it.
    """
    assembly = every.assemblies[0]
    return _orientation(
        every,
        assembly.down,
        method,
        verdict="undecided",
        sentence=(
            "Undecided: as drawn no orientation is held, but if all open pairs were joined, forces "
            "that hold it with gravity as given would exist: "
            f"{open_pair_names(assembly, every.contacts[0])}."
        ),
        judgement=judge(program if every.friction else program.frictionless),
    )


def _sides(program: Program, every: Region) -> Iterator[tuple[Program, Cone]]:
    """Yield the program with its stable cone; with friction, then also both without friction.

    Forces without friction hold as well.
    """
    yield (program if every.friction else program.frictionless), every.cone
    if every.friction:
        yield program.frictionless, stable_cone(program.frictionless).cone


def _answer_of_direction(
    program: Program, every: Region, direction: Array, judgement: Judgement, method: Method
) -> Orientation:
    """The answer for a direction of gravity that forces are proved to hold."""
    assembly, contacts = every.assemblies[0], every.contacts[0]
    down = direction / float(np.linalg.norm(direction)) + 0.0
    margin = _tilt_margin_deg(program, every, down)
    z: float | None = 0.0
    instability: float | None = 0.0
    turned = assembly.with_down(down)
    verdict = check(turned, contacts=contacts.of(turned), require="equilibrium")
    if every.friction:
        z, instability = verdict.displacement.z, verdict.kappa
    sentence = _sentence(every, down, margin)
    if verdict.verdict == "balanced":
        sentence += " There it is balanced: the slightest push makes it fall."
    return _orientation(
        every,
        frozen(down),
        method,
        verdict="found",
        sentence=sentence,
        tilt_margin_deg=margin,
        z=z,
        instability=instability,
        judgement=judgement,
        level=verdict.level,
    )


def _sentence(every: Region, down: Array, margin: float) -> str:
    """Sentence for users about the recommended direction of gravity."""
    return found_sentence(
        down,
        margin,
        friction=every.friction,
        exact=every.exact,
        within=every.kind if every.dimension > 1 else None,
        half_angle_deg=every.half_angle_deg,
    )


def _tilt_margin_deg(program: Program, every: Region, down: Array) -> float:
    """Angle from `down` to the boundary of the stable region [deg]; 0 if the region is thin."""
    if every.dimension < (2 if program.planar else 3):
        return 0.0
    if not len(every.cone.facets):
        return 180.0
    return float(np.degrees(every.cone.depth(down)))


def _not_found(
    every: Region, judgement: Judgement, near: Nearest, method: Method, why: list[str]
) -> Orientation:
    """The answer if no direction was proved stable; `why` lists reasons for doubt."""
    assembly = every.assemblies[0]
    down = near.diamond.direction
    verdict = check(assembly.with_down(down), contacts=every.contacts[0])
    # the region has named the parts that touch nothing
    more = [text for text in verdict.notes if not text.startswith("touches nothing")]
    more += [] if verdict.motion.known else [NO_MOTION]
    if why:
        sentence = f"Undecided: {'; '.join(why)}."
    else:
        first = "No orientation is stable. The orientation nearest to stable"
        if every.friction:
            first = (
                "No orientation is held, even with friction. The orientation nearest to stable "
                "without friction"
            )
        sentence = (
            f"{first} has gravity along {vector(down)} of the assembly's frame; here are the parts "
            "that move there."
        )
    return _orientation(
        every,
        down,
        method,
        verdict="undecided" if why else "none",
        sentence=sentence,
        z=verdict.displacement.z,
        instability=verdict.kappa,
        nearest=near,
        programs=every.programs + near.programs,
        judgement=judgement,
        check=verdict,
        warnings=tuple(dict.fromkeys([*every.warnings, *more])),
    )


def _open_questions(
    contacts: ContactSet, every: Region, program: Program, best: DiamondOptimum
) -> list[str]:
    """Reasons why a stable direction may exist unseen; empty if a proof excludes all."""
    assembly = every.assemblies[0]
    if not _none_is_stable(program, best):
        return [
            "numerical errors prevent a proof that a direction is stable, and that none is (best "
            f"z = {best.z:.2g} kg {assembly.units}, free mass "
            f"{float(program.mass[program.free].sum()):.2g} kg)"
        ]
    outer = bounding_program(assembly, contacts)
    if len(outer.part_a) == len(program.part_a):
        return []
    if _none_holds(outer):
        return []
    why = []
    if every.friction:
        why.append(
            "without friction no orientation is stable, but friction could hold the assembly"
        )
    if contacts.open_pairs:
        why.append(f"open pairs could hold it: {open_pair_names(assembly, contacts)}")
    return why or [
        "a polygon replaces a round face: the polygon could hold it, but the circle might not"
    ]


def _none_holds(program: Program) -> bool:
    """Whether motions of a cluster, or of all parts, prove that no direction is stable.

    A direction that does not hold a cluster does not hold the assembly.
    """
    parted = [] if program.has_limits else clusters(program)
    chosen = np.unique(different_clusters(parted)).tolist() if len(parted) > 1 else []
    single = (parted[k].program for k in chosen)
    return any(
        _none_is_stable(part, joint(part, every=True))
        for part in itertools.chain(single, [program])
    )


def _none_is_stable(program: Program, best: DiamondOptimum) -> bool:
    """Whether motions prove for every facet of directions that none of them is stable."""
    for facet in best.facets:
        for axis in np.flatnonzero(facet.signs):
            corner = np.zeros(3)
            corner[axis] = facet.signs[axis]
            if not check_motion(program.turned(corner), facet.motion).holds:
                return False
    return True


def _least_turn(assembly: Assembly, down: Array) -> Array:
    """Quaternion of the least turn of the assembly that takes `down` to gravity, shape (4,)."""
    opposite = float(np.linalg.norm(down + assembly.down)) < OPPOSITE
    if assembly.planar and opposite:
        return np.array([0.0, 0.0, 1.0, 0.0])
    return rotation_between(down, assembly.down) + 0.0
