"""The commands `check`, `contacts`, `verify` and `example`."""

from __future__ import annotations

import re
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.asked import Asked, check_each, code_of
from kilter.cli.exit_codes import HOLDS, INVALID, LOWER, WRITTEN
from kilter.cli.options import (
    FORM,
    File,
    Files,
    Json,
    Move,
    Output,
    Quiet,
    Require,
    TurnSupport,
    asks,
    takes,
)
from kilter.cli.output import (
    Progress,
    as_json,
    emit,
    keep_apart,
    tell_written,
    write_whole,
    writes_json,
)
from kilter.cli.quantities import moved_supports, number_of
from kilter.errors import InputError, visible
from kilter.values.declaration import argument, option

if TYPE_CHECKING:
    from kilter.analysis.support_movement import SupportMovement
    from kilter.analysis.verdict.verdict import Verdict


RANGED = 200
"""Largest number of contact patches for which --forces lists the range of every pair."""
SMALL = 400
"""Largest number of parts of an example whose verdict is printed when it is written."""


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """Options of `check`."""

    files: list[str] = Files()
    require: str = Require()
    measures: bool = option(
        "--measures",
        "With friction: also compute z, kappa and the displacements of the displacement "
        "program, which ignore friction.",
        FORM,
    )
    forces: bool = option(
        "--forces",
        "List the least and the greatest force of each pair that touches, and one possible set of "
        "contact forces.",
        FORM,
    )
    between: list[tuple[str, str]] | None = option(
        "--between A B",
        "Least and greatest force between two parts. Repeatable; NAME all for the whole force on a "
        "held part.",
        FORM,
    )
    along: str | None = option(
        "--along x|y|z|X,Y,Z",
        "With --forces or --between: the force on the second part along this axis, in place of the "
        "normal force.",
        FORM,
    )
    moment: str | None = option(
        "--moment x|y|z|X,Y,Z",
        "With --forces or --between: the moment on the second part about this axis through its "
        "centre of mass, in N m.",
        FORM,
    )
    range_proof: Path | None = option(
        "--range-proof FILE",
        "With --forces or --between: write proofs of both ends of each range, for kilter verify.",
        FORM,
    )
    move: list[str] | None = Move()
    turn_support: list[str] | None = TurnSupport()
    watch: bool = option(
        "--watch",
        "Check a single file anew whenever it is saved, and state what changed; Ctrl-C ends it.",
        FORM,
    )
    suggest: bool = option(
        "--suggest-joints", "List the pairs that look fastened, each with the joint to add.", FORM
    )


@asks(searches=True, proves=True)
def check(asked: Asked, options: CheckOptions) -> int:
    """Decide whether an assembly stays together under gravity, and if not, which parts move.

    The verdict is of first order. If motions without any first-order change of energy remain (see
    'neutral'), they are also decided to second order: a ball on top of a ball is balanced.

    Exit code: 0 it holds at the level of --require, 3 it holds only at a lower level, 1 unstable,
    4 undecided. For several files a line each, and the worst exit code.

    Levels: equilibrium (forces that hold it exist), settles (put down loosely it comes to rest, and
    no motion was found), proved (no motion can start, to first order), strict (also a small push
    does not make it fall).

    Displacements are computed for up to 300 free parts, neutral motions for up to 100, and second
    order for up to 20.
    """
    if len(options.files) > 1:
        moved = options.move or options.turn_support or options.range_proof
        single = options.forces or options.between or options.suggest or options.watch or moved
        if asked.proof is not None or single:
            alone = (
                "--proof"
                if asked.proof is not None
                else "--forces, --between, --range-proof, --move, --turn-support, "
                "--suggest-joints, --watch"
            )
            raise InputError(
                f"{len(options.files)} files are given", hint=f"give a single file with {alone}"
            )
        return check_each(asked, options.files, lambda each: _check_file(each, options)[1])
    if options.watch:
        from kilter.cli.watching import watch_file

        return watch_file(options.files[0], lambda file: _tell_check(asked.of_file(file), options))
    return _tell_check(asked.of_file(options.files[0]), options)[0]


