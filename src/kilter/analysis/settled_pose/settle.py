"""`kilter.settle`: a pose at rest that an assembly can reach from its drawn pose.

Drawn parts often overlap, or hang above their supports. `settle` pushes overlapping parts apart and
lets the others fall, tip, slide and roll until forces at closed points hold them, or until they
leave the scene (`kilter.analysis.settled_pose.rest_engine`). With `nearest=True` it searches for
the least motion instead (`kilter.analysis.settled_pose.rest_search`).

"At rest" is verified independently of both: contacts are detected anew, gaps are measured on the
geometry, and a certificate proves the forces (`kilter.analysis.settled_pose.rest_verification`).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any, ClassVar, Literal

import numpy as np

from kilter.analysis.check import check_level
from kilter.analysis.settled_pose.closing_motion import closed_up
from kilter.analysis.settled_pose.nearest_rest import find_nearest_rest
from kilter.analysis.settled_pose.rest import RestResult, RestState, WayStep
from kilter.analysis.settled_pose.rest_engine import come_to_rest
from kilter.analysis.settled_pose.rest_proof import ClosedContacts, closed_gap
from kilter.analysis.settled_pose.rest_search import SLACK
from kilter.analysis.settled_pose.rest_verification import (
    RestingParts,
    held_aside,
    parts_without_rest,
    verify_rest,
    with_level,
)
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies, rigid_bodies
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.assembly.question import Question, question
from kilter.assembly.supported_answer import SupportedAnswer
from kilter.contact import ContactSet, Tolerance, detect
from kilter.errors import InputError, TimeLimitReached
from kilter.mechanics.proof import digest_of
from kilter.tell.levels import holds, level_rank, require_level
from kilter.tell.numbers import NO_ANGLE
from kilter.tell.record import InPython, Record, UnitWord, key
from kilter.tell.scene_words import settle_sentence
from kilter.validate import number
from kilter.work import stop_after

ROUGHLY = "equilibrium"
"""Level asked of the drawn pose: the search for higher levels takes longer than all else."""
UNMOVED = 1e-3
"""Movement that comes from rounding, as a fraction of the gap that counts as closed [-]."""


class Way(Record):
    """A piece of the way of a part to its pose at rest."""

    how: Literal["pushed-out", "fell", "tipped", "slid", "rolled"]
    """Kind of the movement."""
    distance: float
    """Way of the centre of mass [length unit]."""
    angle_deg: float
    """Angle of the rotation [deg]."""


class Moved(Record):
    """Movement of a part from the drawn to the settled pose."""

    part: str
    """Name of the part."""
    distance: float
    """Way of its centre of mass [length unit]."""
    angle_deg: float
    """Angle of its rotation [deg]."""
    way: tuple[Way, ...]
    """The pieces of its way, in time; empty with `nearest`."""


class Settled(SupportedAnswer):
    """Answer of `kilter.settle`: the pose at rest, or the reason why there is none."""

    answer: ClassVar[str] = "settle"

    state: Literal["at-rest", "partly", "does-not-fit", "falls", "not-found"]
    """State of the free parts.

        "partly": some are at rest; the others leave the scene or have no pose. "falls": all leave
        the scene; with `nearest`, no forces at the points within reach balance them.
    """
    nearest: bool
    """Whether the least motion was searched for."""
    rounds: int
    """Number of rounds of the search."""
    reach: float | None
    """Largest way of a part; with `nearest`, the largest gap that the search considered
    [length unit]. Null: no limit."""
    tolerance: float
    """Gap that counts as closed [length unit]."""
    units: UnitWord
    """Length unit."""
    before: str | None
    """Verdict on the drawn pose."""
    leaves: tuple[str, ...]
    """Parts that leave the scene."""
    parts: tuple[str, ...]
    """Other parts without a pose at rest: they do not fit, or none was found."""
    depth: float
    """Depth of the overlap that no motion opens [length unit]; 0 if all open."""
    why: str
    """Cause of a failure as a clause; empty at rest."""
    after: str | None = None
    """Verdict on the pose at rest; null in other states.

        It is the verdict on forces at closed points alone if they reach the required level, else
        the verdict on all detected contacts.
    """
    closed_level: str | None = None
    """Level of forces at closed points alone."""
    widest_gap: float | None = None
    """Widest gap of a closed point [length unit]; null without parts at rest."""
    deepest_overlap: float | None = None
    """Deepest overlap of two parts [length unit]; null without parts at rest."""
    require: str
    """Level from which the parts count as at rest."""
    warnings: tuple[str, ...]
    """Warnings about file, geometry and contacts."""
    seconds: float
    """Duration [s]."""
    drawn: InPython[Assembly]
    """The assembly in the drawn pose."""
    assembly: InPython[Assembly]
    """The assembly in the last pose of the search.

    Points of loads, joints and bonds have moved with their parts. Parts that leave the scene are in
    the pose in which they left it.
    """
    movement: InPython[Array]
    """Shift of the centre of mass of each part [length unit], and its rotation vector [rad], shape
    (N, 6)."""
    ways: InPython[tuple[tuple[Way, ...], ...]]
    """The pieces of the way of each part, shape (N,)."""
    resting: InPython[Assembly | None] = None
    """The held parts and the parts at rest, in the pose at rest; None if no free part is."""
    closed: InPython[ClosedContacts | None] = None
    """Contacts of `resting` at closed points; None without it."""
    closed_verdict: InPython[Verdict | None] = None
    """Verdict on forces at the closed points alone."""
    drawn_verdict: InPython[Verdict | None]
    """Verdict of `kilter.check` on the drawn pose, decided at the level "equilibrium"."""
    settled_verdict: InPython[Verdict | None] = None
    """The verdict `after`."""

    def __getitem__(self, name: str) -> Part:
        """The part with this name, in the last pose of the search."""
        return self.assembly[name]

    @property
    def distance(self) -> Array:
        """Movement of the centre of mass of each part [length unit], shape (N,)."""
        return np.asarray(np.linalg.norm(self.movement[:, :3], axis=1))

    @property
    def angle(self) -> Array:
        """Rotation of each part [deg], shape (N,)."""
        return np.asarray(np.degrees(np.linalg.norm(self.movement[:, 3:], axis=1)))

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence."""
        return settle_sentence(self.data_without("sentence"))

    @property
    @key
    def moved(self) -> list[Moved]:
        """Moved parts, the farthest first."""
        names, distance, angle = self.drawn.names, self.distance, self.angle
        moved = np.flatnonzero((distance > UNMOVED * self.tolerance) | (angle > NO_ANGLE))
        return [
            Moved(
                part=names[k],
                distance=float(distance[k]),
                angle_deg=float(angle[k]),
                way=self.ways[k],
            )
            for k in moved[np.argsort(-distance[moved], kind="stable")].tolist()
        ]

    @property
    @key
    def rests(self) -> int:
        """Number of free parts that are at rest."""
        return 0 if self.resting is None else int((~self.resting.geometry.grounded).sum())

    @property
    @key
    def carries(self) -> list[list[str]]:
        """Names of the pairs of parts that touch at closed points."""
        if self.closed is None:
            return []
        contacts = self.closed.contacts
        pairs = np.unique(np.sort(contacts.patch_parts, axis=1), axis=0).tolist()
        return [[contacts.assembly.names[a], contacts.assembly.names[b]] for a, b in pairs]

    @property
    @key
    def level(self) -> str | None:
        """Level of the parts at rest, the higher of both verdicts on them; None without them.

        The verdicts are that on the closed points alone, and `after`.
        """
        verdicts = [v for v in (self.settled_verdict, self.closed_verdict) if v is not None]
        return max((v.level for v in verdicts), key=level_rank, default=None)

    @property
    def at_rest(self) -> bool:
        """True if all parts are at rest at the required level."""
        return self.state == "at-rest" and holds(self.level, self.require)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """The proof that `resting` is at rest, for `kilter.verify` with this assembly.

        If all parts are at rest, `resting` is `assembly`.

        Raises
        ------
        InputError
            If no part is at rest.
        """
        if self.closed_verdict is None:
            raise InputError(
                f"the parts are not at rest: {self.why}", hint="only a pose at rest has a proof"
            )
        proof = self.closed_verdict.proof(options=options)
        proof["rest"] = {"gap": self.tolerance}
        proof["digest"] = digest_of(proof)
        return proof

    def __repr__(self) -> str:
        far = float(self.distance.max(initial=0.0))
        return f"<Settled: {self.state}, moved {far:.3g} {self.drawn.units}>"


