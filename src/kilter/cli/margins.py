"""The command about margins: by how much does it hold?"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

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

if TYPE_CHECKING:
    from kilter.analysis.margins.uncertainty import Ranges

__all__ = ["margin"]

ASKED = "Which margins"
UNSURE = "The worst case of tilt and load factor, where data are not exact"


def margin(
    file: File,
    ground: Ground = None,
    floor: Floor = None,
    without: Without = None,
    fasten: Fasten = None,
    down: Down = None,
    friction: Friction = None,
    units: Units = None,
    density: Density = None,
    gap: Gap = None,
    angle: Angle = None,
    loose: Loose = False,
    clearance: Clearance = None,
    push: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            "--push",
            metavar="X Y Z",
            help="The load factor of a body force in this direction, in units of each part's "
            "weight; else that of the given loads.",
            rich_help_panel=ASKED,
            show_default=False,
        ),
    ] = None,
    about: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            "--about",
            metavar="X Y Z",
            help="Also how far gravity may turn about this axis, across gravity.",
            rich_help_panel=ASKED,
            show_default=False,
        ),
    ] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(
            "--part",
            metavar="NAME",
            help="The weakest push of this part; repeatable. All parts where not given, up to 20.",
            rich_help_panel=ASKED,
            show_default=False,
        ),
    ] = None,
    bracket: Annotated[
        bool,
        typer.Option(
            "--bracket",
            help="Also between which load factors the limit lies where sliding does not dilate "
            "(the contact law, not the associative limit).",
            rich_help_panel=ASKED,
        ),
    ] = False,
    mass_range: Annotated[
        tuple[float, float] | None,
        typer.Option(
            "--mass-range",
            metavar="LOW HIGH",
            help="The mass of every free part by itself within these factors, as 0.9 1.1.",
            rich_help_panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    com_range: Annotated[
        float | None,
        typer.Option(
            "--com-range",
            metavar="LENGTH",
            help="Every coordinate of every centre of mass plus or minus this.",
            rich_help_panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    mu_range: Annotated[
        tuple[float, float] | None,
        typer.Option(
            "--mu-range",
            metavar="LOW HIGH",
            help="Every friction coefficient within these factors.",
            rich_help_panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    normal_tilt: Annotated[
        float | None,
        typer.Option(
            "--normal-tilt",
            metavar="DEG",
            help="Every normal tilted by up to this, any way.",
            rich_help_panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    budget: Budget = 1.0,
    json: Json = False,
    output: Output = None,
    quiet: Quiet = False,
) -> int:
    """By how much does it hold: tilt, least friction, load factor, the push each part resists.

    Limits are those of equilibrium forces: above them nothing holds, and the mechanism that
    starts there is named. Exit 0.
    """
    from kilter.analysis.margins.margin import margin as find

    keep_apart(file, output)
    if not (math.isfinite(budget) and budget >= 0):
        raise InputError(f"--budget is {budget}", hint="give seconds, 0 or more")
    ranges = _ranges(mass_range, com_range, mu_range, normal_tilt)
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    with Progress(quiet) as progress:
        progress("reading")
        assembly = read_assembly(file, reading)
        tolerance = contact_tolerance(gap, angle, loose, clearance)
        assembly, contacts = join_touching(assembly, reading, tolerance, progress)
        found = find(
            assembly,
            push=push,
            about=about,
            pushed=part,
            ranges=ranges,
            bracket=bracket,
            contacts=contacts,
            tolerance=tolerance,
            budget=budget,
            progress=progress,
        )
    tell_warnings(found.warnings, quiet or json)
    from kilter.tell.text import text_of

    emit(as_json(found.to_dict()) if json else text_of(found.to_dict()), output)
    return 0


def _ranges(
    mass: tuple[float, float] | None,
    com: float | None,
    mu: tuple[float, float] | None,
    normal_deg: float | None,
) -> Ranges | None:
    """The intervals that were asked about; None where none were."""
    from kilter.analysis.margins.uncertainty import Ranges

    if mass is None and com is None and mu is None and normal_deg is None:
        return None
    return Ranges(
        mass=mass or (1.0, 1.0),
        center=com or 0.0,
        mu=mu or (1.0, 1.0),
        normal_deg=normal_deg or 0.0,
    )
