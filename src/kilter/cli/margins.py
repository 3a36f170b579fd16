"""The command about margins: by how much does it hold?"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np
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
from kilter.tell.text import LISTED, joint_rows, plain, table, vector

if TYPE_CHECKING:
    from kilter.analysis.margins.margin import Margin
    from kilter.analysis.margins.uncertainty import Ranges

__all__ = ["margin", "margin_text"]

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
    emit(as_json(found.to_dict()) if json else margin_text(found), output)
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


def margin_text(margin: Margin) -> str:
    """The answer of `kilter margin`."""
    rows = [*joint_rows(margin.assembly), ["tilt", _tilt_words(margin)]]
    if margin.about is not None:
        turn, limit = margin.about
        words = f"{np.degrees(turn):.6g} deg" if np.isfinite(turn) else "a full turn is held"
        rows.append(["about axis", words + _moving(margin, None if limit is None else limit)])
    rows.append(["friction", _friction_words(margin)])
    if margin.load_factor is not None:
        rows.append(["load factor", _factor_words(margin)])
    if margin.guaranteed is not None:
        rows.append(["bracket", _bracket_words(margin)])
    rows += _worst_rows(margin)
    rows += [["helps" if k == 0 else "", one.sentence] for k, one in enumerate(margin.helps)]
    lines = [margin.verdict.sentence, "", *table(rows, indent="")]
    if margin.pushes:
        listed = sorted(margin.pushes, key=lambda push: push.force)[:LISTED]
        lines += ["", "Weakest push at the centre of mass:"]
        lines += table(
            [
                [
                    plain(push.part),
                    f"{push.force:.5g} N" if np.isfinite(push.force) else "unlimited",
                    f"along {vector(push.direction, 3)}" if np.isfinite(push.force) else "",
                ]
                for push in listed
            ]
        )
    return "\n".join(lines)


def _bracket_words(margin: Margin) -> str:
    """Where the greatest load factor lies where sliding does not dilate."""
    assert margin.guaranteed is not None
    sure, most = margin.guaranteed[1], None if margin.load_factor is None else margin.load_factor[1]
    if most is None:
        return "no factor is held"
    low = "none" if sure is None else f"{round(sure.value, 12) + 0.0:.6g}"
    high = f"{most.value:.6g}" if np.isfinite(most.value) else "unlimited"
    return f"guaranteed up to {low}, held by forces up to {high}: the limit lies between"


def _worst_rows(margin: Margin) -> list[list[str]]:
    """The worst case over intervals."""
    worst = margin.uncertainty
    if worst is None:
        return []
    exact = worst.kind == "exact"
    if not worst.held:
        words = "some are not held as given" if exact else "not shown that all are held as given"
        rows = [["worst case", words]]
    else:
        words = "all are held as given" if worst.tilt_deg is None else f"{worst.tilt_deg:.6g} deg"
        rows = [["worst case", f"{words} ({'exact' if exact else 'inner: at least that'})"]]
    if worst.load_factor is not None:
        ends = [
            f"{end + 0.0:.6g}" if np.isfinite(end) else "unlimited" for end in worst.load_factor
        ]
        rows.append(["", f"load factor {ends[0]} to {ends[1]}"])
    return rows


def _moving(margin: Margin, limit: object) -> str:
    from kilter.analysis.margins.load_limit import Limit, starting
    from kilter.errors import some

    if not isinstance(limit, Limit) or limit.mechanism is None:
        return ""
    names = [plain(name) for name in starting(margin.program, limit.mechanism)]
    return f"; then {some(names)} start{'s' if len(names) == 1 else ''} to move"


def _tilt_words(margin: Margin) -> str:
    if margin.tilt_deg is None:
        return "none: no direction within a right angle is held, or loads do not turn"
    if margin.tilt is None:
        return (
            f"{margin.tilt_deg:.6g} deg: outside; the nearest held direction is "
            f"{vector(margin.tilt_down)}"
        )
    words = f"{margin.tilt_deg:.6g} deg to the nearest direction that fails"
    lower = float(np.degrees(margin.tilt.lower))
    if margin.tilt_deg - lower > 1e-6 * max(margin.tilt_deg, 1e-12):
        words += f" (at least {lower:.6g})"
    return f"{words}, down = {vector(margin.tilt_down)}{_moving(margin, margin.tilt.limit)}"


def _friction_words(margin: Margin) -> str:
    least = margin.friction
    if least is None:
        return "none is enough"
    if least.value == 0.0:
        return "none is needed" if least.attained else "any above zero holds, by squeeze"
    return f"mu >= {least.value:.6g}, the same at every contact"


def _factor_words(margin: Margin) -> str:
    assert margin.load_factor is not None
    least, greatest = margin.load_factor
    if least is None or greatest is None:
        return "no factor is held"
    ends = [
        f"{end + 0.0:.6g}" if np.isfinite(end) else "unlimited"
        for end in (-least.value, greatest.value)
    ]
    return f"{ends[0]} to {ends[1]}{_moving(margin, greatest)}"
