"""Commands of kilter."""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from kilter.cli.draw import draw
from kilter.cli.margins import margin
from kilter.cli.options import (
    Angle,
    Budget,
    Clearance,
    Density,
    Down,
    Fasten,
    File,
    Floor,
    Friction,
    Gap,
    Ground,
    Json,
    Loose,
    Output,
    Quiet,
    Units,
    Without,
)
from kilter.cli.output import (
    Progress,
    as_json,
    emit,
    keep_apart,
    read_json,
    tell_warnings,
    write_whole,
)
from kilter.cli.reading import (
    LOWEST,
    Reading,
    contact_tolerance,
    read_assembly,
    reading_of,
)
from kilter.cli.reading import fasten as join_touching
from kilter.cli.report import report, view
from kilter.cli.turning import orient, region
from kilter.errors import InputError

__all__ = ["command", "with_floor_value"]

EXIT = {"stable": 0, "unstable": 1, "potentially-stable": 3, "undecided": 4}


app = typer.Typer(
    name="kilter",
    help="Does an assembly of rigid parts stay together under gravity? An exact verdict, with a "
    "proof. All answers are of first order: where motions that cost no energy to first order "
    "are left (see 'neutral'), second order decides, a ball on a ball among them.",
    add_completion=False,
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def command() -> Any:
    """The command with its subcommands."""
    return typer.main.get_command(app)


def with_floor_value(words: list[str]) -> list[str]:
    """``--floor`` with its value filled in where it stands alone.

    Examples
    --------
    >>> with_floor_value(["--floor", "a.stl"]), with_floor_value(["--floor", "-0.5"])
    (['--floor=lowest', 'a.stl'], ['--floor=-0.5'])
    """
    result: list[str] = []
    rest = iter(range(len(words)))
    for k in rest:
        if words[k] == "--":
            return result + words[k:]
        if words[k] != "--floor":
            result.append(words[k])
            continue
        following = words[k + 1] if k + 1 < len(words) else ""
        if _is_number(following) and not Path(following).exists():
            result.append(f"--floor={following}")
            next(rest)
        else:
            result.append(f"--floor={LOWEST}")
    return result


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _version(wanted: bool) -> None:
    if wanted:
        import kilter

        print(f"kilter {kilter.__version__}")
        raise typer.Exit


@app.callback()
def kilter_options(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Options of kilter itself; without a command, the help is shown."""
    if context.invoked_subcommand is None:
        print(context.get_help())


@app.command()
def check(
    file: File,
    ground: Ground = None,
    floor: Floor = None,
    without: Without = None,
    down: Down = None,
    friction: Friction = None,
    units: Units = None,
    density: Density = None,
    fasten: Fasten = None,
    gap: Gap = None,
    angle: Angle = None,
    clearance: Clearance = None,
    loose: Loose = False,
    proof: Annotated[
        Path | None,
        typer.Option(
            "--proof",
            metavar="P.json",
            help="Write the proof here; 'kilter verify FILE P.json' rechecks it.",
            rich_help_panel="Form of the answer",
            show_default=False,
        ),
    ] = None,
    budget: Budget = 10.0,
    forces: Annotated[
        bool,
        typer.Option(
            "--forces",
            help="List the contact forces of equilibrium, the greatest first.",
            rich_help_panel="Form of the answer",
        ),
    ] = False,
    suggest: Annotated[
        bool,
        typer.Option(
            "--suggest-joints",
            help="List pairs that look like fasteners, each with the joint to add.",
            rich_help_panel="Form of the answer",
        ),
    ] = False,
    json: Json = False,
    output: Output = None,
    quiet: Quiet = False,
) -> int:
    """Does it stay together under gravity; if not, what moves, and how?

    Exit 0 stable, 1 unstable, 3 potentially stable (friction can hold it, but need not), 4
    undecided. All of it is of first order.

    Displacements of LP (9) are given for up to 300 free parts, neutral motions for up to 100.
    """
    from kilter.analysis.check import check as decide
    from kilter.contact.fits.suggestions import suggest_joints

    keep_apart(file, proof, output)
    if not (math.isfinite(budget) and budget >= 0):
        raise InputError(f"--budget is {budget}", hint="give seconds, 0 or more")
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    with Progress(quiet) as progress:
        started = time.perf_counter()
        progress("reading")
        assembly = read_assembly(file, reading)
        _ = assembly.geometry
        read = time.perf_counter() - started
        tolerance = contact_tolerance(gap, angle, loose, clearance)
        assembly, found = join_touching(assembly, reading, tolerance, progress)
        joining = time.perf_counter() - started - read
        verdict = decide(
            assembly, contacts=found, tolerance=tolerance, budget=budget, progress=progress
        )
        progress("motion")
        _ = verdict.motion, verdict.displacement, verdict.neutral, verdict.forces
    total = time.perf_counter() - started
    touching = verdict.seconds["contacts"] + joining
    verdict = verdict.with_seconds(contacts=touching, read=read, total=total)
    if proof is not None and verdict.certificate is not None:
        write_whole(proof, as_json(verdict.proof(options=reading.options())))
    caution = [verdict.barely] if verdict.barely else []
    if proof is not None and verdict.certificate is None and proof.exists():
        caution.append(f"undecided: no proof to write, {proof} is left as it was")
    tell_warnings([*verdict.warnings, *caution], quiet or json)
    suggestions = suggest_joints(verdict.assembly, verdict.contacts) if suggest else []
    if json:
        answer = verdict.to_dict()
        if suggest:
            answer["suggested_joints"] = [one.to_dict() for one in suggestions]
        emit(as_json(answer), output)
    else:
        from kilter.tell.tables import forces_table
        from kilter.tell.text import suggestions_text, text_of

        answer = verdict.to_dict()
        text = text_of(answer, *([forces_table(answer)] if forces else []))
        if suggest:
            text += "\n\n" + suggestions_text([one.to_dict() for one in suggestions])
        if proof is not None:
            written = f"written to {proof}" if verdict.certificate else "none to write"
            text += f"\nproof file   {written}"
        emit(text, output)
    return EXIT[verdict.verdict]


app.command()(orient)
app.command()(region)
app.command()(margin)
app.command()(report)
app.command()(view)
app.command()(draw)


@app.command()
def contacts(
    file: File,
    ground: Ground = None,
    floor: Floor = None,
    without: Without = None,
    down: Down = None,
    friction: Friction = None,
    units: Units = None,
    density: Density = None,
    fasten: Fasten = None,
    gap: Gap = None,
    angle: Angle = None,
    clearance: Clearance = None,
    loose: Loose = False,
    json: Json = False,
    output: Output = None,
    quiet: Quiet = False,
) -> int:
    """What touches: patches with area, gap, normal; what came near, and why it does not count."""
    from kilter.contact import find_contacts

    keep_apart(file, output)
    reading = reading_of(ground, floor, without, down, friction, units, density, fasten)
    with Progress(quiet) as progress:
        progress("reading")
        assembly = read_assembly(file, reading)
        tolerance = contact_tolerance(gap, angle, loose, clearance)
        assembly, known = join_touching(assembly, reading, tolerance, progress)
        found = known or find_contacts(assembly, tolerance=tolerance, progress=progress)
    warnings = [*assembly.notes, *assembly.geometry.warnings, *found.warnings]
    tell_warnings(warnings, quiet or json)
    from kilter.tell.text import text_of

    emit(as_json(found.to_dict()) if json else text_of(found.to_dict()), output)
    return 0


@app.command()
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
    from kilter.contact import find_contacts
    from kilter.mechanics.verification import proof_tolerance, verify_proof

    keep_apart(file, output)
    data = read_json(proof, "proof file")
    if not isinstance(data, dict) or "kilter_proof" not in data:
        raise InputError("is no proof", file=proof, hint="give a file of kilter check --proof")
    try:
        reading = Reading.from_options(data.get("options", {}))
        tolerance = proof_tolerance(data)
        with Progress(quiet) as progress:
            progress("reading")
            assembly = read_assembly(file, reading)
            assembly, known = join_touching(assembly, reading, tolerance, progress)
            found = known or find_contacts(assembly, tolerance=tolerance, progress=progress)
            result = verify_proof(assembly, found, data)
    except InputError as error:
        raise error.located(file=proof) from None
    from kilter.tell.text import text_of

    answer = {
        "holds": result.holds,
        "verdict": result.verdict,
        "residual": result.residual,
        "power": result.power,
        "reasons": list(result.reasons),
        "notes": list(result.notes),
        "held": [part.name for part in assembly.parts if part.grounded],
        "gravity": assembly.gravity.tolist(),
        "units": assembly.units,
        "options": reading.options(),
        "tolerance": data["tolerance"],
    }
    emit(as_json(answer) if json else text_of(answer), output)
    return 0 if result.holds else 1


@app.command()
def example(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="Example to write; without it, all are listed."),
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
        if json:
            listed = [
                {"name": s.name, "title": s.title, "source": s.source, "answer": s.answer}
                for s in SCENES.values()
            ]
            emit(as_json(listed), output)
        else:
            from kilter.tell.text import aligned

            rows = [[s.name, s.answer or "", s.title] for s in SCENES.values()]
            emit("\n".join(aligned(rows)), output)
        return 0
    from kilter.files import to_text

    text = to_text(scene(name))
    if output is not None and str(output) == "-":
        sys.stdout.write(text)
        return 0
    target = output or Path(f"{name}.kilter.json")
    if target.exists() and not force:
        raise InputError("is there already", file=str(target), hint="add --force to replace it")
    write_whole(target, text)
    print(f"{target}: {SCENES[name].title}")
    print(f"next: kilter check {target}")
    return 0
