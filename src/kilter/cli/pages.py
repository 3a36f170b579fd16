"""Commands that make pages and figures: report, view, draw."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import WRITTEN
from kilter.cli.options import asks
from kilter.cli.output import Progress, tell_warnings
from kilter.errors import InputError, visible

__all__ = ["draw", "report", "view"]


class What(StrEnum):
    """Figures that there are."""

    ASSEMBLY = "assembly"
    REGION = "region"


@asks(searches=True, answers=False)
def report(
    asked: Asked,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT.html", help="The page to write.", show_default=False
        ),
    ] = None,
    margins: Annotated[
        bool,
        typer.Option(
            "--margins", help="Margins too where more than 20 parts are free: may take minutes."
        ),
    ] = False,
) -> int:
    """One offline page: the assembly in space, its motion and forces, and the gravity ball.

    The page asks for nothing: it can be mailed, kept, and opened without a network. Exit 0 when
    written, whatever the verdict.

    For up to 50,000 parts; the ball is coloured up to 40 free parts, margins are found up to 20.
    """
    from kilter import publish

    if output is None:
        raise InputError("no page is named", hint="add -o out.html")
    publish.require_ending(output, publish.PAGES, "page")
    asked.apart(output)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        made = publish.report(
            assembly,
            output,
            title=publish.title_of(asked.file),
            contacts=contacts,
            tolerance=asked.tolerance,
            effort=asked.effort,
            time_limit=asked.time_limit,
            margins=margins,
            command=asked.command("report", "-o", str(output), *["--margins"] * margins),
            progress=progress,
        )
    if not asked.quiet:
        size = len(made.html.encode("utf-8")) / 1e6
        print(f"{output}: {made.verdict}; {size:.2f} MB, one file, no network", file=sys.stderr)
    return WRITTEN


@asks(searches=True, answers=False)
def view(
    asked: Asked,
    port: Annotated[
        int,
        typer.Option("--port", metavar="N", help="Port on this machine; a free one by default."),
    ] = 0,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only serve; open no browser.")
    ] = False,
) -> int:
    """The page of an assembly in the browser, made anew whenever the file changes.

    Served to this machine only. Ends with Ctrl-C.
    """
    from kilter import publish

    if asked.file == "-":
        raise InputError("standard input cannot be watched", hint="give a file or a folder")
    if not 0 <= port < 2**16:
        raise InputError(f"--port is {port}", hint="give a number from 0 to 65535")
    with Progress(asked.quiet) as progress:

        def say(line: str) -> None:
            progress.done()
            _say(line, quiet=asked.quiet)

        publish.view(
            asked.file,
            port=port,
            browser=not no_browser,
            read=lambda: asked.read(progress),
            tolerance=asked.tolerance,
            effort=asked.effort,
            time_limit=asked.time_limit,
            command=asked.command("view"),
            say=say,
            progress=progress,
        )
    return WRITTEN


def _say(line: str, *, quiet: bool) -> None:
    """Where the page is, on standard output; what has changed, on the error stream."""
    if line.startswith("http"):
        print(line, flush=True)
    elif not quiet:
        print(f"kilter: {visible(line)}", file=sys.stderr, flush=True)


@asks(searches=True, answers=False)
def draw(
    asked: Asked,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT.svg|png|pdf|glb",
            help="The figure to write; OUT.glb: a film of how parts start to move.",
            show_default=False,
        ),
    ] = None,
    what: Annotated[
        What,
        typer.Option(
            "--what",
            help="The assembly with its motion or forces, or the stable region on the sphere of "
            "directions of gravity.",
        ),
    ] = What.ASSEMBLY,
    view: Annotated[
        tuple[float, float] | None,
        typer.Option(
            "--view",
            metavar="AZIMUTH ELEVATION",
            help="Where the eye is: to the right of -y, above the ground (deg); gravity is down.",
            show_default=False,
        ),
    ] = None,
) -> int:
    """A figure for a document: the assembly with arrows, or its stable region; or a film.

    Figures need kilter[figures]; OUT.glb, an animated GLB for any viewer, needs nothing more.
    Exit 0 when written, whatever the verdict.
    """
    from kilter import publish

    if output is None:
        raise InputError("no figure is named", hint="add -o figure.svg")
    films = output.suffix.lower() in publish.FILMS
    if films:
        publish.require_film(what.value, view)
    else:
        publish.require_figure(output, view)
    asked.apart(output)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        found = publish.answer_to_draw(
            assembly,
            what.value,
            contacts=contacts,
            tolerance=asked.tolerance,
            effort=asked.effort,
            time_limit=asked.time_limit,
            progress=progress,
        )
        progress("film" if films else "figure")
        if films:
            publish.animate(found, output)
        else:
            publish.draw(found, output, view=view)
    answer = found.to_dict()
    tell_warnings(answer["warnings"], asked.quiet)
    if not asked.quiet:
        print(f"{output}: {answer.get('verdict', answer.get('kind'))}", file=sys.stderr)
    return WRITTEN
