"""Pages: one offline file (`report`), or the same page served and kept up to date (`view`)."""

from __future__ import annotations

import math
import shlex
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kilter.cli.gather import gather
from kilter.cli.options import (
    Angle,
    Budget,
    Clearance,
    Density,
    Down,
    Fasten,
    File,
    Floor,
    Friction,
    Gap,
    Ground,
    Loose,
    Quiet,
    Units,
    Without,
)
from kilter.cli.output import Progress, keep_apart, write_whole
from kilter.cli.reading import (
    LOWEST,
    Reading,
    contact_tolerance,
    read_assembly,
    reading_of,
)
from kilter.cli.reading import fasten as join_touching
from kilter.cli.watch import Stamp, fingerprint
from kilter.errors import InputError

if TYPE_CHECKING:
    from kilter.contact import Tolerance
    from kilter.show.serve import PageServer

__all__ = ["report", "view"]

PAUSE = 0.4
"""Between two looks at the file [s]."""
ENDINGS = (".html", ".htm")


@dataclass(frozen=True, slots=True)
class _Job:
    """What to make a page of, and how it is read; `touch`: the options of the tolerance."""

    file: str
    reading: Reading
    tolerance: Tolerance
    touch: tuple[str, ...]
    budget: float
    quiet: bool

    def page(self, command: str, *rest: str, live: bool = False) -> tuple[str, str]:
        """The page, and the verdict."""
        from kilter.show.page import render

        with Progress(self.quiet) as progress:
            progress("reading")
            assembly = read_assembly(self.file, self.reading)
            assembly, contacts = join_touching(assembly, self.reading, self.tolerance, progress)
            answers = gather(
                assembly,
                contacts=contacts,
                tolerance=self.tolerance,
                budget=self.budget,
                command=shlex.join(["kilter", command, self.file, *self.words(), *rest]),
                progress=progress,
            )
            progress("page")
            text = render(answers, self.title, live=live)
        return text, str(answers.given.check["verdict"])

    @property
    def title(self) -> str:
        """The name of the file, without its folders and endings."""
        if self.file == "-":
            return "standard input"
        name = Path(self.file).resolve().name
        return name.removesuffix(".json").removesuffix(".kilter")

    def words(self) -> list[str]:
        """The options, as they are typed."""
        found: list[str] = []
        for key, value in self.reading.options().items():
            if key == "floor":
                found += ["--floor"] if value == LOWEST else ["--floor", str(value)]
            elif key == "down":
                found += ["--down", *(f"{v:.17g}" for v in value)]
            elif key == "fasten":
                found += [word for pair in value for word in ("--fasten", *pair)]
            elif isinstance(value, list):
                found += [word for one in value for word in (f"--{key}", str(one))]
            else:
                found += [f"--{key}", f"{value:g}" if isinstance(value, float) else str(value)]
        return [*found, *self.touch]


def _job(
    file: str,
    reading: Reading,
    touch: tuple[float | None, float | None, float | None, bool],
    budget: float,
    quiet: bool,
) -> _Job:
    if not (math.isfinite(budget) and budget >= 0):
        raise InputError(f"--budget is {budget}", hint="give seconds, 0 or more")
    gap, angle, clearance, loose = touch
    words = [
        word
        for name, value in (("gap", gap), ("angle", angle), ("clearance", clearance))
        if value is not None
        for word in (f"--{name}", f"{value:g}")
    ]
    words += ["--loose"] if loose else []
    tolerance = contact_tolerance(gap, angle, loose, clearance)
    return _Job(file, reading, tolerance, tuple(words), budget, quiet)


def report(
    file: File,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT.html", help="The page to write.", show_default=False
        ),
    ] = None,
    ground: Ground = None,
    floor: Floor = None,
    without: Without = None,
    down: Down = None,
    friction: Friction = None,
    units: Units = None,
    density: Density = None,
    fasten: Fasten = None,
    gap: Gap = None,
    angle: Angle = None,
    clearance: Clearance = None,
    loose: Loose = False,
    budget: Budget = 5.0,
    quiet: Quiet = False,
) -> int:
    """One offline page: the assembly in space, its motion and forces, and the gravity ball.

    The page asks for nothing: it can be mailed, kept, and opened without a network. Exit 0 when
    written, whatever the verdict.

    Drawn in full up to some thousand parts; the ball is coloured up to 40 free parts.
    """
    if output is None:
        raise InputError("no page is named", hint="add -o out.html")
    # no input ends so: a slip cannot write over one
    if output.suffix.lower() not in ENDINGS:
        raise InputError("is no name of a page", file=str(output), hint="end it in .html")
    keep_apart(file, output)
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    job = _job(file, reading, (gap, angle, clearance, loose), budget, quiet)
    text, verdict = job.page("report", "-o", str(output))
    write_whole(output, text)
    if not quiet:
        size = len(text.encode("utf-8")) / 1e6
        print(f"{output}: {verdict}; {size:.2f} MB, one file, no network", file=sys.stderr)
    return 0


def view(
    file: File,
    port: Annotated[
        int,
        typer.Option("--port", metavar="N", help="Port on this machine; a free one by default."),
    ] = 0,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only serve; open no browser.")
    ] = False,
    ground: Ground = None,
    floor: Floor = None,
    without: Without = None,
    down: Down = None,
    friction: Friction = None,
    units: Units = None,
    density: Density = None,
    fasten: Fasten = None,
    gap: Gap = None,
    angle: Angle = None,
    clearance: Clearance = None,
    loose: Loose = False,
    budget: Budget = 5.0,
    quiet: Quiet = False,
) -> int:
    """The page of an assembly in the browser, made anew whenever the file changes.

    Served to this machine only. Ends with Ctrl-C.
    """
    from kilter.show.serve import PageServer

    if file == "-":
        raise InputError("standard input cannot be watched", hint="give a file or a folder")
    if not 0 <= port < 2**16:
        raise InputError(f"--port is {port}", hint="give a number from 0 to 65535")
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    job = _job(file, reading, (gap, angle, clearance, loose), budget, quiet)
    seen = fingerprint(file)
    first, verdict = job.page("view", live=True)
    with PageServer(first, port) as server:
        print(f"{server.url}  ({verdict}; Ctrl-C ends it)", flush=True)
        if not no_browser:
            import webbrowser

            webbrowser.open(server.url)
        try:
            while True:
                time.sleep(PAUSE)
                seen = _kept(server, job, seen)
        except KeyboardInterrupt:
            return 0


def _kept(server: PageServer, job: _Job, seen: tuple[Stamp, ...]) -> tuple[Stamp, ...]:
    """Serve the file anew if it has changed; a moment later, since it may be half written."""
    from kilter.show.page import error_page

    if fingerprint(job.file) == seen:
        return seen
    time.sleep(PAUSE / 2)
    now = fingerprint(job.file)
    try:
        text, verdict = job.page("view", live=True)
    except InputError as error:
        text, verdict = error_page(error.for_command, job.title), f"not judged: {error.for_command}"
    server.publish(text)
    if not job.quiet:
        print(f"kilter: changed: {verdict}", file=sys.stderr, flush=True)
    return now
