"""The limits that the user requested of `kilter.margin`, validated.

A push has a direction, an axis is across gravity, and only free parts are pushed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kilter.analysis.margins.uncertainty import Ranges
from kilter.analysis.turning_tolerances import ACROSS_GRAVITY
from kilter.arrays import Array
from kilter.assembly import Assembly, require_assembly
from kilter.assembly.bonds import NO_CONE, NOT_RANGED, require_no_bonds
from kilter.assembly.plain_joints import require_plain_joints
from kilter.errors import InputError
from kilter.rigid import unit
from kilter.tell.levels import require_level

__all__ = ["PUSHED", "MarginQuestion", "margin_question"]

PUSHED = 20
"""Largest number of free parts for which the weakest push of every part is computed by default."""


@dataclass(frozen=True, slots=True, eq=False)
class MarginQuestion:
    """The limits that `kilter.margin` is to compute, validated."""

    assembly: Assembly
    push: Array | None
    """Unit direction of the body force of the load factor, world frame, shape (3,); None: the
    given loads."""
    axis: Array | None
    """Unit axis of a further tilt, world frame, perpendicular to gravity, shape (3,)."""
    pushed: list[int]
    """Parts for which the weakest push and the gain of a grip are computed."""
    loaded: list[int]
    """Parts for which the largest further load straight down is computed."""
    omits_pushes: bool
    """Whether `pushed` is empty because the assembly has more than `PUSHED` free parts."""
    ranges: Ranges | None
    """Intervals of the worst case; None: no worst case is computed."""
    bracket: bool
    """Whether the load factor without dilation is also computed."""
    require: str
    """Level of the further tilt; "equilibrium": no further tilt is computed."""


def margin_question(
    assembly: Assembly,
    *,
    push: Any,
    about: Any,
    pushed: list[str] | None,
    loads: bool,
    ranges: Ranges | None,
    bracket: bool,
    require: str,
) -> MarginQuestion:
    """Validate the arguments of `kilter.margin`.

    Raises `InputError` as `kilter.margin`.
    """
    require_assembly(assembly, "margin")
    direction = None if push is None else unit(push, "push")
    level = require_level(require)
    axis = None if about is None else _axis(assembly, about)
    if axis is not None:
        _require_turnable(assembly)
    if ranges is not None:
        require_no_bonds(assembly, "the worst case over ranges", NOT_RANGED)
        require_plain_joints(assembly, "the worst case over ranges")
    chosen = _free_parts(assembly) if pushed is None else _named_parts(assembly, pushed)
    omits_pushes = pushed is None and len(chosen) > PUSHED
    return MarginQuestion(
        assembly=assembly,
        push=direction,
        axis=axis,
        pushed=[] if omits_pushes else chosen,
        loaded=chosen if loads else [],
        omits_pushes=omits_pushes,
        ranges=ranges,
        bracket=bracket,
        require=level,
    )


def _axis(assembly: Assembly, about: Any) -> Array:
    """Validate the unit axis of a tilt: perpendicular to gravity, and y for a planar assembly."""
    axis = unit(about, "axis of the tilt")
    if abs(float(axis @ assembly.down)) > ACROSS_GRAVITY:
        raise InputError(
            f"the axis {axis.tolist()} is not perpendicular to gravity",
            hint="give a horizontal axis",
        )
    if assembly.planar and abs(abs(float(axis[1])) - 1) > ACROSS_GRAVITY:
        raise InputError(
            "the axis is not perpendicular to the plane", hint="give 0 1 0 for planar assemblies"
        )
    return axis


def _require_turnable(assembly: Assembly) -> None:
    """Reject a tilt about an axis if the assembly has loads or bonds, which do not turn with it."""
    require_no_bonds(assembly, "a tilt about an axis", NO_CONE)
    require_plain_joints(assembly, "a tilt about an axis")
    if assembly.loads:
        raise InputError(
            "a tilt about an axis is not defined with loads: they do not turn with gravity",
            file=assembly.source or None,
            part=assembly.loads[0].part,
            hint="leave the loads out, or compute the margins without an axis",
        )


def _free_parts(assembly: Assembly) -> list[int]:
    """Indices of the parts that are not held in place."""
    return [k for k, part in enumerate(assembly.parts) if not part.grounded]


def _named_parts(assembly: Assembly, names: list[str]) -> list[int]:
    """Indices of the named parts, in the given order; each of them must be free."""
    chosen = []
    for name in names:
        k = assembly.index_of(name)
        if assembly.parts[k].grounded:
            raise InputError("it is held, so no push moves it", part=name, hint="name a free part")
        chosen.append(k)
    return chosen
