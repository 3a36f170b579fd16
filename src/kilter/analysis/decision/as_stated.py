"""Does the accuracy that a file states for its points explain a motion?

A STEP file says how far its points may be off, often .01 mm. Points of a contact of width w that
are off by d turn its normal by d / w and put its forces aside by d. So a motion is explained if
for every part, of mass m and inertia I, weight m g,

    |m a| <= m g d / w        |I alpha| <= m g d        d = d_a + d_b <= STATED_MOST x size

An assembly all of whose motions are so slow stands or falls with points that the file does not
know so well: it is not proved unstable. Stability concerns the assembly as drawn.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.analysis_tolerances import STATED_MOST
from kilter.analysis.verdict.motion import find_motion
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.program import Program
from kilter.shape.solid import Solid
from kilter.tell.numbers import number
from kilter.units import metres_per_unit

__all__ = ["explained_by_accuracy", "stated_accuracy"]


def explained_by_accuracy(assembly: Assembly, contacts: ContactSet, program: Program) -> str:
    """Reason why an unstable assembly is undecided; empty if the accuracy does not explain it.

    Parameters
    ----------
    program : Program
        Without friction, of which a motion is proved.
    """
    off = stated_accuracy(assembly)
    if not off.any() or assembly.loads or len(program.gripping):
        return ""
    motion = find_motion(program)
    if not motion.known:  # unstable as drawn, and no more is known
        return ""
    force, lever = _unbalanced(program, motion.acceleration)
    aside, width = _by_contacts(contacts, off)
    if (force * width > aside).any() or (lever > aside).any():
        return ""
    fastest = assembly.names[int(motion.relative.max(axis=1).argmax())]
    stated = f"{number(float(off.max()), 3)} {assembly.units}"
    return (
        f"the coordinates are not accurate enough to decide: as drawn {fastest!r} starts to move, "
        f"but it would hold if points moved by {stated}, which is the accuracy that the file states"
    )


def stated_accuracy(assembly: Assembly) -> Array:
    """How far points of each part may be off, shape (N,) [length unit]."""
    shapes = (part.shape for part in assembly.parts)
    return np.array([shape.uncertainty if isinstance(shape, Solid) else 0.0 for shape in shapes])


def _unbalanced(program: Program, acceleration: Array) -> tuple[Array, Array]:
    """The force that moves each part over its weight [-], the torque over it [length unit]."""
    force = np.linalg.norm(acceleration[:, :3], axis=1) / program.g
    torque = np.einsum("nij,nj->ni", program.inertia, acceleration[:, 3:])
    lever = np.linalg.norm(torque, axis=1) / (program.mass * program.g)
    return force, lever * metres_per_unit(program.units)


def _by_contacts(contacts: ContactSet, off: Array) -> tuple[Array, Array]:
    """How far points of each part's contacts may be off, and their least width, shape (N,).

    Of a part without contacts 0, and no width.
    """
    geometry, parts = contacts.assembly.geometry, contacts.patch_parts
    both = np.minimum(off[parts].sum(axis=1)[:, None], STATED_MOST * geometry.size[parts])
    aside, width = np.zeros(len(off)), np.full(len(off), np.inf)
    np.maximum.at(aside, parts, both)
    known = contacts.patch_accuracy > 0
    wide = geometry.accuracy[parts[known]].sum(axis=1) / contacts.patch_accuracy[known]
    np.minimum.at(width, parts[known], wide[:, None])
    return aside, np.where(np.isfinite(width), width, geometry.size)
