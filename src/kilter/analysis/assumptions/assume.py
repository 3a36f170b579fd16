"""Apply a rung of the ladder of assumptions to an assembly (`kilter.assembly.assumption`).

The rungs "fits" and "joined" add fixed joints between parts of the drawn pose. Then, unless forces
hold it there, the parts may move within their play: the engine of `kilter.settle` brings them to
rest, and a part takes its pose at rest if its way is within the play of a part of its size, once
for each contact of its chain down to a held part. Overlaps of the other parts are opened by the
least motion, so that a contact that is merely sunk decides nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kilter.analysis.assumptions.joining import joined
from kilter.analysis.assumptions.proved_poses import at_poses
from kilter.analysis.assumptions.rungs import is_simulated
from kilter.analysis.assumptions.straight_drop import drop_straight, tips, with_listed_contacts
from kilter.analysis.check import check_equilibrium
from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.settled_pose.rest import RestResult, WayStep
from kilter.analysis.settled_pose.rest_engine import come_to_rest
from kilter.analysis.settled_pose.rest_verification import RestingParts, verify_rest
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies, rigid_bodies
from kilter.analysis.settled_pose.settle import is_verified, refusal, without_rounding
from kilter.analysis.verdict.remarks import floating_groups
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Mask
from kilter.assembly import Assembly, Joint
from kilter.assembly.assumption import DRAWN, JOINED, PLAY
from kilter.assembly.changed_copies import with_fields
from kilter.assembly.question import Question
from kilter.contact import ContactSet, detect
from kilter.contact.fits.fastening import with_decided_pairs
from kilter.contact.fits.suggestions import suggest_joints
from kilter.contact.open_pairs import still_open
from kilter.files.own.saved_entries import changed_poses
from kilter.tell.levels import holds, level_rank
from kilter.units import metres_per_unit

FASTENED = ("thread", "press fit", "insert")
"""Kinds of suggestions that the rung "fits" joins. Other overlaps may be merely sunk."""
PLAY_SHARE, LEAST_PLAY, MOST_PLAY = 0.02, 5e-5, 2e-3
"""Play of a part in CAD: a share of its size [-], at least and at most this [m]: the clearances of
drawn pins, drawers and lids."""
LONGEST_CHAIN = 5
"""Largest number of plays that a part may move before the search leaves it out [-]."""
VERTICES, LEAST_STEPS, MOST_STEPS = 200_000, 12, 100
"""Work limit of a search for a pose at rest: number of steps times vertices of the assembly, and
the least and the largest number of steps."""
FEW_VERTICES = 5_000
"""Number of vertices up to which rows search for poses, and bodies do not fall straight at first.
"""
ROUNDING = 1e-9
"""Gap to a floor that comes from rounding, over the size of the assembly [-]."""
SUNK_SHARE = 1e-3
"""Play of a part in a file of a simulator, whose contacts are soft: a share of its size [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Assumed:
    """An assembly on a rung of the ladder."""

    rung: str
    assembly: Assembly
    """The assembly with the joints and the poses of the rung."""
    contacts: ContactSet
    """Its contacts."""
    drawn_contacts: ContactSet
    """Contacts of the drawn pose."""
    closed: RestingParts | None = None
    """The pose at rest, if all parts rest within their play: its closed points prove it."""
    ended: bool = True
    """Whether the search for a pose at rest ended before its work limit."""
    finished: bool = True
    """Whether it ended, and its result was verified."""
    moved: float = 0.0
    """Longest way of a part [length unit]."""
    joints: int = 0
    """Number of joints that the rung added."""
    surely_fall: tuple[str, ...] = ()
    """Parts that fall further than their play, if a search would have to show whether others fall.
    """
    ways: Mapping[str, tuple[WayStep, ...]] = field(default_factory=dict)
    """The pieces of the way of each part that took its pose at rest, by name."""

    @property
    def marked(self) -> Assembly:
        """The assembly, marked so that no rung is applied to it again."""
        return as_drawn(self.assembly)


def assume(
    asked: Question,
    rung: str,
    *,
    settles: bool = True,
    searches: bool = True,
    opens: bool = True,
    work: float = 1.0,
) -> Assumed:
    """Apply a rung to the assembly of a question.

    Bodies of a large file fall straight on the rung "joined" (`drop_straight`). They need a search
    only if they do not rest where they land.

    Arguments: `settles`: whether parts move; `searches`: whether a search for a pose at rest is
    permitted; without it, the contacts of the bodies are listed; `opens`: whether overlaps of the
    parts that find no rest within their play are opened; `work`: work of the search, over the usual
    one [-].
    """
    drawn, contacts = asked.assembly, detect.touching(asked)
    base = with_joints(drawn, contacts, rung)
    known = contacts.of(base)
    plain = Assumed(rung, base, known, contacts, joints=len(base.joints) - len(drawn.joints))
    if rung == DRAWN or not settles or refusal(base) or not has_play(base, known):
        return plain
    if rung == JOINED and (not searches or len(base.geometry.vertices) > FEW_VERTICES):
        found = _dropped(asked, plain, listed=not searches)
        if found is not None:
            return found
    if not searches:
        return replace(plain, ended=False)
    if check_equilibrium(base, known).level is not None:
        return plain
    return _within_play(asked, plain, opens, work)


def _dropped(asked: Question, plain: Assumed, *, listed: bool) -> Assumed | None:
    """The assembly whose bodies fell straight; None if the pose of a body needs a search.

    Arguments: `listed`: whether its contacts are given: those between bodies, found for the landed
    bodies alone.
    """
    base = plain.assembly
    bodies = rigid_bodies(base, ())
    play = _largest(bodies, play_of(base), len(bodies.mass))
    dropped = drop_straight(bodies, plain.drawn_contacts, play, on_surfaces=not listed)
    if dropped is not None and listed and dropped.lands.any():
        if dropped.gone.any():
            gone = np.flatnonzero(dropped.gone[bodies.of_part])
            return replace(plain, surely_fall=tuple(base.names[k] for k in gone.tolist()))
        dropped = drop_straight(bodies, plain.drawn_contacts, play)
    assembly = None if dropped is None else with_listed_contacts(dropped, plain.drawn_contacts)
    if dropped is None or assembly is None:
        return None
    moved = float(np.linalg.norm(dropped.bodies.center - bodies.center, axis=1).max())
    kept = np.flatnonzero(~dropped.gone[bodies.of_part])
    rest = assembly if len(kept) == len(assembly) else chosen_parts(assembly, kept, [])
    there = detect.contacts(rest)
    balanced = check_equilibrium(rest, there).level is not None
    if not balanced and not tips(dropped, LONGEST_CHAIN * float(play.max())):
        return None
    if listed:
        there = there if rest is assembly else detect.contacts(assembly)
        return replace(plain, assembly=assembly, contacts=there, moved=moved)
    return _posed(asked, plain, dropped.bodies.assembly(), None)


def falls_surely(asked: Question) -> tuple[bool, tuple[str, ...]]:
    """Whether all parts tip over together on every rung, and the parts that fall if joined.

    If they do not tip over, these parts fall on every rung: they belong to bodies that touch no
    supported part, and whose straight fall is longer than their play. No search is needed.
    """
    drawn, contacts = asked.assembly, detect.touching(asked)
    base = with_joints(drawn, contacts, JOINED)
    bodies = rigid_bodies(base, ())
    play = _largest(bodies, play_of(base), len(bodies.mass))
    dropped = None if refusal(base) else drop_straight(bodies, contacts, play, on_surfaces=False)
    if dropped is None:
        return False, ()
    tip = tips(dropped, LONGEST_CHAIN * float(play.max()))
    falls = bodies.free if tip else dropped.gone
    return tip, tuple(base.names[k] for k in np.flatnonzero(falls[bodies.of_part]).tolist())


def with_joints(assembly: Assembly, contacts: ContactSet, rung: str) -> Assembly:
    """The assembly with the joints of a rung, which its saved options then have, too."""
    if rung in (DRAWN, PLAY):
        return assembly
    named = {frozenset(joint.parts) for joint in assembly.joints}
    found = [s for s in suggest_joints(assembly, contacts) if s.kind in FASTENED and s.fixed]
    joints = [Joint(s.parts, why=s.kind) for s in found if frozenset(s.parts) not in named]
    base = with_fields(assembly, joints=[*assembly.joints, *joints])
    if rung == JOINED:
        base = joined(base, contacts)
    added = base.joints[len(assembly.joints) :]
    return with_entries(base, joints=[{"parts": list(j.parts), "kind": j.kind} for j in added])


def with_entries(assembly: Assembly, **entries: Any) -> Assembly:
    """The assembly whose saved options of reading have more joints or poses, for its proof."""
    options = dict(assembly.reading or {})
    known = dict(options.get("entries", {}))
    for key in ("joints", "open_pairs"):
        if entries.get(key):
            known[key] = [*known.get(key, ()), *entries[key]]
    if entries.get("poses"):
        known["poses"] = {**known.get("poses", {}), **entries["poses"]}
    return with_fields(assembly, reading={**options, "entries": known} if known else options)


def judged(asked: Question, found: Assumed, judge: Callable[[Question], Verdict]) -> Verdict:
    """The verdict on the contacts of the pose, or on its closed points if they prove more."""
    verdict = judge(asked.but(assembly=found.assembly, contacts=found.contacts))
    if found.closed is None or holds(verdict.level, asked.require):
        return verdict
    closed = found.closed.closed
    listed = with_fields(found.assembly, contacts=closed.assembly.contacts, detect=False)
    other = judge(asked.but(assembly=listed, contacts=closed.contacts.of(listed)))
    if level_rank(other.level) <= level_rank(verdict.level):
        return verdict
    return replace(other, rest_gap=found.closed.gap)


def as_drawn(assembly: Assembly) -> Assembly:
    """The assembly with the rung "drawn" in its options: its poses and joints are final."""
    return with_fields(assembly, reading={**(assembly.reading or {}), "assume": DRAWN})


def play_of(assembly: Assembly) -> Array:
    """Play of each part [length unit], shape (N,)."""
    size = assembly.geometry.size
    if is_simulated(assembly):
        return np.asarray(SUNK_SHARE * size)
    unit = metres_per_unit(assembly.units)
    return np.asarray(np.clip(PLAY_SHARE * size, LEAST_PLAY / unit, MOST_PLAY / unit))


def has_play(assembly: Assembly, contacts: ContactSet) -> bool:
    """Whether any part may move within its play: something is open between two rigid bodies.

    That is an overlap, a clearance or a narrow gap. A free group of parts that touches nothing may
    be near enough to other parts, too.
    """
    play, body = play_of(assembly), rigid_bodies(assembly, ()).of_part
    found = (*contacts.open_pairs, *contacts.overlaps)
    if any(body[pair.ends[0]] != body[pair.ends[1]] for pair in found):
        return True
    near = [pair for pair in contacts.near if body[pair.ends[0]] != body[pair.ends[1]]]
    if any(abs(pair.gap) <= play[list(pair.ends)].max() for pair in near):
        return True
    if floating_groups(assembly, contacts) or _hovers(assembly, play):
        return True
    index = assembly.index
    return any(
        lone.gap is None or lone.gap <= play[index[lone.part]]
        for lone in contacts.of(assembly).nearest
    )


def _hovers(assembly: Assembly, play: Array) -> bool:
    """Whether a free part is above a floor by a gap within its play, as a foot of a body may be."""
    geometry = assembly.geometry
    depth, start = geometry.vertices @ assembly.down, geometry.vertex_start[:-1]
    lowest, top = np.maximum.reduceat(depth, start), np.minimum.reduceat(depth, start)
    closed = ROUNDING * geometry.size.max()
    floors = [k for k, part in enumerate(assembly.parts) if part.table]
    gaps = top[floors][:, None] - lowest[None, ~geometry.grounded]
    return bool(((gaps > closed) & (gaps <= play[None, ~geometry.grounded])).any())


def _within_play(asked: Question, plain: Assumed, opens: bool, work: float) -> Assumed:
    """The assembly with the parts at rest that move within their play."""
    base, contacts = plain.assembly, plain.contacts
    bodies = rigid_bodies(base, ())
    play = _largest(bodies, play_of(base), len(bodies.mass))
    steps = work * VERTICES / max(len(base.geometry.vertices), 1)
    rounds = int(np.clip(steps, LEAST_STEPS, MOST_STEPS))
    rest = come_to_rest(
        bodies, contacts, reach=None, tell=asked.tell, limit=LONGEST_CHAIN * play, rounds=rounds
    )
    ended, aside = rest.rounds < rounds, rest.aside if opens else bodies
    rest = without_rounding(rest)
    inner = asked.but(assembly=base, contacts=contacts, require="equilibrium", effort=0.0)
    settled = rest.bodies.assembly()
    verified = verify_rest(rest, settled, inner)
    plain = replace(plain, ended=ended, finished=ended and is_verified(rest, verified))
    if isinstance(verified, RestingParts):
        near = _near_rest(rest, verified, play)
        complete = len(verified.assembly) == len(base) and is_verified(rest, verified)
        if complete and near[bodies.free & bodies.moves].all():
            return replace(_posed(asked, plain, settled, verified), ways=_ways(rest, near))
    else:
        near = ~bodies.free
    assert aside is not None
    found = _posed(asked, plain, rest.bodies.where(near, aside).assembly(), None)
    return replace(found, ways=_ways(rest, near))


def _posed(
    asked: Question, plain: Assumed, assembly: Assembly, closed: RestingParts | None
) -> Assumed:
    """The assumed assembly in new poses, with its contacts."""
    base = plain.assembly
    poses = changed_poses(base, assembly)
    contacts = plain.contacts
    if poses:
        assembly = with_entries(at_poses(base, poses), poses=poses)
        contacts = detect.touching(asked.but(assembly=assembly, contacts=None))
    if closed is None and plain.finished:
        assembly, contacts = _without_play(asked, assembly, contacts)
    far = np.linalg.norm(assembly.geometry.center - base.geometry.center, axis=1)
    return replace(
        plain, assembly=assembly, contacts=contacts, closed=closed, moved=float(far.max())
    )


def _without_play(
    asked: Question, assembly: Assembly, contacts: ContactSet
) -> tuple[Assembly, ContactSet]:
    """The assembly whose parts do not touch across gaps and clearances, and its contacts.

    A part that does not rest within its play moves until it touches; here it does not touch.
    """
    touching = {frozenset(pair) for pair in contacts.patch_parts.tolist()}
    apart = {
        frozenset(pair.ends)
        for pair in still_open(contacts.open_pairs, assembly)
        if pair.kind in ("near", "clearance")
    } - touching
    if not apart:
        return assembly, contacts
    names = assembly.names
    pairs_by_name = sorted(sorted(names[k] for k in pair) for pair in apart)
    decided = [{"parts": pair, "as": "apart"} for pair in pairs_by_name]
    assembly = with_entries(with_decided_pairs(assembly, decided), open_pairs=decided)
    return assembly, detect.touching(asked.but(assembly=assembly, contacts=None))


def _ways(rest: RestResult, near: Mask) -> dict[str, tuple[WayStep, ...]]:
    """The ways of the parts whose bodies took their pose at rest, by name."""
    bodies = rest.bodies
    rows = zip(bodies.drawn.names, bodies.of_part.tolist(), strict=True)
    return {name: rest.ways[body] for name, body in rows if near[body]}


def _near_rest(rest: RestResult, verified: RestingParts, play: Array) -> Mask:
    """Bodies at rest whose way is within the play of their largest part, shape (B,).

    A body above k contacts may move k times as far.
    """
    bodies = rest.bodies
    rests = np.ones(len(bodies.mass), dtype=bool)
    names = verified.assembly.index
    rests[bodies.of_part[[name not in names for name in bodies.drawn.names]]] = False
    shift = np.linalg.norm(bodies.center - bodies.drawn_center, axis=1)
    turn = np.linalg.norm(bodies.rotation - np.eye(3), axis=(1, 2))
    way = shift + turn * bodies.size / 2
    mask: Mask = ~bodies.free | (rests & (way <= play * _chain(bodies, verified)))
    return mask


def _largest(bodies: RigidBodies, values: Array, count: int) -> Array:
    """The largest value among the parts of each body, shape (B,)."""
    most = np.zeros(count)
    np.maximum.at(most, bodies.of_part, values)
    return most


def _chain(bodies: RigidBodies, verified: RestingParts) -> Array:
    """Number of contacts of each body down to a held part, shape (B,); 0 without a chain."""
    names = verified.assembly.names
    index = np.array([bodies.body_of(name) for name in names])
    links = {frozenset(pair) for pair in index[verified.closed.contacts.patch_parts].tolist()}
    links |= {frozenset(map(bodies.body_of, joint.parts)) for joint in verified.assembly.joints}
    depth = np.zeros(len(bodies.mass))
    front, known = {0}, {0}
    for k in range(1, len(depth)):
        front = {other for link in links if link & front for other in link} - known
        known |= front
        depth[list(front)] = k
    return depth
