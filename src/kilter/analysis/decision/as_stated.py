"""Decide whether inaccurate coordinates, as the input states them, explain a proved motion.

A STEP file states an uncertainty of its points, often 0.01 mm. If the points of a contact of
width w are wrong by d, the normal turns by d / w and the forces shift sideways by d. So this
accuracy explains a motion if for every part, of mass m, inertia I and weight m g,

    |m a| <= m g d / w        |I alpha| <= m g d        d = d_a + d_b <= STATED_MOST x size

If all parts move so slowly, the verdict depends on coordinates that the file does not state so
accurately. The assembly is then not proved unstable. A proof of stability is for the geometry as
drawn and is not examined here.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.analysis_tolerances import STATED_MOST
from kilter.analysis.decision.motion import find_motion
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.program import Program
from kilter.shape.solid import Solid
from kilter.tell.numbers import number
from kilter.units import metres_per_unit

__all__ = ["explained_by_accuracy", "stated_accuracy"]


def explained_by_accuracy(assembly: Assembly, contacts: ContactSet, program: Program) -> str:
    """Explain how inaccurate coordinates may cause a proved motion; empty if they cannot cause it.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    program : Program
        Program of all parts against which a motion is proved.
    """
    off = stated_accuracy(assembly)
    # the bounds above compare accelerations with weights alone, so loads and bonds are left out
    if not off.any() or assembly.loads or assembly.straps or len(program.gripping):
        return ""
    motion = find_motion(program)
    if not motion.known:  # the solver failed: the assembly is unstable as drawn
        return ""
    force, lever = _net_force_and_torque(program, motion.acceleration)
    aside, width = _inaccuracy_and_width(contacts, off)
    if (force * width > aside).any() or (lever > aside).any():
        return ""
    fastest = assembly.names[int(motion.relative.max(axis=1).argmax())]
    stated = f"{number(float(off.max()), 3)} {assembly.units}"
    return (
        f"the coordinates are not accurate enough to decide: as drawn {fastest!r} starts to move, "
        f"but it would hold if points moved by {stated}, which is the accuracy that the file states"
    )


def stated_accuracy(assembly: Assembly) -> Array:
    """Stated inaccuracy of the points of each part, shape (N,) [length unit]; 0 if not stated."""
    shapes = (part.shape for part in assembly.parts)
    return np.array([shape.uncertainty if isinstance(shape, Solid) else 0.0 for shape in shapes])


def _net_force_and_torque(program: Program, acceleration: Array) -> tuple[Array, Array]:
    """Net force over weight [-] and net torque over weight [length unit] of each part, both (N,).

    Both result from the given accelerations.
    """
    force = np.linalg.norm(acceleration[:, :3], axis=1) / program.g
    torque = np.einsum("nij,nj->ni", program.inertia, acceleration[:, 3:])
    lever = np.linalg.norm(torque, axis=1) / (program.mass * program.g)
    return force, lever * metres_per_unit(program.units)


def _inaccuracy_and_width(contacts: ContactSet, off: Array) -> tuple[Array, Array]:
    """Inaccuracy of the contact points, and least width of the contacts, of each part, (N,).

    Both are in length units.

    A part without contacts has inaccuracy 0. Its size replaces an unknown width.
    """
    geometry, parts = contacts.assembly.geometry, contacts.patch_parts
    both = np.minimum(off[parts].sum(axis=1)[:, None], STATED_MOST * geometry.size[parts])
    aside, width = np.zeros(len(off)), np.full(len(off), np.inf)
    np.maximum.at(aside, parts, both)
    known = contacts.patch_accuracy > 0
    wide = geometry.accuracy[parts[known]].sum(axis=1) / contacts.patch_accuracy[known]
    np.minimum.at(width, parts[known], wide[:, None])
    return aside, np.where(np.isfinite(width), width, geometry.size)