def _tell_check(asked: Asked, options: CheckOptions) -> tuple[int, dict[str, Any]]:
    """Check a file and print the answer; return the exit code and the answer."""
    from kilter.contact.fits.suggestions import suggest_joints
    from kilter.tell.tables import forces_table, movement_tables, ranges_table
    from kilter.tell.text import suggestions_text

    question = _range_question(options)
    asked.apart(options.range_proof)
    verdict, answer = _check_file(asked, options)
    after = asked.keep_proof(None if verdict.evidence is None else verdict.proof, answer)
    if options.suggest:
        joints = suggest_joints(verdict.assembly, verdict.contact_set)
        answer["suggested_joints"] = [joint.to_dict() for joint in joints]
        after = "\n\n" + suggestions_text(answer["suggested_joints"]) + after
    crowded = bool(verdict.assembly.bonds) or len(verdict.contact_set) > RANGED
    ranges = None
    if options.between or (options.forces and not crowded):
        ranges = verdict.force_ranges(**question)
    if ranges is not None:
        answer["ranges"] = [one.to_dict() for one in ranges]
    if options.range_proof is not None:
        if ranges:
            write_whole(options.range_proof, as_json(verdict.range_proofs(ranges)))
            after += f"\nproof file   ranges written to {options.range_proof}"
        else:
            none = "name pairs with --between" if ranges is None else "no equilibrium is known"
            after += f"\nproof file   ranges not written: {none}"
    movement = _movement(verdict, options)
    if movement is not None:
        answer["movement"] = movement.to_dict()
    bricks = any(part.brick is not None for part in verdict.assembly.parts)
    tables = [] if ranges is None else [ranges_table(answer)]
    tables += [] if movement is None else movement_tables(answer)
    tables += [forces_table(answer)] if options.forces else []
    asked.tell(answer, *tables, after=after, bricks=bricks)
    return code_of(answer), answer


def _range_question(options: CheckOptions) -> dict[str, Any]:
    """Pairs and axes of the ranges that the options ask for; without --between, all pairs.

    Raises `InputError` if an option of ranges is given without ranges.
    """
    for name in ("along", "moment", "range_proof"):
        if getattr(options, name) is not None and not (options.forces or options.between):
            word = name.replace("_", "-")
            raise InputError(f"--{word} needs forces", hint="add --forces, or --between A B")
    axes = {name: getattr(options, name) for name in ("along", "moment")}
    given = {name: _axis(name, text) for name, text in axes.items() if text is not None}
    pairs = [(a,) if b == "all" else (a, b) for a, b in options.between or ()]
    return {"between": pairs or None, **given}


def _movement(verdict: Verdict, options: CheckOptions) -> SupportMovement | None:
    """The movement of supports that the options ask for; None if they ask for none."""
    if not options.move and not options.turn_support:
        return None
    return verdict.support_movement(*moved_supports(options.move, options.turn_support))


def _axis(option: str, text: str) -> list[float]:
    """The axis of an option; its words are x, y, z or three numbers."""
    if text in ("x", "y", "z"):
        return [float(text == name) for name in "xyz"]
    numbers = [number_of(word) for word in text.split(",")]
    if len(numbers) != 3 or None in numbers or not any(numbers):
        raise InputError(f"--{option} is {text!r:.40}", hint="give x, y, z, or X,Y,Z")
    return [float(number) for number in numbers if number is not None]


def _check_file(asked: Asked, options: CheckOptions) -> tuple[Verdict, dict[str, Any]]:
    """Check a single file; return its verdict, and the answer with the reading time."""
    from kilter.analysis.check import check as decide

    with Progress(asked.quiet) as progress:
        started = time.perf_counter()
        assembly, contact_set = asked.read(progress)
        _ = assembly.geometry
        read = time.perf_counter() - started
        verdict = decide(
            assembly,
            require=options.require,
            measures=options.measures,
            **asked.shared(decide, contact_set, progress),
        )
        progress("motion")
        answer = verdict.to_dict()
    answer["seconds"] |= {"read": read, "total": time.perf_counter() - started}
    return verdict, answer


@asks()
def contacts(asked: Asked) -> int:
    """List the contact patches with area, gap and normal, and near pairs that do not count."""
    from kilter.contact import contacts as find

    with Progress(asked.quiet) as progress:
        assembly, known = asked.read(progress)
        contact_set = known or find(assembly, **asked.shared(find, None, progress))
    asked.tell(contact_set.to_dict())
    return WRITTEN


