"""Numbers in words: the one way in which a size, a force, an angle or a vector is shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

__all__ = [
    "NO_ANGLE",
    "angle",
    "count",
    "counts",
    "force",
    "mass",
    "number",
    "percent",
    "plain",
    "shortened",
    "vector",
]

NO_ANGLE = 1e-9
"""An angle below this is what rounding leaves of none [deg]."""
NO_SHARE = 1e-9
"""A share below this is what rounding leaves of none [-]."""
MASSES = ((1e3, "t"), (1.0, "kg"), (1e-3, "g"), (1e-6, "mg"))
PREFIXES = ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"))


def number(value: float, digits: int = 6) -> str:
    """A number with so many significant digits; no minus zero.

    Examples
    --------
    >>> number(-0.0), number(1 / 3), number(210_000.0)
    ('0', '0.333333', '210000')
    """
    return f"{float(value) + 0.0:.{digits}g}"


def force(newtons: float) -> str:
    """A force with a unit that suits its size.

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
    """A mass with a unit that suits its size.

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
    """An angle given in degrees; what rounding leaves of none is none.

    Examples
    --------
    >>> angle(45.0), angle(4.8e-15)
    ('45 deg', '0 deg')
    """
    return f"{number(0.0 if abs(degrees) < NO_ANGLE else degrees)} deg"


def percent(share: float) -> str:
    """A share in percent; what rounding leaves of none is none.

    Examples
    --------
    >>> percent(0.5432), percent(1.0), percent(6e-14)
    ('54.3 %', '100 %', '0 %')
    """
    return f"{number(0.0 if abs(share) < NO_SHARE else 100 * share, 3)} %"


def vector(values: Iterable[float], digits: int = 6) -> str:
    """A vector in brackets, rounded to so many decimals.

    Examples
    --------
    >>> vector([0.5, -0.0, 1])
    '(0.5, 0, 1)'
    """
    return "(" + ", ".join(f"{round(float(v), digits) + 0.0:g}" for v in values) + ")"


def count(many: int, word: str) -> str:
    """A number of things.

    Examples
    --------
    >>> count(1, "patch"), count(2, "patch"), count(2, "pair")
    ('1 patch', '2 patches', '2 pairs')
    """
    ending = "es" if word.endswith("ch") else "s"
    return f"{many} {word}{'' if many == 1 else ending}"


def counts(*, pairs: int, patches: int, points: int) -> str:
    """How much touches."""
    return f"{count(pairs, 'pair')}, {count(patches, 'patch')}, {count(points, 'point')}"


def plain(name: str, width: int = 40) -> str:
    """A name within a line: no control characters, and no longer than `width`.

    Examples
    --------
    >>> plain("a\\nb")
    'a?b'
    >>> plain("bracket-assembly_1/nut-bolt-assembly_2/nut", width=24)
    'bracket...assembly_2/nut'
    """
    shown = "".join(c if c.isprintable() else "?" for c in name)
    if len(shown) <= width:
        return shown
    # the end of a path tells more than its middle
    head = (width - 3) // 3
    return f"{shown[:head]}...{shown[head + 3 - width :]}"


def shortened(names: Iterable[str], width: int = 40) -> dict[str, str]:
    """Names as a list shows them: `plain`, but whole where two would look alike.

    Examples
    --------
    >>> shortened(["left/bracket/bolt", "right/bracket/bolt", "plate"], width=12)["plate"]
    'plate'
    >>> list(shortened(["l/a-bracket/bolt", "l/b-bracket/bolt"], width=12))
    ['l/a-bracket/bolt', 'l/b-bracket/bolt']
    """
    short = {name: plain(name, width) for name in names}
    often = Counter(short.values())
    return {name: one if often[one] == 1 else plain(name, len(name)) for name, one in short.items()}
