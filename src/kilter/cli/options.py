"""Options that several commands share, and the decorators of the functions of commands.

``@asks()`` adds the file and the options of its reading. The function itself takes an `Asked` and
a record of its own options. A command without an assembly has ``@takes``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, get_type_hints

from kilter.cli.asked import Asked, tell_cut
from kilter.cli.declarations import Declared, declared_in
from kilter.cli.output import require_answer_file
from kilter.cli.quantities import ToleranceOptions
from kilter.errors import TimeLimitReached
from kilter.files.reading_options import HELD, TOUCH, ReadingOptions
from kilter.tell.levels import REQUIRE
from kilter.values.declaration import argument, option
from kilter.work import EFFORT

__all__ = [
    "FORM", "QUESTION", "TOUCH", "Code", "File", "Files", "Forward", "Json", "Move", "Output",
    "Quiet", "Require", "TurnSupport", "asks", "takes",
]  # fmt: skip

FORM = "Form of the answer"
SUPPORTS = "Supports that move"
WORK = "Limits of work and time"
QUESTION = "Question: an acceleration, a turn, a rule of load securing or a path"
HELP_OF_FILE = (
    "An assembly: STEP (needs kilter[step]), a folder of meshes (a file for each part), OBJ, STL, "
    "3MF, GLB, COMPAS JSON, MJCF, URDF, USD (needs kilter[usd]), bricks (LDraw, StableLego JSON, "
    "BrickGPT text), a packing list (CSV) or *.kilter.json. With -, kilter JSON is read from "
    "standard input."
)

# fields of the records of several commands
File = partial(argument, "FILE", HELP_OF_FILE)
Files = partial(argument, "FILE...", HELP_OF_FILE)
Require = partial(
    option,
    "--require LEVEL",
    "Level at which the assembly counts as holding: equilibrium, settles, proved or strict.",
    FORM,
    default=REQUIRE,
)
Json = partial(option, "--json", "Print only JSON.", FORM)
Output = partial(
    option,
    "-o --output FILE",
    "Write the answer to this file instead of standard output; to x.json as JSON.",
    FORM,
)
Quiet = partial(option, "--quiet", "Print no progress and no warnings on the error stream.", FORM)
Move = partial(
    option,
    "--move NAME=DX,DY,DZ",
    "A held part moves by this small vector [length unit of the file]: how the parts follow, "
    "where they crack. Repeatable.",
    SUPPORTS,
)
TurnSupport = partial(
    option,
    "--turn-support NAME=AX,AY,AZ,DEG",
    "A held part turns about its centre of mass: axis, and angle in degrees. Repeatable.",
    SUPPORTS,
)
Code = partial(
    option,
    "--code NAME",
    "Does the assembly stay in place at the accelerations of this rule of load securing? "
    "en12195, en12195:tipping, gdv, vdi2700:3.5t, vdi2700:up-to-3.5t, eumos, or eumos:K "
    "for K g.",
    QUESTION,
)
Forward = partial(
    option, "--forward X Y Z", "Direction of travel, for --code.", QUESTION, default=(1.0, 0.0, 0.0)
)


@dataclass(frozen=True, kw_only=True)
class FileOption:
    """The assembly of a command."""

    file: str = File()


@dataclass(frozen=True, kw_only=True)
class AddedOptions:
    """Options of reading that add entries of a file."""

    material: tuple[str, ...] = option(
        "--material NAME=KG/M3",
        'Density of parts, in place of density and mass of the file: --material "bolt*=7850" '
        'or "bolt*=steel". Repeatable; * and ? are wildcards.',
        HELD,
        default=(),
        reads="material_of",
    )
    straps: Path | None = option(
        "--straps FILE.json",
        'Add the straps of this file, a JSON list of straps as in an assembly file: [{"path":'
        ' [["ground", [x, y, z]], ["box", [x, y, z]]], "tension": N}].',
        HELD,
    )


@dataclass(frozen=True, kw_only=True)
class TimeOption:
    """The limit of time."""

    time_limit: float | None = option(
        "--time-limit SECONDS",
        "Stop after this time and answer with the proofs found until then; no limit by default.",
        WORK,
    )


@dataclass(frozen=True, kw_only=True)
class SearchOptions(TimeOption):
    """The limits of work and time."""

    effort: float = option(
        "--effort N",
        "With friction: limit of the work for finding a motion or proving that none exists. 0"
        " is quick, 1 is usual, and each further step allows ten times more. Work is counted,"
        " not timed, so every machine gives the same answer.",
        WORK,
        default=EFFORT,
    )


@dataclass(frozen=True, kw_only=True)
class ProofOption:
    """The file of a proof."""

    proof: Path | None = option(
        "--proof P.json",
        "Write the proof to this file; 'kilter verify FILE P.json' recomputes it.",
        FORM,
    )


@dataclass(frozen=True, kw_only=True)
class FormOptions:
    """The form of an answer."""

    verbose: bool = option(
        "-v --verbose",
        "Also print the basis of the answer: masses, contacts, proof, guarantee of friction, "
        "z and kappa, neutral motions, and the time it took.",
        FORM,
    )
    json: bool = option("--json", "Print only JSON.", FORM)
    output: Path | None = option(
        "-o --output FILE",
        "Write the answer to this file instead of standard output; to x.json as JSON.",
        FORM,
    )


@dataclass(frozen=True, kw_only=True)
class QuietOption:
    """The messages of a command."""

    quiet: bool = Quiet()


def asks(
    *,
    searches: bool = False,
    proves: bool = False,
    answers: bool = True,
    writes: tuple[str, ...] = (),
) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Create a decorator that adds the shared options to a command ``act(asked, options)``.

    An option of the command replaces a shared option of the same name. All commands have
    ``--time-limit``.
    """

    def decorate(act: Callable[..., int]) -> Callable[..., int]:
        """Wrap a command so that it has the shared options."""
        record = get_type_hints(act).get("options")
        own = [] if record is None else declared_in(record)
        limits = SearchOptions if searches else TimeOption
        last = [*([ProofOption] if proves else []), *([FormOptions] if answers else [])]
        names = {each.name for each in own}
        named = bool({"file", "files"} & names)

        def shared(*records: type) -> list[Declared]:
            return [each for one in records for each in declared_in(one) if each.name not in names]

        declared = [
            *([] if named else declared_in(FileOption)),
            *(each for each in own if each.required),
            *shared(ReadingOptions, AddedOptions, ToleranceOptions, limits),
            *(each for each in own if not each.required),
            *shared(*last, QuietOption),
        ]

        def command(**given: Any) -> int:
            if answers:
                require_answer_file(given["output"], writes)
            values = {k: v for k, v in given.items() if k not in names}
            asked = Asked.of({**values, "verb": act.__name__})
            options = () if record is None else (record(**{name: given[name] for name in names}),)
            try:
                return act(asked, *options)
            except TimeLimitReached as reached:
                return tell_cut(
                    reached,
                    asked.limit,
                    as_data=asked.writes_json,
                    output=asked.output,
                    quiet=asked.quiet,
                )

        return _named(command, act, declared)

    return decorate


def takes(act: Callable[..., int]) -> Callable[..., int]:
    """Decorate a command without an assembly, ``act(options)``."""
    record = get_type_hints(act)["options"]
    return _named(lambda **given: act(record(**given)), act, declared_in(record))


def _named(
    command: Callable[..., int], act: Callable[..., int], declared: list[Declared]
) -> Callable[..., int]:
    """A command with the name and the help of a function, and with its options."""
    command.__name__, command.__doc__, command.__module__ = (
        act.__name__,
        act.__doc__,
        act.__module__,
    )
    command.declared = declared  # type: ignore[attr-defined]
    return command
