"""All answers about an assembly that a page shows; large assemblies get fewer of them.

The verdict and the region are computed for every size that a page can show. Answers that need many
programs are computed for small assemblies only: the direction nearest to stable, the stability map,
and forces for every ray. `notes` lists the omitted answers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from kilter.analysis.analysis_tolerances import GAP_DEG
from kilter.analysis.check import check
from kilter.analysis.margins.margin import margin
from kilter.analysis.margins.margin_answer import Margin
from kilter.analysis.margins.margin_steps import HELD_TRIED
from kilter.analysis.margins.tried_changes import TriedChange
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.region import Region, common_region, region
from kilter.analysis.regions.well import find_rests
from kilter.analysis.support_movement import SupportMovement
from kilter.analysis.turning.orientation import Orientation, orient
from kilter.analysis.turning.stability_map import StabilityMap, stability_map
from kilter.analysis.verdict.displacement import find_displacement
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.assembly.assumption import DRAWN
from kilter.assembly.bricks.brick_assembly import is_brick_model
from kilter.assembly.changed_copies import with_fields
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.errors import InputError, SolverError, TimeLimitReached
from kilter.mechanics.certificate import ForceProof
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.answer.path_places import PathPlaces, find_path_places
from kilter.work import EFFORT, stop_after

T = TypeVar("T")
Tell = Callable[[str], None]

REGION_PARTS = 3000
"""Largest number of free parts for which the stable region is computed."""
FRICTION_PARTS = 60
"""Largest number of free parts for which a region in space is computed with friction."""
NEAREST_PARTS = 40
"""Largest number of free parts for which the direction nearest to stable is computed."""
MAP_PARTS = 40
"""Largest number of free parts for which the stability map is computed."""
MAP_PROGRAMS = 1500
"""Largest number of programs for a stability map; a larger map is omitted."""
MAP_MOTIONS = 12_000
"""Largest number of map vertices times free parts; with more, the map is omitted, because its
motions take too long."""
MARGIN_PARTS = HELD_TRIED
"""Largest number of free parts for which margins are computed, including pushes on each part."""
REST_PARTS = 3
"""Largest number of free parts for which the places of rest in the region are computed."""
RAY_FORCES = 60_000
"""Largest number of rays times contact points; with more, the forces of rays are omitted, because
they would fill the page."""


@dataclass(frozen=True, slots=True, eq=False)
class Balance:
    """Contact forces that balance every part for a direction of gravity."""

    down: Array
    """Direction of gravity, shape (3,)."""
    points: Array
    """Contact points, world frame [length unit], shape (K, 3)."""
    parts: Index
    """Indices of the two parts at each point, shape (K, 2)."""
    forces: Array
    """Force on the second part at each point, world frame [N], shape (K, 3)."""
    pull: Array | None = None
    """Strength of the bond in tension at each point [N], shape (K,); None if the assembly has no
    bonds."""
    use: Array | None = None
    """Least share of the friction that the patch of each point needs [-], nan without friction,
    shape (K,); None if it is not known."""


@dataclass(frozen=True, slots=True, eq=False)
class Answered:
    """The verdict, with forces or a motion, for a direction of gravity."""

    down: Array
    """Direction of gravity, shape (3,)."""
    check: Mapping[str, Any]
    """The answer of `kilter check --json`."""
    balance: Balance | None
    """The forces of that answer; None if no forces balance the parts."""
    sentence: str = ""
    """A sentence about this direction; empty for the given direction."""
    path: PathPlaces | None = None
    """The path along which a balanced assembly falls."""


@dataclass(frozen=True, slots=True, eq=False)
class MapMotions:
    """Motion of the assembly at each vertex of its stability map, world frame, without friction."""

    vertices: Array
    """Vertices q of the map [kg x length unit], shape (V, 3): z(g) = -max over q of q.g for a
    direction g."""
    mass: float
    """Mass of the free parts [kg]."""
    motions: Array
    """Displacement of least 2-norm of the displacement program, for a direction of gravity in
    the middle of the partition of each vertex, shape (V, N, 6)."""


@dataclass(frozen=True, slots=True, eq=False)
class Everything:
    """All answers about an assembly that a page shows."""

    assembly: Assembly
    contacts: ContactSet
    given: Answered
    """The answer for the direction of gravity of the assembly."""
    recommended: Answered | None
    """The answer for the direction that `kilter.orient` recommends, or for the centre of the
    region."""
    region: Mapping[str, Any] | None
    """The answer of `kilter region --json`."""
    inner: Cone | None
    """Inner cone of the region, if friction makes its boundary round. The facets of `region`
    then belong to an outer cone. None for an exact region."""
    none: bool
    """Whether it is proved that no direction is stable, whatever further forces act."""
    rays: Sequence[Balance]
    """Forces for each ray of the region, and for both signs of each line."""
    map: MapMotions | None
    """The stability map."""
    margin: Mapping[str, Any] | None
    """The answer of `kilter margin --json`, for gravity as given."""
    change: TriedChange | None
    """The change of the margins that helps most, if it is a brick to add or to remove."""
    notes: Sequence[str]
    """Sentences about omitted answers, with the reasons."""
    movement: SupportMovement | None = None
    """The movement of the parts with their supports, if supports move."""

    def __repr__(self) -> str:
        return f"Everything({self.given.check['verdict']!r}, {len(self.assembly.parts)} parts)"


@question(lacks="require", own_rungs=True)
def everything(
    asked: Question,
    *,
    margins: bool = False,
    moved: Mapping[str, Any] | None = None,
    turned: Mapping[str, Any] | None = None,
) -> Everything:
    """Compute all answers about an assembly that a page shows.

    Arguments: `time_limit`: time limit of all answers together [s]; `margins`: whether margins are
    computed without a limit of size; `moved`, `turned`: movements of supports, as in
    `Verdict.support_movement`. Raises `InputError` if no part is held, if the geometry is not
    usable, or if a movement is invalid.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> everything(scene("tower"))
    Everything('stable', 6 parts)
    """
    tell = asked.tell
    asked.assembly.require_grounded()
    verdict = check(asked.but(contacts=detect.touching(asked), verb=check.__name__))
    assembly, contacts = _final(verdict), verdict.contact_set
    movement = verdict.support_movement(moved or {}, turned or {}) if moved or turned else None
    tell("motion")
    given = full_answer(verdict)
    notes: list[str] = []

    def in_time(name: str, step: Callable[..., T], *arguments: Any) -> T | None:
        """Run a step of the page's computation; return None and add a note after the time limit."""
        try:
            with stop_after(asked.seconds_left):
                return step(*arguments)
        except TimeLimitReached:
            notes.append(f"{name} left out, because the time limit was reached")
            return None

    directions = in_time(
        "the stable region is", _directions, assembly, contacts, asked.effort, tell, notes
    )
    stable, recommended, none = directions or (None, None, False)
    rests = rays = vertex_map = None
    if stable is not None:
        rests = in_time("the places of rest are", _with_rests, stable, assembly, contacts) or stable
        rays = in_time("the forces for turned gravity are", _ray_forces, assembly, contacts, stable)
        vertex_map = in_time("the stability map is", _map, assembly, contacts, tell, notes)
    limits = in_time("the margins are", _margin, assembly, contacts, margins, tell, notes)
    return Everything(
        assembly=assembly,
        contacts=contacts,
        given=given,
        recommended=recommended,
        region=None if rests is None else rests.to_dict(),
        inner=None if stable is None or stable.gap_deg is None else stable.cone,
        none=none,
        rays=rays or (),
        map=vertex_map,
        margin=None if limits is None else limits.to_dict(),
        change=None if limits is None else _brick_change(limits),
        notes=tuple(notes),
        movement=movement,
    )


