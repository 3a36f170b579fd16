"""Numbers as text: every size, force, angle, share and vector that an answer shows."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable

from kilter.errors import short_name

COMPUTED = "computed, not proved"
"""Words beside a number that no proof file contains."""
NO_ANGLE = 1e-9
"""An angle below this is shown as 0, since it comes from rounding [deg]."""
NO_LENGTH = 1e-12
"""A coordinate below this is shown as 0, since it comes from rounding [length unit]."""
NO_SHARE = 1e-9
"""A share below this is shown as 0, since it comes from rounding [-]."""
LONGEST_OF_EQUAL = 400
"""Longest name of several that are equal once they are cut [characters]."""
MASSES = ((1e3, "t"), (1.0, "kg"), (1e-3, "g"), (1e-6, "mg"))
PREFIXES = ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"))


class Name(str):
    """A name from a file; the terminal and the pages escape and shorten it for display."""

    __slots__ = ()


def number(value: float, digits: int = 6) -> str:
    """Return a number with the given count of significant digits, and without a negative zero.

    Examples
    --------
    >>> number(-0.0), number(1 / 3), number(210_000.0)
    ('0', '0.333333', '210000')
    """
    return f"{float(value) + 0.0:.{digits}g}"


def near_zero(value: float) -> float:
    """Return a coordinate, or 0 for one that comes from rounding.

    Examples
    --------
    >>> near_zero(1e-16), near_zero(-0.25)
    (0.0, -0.25)
    """
    return 0.0 if abs(value) < NO_LENGTH else value


def rounded_up(value: float, digits: int = 6) -> str:
    """Return a positive number with its last digit rounded up: a bound that is still sufficient.

    Examples
    --------
    >>> rounded_up(0.363970234), rounded_up(0.25)
    ('0.363971', '0.25')
    """
    text = number(value, digits)
    if float(text) >= value * (1 - NO_SHARE):
        return text
    last = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return number(float(text) + last, digits)


def force(newtons: float) -> str:
    """Return a force [N] with a unit that suits its size.

    Examples
    --------
    >>> force(9.81), force(246_000), force(0.00123)
    ('9.81 N', '246 kN', '1.23 mN')
    """
    for size, unit in PREFIXES:
        if abs(newtons) >= size:
            return f"{newtons / size:.4g} {unit}"
    return f"{float(newtons) + 0.0:.4g} N"


def mass(kilograms: float) -> str:
    """Return a mass [kg] with a unit that suits its size.

    Examples
    --------
    >>> mass(2.0), mass(46930.3), mass(0.0523)
    ('2 kg', '46.93 t', '52.3 g')
    """
    for size, unit in MASSES:
        if kilograms >= size:
            return f"{kilograms / size:.4g} {unit}"
    return f"{float(kilograms) + 0.0:.4g} kg"


def angle(degrees: float) -> str:
    """Return an angle [deg] with its unit; an angle below `NO_ANGLE` is 0.

    Examples
    --------
    >>> angle(45.0), angle(4.8e-15)
    ('45 deg', '0 deg')
    """
    return f"{number(0.0 if abs(degrees) < NO_ANGLE else degrees)} deg"


def percent(share: float) -> str:
    """Return a share [-] in percent; a share below `NO_SHARE` is 0.

    Examples
    --------
    >>> percent(0.5432), percent(1.0), percent(6e-14)
    ('54.3 %', '100 %', '0 %')
    """
    return f"{number(0.0 if abs(share) < NO_SHARE else 100 * share, 3)} %"


def vector(values: Iterable[float], digits: int = 6) -> str:
    """Return a vector in brackets, rounded to the given number of decimals.

    Examples
    --------
    >>> vector([0.5, -0.0, 1])
    '(0.5, 0, 1)'
    """
    return "(" + ", ".join(f"{round(float(v), digits) + 0.0:g}" for v in values) + ")"


def count(many: int, word: str, *, grouped: bool = False) -> str:
    """Return a count with its noun; `grouped` separates thousands by commas.

    Examples
    --------
    >>> count(1, "patch"), count(2, "patch"), count(2000, "pair", grouped=True)
    ('1 patch', '2 patches', '2,000 pairs')
    """
    ending = "es" if word.endswith("ch") else "s"
    figure = f"{many:,}" if grouped else f"{many}"
    return f"{figure} {word}{'' if many == 1 else ending}"


def counts(*, pairs: int, patches: int, points: int) -> str:
    """Return a phrase with the numbers of touching pairs, of patches and of contact points."""
    return f"{count(pairs, 'pair')}, {count(patches, 'patch')}, {count(points, 'point')}"


def plain(name: str, width: int = 40) -> str:
    """Return a name for a table or a sentence: `short_name` with a smaller width.

    Examples
    --------
    >>> plain("bracket-assembly_1/nut-bolt-assembly_2/nut", width=24)
    'bracket...assembly_2/nut'
    """
    return short_name(name, width)


def shortened(names: Iterable[str], width: int = 40) -> dict[str, str]:
    """Map each name to its displayed form: shortened, or longer if two would be equal.

    Examples
    --------
    >>> shortened(["left/bracket/bolt", "right/bracket/bolt", "plate"], width=12)["plate"]
    'plate'
    >>> list(shortened(["l/a-bracket/bolt", "l/b-bracket/bolt"], width=12))
    ['l/a-bracket/bolt', 'l/b-bracket/bolt']
    """
    short = {name: plain(name, width) for name in names}
    often = Counter(short.values())
    return {
        name: shown if often[shown] == 1 else plain(name, LONGEST_OF_EQUAL)
        for name, shown in short.items()
    }
