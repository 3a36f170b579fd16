"""The commands `orient`, `region` and `margin`: directions of gravity, and limits of loads."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.cli.asked import Asked, code_of
from kilter.cli.exit_codes import INTERRUPTED, ORIENT, VERDICT, WRITTEN
from kilter.cli.options import FORM, asks
from kilter.cli.output import Progress
from kilter.cli.planning import as_typed
from kilter.errors import InputError
from kilter.tell.levels import holds
from kilter.values.declaration import argument, option
from kilter.work import stop_after

if TYPE_CHECKING:
    from kilter.analysis.margins.margin_answer import Margin
    from kilter.analysis.margins.uncertainty import Ranges


ASKED = "Which margins"
UNSURE = "Worst case of tilt and load factor for uncertain data"


class Method(StrEnum):
    """Methods to find the direction of gravity nearest to stable."""

    JOINT = "joint"
    WALK = "walk"


@dataclass(frozen=True, kw_only=True)
class OrientOptions:
    """Options of `orient`."""

    method: Method = option(
        "--method",
        "Algorithm if no direction is stable: 'joint' solves a program for each facet of the "
        "directions, 'walk' is the published search.",
        FORM,
        default=Method.JOINT,
    )


@asks()
def orient(asked: Asked, options: OrientOptions) -> int:
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
            method=options.method.value,
            **asked.shared(find, contacts, progress),
        )
    asked.tell(answer.to_dict())
    return ORIENT[answer.verdict]


@dataclass(frozen=True, kw_only=True)
class RegionOptions:
    """Options of `region`."""

    files: list[str] = argument("FILE...", "An assembly; several with --common.")
    common: bool = option(
        "--common",
        "The directions that are stable for all files, so that no reorientation is needed "
        "between them.",
    )
    rests: bool = option(
        "--rests",
        "Also list the directions at which the energy has a strict minimum, with the largest "
        "tilt and the period of the slowest swing of each. Without friction only.",
    )


@asks(proves=True)
def region(asked: Asked, options: RegionOptions) -> int:
    """Find every stable direction of gravity of an assembly, with a proof of each boundary.

    With friction: every direction for which forces that hold it exist, bounded by rays inside and
    facets outside. --common ignores friction.
    """
    from kilter.analysis.regions.region import common_region
    from kilter.analysis.regions.region import region as find

    if options.common and asked.proof is not None:
        raise InputError(
            "--proof is not possible with --common", hint="write the proof of each file by itself"
        )
    if options.common and options.rests:
        raise InputError(
            "--rests is not possible with --common", hint="run it for each file by itself"
        )
    if len(options.files) > 1 and not options.common:
        raise InputError(
            f"{len(options.files)} files are given", hint="add --common, or give a single file"
        )
    with Progress(asked.quiet) as progress:
        given = [asked.of_file(file).read(progress) for file in options.files]
        if options.common:
            assemblies = [assembly for assembly, _ in given]
            with stop_after(asked.time_limit):
                shared = asked.shared(common_region, None, progress)
                answer = common_region(assemblies, **shared)
        else:
            [(assembly, contacts)] = given
            answer = find(
                assembly,
                rests=options.rests,
                **asked.shared(find, contacts, progress),
            )
    data, request = answer.to_dict(), asked if options.common else asked.of_file(options.files[0])
    request.tell(data, after=request.keep_proof(answer.proof, data))
    return VERDICT["undecided"] if answer.pairs_decide else WRITTEN


@dataclass(frozen=True, kw_only=True)
class MarginOptions:
    """Options of `margin`."""

    push: tuple[float, float, float] | None = option(
        "--push X Y Z",
        "Load factor of a body force in this direction, in units of the weight of each part; "
        "by default the load factor of the given loads.",
        ASKED,
    )
    about: tuple[float, float, float] | None = option(
        "--about X Y Z",
        "Also compute how far gravity may turn about this horizontal axis, by the right-hand "
        "rule; the opposite axis is the other sense. Only without loads and bonds.",
        ASKED,
    )
    pushes: bool = option(
        "--pushes",
        "Also compute the greatest push that each part resists in its weakest direction; of more "
        "than 50 parts, of those that move most easily.",
        ASKED,
    )
    part: list[str] | None = option(
        "--part NAME",
        "Compute the greatest push that this part resists; with --improve, only named parts are "
        "held in turn. Repeatable.",
        ASKED,
    )
    loads: bool = option(
        "--loads",
        "Also compute the greatest additional load straight down that each part can carry; "
        "with --part only for those parts.",
        ASKED,
    )
    bracket: bool = option(
        "--bracket",
        "Also compute bounds of the largest load factor if slipping contacts do not dilate. "
        "The load factor itself is the associative limit, which assumes dilation.",
        ASKED,
    )
    improve: bool = option(
        "--improve",
        "Also list the changes that raise the tilt margin most, else the load factor, else those "
        "that lower the least friction: a part to move, to widen, to make lighter or heavier, to "
        "hold, more friction. Of a model of toy bricks: a brick to add or to remove, so that its "
        "studs need less strength. Each was tried.",
        ASKED,
    )
    make_stand: bool = option(
        "--make-stand",
        "Also find the least change after which the assembly stands with the tilt margin of "
        "--tilt; the changed assembly is proved to stand.",
        ASKED,
    )
    allow: str = option(
        "--allow KINDS",
        "Changes that --make-stand may make, separated by commas: move (along the contacts), mass, "
        "size (across the contacts), friction.",
        ASKED,
        default="move,mass",
    )
    tilt: float = option(
        "--tilt DEG", "Tilt margin that --make-stand seeks [deg].", ASKED, default=2.0
    )
    require: str = option(
        "--require LEVEL",
        "Level of the limits: equilibrium, settles, proved or strict. Other commands require "
        "settles. Here the default is lower, because only limits of equilibrium have a proof "
        "from both sides; a higher level adds a search.",
        FORM,
        default="equilibrium",
    )
    write: Path | None = option(
        "--write CHANGED.json",
        "Also write the assembly with the best change of --improve, or with all changes of "
        "--make-stand, as a kilter file.",
        FORM,
    )
    mass_range: tuple[float, float] | None = option(
        "--mass-range LOW HIGH",
        "Factors between which the mass of every free part varies independently, as 0.9 1.1.",
        UNSURE,
    )
    com_range: float | None = option(
        "--com-range LENGTH",
        "Largest error of every coordinate of every centre of mass (file units).",
        UNSURE,
    )
    mu_range: tuple[float, float] | None = option(
        "--mu-range LOW HIGH", "Factors between which every friction coefficient varies.", UNSURE
    )
    normal_tilt: float | None = option(
        "--normal-tilt DEG", "Largest tilt of every contact normal, in any direction [deg].", UNSURE
    )


@asks(searches=True, proves=True)
def margin(asked: Asked, options: MarginOptions) -> int:
    """Find the limits up to which an assembly holds: tilt, friction, load factor and pushes.

    Up to each limit forces that hold it exist (level equilibrium). Beyond it no such forces exist,
    and the answer names the parts that start to move. --require settles or proved adds the value of
    each limit up to which that level is reached.

    Exit code, as of check in the given direction of gravity: 0 it holds at the level settles, or
    at that of --require if it is higher; 1 it does not hold, 3 it holds at a lower level only,
    4 undecided.
    """
    from kilter.analysis.margins.margin import margin as find

    if options.write is not None and not (options.improve or options.make_stand):
        raise InputError("--write needs a changed assembly", hint="add --improve or --make-stand")
    asked.apart(options.write)
    ranges = _ranges(options.mass_range, options.com_range, options.mu_range, options.normal_tilt)
    with Progress(asked.quiet, lines=True) as progress:
        assembly, contacts = asked.read(progress)
        answer = find(
            assembly,
            push=options.push,
            about=options.about,
            pushes=options.pushes,
            pushed=options.part,
            loads=options.loads,
            ranges=ranges,
            bracket=options.bracket,
            improve=options.improve,
            make_stand=options.allow.split(",") if options.make_stand else None,
            stand_tilt_deg=options.tilt,
            require=options.require,
            **asked.shared(find, contacts, progress),
        )
    data = answer.to_dict()
    typed = as_typed(options)
    after = asked.keep_proof(answer.proof, data) + _write_changed(answer, options.write)
    asked.tell(data, after=after, typed=typed)
    if "interrupted" in answer.missing.values():
        return INTERRUPTED
    verdict = answer.check
    lowest = verdict.require if options.require == "equilibrium" else options.require
    reached = holds(verdict.level, lowest)
    return code_of({"verdict": verdict.verdict, "level": verdict.level, "stable": reached})


def _write_changed(answer: Margin, path: Path | None) -> str:
    """Write the changed assembly of an answer, and return the line about it; empty without."""
    from kilter.files.writing import dump

    if path is None:
        return ""
    if answer.made_stand is not None and answer.made_stand.stands:
        changed = answer.made_stand.assembly
    elif answer.improvements:
        changed = answer.improvements[0].changed
    else:
        return "\nchanged assembly  not written: no change helps"
    dump(changed, path)
    return f"\nchanged assembly  written to {path}"


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