@dataclass(frozen=True, kw_only=True)
class VerifyOptions:
    """Options of `verify`."""

    file: str = File()
    proof: str = argument("P.json", "A proof written by the option --proof.")
    require: str | None = option(
        "--require LEVEL",
        "Level that the proof must reach: equilibrium, settles, proved, strict; by default "
        "the level that it claims. Other commands require settles, because they compute a "
        "level and claim none.",
    )
    json: bool = Json()
    output: Path | None = Output()
    quiet: bool = Quiet()


@takes
def verify(options: VerifyOptions) -> int:
    """Recompute a proof from the file. Exit code 0: it holds, 3: at a lower level only, 1: no.

    No solver is used, except for the claim that an assembly settles: its search is repeated.
    The file is read with the options of the proof (held parts, parts left out, direction of
    gravity). The answer lists these options.
    """
    from kilter.analysis.verification import verify as recompute
    from kilter.tell.text import text_of

    keep_apart(options.file, options.output)
    with Progress(options.quiet) as progress:
        result = recompute(options.file, options.proof, require=options.require, progress=progress)
    answer = result.to_dict()
    as_data = writes_json(options.json, options.output)
    emit(as_json(answer) if as_data else text_of(answer), options.output)
    tell_written(
        options.output, f"answer of verify as {'JSON' if as_data else 'text'}", options.quiet
    )
    if result.holds:
        return HOLDS
    return INVALID if result.reasons or result.level is None else LOWER


@dataclass(frozen=True, kw_only=True)
class ExampleOptions:
    """Options of `example`."""

    name: str | None = argument(
        "[NAME]", "Example to write. Without a name all examples are listed.", default=None
    )
    size: str | None = option(
        "--size BRICKSxCOURSES",
        "Walls only: number of bricks in a course, and of courses, as 40x25.",
    )
    output: Path | None = option(
        "-o --output FILE",
        "File to write, or - for standard output; NAME.kilter.json in this folder by default.",
    )
    force: bool = option("--force", "Replace an existing file.")
    json: bool = Json()


@takes
def example(options: ExampleOptions) -> int:
    """List the built-in examples, or write one as an assembly file.

    The drawings, tables and models of the guides are examples, too; they are copied.

    For an example of up to 400 parts the verdict of 'kilter check' is printed, too.
    """
    from kilter.analysis.check import check as decide
    from kilter.cli.guide import shipped
    from kilter.scenes import SCENES, scene

    if options.name is None:
        if options.size is not None:
            raise InputError("--size needs an example", hint="name it: kilter example wall")
        if options.json:
            emit(as_json([entry.to_dict() for entry in SCENES.values()]), options.output)
        else:
            from kilter.tell.text import aligned

            rows = [[entry.name, entry.answer, entry.title] for entry in SCENES.values()]
            rows += [[name, "file", "a file of a guide: kilter help"] for name in shipped()]
            emit("\n".join(aligned(rows)), options.output)
        tell_written(options.output, "list of the examples", quiet=False)
        return WRITTEN
    if options.name in shipped() and options.size is None:
        target = options.output or Path(options.name)
        _write_example(target, shipped()[options.name].read_bytes(), options.force)
        print(f"{visible(str(target))}: written")
        return WRITTEN
    from kilter.files import to_text

    assembly = scene(options.name, size=None if options.size is None else _size(options.size))
    text = to_text(assembly)
    if options.output is not None and str(options.output) == "-":
        sys.stdout.write(text)
        return WRITTEN
    target = options.output or Path(f"{options.name}.kilter.json")
    _write_example(target, text.encode(), options.force)
    print(f"{visible(str(target))}: {SCENES[options.name].title}")
    if len(assembly) <= SMALL:
        with Progress(quiet=False) as progress:
            print(decide(assembly, progress=progress).sentence)
    print(f"next: kilter check {visible(str(target))}")
    return WRITTEN


def _write_example(target: Path, content: bytes, force: bool) -> None:
    """Write an example, unless the file has this content already."""
    from kilter.files import write_bytes

    if target.exists() and not force:
        if target.is_file() and target.read_bytes() == content:
            return
        raise InputError(
            "already exists with another content",
            file=str(target),
            hint="add --force to replace it",
        )
    write_bytes(target, content)


def _size(words: str) -> tuple[int, int]:
    """Parse a size such as 40x25 into two whole numbers."""
    match = re.fullmatch(r"(\d{1,4})x(\d{1,4})", words)
    if match is None:
        raise InputError(f"--size is {words!r:.40}", hint="give it as 40x25")
    return int(match[1]), int(match[2])
