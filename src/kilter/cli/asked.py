"""What a command was asked: a file, how it is read, when faces touch, and where answers go."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.cli.arguments import contact_tolerance, reading_of
from kilter.cli.colour import in_colour
from kilter.cli.output import as_json, emit, keep_apart, tell_warnings, write_whole
from kilter.errors import InputError, shell_words
from kilter.files.formats import EXACT
from kilter.files.reading import LOWEST, Reading

if TYPE_CHECKING:
    from collections.abc import Callable

    from kilter.assembly import Assembly
    from kilter.contact import ContactSet, Tolerance
    from kilter.tell.tables import Table

__all__ = ["Asked"]


@dataclass(frozen=True, slots=True)
class Asked:
    """The options that commands share.

    Attributes
    ----------
    file : str
    reading : Reading
    tolerance : Tolerance
    touch : tuple of str
        The options of the tolerance, as they are typed.
    effort : float
    time_limit : float or None
        [s]
    json, quiet, verbose : bool
    output, proof : Path or None
    """

    file: str
    reading: Reading
    tolerance: Tolerance
    touch: tuple[str, ...]
    effort: float
    time_limit: float | None
    json: bool
    output: Path | None
    proof: Path | None
    quiet: bool
    verbose: bool

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Asked:
        """From the values of the options.

        Raises
        ------
        InputError
            If a value makes no sense, or the answer would be written over the file.
        """
        reading = reading_of(
            *(given[key] for key in ("ground", "floor", "without", "down", "friction")),
            *(given[key] for key in ("units", "density")),
            *(given[key] for key in ("fasten", "fasten_suggested", "fasten_overlaps")),
            *(given[key] for key in ("up", "contacts", "keyframe", "base")),
            *(given[key] for key in ("stud_pull", "stud_shear", "brick_sides", "bond")),
        )
        gap, angle, clearance = (given[key] for key in ("gap", "angle", "clearance"))
        effort = _at_least_none(given.get("effort", 0.0), "--effort", "N")
        limit = given.get("time_limit")
        words = [
            word
            for name, value in (("gap", gap), ("angle", angle), ("clearance", clearance))
            if value is not None
            for word in (f"--{name}", f"{value:g}")
        ]
        asked = cls(
            file=given.get("file", ""),
            reading=reading,
            tolerance=contact_tolerance(gap, angle, given["loose"], clearance),
            touch=(*words, *(["--loose"] if given["loose"] else [])),
            effort=effort,
            time_limit=None if limit is None else _at_least_none(limit, "--time-limit", "SECONDS"),
            json=given.get("json", False),
            output=given.get("output"),
            proof=given.get("proof"),
            quiet=given["quiet"],
            verbose=given.get("verbose", False),
        )
        asked.apart()
        return asked

    def of_file(self, file: str) -> Asked:
        """The same of another file."""
        asked = replace(self, file=file)
        asked.apart()
        return asked

    def apart(self, *outputs: Path | None) -> None:
        """Refuse to write over the file, or two answers to one file."""
        keep_apart(self.file or "-", self.output, self.proof, *outputs)

    def read(self, progress: Callable[[str], None]) -> tuple[Assembly, ContactSet | None]:
        """The assembly, and its contacts where they had to be found to read it."""
        from kilter.contact.fits.fastening import fasten_as_read

        progress("reading")
        if Path(self.file).suffix.lower() in EXACT:  # while OCCT reads, what is needed next
            import manifold3d  # noqa: F401
            import shapely  # noqa: F401

            import kilter.analysis.check
            import kilter.solvers.highs  # noqa: F401
        assembly = self.reading.read(self.file, progress=progress)
        return fasten_as_read(assembly, self.reading, tolerance=self.tolerance, progress=progress)

    def keep_proof(self, made: Callable[..., dict[str, Any]] | None, answer: dict[str, Any]) -> str:
        """Write the proof where that was asked for; the line that says so.

        Parameters
        ----------
        made : callable or None
            Gives the proof, from the options of reading; None where there is none.
        answer : dict
            Gets a warning where a file of an earlier proof stays.
        """
        if self.proof is None:
            return ""
        if made is not None:
            write_whole(self.proof, as_json(made(options=self.reading.options())))
            return f"\nproof file   written to {self.proof}"
        if self.proof.exists():
            caution = f"there is no proof to write: {self.proof} is left as it was"
            answer["warnings"] = [*answer.get("warnings", ()), caution]
        return "\nproof file   none to write"

    def tell(
        self,
        answer: Mapping[str, Any],
        *more: Table,
        after: str = "",
        typed: Sequence[str] = (),
        bricks: bool = False,
    ) -> None:
        """Warnings on the error stream, the answer as JSON or as text.

        Parameters
        ----------
        answer : mapping
            The data of an answer.
        *more : Table
            Lists that were asked for; of the text alone.
        after : str
            What the text ends with; else it is the next step to take.
        typed : sequence of str
            Options of the command beside those of reading, for a next step of the same name.
        bricks : bool
            Whether it is about a model of bricks, for the next step.
        """
        from kilter.tell.text import text_of

        tell_warnings(answer.get("warnings", ()), self.quiet or self.json)
        if self.json:
            emit(as_json(answer), self.output)
            return
        text = text_of(answer, *more, brief=not self.verbose) + after
        text += "" if "\n\n" in after else self._next(answer, typed, bricks)
        emit(text if self.output else in_colour(text, answer), self.output)

    def _next(self, answer: Mapping[str, Any], typed: Sequence[str], bricks: bool) -> str:
        """The next step to take, as it is typed; none of what was piped in."""
        from kilter.tell.facts import kind_of
        from kilter.tell.next_step import next_step

        step = (
            None
            if self.file in ("", "-")
            else next_step(answer, Path(self.file).stem.split(".")[0], bricks=bricks)
        )
        if step is None:
            return ""
        name, *rest = step.words
        asked = self
        if "--down" in rest:
            asked = replace(self, reading=replace(self.reading, down=None))
        words = asked.command(name, *(typed if name == kind_of(answer) else ()), *rest)
        return f"\n\nnext: {words}\n      {step.why}"

    def command(self, name: str, *rest: str) -> str:
        """The command, as it is typed."""
        found: list[str] = []
        for key, value in self.reading.options().items():
            option = f"--{key.replace('_', '-')}"
            if key == "floor":
                found += ["--floor"] if value == LOWEST else ["--floor", str(value)]
            elif key == "down":
                found += ["--down", *(repr(float(v)).removesuffix(".0") for v in value)]
            elif key == "fasten":
                found += [word for pair in value for word in ("--fasten", *pair)]
            elif key == "bond":
                found += [word for a, b, pull in value for word in ("--bond", a, b, f"{pull:.15g}")]
            elif value is True:
                found.append(option)
            elif isinstance(value, list):
                found += [word for one in value for word in (option, str(one))]
            else:
                found += [option, f"{value:g}" if isinstance(value, float) else str(value)]
        return shell_words(["kilter", name, self.file, *found, *self.touch, *rest])


def _at_least_none(value: float, option: str, what: str) -> float:
    """Refuse what is no number of work or time."""
    if not (math.isfinite(value) and value >= 0):
        raise InputError(f"{option} is {value:g}", hint=f"give {option} {what}, 0 or more")
    return value