@question()
def settle(
    asked: Question,
    *,
    reach: float | None = None,
    keep: str | Iterable[str] = (),
    nearest: bool = False,
    ease: bool = False,
) -> Settled:
    """Bring the parts of an assembly to rest: a pose that it can reach without gaining energy.

    Overlapping parts are pushed apart; then parts fall, tip, slide and roll until they rest or
    leave the scene. It is no claim about dynamics: a thrown or bouncing part may come to rest
    elsewhere.

    Parameters
    ----------
    assembly : Assembly, or path
        At least one part is held. Held parts do not move.
    reach : float, optional
        Largest way of a part [length unit]. By default it has no limit; with `nearest`, it is three
        times the widest gap or overlap of the drawn pose, and the answer states it.
    keep : str or iterable of str
        Parts that must not move although they are not held; ``*`` and ``?`` are wildcards.
    nearest : bool
        Whether to search for a pose at rest by the least motion instead.
    ease : bool
        Whether parts at rest slide on, by at most a tenth of their size, to where they need little
        friction: in a simulator with soft contacts, friction that holds a part creeps.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. `Settled.at_rest` is true from this level.

    Returns
    -------
    Settled

    Raises
    ------
    TimeLimitReached
        At the time limit.
    InputError
        If no part is held, or an argument is invalid.

    See Also
    --------
    kilter.check : the verdict on the drawn pose.
    kilter.place : the places where a next part stands.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    >>> box = Part("box", Box(1, 1, 1), [0, 0, 0.75])
    >>> answer = settle(Assembly([table, box]))
    >>> answer.state, answer.level, answer.distance.round(6).tolist()
    ('at-rest', 'proved', [0.0, 0.25])
    >>> answer.moved[0].way[0].how, answer["box"].pose.position.round(6)
    ('fell', array([0. , 0. , 0.5]))
    """
    with stop_after(asked.seconds_left):
        return _settle(asked, reach, keep, nearest, ease)


