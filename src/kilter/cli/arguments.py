"""Convert the words of a command line to reading options and a contact tolerance."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError

if TYPE_CHECKING:
    from kilter.contact import Tolerance
    from kilter.files.choices import Choices
    from kilter.files.reading import Reading

__all__ = [
    "ToleranceOptions",
    "named_numbers",
    "pair_of",
    "reading_of",
    "straps_of",
    "triple_of",
    "with_floor_value",
    "with_off_names",
    "with_several_names",
    "with_two_names",
]

PAIRS = ("--fasten", "--before", "--screws")
"""Options with two names as their value."""
NAMES = ("--ground", "--without", "--off", "--release")
"""Options with one or more names as their value."""
BOND, OPEN = "--bond", "--open"
"""Options with two names and a third word: a pull [N], or a decision about the pair."""
THIRD = {BOND: (" and newtons", " 0.98"), OPEN: (" and a decision", " joined")}
"""Phrase for the third value of an option, and an example of it."""


def reading_of(
    ground: list[str] | None,
    floor: str | None,
    without: list[str] | None,
    down: tuple[float, float, float] | None,
    friction: float | None,
    units: str | None,
    density: float | None,
    fasten: list[str] | None = None,
    fasten_suggested: bool = False,
    fasten_overlaps: bool = False,
    up: str | None = None,
    contacts: str | None = None,
    keyframe: str | None = None,
    base: str | None = None,
    stud_pull: float | None = None,
    stud_shear: str | None = None,
    brick_sides: str | None = None,
    bond: list[str] | None = None,
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
        fasten=tuple(pair_of("--fasten", words) for words in fasten or ()),
        fasten_suggested=fasten_suggested,
        fasten_overlaps=fasten_overlaps,
        up=up,
        contacts=contacts,
        keyframe=keyframe,
        base=base,
        stud_pull=stud_pull,
        stud_shear=_number_or_word(stud_shear),
        brick_sides=brick_sides,
        bond=tuple(_bond_of(words) for words in bond or ()),
        off=tuple(dict.fromkeys(word.replace("-", "_") for word in off or ())),
        release=tuple(release or ()),
        mass=tuple(named_numbers("--mass", words, 1, '"bolt*=0.2"') for words in mass or ()),
        load=tuple(named_numbers("--load", words, 3, "lid=0,0,-20") for words in load or ()),
        accelerate=accelerate,
    )


def pair_of(option: str, words: str) -> tuple[str, str]:
    """The two names in an option value that `with_two_names` joined.

    Raises
    ------
    InputError
        If the value does not have two names.
    """
    try:
        first, second = json.loads(words)
    except ValueError:
        first = second = None
    if not (isinstance(first, str) and isinstance(second, str)):
        raise InputError(
            f"{option} has {words!r}", hint=f'give two names after it: {option} "bolt*" "nut*"'
        )
    return first, second


def triple_of(option: str, words: str) -> tuple[str, str, str]:
    """Split an option value that was typed as a single word into its three words.

    Raises
    ------
    InputError
        If the value does not have three words.
    """
    try:
        first, second, third = json.loads(words)
    except ValueError:
        raise InputError(
            f"{option} has {words!r}", hint=f"give {option} NAME NAME{THIRD[option][1]}"
        ) from None
    return str(first), str(second), str(third)


def _bond_of(words: str) -> tuple[str, str, float]:
    """The two names and the pull of each point [N] in a `--bond` value that was joined."""
    try:
        first, second, pull = json.loads(words)
        pull = float(pull)
    except (ValueError, TypeError):
        pull = math.nan
    if not (math.isfinite(pull) and pull >= 0 and isinstance(first, str)):
        raise InputError(
            f"{BOND} has {words!r}", hint=f'give two names and newtons: {BOND} "brick*" plate 0.98'
        )
    return first, str(second), pull


def with_two_names(words: list[str]) -> list[str]:
    """Join each ``--fasten A B`` into a single word, since the parser repeats only single words.

    The same holds for every option of `PAIRS`, for ``--bond A B T`` and for ``--open A B WORD``.

    Raises
    ------
    InputError
        If two names, or two names and a pull, do not follow the option.

    Examples
    --------
    >>> with_two_names(["check", "--fasten", "bolt*", "nut", "a.json"])
    ['check', '--fasten=["bolt*", "nut"]', 'a.json']
    """
    result: list[str] = []
    k = 0
    while k < len(words):
        if words[k] == "--":
            return result + words[k:]
        option = words[k]
        if option not in (*PAIRS, *THIRD):
            result.append(words[k])
            k += 1
            continue
        count = 3 if option in THIRD else 2
        given = words[k + 1 : k + 1 + count]
        if len(given) < count or any(word.startswith("--") for word in given):
            also, more = THIRD.get(option, ("", ""))
            raise InputError(
                f"{option} needs two names{also}",
                hint=f'for instance {option} "bolt*" "nut*"{more}',
            )
        result.append(f"{option}={json.dumps(given)}")
        k += 1 + count
    return result


def with_several_names(words: list[str]) -> list[str]:
    """Repeat the options in `NAMES`, such as ``--ground``, before each of their names.

    The names end at the next option, and before a word that exists as a path or ends as a file.

    Examples
    --------
    >>> with_several_names(["check", "a.json", "--ground", "0", "1", "--json"])
    ['check', 'a.json', '--ground=0', '--ground=1', '--json']
    >>> with_several_names(["check", "--without", "nut*", "a.json"])
    ['check', '--without=nut*', 'a.json']
    """
    result: list[str] = []
    option = None
    for k, word in enumerate(words):
        if word == "--":
            return result + words[k:]
        if word in NAMES:
            option = word
            if k + 1 == len(words):
                result.append(word)  # the option parser reports the missing name
        elif option is None:
            result.append(word)
        elif words[k - 1] == option or not (word.startswith("-") or _is_file(word)):
            result.append(f"{option}={word}")
        else:
            option = None
            result.append(word)
    return result


def with_off_names(words: list[str]) -> list[str]:
    """Replace ``--no-floor`` by ``--off=floor``, and so for each option that choices save.

    Examples
    --------
    >>> with_off_names(["check", "--no-fasten-suggested", "--no-browser"])
    ['check', '--off=fasten-suggested', '--no-browser']
    """
    if not any(word.startswith("--no-") for word in words):
        return words  # the table of options is loaded only if it is needed
    from kilter.files.choices_off import OFF

    end = words.index("--") if "--" in words else len(words)
    return [
        f"--off={word[5:]}"
        if word.startswith("--no-") and word[5:].replace("-", "_") in OFF and k < end
        else word
        for k, word in enumerate(words)
    ]


def _is_file(word: str) -> bool:
    """Whether a word exists as a path, or ends like a file that kilter reads."""
    from kilter.files.file_content import ENDINGS

    try:
        return Path(word).suffix.lower() in ENDINGS or Path(word).exists()
    except OSError:  # longer than a path may be
        return False


def with_floor_value(words: list[str]) -> list[str]:
    """Insert the default value after each ``--floor`` without a height.

    Examples
    --------
    >>> with_floor_value(["--floor", "a.stl"]), with_floor_value(["--floor", "-0.5"])
    (['--floor=lowest', 'a.stl'], ['--floor=-0.5'])
    """
    result: list[str] = []
    rest = iter(range(len(words)))
    for k in rest:
        if words[k] == "--":
            return result + words[k:]
        if words[k] != "--floor":
            result.append(words[k])
            continue
        following = words[k + 1] if k + 1 < len(words) else ""
        if _is_number(following) and not Path(following).exists():
            result.append(f"--floor={following}")
            next(rest)
        else:
            result.append(f"--floor={_lowest()}")
    return result


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _number_or_word(word: str | None) -> float | str | None:
    """A word as a number, if it is a number; else the word itself."""
    return float(word) if word is not None and _is_number(word) else word


def _height(floor: str) -> float | str:
    """Height of the floor as a number, or the word for the lowest point."""
    try:
        return floor if floor == _lowest() else float(floor)
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


def _lowest() -> str:
    """The value of `--floor` for a floor under the lowest point."""
    from kilter.files.choices import LOWEST

    return LOWEST


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
