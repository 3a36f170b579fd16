"""The commands `report`, `view` and `draw`: pages and figures."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Any

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import WRITTEN
from kilter.cli.options import HELP_OF_FILE, Move, TurnSupport, asks
from kilter.cli.output import Progress, tell_warnings, tell_written
from kilter.cli.quantities import moved_supports
from kilter.errors import InputError, visible
from kilter.values.declaration import argument, option


class What(StrEnum):
    """Kinds of figures that the command `draw` makes."""

    ASSEMBLY = "assembly"
    REGION = "region"
    CHANGES = "changes"
    THRUST = "thrust"
    MOVEMENT = "movement"


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """Options of `report`."""

    output: Path | None = option("-o --output OUT.html", "Page to write.")
    margins: bool = option(
        "--margins", "Compute margins for more than 20 free parts, too. This may take minutes."
    )
    move: list[str] | None = Move()
    turn_support: list[str] | None = TurnSupport()


@asks(searches=True, answers=False)
def report(asked: Asked, options: ReportOptions) -> int:
    """Write an offline page: the assembly in 3D, its motion and forces, and the gravity ball.

    The page is one file that needs no network.

    The page shows up to 50,000 parts. The ball is coloured for up to 40 free parts, and margins are
    computed for up to 20.

    Exit code: 0 when written, whatever the verdict.
    """
    from kilter import publish

    if options.output is None:
        raise InputError("the name of the page is missing", hint="add -o out.html")
    publish.require_ending(options.output, publish.PAGES, "page")
    asked.apart(options.output)
    moved, turned = moved_supports(options.move, options.turn_support)
    typed = ["-o", str(options.output), *["--margins"] * options.margins]
    typed += [word for words in options.move or () for word in ("--move", words)]
    typed += [word for words in options.turn_support or () for word in ("--turn-support", words)]
    with Progress(asked.quiet, lines=True) as progress:
        assembly, contacts = asked.read(progress)
        page = publish.report(
            assembly,
            options.output,
            title=publish.title_of(asked.file),
            **asked.shared(publish.report, contacts, progress),
            margins=options.margins,
            moved=moved,
            turned=turned,
            command=asked.command("report", *typed),
        )
    size = len(page.html.encode("utf-8")) / 1e6
    words = f"verdict {page.verdict}; {size:.2f} MB in a file that needs no network"
    tell_written(options.output, words, asked.quiet)
    return WRITTEN


@dataclass(frozen=True, kw_only=True)
class ViewOptions:
    """Options of `view`."""

    file: str | None = argument("[FILE]", HELP_OF_FILE, default=None)
    port: int = option("--port N", "Port on this machine; a free port by default.", default=0)
    no_browser: bool = option("--no-browser", "Serve the page, but open no browser.")
    host: list[str] | None = option(
        "--host NAME",
        "Also answer requests for this host name, for a proxy in front of this machine. "
        "0.0.0.0 listens on all addresses, for a container. Repeatable.",
    )
    folder: Path | None = option(
        "--folder DIR",
        "Opened folder: FILE and the files that it names must be below. By default the folder"
        " of FILE.",
    )


@asks(answers=False)
def view(asked: Asked, options: ViewOptions) -> int:
    """Open the workbench in the browser: hold, join, load and leave out parts by clicks.

    The options are the first choices, which the page changes and saves as X.kilter.json. Without
    FILE the page lists the files of this folder and the examples.

    The page is served to this machine only, except with --host 0.0.0.0. Ctrl-C ends it; the changes
    are kept beside FILE.
    """
    from kilter.workbench.server import view as open_workbench

    if options.file == "-":
        raise InputError("view cannot watch standard input", hint="give a file or a folder")
    if not 0 <= options.port < 2**16:
        raise InputError(f"--port is {options.port}", hint="give a number from 0 to 65535")

    def say(line: str) -> None:
        _say(line, quiet=asked.quiet)

    path, keys, down = (
        (None, None, None) if options.file is None else _first_choices(asked.of_file(options.file))
    )
    open_workbench(
        path,
        port=options.port,
        browser=not options.no_browser,
        hosts=options.host or (),
        folder=options.folder,
        keys=keys,
        down=down,
        say=say,
    )
    return WRITTEN


def _first_choices(
    asked: Asked,
) -> tuple[Path, dict[str, Any] | None, tuple[float, float, float] | None]:
    """The file to open, and the options as choices; None for the choices of the file itself."""
    path = Path(asked.file)
    if not path.exists():
        raise InputError("no such file", file=str(path), hint="check the path")
    if not (asked.typed.options() or asked.touch.words()):
        return path, None, None
    about = asked.source or path
    from kilter.files.own.choices_writing import choices_about

    options = {key: value for key, value in asked.reading.options().items() if key != "down"}
    choices = choices_about(about, about.parent, options, **asked.all_touch.saved())
    return about, choices.to_dict(), asked.reading.down


def _say(line: str, *, quiet: bool) -> None:
    """Print the address of the served page on standard output, other lines on the error stream."""
    if line.startswith("http"):
        print(line, flush=True)
    elif not quiet:
        print(f"kilter: {visible(line)}", file=sys.stderr, flush=True)


@dataclass(frozen=True, kw_only=True)
class DrawOptions:
    """Options of `draw`."""

    output: Path | None = option(
        "-o --output OUT.svg|png|pdf|glb",
        "Figure to write. OUT.glb is a film of how parts start to move, or of a movement.",
    )
    what: What = option(
        "--what",
        "assembly: the assembly with its motion or its forces. region: the stable region on "
        "the sphere of directions of gravity. changes: arrows of movements that help, and beside "
        "it the assembly with the best change of 'margin --improve'. thrust: the lines of least "
        "and greatest thrust of a chain of parts, such as an arch. movement: the parts after a "
        "movement of supports, magnified, with hinges.",
        default=What.ASSEMBLY,
    )
    move: list[str] | None = Move()
    turn_support: list[str] | None = TurnSupport()
    view: tuple[float, float] | None = option(
        "--view AZIMUTH ELEVATION",
        "Direction to the eye: azimuth to the right of -y, and elevation above the ground [deg].",
    )


@asks(searches=True, answers=False)
def draw(asked: Asked, options: DrawOptions) -> int:
    """Draw a figure for a document: the assembly with arrows, its stable region, or a film.

    Figures need kilter[figures]. OUT.glb is an animated GLB for any viewer and needs no extra.

    Exit code: 0 when written, whatever the verdict.
    """
    from kilter import publish
    from kilter.assembly.question import Question

    if options.output is None:
        raise InputError("the name of the figure is missing", hint="add -o figure.svg")
    films = options.output.suffix.lower() in publish.FILMS
    if films:
        publish.require_film(options.what.value, options.view)
    else:
        publish.require_figure(options.output, options.view)
    asked.apart(options.output)
    moved, turned = moved_supports(options.move, options.turn_support)
    publish.require_movement(options.what.value, moved, turned)
    asked = replace(asked, verb=options.what.value)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        question = Question(**asked.shared(Question, contacts, progress))
        answer = publish.answer_to_draw(assembly, options.what.value, question)
        progress("film" if films else "figure")
        if films:
            publish.animate(answer, options.output, moved=moved, turned=turned)
        else:
            publish.draw(
                answer,
                options.output,
                what=options.what.value,
                view=options.view,
                moved=moved,
                turned=turned,
            )
    data = answer.to_dict()
    tell_warnings(data["warnings"], asked.quiet)
    words = f"verdict {data['verdict']}" if "verdict" in data else f"region {data['kind']}"
    tell_written(options.output, words, asked.quiet)
    return WRITTEN