def _settle(
    asked: Question,
    reach: float | None,
    keep: str | Iterable[str],
    nearest: bool,
    ease: bool,
) -> Settled:
    """Settle the assembly of a question, as `settle`, within the time of the caller."""
    assembly, tell = asked.assembly, asked.tell
    asked = asked.but(time_limit=None, require=require_level(asked.require, strict=True))
    assembly.require_grounded()
    reach = valid_reach(reach)
    kept = assembly.matching(keep)
    contacts = asked.contacts
    if nearest or contacts is not None:
        contacts = detect.touching(asked)
    else:
        tolerance = asked.tolerance or assembly.tolerance or Tolerance()
        contacts = detect.without_neighbours(assembly, tolerance, asked.tell)
    try:
        before = check_level(asked.but(require=ROUGHLY, contacts=contacts))
    except InputError:  # parts in the same place, which this answer moves apart
        before = None
    bodies = rigid_bodies(assembly, kept)
    if nearest and not refusal(assembly):
        rest, reach = find_nearest_rest(bodies, contacts, reach=reach, tell=tell)
        rest = without_rounding(rest)
    else:
        rest = rest_of(bodies, contacts, reach=reach, tell=tell, ease=ease)
    settled = rest.bodies.assembly()
    closed = closed_up(rest, settled) if not nearest and leaves_gaps(rest, settled) else None
    if closed is not None:
        rest, settled = closed, closed.bodies.assembly()
    resting: RestingParts | str = rest.why
    if rest.state == "at-rest" or not nearest:
        tell("verification")
        resting = verify_rest(rest, settled, asked)
        late = False
        sure = nearest or is_verified(rest, resting)
        try:
            for other in () if sure else other_rests(rest, bodies, contacts, reach, tell):
                again = verify_rest(other, other.bodies.assembly(), asked)
                if _open_parts(other, again) < _open_parts(rest, resting):
                    rest, settled, resting = other, other.bodies.assembly(), again
                if is_verified(rest, resting):
                    break
        except TimeLimitReached:  # the parts that are verified remain
            if not isinstance(resting, RestingParts):
                raise
            late = True
            resting = replace(resting, why=f"{resting.why}, until the time limit was reached")
        if isinstance(resting, RestingParts) and not late:
            tell("level of the pose")
            resting = with_level(resting, asked)
    return _answer(rest, settled, resting, asked, drawn=(assembly, before), nearest=nearest,
                   reach=reach)  # fmt: skip


