"""A process that runs cases, forked from this one, and ended where a case breaks a limit."""

import gc
import importlib
import multiprocessing
import os
import pkgutil
import resource
import sys
import time
from contextlib import suppress
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import IO

from fuzz_cases import case

import kilter
from kilter.pipes import end_with_parent

HANGS = 20.0
"""Seconds of CPU after which a case counts as hanging, with all processes that it started."""
STUCK = 3600.0
"""The same of a case that computes nothing; it may be that others take all of the machine [s]."""
MEMORY = 2 << 30
"""Memory that a case may take beside that of the modules that are loaded before [bytes]."""
ADDRESSES = 6 << 30
"""Addresses that a case may take: threads of libraries reserve many more than they use [bytes]."""
ANEW = 2000
"""Cases after which a new process takes over."""
IN_MEMORY = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""Where files are that live for a case: to write them through to a disk takes its time."""
Outcome = tuple[str, list[str]]


class Worker:
    """One such process, forked anew after a hang or a crash."""

    def __init__(self) -> None:
        load_all()
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("fork")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_work, args=(theirs,))
        self.process.start()
        theirs.close()
        self.cases = 0

    def run(self, kind: str, number: int) -> Outcome:
        """How a case ended, and its faults; a hang and a crash are faults."""
        if self.cases >= ANEW:
            self.end()
            self._start()
        self.cases += 1
        self.pipe.send((kind, number))
        began, started = self.cpu(), time.monotonic()
        try:
            while not self.pipe.poll(1.0):
                spent, waited = self.cpu() - began, time.monotonic() - started
                if spent > HANGS or waited > STUCK:
                    outcome = "hung", [f"takes over {spent:.0f} s of CPU, {waited:.0f} s in all"]
                    break
            else:
                how, faults = self.pipe.recv()
                return how, faults
        except EOFError:
            self.process.join(5)
            outcome = "died", [f"the process died, exit {self.process.exitcode}"]
        self.process.kill()
        self.process.join()
        self._start()
        return outcome

    def cpu(self) -> float:
        """Time of the process and of those that it started [s]."""
        waiting, total = [self.process.pid], 0.0
        while waiting:
            pid = waiting.pop()
            with suppress(OSError):
                fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
                total += sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
                below = Path(f"/proc/{pid}/task/{pid}/children").read_text()
                waiting += [int(one) for one in below.split()]
        return total

    def end(self) -> None:
        """Let the process end by itself."""
        with suppress(OSError):
            self.pipe.send(None)
        self.process.join(30)
        self.process.kill()
        self.process.join()


@cache
def load_all() -> None:
    """Load every module of kilter, so that no case has to."""
    for module in pkgutil.walk_packages(kilter.__path__, "kilter."):
        if module.name != "kilter.__main__":
            with suppress(ImportError):  # what needs an extra that is not there
                importlib.import_module(module.name)
    gc.freeze()  # what is loaded is not looked through for garbage, and its pages stay shared


def _work(pipe: Connection) -> None:
    """Run the cases that are asked for, until nobody asks any more."""
    end_with_parent()
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + ADDRESSES, held + ADDRESSES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with TemporaryDirectory(dir=IN_MEMORY) as folder, TemporaryFile() as noise:
        os.chdir(folder)  # a file that a library leaves in the working folder is seen
        for stream in (1, 2):
            os.dup2(noise.fileno(), stream)
        while True:
            try:
                asked = pipe.recv()
            except EOFError:
                break
            if asked is None:
                break
            before = _start_peak()
            try:
                how, faults = case(*asked, Path(folder))
            except MemoryError:
                how, faults = "took it all", [f"takes over {ADDRESSES >> 30} GiB"]
            except BaseException as error:
                how, faults = "raised", [_raised(error)]
            if _peak() - before > MEMORY and not faults:
                faults = [f"takes over {MEMORY >> 30} GiB"]
            pipe.send((how, faults + _heard(noise)))
    sys.stdout = sys.stderr = None


def _start_peak() -> int:
    """Begin to measure the largest memory of this process anew; the present memory [bytes]."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def _peak() -> int:
    """Largest memory of this process since `_start_peak` [bytes]."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) * 1024


def _raised(error: BaseException) -> str:
    at = error.__traceback__
    while at is not None and at.tb_next is not None:
        at = at.tb_next
    where = "" if at is None else f" ({Path(at.tb_frame.f_code.co_filename).name}:{at.tb_lineno})"
    return f"{type(error).__name__}: {error}"[:300] + where


def _heard(noise: IO[bytes]) -> list[str]:
    """What libraries wrote by themselves to the streams of the process."""
    if not os.fstat(noise.fileno()).st_size:
        return []
    noise.seek(0)
    heard = noise.read()[:300]
    noise.seek(0)
    noise.truncate()
    return [f"a library printed {heard!r}"]
