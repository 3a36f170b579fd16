"""Portability: names of POSIX systems, threads, and a release."""

import ast
import datetime
import importlib.util
import json
import multiprocessing
import os
import shutil
import subprocess
import threading
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import kilter
from kilter.threads import on_one_thread

ROOT = Path(__file__).resolve().parents[1]

MODULES = {"fcntl", "grp", "pty", "pwd", "resource", "termios", "tty"}
CALLS = {
    "os.fork", "os.getgid", "os.getuid", "os.geteuid", "os.kill", "os.killpg", "os.mkfifo",
    "os.sched_getaffinity", "os.setsid", "os.statvfs", "os.uname", "os.waitpid",
    "signal.SIGALRM", "signal.SIGHUP", "signal.SIGKILL", "signal.SIGPIPE", "signal.SIGUSR1",
    "signal.alarm", "signal.setitimer",
}  # fmt: skip
METHODS = {"send_signal", "symlink_to"}
"""Methods of any object: Windows sends no SIGINT, and links need a privilege there."""
ARGUMENTS = {"pass_fds", "preexec_fn", "start_new_session"}
FOLDERS = ("/dev/", "/proc/", "/sys/")
GUARDS = ("os.name", "sys.platform", "hasattr", "AttributeError", "ImportError")


def posix_names(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and text of each use of a name that some systems lack."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, a.name) for a in node.names if a.name in MODULES)
        elif isinstance(node, ast.ImportFrom) and node.module in MODULES:
            yield node.lineno, str(node.module)
        elif isinstance(node, ast.Attribute):
            name = f"{node.value.id}.{node.attr}" if isinstance(node.value, ast.Name) else node.attr
            if name in CALLS or node.attr in METHODS:
                yield node.lineno, name
        elif isinstance(node, ast.keyword) and node.arg in ARGUMENTS:
            yield node.value.lineno, node.arg
        elif (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and node.value.startswith(FOLDERS)
        ):
            yield node.lineno, node.value


def guarded_lines(tree: ast.AST) -> set[int]:
    """Lines of each statement whose condition, or whose context, asks what the system has."""
    lines: set[int] = set()
    for node in ast.walk(tree):
        asked: list[ast.AST] = []
        if isinstance(node, ast.If | ast.IfExp):
            asked = [node.test]
        elif isinstance(node, ast.With):
            asked = [item.context_expr for item in node.items]
        elif isinstance(node, ast.Try):
            asked = [handler.type for handler in node.handlers if handler.type]
        elif isinstance(node, ast.FunctionDef):
            asked = [
                one.test
                for one in node.body
                if isinstance(one, ast.If) and isinstance(one.body[-1], ast.Return)
            ]
        if any(guard in ast.unparse(one) for one in asked for guard in GUARDS):
            lines |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return lines


def unguarded(source: str) -> list[tuple[int, str]]:
    """Uses of POSIX names outside a condition that asks what the system has."""
    tree = ast.parse(source)
    safe = guarded_lines(tree)
    return [(line, name) for line, name in posix_names(tree) if line not in safe]


def functions_of(tree: ast.Module) -> dict[str, ast.FunctionDef]:
    """Functions at the top of a module, by name."""
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


def unmarked_tests(source: str) -> list[str]:
    """Tests that need a POSIX name, directly or by a function of their module, without a skip."""
    tree = ast.parse(source)
    safe = guarded_lines(tree)
    functions = functions_of(tree)
    need = {
        name
        for name, node in functions.items()
        if any(line not in safe for line, _ in posix_names(node))
    }
    calls = {
        name: {n.id for n in ast.walk(node) if isinstance(n, ast.Name)} & set(functions)
        for name, node in functions.items()
    }
    while more := {name for name, called in calls.items() if called & need} - need:
        need |= more
    skips = [
        ast.unparse(node.targets[0])
        for node in tree.body
        if isinstance(node, ast.Assign) and "skipif" in ast.unparse(node.value)
    ]
    imported = [
        "import " + name
        for node in tree.body
        if isinstance(node, ast.Import | ast.ImportFrom)
        for _, name in posix_names(node)
    ]  # a skip does not help there
    if "pytestmark" in skips:
        return imported
    return imported + [
        name
        for name in sorted(need)
        if name.startswith("test_")
        and not any(
            "skipif" in mark or mark in skips
            for mark in map(ast.unparse, functions[name].decorator_list)
        )
    ]


def text_without_encoding(source: str) -> list[int]:
    """Lines that open a text file in the encoding of the system instead of UTF-8."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call):
            continue
        given = {keyword.arg for keyword in node.keywords}
        name = getattr(node.func, "id", None) or getattr(node.func, "attr", "")
        if isinstance(node.func, ast.Name) and name == "open":
            mode = ast.unparse(node.args[1]) if len(node.args) > 1 else "'r'"
            wrong = "b" not in mode and "encoding" not in given
        else:
            texts = {"read_text": 0, "write_text": 1}
            wrong = name in texts and "encoding" not in given and len(node.args) <= texts[name]
        if wrong:
            found.append(node.lineno)
    return found


SOURCES = sorted((ROOT / "src").rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("test_*.py"))


@pytest.mark.slow
def test_the_program_guards_each_name_that_only_posix_has():
    found = {
        path.relative_to(ROOT).as_posix(): uses
        for path in SOURCES
        if (uses := unguarded(path.read_text(encoding="utf-8")))
    }
    assert not found


@pytest.mark.slow
def test_the_program_opens_each_text_file_as_utf_8():
    found = {
        path.relative_to(ROOT).as_posix(): lines
        for path in SOURCES
        if (lines := text_without_encoding(path.read_text(encoding="utf-8")))
    }
    assert not found


@pytest.mark.slow
def test_each_test_that_needs_posix_is_skipped_on_other_systems():
    found = {
        path.relative_to(ROOT).as_posix(): names
        for path in TESTS
        if path.name != Path(__file__).name
        and (names := unmarked_tests(path.read_text(encoding="utf-8")))
    }
    assert not found


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("import os\nos.kill(1, 9)", [(2, "os.kill")]),
        ("import os\nif hasattr(os, 'kill'):\n    os.kill(1, 9)", []),
        ("import fcntl", [(1, "fcntl")]),
        ("def f():\n    if sys.platform != 'linux':\n        return\n    import pwd", []),
        ("open('/proc/self')", [(1, "/proc/self")]),
    ],
)
def test_the_search_finds_what_is_not_guarded(source, found):
    assert unguarded(source) == found


def test_the_search_finds_a_test_without_a_skip_also_by_its_helper():
    source = "import os\ndef end():\n    os.kill(1, 9)\n{}def test_a():\n    end()\n"
    assert unmarked_tests(source.format("")) == ["test_a"]
    mark = "@pytest.mark.skipif(os.name != 'posix', reason='signals')\n"
    assert unmarked_tests(source.format(mark)) == []
    assert unmarked_tests("import resource\npytestmark = pytest.mark.skipif(True)") == [
        "import resource"
    ]


def test_the_search_finds_text_in_the_encoding_of_the_system():
    assert text_without_encoding("open('a')\nopen('a', 'rb')\np.write_text('x')\n") == [1, 3]
    assert text_without_encoding("p.read_text('utf-8')\np.write_text('x', 'utf-8')") == []


def threads() -> set[int]:
    np.linalg.norm(np.ones(2))
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


@on_one_thread
def inner() -> set[int]:
    return threads()


@on_one_thread
def outer() -> tuple[set[int], set[int]]:
    return inner(), threads()


def test_a_call_within_another_leaves_the_one_thread_to_it():
    with threadpool_limits(limits=2):
        if threads() != {2}:
            pytest.skip("linear algebra here has one thread only")
        assert outer() == ({1}, {1})
        assert threads() == {2}


def test_threads_come_back_after_a_call_that_failed():
    @on_one_thread
    def fails() -> None:
        raise ZeroDivisionError

    with threadpool_limits(limits=2):
        before = threads()
        with pytest.raises(ZeroDivisionError):
            fails()
        assert threads() == before


def beside(act: Callable[[], None]) -> set[int]:
    """Run something while a call on another thread is inside; the threads that call has after."""
    begun, go_on = threading.Event(), threading.Event()
    found: list[set[int]] = []

    @on_one_thread
    def waits() -> None:
        begun.set()
        go_on.wait(60)
        found.append(threads())

    other = threading.Thread(target=waits)
    other.start()
    begun.wait(60)
    act()
    go_on.set()
    other.join()
    return found[0]


def test_a_call_that_ends_leaves_the_one_thread_to_a_call_beside_it():
    with threadpool_limits(limits=2):
        if threads() != {2}:
            pytest.skip("linear algebra here has one thread only")
        seen: list[set[int]] = []
        assert beside(lambda: seen.append(inner())) == {1}
        assert seen == [{1}]
        assert threads() == {2}


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork there")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork")
def test_a_process_forked_beside_a_call_has_what_was_before_it():
    with threadpool_limits(limits=2):
        if threads() != {2}:
            pytest.skip("linear algebra here has one thread only")
        found: list[list[set[int]]] = []

        def forks() -> None:
            with multiprocessing.get_context("fork").Pool(1) as pool:
                found.append(pool.apply(lived))

        assert beside(forks) == {1}
        assert found == [[{2}, {1}, {2}]]


def lived() -> list[set[int]]:
    """Threads before, within and after a call."""
    return [threads(), inner(), threads()]


PROGRAMS = ROOT / ".ci"
FILES = (
    "src/kilter/__init__.py", "CITATION.cff", "conda/recipe.yaml", "docs/index.md",
    "CHANGELOG.md", "pyproject.toml", "mkdocs.yml", "README.md",
    ".github/ISSUE_TEMPLATE/config.yml",
)  # fmt: skip
WORKFLOWS = (".github/workflows/tests.yml", ".github/workflows/release.yml")
REPOSITORY, SITE = "https://github.com/owner/kilter", "https://owner.github.io/kilter"


def program(name: str) -> ModuleType:
    """A program of the folder .ci as a module."""
    spec = importlib.util.spec_from_file_location(name, PROGRAMS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The files that a release or an address changes, and the notebooks."""
    notebooks = [path.relative_to(ROOT).as_posix() for path in (ROOT / "examples").glob("*.ipynb")]
    for name in (*FILES, *notebooks):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


@pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
def test_each_file_states_the_version_of_the_package():
    assert set(program("release").versions().values()) == {kilter.__version__}


@pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
def test_a_release_sets_the_version_and_dates_the_changelog(copy):
    release = program("release")
    for version in ("0.2.0", "0.3.0"):
        release.set_version(version, datetime.date(2027, 1, 31), copy)
        assert set(release.versions(copy).values()) == {version}
    changes = (copy / "CHANGELOG.md").read_text(encoding="utf-8")
    assert changes.index("## [Unreleased]") < changes.index("## [0.3.0] - 2027-01-31")
    assert changes.index("## [0.3.0]") < changes.index("## [0.2.0]")
    citation = (copy / "CITATION.cff").read_text(encoding="utf-8")
    assert citation.count("date-released: 2027-01-31") == 1
    with pytest.raises(SystemExit, match="is no version: give three numbers"):
        release.set_version("0.3", datetime.date(2027, 1, 31), copy)


AUDITS = {
    "bad": ({"vulns": [{"id": "PYSEC-1"}, {"id": "PYSEC-2"}]}, "solver 1.0: PYSEC-1, PYSEC-2"),
    "good": ({"vulns": []}, "no known vulnerability, 1 of 2 packages audited"),
    "unknown": ({"skip_reason": "not found"}, "the service of pip-audit knows none"),
    "unreachable": (None, "not audited, pip-audit failed: no route to the service"),
}


@pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
@pytest.mark.parametrize("case", AUDITS)
def test_only_a_known_vulnerability_ends_a_release(case, monkeypatch, capsys):
    """A service that is out of reach, or knows no package, is named: it proves nothing."""
    answer, sentence = AUDITS[case]
    other = {"name": "own", "skip_reason": "not found"}
    packages = [{"name": "solver", "version": "1.0", **(answer or {})}, other]
    output = json.dumps({"dependencies": packages}) if answer else ""
    done = subprocess.CompletedProcess([], 1, output, "Traceback\nno route to the service\n")
    release = program("release")
    monkeypatch.setattr(release.subprocess, "run", lambda *_, **__: done)
    if case == "bad":
        with pytest.raises(SystemExit, match="no file was changed"):
            release.audit_all()
    else:
        release.audit_all()
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(release.requirements())
    assert all(sentence in line for line in lines)


@pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
def test_an_audit_names_the_requirements_of_users():
    release = program("release")
    required = release.requirements()
    assert {"kilter", "step", "mcp"} <= set(required)
    assert not set(required) & release.DEVELOPERS
    assert all(set(required["kilter"]) <= set(lines) for lines in required.values())
    assert any(line.startswith("mcp") for line in required["mcp"])


@pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
def test_every_place_states_the_same_pythons():
    """Classifiers, the checks of a release, the workflows and the recipe."""
    with open(ROOT / "pyproject.toml", "rb") as stream:
        project = tomllib.load(stream)["project"]
    heading = "Programming Language :: Python :: 3."
    stated = [int(c.removeprefix(heading)) for c in project["classifiers"] if c.startswith(heading)]
    first, last = stated[0], stated[-1]
    assert stated == list(range(first, last + 1))
    pythons = tuple(f"3.{minor}" for minor in stated)
    assert pythons == program("package").PYTHONS
    assert project["requires-python"] == f">=3.{first},<3.{last + 1}"
    texts = {
        name: (ROOT / name).read_text(encoding="utf-8")
        for name in (*FILES, "CONTRIBUTING.md", *WORKFLOWS)
    }
    for name in ("README.md", "docs/index.md", "CONTRIBUTING.md"):
        assert f"Python 3.{first} to 3.{last}" in texts[name], name
    assert f"python {project['requires-python']}" in texts["conda/recipe.yaml"]
    for name in WORKFLOWS:
        assert f"python: {json.dumps(pythons)}" in texts[name], name


@pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
def test_the_recipe_needs_what_the_package_needs():
    with open(ROOT / "pyproject.toml", "rb") as stream:
        needed = tomllib.load(stream)["project"]["dependencies"]
    recipe = (ROOT / "conda/recipe.yaml").read_text(encoding="utf-8")
    for line in needed:
        name, bound = line.replace("[extras]", "").split(">=")
        assert f"- {name} >={bound}\n" in recipe, line


@pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
def test_an_address_reaches_each_file_and_can_be_changed(copy):
    address = program("set_address")
    untouched = {path: path.read_bytes() for path in copy.rglob("*") if path.is_file()}
    address.set_address("https://example.org/a/b", "https://example.org/c", copy)
    address.set_address(REPOSITORY, SITE, copy)
    for path, before in untouched.items():
        text = path.read_text(encoding="utf-8")
        assert "example.org" not in text
        unchanged = {"CHANGELOG.md", "__init__.py", "index.md"}
        assert (path.read_bytes() == before) == (path.name in unchanged), path.name
    with open(copy / "pyproject.toml", "rb") as stream:
        urls = tomllib.load(stream)["project"]["urls"]
    assert urls["Repository"] == REPOSITORY
    assert urls["Documentation"] == SITE
    for path in (copy / "examples").glob("*.ipynb"):
        first = json.loads(path.read_text(encoding="utf-8"))["cells"][0]
        assert "".join(first["source"]).count(f"/owner/kilter/blob/main/examples/{path.name}") == 1
    with pytest.raises(SystemExit, match="kilter is no address: give https://HOST/OWNER/NAME"):
        address.set_address("kilter", SITE, copy)
