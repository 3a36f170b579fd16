"""Every answer about an assembly that a page shows, asked for once, each within its limit.

The verdict and the region are computed at every size that a page can show. Results that take many
programs (the nearest direction if none is stable, the stability map, forces for every
ray) are computed only for small assemblies, and `notes` lists those that were left out.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.margins.improve import Improvement, improve
from kilter.analysis.margins.margin import PUSHED, margin
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.region import Region, common_region, region
from kilter.analysis.regions.rests import find_rests
from kilter.analysis.turning.orientation import orient
from kilter.analysis.turning.stability_map import StabilityMap, stability_map
from kilter.analysis.verdict.displacement import find_displacement
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index
from kilter.assembly import Assembly, require_assembly
from kilter.contact import ContactSet, Tolerance, detect
from kilter.errors import InputError, SolverError, TimeLimitReached
from kilter.mechanics.program import Program, build_program
from kilter.second_order.answer.path_places import PathPlaces, find_path_places
from kilter.threads import on_one_thread
from kilter.work import EFFORT, stop_after

__all__ = ["Answered", "Balance", "Everything", "MapMotions", "everything"]

T = TypeVar("T")
Tell = Callable[[str], None]

REGION_PARTS = 3000
"""Up to this many free parts the stable region is looked for."""
FRICTION_PARTS = 60
"""In space, up to this many free parts its region is found with friction."""
NEAREST_PARTS = 40
"""Up to this many free parts the nearest direction is looked for where none is stable."""
MAP_PARTS = 40
"""Up to this many free parts the stability map is looked for."""
MAP_PROGRAMS = 1500
"""A map that needs more programs is left out."""
MAP_MOTIONS = 12_000
"""Vertices of the map times free parts: above this its motions take too long."""
MARGIN_PARTS = PUSHED
"""Up to this many free parts margins are looked for, each part's weakest push among them."""
REST_PARTS = 3
"""Up to this many free parts it is asked how it rests in each direction of its region."""
CHANGE_PARTS = 40
"""Up to this many free bricks it is looked for which one to add or to take away."""
RAY_FORCES = 60_000
"""Rays times contact points: above this their forces would fill the page."""


@dataclass(frozen=True, slots=True, eq=False)
class Balance:
    """Contact forces that balance every part for a direction of gravity.

    Attributes
    ----------
    down : ndarray, shape (3,)
    points : ndarray, shape (K, 3)
        Points of the forces [length unit].
    parts : ndarray of int, shape (K, 2)
    forces : ndarray, shape (K, 3)
        On the second part [N].
    pull : ndarray, shape (K,), or None
        Largest pull of the bonds there [N]; None without bonds.
    """

    down: Array
    points: Array
    parts: Index
    forces: Array
    pull: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Answered:
    """A direction of gravity, answered in full.

    Attributes
    ----------
    down : ndarray, shape (3,)
    check : dict
        The answer of `kilter check --json`.
    balance : Balance or None
        The forces of that answer.
    sentence : str
        Special property of this direction.
    path : PathPlaces or None
        Path of the fall of a balanced assembly.
    """

    down: Array
    check: dict[str, Any]
    balance: Balance | None
    sentence: str = ""
    path: PathPlaces | None = None


@dataclass(frozen=True, slots=True, eq=False)
class MapMotions:
    """The stability map with a motion a vertex; world frame, without friction.

    Attributes
    ----------
    vertices : ndarray, shape (V, 3)
        z(g) = -max over vertices of q.g [kg x length unit].
    mass : float
        Of the free parts [kg].
    motions : ndarray, shape (V, N, 6)
        The displacement of LP (9) of least 2-norm for which that vertex is the farthest.
    """

    vertices: Array
    mass: float
    motions: Array


@dataclass(frozen=True, slots=True, eq=False)
class Everything:
    """All that a page shows.

    Attributes
    ----------
    assembly : Assembly
    contacts : ContactSet
    given : Answered
        Gravity as in the file or as asked for.
    recommended : Answered or None
    region : dict or None
        The answer of `kilter region --json`.
    inner : Cone or None
        Inner cone of the region, if friction makes its boundary round: the facets
        of `region` are then those of an outer cone.
    none : bool
        It is proved that no direction is stable, whatever further forces there may be.
    rays : sequence of Balance
        Forces for each ray, and both signs of each line, of the region.
    map : MapMotions or None
    margin : dict or None
        The answer of `kilter margin --json`, for gravity as given.
    change : Improvement or None
        Brick to add or to take away, for models of bricks.
    notes : sequence of str
        Results that are not shown, with the reason.
    """

    assembly: Assembly
    contacts: ContactSet
    given: Answered
    recommended: Answered | None
    region: dict[str, Any] | None
    inner: Cone | None
    none: bool
    rays: Sequence[Balance]
    map: MapMotions | None
    margin: dict[str, Any] | None
    change: Improvement | None
    notes: Sequence[str]

    def __repr__(self) -> str:
        return f"Everything({self.given.check['verdict']!r}, {len(self.assembly.parts)} parts)"


