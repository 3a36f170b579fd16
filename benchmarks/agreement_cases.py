"""Cases of the census of agreement: the limit of each command, the log, and the counts."""

from __future__ import annotations

import collections
import json
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.work import EFFORT

__all__ = ["Case", "catch_limit", "logged_cases", "print_counts"]

LIMIT = 20.0
"""Limit of each command [CPU s]."""


class Cut(Exception):
    """A command reached its limit."""


@dataclass
class Case:
    """Counts of a case: tests and contradictions of each rule, cut commands, CPU seconds.

    `seconds` has the slowest run of each command, `total` the sum over all `runs`; `commit` is the
    version of the code that was tested.
    """

    family: str
    seed: int
    effort: float = EFFORT
    verdict: str = "error"
    tests: collections.Counter[str] = field(default_factory=collections.Counter)
    wrong: list[str] = field(default_factory=list)
    cut: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    total: float = 0.0
    runs: int = 0
    commit: str = ""

    def test(self, rule: str, agrees: bool, words: str) -> None:
        """Count a test of a rule, and note the contradiction."""
        self.tests[f"{rule}, balanced" if self.verdict == "balanced" else rule] += 1
        if not agrees:
            self.wrong.append(f"{self.family} {self.seed}: {rule}: {words}")

    def run(self, name: str, command: Callable[[], Any]) -> Any:
        """The answer of a command; None if it reaches its limit or rejects the assembly."""
        began = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, LIMIT)
        try:
            return command()
        except Cut:
            self.cut.append(name)
        except InputError as error:
            reason = str(error).split(", such as")[0][:70]
            self.tests[f"{name} rejects: {reason}"] += 1
            if "fault" in str(error):
                self.wrong.append(f"{self.family} {self.seed}: {name}: {error}")
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
            taken = time.process_time() - began
            self.seconds[name] = max(self.seconds.get(name, 0.0), taken)
            self.total += taken
            self.runs += 1
        return None


def catch_limit() -> None:
    """Let the CPU limit of a command raise `Cut` in this process."""
    signal.signal(signal.SIGPROF, _cut)


def _cut(*_: object) -> None:
    raise Cut


def logged_cases(log: Path) -> dict[tuple[str, int], Case]:
    """The cases of a log by family and seed."""
    lines = log.read_text(encoding="utf-8").splitlines() if log.exists() else []
    rows = [json.loads(line) for line in lines]
    return {
        (row["family"], row["seed"]): Case(**{**row, "tests": collections.Counter(row["tests"])})
        for row in rows
    }


def print_counts(cases: list[Case]) -> int:
    """Print the counts of all cases; return 1 if there is a contradiction."""
    tests: collections.Counter[str] = collections.Counter()
    slowest: dict[str, tuple[float, str]] = {}
    for case in cases:
        tests.update(case.tests)
        for name, taken in case.seconds.items():
            row = (taken, f"{case.family} {case.seed}")
            slowest[name] = max(slowest.get(name, (0.0, "")), row)
    words = collections.Counter(f"{case.family} {case.verdict}" for case in cases)
    cuts = collections.Counter(name for case in cases for name in case.cut)
    commits = collections.Counter(case.commit or "unknown" for case in cases)
    for title, counter in (
        ("cases of each commit", commits),
        ("verdicts", words),
        ("tests", tests),
        ("cut at 20 CPU s", cuts),
    ):
        print(title)
        for name, number in sorted(counter.items()):
            print(f"  {number:6d}  {name}")
    print("slowest of each command [CPU s]")
    for name, (taken, place) in sorted(slowest.items(), key=lambda item: -item[1][0]):
        print(f"  {taken:6.1f}  {name}: {place}")
    commands = sum(case.runs for case in cases)
    wrong = [text for case in cases for text in case.wrong]
    print("\n".join(wrong))
    print(
        f"{len(cases)} assemblies, {sum(cuts.values())} of {commands} commands cut, "
        f"{len(wrong)} contradictions, {sum(case.total for case in cases) / 60:.1f} CPU min"
    )
    return 1 if wrong else 0
