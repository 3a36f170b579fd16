"""The compared tools, and the measurement of an answer.

A tool prepares its assembly, matrix or model from a question, which is not timed. The measured
time starts with known contacts (MuJoCo: with the compiled model) and ends with the answer.
"""

from __future__ import annotations

import importlib
import importlib.util
import resource
import signal
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

from closed_forms import CASES, Case
from question import Question

__all__ = ["RUNS", "TOOLS", "Row", "Tool", "answered", "spent", "truth"]

RUNS = 3
"""Number of runs; their median counts."""
LONG = 0.4
"""A run repeats the answer for at least this time, so that the clock is fine enough [CPU s]."""
REPEATED = 200
"""Maximum repetitions of the answer in a run."""


@dataclass(frozen=True, slots=True)
class Tool:
    """A compared tool.

    Attributes
    ----------
    name : str
    package : str
        Required package.
    asked : str
        Module and function that prepare it.
    words : str
        Description.
    """

    name: str
    package: str
    asked: str
    words: str

    @property
    def installed(self) -> bool:
        """Whether the package is installed."""
        return importlib.util.find_spec(self.package) is not None

    @property
    def version(self) -> str:
        """Version of the package."""
        return version(self.package)

    def ready(self, question: Question) -> Callable[[], tuple[str, str]]:
        """Prepare a function that returns the answer ("holds", "falls" or "open") and a note."""
        module, function = self.asked.split(".")
        made: Callable[[], tuple[str, str]] = getattr(importlib.import_module(module), function)(
            question
        )
        return made


TOOLS = {
    tool.name: tool
    for tool in (
        Tool("kilter", "kilter", "ask_kilter.verdict", "check: the whole verdict"),
        Tool(
            "kilter, equilibrium", "kilter", "ask_kilter.equilibrium",
            "equilibrium in Coulomb's cones, certified",
        ),
        Tool("HiGHS", "highspy", "ask_programs.highs", "the linear program, inner pyramids"),
        Tool("linprog", "scipy", "ask_programs.linprog", "the same through scipy"),
        Tool(
            "compas_cra RBE", "compas_cra", "ask_compas_cra.rbe",
            "equilibrium with penalised tension",
        ),
        Tool(
            "compas_cra CRA", "compas_cra", "ask_compas_cra.cra",
            "forces that agree with displacements",
        ),
        Tool(
            "compas_cra CRA, tuned", "compas_cra", "ask_compas_cra.cra_tuned",
            "the same in its fastest units",
        ),
        Tool(
            "LMGC90", "compas_lmgc90", "ask_lmgc90.settle",
            "simulation by contact dynamics: did a block move?",
        ),
        Tool("MuJoCo", "mujoco", "ask_mujoco.settle", "simulation: did it move?"),
        Tool(
            "factorisation", "scipy", "ask_programs.factorisation",
            "a single sparse factorisation: the lower bound",
        ),
    )
}  # fmt: skip
"""All tools by name."""


@dataclass(frozen=True, slots=True)
class Row:
    """Answer of a tool for a case, with its measurements.

    Attributes
    ----------
    family, case, tool : str
    bricks, points : int
        Number of free parts and of contact points; 0 if the run ended before.
    truth, answer : str
        "holds" or "falls"; `answer` can also be "open", "refused", "time", "memory", "crashed", or
        empty for a tool without answers.
    seconds : float
        Median of the runs [CPU s], or the time limit.
    runs : int
        Number of runs.
    peak : float
        Peak memory above that of the process before [MiB].
    note : str
    """

    family: str
    case: str
    tool: str
    bricks: int
    points: int
    truth: str
    answer: str
    seconds: float
    runs: int
    peak: float
    note: str

    def to_dict(self) -> dict[str, Any]:
        """The row as a dictionary."""
        return asdict(self)


def truth(case: Case) -> str:
    """The known answer of a case, "holds" or "falls"."""
    return "holds" if case.holds else "falls"


def answered(case: Case, tool: Tool, limit: float = 0.0) -> Row:
    """Measure a row in this process; an answer over `limit` [CPU s] ends the process."""
    question = Question(case.build())
    bricks, points = int(question.program.free.sum()), len(question.contacts.points)
    warm = Question(CASES["slides toward 0, 0.98"].build())
    tool.ready(warm)()
    try:
        run = tool.ready(question)
    except ValueError as error:
        said = (str(error).splitlines() or [""])[0]
        return Row(
            case.family, case.name, tool.name, bricks, points, truth(case), "refused", 0.0, 0, 0.0,
            said,
        )  # fmt: skip
    before = restarted_peak()
    (answer, note), first = timed(run, limit)
    peak = held("VmHWM") - before
    taken = [first, *(timed(run, limit)[1] for _ in range(1, RUNS))]
    return Row(
        case.family, case.name, tool.name, bricks, points, truth(case), answer,
        median(taken), len(taken), max(peak, 0.0), note,
    )  # fmt: skip


def timed(run: Callable[[], tuple[str, str]], limit: float) -> tuple[tuple[str, str], float]:
    """An answer and its mean CPU seconds; an answer over its limit ends the process."""
    started, count = spent(), 0
    while True:
        signal.setitimer(signal.ITIMER_PROF, limit)
        before = spent()
        answer = run()
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        if 0 < limit < spent() - before:  # includes child processes, which the timer misses
            signal.raise_signal(signal.SIGPROF)
        count, passed = count + 1, spent() - started
        if passed >= LONG or count == REPEATED:
            return answer, passed / count


def spent() -> float:
    """CPU time of this process and of its finished child processes [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def restarted_peak() -> float:
    """Current memory [MiB]; if the system allows it, the peak is reset."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
        return held("VmRSS")
    except OSError:
        return held("VmHWM")


def held(what: str) -> float:
    """Memory of this process [MiB]: a field of its status file, or the peak."""
    status = Path("/proc/self/status")
    if not status.exists():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10
    [line] = [one for one in status.read_text().splitlines() if one.startswith(what)]
    return int(line.split()[1]) / 2**10
