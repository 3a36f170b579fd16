"""All the answers that a page shows, asked for once, each within its limit.

The verdict and the exact region are found at every size; what takes many programs (the
nearest direction where none is stable, the stability map, forces for every ray) only where
the assembly is small, and the page says what was left out.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError, SolverError

if TYPE_CHECKING:
    from kilter.analysis.regions.region import Region
    from kilter.analysis.verdict import Verdict
    from kilter.assembly import Assembly
    from kilter.contact import ContactSet, Tolerance
    from kilter.show.answers import Answers, Balance, MapAnswer, Orientation

__all__ = ["gather"]

Tell = Callable[[str], None]

REGION_PARTS = 3000
"""Up to this many free parts the stable region is looked for."""
NEAREST_PARTS = 40
"""Up to this many free parts the nearest direction is looked for where none is stable."""
MAP_PARTS = 40
"""Up to this many free parts the stability map is looked for."""
MAP_PROGRAMS = 1500
"""A map that needs more programs is left out."""
MAP_MOTIONS = 12_000
"""Vertices of the map times free parts: above this its motions take too long."""
RAY_FORCES = 60_000
"""Rays times contact points: above this their forces would fill the page."""
PACKAGES = ("kilter", "numpy", "scipy", "highspy", "clarabel")


def gather(
    assembly: Assembly,
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    budget: float = 5.0,
    command: str = "",
    progress: Tell | None = None,
) -> Answers:
    """Every answer about an assembly that a page shows.

    Raises
    ------
    InputError
        If nothing is held, or the geometry is not usable.
    """
    from kilter.analysis.check import check
    from kilter.contact import find_contacts
    from kilter.show.answers import Answers

    tell = progress or (lambda stage: None)
    assembly.require_grounded()
    if contacts is None:
        contacts = find_contacts(assembly, tolerance=tolerance, progress=progress)
    verdict = check(assembly, contacts=contacts, budget=budget, progress=progress)
    tell("motion")
    given = _answered(verdict)
    notes: list[str] = []
    region, recommended, none = _turned(assembly, contacts, budget, tell, notes)
    return Answers(
        assembly=assembly,
        contacts=contacts,
        given=given,
        recommended=recommended,
        region=None if region is None else region.to_dict(),
        none=none,
        rays=() if region is None else _rays(assembly, contacts, region),
        map=None if region is None else _map(assembly, contacts, tell, notes),
        notes=tuple(notes),
        command=command,
        versions=_versions(),
    )


def _answered(verdict: Verdict, sentence: str = "") -> Orientation:
    """One direction in full, with the forces that prove it where it holds."""
    from kilter.show.answers import Balance, Orientation

    balance: Balance | None = None
    if verdict.verdict in ("stable", "potentially-stable") and verdict.certificate is not None:
        balance = Balance.of_proof(verdict.proof(), verdict.assembly.index)
    return Orientation(verdict.assembly.down, verdict.to_dict(), balance, sentence)


def _turned(
    assembly: Assembly, contacts: ContactSet, budget: float, tell: Tell, notes: list[str]
) -> tuple[Region | None, Orientation | None, bool]:
    """The stable region, the direction that is recommended, and whether none is, proved."""
    from kilter.analysis.check import check
    from kilter.analysis.regions.region import region as find_region
    from kilter.analysis.turning.orientation import orient

    free = sum(not part.grounded for part in assembly.parts)
    if free > REGION_PARTS:
        notes.append(
            f"the stable region is found up to {REGION_PARTS} free parts, so only the given "
            "direction is answered; 'kilter region' looks at every size"
        )
        return None, None, False
    try:
        if free <= NEAREST_PARTS:
            answer = orient(assembly, contacts=contacts, progress=tell)
            turned = check(assembly.with_down(answer.down), contacts=contacts, budget=budget)
            return answer.region, _answered(turned, answer.sentence), answer.verdict == "none"
        tell("stable region")
        region = find_region(assembly, contacts=contacts)
    except InputError as error:
        notes.append(f"other directions of gravity are not answered: {error.what}")
        return None, None, False
    center = region.center if region.center is not None else _first(region, assembly.down)
    if center is None:
        notes.append(
            f"the direction nearest to stable is looked for up to {NEAREST_PARTS} free parts; "
            "'kilter orient' looks at every size"
        )
        return region, None, False
    tell("recommended direction")
    turned = check(assembly.with_down(center), contacts=contacts, budget=budget)
    return region, _answered(turned, turned.sentence), False


def _first(region: Region, down: Array) -> Array | None:
    """The direction of a region without a centre that is nearest to gravity; None where none."""
    if not len(region.lines):
        return None
    along: Array = region.lines.T @ (region.lines @ down)
    length = float(np.linalg.norm(along))
    return along / length if length > 1e-9 else np.asarray(region.lines[0])


def _rays(assembly: Assembly, contacts: ContactSet, region: Region) -> tuple[Balance, ...]:
    """Forces for each ray and both signs of each line, where they are not too many."""
    from kilter.show.answers import Balance

    directions = len(region.rays) + 2 * len(region.lines)
    if not directions or directions * len(contacts.points) > RAY_FORCES:
        return ()
    found = [
        Balance.of_proof(proof.data, assembly.index)
        for proof in region.proofs()
        if proof.about in ("ray", "line")
    ]
    return tuple(one for one in found if one is not None)


def _map(
    assembly: Assembly, contacts: ContactSet, tell: Tell, notes: list[str]
) -> MapAnswer | None:
    """The stability map with a motion a vertex, where it is small enough."""
    from kilter.analysis.turning.stability_map import stability_map
    from kilter.mechanics.program import build_program
    from kilter.show.answers import MapAnswer

    free = sum(not part.grounded for part in assembly.parts)
    left = "so the ball shows the stable region and no colour, and no motion but for the buttons"
    if free > MAP_PARTS:
        notes.append(f"the stability map is found up to {MAP_PARTS} free parts, {left}")
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
    return MapAnswer(np.asarray(found.vertices), found.mass, motions)


def _motion(program: Any, found: Any, vertex: int) -> Array:
    """The displacement of LP (9) of least 2-norm in the middle of a partition, shape (N, 6)."""
    from kilter.analysis.displacement import find_displacement

    nothing = np.zeros((len(program.names), 6))
    middle = found.partition(vertex).sum(axis=0)
    if not middle.any() or not found.vertices[vertex].any():
        return nothing
    motion = find_displacement(program.turned(middle)).displacement
    return nothing if motion is None else motion


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "unknown"
    return found