def _final(verdict: Verdict) -> Assembly:
    """The assembly of a verdict, marked so that no rung is applied to it again."""
    assembly = verdict.assembly
    if verdict.assume == DRAWN:
        return assembly
    return with_fields(assembly, reading={**(assembly.reading or {}), "assume": DRAWN})


def only_given(verdict: Verdict) -> Everything:
    """The answer of a check alone, for a page that shows nothing else."""
    return Everything(
        assembly=verdict.assembly,
        contacts=verdict.contact_set,
        given=full_answer(verdict),
        recommended=None,
        region=None,
        inner=None,
        none=False,
        rays=(),
        map=None,
        margin=None,
        change=None,
        notes=(),
    )


def only_directions(
    assembly: Assembly, contacts: ContactSet, orientation: Orientation, tell: Tell
) -> Everything:
    """The answers of a page about other directions of gravity, for a known orientation.

    The answer for the given direction is left out.
    """
    notes: list[str] = []
    stable, recommended, none = _directions(assembly, contacts, EFFORT, tell, notes, orientation)
    found = stable if stable is None else _with_rests(stable, assembly, contacts)
    return Everything(
        assembly=assembly,
        contacts=contacts,
        given=Answered(assembly.down, {}, None),
        recommended=recommended,
        region=None if found is None else found.to_dict(),
        inner=None if found is None or found.gap_deg is None else found.cone,
        none=none,
        rays=() if stable is None else _ray_forces(assembly, contacts, stable),
        map=None if stable is None else _map(assembly, contacts, tell, notes),
        margin=None,
        change=None,
        notes=tuple(notes),
    )