@on_one_thread
def everything(
    assembly: Assembly,
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    margins: bool = False,
    progress: Tell | None = None,
) -> Everything:
    """Every answer about an assembly that a page shows.

    Parameters
    ----------
    assembly : Assembly
        It has at least one held part.
    contacts, tolerance, effort, time_limit, progress
        As of `kilter.check`.
    margins : bool
        Margins at every size, not only up to `MARGIN_PARTS` free parts; of bricks what to change
        too, not only up to `CHANGE_PARTS`.

    Raises
    ------
    InputError
        If nothing is held, or the geometry is not usable.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> everything(scene("tower"))
    Everything('stable', 6 parts)
    """
    tell = progress or (lambda stage: None)
    started = time.perf_counter()
    require_assembly(assembly, "report")
    assembly.require_grounded()
    if contacts is None:
        contacts = detect.contacts(assembly, tolerance=tolerance, progress=progress)
    left = None if time_limit is None else max(started + time_limit - time.perf_counter(), 0.0)
    verdict = check(assembly, contacts=contacts, effort=effort, time_limit=left, progress=progress)
    tell("motion")
    given = _answered(verdict)
    notes: list[str] = []
    deadline = None if time_limit is None else started + time_limit

    def in_time(name: str, step: Callable[..., T], *arguments: Any) -> T | None:
        """The result of a step; None, with a note, if the time limit ends it."""
        left = None if deadline is None else max(deadline - time.perf_counter(), 0.0)
        try:
            with stop_after(left):
                return step(*arguments)
        except TimeLimitReached:
            notes.append(f"{name} left out, because the time limit was reached")
            return None

    turned = in_time("the stable region is", _turned, assembly, contacts, effort, tell, notes)
    found, recommended, none = turned or (None, None, False)
    rests = rays = vertex_map = None
    if found is not None:
        rests = in_time("the states of rest are", _with_rests, found, assembly, contacts) or found
        rays = in_time("the forces of the region are", _rays, assembly, contacts, found)
        vertex_map = in_time("the stability map is", _map, assembly, contacts, tell, notes)
    return Everything(
        assembly=assembly,
        contacts=contacts,
        given=given,
        recommended=recommended,
        region=None if rests is None else rests.to_dict(),
        inner=None if found is None or found.gap_deg is None else found.cone,
        none=none,
        rays=rays or (),
        map=vertex_map,
        margin=in_time("the margins are", _margin, assembly, contacts, margins, tell, notes),
        change=in_time("the changes are", _change, assembly, margins, tell, notes),
        notes=tuple(notes),
    )


def _answered(verdict: Verdict, sentence: str = "") -> Answered:
    """A direction in full, with the forces of its answer if it holds."""
    answer, down = verdict.to_dict(), verdict.assembly.down
    if answer["forces"] is None:
        return Answered(down, answer, None, sentence)
    second = verdict.second_order
    path = None if second is None else find_path_places(verdict.assembly, second)
    index, patches = verdict.assembly.index, answer["forces"]["patches"]
    parts = [[index[n] for n in patch["parts"]] for patch in patches for _ in patch["points"]]
    balance = _balance(
        down,
        [point for patch in patches for point in patch["points"]],
        parts,
        [force for patch in patches for force in patch["forces"]],
    )
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


def _free(assembly: Assembly) -> int:
    return sum(not part.grounded for part in assembly.parts)


def _turned(
    assembly: Assembly, contacts: ContactSet, effort: float, tell: Tell, notes: list[str]
) -> tuple[Region | None, Answered | None, bool]:
    """The region, the direction that is recommended, and whether none is, proved."""
    free = _free(assembly)
    if free > REGION_PARTS:
        notes.append(
            f"the page computes the stable region for up to {REGION_PARTS} free parts, so it "
            "answers only the given direction; 'kilter region' has no such limit"
        )
        return None, None, False
    try:
        if free <= NEAREST_PARTS:
            answer = orient(assembly, contacts=contacts, progress=tell)
            there = check(assembly.with_down(answer.down), contacts=contacts, effort=effort)
            return answer.region, _answered(there, answer.sentence), answer.verdict == "none"
        tell("stable region")
        found = _region(assembly, contacts, notes)
    except InputError as error:
        notes.append(f"the page answers only the given direction of gravity: {error.what}")
        return None, None, False
    center = found.center if found.center is not None else _first(found, assembly.down)
    if center is None:
        notes.append(
            f"the page computes the direction nearest to stable for up to {NEAREST_PARTS} free "
            "parts; 'kilter orient' has no such limit"
        )
        return found, None, False
    tell("recommended direction")
    there = check(assembly.with_down(center), contacts=contacts, effort=effort)
    return found, _answered(there, there.sentence), False


