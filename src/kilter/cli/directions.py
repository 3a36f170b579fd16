"""Commands about directions and limits: orient, region, margin."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import ORIENT, VERDICT, WRITTEN
from kilter.cli.options import FORM, Require, asks
from kilter.cli.output import Progress
from kilter.errors import InputError

if TYPE_CHECKING:
    from kilter.analysis.margins.uncertainty import Ranges

__all__ = ["margin", "orient", "region"]

ASKED = "Which margins"
UNSURE = "The worst case of tilt and load factor, where data are not exact"


class Method(StrEnum):
    """Ways to the nearest direction."""

    JOINT = "joint"
    WALK = "walk"


@asks()
def orient(
    asked: Asked,
    method: Annotated[
        Method,
        typer.Option(
            "--method",
            help="For the nearest direction: joint programs, or the walk of the paper.",
            rich_help_panel=FORM,
        ),
    ] = Method.JOINT,
) -> int:
    """How could it be turned so that it stays: the stable orientation with the widest margin.

    With friction: the middle of the directions for which forces that hold it exist; 'kilter
    check --down' tells what is guaranteed there.

    Exit 0 found, 1 none exists (then the nearest to stable, and what moves there), 4 undecided.
    """
    from kilter.analysis.turning.orientation import orient as find

    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answer = find(
            assembly,
            contacts=contacts,
            tolerance=asked.tolerance,
            method=method.value,
            progress=progress,
        )
    asked.tell(answer.to_dict())
    return ORIENT[answer.verdict]


@asks(proves=True)
def region(
    asked: Asked,
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
    rests: Annotated[
        bool,
        typer.Option(
            "--rests",
            help="Also which of its directions are strict minima of energy, how far each may be "
            "tilted and how fast it swings; without friction.",
        ),
    ] = False,
) -> int:
    """Every direction of gravity for which it stays: exactly, with a proof for each boundary.

    With friction, those for which forces that hold it exist, between rays inside and facets
    outside; --common leaves friction out.
    """
    from kilter.analysis.regions.region import common_region
    from kilter.analysis.regions.region import region as find

    if common and asked.proof is not None:
        raise InputError(
            "a common region has proofs about several files", hint="ask each by itself for its own"
        )
    if common and rests:
        raise InputError("rests are of one file", hint="ask each by itself")
    if len(files) > 1 and not common:
        raise InputError(f"{len(files)} files are given", hint="add --common, or give one")
    tolerance = asked.tolerance
    with Progress(asked.quiet) as progress:
        given = [asked.of_file(file).read(progress) for file in files]
        if common:
            each = [assembly for assembly, _ in given]
            answer = common_region(each, tolerance=tolerance, progress=progress)
        else:
            [(assembly, contacts)] = given
            answer = find(
                assembly, contacts=contacts, rests=rests, tolerance=tolerance, progress=progress
            )
    told, one = answer.to_dict(), asked if common else asked.of_file(files[0])
    one.tell(told, after=one.keep_proof(answer.proof, told))
    return VERDICT["undecided"] if answer.pairs_decide else WRITTEN


@asks(searches=True, proves=True)
def margin(
    asked: Asked,
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
            help="Also how far gravity may turn about this axis, across it; no loads or bonds.",
            rich_help_panel=ASKED,
            show_default=False,
        ),
    ] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(
            "--part",
            metavar="NAME",
            help="The weakest push of this part, and what holding it adds; repeatable. All parts "
            "where not given, up to 20.",
            rich_help_panel=ASKED,
            show_default=False,
        ),
    ] = None,
    loads: Annotated[
        bool,
        typer.Option(
            "--loads",
            help="Also the load that each part still takes straight down, or each of --part.",
            rich_help_panel=ASKED,
        ),
    ] = False,
    bracket: Annotated[
        bool,
        typer.Option(
            "--bracket",
            help="Also between which load factors the limit lies where sliding does not dilate "
            "(the contact law, not the associative limit).",
            rich_help_panel=ASKED,
        ),
    ] = False,
    require: Require = "equilibrium",
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
) -> int:
    """By how much does it hold: tilt, least friction, load factor, the push each part resists.

    Limits are those of equilibrium forces: above them nothing holds, and the mechanism that
    starts there is named. --require settles or proved adds the tilt up to which that level is
    reached. Exit 0, whatever the verdict: it is `verdict` in --json, and check
    exits by it.
    """
    from kilter.analysis.margins.margin import margin as find

    ranges = _ranges(mass_range, com_range, mu_range, normal_tilt)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        found = find(
            assembly,
            push=push,
            about=about,
            pushed=part,
            loads=loads,
            ranges=ranges,
            bracket=bracket,
            require=require,
            contacts=contacts,
            tolerance=asked.tolerance,
            effort=asked.effort,
            time_limit=asked.time_limit,
            progress=progress,
        )
    told = found.to_dict()
    asked.tell(told, after=asked.keep_proof(found.proof, told))
    return WRITTEN


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
