"""Options that several commands share, and the decorator that adds them to a command.

``@asks()`` adds the file and the options of its reading. The command itself takes an `Asked` and
its own options.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, get_type_hints

from kilter.cli.asked import Asked
from kilter.cli.declarations import Argument, Option
from kilter.cli.output import require_answer_file
from kilter.cli.quantities import density_of, friction_of
from kilter.errors import TimeLimitReached
from kilter.work import EFFORT

__all__ = [
    "FORM",
    "QUESTION",
    "Code",
    "File",
    "Files",
    "Forward",
    "Json",
    "Output",
    "Quiet",
    "Require",
    "asks",
]

HELD = "Held parts, gravity, friction and materials"
TOUCH = "Contacts and their tolerances"
SAVED = "Saved choices"
FORM = "Form of the answer"
WORK = "Limits of work and time"
QUESTION = "Question: an acceleration, a turn, a rule of load securing or a path"

HELP_OF_FILE = (
    "An assembly: STEP (needs kilter[step]), a folder of meshes (a file for each part), OBJ, STL, "
    "3MF, GLB, COMPAS JSON, MJCF, URDF, USD (needs kilter[usd]), bricks (LDraw, StableLego JSON, "
    "BrickGPT text), a packing list (CSV) or *.kilter.json. With -, kilter JSON is read from "
    "standard input."
)
File = Annotated[
    str,
    Argument(
        metavar="FILE",
        help=HELP_OF_FILE,
        show_default=False,
    ),
]
Files = Annotated[
    list[str],
    Argument(metavar="FILE...", help=HELP_OF_FILE, show_default=False),
]
Ground = Annotated[
    list[str] | None,
    Option(
        "--ground",
        metavar="NAME...",
        help="Hold these parts, so that they cannot move. Repeatable; * and ? are wildcards.",
        panel=HELD,
        show_default=False,
    ),
]
Floor = Annotated[
    str | None,
    Option(
        "--floor",
        metavar="[HEIGHT]",
        help="Add a held table under the lowest point, or at this height (file units). It lies "
        "across the up direction of the file.",
        panel=HELD,
        show_default=False,
    ),
]
Without = Annotated[
    list[str] | None,
    Option(
        "--without",
        metavar="NAME...",
        help="Leave these parts out, for a half-built assembly. Repeatable; * and ? are wildcards.",
        panel=HELD,
        show_default=False,
    ),
]
Down = Annotated[
    tuple[float, float, float] | None,
    Option(
        "--down",
        metavar="X Y Z",
        help="Direction of gravity. Its size in the file is kept. A floor turns with the parts.",
        panel=HELD,
        show_default=False,
    ),
]
Up = Annotated[
    str | None,
    Option(
        "--up",
        metavar="x|y|z|-x|-y|-z",
        help="The axis of the file that points up; z by default.",
        panel=HELD,
        show_default=False,
    ),
]
Contacts = Annotated[
    str | None,
    Option(
        "--contacts",
        metavar="file|geometry",
        help="file: use only the contacts in the file (interfaces of COMPAS). geometry: detect all "
        "contacts.",
        panel=TOUCH,
        show_default=False,
    ),
]
Keyframe = Annotated[
    str | None,
    Option(
        "--keyframe",
        metavar="NAME",
        help="MJCF only: use the pose of this keyframe; the first keyframe by default.",
        panel=HELD,
        show_default=False,
    ),
]
Base = Annotated[
    str | None,
    Option(
        "--base",
        metavar="fixed|floating",
        help="URDF only: whether the root link is held; fixed by default.",
        panel=HELD,
        show_default=False,
    ),
]
StudPull = Annotated[
    float | None,
    Option(
        "--stud-pull",
        metavar="N",
        help="Bricks only: pull that each of the three or four points of a stud resists [N]; "
        "0.98 N by default.",
        panel=HELD,
        show_default=False,
    ),
]
StudShear = Annotated[
    str | None,
    Option(
        "--stud-shear",
        metavar="unlimited|mu|N",
        help="Bricks only: sideways force that each point of a stud resists: any force, friction "
        "only (mu), or up to this force [N]; unlimited by default.",
        panel=HELD,
        show_default=False,
    ),
]
BrickSides = Annotated[
    str | None,
    Option(
        "--brick-sides",
        metavar="lower-edge|face|none",
        help="Bricks only: where neighbours in a layer can push each other; lower-edge by default.",
        panel=HELD,
        show_default=False,
    ),
]
Friction = Annotated[
    float | None,
    Option(
        "--friction",
        metavar="MU",
        reads=friction_of,
        help="Friction coefficient of contacts without a coefficient of their own; it replaces the "
        "default of the file. 30% and 17deg are 0.3 and tan 17 deg.",
        panel=HELD,
        show_default=False,
    ),
]
Units = Annotated[
    str | None,
    Option(
        "--units",
        metavar="m|cm|mm|in",
        help="Unit of length of a file that does not name its unit; m by default.",
        panel=HELD,
        show_default=False,
    ),
]
Density = Annotated[
    float | None,
    Option(
        "--density",
        metavar="KG/M3",
        reads=density_of,
        help="Density of the parts without a density in the file, or of all parts of a STEP file "
        "[kg/m^3]; 1000 by default. Names such as steel or oak are known.",
        panel=HELD,
        show_default=False,
    ),
]
Material = Annotated[
    list[str] | None,
    Option(
        "--material",
        metavar="NAME=KG/M3",
        help='Density of parts, in place of density and mass of the file: --material "bolt*=7850" '
        'or "bolt*=steel". Repeatable; * and ? are wildcards.',
        panel=HELD,
        show_default=False,
    ),
]
Gap = Annotated[
    float | None,
    Option(
        "--gap",
        metavar="LENGTH",
        help="Largest gap between touching faces (file units); 1e-5 of the size of the smaller "
        "part by default.",
        panel=TOUCH,
        show_default=False,
    ),
]
Angle = Annotated[
    float | None,
    Option(
        "--angle",
        metavar="DEG",
        help="Largest angle between touching faces [deg]; 0.057 deg (1e-3 rad) by default.",
        panel=TOUCH,
        show_default=False,
    ),
]
Loose = Annotated[
    bool,
    Option(
        "--loose",
        help="For scanned or rounded data: touching faces may have gaps up to 1e-3 of the size of "
        "the smaller part and angles up to 1.15 deg.",
        panel=TOUCH,
    ),
]
Effort = Annotated[
    float,
    Option(
        "--effort",
        metavar="N",
        help="With friction: limit of the work for finding a motion or proving that none exists. "
        "0 is quick, 1 is usual, and each further step allows ten times more. Work is counted, "
        "not timed, so every machine gives the same answer.",
        panel=WORK,
    ),
]
TimeLimit = Annotated[
    float | None,
    Option(
        "--time-limit",
        metavar="SECONDS",
        help="Stop after this time and answer with the proofs found until then; no limit by "
        "default.",
        panel=WORK,
        show_default=False,
    ),
]
Clearance = Annotated[
    float | None,
    Option(
        "--clearance",
        metavar="LENGTH",
        help="Designed clearance: faces up to this distance apart (file units) count as closed. "
        "Penetrating faces do not.",
        panel=TOUCH,
        show_default=False,
    ),
]
Fasten = Annotated[
    list[tuple[str, str]] | None,
    Option(
        "--fasten",
        metavar="NAME NAME",
        help="Join two parts rigidly. Repeatable. With * and ? every two matching parts that touch "
        'are joined, as in --fasten "bolt*" "nut*"; held parts must have their full name.',
        panel=HELD,
        show_default=False,
    ),
]
FastenSuggested = Annotated[
    bool,
    Option(
        "--fasten-suggested",
        help="Join all pairs that look fastened, and list them: screws in threads, press fits, "
        "inserts and other overlaps.",
        panel=HELD,
    ),
]
FastenOverlaps = Annotated[
    bool,
    Option(
        "--fasten-overlaps",
        help="Join all pairs of parts that overlap, and list them.",
        panel=HELD,
    ),
]
Bonded = Annotated[
    list[tuple[str, str, float]] | None,
    Option(
        "--bond",
        metavar="NAME NAME T",
        help="Bond two parts: each contact point between them also resists a pull up to T [N] and "
        "any shear force. Repeatable; * and ? as in --fasten.",
        panel=HELD,
        show_default=False,
    ),
]
Straps = Annotated[
    Path | None,
    Option(
        "--straps",
        metavar="FILE.json",
        help="Add the straps of this file, a JSON list of straps as in an assembly file: "
        '[{"path": [["ground", [x, y, z]], ["box", [x, y, z]]], "tension": N}].',
        panel=HELD,
        show_default=False,
    ),
]
Mass = Annotated[
    list[str] | None,
    Option(
        "--mass",
        metavar="NAME=KG",
        help='Mass of a part, in place of its density: --mass "bolt*=0.2". Repeatable; * and ? are '
        "wildcards.",
        panel=HELD,
        show_default=False,
    ),
]
Load = Annotated[
    list[str] | None,
    Option(
        "--load",
        metavar="NAME=FX,FY,FZ",
        help="Add a force at the centre of mass of a part [N]: --load lid=0,0,-20. Repeatable; * "
        "and ? are wildcards.",
        panel=HELD,
        show_default=False,
    ),
]
Accelerate = Annotated[
    tuple[str, str, str] | None,
    Option(
        "--accelerate",
        metavar="X Y Z",
        help="The held parts belong to a carrier with this acceleration, in m/s^2, or in g as "
        "0.5g.",
        panel=HELD,
        show_default=False,
    ),
]
Off = Annotated[
    list[str] | None,
    Option(
        "--off",
        metavar="OPTION...",
        help="Ignore the saved values of these options: --off floor loose, or --no-floor "
        "--no-loose. Repeatable.",
        panel=SAVED,
        show_default=False,
    ),
]
Release = Annotated[
    list[str] | None,
    Option(
        "--release",
        metavar="NAME...",
        help="Do not hold these parts, which the saved choices hold. Repeatable; * and ? are "
        "wildcards.",
        panel=SAVED,
        show_default=False,
    ),
]
Require = Annotated[
    str,
    Option(
        "--require",
        metavar="LEVEL",
        help="Level at which the assembly counts as holding: equilibrium, settles, proved or "
        "strict.",
        panel=FORM,
    ),
]
Proof = Annotated[
    Path | None,
    Option(
        "--proof",
        metavar="P.json",
        help="Write the proof to this file; 'kilter verify FILE P.json' recomputes it.",
        panel=FORM,
        show_default=False,
    ),
]
Json = Annotated[bool, Option("--json", help="Print only JSON.", panel=FORM)]
Output = Annotated[
    Path | None,
    Option(
        "-o",
        "--output",
        metavar="FILE",
        help="Write the answer to this file instead of standard output; to x.json as JSON.",
        panel=FORM,
        show_default=False,
    ),
]
Verbose = Annotated[
    bool,
    Option(
        "-v",
        "--verbose",
        help="Also print the basis of the answer: masses, contacts, proof, guarantee of friction, "
        "z and kappa, neutral motions, and the time it took.",
        panel=FORM,
    ),
]
Quiet = Annotated[
    bool,
    Option(
        "--quiet",
        help="Print no progress and no warnings on the error stream.",
        panel=FORM,
    ),
]
Code = Annotated[
    str | None,
    Option(
        "--code",
        metavar="NAME",
        help="Does the assembly stay in place at the accelerations of this rule of load securing? "
        "en12195, en12195:tipping, gdv, vdi2700:3.5t, vdi2700:up-to-3.5t, eumos, or eumos:K for "
        "K g.",
        panel=QUESTION,
        show_default=False,
    ),
]
Forward = Annotated[
    tuple[float, float, float],
    Option(
        "--forward",
        metavar="X Y Z",
        help="Direction of travel, for --code.",
        panel=QUESTION,
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
    "material": (Material, None),
    "fasten": (Fasten, None),
    "bond": (Bonded, None),
    "straps": (Straps, None),
    "mass": (Mass, None),
    "load": (Load, None),
    "accelerate": (Accelerate, None),
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
    "off": (Off, None),
    "release": (Release, None),
}
"""Options of reading a file and of contact detection, each with its default."""
SEARCHING: dict[str, tuple[Any, Any]] = {
    "effort": (Effort, EFFORT),
    "time_limit": (TimeLimit, None),
}
"""Options that limit work and time, each with its default."""
FORMS: dict[str, tuple[Any, Any]] = {
    "verbose": (Verbose, False),
    "json": (Json, False),
    "output": (Output, None),
}


def asks(
    *,
    searches: bool = False,
    timed: bool = False,
    proves: bool = False,
    answers: bool = True,
    writes: tuple[str, ...] = (),
) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Create a decorator that adds the shared options to a command ``act(asked, **options)``.

    A parameter whose annotation is a dataclass stands for the options that are its fields. An
    option of the command replaces a shared option of the same name.

    Parameters
    ----------
    searches : bool
        Whether to add ``--effort`` and ``--time-limit``, for commands that search with friction.
    timed : bool
        Whether to add ``--time-limit`` only, for commands without a search.
    proves : bool
        Whether to add ``--proof``, for answers with a proof.
    answers : bool
        Whether to add ``--json``, ``--output`` and ``--verbose``. Commands that write a page or a
        figure have output options of their own.
    writes : tuple of str
        Endings of pages, figures and films that the command writes with ``--output``.
    """

    def decorate(act: Callable[..., int]) -> Callable[..., int]:
        """Wrap a command so that its signature contains the shared options."""
        _, *declared = inspect.signature(act, eval_str=True).parameters.values()
        declared_options = [field for parameter in declared for field in _own_options(parameter)]
        limits = {"time_limit": (TimeLimit, None)} if timed else {}
        shared = READING | (SEARCHING if searches else limits)
        names = {parameter.name for parameter in declared_options}
        shared = {name: option for name, option in shared.items() if name not in names}
        kept = {"proof": (Proof, None)} if proves else {}
        last = kept | (FORMS if answers else {}) | {"quiet": (Quiet, False)}
        own = any(parameter.name in ("file", "files") for parameter in declared_options)
        first = [] if own else [_parameter("file", File)]
        parameters = [
            *first,
            *(
                parameter
                for parameter in declared_options
                if parameter.default is inspect.Parameter.empty
            ),
            *(_parameter(name, *option) for name, option in shared.items()),
            *(
                parameter
                for parameter in declared_options
                if parameter.default is not inspect.Parameter.empty
            ),
            *(_parameter(name, *option) for name, option in last.items()),
        ]

        def command(**given: Any) -> int:
            if answers:
                require_answer_file(given["output"], writes)
            asked = Asked.of({k: v for k, v in given.items() if k not in names})
            try:
                return act(asked, **{entry.name: _value(entry, given) for entry in declared})
            except TimeLimitReached as reached:
                return asked.tell_cut(reached)

        # the parser of options reads the signature and the annotations of the command
        signature = inspect.Signature(parameters, return_annotation=int)
        command.__signature__ = signature  # type: ignore[attr-defined]
        command.__annotations__ = {entry.name: entry.annotation for entry in parameters}
        command.__name__, command.__doc__ = act.__name__, act.__doc__
        return command

    return decorate


def _own_options(parameter: inspect.Parameter) -> list[inspect.Parameter]:
    """The shared options that replace a parameter such as `asked`, or the parameter itself."""
    if not is_dataclass(parameter.annotation):
        return [parameter]
    kinds = get_type_hints(parameter.annotation, include_extras=True)
    every = fields(parameter.annotation)
    return [_parameter(field.name, kinds[field.name], field.default) for field in every]


def _value(parameter: inspect.Parameter, given: dict[str, Any]) -> Any:
    """Value of a parameter of a command, from the values of all options by name."""
    build: Callable[..., Any] = parameter.annotation
    if not is_dataclass(parameter.annotation):
        return given[parameter.name]
    return build(**{field.name: given[field.name] for field in fields(parameter.annotation)})


def _parameter(name: str, kind: Any, default: Any = inspect.Parameter.empty) -> inspect.Parameter:
    """Create a parameter of a command from name, annotation and default."""
    return inspect.Parameter(
        name, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=kind
    )
