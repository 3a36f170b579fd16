"""`kilter.settle`: the pose at rest near the drawn pose of an assembly.

Drawn parts often overlap or hang by a fraction of a millimetre. `settle` moves them until they
touch and forces at closed points hold them. "At rest" is verified independently of the search:
contacts are detected anew, gaps are measured on the geometry, and a certificate proves the forces
(`kilter.analysis.settled_pose.rest_proof`). The pose is neither unique nor proved to be the
nearest, and the state "falls" is no proof of a fall.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, ClassVar, Literal

import numpy as np

from kilter.analysis.check import check, check_level
from kilter.analysis.settled_pose.near_points import find_near_points
from kilter.analysis.settled_pose.rest_proof import ClosedContacts, closed_contacts, closed_gap
from kilter.analysis.settled_pose.rest_search import SearchResult, search_rest
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies, rigid_bodies
from kilter.analysis.settled_pose.settle_tolerances import REACH
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.errors import InputError
from kilter.mechanics.proof import digest_of
from kilter.tell.levels import holds, level_rank, require_level
from kilter.tell.numbers import NO_ANGLE
from kilter.tell.record import Answer, InPython, Record, UnitWord, key
from kilter.tell.scene_words import settle_sentence
from kilter.validate import number
from kilter.work import stop_after

MARGIN = 3.0
"""Default reach, in multiples of the widest gap or overlap that was found."""
WIDER = 10.0
"""Factor of the default reach in a second attempt, if more pairs of parts come within it."""
WIDEST = 0.1
"""Largest reach of a second attempt, over the median size of the parts [-]: within a larger reach
nearly all faces of the parts are candidates."""
FITS = "the normals of their free-form faces are fits, and change from round to round"
"""Cause of gaps that do not close between curved faces without a formula."""
ROUGHLY = "equilibrium"
"""Level asked of the drawn pose, and of all detected contacts if the closed points alone reach the
required level: the search for higher levels takes longer than the search for the pose."""
UNMOVED = 1e-3
"""Movement that comes from rounding, as a fraction of the gap that counts as closed [-]."""


class Moved(Record):
    """Movement of a part from the drawn to the settled pose."""

    part: str
    """Name of the part."""
    distance: float
    """Way of its centre of mass [length unit]."""
    angle_deg: float
    """Angle of its rotation [deg]."""


class Settled(Answer):
    """Answer of `kilter.settle`: the pose at rest, or the reason why there is none."""

    answer: ClassVar[str] = "settle"

    state: Literal["at-rest", "does-not-fit", "falls", "not-found"]
    """State in which the search ended."""
    rounds: int
    """Number of rounds of the search."""
    reach: float
    """Largest gap that the search considered [length unit]."""
    tolerance: float
    """Gap that counts as closed [length unit]."""
    dropped: float
    """Largest distance of a fall before the search [length unit]."""
    units: UnitWord
    """Length unit."""
    before: str | None
    """Verdict on the drawn pose."""
    parts: tuple[str, ...]
    """Parts that fall, that do not fit, or that are out of reach."""
    depth: float
    """Depth of the overlap that no small motion opens [length unit]; 0 if all open."""
    why: str
    """Cause of a failure as a clause; empty at rest."""
    after: str | None = None
    """Verdict on the pose at rest; null in other states."""
    after_asked: str | None = None
    """Level up to which the verdict on the pose at rest was asked.

        It is "equilibrium" if the closed points alone reach the required level.
        """
    closed_level: str | None = None
    """Level of forces at closed points alone."""
    widest_gap: float | None = None
    """Widest gap of a closed point [length unit]; null without a pose at rest."""
    deepest_overlap: float | None = None
    """Deepest overlap of two parts [length unit]; null without a pose at rest."""
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

    Points of loads, joints and bonds have moved with their parts.
    """
    movement: InPython[Array]
    """Shift of the centre of mass of each part [length unit], and its rotation vector [rad], shape
    (N, 6)."""
    closed: InPython[ClosedContacts | None] = None
    """Contacts of the pose at closed points; None unless the search ended at rest."""
    closed_verdict: InPython[Verdict | None] = None
    """Verdict on forces at the closed points alone."""
    drawn_verdict: InPython[Verdict]
    """Verdict of `kilter.check` on the drawn pose, decided at the level "equilibrium"."""
    settled_verdict: InPython[Verdict | None] = None
    """Verdict of `kilter.check` on the settled pose, decided at the level `after_asked`."""

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
            Moved(part=names[k], distance=float(distance[k]), angle_deg=float(angle[k]))
            for k in moved[np.argsort(-distance[moved], kind="stable")].tolist()
        ]

    @property
    @key
    def carries(self) -> list[list[str]]:
        """Names of the pairs of parts that touch at closed points."""
        if self.closed is None:
            return []
        pairs = np.unique(np.sort(self.closed.contacts.patch_parts, axis=1), axis=0)
        return [[self.drawn.names[a], self.drawn.names[b]] for a, b in pairs.tolist()]

    @property
    @key
    def level(self) -> str | None:
        """Level of the pose at rest, the higher of both verdicts on it; None in other states.

        The verdicts are that on all detected contacts, and that on the closed points alone.
        """
        if self.state != "at-rest":
            return None
        verdicts = [v for v in (self.settled_verdict, self.closed_verdict) if v is not None]
        return max((v.level for v in verdicts), key=level_rank, default=None)

    @property
    def at_rest(self) -> bool:
        """True if the parts are at rest at the required level."""
        return self.state == "at-rest" and holds(self.level, self.require)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """The proof that the pose is at rest, for `kilter.verify` with the settled assembly.

        Raises
        ------
        InputError
            If the parts are not at rest.
        """
        if self.closed_verdict is None or self.state != "at-rest":
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
    drop: bool = False,
) -> Settled:
    """Move the parts of an assembly by little until they touch and rest on each other.

    Parameters
    ----------
    assembly : Assembly, or path
        At least one part is held. Held parts do not move.
    reach : float, optional
        Largest permitted movement of a part [length unit]. By default it is three times the widest
        gap or overlap of the drawn pose; the answer states it.
    keep : str or iterable of str
        Parts that must not move although they are not held; ``*`` and ``?`` are wildcards.
    drop : bool
        Whether hanging parts first fall straight down until they meet another part.
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
    >>> box = Part("box", Box(1, 1, 1), [0, 0, 0.501])
    >>> answer = settle(Assembly([table, box]))
    >>> answer.state, answer.level, answer.distance.round(6).tolist()
    ('at-rest', 'proved', [0.0, 0.001])
    >>> answer["box"].pose.position.round(6)
    array([0. , 0. , 0.5])
    """
    with stop_after(asked.seconds_left):
        return _settle(asked, reach, keep, drop)


