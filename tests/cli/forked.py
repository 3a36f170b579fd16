"""Commands of kilter by the hundred: forked from one process that has loaded all of it.

python tests/cli/forked.py      a request a line: words, folder, seconds, signal, ignored
"""

import importlib
import json
import os
import pkgutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

SAID = "said.txt"
"""What a command prints, in its folder."""
RUNS_ON = 0
"""In place of a signal: the command ends by itself."""


class Commands:
    """The process that runs them."""

    def __init__(self) -> None:
        pipe = subprocess.PIPE
        command = [sys.executable, __file__]
        self.server = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)

    def run(
        self,
        words: list[str],
        folder: Path,
        *,
        after: float = 0.0,
        number: int = RUNS_ON,
        ignored: bool = False,
    ) -> tuple[int, float]:
        """Exit code of a command (minus the signal that ended it), and how long it took [s].

        Parameters
        ----------
        words : list of str
        folder : Path
            Where it runs.
        after : float
            When the signal is sent [s].
        number : int
            Of the signal.
        ignored : bool
            It begins with interruptions ignored, as what a script starts in the background.
        """
        assert self.server.stdin is not None
        assert self.server.stdout is not None
        request = [words, str(folder), after, int(number), ignored]
        self.server.stdin.write(json.dumps(request) + "\n")
        self.server.stdin.flush()
        code, seconds = json.loads(self.server.stdout.readline())
        return code, seconds

    def end(self) -> None:
        """End it."""
        self.server.kill()
        self.server.communicate()


DRAWING = ("figure", "backends.backend_agg", "backends.backend_svg")
"""Of matplotlib: what takes a second to load before anything is drawn."""


def load_all() -> None:
    """Load every module of kilter, and what draws."""
    import kilter

    for module in pkgutil.walk_packages(kilter.__path__, "kilter."):
        if module.name != "kilter.__main__":
            with suppress(ImportError):
                importlib.import_module(module.name)
    for name in DRAWING:
        with suppress(ImportError):
            importlib.import_module(f"matplotlib.{name}")


def begun(words: list[str], folder: str, ignored: bool) -> int:
    """A process that runs a command as a program of its own does."""
    pid = os.fork()
    if pid:
        return pid
    from kilter.cli import main

    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, signal.SIG_IGN if ignored else signal.SIG_DFL)
    os.chdir(folder)
    stream = os.open(SAID, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for one in (1, 2):
        os.dup2(stream, one)
    sys.argv = ["kilter", *words]
    code = 99
    try:
        code = main()
        if sys.stdout is not None:
            sys.stdout.flush()
    finally:
        os._exit(code)


def serve() -> None:
    """Answer requests until nobody asks."""
    load_all()
    for line in sys.stdin:
        words, folder, after, number, ignored = json.loads(line)
        started = time.perf_counter()
        pid = begun(words, folder, ignored)
        if number != RUNS_ON:
            time.sleep(after)
            os.kill(pid, number)
        _, status = os.waitpid(pid, 0)
        ended = os.waitstatus_to_exitcode(status), time.perf_counter() - started
        sys.stdout.write(json.dumps(ended) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    serve()
