"""The command about changes: improve."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import IMPROVE
from kilter.cli.options import FORM, asks
from kilter.cli.output import Progress

__all__ = ["improve"]


@asks()
def improve(
    asked: Asked,
    write: Annotated[
        Path | None,
        typer.Option(
            "--write",
            metavar="CHANGED.json",
            help="Also write the model with the change that is named, as a kilter file.",
            rich_help_panel=FORM,
            show_default=False,
        ),
    ] = None,
) -> int:
    """Which brick to add or to take away so that a model of bricks stands, or holds more easily.

    Bricks are tried where the fall, or the first motion beyond the strength of the studs, says;
    with each the strength that is needed is found anew.

    Exit 0 it stands, as it is or with the brick that is named; 1 no one brick that was tried is
    enough.
    """
    from kilter.analysis.margins.improve import improve as find
    from kilter.files.writing import dump

    asked.apart(write)
    with Progress(asked.quiet) as progress:
        assembly, _ = asked.read(progress)
        found = find(assembly, progress=progress)
    after = ""
    if write is not None and found.best is not None:
        dump(found.best.assembly, write)
        after = f"\nchanged model  written to {write}"
    elif write is not None:
        after = "\nchanged model  none to write"
    asked.tell(found.to_dict(), after=after)
    return IMPROVE[found.stands]
