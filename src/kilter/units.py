"""Units of length, in metres.

Lengths, areas and volumes keep the unit of the file. Everything else is in SI units. A gravity of
9.81 m/s^2 is therefore ``9.81 / metres_per_unit`` file units per second squared.
"""

from __future__ import annotations

from kilter.errors import InputError

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
"""Length of each unit [m]."""


def metres_per_unit(units: str) -> float:
    """Length of a unit of length such as "mm" [m].

    Raises `InputError` if the unit is not one of m, cm, mm, in.

    Examples
    --------
    >>> metres_per_unit("mm")
    0.001
    """
    try:
        return METRES[units]
    except (KeyError, TypeError):
        raise InputError(
            f"unknown units {units!r}", hint=f"use one of {', '.join(METRES)}"
        ) from None
