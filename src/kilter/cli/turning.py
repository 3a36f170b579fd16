"""Commands about turning: which way up it stays, and every way that it does."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from kilter.cli.options import (
    Angle,
    Clearance,
    Density,
    Down,
    Fasten,
    File,
    Floor,
    Friction,
    Gap,
    Ground,
    Json,
    Loose,
    Output,
    Quiet,
    Units,
    Without,
)
from kilter.cli.output import Progress, as_json, emit, keep_apart, tell_warnings
from kilter.cli.reading import contact_tolerance, read_assembly, reading_of
from kilter.cli.reading import fasten as join_touching
from kilter.errors import InputError

__all__ = ["orient", "region"]


class Method(StrEnum):
    """Ways to the nearest direction."""

    JOINT = "joint"
    WALK = "walk"


def orient(
    file: File,
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
    method: Annotated[
        Method,
        typer.Option(
            "--method",
            help="For the nearest direction: joint programs, or the walk of the paper.",
            rich_help_panel="Form of the answer",
        ),
    ] = Method.JOINT,
    json: Json = False,
    output: Output = None,
    quiet: Quiet = False,
) -> int:
    """How could it be turned so that it stays: the stable orientation with the widest margin.

    With friction: the middle of the directions for which forces that hold it exist; 'kilter
    check --down' tells what is guaranteed there.

    Exit 0 found, 1 none exists (then the nearest to stable, and what moves there), 4 undecided.
    """
    from kilter.analysis.turning.orientation import orient as find

    keep_apart(file, output)
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    with Progress(quiet) as progress:
        progress("reading")
        assembly = read_assembly(file, reading)
        tolerance = contact_tolerance(gap, angle, loose, clearance)
        assembly, found = join_touching(assembly, reading, tolerance, progress)
        answer = find(
            assembly,
            contacts=found,
            tolerance=tolerance,
            method=method.value,
            progress=progress,
        )
    tell_warnings(answer.warnings, quiet or json)
    from kilter.tell.text import text_of

    emit(as_json(answer.to_dict()) if json else text_of(answer.to_dict()), output)
    return {"found": 0, "none": 1, "undecided": 4}[answer.verdict]


def region(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help="One assembly; several with --common."),
    ],
    common: Annotated[
        bool,
        typer.Option(
            "--common", help="The directions stable for all of the files: no reorientation between."
        ),
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
    json: Json = False,
    output: Output = None,
    quiet: Quiet = False,
) -> int:
    """Every direction of gravity for which it stays: exactly, with a proof for each boundary.

    With friction, those for which forces that hold it exist, between rays inside and facets
    outside; --common leaves friction out.
    """
    from kilter.analysis.regions.region import common_region
    from kilter.analysis.regions.region import region as find

    if len(files) > 1 and not common:
        raise InputError(f"{len(files)} files are given", hint="add --common, or give one")
    for file in files:
        keep_apart(file, output)
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    tolerance = contact_tolerance(gap, angle, loose, clearance)
    with Progress(quiet) as progress:
        progress("reading")
        assemblies = [
            join_touching(read_assembly(file, reading), reading, tolerance, progress)[0]
            for file in files
        ]
        if common:
            answer = common_region(assemblies, tolerance=tolerance, progress=progress)
        else:
            answer = find(assemblies[0], tolerance=tolerance, progress=progress)
    tell_warnings(answer.warnings, quiet or json)
    from kilter.tell.text import text_of

    emit(as_json(answer.to_dict()) if json else text_of(answer.to_dict()), output)
    return 0
