"""Mutation testing of what decides: ``python tests/mutation/mutate.py [MODULE ...]``.

Of each module in `GUARDS` every mutant (`mutants`) is asked of the tests that run its line, the
quickest first, until one fails. The tests are collected once; each mutant lives in a process that
is forked from there, where the code of its functions is exchanged, so that a mutant costs little
more than the tests that it fails. A mutant that lives has its reason in `survivors.toml`, or the
command fails; so does a reason whose mutant is killed.

    --list      how many mutants there are
    --only TEXT those whose name has this text
    --seconds S what the tests of one mutant may take before it counts as killed
"""

import argparse
import ast
import functools
import gc
import importlib
import json
import os
import pkgutil
import signal
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, FrameType, FunctionType, ModuleType
from typing import Any

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

from mutants import Mutant, mutants  # noqa: E402

GUARDS = tomllib.loads((HERE / "guards.toml").read_text(encoding="utf-8"))
"""Of each module, the tests that guard it."""
SURVIVORS = HERE / "survivors.toml"
LONGEST = 60.0
"""Of the tests of one mutant [s]; an endless loop is seen, too."""


class Round:
    """The mutants of one module, asked of its tests."""

    def __init__(self, module: str, only: str, seconds: float) -> None:
        self.module, self.only, self.seconds = module, only, seconds
        self.path = ROOT / "src" / (module.replace(".", "/") + ".py")
        self.lived: list[Mutant] = []
        self.killed = 0
        self._failed = False

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._failed |= report.failed

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Every mutant, in the place of one run of the tests."""
        _load_all()
        session.config.pluginmanager.unregister(name="terminalreporter")
        every = [one for one in mutants(self.path.read_text("utf-8")) if self.only in one.name]
        lines, costs = self._lines(session.items)
        module = importlib.import_module(self.module)
        gc.unfreeze()  # of the module before
        functions = _functions(self.path)
        gc.collect()
        gc.freeze()  # children that look for garbage would copy everything
        for number, mutant in enumerate(every, 1):
            asked = sorted(
                (item for item in session.items if self._concerns(mutant, lines[item.nodeid])),
                key=lambda item: costs[item.nodeid],
            )
            killer = self._killer(module, functions, mutant, asked)
            if killer:
                self.killed += 1
            else:
                self.lived.append(mutant)
                print(f"  lives  {self.path.name}:{mutant.line}  {mutant.name}", flush=True)
            if number % 50 == 0:
                print(f"  {number} of {len(every)}", flush=True)
        return True

    def _concerns(self, mutant: Mutant, lines: set[int]) -> bool:
        """Whether a test runs the line; of what runs when the module is loaded, whether any."""
        return bool(lines) and (mutant.function in at_load(self.path) or mutant.line in lines)

    def _lines(self, items: list[pytest.Item]) -> tuple[dict[str, set[int]], dict[str, float]]:
        """Lines of the module that each test runs, and what it takes [s]."""
        lines, costs = {}, {}
        for item in items:
            said = _apart(lambda item=item: self._traced(item), 600.0)
            if said is None or said["failed"]:
                raise SystemExit(f"{item.nodeid} fails without any mutant")
            lines[item.nodeid], costs[item.nodeid] = _statements(self.path, said), said["seconds"]
        return lines, costs

    def _traced(self, item: pytest.Item) -> dict[str, Any]:
        seen: set[int] = set()
        name = str(self.path)

        def within(frame: FrameType, event: str, arg: object) -> Any:
            seen.add(frame.f_lineno)
            return within

        def begun(frame: FrameType, event: str, arg: object) -> Any:
            return within(frame, event, arg) if frame.f_code.co_filename == name else None

        started = time.perf_counter()
        sys.settrace(begun)
        failed = self._run(item)
        sys.settrace(None)
        return {
            "failed": failed,
            "lines": sorted(seen),
            "seconds": time.perf_counter() - started,
        }

    def _run(self, item: pytest.Item) -> bool:
        self._failed = False
        item.ihook.pytest_runtest_protocol(item=item, nextitem=None)
        return self._failed

    def _killer(
        self,
        module: ModuleType,
        functions: list[FunctionType],
        mutant: Mutant,
        items: list[pytest.Item],
    ) -> str:
        """The first test that fails; none where the mutant lives."""

        def tried() -> str:
            exchange(module, functions, mutant, self.path)
            return next((item.nodeid for item in items if self._run(item)), "")

        if not items:
            return ""
        said = _apart(tried, self.seconds)
        return "it does not end, or breaks down" if said is None else str(said)


def _statements(path: Path, said: dict[str, Any]) -> set[int]:
    """All lines of the statements that were begun: a mutant may stand on a later one."""
    ran, lines = set(said["lines"]), set(said["lines"])
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.expr | ast.stmt) and not isinstance(
            node, ast.FunctionDef | ast.ClassDef | ast.If | ast.For | ast.While | ast.Try | ast.With
        ):
            own = set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
            lines |= own if own & ran else set()
    return lines


def _apart(ask: Callable[[], Any], seconds: float) -> Any:
    """An answer from a process that is forked for it; None where it gives none."""
    receiving, sending = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(receiving)
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nothing, stream)
        signal.setitimer(signal.ITIMER_REAL, seconds)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        code = 1
        try:
            answer = json.dumps(ask()).encode()
            with os.fdopen(sending, "wb") as stream:
                stream.write(answer)
            code = 0
        finally:
            os._exit(code)
    os.close(sending)
    with os.fdopen(receiving, "rb") as stream:
        said = stream.read()
    _, status = os.waitpid(child, 0)
    return json.loads(said) if status == 0 else None


def exchange(module: ModuleType, functions: list[FunctionType], mutant: Mutant, path: Path) -> None:
    """Put a mutant in the place of a module that is imported already, wherever it is used."""
    code = mutant.code(path)
    if mutant.function in at_load(path):
        _replaced(module, code)
        return
    new = {(one.co_qualname, one.co_firstlineno): one for one in _codes(code)}
    for function in functions:
        found = new[function.__code__.co_qualname, function.__code__.co_firstlineno]
        if found.co_freevars == function.__code__.co_freevars:
            function.__code__ = found
        else:  # it has lost the last use of a name around it
            _replaced(module, code)


@functools.cache
def at_load(path: Path) -> set[str]:
    """What runs when a module is loaded: the module, and the functions that it calls itself."""
    tree = ast.parse(path.read_text("utf-8"))
    own = {one.name for one in tree.body if isinstance(one, ast.FunctionDef)}
    called = {
        node.func.id
        for statement in tree.body
        if not isinstance(statement, ast.FunctionDef | ast.ClassDef)
        for node in ast.walk(statement)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    return {"module", *(own & called)}


def _functions(path: Path) -> list[FunctionType]:
    """Every function of a module that is alive, closures that it made among them."""
    return [
        one
        for one in gc.get_objects()
        if isinstance(one, FunctionType) and one.__code__.co_filename == str(path)
    ]


def _codes(code: CodeType) -> Iterator[CodeType]:
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield one
            yield from _codes(one)


def _replaced(module: ModuleType, code: CodeType) -> None:
    """Exchange the values of a module, also where others have imported them by name."""
    fresh = {"__name__": module.__name__, "__file__": module.__file__, "__package__": ""}
    exec(code, fresh)
    old = dict(vars(module))
    for name, value in fresh.items():
        if name.startswith("__") or isinstance(value, type | ModuleType):
            continue
        for other in list(sys.modules.values()):
            if getattr(other, "__name__", "").startswith("kilter") and (
                name in vars(other) and vars(other)[name] is old.get(name)
            ):
                setattr(other, name, value)


def _load_all() -> None:
    """Everything that tests import late, so that no child has to."""
    import kilter

    for one in pkgutil.walk_packages(kilter.__path__, "kilter."):
        if "__main__" not in one.name:
            importlib.import_module(one.name)


def judged(module: str, only: str, seconds: float) -> tuple[int, list[Mutant]]:
    """How many mutants of a module are killed, and which live."""
    asked = Round(module, only, seconds)
    tests = [str(ROOT / test) for test in GUARDS[module]]
    options = ["-n", "0", "-p", "no:cacheprovider", "--no-header", "-q", "--rootdir", str(ROOT)]
    code = pytest.main([*options, "-m", "not slow and not browser", *tests], plugins=[asked])
    if code not in (0, 5):
        raise SystemExit(f"the tests of {module} could not be collected")
    return asked.killed, asked.lived


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("modules", nargs="*", default=list(GUARDS))
    parser.add_argument("--only", default="")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--seconds", type=float, default=LONGEST)
    given = parser.parse_args()
    reasons = tomllib.loads(SURVIVORS.read_text(encoding="utf-8"))
    wrong = 0
    for module in given.modules:
        path = ROOT / "src" / (module.replace(".", "/") + ".py")
        if given.list:
            print(f"{len(mutants(path.read_text('utf-8'))):6}  {module}")
            continue
        started = time.process_time(), os.times()
        killed, lived = judged(module, given.only, given.seconds)
        known = reasons.get(module, {})
        new = [one.name for one in lived if one.name not in known]
        stale = [] if given.only else sorted(set(known) - {one.name for one in lived})
        wrong += len(new) + len(stale)
        ended = os.times()
        cpu = ended.user + ended.children_user - started[1].user - started[1].children_user
        total = killed + len(lived)
        print(
            f"{module}: {killed} of {total} killed ({killed / max(total, 1):.1%}), "
            f"{len(lived) - len(new)} live with a reason, {len(new)} without; {cpu:.0f} s"
        )
        print(*(f"  no reason: {name}" for name in new), sep="\n" if new else "")
        print(*(f"  killed, or gone: {name}" for name in stale), sep="\n" if stale else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
