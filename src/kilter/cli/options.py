"""Options that commands share, and the one place where commands get them.

``@asks()`` gives a command the file and the options of how it is read; the command
itself takes an `Asked` and its own options.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from kilter.cli.asked import Asked
from kilter.work import EFFORT

__all__ = ["FORM", "File", "Files", "Json", "Output", "Quiet", "Require", "asks"]

HELD = "What is held, and how it lies"
TOUCH = "When faces count as touching"
FORM = "Form of the answer"
WORK = "How much work"

HELP_OF_FILE = (
    "An assembly: STEP (kilter[step]), a folder of meshes (one part a file), OBJ, STL, 3MF, GLB, "
    "COMPAS JSON, MJCF, URDF, bricks (LDraw, StableLego JSON, BrickGPT text) or *.kilter.json; "
    "- reads kilter JSON from standard input."
)
File = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help=HELP_OF_FILE,
        show_default=False,
    ),
]
Files = Annotated[
    list[str],
    typer.Argument(metavar="FILE...", help=HELP_OF_FILE, show_default=False),
]
Ground = Annotated[
    list[str] | None,
    typer.Option(
        "--ground",
        metavar="NAME",
        help="Hold this part; repeatable, * and ? are globs.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Floor = Annotated[
    str | None,
    typer.Option(
        "--floor",
        metavar="[HEIGHT]",
        help="Put a table under the lowest point, or at this height (against gravity, file units).",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Without = Annotated[
    list[str] | None,
    typer.Option(
        "--without",
        metavar="NAME",
        help="Leave this part out (the half-built assembly); repeatable, * and ? are globs.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Down = Annotated[
    tuple[float, float, float] | None,
    typer.Option(
        "--down",
        metavar="X Y Z",
        help="Direction of gravity; its size stays that of the file.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Up = Annotated[
    str | None,
    typer.Option(
        "--up",
        metavar="x|y|z|-x|-y|-z",
        help="The axis of the file that points up, for files that are not made with z up.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Contacts = Annotated[
    str | None,
    typer.Option(
        "--contacts",
        metavar="file|geometry",
        help="Take the contacts that the file carries (interfaces of COMPAS) and no others, or "
        "detect all of them.",
        rich_help_panel=TOUCH,
        show_default=False,
    ),
]
Keyframe = Annotated[
    str | None,
    typer.Option(
        "--keyframe",
        metavar="NAME",
        help="Of MJCF: the pose of this keyframe; of the first one where not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Base = Annotated[
    str | None,
    typer.Option(
        "--base",
        metavar="fixed|floating",
        help="Of URDF: whether the root is held; fixed where not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
StudPull = Annotated[
    float | None,
    typer.Option(
        "--stud-pull",
        metavar="N",
        help="Of bricks: what each of the three or four points of a stud holds; .98 N where not "
        "given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
StudShear = Annotated[
    str | None,
    typer.Option(
        "--stud-shear",
        metavar="unlimited|mu|N",
        help="Of bricks: sideways at such a point any force, friction, or up to N; unlimited where "
        "not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
BrickSides = Annotated[
    str | None,
    typer.Option(
        "--brick-sides",
        metavar="lower-edge|face|none",
        help="Of bricks: where neighbours in a layer push each other; lower-edge where not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Friction = Annotated[
    float | None,
    typer.Option(
        "--friction",
        metavar="MU",
        help="Friction coefficient of contacts that have none of their own.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Units = Annotated[
    str | None,
    typer.Option(
        "--units",
        metavar="m|cm|mm|in",
        help="Unit of length of a file that names none; m where not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Density = Annotated[
    float | None,
    typer.Option(
        "--density",
        metavar="KG/M3",
        help="Density of parts that have none; 1000 where not given.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Gap = Annotated[
    float | None,
    typer.Option(
        "--gap",
        metavar="LENGTH",
        help="Largest gap, in file units; 1e-5 of the smaller part where not given.",
        rich_help_panel=TOUCH,
        show_default=False,
    ),
]
Angle = Annotated[
    float | None,
    typer.Option(
        "--angle",
        metavar="DEG",
        help="Largest angle between the faces; 0.057 degrees (1e-3 rad) where not given.",
        rich_help_panel=TOUCH,
        show_default=False,
    ),
]
Loose = Annotated[
    bool,
    typer.Option(
        "--loose",
        help="For scanned or rounded data: gaps to 1e-3 of a part, tilts to 1.15 degrees.",
        rich_help_panel=TOUCH,
    ),
]
Effort = Annotated[
    float,
    typer.Option(
        "--effort",
        metavar="N",
        help="With friction: how much work the search of a motion and the proof that there is "
        "none may take, counted and not timed: 0 quick, 1 usual, each further one ten times more.",
        rich_help_panel=WORK,
    ),
]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        "--time-limit",
        metavar="SECONDS",
        help="Answer with what is proved after so many seconds, and say so; none where not given.",
        rich_help_panel=WORK,
        show_default=False,
    ),
]
Clearance = Annotated[
    float | None,
    typer.Option(
        "--clearance",
        metavar="LENGTH",
        help="Designed clearance: faces that stand apart by up to this, in file units, count as "
        "closed; faces that penetrate do not.",
        rich_help_panel=TOUCH,
        show_default=False,
    ),
]
Fasten = Annotated[
    list[str] | None,
    typer.Option(
        "--fasten",
        metavar="NAME NAME",
        help="Join these two parts firmly; repeatable. With * and ? every two that match and "
        'touch, held ones only by their full name: --fasten "bolt*" "nut*".',
        rich_help_panel=HELD,
        show_default=False,
    ),
]
FastenSuggested = Annotated[
    bool,
    typer.Option(
        "--fasten-suggested",
        help="Join what looks fastened, and name it: screws in threads, press fits, inserts, and "
        "what else overlaps.",
        rich_help_panel=HELD,
    ),
]
FastenOverlaps = Annotated[
    bool,
    typer.Option(
        "--fasten-overlaps",
        help="Join every two parts that overlap, and name them.",
        rich_help_panel=HELD,
    ),
]
Bonded = Annotated[
    list[str] | None,
    typer.Option(
        "--bond",
        metavar="NAME NAME T",
        help="Bond these two parts: each contact point of theirs also pulls, up to T newtons, and "
        "bears any shear; repeatable, * and ? as in --fasten.",
        rich_help_panel=HELD,
        show_default=False,
    ),
]
Require = Annotated[
    str,
    typer.Option(
        "--require",
        metavar="LEVEL",
        help="The level at which it counts as holding: equilibrium, settles, proved or strict.",
        rich_help_panel=FORM,
    ),
]
Proof = Annotated[
    Path | None,
    typer.Option(
        "--proof",
        metavar="P.json",
        help="Write the proof here; 'kilter verify FILE P.json' rechecks it.",
        rich_help_panel=FORM,
        show_default=False,
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="Answer as JSON, nothing else.", rich_help_panel=FORM)
]
Output = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE",
        help="Write the answer here instead.",
        rich_help_panel=FORM,
        show_default=False,
    ),
]
Verbose = Annotated[
    bool,
    typer.Option(
        "-v",
        "--verbose",
        help="Also what the answer rests on: masses, contacts, proof, what friction guarantees, "
        "z and kappa, neutral motions, how long it took.",
        rich_help_panel=FORM,
    ),
]
Quiet = Annotated[
    bool,
    typer.Option(
        "--quiet", help="No progress and no warnings on the error stream.", rich_help_panel=FORM
    ),
]
READING: dict[str, tuple[Any, Any]] = {
    "ground": (Ground, None),
    "floor": (Floor, None),
    "without": (Without, None),
    "down": (Down, None),
    "up": (Up, None),
    "friction": (Friction, None),
    "units": (Units, None),
    "density": (Density, None),
    "fasten": (Fasten, None),
    "bond": (Bonded, None),
    "fasten_suggested": (FastenSuggested, False),
    "fasten_overlaps": (FastenOverlaps, False),
    "contacts": (Contacts, None),
    "keyframe": (Keyframe, None),
    "base": (Base, None),
    "stud_pull": (StudPull, None),
    "stud_shear": (StudShear, None),
    "brick_sides": (BrickSides, None),
    "gap": (Gap, None),
    "angle": (Angle, None),
    "clearance": (Clearance, None),
    "loose": (Loose, False),
}
"""How a file is read, and when its faces count as touching."""
SEARCHING: dict[str, tuple[Any, Any]] = {
    "effort": (Effort, EFFORT),
    "time_limit": (TimeLimit, None),
}
"""How much work an answer may take."""
FORMS: dict[str, tuple[Any, Any]] = {
    "verbose": (Verbose, False),
    "json": (Json, False),
    "output": (Output, None),
}


def asks(
    *, searches: bool = False, proves: bool = False, answers: bool = True
) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Give a command ``act(asked, **own)`` the options that commands share.

    Parameters
    ----------
    searches : bool
        The command searches for motions with friction: ``--effort`` and ``--time-limit``.
    proves : bool
        The answer has a proof that can be kept: ``--proof``.
    answers : bool
        The command has an answer: ``--json`` and ``--output``. Else it writes a page or a
        figure, and says itself where.
    """

    def made(act: Callable[..., int]) -> Callable[..., int]:
        _, *own = inspect.signature(act, eval_str=True).parameters.values()
        shared = READING | (SEARCHING if searches else {})
        kept = {"proof": (Proof, None)} if proves else {}
        last = kept | (FORMS if answers else {}) | {"quiet": (Quiet, False)}
        several = any(one.name == "files" for one in own)
        first = [] if several else [_parameter("file", File)]
        parameters = [
            *first,
            *(one for one in own if one.default is inspect.Parameter.empty),
            *(_parameter(name, *one) for name, one in shared.items()),
            *(one for one in own if one.default is not inspect.Parameter.empty),
            *(_parameter(name, *one) for name, one in last.items()),
        ]
        names = {one.name for one in own}

        def command(**given: Any) -> int:
            mine = {name: value for name, value in given.items() if name in names}
            return act(Asked.of({k: v for k, v in given.items() if k not in names}), **mine)

        signature = inspect.Signature(parameters, return_annotation=int)
        command.__signature__ = signature  # type: ignore[attr-defined]
        command.__annotations__ = {one.name: one.annotation for one in parameters}
        command.__name__, command.__doc__ = act.__name__, act.__doc__
        return command

    return made


def _parameter(name: str, kind: Any, default: Any = inspect.Parameter.empty) -> inspect.Parameter:
    return inspect.Parameter(
        name, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=kind
    )
