"""Fuzzing: damaged files and random scenes until the time is up; each case has a number.

    python tests/fuzz/fuzz.py --seconds 600 --seed 0        files and scenes in turn
    python tests/fuzz/fuzz.py --only files:417              one case again, in this process

Each case runs in a process of its own kind that is ended where it hangs or takes too much
memory. Faults are listed, and the exit code is 1 where there is any.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import sys
import time
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from fuzz_corpus import corpus
from fuzz_mutations import damaged
from fuzz_oracles import faults_of_command, faults_of_proof, faults_of_scene
from fuzz_scenes import random_scene

HANGS = 30.0
"""Seconds after which a case counts as hanging."""
MEMORY = 8 << 30
"""Address space of the process that runs the cases [bytes]; libraries alone map about 2 GiB."""
EFFORT = 0.5
"""For what friction guarantees [s]."""
COMMANDS = ("check", "check", "check", "contacts", "orient", "region")
KINDS = ("files", "scenes")


def case(kind: str, number: int, folder: Path) -> list[str]:
    """The faults of one case."""
    rng = np.random.default_rng([KINDS.index(kind), number])
    if kind == "scenes":
        return faults_of_scene(random_scene(rng), rng, EFFORT)
    names = sorted(corpus())
    name = names[number % len(names)]
    path = folder / name
    path.write_bytes(damaged(name, corpus()[name], rng))
    command = COMMANDS[int(rng.integers(len(COMMANDS)))]
    words = [command, str(path), "--quiet"]
    if command != "contacts" and not name.endswith("kilter.json"):
        words.append("--floor")
    if command == "check":
        words += ["--effort", str(EFFORT)]
        if rng.random() < 0.3:
            return faults_of_proof(words, folder / "proof.json")
    return faults_of_command(words)


def work(pipe: Connection) -> None:
    """A process that runs the cases it is told, until it is told None."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    with TemporaryDirectory() as folder:
        while (asked := pipe.recv()) is not None:
            try:
                pipe.send(case(*asked, Path(folder)))
            except BaseException as error:
                pipe.send([f"{type(error).__name__}: {error}"[:300]])


class Worker:
    """One such process, started anew after a hang or a crash."""

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=work, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()

    def run(self, kind: str, number: int) -> list[str]:
        """The faults of a case; a hang and a crash are faults."""
        self.pipe.send((kind, number))
        try:
            if self.pipe.poll(HANGS):
                return list(self.pipe.recv())
            found = [f"hangs over {HANGS:g} s"]
        except EOFError:
            self.process.join(5)
            found = [f"the process died, exit {self.process.exitcode}"]
        self.process.kill()
        self._start()
        return found

    def end(self) -> None:
        """Let the process end by itself."""
        self.pipe.send(None)
        self.process.join(10)


def round_of(
    seconds: float, seed: int, kinds: tuple[str, ...] = KINDS
) -> tuple[Counter, list[str]]:
    """Cases in turn until the time is up: how many of each kind, and what was found."""
    worker, counts, found = Worker(), Counter(), []
    worker.run("files", 0)  # the start-up of the process is not counted
    end, number = time.monotonic() + seconds, seed
    while time.monotonic() < end:
        for kind in kinds:
            counts[kind] += 1
            found += [f"{kind}:{number} {fault}" for fault in worker.run(kind, number)]
        number += 1
    worker.end()
    return counts, found


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0, help="number of the first case")
    parser.add_argument("--kinds", default=",".join(KINDS), help="files, scenes or both")
    parser.add_argument("--only", metavar="KIND:NUMBER", help="one case, in this process")
    given = parser.parse_args()
    if given.only:
        kind, number = given.only.split(":")
        folder = Path("fuzz-case")
        folder.mkdir(exist_ok=True)
        print("\n".join(case(kind, int(number), folder)) or "no fault")
        return 0
    counts, found = round_of(given.seconds, given.seed, tuple(given.kinds.split(",")))
    print("\n".join(found))
    print(", ".join(f"{n} {kind}" for kind, n in counts.items()) + f": {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
