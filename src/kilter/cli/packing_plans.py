"""The command `check-plan`: a packing plan, item by item."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from kilter.cli.declarations import Argument, Option
from kilter.cli.exit_codes import HOLDS, LOWER, PACKING
from kilter.cli.options import Json, Output, Quiet, Require
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
from kilter.errors import InputError
from kilter.tell.levels import REQUIRE

if TYPE_CHECKING:
    from kilter.assembly import Assembly

__all__ = ["check_plan"]


def check_plan(
    plan: Annotated[
        str,
        Argument(
            metavar="PLAN",
            help="CSV with the header name,length,width,height,mass,x,y,z (corner with the least "
            "coordinates) and optionally turned and max_load (kg), or JSON of BED-BPP.",
            show_default=False,
        ),
    ],
    order: Annotated[
        str | None,
        Option("--order", metavar="NAME", help="Order of a file with several.", show_default=False),
    ] = None,
    units: Annotated[
        str | None,
        Option(
            "--units", metavar="m|cm|mm|in", help="Unit of a table without one.", show_default=False
        ),
    ] = None,
    friction: Annotated[
        float, Option("--friction", metavar="MU", help="Friction coefficient of all contacts.")
    ] = 0.0,
    pallet: Annotated[
        tuple[float, float] | None,
        Option(
            "--pallet",
            metavar="LENGTH WIDTH",
            help="Base from the origin of x and y; by default it extends beyond the pile.",
            show_default=False,
        ),
    ] = None,
    held: Annotated[
        Path | None,
        Option(
            "--held",
            metavar="FILE",
            help="Assembly file of held parts around the pile, such as the walls of a roll "
            "container.",
            show_default=False,
        ),
    ] = None,
    walls: Annotated[
        tuple[float, float] | None,
        Option(
            "--walls",
            metavar="LENGTH WIDTH",
            help="Inner size of four held walls from the origin of x and y, as tall as the pile: "
            "those of a roll container.",
            show_default=False,
        ),
    ] = None,
    transport: Annotated[
        bool,
        Option(
            "--transport", help="Also compute the accelerations that the finished pile carries."
        ),
    ] = False,
    require: Require = REQUIRE,
    json: Json = False,
    output: Output = None,
    quiet: Quiet = False,
) -> int:
    """Decide for each item of a packing plan whether the pile stands when it is put down.

    If an item falls, the answer names the reason, and whether walls around the pile would hold it.

    Exit code: 0 the pile stands after each item at the level of --require, 3 at a lower level,
    1 it falls or an item is overloaded, 2 a wrong list, 4 undecided.
    """
    from kilter.analysis.placing.check_plan import check_plan as decide
    from kilter.tell.text import text_of

    require_answer_file(output)
    keep_apart(plan, output, None)
    if pallet is not None and not min(pallet) > 0:
        raise InputError(f"--pallet is {pallet[0]:g} {pallet[1]:g}", hint="give lengths above 0")
    with Progress(quiet) as progress:
        checked = decide(
            plan,
            order=order,
            units=units,
            friction=friction,
            pallet=pallet,
            held=None if held is None else _held_parts(held),
            walls=walls,
            require=require,
            carried=transport,
            progress=progress,
        )
    answer = checked.to_dict()
    tell_warnings(answer["warnings"], quiet or json)
    as_data = writes_json(json, output)
    emit(as_json(answer) if as_data else text_of(answer), output)
    tell_written(output, f"answer of check-plan as {'JSON' if as_data else 'text'}", quiet)
    if checked.first is not None or checked.overload is not None:
        return PACKING["falls"]
    if checked.undecided:
        return PACKING["undecided"]
    return HOLDS if checked.stands else LOWER


def _held_parts(path: Path) -> Assembly:
    """The assembly of a file, all of whose parts are held."""
    from kilter.files import load

    assembly = load(path)
    return assembly.with_grounded(assembly.names)
