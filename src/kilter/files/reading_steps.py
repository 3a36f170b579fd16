"""Steps of a reading that need no names: the source of the contacts, and default densities."""

from __future__ import annotations

import dataclasses
from typing import Any

from kilter.assembly import Assembly, Part
from kilter.errors import InputError

__all__ = ["with_contacts_of", "with_density"]


def with_contacts_of(assembly: Assembly, source: str | None, *, floor: bool) -> Assembly:
    """Copy with only its given contacts ("file"), or without them ("geometry").

    Without given contacts, kilter detects the contacts.

    Parameters
    ----------
    assembly : Assembly
    source : {"file", "geometry"} or None
        Source of the contacts; None changes nothing.
    floor : bool
        Whether a floor will be added, which has no contacts in the file.

    Raises
    ------
    InputError
        If only contacts of the file count, and it lists none, or none with the floor.
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
        return dataclasses.replace(part, density=density)

    try:
        return dataclasses.replace(assembly, parts=[with_default(part) for part in assembly.parts])
    except InputError as error:
        raise InputError(error.what, hint=error.hint) from None