def _settle(asked: Question, reach: float | None, keep: str | Iterable[str], drop: bool) -> Settled:
    """Settle the assembly of a question, as `settle`, within the time of the caller."""
    assembly, tell = asked.assembly, asked.tell
    asked = asked.but(time_limit=None, require=require_level(asked.require, strict=True))
    assembly.require_grounded()
    most = None if reach is None else number(reach, "reach", lowest=0)
    if most == 0.0:
        raise InputError("reach is 0", hint="give a length above zero")
    kept = assembly.matching(keep)
    contacts = detect.touching(asked)
    roughly = asked.but(require=ROUGHLY)
    before = check_level(roughly.but(contacts=contacts))
    bodies = rigid_bodies(assembly, kept)
    found, used, dropped = _found(assembly, bodies, contacts, most, drop, tell)
    settled = found.bodies.assembly()
    verdicts: dict[str, Any] = {}
    if found.state == "at-rest":
        tell("verification")
        found, verdicts = _verified(found, settled, asked, roughly)
    warned = verdicts.get("settled_verdict", before)
    return Settled(
        state=found.state,
        rounds=found.rounds,
        reach=used,
        tolerance=closed_gap(settled),
        dropped=dropped,
        units=assembly.units,
        before=before.verdict,
        parts=found.parts,
        depth=found.depth,
        why=found.why,
        require=asked.require,
        warnings=tuple(dict.fromkeys(warned.notes)),
        seconds=time.perf_counter() - asked.begun,
        drawn=assembly,
        assembly=settled,
        movement=found.bodies.movements(),
        drawn_verdict=before,
        **verdicts,
    )


def _found(
    assembly: Assembly,
    bodies: RigidBodies,
    contacts: ContactSet,
    most: float | None,
    drop: bool,
    tell: Callable[[str], None],
) -> tuple[SearchResult, float, float]:
    """The result of the search, its reach and the largest distance of a fall before it."""
    refusal = _refusal(assembly)
    if refusal:
        return SearchResult("not-found", bodies, 0, why=refusal), most or 0.0, 0.0
    dropped = 0.0
    if drop:
        from kilter.analysis.settled_pose.vertical_drop import drop_hanging

        tell("drop")
        bodies, dropped = drop_hanging(bodies)
    found, used = _search(bodies, contacts, most, dropped, tell)
    if _between_fits(found, contacts):
        found = replace(found, why=f"{found.why}; {FITS}")
    return found, used, dropped