def full_answer(verdict: Verdict, sentence: str = "") -> Answered:
    """The full answer for a verdict and its direction of gravity, with forces if it holds."""
    answer, down = verdict.to_dict(), verdict.assembly.down
    if answer["forces"] is None:
        return Answered(down, answer, None, sentence)
    second = verdict.second_order_answer
    path = None if second is None else find_path_places(verdict.assembly, second)
    index, patches = verdict.assembly.index, answer["forces"]["patches"]
    parts = [[index[n] for n in patch["parts"]] for patch in patches for _ in patch["points"]]
    balance = _balance(
        down,
        [point for patch in patches for point in patch["points"]],
        parts,
        [force for patch in patches for force in patch["forces"]],
    )
    uses = [patch["utilisation"] for patch in patches for _ in patch["points"]]
    balance = replace(balance, use=np.array(uses, dtype=np.float64))
    if verdict.assembly.bonds and verdict.forces is not None:
        rows = verdict.forces.rows[np.argsort(verdict.forces.patch_of, kind="stable")]
        balance = replace(balance, pull=verdict.program.pull[rows])
    return Answered(down, answer, balance, sentence, path)


def _balance(down: Any, points: Any, parts: Any, forces: Any) -> Balance:
    return Balance(
        np.array(down, dtype=np.float64),
        np.array(points, dtype=np.float64).reshape(-1, 3),
        np.array(parts, dtype=np.int64).reshape(-1, 2),
        np.array(forces, dtype=np.float64).reshape(-1, 3),
    )


def turned_verdict(
    assembly: Assembly, contacts: ContactSet, down: Array, effort: float = EFFORT
) -> Verdict:
    """The verdict for another direction of gravity, without a ladder of assumptions."""
    turned = assembly.with_down(down)
    return check(Question(assembly=turned, contacts=contacts.of(turned), effort=effort))


def _free_count(assembly: Assembly) -> int:
    """Number of free parts."""
    return sum(not part.grounded for part in assembly.parts)


def _directions(
    assembly: Assembly,
    contacts: ContactSet,
    effort: float,
    tell: Tell,
    notes: list[str],
    known: Orientation | None = None,
) -> tuple[Region | None, Answered | None, bool]:
    """The stable region, the answer for its best direction, and whether no direction is stable.

    `known` is the answer of `kilter.orient`, if it exists already. Reasons for omitted answers are
    appended to `notes`.
    """
    free = _free_count(assembly)
    if free > REGION_PARTS:
        notes.append(
            f"the page computes the stable region for up to {REGION_PARTS} free parts, so it "
            "answers only the given direction; 'kilter region' has no such limit"
        )
        return None, None, False
    try:
        if known is not None or free <= NEAREST_PARTS:
            answer = known or orient(assembly, contacts=contacts, progress=tell)
            verdict = turned_verdict(assembly, contacts, answer.down, effort)
            stable = answer.stable_region
            if (stable.gap_deg or 0.0) > GAP_DEG:  # only its widest cone was refined
                stable = _region(assembly, contacts, notes)
            return (
                stable,
                full_answer(verdict, answer.sentence),
                answer.verdict == "none",
            )
        tell("stable region")
        stable = _region(assembly, contacts, notes)
    except InputError as error:
        notes.append(f"the page answers only the given direction of gravity: {error.what}")
        return None, None, False
    center = stable.center if stable.center is not None else _nearest_line(stable, assembly.down)
    if center is None:
        notes.append(
            f"the page computes the direction nearest to stable for up to {NEAREST_PARTS} free "
            "parts; 'kilter orient' has no such limit"
        )
        return stable, None, False
    tell("recommended direction")
    verdict = turned_verdict(assembly, contacts, center, effort)
    return stable, full_answer(verdict, verdict.sentence), False


def _region(assembly: Assembly, contacts: ContactSet, notes: list[str]) -> Region:
    """The stable region of an assembly; notes explain parts of the computation that were left out.

    Friction is left out for a large assembly in space.
    """
    rubs = bool((contacts.patch_mu > 0).any()) and not assembly.planar
    if not rubs or _free_count(assembly) <= FRICTION_PARTS:
        return region(assembly, contacts=contacts)
    notes.append(
        f"the page computes the region with friction for up to {FRICTION_PARTS} free parts, so it "
        "shows the region without friction; 'kilter region' has no such limit"
    )
    return common_region([assembly], contacts=[contacts])


