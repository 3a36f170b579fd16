"""Convert the words of a command line to reading options and a contact tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.quantities import number_of
from kilter.errors import InputError

if TYPE_CHECKING:
    from kilter.contact import Tolerance
    from kilter.files.choices import Choices
    from kilter.files.reading import Reading

__all__ = ["ToleranceOptions", "named_numbers", "reading_of", "straps_of"]


def reading_of(
    ground: list[str] | None,
    floor: str | None,
    without: list[str] | None,
    down: tuple[float, float, float] | None,
    friction: float | None,
    units: str | None,
    density: float | None,
    fasten: list[tuple[str, str]] | None = None,
    fasten_suggested: bool = False,
    fasten_overlaps: bool = False,
    up: str | None = None,
    contacts: str | None = None,
    keyframe: str | None = None,
    base: str | None = None,
    stud_pull: float | None = None,
    stud_shear: str | None = None,
    brick_sides: str | None = None,
    bond: list[tuple[str, str, float]] | None = None,
    off: list[str] | None = None,
    release: list[str] | None = None,
    mass: list[str] | None = None,
    load: list[str] | None = None,
    accelerate: tuple[str, str, str] | None = None,
) -> Reading:
    """Create the reading options from the values of the options of a command."""
    # imported late: the help needs no reader
    from kilter.files.reading import Reading

    return Reading(
        ground=tuple(ground or ()),
        floor=None if floor is None else _height(floor),
        without=tuple(without or ()),
        down=down,
        friction=friction,
        units=units,
        density=density,
        fasten=tuple(fasten or ()),
        fasten_suggested=fasten_suggested,
        fasten_overlaps=fasten_overlaps,
        up=up,
        contacts=contacts,
        keyframe=keyframe,
        base=base,
        stud_pull=stud_pull,
        stud_shear=_number_or_word(stud_shear),
        brick_sides=brick_sides,
        bond=tuple(map(_bond, bond or ())),
        off=tuple(dict.fromkeys(word.replace("-", "_") for word in off or ())),
        release=tuple(release or ()),
        mass=tuple(named_numbers("--mass", words, 1, '"bolt*=0.2"') for words in mass or ()),
        load=tuple(named_numbers("--load", words, 3, "lid=0,0,-20") for words in load or ()),
        accelerate=accelerate,
    )


def _bond(bond: tuple[str, str, float]) -> tuple[str, str, float]:
    """A value of ``--bond``, whose pull [N] is finite and not negative."""
    if not (math.isfinite(bond[2]) and bond[2] >= 0):
        raise InputError(
            f"--bond has a pull of {bond[2]:g} N", hint="give two names and newtons, 0 or more"
        )
    return bond


def _number_or_word(word: str | None) -> float | str | None:
    """A word as a number, if it is a number; else the word itself."""
    number = None if word is None else number_of(word)
    return word if number is None else number


def _height(floor: str) -> float | str:
    """Height of the floor as a number, or the word for the lowest point."""
    from kilter.files.choices import LOWEST

    try:
        return floor if floor == LOWEST else float(floor)
    except ValueError:
        raise InputError(
            f"--floor has {floor!r}, which is not a height", hint="give a number or no value"
        ) from None


@dataclass(frozen=True, slots=True)
class ToleranceOptions:
    """Values of the tolerance options of a command; None or False for options not given."""

    gap: float | None = None
    angle: float | None = None
    clearance: float | None = None
    loose: bool = False

    def tolerance(self) -> Tolerance:
        """The contact tolerance for these option values.

        Raises
        ------
        InputError
            If a value is not positive, or the angle [deg] is 45 or more.
        """
        from kilter.contact import Tolerance

        base = Tolerance.loose() if self.loose else Tolerance()
        for name, value in (("gap", self.gap), ("clearance", self.clearance)):
            if value is not None and not (math.isfinite(value) and value > 0):
                raise InputError(
                    f"--{name} is {value:g}", hint="give a length above zero, in file units"
                )
        angle = self.angle
        if angle is not None and not (math.isfinite(angle) and 0 < angle < 45):
            raise InputError(f"--angle is {angle:g}", hint="give an angle between 0 and 45 degrees")
        return Tolerance(
            gap=self.gap,
            relative_gap=base.relative_gap,
            angle=base.angle if angle is None else math.radians(angle),
            clearance=self.clearance,
        )

    def words(self) -> list[str]:
        """The tolerance options as words of a command line."""
        words = [
            word
            for name in ("gap", "angle", "clearance")
            if getattr(self, name) is not None
            for word in (f"--{name}", f"{getattr(self, name):.15g}")
        ]
        return [*words, "--loose"] if self.loose else words

    def saved(self) -> dict[str, Any]:
        """The tolerance options as keys of a file of choices."""
        values = {"gap": self.gap, "angle_deg": self.angle, "clearance": self.clearance}
        return {"tolerance": values, "loose": self.loose}

    def over(self, choices: Choices) -> tuple[ToleranceOptions, list[str]]:
        """These options completed by a file of choices, and a sentence for each replaced value."""
        kept = dict(choices.tolerance or {})
        kept["angle"] = kept.pop("angle_deg", None)
        replaced = []
        for name in ("gap", "angle", "clearance"):
            value, old = getattr(self, name), kept.get(name)
            if value is not None and old not in (None, value):
                replaced.append(
                    f"the option {name} {value:.15g} replaces {name} {old:.15g} of the choices"
                )
            kept[name] = old if value is None else value
        return ToleranceOptions(**kept, loose=self.loose or choices.loose), replaced


def named_numbers(option: str, words: str, count: int, example: str) -> tuple[Any, ...]:
    """Split ``NAME=X`` or ``NAME=X,Y,Z`` into the name and its numbers.

    Raises
    ------
    InputError
        If the name or a number is missing; the message names `option`.

    Examples
    --------
    >>> named_numbers("--load", "lid=0,0,-20", 3, "")
    ('lid', 0.0, 0.0, -20.0)
    """
    name, equals, text = words.rpartition("=")
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        numbers = []
    if not (name and equals and len(numbers) == count and all(map(math.isfinite, numbers))):
        raise InputError(f"{option} has {words!r:.60}", hint=f"write {option} {example}")
    return (name, *numbers)


def straps_of(path: Path) -> dict[str, Any]:
    """Read the file of ``--straps`` as entries of a reading: a JSON list of straps.

    Raises
    ------
    InputError
        If the file cannot be read, or an entry is no strap.
    """
    from kilter.files.raw import read_bytes
    from kilter.files.saved_entries import valid_entries
    from kilter.files.strict_json import parse_json

    try:
        data = parse_json(read_bytes(path))
        if not isinstance(data, list) or not data:
            raise InputError(
                "this is no list of straps",
                hint='write [{"path": [["ground", [x, y, z]], ["box", [x, y, z]]], "tension": N}]',
            )
        return valid_entries({"straps": data})
    except InputError as error:
        raise error.located(file=str(path)) from None
