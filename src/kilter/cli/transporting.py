"""The command `transport`: accelerations of a carrier under which an assembly stays in place."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import HOLDS, LOWER, VERDICT, WRITTEN
from kilter.cli.options import FORM, QUESTION, Code, Forward, Require, asks
from kilter.cli.output import Progress
from kilter.errors import InputError
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.analysis.transport.carrier import CarrierMotion
    from kilter.analysis.transport.carrier_path import CarrierPath
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.assembly import Assembly


UNSURE = "Worst case for uncertain data"


@dataclass(frozen=True, kw_only=True)
class TransportOptions:
    """Options of `transport`."""

    turn: tuple[float, float, float] | None = option(
        "--turn X Y Z", "Angular velocity of the carrier about --about [rad/s].", QUESTION
    )
    turn_faster: tuple[float, float, float] | None = option(
        "--turn-faster X Y Z",
        "Angular acceleration of the carrier about --about [rad/s^2].",
        QUESTION,
    )
    about: tuple[float, float, float] = option(
        "--about X Y Z",
        "Point to which --accelerate, --turn and --turn-faster refer (file units).",
        QUESTION,
        default=(0.0, 0.0, 0.0),
    )
    code: str | None = Code()
    forward: tuple[float, float, float] = Forward()
    path: Path | None = option(
        "--path PATH.csv",
        "How many times as fast may the carrier follow this path? Columns: time, x, y, z "
        "(file units), and optionally qw, qx, qy, qz; or ax, ay, az, ox, oy, oz, alx, aly, "
        "alz in the frame of the carrier; or the joints of --robot.",
        QUESTION,
    )
    robot: Path | None = option(
        "--robot ROBOT.urdf",
        "The --path has the values of the joints of this robot over time, in columns with "
        "their names [rad or m].",
        QUESTION,
    )
    flange: str | None = option(
        "--flange LINK",
        "Link of --robot on which the assembly stands; its frame is that of the file.",
        QUESTION,
    )
    collapse: bool = option(
        "--collapse",
        "Also the collapse multipliers of horizontal forces: mechanism, participating mass, "
        "and spectral acceleration.",
        QUESTION,
    )
    fc: float = option(
        "--fc FC",
        "Confidence factor of the spectral accelerations of --collapse.",
        QUESTION,
        default=1.35,
    )
    mu_range: tuple[float, float] | None = option(
        "--mu-range LOW HIGH",
        "Factors between which every friction coefficient varies. All limits are those of the"
        " worst case, which is LOW.",
        UNSURE,
    )
    figure: Path | None = option(
        "--figure OUT.svg|png|pdf",
        "Also write a figure of all horizontal accelerations, or of the speed factor of "
        "--path over time. Needs kilter[figures].",
        FORM,
    )
    film: Path | None = option(
        "--film OUT.glb",
        "Also write a film of the parts that start to move first, seen from the carrier.",
        FORM,
    )
    require: str = Require()


@asks(searches=True, proves=True)
def transport(asked: Asked, options: TransportOptions) -> int:
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
    if options.figure is not None:
        _require_figure(
            options.figure, [accelerate, options.turn, options.turn_faster, options.code]
        )
        asked.apart(options.figure)
    if options.film is not None:
        from kilter import publish

        publish.require_ending(options.film, publish.FILMS, "film")
        asked.apart(options.film)
    motion = _motion(accelerate, options.turn, options.turn_faster, options.about)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answer = find(
            assembly,
            turn=None if motion is None else motion(assembly),
            code=options.code,
            forward=options.forward,
            path=_path(options.path, options.robot, options.flange, assembly.units),
            collapse=options.collapse,
            fc=options.fc,
            mu_range=options.mu_range,
            require=options.require,
            **asked.shared(find, contacts, progress),
        )
        if options.figure is not None:
            from kilter import publish

            progress("figure")
            publish.draw(answer, options.figure)
        if options.film is not None:
            progress("film")
            publish.animate(answer, options.film)
    data = answer.to_dict()
    after = asked.keep_proof(answer.proof if _has_proof(answer) else None, data)
    for name, file in (("figure", options.figure), ("film", options.film)):
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
