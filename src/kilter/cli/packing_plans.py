"""The command `check-plan`: a packing plan, item by item."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.cli.asked import tell_cut
from kilter.cli.exit_codes import HOLDS, LOWER, PACKING
from kilter.cli.options import Json, Output, Quiet, Require, SearchOptions, takes
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
from kilter.errors import InputError, TimeLimitReached
from kilter.values.declaration import argument, option

if TYPE_CHECKING:
    from kilter.analysis.placing.check_plan import CheckedPlan
    from kilter.assembly import Assembly

__all__ = ["check_plan"]


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
