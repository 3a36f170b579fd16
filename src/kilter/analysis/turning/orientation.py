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

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.check import check
from kilter.analysis.decision.judge import Judgement, judge
from kilter.analysis.decision.motion import NO_MOTION
from kilter.analysis.decision.open_question import open_pair_names, open_pairs_answer
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.region import Region, region
from kilter.analysis.regions.stable_cone import stable_cone
from kilter.analysis.time_limits import given_direction_known
from kilter.analysis.turning.facet_program import DiamondOptimum, joint
from kilter.analysis.turning.nearest import Method, Nearest, nearest
from kilter.analysis.turning_tolerances import OPPOSITE, PLAIN
from kilter.analysis.verdict.answers import joints_answer
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.bonds import NO_CONE, require_no_bonds
from kilter.assembly.verb_keywords import AssemblyOrPath, asked_assembly
from kilter.contact import ContactSet, Tolerance, detect
from kilter.errors import InputError
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.program import Program, bounding_program, build_program
from kilter.rigid import rotation_between
from kilter.tell.html import html_of
from kilter.tell.json_answer import Answer
from kilter.tell.numbers import vector
from kilter.tell.words import found_sentence
from kilter.threads import on_one_thread
from kilter.validate import frozen
from kilter.values.guesses import guarded
from kilter.work import seconds_left

if TYPE_CHECKING:
    from kilter.tell.answer_data.directions_data import OrientData

__all__ = ["Orientation", "orient"]

OF_REGION = 0.7
"""Fraction of a time limit for the region; the rest is for the verdict of its direction."""

Word = Literal["found", "none", "undecided"]


@dataclass(frozen=True, slots=True, eq=False)
class Orientation(Answer):
    """Answer of `kilter.orient`: a stable orientation, or the orientation nearest to stable.

    Attributes
    ----------
    assembly : Assembly
        Contacts of the assembly.
    verdict : {"found", "none", "undecided"}
    sentence : str
        The verdict in words.
    down : ndarray, shape (3,)
        Unit direction of gravity in the frame of the assembly: stable if found, else the
        nearest on the paper's diamond.
    rotation : ndarray, shape (4,)
        Quaternion (w, x, y, z) of the least turn that takes `down` to the gravity of the file.
    tilt_margin_deg : float or None
        From `down` to the nearest direction that is not stable; 0 if the region is thinner
        than space (than the plane, if planar); None if no direction was found.
    friction : bool
        Whether forces of friction were counted: then forces hold the found direction,
        and `check` reports the guarantee of friction there.
    z : float
        LP (9) at `down`, gravity of length 1 (2-norm, as in `check`) [kg x length unit]; None
        if no solver finished it.
    instability : float or None
        kappa at `down` [-]; None if no solver finished it.
    nearest : Nearest or None
        Directions nearest to stable, if no direction was found.
    method : {"joint", "walk"}
    programs : int
        Programs solved, verdicts left out.
    judgement : Judgement
        The proof at `down`.
    level : str or None
        The level at `down`, with second order and without the guarantee of friction.
    check : Verdict or None
        Verdict at `down`, if no direction was found.
    region : Region
    warnings : tuple of str
    """

    answer: ClassVar[str] = "orient"

    verdict: Word
    sentence: str
    assembly: Assembly
    down: Array
    rotation: Array
    tilt_margin_deg: float | None
    friction: bool
    z: float | None
    instability: float | None
    nearest: Nearest | None
    method: Method
    programs: int
    judgement: Judgement
    level: str | None
    check: Verdict | None
    region: Region
    warnings: tuple[str, ...]

    @property
    def found(self) -> bool:
        """Whether the direction `down` is stable, proved by contact forces."""
        return self.verdict == "found"

    def to_dict(self) -> OrientData:
        """The orientation as JSON data, as ``kilter orient --json`` prints it."""
        near, verdict, forces = self.nearest, self.check, self.judgement.forces
        verdict_data = None if verdict is None else verdict.to_dict()
        return {
            "verdict": self.verdict,
            "found": self.found,
            "level": self.level,
            "sentence": self.sentence,
            "down": self.down.tolist(),
            "rotation": self.rotation.tolist(),
            "tilt_margin_deg": self.tilt_margin_deg,
            "friction": self.friction,
            "residual": forces.residual if self.found and forces is not None else None,
            "z": self.z,
            "instability": self.instability,
            "units": self.assembly.units,
            "joints": joints_answer(self.assembly),
            "parts": [] if verdict_data is None else verdict_data["parts"],
            "unsupported": [] if verdict_data is None else verdict_data["unsupported"],
            "open_pairs": open_pairs_answer(self.assembly, self.region.contacts[0]),
            "tolerance": None if verdict_data is None else verdict_data["tolerance"],
            "region": {
                "kind": self.region.kind,
                "half_angle_deg": self.region.half_angle_deg,
                "friction": self.region.friction,
            },
            "nearest": None if near is None else near.to_dict(),
            "method": self.method,
            "programs": self.programs,
            "warnings": list(self.warnings),
        }

    def _repr_html_(self) -> str:
        """The orientation as HTML for a notebook."""
        return html_of(self.to_dict())

    def __str__(self) -> str:
        return self.sentence

    def __repr__(self) -> str:
        margin = self.tilt_margin_deg
        width = "" if margin is None else f", tilt margin {margin:.6g} deg"
        return f"Orientation({self.verdict}, down {vector(self.down)}{width})"


