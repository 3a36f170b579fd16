"""The command `hold`: the fewest supports that hold an assembly."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import HOLD, HOLDS, INTERRUPTED, LOWER
from kilter.cli.options import Code, Forward, Require, asks
from kilter.cli.output import Progress
from kilter.errors import InputError
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.contact.supports import Support

__all__ = ["hold"]

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
    from kilter.analysis.planning.hold.support_candidates import WORDS
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