def is_verified(rest: RestResult, resting: RestingParts | str) -> bool:
    """Whether the verification confirms the rest of all parts of which the engine claims it."""
    if isinstance(resting, RestingParts):
        return not resting.unproved
    return rest.state not in ("at-rest", "partly")


def _open_parts(rest: RestResult, resting: RestingParts | str) -> int:
    """Number of free parts that neither rest by verification nor leave the scene."""
    if isinstance(resting, str):
        return 0 if rest.state == "falls" else len(rest.bodies.drawn)
    return len(set(rest.parts) | set(resting.unproved))


def leaves_gaps(rest: RestResult, settled: Assembly) -> bool:
    """Whether points that the engine regards as closed have gaps that the verification rejects.

    Inexact parts that lie aside of the final pose `settled` make the engine less exact.
    """
    if rest.points is None:
        return False
    return bool((rest.points.gap > closed_gap(settled, held_aside(settled))).any())


def other_rests(
    rest: RestResult,
    bodies: RigidBodies,
    contacts: ContactSet,
    reach: float | None,
    tell: Callable[[str], None],
) -> Iterator[RestResult]:
    """Results for a pose that the verification does not confirm; arguments as of `rest_of`.

    First comes the last least motion, then the engine without `ease`, and without the first one.
    """
    closed = closed_up(rest, rest.bodies.assembly())
    if closed is not None:
        yield closed
    if rest.eased:
        yield rest_of(bodies, contacts, reach=reach, tell=tell)
    if rest.sunk:
        yield rest_of(bodies, contacts, reach=reach, tell=tell, sunk=False)


def valid_reach(reach: float | None) -> float | None:
    """A reach above zero; None: no limit. Raises `InputError` otherwise."""
    most = None if reach is None else number(reach, "reach", lowest=0)
    if most == 0.0:
        raise InputError("reach is 0", hint="give a length above zero")
    return most


def rest_of(
    bodies: RigidBodies,
    contacts: ContactSet,
    *,
    reach: float | None,
    tell: Callable[[str], None],
    sunk: bool = True,
    ease: bool = False,
) -> RestResult:
    """The result of the engine; "not-found" for an assembly that it does not accept.

    Arguments: `contacts`: contacts of the drawn pose; `sunk`, `ease`: as of `come_to_rest`.
    """
    why = refusal(bodies.drawn)
    if why:
        return RestResult("not-found", bodies, ways=((),) * len(bodies.mass), why=why)
    drawn = contacts.of(bodies.drawn)
    rest = come_to_rest(bodies, drawn, reach=reach, tell=tell, sunk=sunk, ease=ease)
    if reach is not None:
        shift = np.linalg.norm(rest.bodies.movements()[:, :3], axis=1)
        beyond = [bodies.drawn.names[k] for k in np.flatnonzero(shift > reach * (1 + SLACK))]
        stay = dict.fromkeys((*rest.parts, *beyond))
        rest = replace(rest, parts=tuple(name for name in stay if name not in rest.leaves))
    return without_rounding(rest)


