"""Which way up friction can hold it: the middle of the directions that have such forces."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.judge import Judgement, judge
from kilter.analysis.regions.friction_region import FrictionRegion, find_region_with_friction
from kilter.analysis.turning.nearest import Method, turned
from kilter.analysis.turning.orientation import (
    Orientation,
    candidate_directions,
    least_turn,
    orient,
    require_turnable,
    tilt_margin_deg,
)
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, find_contacts
from kilter.mechanics.program import Program, build_program

__all__ = ["orient_with_friction"]


def orient_with_friction(
    assembly: Assembly,
    contacts: ContactSet | None = None,
    *,
    tolerance: Tolerance | None = None,
    method: Method = "joint",
    progress: Callable[[str], None] | None = None,
) -> Orientation:
    """How could it be turned so that forces that hold it exist? Where mu = 0, `orient`.

    Found is the axis of the widest cone inside the inner cone. Where there is none, the
    nearest is that without friction.

    Raises
    ------
    InputError
        As `orient` does.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> answer = orient_with_friction(stacks.block_on_slope(40.0, friction=0.5))
    >>> answer.verdict, round(answer.tilt_margin_deg, 1)
    ('found', 26.6)
    """
    require_turnable(assembly, method)
    if contacts is None:
        contacts = find_contacts(assembly, tolerance=tolerance, progress=progress)
    if not (contacts.patch_mu > 0).any():
        return orient(assembly, contacts, method=method, progress=progress)
    region = find_region_with_friction(assembly, contacts, progress=progress)
    assert isinstance(region, FrictionRegion)
    program = build_program(assembly, contacts)
    for direction in candidate_directions(program, region):
        down = direction / float(np.linalg.norm(direction)) + 0.0
        judgement = judge(turned(program, down))
        if judgement.stable:
            return _found(assembly, contacts, program, region, down, judgement, method)
    return _not_found(orient(assembly, contacts, method=method, progress=progress), region)


def _found(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    region: FrictionRegion,
    down: Array,
    judgement: Judgement,
    method: Method,
) -> Orientation:
    margin = tilt_margin_deg(program, region, down)
    verdict = check(assembly.with_down(down), contacts=contacts, budget=0.0)
    x, y, z = (f"{round(float(c), 6) + 0.0:g}" for c in down)
    words = "any turn keeps them" if margin >= 180 else f"a tilt by {margin:.4g} degrees keeps them"
    sentence = (
        f"Forces that hold it exist with gravity along ({x}, {y}, {z}) of the assembly's frame, and"
        f" {words}; 'kilter check --down {x} {y} {z}' tells what friction guarantees there."
    )
    return Orientation(
        verdict="found",
        sentence=sentence,
        assembly=assembly,
        down=down,
        rotation=least_turn(assembly, down),
        tilt_margin_deg=margin,
        z=verdict.displacement.z,
        instability=verdict.motion.instability,
        nearest=None,
        method=method,
        programs=region.programs,
        judgement=judgement,
        check=None,
        region=region,
        warnings=region.warnings,
    )


def _not_found(smooth: Orientation, region: FrictionRegion) -> Orientation:
    """The answer without friction, which knows what is nearest; and that friction is no help."""
    if smooth.found or not region.none:
        return smooth
    return dataclasses.replace(
        smooth,
        verdict="none",
        sentence="No orientation is held, not even with friction; without it the nearest has "
        f"gravity along {np.round(smooth.down, 6).tolist()} of the assembly's frame, and here is "
        "what moves there.",
        region=region,
    )
