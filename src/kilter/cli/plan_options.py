"""Options of the command `plan` about the order of assembly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.cli.options import FORM
from kilter.errors import InputError
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.analysis.planning.order.plan_rules import PlanRules

__all__ = ["PlanOptions"]

ORDER = "Allowed orders"


@dataclass(frozen=True, kw_only=True)
class PlanOptions:
    """Values of the options of `plan` about the order, each with its help text."""

    hold: int | None = option(
        "--hold K",
        "Largest number of parts held at once, besides the moving part; by default the "
        "fewest, up to 2.",
        ORDER,
    )
    directions: list[str] | None = option(
        "--directions axes|normals|X,Y,Z",
        "Directions along which parts move, in the order of their trial. Repeatable; axes and"
        " contact normals by default.",
        ORDER,
    )
    before: list[tuple[str, str]] | None = option(
        "--before A B", "A is inserted before B. Repeatable; * and ? are wildcards.", ORDER
    )
    never_hold: list[str] | None = option(
        "--never-hold NAME", "This part must not be held. Repeatable; * and ? are wildcards.", ORDER
    )
    screws: list[tuple[str, str]] | None = option(
        "--screws BOLT NUT",
        "A bolt stays while its nut is on, and the nut comes off along its axis. Repeatable; "
        "* and ? are wildcards.",
        ORDER,
    )
    group: list[str] | None = option(
        "--group PATTERN",
        "The parts that match move as a single body. Repeatable; * and ? are wildcards.",
        ORDER,
    )
    together: bool = option(
        "--together",
        "Parts that block each other may move as a single body if none can leave alone.",
        ORDER,
    )
    fewest: str = option(
        "--fewest WHAT",
        "Quantity to minimise: holds (parts held at once), held-steps (steps with held parts)"
        " or turns (implies --turn).",
        ORDER,
        default="holds",
    )
    sequence: Path | None = option(
        "--sequence FILE",
        "Check this order without a search: a name in each line, .csv with a column 'part', "
        "or .json.",
        ORDER,
    )
    press: float = option(
        "--press N",
        "Force that presses each part into its place along its path [N]; the standing parts "
        "must withstand it.",
        ORDER,
        default=0.0,
    )
    carried: str | None = option(
        "--carried A|X,Y,Z",
        "The standing parts also carry this acceleration of their carrier between steps: a "
        "size in every horizontal direction, or a vector. In m/s^2, or in g as 0.3g.",
        ORDER,
    )
    turn: bool = option(
        "--turn", "The standing parts may be turned between two steps, with the base.", ORDER
    )
    require: str = option(
        "--require LEVEL",
        "Level at which every step counts as holding: equilibrium, settles, proved or strict."
        " Other commands require settles. Here the default is lower, because a search judges "
        "hundreds of half-built states, and a hand or a robot places each part gently.",
        FORM,
        default="equilibrium",
    )

    def rules(self, gravity: Sequence[float]) -> PlanRules:
        """The options about the order as rules of `kilter.plan`.

        Arguments: `gravity` (3,): gravity of the assembly [m/s^2], for an acceleration in g. Raises
        `InputError` if a direction, a pair of names, an acceleration or the file of the sequence is
        invalid.
        """
        from kilter.analysis.planning.order.plan_rules import MOST_HELD, PlanRules
        from kilter.files.sequence import read_sequence

        return PlanRules(
            hold=MOST_HELD if self.hold is None else self.hold,
            directions=[_direction(word) for word in self.directions or ("axes", "normals")],
            before=self.before or (),
            never_hold=self.never_hold or (),
            screws=self.screws or (),
            groups=self.group or (),
            together=self.together,
            fewest=self.fewest,
            sequence=None if self.sequence is None else read_sequence(self.sequence),
            press=self.press,
            carried=0.0 if self.carried is None else _acceleration(self.carried, gravity),
            turn=self.turn,
        )


def _acceleration(text: str, gravity: Sequence[float]) -> float | list[float]:
    """Parse the value of --carried: a size, or a vector with commas [m/s^2].

    Examples
    --------
    >>> _acceleration("0.5g", (0, 0, -10)), _acceleration("0.1g,-2,0", (0, 0, -10))
    (5.0, [1.0, -2.0, 0.0])
    """
    from kilter.files.reading_steps import acceleration_of

    parts = [acceleration_of("--carried", word) for word in text.split(",")]
    values = [value * (math.hypot(*gravity) if in_g else 1.0) for value, in_g in parts]
    if len(values) not in (1, 3):
        raise InputError(f"--carried has {text!r:.40}", hint="give one number, or X,Y,Z")
    return values[0] if len(values) == 1 else values


def _direction(word: str) -> str | list[float]:
    """Parse the value of a direction: a name, or three numbers.

    Raises `InputError` if the word is neither.
    """
    if word in ("axes", "normals"):
        return word
    try:
        x, y, z = (float(number) for number in word.split(","))
    except ValueError:
        raise InputError(
            f"--directions has {word!r:.60}", hint="give axes, normals or X,Y,Z"
        ) from None
    return [x, y, z]
