"""Figures: the assembly with its motion or forces, or its stable region, as a file."""

from __future__ import annotations

import math
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

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
from kilter.cli.output import Progress, keep_apart, tell_warnings
from kilter.cli.reading import contact_tolerance, read_assembly, reading_of
from kilter.cli.reading import fasten as join_touching
from kilter.errors import InputError

__all__ = ["draw"]


class What(StrEnum):
    """Figures that there are."""

    ASSEMBLY = "assembly"
    REGION = "region"


def draw(
    file: File,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT.svg|png|pdf",
            help="The figure to write.",
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
    budget: Budget = 10.0,
    quiet: Quiet = False,
) -> int:
    """A figure for a document: the assembly with arrows, or its stable region.

    Needs the extra kilter[figures]. Exit 0 when written, whatever the verdict.
    """
    from kilter.files import write_bytes
    from kilter.show.canvas import SUFFIXES, rendered, require

    if output is None:
        raise InputError("no figure is named", hint="add -o figure.svg")
    # no input ends so: a slip cannot write over one
    if output.suffix.lower() not in SUFFIXES:
        kinds = ", ".join(SUFFIXES)
        raise InputError("is no name of a figure", file=str(output), hint=f"end it in {kinds}")
    if view is not None and not all(math.isfinite(v) for v in view):
        raise InputError(f"--view is {view[0]} {view[1]}", hint="give two angles in degrees")
    if not (math.isfinite(budget) and budget >= 0):
        raise InputError(f"--budget is {budget}", hint="give seconds, 0 or more")
    require()
    keep_apart(file, output)
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    tolerance = contact_tolerance(gap, angle, loose, clearance)
    with Progress(quiet) as progress:
        progress("reading")
        assembly = read_assembly(file, reading)
        assembly, contacts = join_touching(assembly, reading, tolerance, progress)
        if what is What.REGION:
            from kilter.analysis.regions.region import region as find
            from kilter.show.figures import draw_region

            region = find(assembly, contacts=contacts, tolerance=tolerance, progress=progress)
            found, warnings = region.kind, region.warnings
            figure = draw_region(region)
        else:
            from kilter.analysis.check import check
            from kilter.show.figures import draw_assembly

            verdict = check(
                assembly,
                contacts=contacts,
                tolerance=tolerance,
                budget=budget,
                progress=progress,
            )
            progress("figure")
            found, warnings = verdict.verdict, verdict.warnings
            figure = draw_assembly(verdict, view=view)
        data = rendered(figure, output.suffix)
    write_bytes(output, data)
    tell_warnings(warnings, quiet)
    if not quiet:
        print(f"{output}: {found}", file=sys.stderr)
    return 0
