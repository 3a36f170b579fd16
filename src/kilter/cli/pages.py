"""The commands `report`, `view` and `draw`: pages and figures."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from kilter.cli.asked import Asked
from kilter.cli.declarations import Option
from kilter.cli.exit_codes import WRITTEN
from kilter.cli.options import asks
from kilter.cli.output import Progress, tell_warnings
from kilter.errors import InputError, visible

__all__ = ["draw", "report", "view"]


class What(StrEnum):
    """Kinds of figures that the command `draw` makes."""

    ASSEMBLY = "assembly"
    REGION = "region"


@asks(searches=True, answers=False)
def report(
    asked: Asked,
    output: Annotated[
        Path | None,
        Option("-o", "--output", metavar="OUT.html", help="Page to write.", show_default=False),
    ] = None,
    margins: Annotated[
        bool,
        Option(
            "--margins",
            help="Compute margins for more than 20 free parts, too. This may take minutes.",
        ),
    ] = False,
) -> int:
    """Write an offline page: the assembly in 3D, its motion and forces, and the gravity ball.

    The page is one file that needs no network.

    The page shows up to 50,000 parts. The ball is coloured for up to 40 free parts, and margins are
    computed for up to 20.

    Exit code: 0 when written, whatever the verdict.
    """
    from kilter import publish

    if output is None:
        raise InputError("the name of the page is missing", hint="add -o out.html")
    publish.require_ending(output, publish.PAGES, "page")
    asked.apart(output)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        page = publish.report(
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
        size = len(page.html.encode("utf-8")) / 1e6
        words = f"verdict {page.verdict}; {size:.2f} MB in a file that needs no network"
        print(f"{output}: {words}", file=sys.stderr)
    return WRITTEN


@asks(searches=True, answers=False)
def view(
    asked: Asked,
    port: Annotated[
        int,
        Option("--port", metavar="N", help="Port on this machine; a free port by default."),
    ] = 0,
    no_browser: Annotated[
        bool, Option("--no-browser", help="Serve the page, but open no browser.")
    ] = False,
) -> int:
    """Show the page of an assembly in the browser, and update it whenever the file changes.

    The page is served to this machine only. Ctrl-C ends it.
    """
    from kilter import publish

    if asked.file == "-":
        raise InputError("view cannot watch standard input", hint="give a file or a folder")
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
            read=lambda: asked.of_file(asked.file).read(progress),
            # each reading of choices has its own tolerance
            tolerance=None if asked.source else asked.tolerance,
            effort=asked.effort,
            time_limit=asked.time_limit,
            command=asked.command("view"),
            say=say,
            progress=progress,
        )
    return WRITTEN


def _say(line: str, *, quiet: bool) -> None:
    """Print the address of the served page on standard output, other lines on the error stream."""
    if line.startswith("http"):
        print(line, flush=True)
    elif not quiet:
        print(f"kilter: {visible(line)}", file=sys.stderr, flush=True)


@asks(searches=True, answers=False)
def draw(
    asked: Asked,
    output: Annotated[
        Path | None,
        Option(
            "-o",
            "--output",
            metavar="OUT.svg|png|pdf|glb",
            help="Figure to write. OUT.glb is a film of how parts start to move.",
            show_default=False,
        ),
    ] = None,
    what: Annotated[
        What,
        Option(
            "--what",
            help="assembly: the assembly with its motion or its forces. region: the stable region "
            "on the sphere of directions of gravity.",
        ),
    ] = What.ASSEMBLY,
    view: Annotated[
        tuple[float, float] | None,
        Option(
            "--view",
            metavar="AZIMUTH ELEVATION",
            help="Direction to the eye: azimuth to the right of -y, and elevation above the ground "
            "[deg].",
            show_default=False,
        ),
    ] = None,
) -> int:
    """Draw a figure for a document: the assembly with arrows, its stable region, or a film.

    Figures need kilter[figures]. OUT.glb is an animated GLB for any viewer and needs no extra.

    Exit code: 0 when written, whatever the verdict.
    """
    from kilter import publish

    if output is None:
        raise InputError("the name of the figure is missing", hint="add -o figure.svg")
    films = output.suffix.lower() in publish.FILMS
    if films:
        publish.require_film(what.value, view)
    else:
        publish.require_figure(output, view)
    asked.apart(output)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answer = publish.answer_to_draw(
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
            publish.animate(answer, output)
        else:
            publish.draw(answer, output, view=view)
    data = answer.to_dict()
    tell_warnings(data["warnings"], asked.quiet)
    if not asked.quiet:
        words = f"verdict {data['verdict']}" if "verdict" in data else f"region {data['kind']}"
        print(f"{output}: {words}", file=sys.stderr)
    return WRITTEN
