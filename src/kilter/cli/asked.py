"""Values of the options that commands share: input file, reading, limits, output."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from inspect import signature
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from kilter.cli.exit_codes import FAULT, HOLDS, LOWER, USAGE, VERDICT
from kilter.cli.interruption import known_words
from kilter.cli.output import (
    as_json,
    emit,
    keep_apart,
    tell_warnings,
    tell_written,
    write_whole,
    writes_json,
)
from kilter.cli.quantities import ToleranceOptions, straps_of
from kilter.errors import (
    NO_MEMORY,
    InputError,
    TimeLimitReached,
    fault_words,
    message_line,
    shell_words,
)
from kilter.files.reading_options import ReadingOptions
from kilter.work import facts_of, stop_after

if TYPE_CHECKING:
    from kilter.assembly import Assembly, Strap
    from kilter.cli.output import Progress
    from kilter.contact import ContactSet, Tolerance
    from kilter.files.reading import Reading
    from kilter.tell.tables import Table


# Import scipy without the submodules of numpy that kilter does not use.


UNUSED = ("char", "core", "ctypeslib", "f2py", "ma", "polynomial", "rec", "strings", "testing")
"""Submodules of numpy that the import of scipy does not need."""


def import_scipy_quickly() -> None:
    """Import `scipy.sparse` while numpy does not list the submodules that scipy does not need."""
    import numpy

    listed, names = getattr(numpy, "__dir__", None), numpy.__all__
    if listed is None or "scipy.sparse" in sys.modules:
        return
    try:
        numpy.__all__ = [name for name in names if name not in UNUSED]
        vars(numpy)["__dir__"] = lambda: [name for name in listed() if name not in UNUSED]
        import scipy.sparse  # noqa: F401
    finally:
        numpy.__all__, vars(numpy)["__dir__"] = names, listed


TOUCHING = ("gap", "angle", "clearance", "loose")
"""Options of the tolerance."""
NOTHING_TYPED = ToleranceOptions()
"""Tolerance options of a command line that has none."""
WORDS_SHARE, MOST_WORDS = 0.2, 1.0
"""Time that is kept for printing the answer: share of a time limit [-], and at most this [s]."""


@dataclass(frozen=True, slots=True)
class Asked:
    """Values of the options that commands share: file, reading, tolerance, limits, output."""

    file: str
    """Path of the assembly, or "-" for standard input."""
    reading: Reading
    """Options of reading the file; those of a file of choices are included."""
    typed: Reading
    """Options of reading, as they are typed."""
    tolerance: Tolerance
    """Tolerance of contact detection."""
    touch: ToleranceOptions
    """Options of the tolerance, as they are typed."""
    effort: float | None
    """Limit of the work of searches with friction; None for a command without."""
    limit: float | None
    """Limit of the time for a file, its reading included [s]."""
    begun: float
    """Time at which the command, or the work on this file, began [s]."""
    json: bool
    output: Path | None
    proof: Path | None
    """Files to write."""
    quiet: bool
    verbose: bool
    """Options of these names."""
    source: Path | None = None
    """The file that a file of choices names; None for a file without choices."""
    notes: tuple[str, ...] = ()
    """Sentences about the choices: replaced keys, a changed file."""
    all_touch: ToleranceOptions = NOTHING_TYPED
    """Options of the tolerance, with those of the choices."""
    straps: Path | None = None
    """File of straps that are added."""
    verb: str = ""
    """Name of the command."""

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Asked:
        """Take the shared options out of the values of all options of a command, by name.

        Raises `InputError` if a value is invalid, or the answer would overwrite the file.
        """
        import_scipy_quickly()
        from kilter.files.own.choices_writing import require_off
        from kilter.files.reading import Reading

        reading = Reading(
            **{each.name: given[each.name] for each in fields(ReadingOptions) if each.name in given}
        )
        touching = [name for name in TOUCHING if given[name] not in (None, False)]
        require_off(reading.off, (), touching)
        entries = {} if given["straps"] is None else straps_of(given["straps"])
        if given["material"]:
            entries["materials"] = list(given["material"])
        if entries:
            reading = replace(reading, entries=entries)
        touch = ToleranceOptions(**{name: given[name] for name in TOUCHING})
        effort = given.get("effort")
        limit = given.get("time_limit")
        asked = cls(
            file=given.get("file", ""),
            reading=reading,
            typed=reading,
            straps=given["straps"],
            tolerance=touch.tolerance(),
            touch=touch,
            effort=None if effort is None else _not_negative(effort, "--effort", "N"),
            limit=None if limit is None else _not_negative(limit, "--time-limit", "SECONDS"),
            begun=perf_counter(),
            json=given.get("json", False),
            output=given.get("output"),
            proof=given.get("proof"),
            quiet=given["quiet"],
            verbose=given.get("verbose", False),
            verb=given.get("verb", ""),
        )
        return asked.of_file(asked.file) if asked.file else asked

    @property
    def time_limit(self) -> float | None:
        """Remaining time for the computation [s]; None without a time limit.

        A share of the limit remains for the words of the answer.
        """
        if self.limit is None:
            return None
        computing = self.limit - min(WORDS_SHARE * self.limit, MOST_WORDS)
        return max(computing - (perf_counter() - self.begun), 0.0)

    def shared(
        self, find: Callable[..., Any], contacts: ContactSet | None, progress: Progress
    ) -> dict[str, Any]:
        """The shared keywords of a function of the Python API, with the values of these options."""
        values = {
            "contacts": contacts,
            "tolerance": self.tolerance,
            "effort": self.effort,
            "time_limit": self.time_limit,
            "progress": progress,
            "assume": self.reading.assume,
        }
        known = signature(find).parameters
        return {
            name: value for name, value in values.items() if name in known and value is not None
        }

    @property
    def writes_json(self) -> bool:
        """Whether the answer is JSON."""
        return writes_json(self.json, self.output)

    def of_file(self, file: str) -> Asked:
        """Copy of these options for another file, whose time limit starts now.

        If the file has choices, the request is about the file that they name, with their options.
        """
        from kilter.files.own.choices import find_choices

        asked = replace(self, file=file, begun=perf_counter())
        asked.apart()
        choices = find_choices(file)
        if choices is None:
            plain = self.typed.without_off()  # a file without choices has nothing to ignore
            return replace(asked, typed=plain, reading=plain, all_touch=self.touch)
        from kilter.files.reading import chosen

        try:
            both = chosen(choices, self.typed)
        except InputError as error:
            raise error.located(file=file) from None
        touch, replaced = self.touch.over(both.choices)
        keep_apart(str(both.path), self.output, self.proof)
        return replace(
            asked,
            reading=both.reading,
            tolerance=touch.tolerance(),
            all_touch=touch,
            source=both.path,
            notes=(*both.notes, *replaced),
        )

    def apart(self, *outputs: Path | None) -> None:
        """Raise an error if an output file would overwrite the input file or another output."""
        keep_apart(self.file or "-", self.output, self.proof, *outputs)

    def read(self, progress: Callable[[str], None]) -> tuple[Assembly, ContactSet | None]:
        """Read the assembly; return it, and its contacts if reading needed them."""
        from kilter.assembly.question import supported
        from kilter.contact.fits.fastening import fasten_as_read
        from kilter.files.formats import EXACT

        progress("reading")
        source = self.source or self.file
        if Path(source).suffix.lower() in EXACT:
            # another process reads the STEP file, so this process loads the next modules meanwhile
            import manifold3d  # noqa: F401
            import shapely  # noqa: F401

            import kilter.analysis.check
            import kilter.solvers.highs  # noqa: F401
        assembly = supported(self.reading.read(source, progress=progress), self.verb)
        report_fact = facts_of(progress)
        if report_fact is not None:
            held = sum(part.grounded for part in assembly.parts)
            report_fact("parts", f"it has {len(assembly)} parts, {held} of them held")
        assembly = replace(assembly, reading=self.reading.options())
        if self.source is not None:
            notes = [*assembly.notes, *self.notes]
            assembly = replace(assembly, notes=notes, tolerance=self.tolerance)
        # joints from incomplete contacts would be wrong, so the limit ends the command here
        with stop_after(self.time_limit):
            return fasten_as_read(
                assembly, self.reading, tolerance=self.tolerance, progress=progress
            )

    def without_straps(self) -> tuple[Asked, list[Strap]]:
        """A copy that does not add the straps of `--straps` to the assembly, and these straps."""
        from kilter.assembly import Strap

        entries = {key: value for key, value in self.reading.entries.items() if key != "straps"}
        straps = [Strap(**entry) for entry in self.reading.entries["straps"]]
        reading = replace(self.reading, entries=entries)
        return replace(self, reading=reading, typed=reading), straps

    def without_acceleration(self) -> tuple[Asked, tuple[str, str, str] | None]:
        """A copy that reads the assembly without `--accelerate`, and the value of this option."""
        reading = replace(self.reading, accelerate=None)
        return replace(self, reading=reading), self.reading.accelerate

    def keep_proof(
        self,
        make: Callable[..., dict[str, Any]] | None,
        answer: Any,
        options: dict[str, Any] | None = None,
    ) -> str:
        """Write the proof file that `--proof` names; return the line for the user about it.

        Arguments: `make`: function that returns the proof; None without a proof; `answer`: data of
        the answer; it gets a warning if the file of an earlier proof remains; `options`: those of
        reading; None: those that the assembly of the proof remembers.
        """
        if self.proof is None:
            return ""
        if make is not None:
            write_whole(self.proof, as_json(make(options=options)))
            return f"\nproof file   written to {self.proof}"
        if self.proof.exists():
            caution = f"this answer has no proof: the earlier file {self.proof} was not changed"
            answer["warnings"] = [*answer["warnings"], caution]
        return "\nproof file   not written: this answer has no proof"

    def tell(
        self,
        answer: Mapping[str, Any],
        *more: Table,
        after: str = "",
        typed: Sequence[str] = (),
        bricks: bool = False,
    ) -> None:
        """Print warnings on the error stream, and the answer as JSON or as text.

        Arguments: `typed`: options of this command besides those of reading, for a next step of the
        same name.
        """
        from kilter.tell.facts import kind_of
        from kilter.tell.text import text_of

        content = f"answer of {kind_of(answer)} as {'JSON' if self.writes_json else 'text'}"
        tell_warnings(answer.get("warnings", ()), self.quiet or self.json)
        if self.writes_json:
            emit(as_json(answer), self.output)
            tell_written(self.output, content, self.quiet)
            return
        text = text_of(answer, *more, brief=not self.verbose) + after
        text += self._next(answer, typed, bricks)
        emit(text, self.output, answer)
        tell_written(self.output, content, self.quiet)

    def _next(self, answer: Mapping[str, Any], typed: Sequence[str], bricks: bool) -> str:
        """The suggested next command to type; empty if the input is standard input."""
        from kilter.assembly.question import FREE_STANDING
        from kilter.tell.facts import kind_of
        from kilter.tell.next_step import next_step

        step = (
            None
            if self.file in ("", "-")
            else next_step(
                answer,
                Path(self.file).stem.split(".")[0],
                bricks=bricks,
                straps=self.straps is not None,
            )
        )
        if step is None:
            return ""
        name, *rest = step.words
        if name in FREE_STANDING and "floor" in answer.get("assumed", ()):
            rest.append("--floor")  # this command assumes none
        request = self
        if "--down" in rest:
            request = replace(self, typed=replace(self.typed, down=None))
        if "--accelerate" in rest:
            request = replace(self, typed=replace(self.typed, accelerate=None))
        if "--friction" in rest:
            request = replace(self, typed=replace(self.typed, friction=None))
        words = request.command(name, *(typed if name == kind_of(answer) else ()), *rest)
        return f"\n\nnext: {words}\n      {step.why}"

    def command(self, name: str, *rest: str) -> str:
        """The command `name` with the options of this call, as a user types it."""
        from kilter.files.own.choices import option_words

        words = option_words(self.typed.options())
        if self.straps is not None:
            words += ["--straps", str(self.straps)]
        return shell_words(["kilter", name, self.file, *words, *self.touch.words(), *rest])


def tell_cut(
    reached: TimeLimitReached,
    time_limit: float | None,
    *,
    as_data: bool,
    output: Path | None,
    quiet: bool,
) -> int:
    """Print the facts known when the time limit [s] was reached; return the exit code."""
    limit = "the time limit" if time_limit is None else f"the time limit of {time_limit:g} s"
    sentence = f"Undecided: {limit} was reached before the answer was complete."
    known = known_words()
    facts = f"{known[:1].upper()}{known[1:]}." if known else ""
    sentence = " ".join(words for words in (sentence, reached.known, facts) if words)
    from kilter.tell.record import Incomplete

    answer = Incomplete(sentence=sentence, time_limit=time_limit)
    emit(as_json(answer.to_dict()) if as_data else sentence, output)
    tell_written(output, "incomplete answer", quiet)
    return VERDICT["undecided"]


def _not_negative(value: float, option: str, unit: str) -> float:
    """Validate that an option value is not negative, and return it.

    Raises `InputError` if the value is negative or not finite.
    """
    if not (math.isfinite(value) and value >= 0):
        raise InputError(f"{option} is {value:g}", hint=f"give {option} {unit}, 0 or more")
    return value


# The command `check` for several files: a line for each file, and the worst exit code.


Answer = Mapping[str, Any]
WORST = (FAULT, USAGE, VERDICT["unstable"], VERDICT["undecided"], LOWER, HOLDS)
"""Exit codes, the worst first."""
WIDE = 100
"""Largest number of characters about the motion of a file."""


def code_of(answer: Answer) -> int:
    """Exit code of an answer of `check`: a verdict, or data with a verdict."""
    if answer["level"] is None:
        return VERDICT[answer["verdict"]]
    return HOLDS if answer["stable"] else LOWER


def check_each(asked: Asked, files: Sequence[str], judge: Callable[[Asked], Answer]) -> int:
    """Print the verdict or the error of each file; return the worst exit code.

    Returns the worst exit code.
    """
    from kilter.tell.numbers import plain
    from kilter.tell.text import aligned

    answers, rows, codes = [], [], set()
    # every name is validated before the first file is checked
    for file, request in [(file, asked.of_file(file)) for file in files]:
        answer, code = _answer(request, judge)
        answers.append({"file": file, **answer})
        codes.add(code)
        moves = plain(answer["summary"], WIDE) if answer.get("verdict") == "unstable" else ""
        rows.append((file, answer.get("verdict", "error"), moves))
    text = as_json(answers) if asked.writes_json else "\n".join(aligned(rows))
    emit(text, asked.output)
    tell_written(asked.output, f"answers of check about {len(files)} files", asked.quiet)
    return next(code for code in WORST if code in codes)


def _answer(asked: Asked, judge: Callable[[Asked], Answer]) -> tuple[Answer, int]:
    """Check a file and return its answer and exit code; an error becomes the answer."""
    try:
        answer = judge(asked)
    except InputError as error:
        why, code = error.for_command, USAGE
    except BrokenPipeError:
        raise
    except MemoryError:
        why, code = NO_MEMORY, USAGE
    except Exception as error:
        why, code = fault_words(error, ["check", asked.file]), FAULT
    else:
        warnings = [f"{asked.file}: {warning}" for warning in answer["warnings"]]
        tell_warnings(warnings, asked.quiet or asked.json)
        return answer, code_of(answer)
    print(f"kilter: {message_line(why)}", file=sys.stderr)
    return {"error": why}, code
