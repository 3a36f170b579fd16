"""The commands `settle` and `scene`: poses at rest, and the states of the objects of a scene."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import HOLDS, LOWER, SCENE, SETTLE
from kilter.cli.options import Json, Require, asks
from kilter.cli.output import (
    OTHER_FILES,
    Progress,
    as_json,
    emit,
    require_answer_file,
    tell_warnings,
    tell_written,
    write_whole,
)
from kilter.cli.simulator_poses import with_key, write_simulator_pose
from kilter.cli.state_settling import settle_many
from kilter.errors import InputError
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.analysis.scene_states.scene_report import SceneReport
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.assembly import Assembly
    from kilter.files.reading import Reading


MOVED = "Movement"
PICTURES = (".svg", ".png", ".pdf")
USD = (".usd", ".usda", ".usdc")


@dataclass(frozen=True, kw_only=True)
class SettleOptions:
    """Options of `settle`."""

    reach: float | None = option(
        "--reach LENGTH",
        "Largest way of a part (file units). By default it has no limit; with --nearest, it is "
        "three times the widest gap or overlap.",
        MOVED,
    )
    keep: list[str] | None = option(
        "--keep NAME",
        "A part that must not move although it is not held. Repeatable; * and ? are wildcards.",
        MOVED,
    )
    nearest: bool = option(
        "--nearest",
        "Search for a pose at rest by the least motion: parts do not fall, tip or roll.",
        MOVED,
    )
    ease: bool = option(
        "--ease",
        "Let parts at rest slide on, by at most a tenth of their size, to where they need little "
        "friction: in a simulator with soft contacts, friction that holds a part creeps.",
        MOVED,
    )
    states: Path | None = option(
        "--states FILE",
        "Settle each state of an MJCF scene in this file (.npy, .npz, or a pickled array such as "
        ".pruned_init): a row qpos, or a full state. With -o X.npy the new states are written; a "
        "later run continues an interrupted one. --time-limit counts for each state.",
        MOVED,
    )
    processes: int = option(
        "--processes N", "Number of processes that settle states.", MOVED, default=1
    )
    require: str = Require()
    json: bool = Json()
    output: Path | None = option(
        "-o --output OUT",
        "Write the pose at rest: X.kilter.json (choices about FILE), X.xml (a copy of an MJCF file "
        "with new poses, in the keyframe of --keyframe; or a new MJCF scene), X.npy (poses "
        "only: qpos for MJCF), X.glb, X.usda (a layer over a USD file), X.json (COMPAS), or a "
        "figure X.svg, X.png, X.pdf with magnified movements.",
    )


@asks(searches=True, proves=True, answers=False)
def settle(asked: Asked, options: SettleOptions) -> int:
    """Bring parts that overlap or hang to rest, and prove that they rest.

    Overlapping parts are pushed apart; then parts fall, tip, slide and roll until they rest or
    leave the scene. The answer is a pose at rest that the assembly can reach without gaining
    energy, not a claim about dynamics. It states the way of each part, the widest remaining gap,
    and the verdicts before and after. At rest means: no overlap, and forces at closed points hold
    every part. The pose is not unique.

    Exit code: 0 at rest at the level of --require, 3 at rest at a lower level, 1 a part leaves the
    scene or does not fit, 4 no pose was found. With --states: 0 each state has a row, whatever the
    results; 1 some rows are errors.
    """
    if options.states is not None:
        keywords = {
            "reach": options.reach,
            "keep": options.keep or (),
            "nearest": options.nearest,
            "ease": options.ease,
            "require": options.require,
        }
        return settle_many(
            asked, options.states, keywords,
            processes=options.processes, json=options.json, output=options.output,
        )  # fmt: skip
    from kilter.analysis.settled_pose.settle import settle as find
    from kilter.tell.text import text_of

    if options.output is not None:
        require_pose_form(options.output, asked)
    asked.apart(options.output)
    asked, key = with_key(asked, options.output)
    told = ""
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        answer = find(
            assembly,
            reach=options.reach,
            keep=options.keep or (),
            nearest=options.nearest,
            ease=options.ease,
            require=options.require,
            **asked.shared(find, contacts, progress),
        )
        data = answer.to_dict()
        rests = answer.resting is not None
        if options.output is not None and (rests or options.output.suffix in PICTURES):
            progress("output")
            told = write_pose(answer, asked, options.output, key)
    posed = replace(asked, reading=_proved_reading(asked, answer))
    options_of = posed.reading.options()
    after = posed.keep_proof(answer.proof if rests else None, data, options_of)
    tell_warnings(data["warnings"], asked.quiet or options.json)
    if options.json:
        emit(as_json(data), None)
    else:
        emit(text_of(data) + after, None)
    if options.output is not None and rests:
        tell_written(options.output, _with_place("pose at rest", told), asked.quiet)
    elif options.output is not None and options.output.suffix not in PICTURES:
        tell_warnings([f"{options.output} was not written: no pose at rest was found"], asked.quiet)
    if answer.at_rest:
        return HOLDS
    if answer.state == "partly":
        return SETTLE["falls"] if answer.leaves or answer.depth else SETTLE["not-found"]
    return LOWER if answer.state == "at-rest" else SETTLE[answer.state]


def _with_place(content: str, place: str) -> str:
    """Words about a written file: its content, and the place of the poses in it."""
    return f"{content}: {place}" if place else content


def require_pose_form(output: Path, asked: Asked) -> None:
    """Raise an error if an output file has an unknown ending or an unsuitable place."""
    suffix = output.suffix.lower()
    if suffix in PICTURES:
        from kilter.publish import require_figure

        require_figure(output, None)
    elif output.name.endswith(".kilter.json"):
        if asked.file == "-":
            raise InputError(
                "choices about standard input cannot be written", hint="give a file or a folder"
            )
        from kilter.files.own.choices_writing import choices_about, require_place

        require_place(output)
        source = asked.source or Path(asked.file)
        if source.exists():
            choices_about(source, output.parent, {})
    elif suffix in USD and (asked.source or Path(asked.file)).suffix.lower() not in (*USD, ".usdz"):
        raise InputError(
            "a USD layer moves the objects of a USD file, and the input is another file",
            file=str(output),
            hint="write the pose to X.kilter.json, X.xml, X.glb or X.json",
        )
    elif suffix not in (".xml", ".npy", ".glb", ".json", *USD):
        raise InputError(
            f"{suffix or 'a file without ending'} is no format of a pose", file=str(output),
            hint="give X.kilter.json, X.xml, X.npy, X.glb, X.usda, X.json, X.svg or X.png",
        )  # fmt: skip


def _with_poses(asked: Asked, answer: Settled | SceneReport) -> Reading:
    """The options of reading with the settled poses of all moved parts."""
    from kilter.files.own.saved_entries import changed_poses

    poses = changed_poses(_drawn(answer), answer.assembly)
    entries = {**asked.reading.entries}
    if poses:
        entries["poses"] = {**entries.get("poses", {}), **poses}
    return replace(asked.reading, entries=entries)


def _proved_reading(asked: Asked, answer: Settled) -> Reading:
    """The options of reading with the settled poses, without the parts that are not at rest."""
    reading = _with_poses(asked, answer)
    if answer.resting is None or len(answer.resting) == len(answer.assembly):
        return reading
    left_out = [name for name in answer.assembly.names if name not in answer.resting.index]
    kept = {k: v for k, v in reading.entries.get("poses", {}).items() if k not in left_out}
    entries = {key: value for key, value in reading.entries.items() if key != "poses"}
    entries |= {"poses": kept} if kept else {}
    return replace(reading, entries=entries, without=(*reading.without, *left_out))


def _drawn(answer: Settled | SceneReport) -> Assembly:
    """The assembly before the movement."""
    return answer.assembly if answer.drawn is None else answer.drawn


def write_pose(
    answer: Settled | SceneReport, asked: Asked, output: Path, key: str | None = None
) -> str:
    """Write the pose in the format that the ending of the file names.

    Arguments: `key`: keyframe of an MJCF file to write. Returns words about the place of the poses
    in the file, or none.
    """
    suffix = output.suffix.lower()
    if suffix in PICTURES:
        from kilter.analysis.scene_states.scene_report import SceneReport
        from kilter.publish import draw

        draw(answer.assembly if isinstance(answer, SceneReport) else answer, output)
    elif output.name.endswith(".kilter.json"):
        _write_kilter(answer, asked, output)
    elif suffix in (".xml", ".npy"):
        lost = {*getattr(answer, "leaves", ()), *getattr(answer, "parts", ())}
        return write_simulator_pose(answer.assembly, lost, asked, output, key)
    elif suffix == ".glb":
        from kilter.files import write_bytes
        from kilter.show.glb_film import Film

        write_bytes(output, Film(answer.assembly).to_bytes("pose at rest"))
    elif suffix in USD:
        from kilter.files.usd.usd_assembly import write_usd_poses

        source = asked.source or Path(asked.file)
        write_usd_poses(source, output, _drawn(answer), answer.assembly)
    else:
        from kilter.files.compas_files import to_compas

        write_whole(output, to_compas(answer.assembly))
    return ""


def _write_kilter(answer: Settled | SceneReport, asked: Asked, output: Path) -> None:
    """Write choices with the new poses; the complete assembly if choices cannot express the pose.

    Points of loads, joints and bonds move with their parts, which choices do not state.
    """
    drawn, settled = _drawn(answer), answer.assembly
    entries = ("loads", "joints", "bonds")
    if any(getattr(drawn, name) != getattr(settled, name) for name in entries):
        from kilter.files import dump

        dump(settled, output)
        return
    from kilter.loading import save_reading

    source = asked.source or Path(asked.file)
    save_reading(source, output, _with_poses(asked, answer), asked.all_touch.saved())


# The command `scene`: the state of each object of a scene.


@dataclass(frozen=True, kw_only=True)
class SceneOptions:
    """Options of `scene`."""

    require: str = Require()
    settle: bool = option(
        "--settle",
        "First bring the objects to rest, as 'kilter settle' does. With -o, the settled scene is "
        "written: X.usda (a layer over a USD file), X.kilter.json, X.xml (MJCF), X.npy (poses "
        "only: qpos for MJCF), X.glb.",
    )


@asks(searches=True, writes=tuple(OTHER_FILES))
def scene(asked: Asked, options: SceneOptions) -> int:
    """Report for each object of a scene whether it is at rest, floats, overlaps or falls.

    Objects that touch each other form a cluster, and each cluster is judged by itself. Held are the
    static bodies of the file, the parts of --ground, and the table of --floor.

    Exit code: 0 every object is at rest at the level of --require; 1 some objects float, overlap or
    fall; 3 some are at rest only at a lower level; 4 some are open.
    """
    from kilter.analysis.scene_states.object_states import scene as find

    output = asked.output if options.settle else None
    if not options.settle:
        require_answer_file(asked.output)
    if output is not None:
        require_pose_form(output, asked)
    asked, key = with_key(asked, output)
    told = ""
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        report = find(
            assembly,
            require=options.require,
            settle=options.settle,
            **asked.shared(find, contacts, progress),
        )
        if output is not None:
            told = write_pose(report, asked, output, key)
    if options.settle:
        asked = replace(asked, output=None)
    asked.tell(report.to_dict())
    tell_written(output, _with_place("settled scene", told), asked.quiet)
    if report.faults:
        return SCENE["faults"]
    if any(entry.state == "open" for entry in report):
        return SCENE["open"]
    return HOLDS if report.at_rest else LOWER
