"""Accelerations that codes of load securing (such as EN 12195) require, with their sources.

A rule belongs to its publisher, and it contains more than accelerations (test methods, safety
factors, lashing forces). kilter computes rigid statics under these accelerations and never states
that a load complies with a rule.

Sources
-------
en12195
    EN 12195-1:2010, road transport, as reproduced in a training page on the CTU Code,
    https://demo.arcademy.ch/CTU-Code/data/html/en/4/p_4_6.html: 0.8 in the direction of travel, 0.5
    backward and sideways, 0.6 sideways for loads at risk of tipping.
gdv
    German Insurance Association, Cargo loss prevention information, load securing in road traffic,
    https://www.tis-gdv.de/tis_e/ls/ls_im_strassenverkehr/kapitel01.html: 0.8 forward, 0.5
    rearward, 0.5 sideways.
eumos
    EUMOS 40509, acceleration test of palletised goods: a constant horizontal acceleration, 0.5 g
    most often, as described in https://en.wikipedia.org/wiki/Acceleration_test.
vdi2700
    VDI 2700 as reproduced by the manual of a vehicle fitter,
    https://manualslib.mx/manual/147842/Bott-Vario-3.html?page=11: over 3.5 t 0.8 forward, 0.5
    backward, 0.5 sideways; vehicles up to 3.5 t 0.6 sideways. Values for vehicles up to 2 t were
    not found in a source and are left out.

In all of them the vertical acceleration is that of gravity alone, 1.0 g.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, cross
from kilter.assembly import Assembly
from kilter.errors import InputError, nearest_name
from kilter.rigid import unit

__all__ = ["CODES", "CodeCase", "code_accelerations", "code_cases"]


@dataclass(frozen=True, slots=True)
class CodeCase:
    """An acceleration that a code of load securing requires, in multiples of g."""

    name: str
    """Direction in which the load is pressed, as the rule calls it."""
    inertia: tuple[float, float]
    """Direction in which the load is pressed [-]."""
    size: float
    """[g]"""

    def acceleration(self, forward: Array, down: Array, g: float) -> Array:
        """Acceleration of the carrier [m/s^2], shape (3,), opposite to the required inertia force.

        Arguments: `forward`, `down` (3,): unit directions of travel and of gravity, perpendicular
        to each other; `g` [m/s^2].
        """
        left = cross(forward, down)
        pressed = self.inertia[0] * forward + self.inertia[1] * left
        return -self.size * g * pressed


def _road(forward: float, backward: float, sideways: float) -> tuple[CodeCase, ...]:
    """Cases of a code for road transport: braking, starting and both sides."""
    return (
        CodeCase("forward", (1.0, 0.0), forward),
        CodeCase("backward", (-1.0, 0.0), backward),
        CodeCase("left", (0.0, 1.0), sideways),
        CodeCase("right", (0.0, -1.0), sideways),
    )


CODES: dict[str, tuple[CodeCase, ...]] = {
    "en12195": _road(0.8, 0.5, 0.5),
    "en12195:tipping": _road(0.8, 0.5, 0.6),
    "gdv": _road(0.8, 0.5, 0.5),
    "vdi2700:3.5t": _road(0.8, 0.5, 0.5),
    "vdi2700:up-to-3.5t": _road(0.8, 0.5, 0.6),
    "eumos": _road(0.5, 0.5, 0.5),
}
"""Cases of each rule. ``eumos:K`` sets the acceleration of the test to K g."""
FREE = ("eumos",)
"""Rules whose acceleration the user chooses."""


def code_cases(name: str) -> tuple[CodeCase, ...]:
    """Required accelerations of a code, by its name such as "EN 12195-1" or "eumos:0.4".

    Raises `InputError` if the rule does not exist or its acceleration is not a positive number.

    Examples
    --------
    >>> [(case.name, case.size) for case in code_cases("EN 12195-1")][:2]
    [('forward', 0.8), ('backward', 0.5)]
    >>> code_cases("eumos:0.4")[0].size
    0.4
    """
    plain = name.lower().replace(" ", "").replace("en12195-1", "en12195")
    if plain in CODES:
        return CODES[plain]
    head, colon, tail = plain.partition(":")
    if colon and head in FREE:
        try:
            size = float(tail)
        except ValueError:
            size = np.nan
        if not 0.0 < size < np.inf:
            raise InputError(
                f"the acceleration {tail!r} of {head} is not a positive number",
                hint=f"write {head}:0.5 for half of gravity",
            )
        return _road(size, size, size)
    near = nearest_name(plain, CODES)
    hint = f"did you mean {near}?" if near else f"use one of {', '.join(CODES)}"
    raise InputError(f"the rule {name!r:.60} does not exist", hint=hint)


def code_accelerations(
    assembly: Assembly, code: str, forward: ArrayLike
) -> tuple[tuple[str, Array], ...]:
    """Names and accelerations of the carrier [m/s^2] that a code requires for an assembly.

    For a planar assembly only those in its plane.

    Raises `InputError` if the rule does not exist, or the direction of travel is zero or vertical.
    """
    cases = code_cases(code)
    size = float(np.linalg.norm(assembly.gravity))
    ahead = travel_direction(forward, assembly.down)
    return tuple(
        (case.name, case.acceleration(ahead, assembly.down, size))
        for case in cases
        if not (assembly.planar and case.inertia[1] != 0.0)
    )


def travel_direction(forward: object, down: Array) -> Array:
    """The direction of travel as a horizontal unit vector, shape (3,).

    Raises `InputError` if it is zero or vertical.
    """
    vector = unit(forward, "the direction of travel")  # type: ignore[arg-type]
    level = vector - (vector @ down) * down
    if float(np.linalg.norm(level)) < 1e-6:
        raise InputError("the direction of travel is vertical", hint="give a horizontal direction")
    return unit(level)
