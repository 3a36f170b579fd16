"""The commands `orient`, `region` and `margin`: directions of gravity, and limits of loads."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

from kilter.cli.asked import Asked
from kilter.cli.declarations import Argument, Option
from kilter.cli.each import code_of
from kilter.cli.exit_codes import ORIENT, VERDICT, WRITTEN
from kilter.cli.options import FORM, asks
from kilter.cli.order_files import as_typed
from kilter.cli.output import Progress
from kilter.errors import InputError
from kilter.tell.levels import holds
from kilter.work import stop_after

if TYPE_CHECKING:
    from kilter.analysis.margins.uncertainty import Ranges

__all__ = ["margin", "orient", "region"]

ASKED = "Which margins"
UNSURE = "Worst case of tilt and load factor for uncertain data"


class Method(StrEnum):
    """Methods to find the direction of gravity nearest to stable."""

    JOINT = "joint"
    WALK = "walk"


@asks(timed=True)
def orient(
    asked: Asked,
    method: Annotated[
        Method,
        Option(
            "--method",
            help="Algorithm if no direction is stable: 'joint' solves a program for each facet of "
            "the directions, 'walk' is the published search.",
            panel=FORM,
        ),
    ] = Method.JOINT,
) -> int:
    """Find the stable orientation of an assembly with the widest tilt margin.

    With friction: the middle of the directions for which forces that hold it exist. 'kilter check
    --down' reports what friction guarantees there.

    Exit code: 0 found, 1 none exists (the answer is the direction nearest to stable, with the parts
    that move there), 4 undecided.
    """
    from kilter.analysis.turning.orientation import orient as find

    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answer = find(
            assembly,
            contacts=contacts,
            tolerance=asked.tolerance,
            method=method.value,
            time_limit=asked.time_limit,
            progress=progress,
        )
    asked.tell(answer.to_dict())
    return ORIENT[answer.verdict]


@asks(timed=True, proves=True)
def region(
    asked: Asked,
    files: Annotated[
        list[str],
        Argument(metavar="FILE...", help="An assembly; several with --common."),
    ],
    common: Annotated[
        bool,
        Option(
            "--common",
            help="The directions that are stable for all files, so that no reorientation is "
            "needed between them.",
        ),
    ] = False,
    rests: Annotated[
        bool,
        Option(
            "--rests",
            help="Also list the directions at which the energy has a strict minimum, with the "
            "largest tilt and the period of the slowest swing of each. Without friction only.",
        ),
    ] = False,
) -> int:
    """Find every stable direction of gravity of an assembly, with a proof of each boundary.

    With friction: every direction for which forces that hold it exist, bounded by rays inside and
    facets outside. --common ignores friction.
    """
    from kilter.analysis.regions.region import common_region
    from kilter.analysis.regions.region import region as find

    if common and asked.proof is not None:
        raise InputError(
            "--proof is not possible with --common", hint="write the proof of each file by itself"
        )
    if common and rests:
        raise InputError(
            "--rests is not possible with --common", hint="run it for each file by itself"
        )
    if len(files) > 1 and not common:
        raise InputError(
            f"{len(files)} files are given", hint="add --common, or give a single file"
        )
    tolerance = asked.tolerance
    with Progress(asked.quiet) as progress:
        given = [asked.of_file(file).read(progress) for file in files]
        if common:
            assemblies = [assembly for assembly, _ in given]
            with stop_after(asked.time_limit):
                answer = common_region(assemblies, tolerance=tolerance, progress=progress)
        else:
            [(assembly, contacts)] = given
            answer = find(
                assembly,
                contacts=contacts,
                rests=rests,
                tolerance=tolerance,
                time_limit=asked.time_limit,
                progress=progress,
            )
    data, request = answer.to_dict(), asked if common else asked.of_file(files[0])
    request.tell(data, after=request.keep_proof(answer.proof, data))
    return VERDICT["undecided"] if answer.pairs_decide else WRITTEN


@asks(searches=True, proves=True)
def margin(
    asked: Asked,
    push: Annotated[
        tuple[float, float, float] | None,
        Option(
            "--push",
            metavar="X Y Z",
            help="Load factor of a body force in this direction, in units of the weight of each "
            "part; by default the load factor of the given loads.",
            panel=ASKED,
            show_default=False,
        ),
    ] = None,
    about: Annotated[
        tuple[float, float, float] | None,
        Option(
            "--about",
            metavar="X Y Z",
            help="Also compute how far gravity may turn about this horizontal axis, by the "
            "right-hand rule; the opposite axis is the other sense. Only without loads and bonds.",
            panel=ASKED,
            show_default=False,
        ),
    ] = None,
    part: Annotated[
        list[str] | None,
        Option(
            "--part",
            metavar="NAME",
            help="Compute the greatest push that this part resists, and the gain in tilt or load "
            "if it is held. Repeatable; all parts by default if there are at most 20.",
            panel=ASKED,
            show_default=False,
        ),
    ] = None,
    loads: Annotated[
        bool,
        Option(
            "--loads",
            help="Also compute the greatest additional load straight down that each part can "
            "carry; with --part only for those parts.",
            panel=ASKED,
        ),
    ] = False,
    bracket: Annotated[
        bool,
        Option(
            "--bracket",
            help="Also compute bounds of the largest load factor if slipping contacts do not "
            "dilate. The load factor itself is the associative limit, which assumes dilation.",
            panel=ASKED,
        ),
    ] = False,
    require: Annotated[
        str,
        Option(
            "--require",
            metavar="LEVEL",
            help="Level of the limits: equilibrium, settles, proved or strict. Other commands "
            "require settles. Here the default is lower, because only limits of equilibrium have "
            "a proof from both sides; a higher level adds a search.",
            panel=FORM,
        ),
    ] = "equilibrium",
    mass_range: Annotated[
        tuple[float, float] | None,
        Option(
            "--mass-range",
            metavar="LOW HIGH",
            help="Factors between which the mass of every free part varies independently, as "
            "0.9 1.1.",
            panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    com_range: Annotated[
        float | None,
        Option(
            "--com-range",
            metavar="LENGTH",
            help="Largest error of every coordinate of every centre of mass (file units).",
            panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    mu_range: Annotated[
        tuple[float, float] | None,
        Option(
            "--mu-range",
            metavar="LOW HIGH",
            help="Factors between which every friction coefficient varies.",
            panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    normal_tilt: Annotated[
        float | None,
        Option(
            "--normal-tilt",
            metavar="DEG",
            help="Largest tilt of every contact normal, in any direction [deg].",
            panel=UNSURE,
            show_default=False,
        ),
    ] = None,
) -> int:
    """Find the limits up to which an assembly holds: tilt, friction, load factor and pushes.

    Up to each limit forces that hold it exist (level equilibrium). Beyond it no such forces exist,
    and the answer names the parts that start to move. --require settles or proved adds the value of
    each limit up to which that level is reached.

    Exit code, as of check in the given direction of gravity: 0 it holds at the level settles, or
    at that of --require if it is higher; 1 it does not hold, 3 it holds at a lower level only,
    4 undecided.
    """
    from kilter.analysis.margins.margin import margin as find

    ranges = _ranges(mass_range, com_range, mu_range, normal_tilt)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answer = find(
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
    data = answer.to_dict()
    typed = as_typed(
        push=push,
        about=about,
        part=part,
        loads=loads,
        bracket=bracket,
        mass_range=mass_range,
        com_range=com_range,
        mu_range=mu_range,
        normal_tilt=normal_tilt,
        require=None if require == "equilibrium" else require,
    )
    asked.tell(data, after=asked.keep_proof(answer.proof, data), typed=typed)
    verdict = answer.check
    lowest = verdict.require if require == "equilibrium" else require
    reached = holds(verdict.level, lowest)
    return code_of({"verdict": verdict.verdict, "level": verdict.level, "stable": reached})


def _ranges(
    mass: tuple[float, float] | None,
    com: float | None,
    mu: tuple[float, float] | None,
    normal_deg: float | None,
) -> Ranges | None:
    """Intervals of uncertain data from four options; None if no option is given."""
    from kilter.analysis.margins.uncertainty import Ranges

    if mass is None and com is None and mu is None and normal_deg is None:
        return None
    return Ranges(
        mass=mass or (1.0, 1.0),
        center=com or 0.0,
        mu=mu or (1.0, 1.0),
        normal_deg=normal_deg or 0.0,
    )
