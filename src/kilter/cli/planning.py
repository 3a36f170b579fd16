"""The command `plan`: orders of assembly."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import HOLD, HOLDS, INTERRUPTED, LOWER, PLAN
from kilter.cli.options import FORM, Code, Forward, Require, asks
from kilter.cli.output import Progress, tell_warnings, tell_written, write_whole
from kilter.errors import InputError
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.planning.order.plan_rules import PlanRules
    from kilter.contact.supports import Support


# The command `hold`: the fewest supports that hold an assembly.


MAY = "Candidates for supports"


@dataclass(frozen=True, kw_only=True)
class HoldOptions:
    """Options of `hold`."""

    candidates: list[str] | None = option(
        "--candidates grips|props|fingers|FILE.json",
        "Possible supports. grips: every part gripped. props: a prop under every part. "
        "fingers: a finger on every free flat face. FILE.json: a list of supports (kind, "
        "part, point, direction, mu, capacity, on). Repeatable; grips by default.",
        MAY,
    )
    most: int | None = option(
        "--most K", "Largest number of supports in the answer; no limit by default.", MAY
    )
    code: str | None = Code()
    forward: tuple[float, float, float] = Forward()
    require: str = Require()


@asks(searches=True, proves=True)
def hold(asked: Asked, options: HoldOptions) -> int:
    """Find the fewest supports that hold an assembly together, and prove that fewer do not.

    For a half-built assembly, leave out the missing parts with --without. With --straps, the
    candidates are the straps of this file, and the answer is the fewest of them. With --code, the
    same straps must hold the load at every acceleration of the rule.

    Exit code: 0 found at the level of --require, 3 found only at a lower level, 1 proved that not
    even all candidates are enough, 4 undecided.
    """
    from kilter.analysis.planning.hold.hold import hold as find

    straps = None
    if options.code is not None and asked.reading.accelerate is not None:
        raise InputError("--code and --accelerate are given together", hint="give one")
    if asked.straps is not None:
        if options.candidates:
            raise InputError("--straps and --candidates are given together", hint="give one")
        asked, straps = asked.without_straps()
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        fixture = find(
            assembly,
            straps=straps,
            code=options.code,
            forward=options.forward,
            candidates=[
                candidate
                for word in options.candidates or ("grips",)
                for candidate in _candidates(word)
            ],
            most=options.most,
            require=options.require,
            **asked.shared(find, contacts, progress),
        )
    answer: Any = fixture.to_dict()
    proved = fixture.verdict != "undecided"
    after = asked.keep_proof(fixture.proof if proved else None, answer)
    asked.tell(answer, after=after)
    if answer["interrupted"]:
        return INTERRUPTED
    if fixture.verdict == "held":
        return HOLDS if fixture.holds else LOWER
    return HOLD[fixture.verdict]


def _candidates(word: str) -> list[str | Support]:
    """Candidate supports for a word of the option `--candidates`: a keyword, or those in a file."""
    from kilter.analysis.planning.hold.hold import WORDS
    from kilter.contact.supports import Support
    from kilter.files.file_content import read_json

    if word in WORDS:
        return [word]
    if not word.endswith(".json"):
        hint = f"give {', '.join(WORDS)} or a file of supports (.json)"
        raise InputError(f"--candidates has {word!r:.60}", hint=hint)
    data = read_json(Path(word))
    if not isinstance(data, list):
        raise InputError("it is not a list of supports", file=word, hint="give a list")
    try:
        return [Support.from_dict(entry) for entry in data]
    except InputError as error:
        raise error.located(file=word) from None


# Write a plan as a page, a film, a figure or a table, by the suffix of the output file.


def written(order: Order, answer: Mapping[str, Any], asked: Asked, typed: list[str]) -> bool:
    """Write a plan in the format of the output suffix; False if the suffix is no plan format.

    With any other suffix nothing is written: the caller writes text or JSON.

    Parameters
    ----------
    order : Order
    answer : dict
        Data of the plan, with the warnings of the command.
    asked : Asked
        Request with an output file.
    typed : list of str
        Options of the plan, for the command that a page shows.
    """
    from kilter import publish
    from kilter.show.canvas import SUFFIXES

    assert asked.output is not None
    ending = asked.output.suffix.lower()
    if ending == ".csv":
        write_whole(asked.output, order.table())
    elif ending in publish.PAGES:
        publish.report(
            order,
            asked.output,
            title=publish.title_of(asked.file),
            command=asked.command("plan", *typed, "-o", str(asked.output)),
        )
    elif ending in (*publish.FILMS, *SUFFIXES):
        if not order.found or not order.steps:
            replace(asked, output=None).tell(answer)
            return _report(asked, "not written, because the plan has no steps")
        if ending in publish.FILMS:
            publish.animate(order, asked.output)
        else:
            publish.draw(order, asked.output)
    else:
        return False
    tell_warnings(answer["warnings"], asked.quiet)
    return _report(asked, answer["sentence"])


def _report(asked: Asked, words: str) -> bool:
    """Print a line about the output file on the error stream; always returns True."""
    tell_written(asked.output, words, asked.quiet)
    return True


def as_typed(options: Any, *names: str) -> list[str]:
    """Words of a command line for a record of options, or for some of them, without defaults."""
    words: list[str] = []
    for entry in fields(options):
        value = getattr(options, entry.name)
        if (names and entry.name not in names) or value == entry.default:
            continue
        name = entry.metadata["option"].names[-1]
        if value is True:
            words.append(name)
            continue
        for each in value if isinstance(value, list) else [value]:
            values = each if isinstance(each, tuple) else (each,)
            words += [name, *(f"{v:.12g}" if isinstance(v, float) else str(v) for v in values)]
    return words


# Options of the command `plan` about the order of assembly.


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
        from kilter.files.packing.packing_lists import read_sequence

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


@asks(searches=True, proves=True, writes=(".html", ".htm", ".svg", ".png", ".pdf", ".glb"))
def plan(asked: Asked, options: PlanOptions) -> int:
    """Find an order in which an assembly can be put together, and the parts to hold at each step.

    Grounded parts stand from the start. Every step is proved: forces hold the standing parts while
    the next part comes in along a free path of one or two straight pieces.

    With -o FILE.html a page that plays the steps is written, with -o FILE.glb a film for other
    programs, with -o FILE.svg, .png or .pdf a sheet of pictures, with -o FILE.csv a table for a
    robot.

    Exit code: 0 found, with every step at the level of --require; 3 found, with steps at a lower
    level; 1 proved that no order exists, or that the order of --sequence fails; 4 none found, which
    proves nothing.
    """
    from kilter.analysis.planning.order.plan import plan as find

    typed = as_typed(options)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        order = find(
            assembly,
            options.rules(assembly.gravity),
            require=options.require,
            **asked.shared(find, contacts, progress),
        )
    answer = order.to_dict()
    proved = order.verdict in ("found", "impossible")
    after = asked.keep_proof(order.proof if proved else None, answer)
    if asked.output is None or not written(order, answer, asked, typed):
        asked.tell(answer, after=after, typed=typed)
    if order.interrupted:
        return INTERRUPTED
    return PLAN[order.verdict] if not order.found else HOLDS if order.holds else LOWER
