"""From the options of a command to an assembly and a tolerance."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError

if TYPE_CHECKING:
    from kilter.assembly import Assembly
    from kilter.contact import Tolerance

__all__ = ["LOWEST", "Reading", "contact_tolerance", "read_assembly", "reading_of"]

LOWEST = "lowest"
"""Value of --floor without a height."""


@dataclass(frozen=True, slots=True)
class Reading:
    """How a file is read: the options that change what is judged."""

    ground: tuple[str, ...] = ()
    floor: str | None = None
    without: tuple[str, ...] = ()
    down: tuple[float, float, float] | None = None
    friction: float | None = None
    units: str | None = None
    density: float | None = None

    def options(self) -> dict[str, Any]:
        """The options as JSON data, for a proof."""
        return {
            key: list(value) if isinstance(value, tuple) else value
            for key, value in asdict(self).items()
            if value not in (None, ())
        }

    @classmethod
    def from_options(cls, options: Any) -> Reading:
        """The reading that a proof was made with."""
        try:
            values = dict(options)
            for key in ("ground", "without", "down"):
                if key in values:
                    values[key] = tuple(values[key])
            return cls(**values)
        except (TypeError, ValueError):
            raise InputError("the proof's options cannot be read", hint="make it anew") from None


def reading_of(
    ground: list[str] | None,
    floor: str | None,
    without: list[str] | None,
    down: tuple[float, float, float] | None,
    friction: float | None,
    units: str | None,
    density: float | None,
) -> Reading:
    """The reading that the options of a command ask for."""
    return Reading(
        ground=tuple(ground or ()),
        floor=floor,
        without=tuple(without or ()),
        down=down,
        friction=friction,
        units=units,
        density=density,
    )


def read_assembly(file: str, reading: Reading) -> Assembly:
    """The assembly of a file with the options applied.

    Raises
    ------
    InputError
        If the file or an option is wrong.
    """
    from kilter.files import load

    assembly = load(file, units=reading.units, density=reading.density)
    if reading.without:
        assembly = assembly.without(reading.without)
    if reading.friction is not None:
        assembly = assembly.with_friction(reading.friction)
    if reading.down is not None:
        assembly = assembly.with_down(reading.down)
    if reading.ground:
        assembly = assembly.with_grounded(reading.ground)
    if reading.floor is not None:
        assembly = assembly.with_floor(_height(reading.floor))
    return assembly


def _height(floor: str) -> float | None:
    if floor == LOWEST:
        return None
    try:
        return float(floor)
    except ValueError:
        raise InputError(
            f"--floor {floor!r} is no height", hint="give a number or nothing"
        ) from None


def contact_tolerance(gap: float | None, angle: float | None, loose: bool) -> Tolerance:
    """The tolerance of contacts from the options."""
    from kilter.contact import Tolerance

    base = Tolerance.loose() if loose else Tolerance()
    if gap is not None and not (math.isfinite(gap) and gap > 0):
        raise InputError(f"--gap is {gap:g}", hint="give a length above zero, in file units")
    if angle is not None and not (math.isfinite(angle) and 0 < angle < 45):
        raise InputError(f"--angle is {angle:g}", hint="give degrees between 0 and 45")
    return Tolerance(
        gap=gap,
        relative_gap=base.relative_gap,
        angle=base.angle if angle is None else math.radians(angle),
    )