def _region(assembly: Assembly, contacts: ContactSet, notes: list[str]) -> Region:
    """The region; for large rough assemblies in space, the part that needs no friction."""
    rubs = bool((contacts.patch_mu > 0).any()) and not assembly.planar
    if not rubs or _free(assembly) <= FRICTION_PARTS:
        return region(assembly, contacts=contacts)
    notes.append(
        f"the page computes the region with friction for up to {FRICTION_PARTS} free parts, so it "
        "shows the region without friction; 'kilter region' has no such limit"
    )
    return common_region([assembly], contacts=[contacts])


def _with_rests(found: Region, assembly: Assembly, contacts: ContactSet) -> Region:
    """The region with its states of rest; unchanged with friction, or with many parts."""
    rubs = bool((contacts.patch_mu > 0).any())
    if rubs or assembly.planar or _free(assembly) > REST_PARTS:
        return found
    return replace(found, rests=find_rests(found.cone, assembly, contacts))


def _first(found: Region, down: Array) -> Array | None:
    """The direction nearest to gravity, for a region without a centre; None if it is empty."""
    if not len(found.lines):
        return None
    along: Array = found.lines.T @ (found.lines @ down)
    length = float(np.linalg.norm(along))
    # rounding of an exact zero must not become a direction
    return along / length if length > 1e-9 else np.asarray(found.lines[0])


def _rays(assembly: Assembly, contacts: ContactSet, found: Region) -> tuple[Balance, ...]:
    """Forces for each ray and both signs of each line, if they are not too many."""
    directions = len(found.rays) + 2 * len(found.lines)
    if not directions or directions * len(contacts.points) > RAY_FORCES:
        return ()
    index = assembly.index
    return tuple(
        _balance(
            proof.data["down"],
            [point["x"] for point in proof.data["points"]],
            [[index[name] for name in point["parts"]] for point in proof.data["points"]],
            proof.data["forces"],
        )
        for proof in found.proofs()
        if proof.about in ("ray", "line") and "forces" in proof.data
    )


def _margin(
    assembly: Assembly, contacts: ContactSet, always: bool, tell: Tell, notes: list[str]
) -> dict[str, Any] | None:
    """The margins of gravity as given, if the assembly is small or they are requested."""
    free = _free(assembly)
    if not free:
        return None
    if free > MARGIN_PARTS and not always:
        notes.append(
            f"the page computes margins for up to {MARGIN_PARTS} free parts; 'kilter report "
            "--margins' and 'kilter margin' have no such limit"
        )
        return None
    # what friction guarantees is said by the check
    loads = bool(assembly.bonds)
    return margin(assembly, contacts=contacts, loads=loads, effort=0, progress=tell).to_dict()


def _change(assembly: Assembly, always: bool, tell: Tell, notes: list[str]) -> Improvement | None:
    """The brick to add or to take away, if the model is small or it is requested."""
    if not assembly.bonds or any(part.brick is None for part in assembly.parts):
        return None
    if _free(assembly) > CHANGE_PARTS and not always:
        notes.append(
            f"the page looks for a brick to add or to remove in models of up to {CHANGE_PARTS} "
            "bricks; 'kilter report --margins' and 'kilter improve' have no such limit"
        )
        return None
    try:
        return improve(assembly, progress=tell)
    except InputError as error:
        notes.append(f"the page names no brick to add or to remove: {error.what}")
        return None


def _map(
    assembly: Assembly, contacts: ContactSet, tell: Tell, notes: list[str]
) -> MapMotions | None:
    """The stability map with a motion for each vertex, if it is small enough."""
    free = _free(assembly)
    left = (
        "so the ball shows the stable region without colours, and motions only for the directions "
        "of the buttons"
    )
    if free > MAP_PARTS:
        notes.append(f"the page computes the map for up to {MAP_PARTS} free parts, {left}")
        return None
    tell("stability map")
    program = build_program(assembly, contacts)
    try:
        found = stability_map(program, limit=MAP_PROGRAMS)
    except SolverError:
        notes.append(f"the stability map needs more than {MAP_PROGRAMS} programs, {left}")
        return None
    if len(found.vertices) * free > MAP_MOTIONS:
        notes.append(f"the stability map has {len(found.vertices)} partitions, {left}")
        return None
    motions = np.array([_motion(program, found, k) for k in range(len(found.vertices))])
    return MapMotions(np.asarray(found.vertices), found.mass, motions)


def _motion(program: Program, found: StabilityMap, vertex: int) -> Array:
    """The displacement of LP (9) of least 2-norm in the middle of a partition, shape (N, 6)."""
    nothing = np.zeros((len(program.names), 6))
    middle = found.partition(vertex).sum(axis=0)
    if not middle.any() or not found.vertices[vertex].any():
        return nothing
    motion = find_displacement(program.turned(middle)).displacement
    return nothing if motion is None else motion
