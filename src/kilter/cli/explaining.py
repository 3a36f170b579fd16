"""The command `why`: why a state of a MuJoCo scene moves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.cli.exit_codes import HOLDS, LOWER, WHY
from kilter.cli.options import FORM, WORK, Json, Output, Quiet, Require, takes
from kilter.cli.output import (
    Progress,
    as_json,
    emit,
    keep_apart,
    require_answer_file,
    tell_warnings,
    tell_written,
    write_whole,
    writes_json,
)
from kilter.errors import InputError
from kilter.values.declaration import argument, option
from kilter.work import EFFORT

if TYPE_CHECKING:
    from kilter.analysis.engine_contacts.judged import Judged

STATE = "State of the scene"
LONGEST = 100.0
"""Longest simulation [s]."""
MOST_STEPS = 1_000_000
"""Largest number of steps before the judgement."""


@dataclass(frozen=True, kw_only=True)
class WhyOptions:
    """Options of `why`."""

    file: str = argument("SCENE", "A scene for MuJoCo: an MJCF file.")
    keyframe: str | None = option(
        "--keyframe NAME", "Use the state of this keyframe; the first keyframe by default.", STATE
    )
    state: str | None = option(
        "--state FILE[:ROW]",
        "Use the state of this row of a file of numpy.save: qpos; qpos and qvel; or time, qpos and "
        "qvel. The first row by default.",
        STATE,
    )
    steps: int = option("--steps N", "First simulate this number of time steps.", STATE, default=0)
    creep: float = option(
        "--creep SECONDS",
        "Simulate the state from rest for this time, with several settings of the engine's solver, "
        "and report which of them moves the bodies least.",
        STATE,
        default=0.0,
    )
    loose_robots: bool = option(
        "--loose-robots",
        "Let robots move, with the forces of their motors as loads; they are held by default.",
        STATE,
    )
    effort: float = option(
        "--effort N",
        "Limit of the work for finding a motion or proving that none exists, as of 'kilter check'.",
        WORK,
        default=EFFORT,
    )
    time_limit: float | None = option(
        "--time-limit SECONDS",
        "Stop after this time and answer with the proofs found until then; no limit by default.",
        WORK,
    )
    require: str = Require()
    proof: Path | None = option(
        "--proof P.json",
        "Write the proof to this file; 'kilter verify X.kilter.json P.json' recomputes it from the "
        "file of --contacts.",
        FORM,
    )
    contacts: Path | None = option(
        "--contacts X.kilter.json",
        "Write the bodies and the engine's contacts as an assembly to this file.",
        FORM,
    )
    json: bool = Json()
    output: Path | None = Output()
    quiet: bool = Quiet()


@takes
def why(options: WhyOptions) -> int:
    """Why do the bodies of a MuJoCo scene move, judged with the engine's own contacts?

    The state is one of four. Holds: forces at the contacts balance every body, so that a motion is
    creep of soft contacts; the answer has the largest factor of gravity that holds. Falls: no
    forces do. Pushed-out: a contact is deeper than its parameters explain. Floats: no contact.

    Exit code: 0 it holds at the level of --require, 3 it holds only at a lower level, 1 a body
    falls, is pushed out or floats, 4 undecided.
    """
    from kilter.analysis.engine_contacts.engine_bodies import EngineBodies
    from kilter.analysis.engine_contacts.judged import judge_bodies
    from kilter.assembly.question import Question
    from kilter.files.format_options import FormatOptions
    from kilter.files.objects.state_files import state_row
    from kilter.files.robots.scene_process import read_engine_state
    from kilter.tell.levels import require_level
    from kilter.tell.text import text_of

    require_answer_file(options.output)
    keep_apart(options.file, options.output, options.proof, options.contacts)
    _require_run(options)
    asked = Question(
        require=require_level(options.require, strict=True),
        effort=options.effort,
        time_limit=options.time_limit,
        verb="why",
    )
    with Progress(options.quiet) as progress:
        progress("reading")
        states = None if options.state is None else state_row(options.state)
        choices = FormatOptions(keyframe=options.keyframe, states=states)
        state = read_engine_state(Path(options.file), choices, (options.steps, options.creep))
        progress("verdict")
        bodies = EngineBodies(state, options.loose_robots)
        judged = judge_bodies(bodies, asked, options.creep)
        data = judged.to_dict()
    after = _write_files(options, judged)
    tell_warnings(data["warnings"], options.quiet or options.json)
    as_data = writes_json(options.json, options.output)
    emit(as_json(data) if as_data else text_of(data) + after, options.output)
    tell_written(options.output, f"answer of why as {'JSON' if as_data else 'text'}", options.quiet)
    if judged.holds:
        return HOLDS
    return LOWER if judged.state == "holds" else WHY[judged.state]


def _require_run(options: WhyOptions) -> None:
    """Raise an error if a number of a simulation is out of range, or two states are given."""
    if not 0 <= options.steps <= MOST_STEPS:
        raise InputError(f"--steps is {options.steps}", hint=f"give 0 to {MOST_STEPS}")
    if not 0 <= options.creep <= LONGEST:
        raise InputError(f"--creep is {options.creep:g}", hint=f"give 0 to {LONGEST:g} seconds")
    if options.keyframe is not None and options.state is not None:
        raise InputError("--keyframe and --state are given", hint="give one of them")


def _write_files(options: WhyOptions, judged: Judged) -> str:
    """Write the proof and the contacts; return the lines for the user about them."""
    from kilter.files import to_text

    lines = []
    if options.contacts is not None:
        if judged.assembly is None:
            lines.append("contacts     not written: no body moves")
        else:
            write_whole(options.contacts, to_text(judged.assembly))
            lines.append(f"contacts     written to {options.contacts}")
    if options.proof is not None:
        proves = judged.verdict is not None and judged.verdict.evidence is not None
        if proves:
            write_whole(options.proof, as_json(judged.proof()))
        state = f"written to {options.proof}" if proves else "not written: this answer has no proof"
        lines.append(f"proof file   {state}")
    return "".join(f"\n{line}" for line in lines)
