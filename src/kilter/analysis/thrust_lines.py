"""Lines of thrust of a chain of parts, such as an arch, at its least and at its greatest thrust.

The thrust is the horizontal force of the first support on the chain, along the span. The line joins
the centres of pressure of the contacts, in the equilibrium that attains an end of the range of the
thrust (`kilter.analysis.force_ranges`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kilter.analysis.force_ranges import ForceEnd, ForceRange, pressed_pairs, rows_between
from kilter.arrays import Array
from kilter.errors import InputError
from kilter.mechanics.program import Program, build_program
from kilter.tell.numbers import count

if TYPE_CHECKING:
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly import Assembly

LEVEL = 1e-6
"""Least horizontal share of the direction between both ends of a chain [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class ThrustLines:
    """The range of the thrust of a chain of parts, and the line of thrust at each end."""

    assembly: Assembly
    span: Array
    """Horizontal unit vector from the first to the last contact, shape (3,)."""
    pairs: tuple[tuple[str, str], ...]
    """Names of the parts of each contact, from support to support."""
    thrust: ForceRange
    """Least and greatest thrust [N]."""
    least: Array | None
    """Centres of pressure at the least thrust, shape (n, 3); None if the thrust has no limit."""
    greatest: Array | None
    """Centres of pressure at the greatest thrust, shape (n, 3); None if the thrust has no limit."""


def find_thrust_lines(verdict: Verdict) -> ThrustLines:
    """Compute both lines of thrust of a chain of parts between supports.

    Raises `InputError` if the free parts are no chain, or no contact forces balance them.
    """
    program = build_program(verdict.assembly, verdict.contact_set)
    chain = _chain(program)
    names = [(program.names[a], program.names[b]) for a, b in chain]
    ends = [program.point[rows_between(program, chain[k])].mean(axis=0) for k in (0, -1)]
    way = ends[1] - ends[0]
    span = way - way @ program.down * program.down
    if np.linalg.norm(span) <= LEVEL * np.linalg.norm(way):
        raise InputError(
            "the supports are above each other, so no thrust acts between them",
            hint="draw the assembly without --what thrust",
        )
    ranges = verdict.force_ranges([names[0]], span)
    if not ranges:
        raise InputError(f"no contact forces are known to balance the parts: {verdict.sentence}")
    (thrust,) = ranges
    lines = [_line(program, chain, end) for end in (thrust.least, thrust.greatest)]
    assert thrust.along is not None
    return ThrustLines(
        verdict.assembly, np.asarray(thrust.along), tuple(names), thrust, lines[0], lines[1]
    )


def _chain(program: Program) -> list[tuple[int, int]]:
    """Pairs of parts that touch, from support to support; the second part comes later.

    Raises `InputError` if the free parts are no chain.
    """
    pairs = [(a, b) for a, b in pressed_pairs(program) if program.free[[a, b]].any()]
    touching: dict[int, list[int]] = {k: [] for k in np.flatnonzero(program.free).tolist()}
    for a, b in pairs:
        for part, other in ((a, b), (b, a)):
            if part in touching:
                touching[part].append(other)
    for part, others in touching.items():
        if len(others) != 2:
            number = count(len(others), "part")
            raise InputError(
                f"{program.names[part]!r} touches {number}: a line of thrust needs a chain of "
                "parts between two supports",
                hint="leave parts out of the assembly",
                option="leave parts out: --without NAME",
            )
    held = [pair for pair in pairs if not program.free[list(pair)].all()]
    if not held:
        raise InputError("no chain of parts begins at a support")
    a, b = held[0]
    chain = [(a, b) if program.free[b] else (b, a)]
    while program.free[chain[-1][1]]:
        before, part = chain[-1]
        first, second = touching[part]
        chain.append((part, second if first == before else first))
    if len(chain) != len(pairs):
        raise InputError("the parts are several chains", hint="draw one chain at a time")
    return chain


def _line(program: Program, chain: list[tuple[int, int]], end: ForceEnd) -> Array | None:
    """Centre of pressure of each contact of a chain, (n, 3), in the equilibrium of an end."""
    if end.value is None or end.evidence is None:
        return None
    forces = np.zeros(len(program.part_a))
    for piece in end.evidence:
        forces[piece.rows] = piece.forces.forces
    points = []
    for pair in chain:
        rows = rows_between(program, pair)
        if forces[rows].any():
            points.append(np.average(program.point[rows], axis=0, weights=forces[rows]))
    return np.array(points)
