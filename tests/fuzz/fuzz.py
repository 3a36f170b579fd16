"""Fuzzing: damaged files and proofs, options and scenes at random, until the time is up.

    python tests/fuzz/fuzz.py --seconds 50                    as many of each kind as there is time
    python tests/fuzz/fuzz.py --inputs 40000 --log run.json   so many, goes on where it was
    python tests/fuzz/fuzz.py --only files:417                one case again, in this process

A case is its kind and its number: both together are its seed. Cases run in a process that is
forked from this one, so that a case costs milliseconds, and which is ended where a case hangs or
takes too much memory. Faults are listed, and the exit code is 1 where there is any.
"""

import argparse
import json
import math
import os
import resource
import sys
import time
from collections import Counter
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one process, forked: before numpy is loaded

from fuzz_cases import KINDS, case
from fuzz_worker import Worker

SHARE = {
    "files": 50, "scenes": 10, "options": 10, "proofs": 10,
    "formats": 70, "messages": 2, "tools": 10,
}  # fmt: skip
"""Cases of each kind where only a time is given, of so many together."""
HOSTILE = ("files", "proofs", "formats", "messages", "tools")
"""Kinds of cases that are damaged inputs."""
KEPT_EACH = 20.0
"""Between two writings of the log [s]."""


class Round:
    """What was done so far; kept in a file, if there is one."""

    def __init__(self, seed: int, log: Path | None) -> None:
        self.log = log
        self.seed = seed
        self.done: Counter[str] = Counter()
        self.ended: dict[str, Counter[str]] = {kind: Counter() for kind in KINDS}
        self.found: list[str] = []
        self.seconds = self.cpu = 0.0
        if log is not None and log.exists():
            kept = json.loads(log.read_text("utf-8"))
            self.seed = kept["seed"]
            self.done.update(kept["done"])
            for kind, counts in kept["ended"].items():
                self.ended[kind].update(counts)
            self.found, self.seconds, self.cpu = kept["found"], kept["seconds"], kept["cpu"]

    def add(self, kind: str, number: int, how: str, faults: list[str]) -> None:
        """The outcome of a case."""
        self.done[kind] += 1
        self.ended[kind][how] += 1
        for fault in faults:
            self.found.append(f"{kind}:{number} {fault}")
            print(self.found[-1], flush=True)

    def keep(self) -> None:
        """Write the log."""
        if self.log is None:
            return
        names = ("seed", "done", "ended", "found", "seconds", "cpu")
        beside = self.log.with_suffix(".new")
        beside.write_text(json.dumps({name: getattr(self, name) for name in names}, indent=1))
        beside.replace(self.log)

    def summary(self) -> str:
        """How many of each kind, how they ended, how long it took."""
        lines = [
            f"{self.done[kind]} {kind}: "
            + ", ".join(f"{count} {how}" for how, count in self.ended[kind].most_common())
            for kind in KINDS
            if self.done[kind]
        ]
        last = f"from number {self.seed}, {self.seconds / 3600:.2f} h, {self.cpu:.0f} s of CPU"
        return "\n".join([*lines, f"{last}: {len(self.found)} faults"])


def run(done: Round, targets: dict[str, int], seconds: float) -> None:
    """Cases of the kind that is farthest behind, until all are done or the time is up."""
    worker = Worker()
    before, cpu_before = done.seconds, done.cpu
    started = kept = time.monotonic()
    while True:
        waiting = [kind for kind, wanted in targets.items() if done.done[kind] < wanted]
        now = time.monotonic()
        if now - kept > KEPT_EACH or not waiting or now - started > seconds:
            done.seconds, kept = before + now - started, now
            done.cpu = cpu_before + _cpu() + worker.cpu()
            done.keep()
        if not waiting or now - started > seconds:
            break
        kind = min(waiting, key=lambda one: done.done[one] / targets[one])
        number = done.seed + done.done[kind]
        done.add(kind, number, *worker.run(kind, number))
    worker.end()


def _cpu() -> float:
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=0, help="number of the first case")
    parser.add_argument("--log", type=Path, help="kept here; a run goes on from it")
    parser.add_argument("--only", metavar="KIND:NUMBER", help="one case, in this process")
    parser.add_argument("--inputs", type=int, help="damaged inputs of all kinds together")
    for kind in KINDS:
        parser.add_argument(f"--{kind}", type=int, help=f"cases of {kind}")
    given = parser.parse_args()
    if given.only:
        kind, number = given.only.split(":")
        folder = Path("fuzz-case")
        folder.mkdir(exist_ok=True)
        how, faults = case(kind, int(number), folder)
        print("\n".join([how, *faults]))
        return 1 if faults else 0
    asked = {kind: getattr(given, kind) for kind in KINDS}
    if given.inputs:
        share = given.inputs / sum(SHARE[kind] for kind in HOSTILE)
        asked = {kind: math.ceil(share * SHARE[kind]) if kind in HOSTILE else 0 for kind in KINDS}
    targets = {kind: count for kind, count in asked.items() if count}
    if not targets:
        if given.seconds == float("inf"):
            parser.error("give --seconds, or how many cases")
        targets = {kind: SHARE[kind] * 10**6 for kind in KINDS}
    done = Round(given.seed, given.log)
    run(done, targets, given.seconds)
    print(done.summary())
    return 1 if done.found else 0


if __name__ == "__main__":
    sys.exit(main())
