"""Pairs that look like fasteners, with the joint that each would be.

A part whose cylinder fills a hole of another, size on size or thicker, is meant to be held
by it: a bolt in a nut, a pin pressed in, a shaft in its bearing. What interferes is taken
for fixed (a thread, a press fit), and so is what is named a nut; else size on size for a
shaft that turns and slides, until it is fastened. Nothing is joined by itself: the
suggestions are to be pasted.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.assembly import Assembly
from kilter.contact.contact_set import INTERFERE, ContactSet
from kilter.contact.contact_tolerances import AXIS_ROUNDING
from kilter.contact.fits.coaxial import Fit, coaxial_fits
from kilter.contact.fits.fastening import touching_pairs

__all__ = ["Suggestion", "suggest_joints"]

NUT = re.compile(r"(?<![a-z])nut(?![a-z])", re.IGNORECASE)
"""Names of parts whose hole is taken for a thread."""


@dataclass(frozen=True, slots=True, eq=False)
class Suggestion:
    """A pair that looks like a fastener.

    Attributes
    ----------
    parts : pair of str
        The bolt, pin or shaft; the part with the hole.
    why : str
    option : str
        What to add to a command: it fixes them.
    joint : dict
        What to add to the file's `joints`.
    """

    parts: tuple[str, str]
    why: str
    option: str
    joint: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """As JSON data."""
        entry = {"parts": list(self.parts), "why": self.why}
        return {**entry, "option": self.option, "joint": self.joint}


def suggest_joints(assembly: Assembly, contacts: ContactSet) -> list[Suggestion]:
    """Pairs that look like fasteners and are not joined yet.

    Coaxial cylinders, a solid one in a hollow one, that are as thick within the tolerance or
    interfere; and pairs that the contacts name as interfering.
    """
    joined = {frozenset(joint.parts) for joint in assembly.joints}
    held = assembly.geometry.grounded
    near = [*touching_pairs(contacts), *(r.parts for r in contacts.rejected)]
    near = [pair for pair in near if not (held[pair[0]] and held[pair[1]])]
    fits: dict[frozenset[int], Fit] = {}
    for fit in coaxial_fits(assembly, near, contacts.tolerance):
        key = frozenset(fit.parts)
        if key not in fits or (fit.tight, fit.length) > (fits[key].tight, fits[key].length):
            fits[key] = fit
    names = assembly.names
    found = [_of_fit(assembly, fit) for fit in fits.values()]
    for overlap in contacts.overlaps:
        if overlap.why == INTERFERE and frozenset(overlap.parts) not in fits:
            why = f"interfere by {overlap.depth:.3g} {assembly.units}"
            found.append(_fixed((names[overlap.parts[0]], names[overlap.parts[1]]), why))
    return [one for one in found if frozenset(one.parts) not in joined]


def _of_fit(assembly: Assembly, fit: Fit) -> Suggestion:
    parts = (assembly.names[fit.parts[0]], assembly.names[fit.parts[1]])
    unit = assembly.units
    size = f"radius {fit.radius:.6g} {unit} over {fit.length:.4g} {unit}"
    if fit.tight:
        return _fixed(parts, f"coaxial, {size}, interferes by {fit.interference:.3g} {unit}")
    why = f"coaxial, size on size, {size}"
    if NUT.search(parts[1].rpartition("/")[2]):
        return _fixed(parts, f"{why}, by its name a nut")
    joint = {
        "parts": list(parts),
        "kind": "cylindrical",
        "point": (fit.point + 0.0).tolist(),
        "axis": np.where(np.abs(fit.axis) < AXIS_ROUNDING, 0.0, fit.axis).tolist(),
    }
    return Suggestion(parts, why, _option(parts), joint)


def _fixed(parts: tuple[str, str], why: str) -> Suggestion:
    return Suggestion(parts, why, _option(parts), {"parts": list(parts), "kind": "fixed"})


def _option(parts: tuple[str, str]) -> str:
    return f"--fasten {shlex.quote(parts[0])} {shlex.quote(parts[1])}"
