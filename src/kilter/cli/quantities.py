"""Quantities as users write them: friction as a share or an angle, density as a material.

--friction 30%  ->  0.3        --friction 17deg  ->  tan 17 deg        --density steel  ->  7850
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError, nearest_name
from kilter.files.reading_options import TOUCH
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.contact import Tolerance
    from kilter.files.own.choices import Choices


def number_of(word: str) -> float | None:
    """The number that a word is; None for other words."""
    try:
        return float(word)
    except ValueError:
        return None


def friction_of(word: str) -> float:
    """Coefficient of friction of a word: a number, a share in percent, or an angle in degrees."""
    number = number_of(word)
    share, angle = number_of(word.removesuffix("%")), number_of(word.removesuffix("deg"))
    if number is not None:
        return number
    if word.endswith("%") and share is not None:
        return share / 100
    if word.endswith("deg") and angle is not None and 0 <= angle < 90:
        return math.tan(math.radians(angle))
    raise InputError(
        f"--friction has {word!r:.40}",
        hint="give a coefficient, a share or an angle below 90 degrees: 0.3, 30% or 17deg",
    )


def density_of(word: str) -> float:
    """Density of a word [kg/m^3]: a number, or the name of a material of the workbench."""
    number = number_of(word)
    if number is not None:
        return number
    # imported late: most command lines name no material
    from kilter.workbench.live_assembly import MATERIALS

    known = {material.name: material.density for material in MATERIALS}
    near = nearest_name(word, known)
    if near is not None and near.casefold() == word.casefold():
        return known[near]
    hint = f"did you mean {near!r}?" if near else f"give kg/m^3, or one of {', '.join(known)}"
    raise InputError(f"{word!r:.40} is neither a density nor a material", hint=hint)


def material_of(words: str) -> dict[str, Any]:
    """The material entry of a value of ``--material``: a name of parts, and density or material.

    Raises `InputError` if the value has no name of parts, or no density.

    Examples
    --------
    >>> material_of("bolt*=steel")
    {'parts': 'bolt*', 'density': 7850, 'name': 'steel'}
    """
    parts, _, value = words.rpartition("=")
    if not parts:
        raise InputError(
            f"--material has {words!r:.60}",
            hint=f'name the parts: --material "*={words:.40}", or --density for all parts',
        )
    density = density_of(value)
    if not (density > 0 and math.isfinite(density)):
        raise InputError(f"--material has {words!r:.60}", hint="give a density above zero")
    name = {} if number_of(value) is not None else {"name": value}
    return {"parts": parts, "density": density, **name}


def named_numbers(option: str, words: str, count: int, example: str) -> tuple[Any, ...]:
    """Split ``NAME=X`` or ``NAME=X,Y,Z`` into the name and its numbers.

    Raises `InputError` if the name or a number is missing; the message names `option`.

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


def moved_supports(
    moves: list[str] | None, turns: list[str] | None
) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """Translations and rotations of supports by name, from the words of both options."""
    moved = [named_numbers("--move", words, 3, "base=0,0,-0.01") for words in moves or ()]
    turned = [named_numbers("--turn-support", words, 4, "base=0,1,0,0.5") for words in turns or ()]
    return {name: way for name, *way in moved}, {name: turn for name, *turn in turned}


def height_of(floor: str) -> float | str:
    """Height of the floor as a number, or the word for the lowest point."""
    from kilter.assembly.question import LOWEST

    height = number_of(floor)
    if height is None and floor != LOWEST:
        raise InputError(
            f"--floor has {floor!r}, which is not a height", hint="give a number or no value"
        )
    return floor if height is None else height


READS: dict[str, Callable[[str], Any]] = {
    "density_of": density_of,
    "friction_of": friction_of,
    "height_of": height_of,
    "load_of": lambda words: named_numbers("--load", words, 3, "lid=0,0,-20"),
    "mass_of": lambda words: named_numbers("--mass", words, 1, '"bolt*=0.2"'),
    "material_of": material_of,
    "number_or_word": lambda word: word if number_of(word) is None else number_of(word),
    "option_name": lambda word: word.replace("-", "_"),
}
"""Functions that convert a word of an option to its value, by the names of declarations."""


# The options of the contact tolerance, and straps of a file.


@dataclass(frozen=True, kw_only=True)
class ToleranceOptions:
    """Values of the tolerance options of a command; None or False for options not given."""

    gap: float | None = option(
        "--gap LENGTH",
        "Largest gap between touching faces (file units); 1e-5 of the size of the smaller "
        "part by default.",
        TOUCH,
    )
    angle: float | None = option(
        "--angle DEG",
        "Largest angle between touching faces [deg]; 0.057 deg (1e-3 rad) by default.",
        TOUCH,
    )
    clearance: float | None = option(
        "--clearance LENGTH",
        "Designed clearance: faces up to this distance apart (file units) count as closed. "
        "Penetrating faces do not.",
        TOUCH,
    )
    loose: bool = option(
        "--loose",
        "For scanned or rounded data: touching faces may have gaps up to 1e-3 of the size of "
        "the smaller part and angles up to 1.15 deg.",
        TOUCH,
    )

    def tolerance(self) -> Tolerance:
        """The contact tolerance for these option values.

        Raises `InputError` if a value is not positive, or the angle [deg] is 45 or more.
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


def straps_of(path: Path) -> dict[str, Any]:
    """Read the file of ``--straps`` as entries of a reading: a JSON list of straps.

    Raises `InputError` if the file cannot be read, or an entry is no strap.
    """
    from kilter.files.complaints import parse_json
    from kilter.files.limits import read_bytes
    from kilter.files.own.saved_entries import valid_entries

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