def _with_rests(stable: Region, assembly: Assembly, contacts: ContactSet) -> Region:
    """A stable region with the directions of gravity at which the assembly rests on a minimum.

    The region is returned unchanged with friction, in the plane, and for a large assembly.
    """
    rubs = bool((contacts.patch_mu > 0).any())
    if rubs or assembly.planar or _free_count(assembly) > REST_PARTS:
        return stable
    return replace(stable, rests=find_rests(stable.cone, assembly, contacts))


def _nearest_line(stable: Region, down: Array) -> Array | None:
    """Unit vector nearest to `down` on the lines of a stable region; None without lines."""
    if not len(stable.lines):
        return None
    along: Array = stable.lines.T @ (stable.lines @ down)
    length = float(np.linalg.norm(along))
    # gravity perpendicular to all lines: rounding of an exact zero must not become a direction
    return along / length if length > 1e-9 else np.asarray(stable.lines[0])


def _ray_forces(assembly: Assembly, contacts: ContactSet, stable: Region) -> tuple[Balance, ...]:
    """Contact forces for gravity along each ray and line of a region; empty if too many.

    Each line has forces for both of its directions.
    """
    directions = len(stable.rays) + 2 * len(stable.lines)
    if not directions or directions * len(contacts.points) > RAY_FORCES:
        return ()
    balances = []
    for each in stable.verified(("ray", "line")):
        program, proof = each.program, each.certificate
        if isinstance(proof, ForceProof):
            rows = np.flatnonzero(program.kind == CONTACT)
            parts = np.stack([program.part_a[rows], program.part_b[rows]], axis=1)
            forces = program.point_forces(proof.forces, proof.friction)
            balances.append(_balance(each.assembly.down, program.point[rows], parts, forces))
    return tuple(balances)


def _margin(
    assembly: Assembly, contacts: ContactSet, always: bool, tell: Tell, notes: list[str]
) -> Margin | None:
    """The margins for the given gravity; None for a large assembly unless `always` is set."""
    free = _free_count(assembly)
    if not free:
        return None
    if free > MARGIN_PARTS and not always:
        notes.append(
            f"the page computes margins for up to {MARGIN_PARTS} free parts; 'kilter report "
            "--margins' and 'kilter margin' have no such limit"
        )
        return None
    # effort 0, since the check already reports the guarantee of friction
    return margin(
        assembly,
        contacts=contacts,
        pushes=True,
        loads=bool(assembly.bonds),
        improve=free <= HELD_TRIED or is_brick_model(assembly),
        effort=0,
        progress=tell,
    )


def _brick_change(limits: Margin) -> TriedChange | None:
    """The brick to add or to remove that helps most; None for other assemblies."""
    best = limits.improvements[:1]
    return next((change for change in best if change.what in ("add", "remove")), None)


def _map(
    assembly: Assembly, contacts: ContactSet, tell: Tell, notes: list[str]
) -> MapMotions | None:
    """The stability map with a motion for each vertex; None if the assembly or map is too large."""
    free = _free_count(assembly)
    consequence = (
        "so the ball shows the stable region in a single colour, and the page shows motions only "
        "for directions that have a button"
    )
    if free > MAP_PARTS:
        notes.append(f"the page computes the map for up to {MAP_PARTS} free parts, {consequence}")
        return None
    tell("stability map")
    program = build_program(assembly, contacts)
    try:
        full_map = stability_map(program, limit=MAP_PROGRAMS)
    except SolverError:
        notes.append(f"the stability map needs more than {MAP_PROGRAMS} programs, {consequence}")
        return None
    if len(full_map.vertices) * free > MAP_MOTIONS:
        notes.append(f"the stability map has {len(full_map.vertices)} partitions, {consequence}")
        return None
    motions = np.array([_motion(program, full_map, k) for k in range(len(full_map.vertices))])
    return MapMotions(np.asarray(full_map.vertices), full_map.mass, motions)


def _motion(program: Program, full_map: StabilityMap, vertex: int) -> Array:
    """Optimal displacement of least norm for the middle of a vertex's partition, shape (N, 6)."""
    at_rest = np.zeros((len(program.names), 6))
    middle = full_map.partition(vertex).sum(axis=0)
    # the vertex 0 belongs to the stable directions, for which nothing moves
    if not middle.any() or not full_map.vertices[vertex].any():
        return at_rest
    motion = find_displacement(program.turned(middle)).displacement
    return at_rest if motion is None else motion