def _verified(
    found: SearchResult, settled: Assembly, asked: Question, roughly: Question
) -> tuple[SearchResult, dict[str, Any]]:
    """The result of a search that ended at rest, and the verdicts on the pose, as fields."""
    assert found.points is not None
    closed = closed_contacts(settled, found.points, progress=asked.progress)
    alone = check_level(asked.but(assembly=closed.assembly, contacts=closed.contacts))
    verdicts: dict[str, Any] = {
        "closed": closed,
        "widest_gap": closed.widest_gap,
        "deepest_overlap": closed.deepest_overlap,
        "closed_verdict": alone,
        "closed_level": alone.level,
    }
    why = _unproved(closed, alone)
    if why:
        return replace(found, state="not-found", why=why), verdicts
    again = roughly if holds(alone.level, asked.require) else asked
    after = check(again.but(assembly=settled, contacts=None))
    more = {"settled_verdict": after, "after": after.verdict, "after_asked": after.require}
    return found, verdicts | more


def _search(
    bodies: RigidBodies,
    contacts: ContactSet,
    most: float | None,
    dropped: float,
    tell: Callable[[str], None],
) -> tuple[SearchResult, float]:
    """Search with the given reach, or with one or two reaches from the gaps of the drawn pose.

    Returns the result and the reach [length unit].
    """
    if most is not None:
        limit = most + dropped
        return search_rest(bodies, reach=most, most=limit, progress=tell), most
    reach = _default_reach(bodies.drawn, contacts, dropped)
    found = search_rest(bodies, reach=reach, most=None, progress=tell)
    wide = min(WIDER * reach, WIDEST * _median_size(bodies.drawn))
    nothing_near = found.state == "not-found" and found.rounds == 0 and found.points is None
    if wide <= reach or not (found.state == "falls" or nothing_near):
        return found, reach
    if not _more_pairs(bodies, (reach, wide), found.parts):
        return found, reach
    tell("wider reach")
    wider = search_rest(bodies, reach=wide, most=None, progress=tell)
    return (wider, wide) if wider.state == "at-rest" else (found, reach)


def _between_fits(found: SearchResult, contacts: ContactSet) -> bool:
    """Whether a failed search names a pair of parts that touch at faces with fitted normals."""
    index = found.bodies.drawn.index
    parts = {index[name] for name in found.parts}
    return found.state == "not-found" and any(
        pair.kind == "free-form" and set(pair.ends) == parts for pair in contacts.open_pairs
    )


def _more_pairs(bodies: RigidBodies, reaches: tuple[float, float], parts: tuple[str, ...]) -> bool:
    """Whether more pairs with one of `parts` come within the second, wider reach.

    Without `parts`, every pair counts.
    """
    assembly = bodies.assembly()
    pairs = []
    for distance in reaches:
        points = find_near_points(assembly, distance, distance)
        bearing = points.take(points.bears)
        pairs.append(set(zip(bearing.part_a.tolist(), bearing.part_b.tolist(), strict=True)))
    falling = {assembly.index_of(name) for name in parts or assembly.names}
    return any(falling.intersection(pair) for pair in pairs[1] - pairs[0])


def _default_reach(assembly: Assembly, contacts: ContactSet, dropped: float) -> float:
    """Reach from the widest gap and the deepest overlap of the drawn pose [length unit]."""
    size = _median_size(assembly)
    gaps = [overlap.depth for overlap in contacts.overlaps]
    gaps += [abs(pair.gap) for pair in contacts.near if abs(pair.gap) < size]
    if not dropped:
        gaps += [neighbour.gap for neighbour in contacts.neighbours]
    return MARGIN * max([REACH / MARGIN * size, *gaps])


def _median_size(assembly: Assembly) -> float:
    """Median size of the parts that are not held [length unit]."""
    geometry = assembly.geometry
    return float(np.median(geometry.size[~geometry.grounded]))


def _refusal(assembly: Assembly) -> str:
    """Reason why an assembly of this kind cannot be settled, as a clause; empty if it can."""
    if assembly.contacts or not assembly.detect:
        return "the file lists contacts, whose gaps no geometry shows; use --contacts geometry"
    if assembly.straps:
        return "straps are not settled: their pull changes with the pose"
    if assembly.geometry.grounded.all():
        return "every part is held"
    return ""


def _unproved(closed: ClosedContacts, verdict: Verdict) -> str:
    """Reason why the verification does not confirm the pose, as a clause; empty if it does."""
    if closed.fault:
        return f"the search ended at rest, but {closed.fault}"
    if verdict.level is None:
        return (
            "the search ended at rest, but no forces at the points that the geometry shows closed "
            "are proved to balance the parts"
        )
    return ""
