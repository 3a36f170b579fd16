"""Options that commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = [
    "Angle",
    "Budget",
    "Clearance",
    "Density",
    "Down",
    "Fasten",
    "File",
    "Floor",
    "Friction",
    "Gap",
    "Ground",
    "Json",
    "Loose",
    "Output",
    "Quiet",
    "Units",
    "Without",
]

HELD = "What is held, and how it lies"
TOUCH = "When faces count as touching"
FORM = "Form of the answer"

File = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help="An assembly: *.kilter.json, a folder of meshes (one part a file), OBJ, STL, 3MF, "
        "GLB, COMPAS JSON; - reads kilter JSON from standard input.",
        show_default=False,
    ),
]
Ground = Annotated[
    list[str] | None,
    typer.Option(
        "--ground",
        metavar="NAME",
        help="Hold this part; repeatable, * and ? are globs.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Floor = Annotated[
    str | None,
    typer.Option(
        "--floor",
        metavar="[HEIGHT]",
        help="Put a table under the lowest point, or at this height (against gravity, file units).",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Without = Annotated[
    list[str] | None,
    typer.Option(
        "--without",
        metavar="NAME",
        help="Leave this part out (the half-built assembly); repeatable, * and ? are globs.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Down = Annotated[
    tuple[float, float, float] | None,
    typer.Option(
        "--down",
        metavar="X Y Z",
        help="Direction of gravity; its size stays that of the file.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Friction = Annotated[
    float | None,
    typer.Option(
        "--friction",
        metavar="MU",
        help="Friction coefficient of contacts that have none of their own.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Units = Annotated[
    str | None,
    typer.Option(
        "--units",
        metavar="m|cm|mm|in",
        help="Unit of length of a file that names none; m where not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Density = Annotated[
    float | None,
    typer.Option(
        "--density",
        metavar="KG/M3",
        help="Density of parts that have none; 1000 where not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Gap = Annotated[
    float | None,
    typer.Option(
        "--gap",
        metavar="LENGTH",
        help="Largest gap, in file units; 1e-5 of the smaller part where not given.",
        rich_help_panel=TOUCH,
        show_default=False,
    ),
]
Angle = Annotated[
    float | None,
    typer.Option(
        "--angle",
        metavar="DEG",
        help="Largest angle between the faces; 0.057 degrees (1e-3 rad) where not given.",
        rich_help_panel=TOUCH,
        show_default=False,
    ),
]
Loose = Annotated[
    bool,
    typer.Option(
        "--loose",
        help="For scanned or rounded data: gaps to 1e-3 of a part, tilts to 1.15 degrees.",
        rich_help_panel=TOUCH,
    ),
]
Budget = Annotated[
    float,
    typer.Option(
        "--budget",
        metavar="SECONDS",
        help="With friction: seconds for the search of a motion and for the proof that there is "
        "none; past it the guarantee is open.",
        rich_help_panel=FORM,
    ),
]
Clearance = Annotated[
    float | None,
    typer.Option(
        "--clearance",
        metavar="LENGTH",
        help="Designed clearance: faces that stand apart by up to this, in file units, count as "
        "closed; faces that penetrate do not.",
        rich_help_panel=TOUCH,
        show_default=False,
    ),
]
Fasten = Annotated[
    list[str] | None,
    typer.Option(
        "--fasten",
        metavar="NAME NAME",
        help="Join these two parts firmly; repeatable. With * and ? every two that match and "
        "touch: --fasten 'bolt*' 'nut*'.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="Answer as JSON, nothing else.", rich_help_panel=FORM)
]
Output = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE",
        help="Write the answer here instead.",
        rich_help_panel=FORM,
        show_default=False,
    ),
]
Quiet = Annotated[
    bool,
    typer.Option(
        "--quiet", help="No progress and no warnings on the error stream.", rich_help_panel=FORM
    ),
]
