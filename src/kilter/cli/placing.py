"""The command `place`: where the next part stands on an assembly."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.cli.asked import Asked, tell_cut
from kilter.cli.exit_codes import HOLDS, LOWER, PACKING, PLACE
from kilter.cli.options import Json, Output, Quiet, Require, SearchOptions, asks, takes
from kilter.cli.output import (
    Progress,
    as_json,
    emit,
    keep_apart,
    require_answer_file,
    tell_warnings,
    tell_written,
    writes_json,
)
from kilter.cli.planning import as_typed
from kilter.errors import InputError, TimeLimitReached
from kilter.values.declaration import argument, option

if TYPE_CHECKING:
    from kilter.analysis.placing.check_plan import CheckedPlan
    from kilter.assembly import Assembly, Part


# The command `check-plan`: a packing plan, item by item.


@dataclass(frozen=True, kw_only=True)
class CheckPlanOptions(SearchOptions):
    """Options of `check-plan`."""

    plan: str = argument(
        "PLAN",
        "CSV with the header name,length,width,height,mass,x,y,z (corner with the least "
        "coordinates) and optionally turned and max_load (kg), or JSON of BED-BPP.",
    )
    order: str | None = option("--order NAME", "Order of a file with several.")
    units: str | None = option("--units m|cm|mm|in", "Unit of a table without one.")
    friction: float = option("--friction MU", "Friction coefficient of all contacts.", default=0.0)
    pallet: tuple[float, float] | None = option(
        "--pallet LENGTH WIDTH",
        "Base from the origin of x and y; by default it extends beyond the pile.",
    )
    held: Path | None = option(
        "--held FILE",
        "Assembly file of held parts around the pile, such as the walls of a roll container.",
    )
    walls: tuple[float, float] | None = option(
        "--walls LENGTH WIDTH",
        "Inner size of four held walls from the origin of x and y, as tall as the pile: those"
        " of a roll container.",
    )
    transport: bool = option(
        "--transport", "Also compute the accelerations that the finished pile carries."
    )
    require: str = Require()
    json: bool = Json()
    output: Path | None = Output()
    quiet: bool = Quiet()


@takes
def check_plan(options: CheckPlanOptions) -> int:
    """Decide for each item of a packing plan whether the pile stands when it is put down.

    If an item falls, the answer names the reason, and whether walls around the pile would hold it.

    Exit code: 0 the pile stands after each item at the level of --require, 3 at a lower level,
    1 it falls or an item is overloaded, 2 a wrong list, 4 undecided.
    """
    from kilter.tell.text import text_of

    as_data = writes_json(options.json, options.output)
    require_answer_file(options.output)
    keep_apart(options.plan, options.output, None)
    if options.pallet is not None and not min(options.pallet) > 0:
        raise InputError(
            "--pallet is " + " ".join(f"{size:g}" for size in options.pallet),
            hint="give lengths above 0",
        )
    try:
        checked = _decided(options)
    except TimeLimitReached as reached:
        return tell_cut(
            reached, options.time_limit, as_data=as_data, output=options.output, quiet=options.quiet
        )
    answer = checked.to_dict()
    tell_warnings(answer["warnings"], options.quiet or options.json)
    emit(as_json(answer) if as_data else text_of(answer), options.output)
    form = "JSON" if as_data else "text"
    tell_written(options.output, f"answer of check-plan as {form}", options.quiet)
    if checked.first is not None or checked.overload is not None:
        return PACKING["falls"]
    if checked.undecided:
        return PACKING["undecided"]
    return HOLDS if checked.stands else LOWER


def _decided(options: CheckPlanOptions) -> CheckedPlan:
    """The answer about a packing plan."""
    from kilter.analysis.placing.check_plan import check_plan as decide

    with Progress(options.quiet) as progress:
        return decide(
            options.plan,
            order=options.order,
            units=options.units,
            friction=options.friction,
            pallet=options.pallet,
            held=None if options.held is None else _held_parts(options.held),
            walls=options.walls,
            require=options.require,
            carried=options.transport,
            effort=options.effort,
            time_limit=options.time_limit,
            progress=progress,
        )


def _held_parts(path: Path) -> Assembly:
    """The assembly of a file, all of whose parts are held."""
    from kilter.loading import load

    assembly = load(path)
    return assembly.with_grounded(assembly.names)


PUT = "The part that is put down"


@dataclass(frozen=True, kw_only=True)
class PlaceOptions:
    """Options of `place`."""

    box: str | None = option(
        "--box AxBxC",
        "A box of this length, width and height (file units), such as 400x300x250.",
        PUT,
    )
    mass: str | None = option(
        "--mass KG", "Mass of the part, or its least and largest mass, such as 5..8.", PUT
    )
    centre_within: str | None = option(
        "--centre-within SHARE",
        "The part stands with every centre of mass that is this share of its length and width"
        " from the middle, such as 10%.",
        PUT,
    )
    part: Path | None = option("--part FILE", "A file with a single part in place of --box.", PUT)
    turn: list[float] | None = option(
        "--turn DEG",
        "Angle of the box about the vertical. Repeatable: the best of all angles.",
        PUT,
    )
    at: tuple[float, float] | None = option(
        "--at X Y",
        "Does the part stand with its centre at this place? By default all places are mapped.",
        PUT,
    )
    clear: float = option(
        "--clear LENGTH",
        "Distance that the part keeps from parts beside it, for a gripper.",
        PUT,
        default=0.0,
    )
    accuracy: float | None = option(
        "--accuracy LENGTH",
        "Largest width of the strip between places that stand and places that fall.",
        PUT,
    )
    figure: Path | None = option(
        "--figure F", "Also draw the map from above to this file (.svg, .png or .pdf)."
    )
    require: str = Require()


@asks(searches=True, proves=True, writes=(".html", ".htm"))
def place(asked: Asked, options: PlaceOptions) -> int:
    """Find where the next part stands on an assembly, and where it stands best.

    The part is lowered straight down. A map names, for each height, the places at which forces
    prove that everything stands and the places that motions exclude. With --at the answer has the
    verdict there, the parts that would move, and the heaviest mass that is carried.

    With -o FILE.html a page with the map is written, on which the part follows the pointer.

    Exit code: 0 there is a place, or the part stands at the given place at the level of --require;
    3 it stands there at a lower level; 1 there is no place, or it falls there; 4 undecided.
    """
    from kilter import publish
    from kilter.analysis.placing.place import place as find

    page, turns = _is_page(asked, options), options.turn or [0.0]
    masses = None if options.mass is None else _masses(options.mass)
    within = 0.0 if options.centre_within is None else _share(options.centre_within)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answers = [
            find(
                assembly,
                _part_of(options.box, masses, options.part, angle),
                at=options.at,
                mass=masses,
                center_within=within,
                clear=options.clear,
                accuracy=options.accuracy,
                require=options.require,
                **asked.shared(find, contacts, progress),
            )
            for angle in turns
        ]
    best = max(
        answers,
        key=lambda answer: answer.best.margin if answer.best else float(answer.undecided) - 2,
    )
    if options.figure is not None:
        publish.draw(best, options.figure)
    data = best.to_dict()
    after = asked.keep_proof(None if best.undecided else best.proof, data)
    typed = as_typed(options, "box", "mass", "centre_within", "part")
    if len(turns) == 1 and turns[0]:
        typed += ["--turn", f"{turns[0]:g}"]
    after += f"\nfigure       written to {options.figure}" if options.figure else ""
    if page:
        assert asked.output is not None
        publish.report(
            best,
            asked.output,
            title=publish.title_of(asked.file),
            command=asked.command("place", *typed, "-o", str(asked.output)),
        )
        after += f"\npage         written to {asked.output}"
        asked = replace(asked, output=None)
    asked.tell(data, typed=typed, after=after)
    if best.stands:
        return HOLDS
    if best.undecided:
        return PLACE["undecided"]
    return PLACE["none"] if best.level is None else LOWER


def _is_page(asked: Asked, options: PlaceOptions) -> bool:
    """Whether the answer is a page; raises `InputError` for options that contradict each other."""
    from kilter import publish

    if options.at is not None and len(options.turn or ()) > 1:
        raise InputError("--at and several --turn are given", hint="give a single angle with --at")
    if options.part is not None and options.turn:
        raise InputError("--part and --turn are given", hint="turn the part in its file")
    if options.figure is not None:
        publish.require_figure(options.figure, None)
        asked.apart(options.figure)
        if options.at is not None:
            raise InputError("--figure and --at are given", hint="a map has a figure: no --at")
    page = asked.output is not None and asked.output.suffix.lower() in publish.PAGES
    if page and options.at is not None:
        raise InputError("--at and -o FILE.html are given", hint="a page shows a map: no --at")
    return page


def _masses(words: str) -> tuple[float, float]:
    """Least and largest mass from an option such as 6 or 5..8."""
    ends = words.split("..")
    try:
        low, high = (float(ends[0]), float(ends[-1]))
    except ValueError:
        low = high = 0.0
    if len(ends) > 2 or not 0 < low <= high < float("inf"):
        raise InputError(f"--mass is {words!r:.40}", hint="give a mass such as 6, or 5..8")
    return low, high


def _share(words: str) -> float:
    """A share from an option such as 10% or 0.1."""
    text = words.strip()
    try:
        share = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        share = -1.0
    if not 0 <= share < MOST_SHARE:
        raise InputError(
            f"--centre-within is {words!r:.40}", hint="give a share below 50%, such as 10%"
        )
    return share


MOST_SHARE = 0.5
"""Share of a size within which every centre of mass lies inside the part."""


def _part_of(
    box: str | None, mass: tuple[float, float] | None, path: Path | None, turn: float
) -> Part:
    """The part that the options describe.

    Raises `InputError` if not exactly one part is described.
    """
    from kilter.analysis.placing.place import box_to_place
    from kilter.loading import load

    if (box is None) == (path is None):
        raise InputError(
            "the part to put down is not given"
            if box is None
            else "--box and --part are both given",
            hint="give --box AxBxC --mass KG, or --part FILE",
        )
    if path is not None:
        found = load(path)
        if len(found.parts) != 1:
            raise InputError(f"{path} has {len(found.parts)} parts", hint="give a single part")
        return found.parts[0]
    assert box is not None
    lengths = re.fullmatch(r"([0-9.eE+-]+)[xX*]([0-9.eE+-]+)[xX*]([0-9.eE+-]+)", box.strip())
    if lengths is None or mass is None:
        raise InputError(
            f"--box is {box!r:.40}" if lengths is None else "the mass of the box is not given",
            hint="give --box 400x300x250 --mass 6",
        )
    try:
        size = [float(word) for word in lengths.groups()]
    except ValueError:
        raise InputError(f"--box is {box!r:.40}", hint="give --box 400x300x250") from None
    return box_to_place(size, mass[1], turn=turn)