@guarded
@on_one_thread
def orient(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    method: Method = "joint",
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Orientation:
    """Find the stable direction of gravity with the widest margin, or the nearest to stable.

    With friction: so that forces that hold it exist, in the middle of those directions.

    Parameters
    ----------
    assembly : Assembly, or path
        It has at least one held part, and no loads.
    friction, down, ground, floor : optional
        Changes of the assembly before the question, as in `kilter.check`.
    method : {"joint", "walk"}
        For the nearest direction on the paper's diamond.
    contacts, tolerance, time_limit, progress : optional
        As in `kilter.check`.

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
    started = time.perf_counter()
    assembly = asked_assembly(
        assembly, "orient", contacts, friction=friction, down=down, ground=ground, floor=floor
    )
    _require_turnable(assembly, method)
    if contacts is None:
        contacts = detect.contacts(
            assembly, tolerance=tolerance, time_limit=time_limit, progress=progress
        )
    limit = None if time_limit is None else time_limit - (time.perf_counter() - started)
    with given_direction_known(assembly, contacts, limit):
        return _orient(assembly, contacts, method, limit, progress)


def _orient(
    assembly: Assembly,
    contacts: ContactSet,
    method: Method,
    time_limit: float | None,
    progress: Callable[[str], None] | None,
) -> Orientation:
    """Find the orientation of an assembly with given contacts, as `orient`."""
    tell = progress or (lambda stage: None)
    program = build_program(assembly, contacts)
    tell("stable region")
    limit = None if time_limit is None else OF_REGION * time_limit
    words = progress if program.mu.any() else None
    every = region(assembly, contacts=contacts, time_limit=limit, progress=words)
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
    plain = np.where(np.abs(direction) < PLAIN, 0.0, direction)
    plain = plain / np.linalg.norm(plain)
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
    return Orientation(
        verdict="undecided",
        sentence=(
            "Undecided: as drawn no orientation is held, but if all open pairs were joined, forces "
            "that hold it with gravity as given would exist: "
            f"{open_pair_names(assembly, every.contacts[0])}."
        ),
        assembly=assembly,
        down=assembly.down,
        rotation=frozen(_least_turn(assembly, assembly.down)),
        tilt_margin_deg=None,
        friction=every.friction,
        z=None,
        instability=None,
        nearest=None,
        method=method,
        programs=every.programs,
        judgement=judge(program if every.friction else program.frictionless),
        level=None,
        check=None,
        region=every,
        warnings=every.warnings,
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
        z, instability = verdict.displacement.z, verdict.instability
    sentence = _sentence(every, down, margin)
    if verdict.verdict == "balanced":
        sentence += " There it is balanced: the slightest push makes it fall."
    return Orientation(
        verdict="found",
        sentence=sentence,
        assembly=assembly,
        down=frozen(down),
        rotation=frozen(_least_turn(assembly, down)),
        tilt_margin_deg=margin,
        friction=every.friction,
        z=z,
        instability=instability,
        nearest=None,
        method=method,
        programs=every.programs,
        judgement=judgement,
        level=verdict.level,
        check=None,
        region=every,
        warnings=every.warnings,
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
    return Orientation(
        verdict="undecided" if why else "none",
        sentence=sentence,
        assembly=assembly,
        down=down,
        rotation=frozen(_least_turn(assembly, down)),
        tilt_margin_deg=None,
        friction=every.friction,
        z=verdict.displacement.z,
        instability=verdict.instability,
        nearest=near,
        method=method,
        programs=every.programs + near.programs,
        judgement=judgement,
        level=None,
        check=verdict,
        region=every,
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
    if _none_is_stable(outer, joint(outer, every=True)):
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
