"""Steps of a reading: the source of the contacts, densities, masses, loads and a carrier."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

from kilter.assembly import Assembly, Load, Part
from kilter.assembly.mesh_surface import reweighed
from kilter.errors import InputError


def with_contacts_of(assembly: Assembly, source: str | None, *, floor: bool) -> Assembly:
    """Copy with only its given contacts ("file"), or without them ("geometry").

    Without given contacts, kilter detects the contacts.

    Arguments: `source`: source of the contacts; None changes nothing. Raises `InputError` if only
    contacts of the file count, and it lists none, or none with the floor.
    """
    if source == "geometry":
        return dataclasses.replace(assembly, contacts=(), detect=True)
    if source != "file":
        return assembly
    if not assembly.contacts:
        raise InputError(
            "the file lists no contacts",
            file=assembly.source or None,
            hint="leave contacts='file' out",
            option="leave --contacts file out",
        )
    if floor:
        raise InputError(
            "only the contacts of the file count, and the file lists none with the floor",
            file=assembly.source or None,
            hint="hold parts with ground=[...] in place of the floor",
            option="hold parts with --ground NAME in place of --floor",
        )
    return dataclasses.replace(assembly, detect=False)


def with_density(assembly: Assembly, density: float, *, replaces: bool = False) -> Assembly:
    """The assembly with a density for parts that state neither density nor mass [kg/m^3].

    `replaces`: whether the density also replaces stated densities.
    """

    def with_default(part: Part) -> Any:
        stated = part.density is not None and not replaces
        if stated or part.given_mass is not None:
            return part
        return reweighed(part, density=density)

    try:
        return dataclasses.replace(assembly, parts=[with_default(part) for part in assembly.parts])
    except InputError as error:
        raise InputError(error.what, hint=error.hint) from None


def with_friction(assembly: Assembly, friction: float) -> Assembly:
    """The assembly with another default friction coefficient; a note counts its friction pairs."""
    changed = assembly.with_friction(friction)
    if not (pairs := len(assembly.friction_pairs)):
        return changed
    keep = "1 friction pair keeps its" if pairs == 1 else f"{pairs} friction pairs keep their"
    note = f"the friction {friction:g} is for the other pairs: {keep} own coefficient"
    return dataclasses.replace(changed, notes=[*assembly.notes, note])


def with_masses(assembly: Assembly, masses: Sequence[tuple[str, float]]) -> Assembly:
    """The assembly with given masses [kg] of the parts that match a name or wildcard.

    If several patterns match a part, the last mass counts.

    Raises `InputError` if a pattern matches no part, or a mass is not positive.
    """
    if not masses:
        return assembly
    given = {name: kg for pattern, kg in masses for name in assembly.matching([pattern])}
    parts = [
        reweighed(part, given_mass=given[part.name], density=None) if part.name in given else part
        for part in assembly.parts
    ]
    return dataclasses.replace(assembly, parts=parts)


def with_loads(assembly: Assembly, loads: Sequence[tuple[str, float, float, float]]) -> Assembly:
    """The assembly with further forces [N] at the centres of mass of the named parts.

    Raises `InputError` if a name matches no part.
    """
    if not loads:
        return assembly
    more = [
        Load(name, force=force)
        for pattern, *force in loads
        for name in assembly.matching([pattern])
    ]
    return dataclasses.replace(assembly, loads=[*assembly.loads, *more])


def on_carrier(assembly: Assembly, accelerate: Sequence[str] | None) -> Assembly:
    """The assembly on a carrier with this acceleration: it feels gravity less the acceleration.

    Raises `InputError` if a component is no number, or if no weight remains.
    """
    if accelerate is None:
        return assembly
    size = math.hypot(*assembly.gravity)
    parts = [acceleration_of("--accelerate", text) for text in accelerate]
    felt = [
        float(g) - value * (size if in_g else 1.0)
        for g, (value, in_g) in zip(assembly.gravity, parts, strict=True)
    ]
    if not any(felt):
        raise InputError(
            "the carrier falls freely, so no part has weight", hint="give another acceleration"
        )
    return dataclasses.replace(assembly, gravity=felt)


def acceleration_of(option: str, text: str) -> tuple[float, bool]:
    """Parse a component of an acceleration: its number, and whether its unit is g.

    Raises `InputError` if it is no finite number; the message names `option`.

    Examples
    --------
    >>> acceleration_of("--accelerate", "0.5g"), acceleration_of("--accelerate", "-2")
    ((0.5, True), (-2.0, False))
    """
    in_g = text.endswith("g")
    try:
        value = float(text[:-1] if in_g else text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"{option} has {text!r:.40}",
            hint="give numbers in m/s^2, or in g as 0.5g",
        )
    return value, in_g
