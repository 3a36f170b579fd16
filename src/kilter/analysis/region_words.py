"""What a region does not say by itself: knife edges, loose parts, forces left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kilter.analysis.stable_cone import StableCone
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.certificate import MotionProof, part_sizes
from kilter.mechanics.program import TOLERANCE, Program

__all__ = ["warnings_of"]

Array = NDArray[np.float64]

MOVES = 0.01
"""A part that moves less than this part of the largest motion is not named."""


def warnings_of(
    assembly: Assembly, contacts: ContactSet, program: Program, found: StableCone
) -> list[str]:
    """Warnings about a stable cone and its assembly, in words."""
    warnings = [*assembly.notes, *assembly.geometry.warnings, *contacts.warnings]
    if not program.free.any():
        warnings.append("every part is held: nothing can move")
    warnings += _inner(assembly, contacts)
    alone = _alone(assembly, contacts, program)
    if alone:
        warnings.append(f"touches nothing, so it falls whatever the orientation: {_list(alone)}")
    whole = 2 if program.planar else 3
    if 0 < found.cone.dimension < whole:
        warnings.append(_knife_edge(program, found))
    if program.tolerance[program.free].max(initial=0.0) > TOLERANCE:
        warnings.append(
            "within the accuracy of the data: directions nearer to the boundary than "
            f"{np.degrees(found.cone.blur):.2g} deg count as on it"
        )
    missing = sum(not proof.certificate.holds for proof in found.proofs)
    if missing:
        warnings.append(
            f"{missing} of {len(found.proofs)} proofs do not hold within the tolerance of the data"
        )
    return warnings


def _inner(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """What could make the region larger."""
    why = []
    if (contacts.patch_mu > 0).any():
        why.append("friction")
    if contacts.unsupported:
        pairs = [" and ".join(assembly.names[k] for k in u.parts) for u in contacts.unsupported]
        why.append(f"contacts of a kind that is not modelled yet ({_list(pairs)})")
    if not why:
        return []
    return [
        f"{' and '.join(why)} left out: every direction found is stable, and more may be,"
        " since further forces can only help"
    ]


def _alone(assembly: Assembly, contacts: ContactSet, program: Program) -> list[str]:
    """Free parts that touch nothing and are joined to nothing."""
    touched = np.zeros(len(program.names), dtype=bool)
    touched[contacts.patch_parts.ravel()] = True
    touched[[k for u in contacts.unsupported for k in u.parts]] = True
    joined = [assembly.index[n] for j in assembly.joints for n in j.parts if n in assembly.index]
    touched[joined] = True
    return [n for n, t, f in zip(program.names, touched, program.free, strict=True) if f and not t]


def _knife_edge(program: Program, found: StableCone) -> str:
    """What a cone thinner than space means, and what to hold."""
    cone = found.cone
    axes: list[Array] = []
    moving = np.zeros(len(program.names))
    for proof in found.proofs:
        if proof.about != "equation" or not isinstance(proof.certificate, MotionProof):
            continue
        sizes = part_sizes(program, proof.certificate.motion, per_radius=False)
        moving = np.maximum(moving, sizes / max(float(sizes.max(initial=0.0)), 1e-300))
        if not any(np.array_equal(proof.vector, axis) for axis in axes):
            axes.append(proof.vector)
    names = [n for n, size in zip(program.names, moving, strict=True) if size > MOVES]
    along = " and ".join(_direction(axis) for axis in axes)
    what = {"ray": "one direction", "line": "one direction and its opposite"}
    space = "the plane" if program.planar else "space"
    return (
        f"a knife edge: stable for {what.get(cone.kind, f'a {cone.kind} of directions')} only, "
        f"thinner than {space}; the least tilt along {along}, either way, sets parts in motion:"
        f" {_list(names)}. Hold them against sliding and tipping that way (a stop, a clamp or"
        " friction)"
    )


def _direction(axis: Array) -> str:
    """An axis in words: x, y or z where it is one, else its numbers."""
    for k, name in enumerate("xyz"):
        if abs(axis[k]) > 1 - 1e-9:
            return name
    return "(" + ", ".join(f"{value:.3g}" for value in axis + 0.0) + ")"


def _list(names: Sequence[str], limit: int = 5) -> str:
    shown = ", ".join(repr(name) for name in names[:limit])
    return f"{shown} and {len(names) - limit} more" if len(names) > limit else shown
