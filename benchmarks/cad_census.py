"""Census of CAD as engineers draw it: does kilter reach the right answer by its own proposals?

    python benchmarks/cad_census.py             300 assemblies
    python benchmarks/cad_census.py 50 1000     50 assemblies, from seed 1000 on
    python benchmarks/cad_census.py 20 1030     the last 20 of these, after an interruption
    python benchmarks/cad_census.py --seed 7    one assembly, with the sentences of its answers

`cad_assemblies` draws each assembly and knows its outcome. The census runs `kilter check FILE
--ground base`, then at most two commands that kilter itself proposes as the next step.

    right        it holds and the last verdict is stable, settles or balanced; or parts fall and the
                 last verdict is unstable and names all of them
    wrong        stable or settles although parts fall; or unstable although it holds, and kilter
                 proposes nothing more
    useful       the first answer is right, or it proposes a command that decides
    open         neither right nor wrong

The command prints a line for each seed as soon as its answers are known. At the end, and also if it
is interrupted, it prints the counts by kind of module, the CPU time beside reading, and the seeds
that are wrong or open. The exit code is 1 if an answer is wrong or a command ends by a fault, and
130 after an interruption.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import io
import json
import signal
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from cad_assemblies import Drawn, draw, write_drawn

import kilter
from kilter.cli import main as run_kilter
from kilter.tell.next_step import next_step

HOLDS = ("stable", "settles", "balanced")
PROPOSALS = 2
"""Largest number of proposed commands that the census runs after the first."""


@dataclass
class Case:
    """The answers about an assembly, and their judgement."""

    drawn: Drawn
    answers: list[dict[str, Any]] = field(default_factory=list)
    commands: list[list[str]] = field(default_factory=list)
    seconds: float = 0.0
    fault: str = ""

    def is_right(self, answer: dict[str, Any]) -> bool:
        """Whether the verdict of an answer is the known outcome."""
        if not self.drawn.falls:
            return answer["verdict"] in HOLDS
        moving = [part["name"] for part in answer["parts"] if part["moves"]]
        fallen = all(
            fall in moving or any(name.endswith(f"/{fall}") for name in moving)
            for fall in self.drawn.falls
        )
        return answer["verdict"] == "unstable" and fallen

    def judgement(self) -> str:
        """One of fault, right, wrong, open."""
        if self.fault or not self.answers:
            return "fault"
        last = self.answers[-1]
        if self.is_right(last):
            return "right"
        false_hold = bool(self.drawn.falls) and last["verdict"] in ("stable", "settles")
        ended = _proposal(last) is None
        false_fall = not self.drawn.falls and last["verdict"] == "unstable" and ended
        return "wrong" if false_hold or false_fall else "open"

    def is_useful(self) -> bool:
        """Whether the first answer is right, or proposes a command that decides."""
        if self.fault or not self.answers:
            return False
        return self.is_right(self.answers[0]) or _proposal(self.answers[0]) is not None


def _proposal(answer: dict[str, Any]) -> tuple[str, ...] | None:
    """Options of the check that an answer proposes; None if it proposes no further check."""
    step = next_step(answer, "assembly")
    return step.words[1:] if step is not None and step.words[0] == "check" else None


def _ask(words: list[str]) -> tuple[dict[str, Any] | None, str]:
    """The JSON answer of a check, and its error message."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run_kilter(["check", *words, "--json", "--quiet"])
    if code == 130:
        raise KeyboardInterrupt
    if code in (2, 70) or not out.getvalue().strip():
        return None, err.getvalue().strip() or f"exit code {code}"
    return json.loads(out.getvalue()), ""


def examine(seed: int, folder: Path) -> Case:
    """Ask kilter about the assembly of a seed, and follow its proposals."""
    case = Case(draw(seed))
    file = write_drawn(case.drawn, folder / f"{seed}.step")
    started = time.process_time()
    kilter.load(file)
    read = time.process_time() - started
    words = [str(file), "--ground", "base"]
    started = time.process_time()
    for _ in range(1 + PROPOSALS):
        case.commands.append(words)
        answer, error = _ask(words)
        if answer is None:
            case.fault = error
            break
        case.answers.append(answer)
        proposed = _proposal(answer)
        if case.is_right(answer) or proposed is None:
            break
        words = [*words, *proposed]
    case.seconds = time.process_time() - started - read * len(case.commands)
    return case


def _line(seed: int, case: Case) -> str:
    """The judgement about a seed, its CPU time, its verdicts, and its kinds of module."""
    first = "useful" if case.is_useful() else "not useful"
    verdicts = " > ".join(answer["verdict"] for answer in case.answers)
    kinds = ", ".join(sorted(set(case.drawn.kinds)))
    return f"{seed} {case.judgement():5} {first} {case.seconds:6.2f} s  {verdicts}  ({kinds})"


def _report(cases: dict[int, Case]) -> None:
    """Print the counts, the times and the seeds without a right answer."""
    judged = {seed: case.judgement() for seed, case in cases.items()}
    by_kind: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    for seed, case in cases.items():
        for kind in set(case.drawn.kinds):
            by_kind[kind][judged[seed]] += 1
    total = collections.Counter(judged.values())
    print(f"{'kind':34} right  open wrong fault")
    for kind, count in [*sorted(by_kind.items()), ("all", total)]:
        print(f"{kind:34}" + "".join(f"{count[w]:6d}" for w in ("right", "open", "wrong", "fault")))
    useful = sum(case.is_useful() for case in cases.values())
    print(f"first answer useful: {useful} of {len(cases)}")
    seconds = [case.seconds for case in cases.values()]
    print(f"CPU s beside reading: median {np.median(seconds):.2f}, worst {max(seconds):.2f}")
    for word in ("wrong", "fault", "open"):
        for seed in (seed for seed, judgement in judged.items() if judgement == word):
            print(f"{word} {seed}: {', '.join(cases[seed].drawn.kinds)}; {cases[seed].fault}")


def main() -> int:
    """Run the census."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=300)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("--seed", type=int, help="examine the assembly of this seed alone")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.count)
    seeds = seeds if options.seed is None else range(options.seed, options.seed + 1)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the end of a time slot interrupts
    cases: dict[int, Case] = {}
    interrupted = False
    with tempfile.TemporaryDirectory() as folder:
        try:
            for seed in seeds:
                cases[seed] = examine(seed, Path(folder))
                print(_line(seed, cases[seed]), flush=True)
        except KeyboardInterrupt:
            interrupted = True
    if options.seed is not None:
        case = cases[options.seed]
        print(f"falls: {sorted(case.drawn.falls)}, joined: {case.drawn.joined}")
        for words, answer in zip(case.commands, case.answers, strict=False):
            print(" ".join(words[1:]), "->", answer["sentence"], answer["ladder"])
    if cases:
        _report(cases)
    if interrupted:
        print(f"interrupted at seed {seed}: {len(cases)} of {len(seeds)} seeds are judged")
        return 130
    judged = [case.judgement() for case in cases.values()]
    return 1 if "wrong" in judged or "fault" in judged else 0


if __name__ == "__main__":
    sys.exit(main())
