"""Quantities as users write them: friction as a share or an angle, density as a material.

--friction 30%  ->  0.3        --friction 17deg  ->  tan 17 deg        --density steel  ->  7850
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from kilter.errors import InputError, nearest_name

__all__ = ["READS", "density_of", "friction_of", "material_of", "named_numbers", "number_of"]


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
    from kilter.workbench.materials import MATERIALS

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


def height_of(floor: str) -> float | str:
    """Height of the floor as a number, or the word for the lowest point."""
    from kilter.files.choices import LOWEST

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
