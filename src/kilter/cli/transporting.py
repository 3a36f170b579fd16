"""The command `transport`: accelerations of a carrier under which an assembly stays in place."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from kilter.cli.asked import Asked
from kilter.cli.declarations import Option
from kilter.cli.exit_codes import HOLDS, LOWER, VERDICT, WRITTEN
from kilter.cli.options import FORM, QUESTION, Code, Forward, Require, asks
from kilter.cli.output import Progress
from kilter.errors import InputError
from kilter.tell.levels import REQUIRE

if TYPE_CHECKING:
    from kilter.analysis.transport.carrier import CarrierMotion
    from kilter.analysis.transport.carrier_path import CarrierPath
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.assembly import Assembly

__all__ = ["transport"]

UNSURE = "Worst case for uncertain data"


@asks(searches=True, proves=True)
def transport(
    asked: Asked,
    turn: Annotated[
        tuple[float, float, float] | None,
        Option(
            "--turn",
            metavar="X Y Z",
            help="Angular velocity of the carrier about --about [rad/s].",
            panel=QUESTION,
            show_default=False,
        ),
    ] = None,
    turn_faster: Annotated[
        tuple[float, float, float] | None,
        Option(
            "--turn-faster",
            metavar="X Y Z",
            help="Angular acceleration of the carrier about --about [rad/s^2].",
            panel=QUESTION,
            show_default=False,
        ),
    ] = None,
    about: Annotated[
        tuple[float, float, float],
        Option(
            "--about",
            metavar="X Y Z",
            help="Point to which --accelerate, --turn and --turn-faster refer (file units).",
            panel=QUESTION,
        ),
    ] = (0.0, 0.0, 0.0),
    code: Code = None,
    forward: Forward = (1.0, 0.0, 0.0),
    path: Annotated[
        Path | None,
        Option(
            "--path",
            metavar="PATH.csv",
            help="How many times as fast may the carrier follow this path? Columns: time, x, y, z "
            "(file units), and optionally qw, qx, qy, qz; or ax, ay, az, ox, oy, oz, alx, aly, "
            "alz in the frame of the carrier; or the joints of --robot.",
            panel=QUESTION,
            show_default=False,
        ),
    ] = None,
    robot: Annotated[
        Path | None,
        Option(
            "--robot",
            metavar="ROBOT.urdf",
            help="The --path has the values of the joints of this robot over time, in columns "
            "with their names [rad or m].",
            panel=QUESTION,
            show_default=False,
        ),
    ] = None,
    flange: Annotated[
        str | None,
        Option(
            "--flange",
            metavar="LINK",
            help="Link of --robot on which the assembly stands; its frame is that of the file.",
            panel=QUESTION,
            show_default=False,
        ),
    ] = None,
    collapse: Annotated[
        bool,
        Option(
            "--collapse",
            help="Also the collapse multipliers of horizontal forces: mechanism, participating "
            "mass, and spectral acceleration.",
            panel=QUESTION,
        ),
    ] = False,
    fc: Annotated[
        float,
        Option(
            "--fc",
            metavar="FC",
            help="Confidence factor of the spectral accelerations of --collapse.",
            panel=QUESTION,
        ),
    ] = 1.35,
    mu_range: Annotated[
        tuple[float, float] | None,
        Option(
            "--mu-range",
            metavar="LOW HIGH",
            help="Factors between which every friction coefficient varies. All limits are those of "
            "the worst case, which is LOW.",
            panel=UNSURE,
            show_default=False,
        ),
    ] = None,
    figure: Annotated[
        Path | None,
        Option(
            "--figure",
            metavar="OUT.svg|png|pdf",
            help="Also write a figure of all horizontal accelerations, or of the speed factor of "
            "--path over time. Needs kilter[figures].",
            panel=FORM,
            show_default=False,
        ),
    ] = None,
    film: Annotated[
        Path | None,
        Option(
            "--film",
            metavar="OUT.glb",
            help="Also write a film of the parts that start to move first, seen from the carrier.",
            panel=FORM,
            show_default=False,
        ),
    ] = None,
    require: Require = REQUIRE,
) -> int:
    """Find how hard a carrier may accelerate, brake and turn before a part on it moves.

    The frame of the file is fixed in the carrier: a truck, a trolley, a robot's wrist. Held parts
    belong to the carrier. --accelerate asks about one acceleration. Without a question: the
    largest acceleration along each axis, and the least of all horizontal directions. Up to each
    limit forces that hold the assembly exist.

    Exit code: 0 carried at the level of --require (without a question: always), 1 not carried,
    3 carried at a lower level only, 4 undecided.
    """
    from kilter.analysis.transport.transport import transport as find

    asked, accelerate = asked.without_acceleration()
    if figure is not None:
        _require_figure(figure, [accelerate, turn, turn_faster, code])
        asked.apart(figure)
    if film is not None:
        from kilter import publish

        publish.require_ending(film, publish.FILMS, "film")
        asked.apart(film)
    motion = _motion(accelerate, turn, turn_faster, about)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answer = find(
            assembly,
            turn=None if motion is None else motion(assembly),
            code=code,
            forward=forward,
            path=_path(path, robot, flange, assembly.units),
            collapse=collapse,
            fc=fc,
            mu_range=mu_range,
            contacts=contacts,
            require=require,
            tolerance=asked.tolerance,
            effort=asked.effort,
            time_limit=asked.time_limit,
            progress=progress,
        )
        if figure is not None:
            from kilter import publish

            progress("figure")
            publish.draw(answer, figure)
        if film is not None:
            progress("film")
            publish.animate(answer, film)
    data = answer.to_dict()
    after = asked.keep_proof(answer.proof if _has_proof(answer) else None, data)
    for name, file in (("figure", figure), ("film", film)):
        after += f"\n{name:13s}written to {file}" if file else ""
    asked.tell(data, after=after)
    return _exit_code(answer)


def _path(
    path: Path | None, robot: Path | None, flange: str | None, units: str
) -> CarrierPath | None:
    """Carrier path of the options; None without any."""
    from kilter.analysis.transport.carrier_path import read_path
    from kilter.analysis.transport.robot_path import read_robot_path

    if (robot is None) != (flange is None):
        missing = "--robot" if robot is None else "--flange"
        raise InputError(f"{missing} is missing", hint="give --path, --robot and --flange together")
    if path is None:
        if robot is not None:
            raise InputError(
                "--robot has no path", hint="give its joint values over time with --path"
            )
        return None
    if robot is None or flange is None:
        return read_path(path, units=units)
    return read_robot_path(path, robot, flange)


def _exit_code(answer: Transport) -> int:
    """Exit code of `transport` for its answer."""
    if not answer.cases and answer.speed is None and "path" not in answer.missing:
        return WRITTEN
    if answer.carried is None:
        return VERDICT["undecided"]
    if answer.carried:
        return HOLDS
    lower = bool(answer.cases) and answer.level is not None
    return LOWER if lower else VERDICT["unstable"]


def _has_proof(answer: Transport) -> bool:
    """Whether any limit of a transport answer has proofs."""
    return answer.least is not None or any(case.factor is not None for case in answer.cases)


def _require_figure(figure: Path, question: list[object]) -> None:
    """Reject a figure file with a wrong ending, or options whose answer has no figure."""
    from kilter import publish

    publish.require_figure(figure, None)
    if any(value is not None for value in question):
        raise InputError(
            "--figure shows all horizontal accelerations, or a path",
            hint="give it without a question, or with --path",
        )


def _motion(
    accelerate: tuple[str, str, str] | None,
    turn: tuple[float, float, float] | None,
    turn_faster: tuple[float, float, float] | None,
    about: tuple[float, float, float],
) -> Callable[[Assembly], CarrierMotion] | None:
    """Return a function from an assembly to the carrier motion of the options; None without any."""
    if accelerate is None and turn is None and turn_faster is None:
        return None
    from kilter.files.reading_steps import acceleration_of

    parts = [acceleration_of("--accelerate", text) for text in accelerate or ("0", "0", "0")]

    def motion(assembly: Assembly) -> CarrierMotion:
        from kilter.analysis.transport.carrier import CarrierMotion

        gravity = math.hypot(*assembly.gravity)
        along = [value * (gravity if in_g else 1.0) for value, in_g in parts]
        none = (0.0, 0.0, 0.0)
        return CarrierMotion(along, turn or none, turn_faster or none, about)

    return motion