def without_rounding(rest: RestResult) -> RestResult:
    """The result with the drawn poses of all bodies whose movement comes from rounding."""
    bodies = rest.bodies
    shift = np.linalg.norm(bodies.center - bodies.drawn_center, axis=1)
    turn = np.linalg.norm(bodies.rotation - np.eye(3), axis=(1, 2)) / np.sqrt(2)
    far = (shift > UNMOVED * closed_gap(bodies.drawn)) | (turn > np.radians(NO_ANGLE))
    ways = tuple(way if moved else () for way, moved in zip(rest.ways, far.tolist(), strict=True))
    center = np.where(far[:, None], bodies.center, bodies.drawn_center)
    rotation = np.where(far[:, None, None], bodies.rotation, np.eye(3))
    return replace(rest, bodies=replace(bodies, center=center, rotation=rotation), ways=ways)


def _answer(
    rest: RestResult,
    settled: Assembly,
    resting: RestingParts | str,
    asked: Question,
    *,
    drawn: tuple[Assembly, Verdict | None],
    nearest: bool,
    reach: float | None,
) -> Settled:
    """The answer from the result of a search and its verification."""
    assembly, before = drawn
    fails = parts_without_rest(rest)
    more: dict[str, Any] = {}
    warned: Verdict | None = before
    unproved: tuple[str, ...] = ()
    if isinstance(resting, RestingParts):
        warned, unproved = resting.verdict, resting.unproved
        why = rest.why if rest.depth else resting.why or rest.why
        more = {
            "tolerance": resting.gap,
            "resting": resting.assembly,
            "closed": resting.closed,
            "widest_gap": resting.closed.widest_gap,
            "deepest_overlap": resting.closed.deepest_overlap,
            "closed_verdict": resting.closed_verdict,
            "closed_level": resting.closed_verdict.level,
            "settled_verdict": resting.verdict,
            "after": resting.verdict.verdict,
        }
    else:
        why, more = resting, {"tolerance": closed_gap(settled)}
    state = _state(rest, isinstance(resting, RestingParts), bool(fails.any() or unproved))
    return Settled(
        state=state,
        nearest=nearest,
        rounds=rest.rounds,
        reach=reach,
        units=assembly.units,
        before=None if before is None else before.verdict,
        leaves=rest.leaves,
        parts=tuple(k for k in dict.fromkeys((*rest.parts, *unproved)) if k not in rest.leaves),
        depth=rest.depth,
        why="" if state == "at-rest" else why,
        require=asked.require,
        warnings=() if warned is None else tuple(dict.fromkeys(warned.notes)),
        seconds=time.perf_counter() - asked.begun,
        drawn=assembly,
        assembly=settled,
        movement=rest.bodies.movements(),
        ways=tuple(way_of(rest.ways[body]) for body in rest.bodies.of_part.tolist()),
        drawn_verdict=before,
        **more,
    )


def _state(rest: RestResult, some_rest: bool, some_fail: bool) -> RestState:
    """State of the free parts after the verification."""
    if some_rest:
        return "partly" if some_fail else "at-rest"
    return "not-found" if rest.state in ("at-rest", "partly") else rest.state


def way_of(steps: tuple[WayStep, ...]) -> tuple[Way, ...]:
    """The pieces of a way as records."""
    return tuple(Way(how=s.how, distance=s.distance, angle_deg=s.angle_deg) for s in steps)


def refusal(assembly: Assembly) -> str:
    """Reason why an assembly of this kind cannot be settled, as a clause; empty if it can."""
    if any(len(entry.points) for entry in assembly.contacts) or not assembly.detect:
        return "the file lists contacts, whose gaps no geometry shows; use --contacts geometry"
    if assembly.straps:
        return "straps are not settled: their pull changes with the pose"
    if assembly.geometry.grounded.all():
        return "every part is held"
    return ""
