"""The command about orders of assembly: plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kilter.cli.arguments import pair_of
from kilter.cli.asked import Asked
from kilter.cli.exit_codes import HOLDS, INTERRUPTED, LOWER, PLAN
from kilter.cli.options import Require, asks
from kilter.cli.order_files import as_typed, written
from kilter.cli.output import Progress
from kilter.errors import InputError
from kilter.files.sequence import read_sequence

__all__ = ["plan"]

ORDER = "What an order may be"


@asks(searches=True, proves=True)
def plan(
    asked: Asked,
    hold: Annotated[
        int | None,
        typer.Option(
            "--hold",
            metavar="K",
            help="Most parts held at once, beside the one that moves; the fewest up to 2 where "
            "not given.",
            rich_help_panel=ORDER,
            show_default=False,
        ),
    ] = None,
    directions: Annotated[
        list[str] | None,
        typer.Option(
            "--directions",
            metavar="axes|normals|X,Y,Z",
            help="Along which parts move, in the order in which they are tried; repeatable. Axes "
            "and normals of contacts where not given.",
            rich_help_panel=ORDER,
            show_default=False,
        ),
    ] = None,
    before: Annotated[
        list[str] | None,
        typer.Option(
            "--before",
            metavar="A B",
            help="A is put in before B; repeatable, * and ? are globs.",
            rich_help_panel=ORDER,
            show_default=False,
        ),
    ] = None,
    never_hold: Annotated[
        list[str] | None,
        typer.Option(
            "--never-hold",
            metavar="NAME",
            help="This part must not be held; repeatable, * and ? are globs.",
            rich_help_panel=ORDER,
            show_default=False,
        ),
    ] = None,
    screws: Annotated[
        list[str] | None,
        typer.Option(
            "--screws",
            metavar="BOLT NUT",
            help="A bolt stays while its nut is on, and the nut comes off along its axis; "
            "repeatable, * and ? are globs.",
            rich_help_panel=ORDER,
            show_default=False,
        ),
    ] = None,
    group: Annotated[
        list[str] | None,
        typer.Option(
            "--group",
            metavar="PATTERN",
            help="The parts that match move as one; repeatable, * and ? are globs.",
            rich_help_panel=ORDER,
            show_default=False,
        ),
    ] = None,
    together: Annotated[
        bool,
        typer.Option(
            "--together",
            help="Parts that stop one another may move as one where none leaves alone.",
            rich_help_panel=ORDER,
        ),
    ] = False,
    fewest: Annotated[
        str,
        typer.Option(
            "--fewest",
            metavar="WHAT",
            help="What there is to be least of: holds (parts held at once), held-steps "
            "or turns (implies --turn).",
            rich_help_panel=ORDER,
        ),
    ] = "holds",
    sequence: Annotated[
        Path | None,
        typer.Option(
            "--sequence",
            metavar="FILE",
            help="Judge this order: a name a line, .csv with a column part, or .json.",
            rich_help_panel=ORDER,
            show_default=False,
        ),
    ] = None,
    press: Annotated[
        float,
        typer.Option(
            "--press",
            metavar="N",
            help="Each part, in place, is pressed along its way with this force [N], and held by "
            "what stands.",
            rich_help_panel=ORDER,
        ),
    ] = 0.0,
    turn: Annotated[
        bool,
        typer.Option(
            "--turn",
            help="What stands may be turned between two steps, the base and all.",
            rich_help_panel=ORDER,
        ),
    ] = False,
    require: Require = "equilibrium",
) -> int:
    """In which order can it be put together, part by part, and what must be held at each step?

    What is grounded is there from the start. Every step is proved: forces hold what stands while
    the next part comes in, along a straight way, or one of two pieces, that nothing stops. With
    -o FILE.html a page is written that plays the steps, with -o FILE.glb a film for other programs,
    with -o FILE.svg, .png or .pdf a sheet of pictures, with -o FILE.csv a table for a robot.

    Exit 0 found, every step at the level of --require; 1 proved that there is none, or that the
    order of --sequence fails; 3 found, some steps at a lower level; 4 none found, which proves
    nothing.
    """
    from kilter.analysis.planning.order.plan import plan as find

    typed = as_typed(
        hold=hold,
        directions=directions,
        before=before,
        never_hold=never_hold,
        screws=screws,
        group=group,
        together=together,
        fewest=None if fewest == "holds" else fewest,
        sequence=sequence,
        press=press or None,
        turn=turn or None,
        require=None if require == "equilibrium" else require,
    )
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        order = find(
            assembly,
            hold=hold,
            directions=[_direction(one) for one in directions or ("axes", "normals")],
            before=[pair_of("--before", words) for words in before or ()],
            never_hold=never_hold or (),
            screws=[pair_of("--screws", words) for words in screws or ()],
            groups=group or (),
            together=together,
            fewest=fewest,
            sequence=None if sequence is None else read_sequence(sequence),
            press=press,
            turn=turn,
            require=require,
            effort=asked.effort,
            time_limit=asked.time_limit,
            contacts=contacts,
            tolerance=asked.tolerance,
            progress=progress,
        )
    answer = order.to_dict()
    proved = order.verdict in ("found", "impossible")
    after = asked.keep_proof(order.proof if proved else None, answer)
    if asked.output is None or not written(order, answer, asked, typed):
        asked.tell(answer, after=after, typed=typed)
    if order.interrupted:
        return INTERRUPTED
    return PLAN[order.verdict] if not order.found else HOLDS if order.holds else LOWER


def _direction(word: str) -> str | list[float]:
    """A direction by name, or as three numbers."""
    if word in ("axes", "normals"):
        return word
    try:
        x, y, z = (float(one) for one in word.split(","))
    except ValueError:
        raise InputError(
            f"--directions has {word!r:.60}", hint="give axes, normals or X,Y,Z"
        ) from None
    return [x, y, z]
