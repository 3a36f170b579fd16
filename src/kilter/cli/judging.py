"""Commands that judge and list: check, contacts, verify, example."""

from __future__ import annotations

import re
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kilter.cli.asked import Asked
from kilter.cli.each import check_each, code_of
from kilter.cli.exit_codes import VERIFY, WRITTEN
from kilter.cli.options import FORM, File, Files, Json, Output, Quiet, Require, asks
from kilter.cli.output import Progress, as_json, emit, keep_apart, write_whole
from kilter.errors import InputError
from kilter.tell.levels import REQUIRE

if TYPE_CHECKING:
    from kilter.analysis.verdict.verdict import Verdict

__all__ = ["check", "contacts", "example", "verify"]


@asks(searches=True, proves=True)
def check(
    asked: Asked,
    files: Files,
    require: Require = REQUIRE,
    measures: Annotated[
        bool,
        typer.Option(
            "--measures",
            help="Also z, kappa and the displacements of LP (9) where friction plays a part; they "
            "leave it out.",
            rich_help_panel=FORM,
        ),
    ] = False,
    forces: Annotated[
        bool,
        typer.Option(
            "--forces",
            help="List the contact forces of equilibrium, the greatest first.",
            rich_help_panel=FORM,
        ),
    ] = False,
    suggest: Annotated[
        bool,
        typer.Option(
            "--suggest-joints",
            help="List pairs that look like fasteners, each with the joint to add.",
            rich_help_panel=FORM,
        ),
    ] = False,
) -> int:
    """Does it stay together under gravity; if not, what moves, and how?

    Exit 0 it holds at the level of --require, 1 unstable, 3 it holds at a lower level only, 4
    undecided; of several files, a line each, the worst. Levels: equilibrium (forces that hold it
    exist), settles (put down loosely it comes to rest, and no motion was found), proved (to first
    order), strict (nor does a small push make it fall).

    Displacements of LP (9) are given for up to 300 free parts, neutral motions for up to 100;
    what second order says of them for up to 20.
    """
    from kilter.contact.fits.suggestions import suggest_joints
    from kilter.tell.tables import forces_table
    from kilter.tell.text import suggestions_text

    if len(files) > 1:
        if asked.proof is not None or forces or suggest:
            alone = "--proof" if asked.proof is not None else "--forces and --suggest-joints"
            raise InputError(f"{len(files)} files are given", hint=f"give one with {alone}")
        return check_each(asked, files, lambda one: _judged(one, require, measures)[1])
    asked = asked.of_file(files[0])
    verdict, answer = _judged(asked, require, measures)
    after = asked.keep_proof(None if verdict.certificate is None else verdict.proof, answer)
    if not suggest and verdict.verdict != "stable" and not asked.json:
        after = _hint(verdict) + after
    if suggest:
        listed = [one.to_dict() for one in suggest_joints(verdict.assembly, verdict.contacts)]
        answer["suggested_joints"] = listed
        after = "\n\n" + suggestions_text(listed) + after
    bricks = any(part.brick is not None for part in verdict.assembly.parts)
    tables = [forces_table(answer)] if forces else []
    asked.tell(answer, *tables, after=after, bricks=bricks)
    return code_of(answer)


def _judged(asked: Asked, require: str, measures: bool) -> tuple[Verdict, dict[str, Any]]:
    """The verdict about a file, and its data with the time that reading took."""
    from kilter.analysis.check import check as decide

    with Progress(asked.quiet) as progress:
        started = time.perf_counter()
        assembly, found = asked.read(progress)
        _ = assembly.geometry
        read = time.perf_counter() - started
        verdict = decide(
            assembly,
            contacts=found,
            tolerance=asked.tolerance,
            require=require,
            measures=measures,
            effort=asked.effort,
            time_limit=asked.time_limit,
            progress=progress,
        )
        progress("motion")
        answer = verdict.to_dict()
    answer["seconds"] |= {"read": read, "total": time.perf_counter() - started}
    return verdict, answer


def _hint(verdict: Verdict) -> str:
    """What looks fastened; of unstable solids that nothing joins, what their file leaves out."""
    from kilter.contact.fits.suggestions import suggest_joints
    from kilter.shape.solid import Solid
    from kilter.tell.text import solids_hint, suggestions_hint

    looks = suggest_joints(verdict.assembly, verdict.contacts)
    firm = [one.kind for one in looks if one.fixed]
    solids = any(isinstance(part.shape, Solid) for part in verdict.assembly.parts)
    if not firm and solids and verdict.verdict == "unstable" and not verdict.assembly.joints:
        return solids_hint(friction=bool(verdict.contacts.patch_mu.any()))
    return suggestions_hint(firm)


@asks()
def contacts(asked: Asked) -> int:
    """What touches: patches with area, gap, normal; what came near, and why it does not count."""
    from kilter.contact import contacts as find

    with Progress(asked.quiet) as progress:
        assembly, known = asked.read(progress)
        found = known or find(assembly, tolerance=asked.tolerance, progress=progress)
    asked.tell(found.to_dict())
    return WRITTEN


def verify(
    file: File,
    proof: Annotated[
        str, typer.Argument(metavar="P.json", help="A proof that 'kilter check --proof' wrote.")
    ],
    json: Json = False,
    output: Output = None,
    quiet: Quiet = False,
) -> int:
    """Recompute a proof from the file, without any solver. Exit 0 it holds, 1 it does not.

    The file is read as it was for the proof (parts held, left out, direction of gravity);
    the answer names these conditions.
    """
    from kilter.analysis.verification import verify as recompute
    from kilter.tell.text import text_of

    keep_apart(file, output)
    with Progress(quiet) as progress:
        result = recompute(file, proof, progress=progress)
    answer = result.to_dict()
    emit(as_json(answer) if json else text_of(answer), output)
    return VERIFY[result.holds]


def example(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="Example to write; without it, all are listed."),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option(
            "--size",
            metavar="BRICKSxCOURSES",
            help="Of a wall: bricks a course and courses, as 40x25.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="Where to; NAME.kilter.json in this folder where not given, "
            "- for standard output.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace a file that is there already.")
    ] = False,
    json: Json = False,
) -> int:
    """List the built-in examples, or write one as an assembly file."""
    from kilter.scenes import SCENES, scene

    if name is None:
        if size is not None:
            raise InputError("--size is of an example", hint="name it: kilter example wall")
        if json:
            emit(as_json([one.to_dict() for one in SCENES.values()]), output)
        else:
            from kilter.tell.text import aligned

            rows = [[one.name, one.answer, one.title] for one in SCENES.values()]
            emit("\n".join(aligned(rows)), output)
        return WRITTEN
    from kilter.files import to_text

    text = to_text(scene(name, size=None if size is None else _size(size)))
    if output is not None and str(output) == "-":
        sys.stdout.write(text)
        return WRITTEN
    target = output or Path(f"{name}.kilter.json")
    if target.exists() and not force:
        raise InputError("is there already", file=str(target), hint="add --force to replace it")
    write_whole(target, text)
    print(f"{target}: {SCENES[name].title}")
    print(f"next: kilter check {target}")
    return WRITTEN


def _size(words: str) -> tuple[int, int]:
    """Two whole numbers with an x between them."""
    found = re.fullmatch(r"(\d{1,4})x(\d{1,4})", words)
    if found is None:
        raise InputError(f"--size is {words!r:.40}", hint="give it as 40x25")
    return int(found[1]), int(found[2])
