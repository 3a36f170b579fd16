"""Names that exist only on POSIX systems: the program guards them, and tests that need them skip.

The search is static: a run on Linux also finds code that would break on Windows or macOS.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

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
def test_the_program_guards_each_name_that_only_posix_has() -> None:
    found = {
        path.relative_to(ROOT).as_posix(): uses
        for path in SOURCES
        if (uses := unguarded(path.read_text(encoding="utf-8")))
    }
    assert not found


@pytest.mark.slow
def test_the_program_opens_each_text_file_as_utf_8() -> None:
    found = {
        path.relative_to(ROOT).as_posix(): lines
        for path in SOURCES
        if (lines := text_without_encoding(path.read_text(encoding="utf-8")))
    }
    assert not found


@pytest.mark.slow
def test_each_test_that_needs_posix_is_skipped_on_other_systems() -> None:
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
def test_the_search_finds_what_is_not_guarded(source: str, found: list[tuple[int, str]]) -> None:
    assert unguarded(source) == found


def test_the_search_finds_a_test_without_a_skip_also_by_its_helper() -> None:
    source = "import os\ndef end():\n    os.kill(1, 9)\n{}def test_a():\n    end()\n"
    assert unmarked_tests(source.format("")) == ["test_a"]
    mark = "@pytest.mark.skipif(os.name != 'posix', reason='signals')\n"
    assert unmarked_tests(source.format(mark)) == []
    assert unmarked_tests("import resource\npytestmark = pytest.mark.skipif(True)") == [
        "import resource"
    ]


def test_the_search_finds_text_in_the_encoding_of_the_system() -> None:
    assert text_without_encoding("open('a')\nopen('a', 'rb')\np.write_text('x')\n") == [1, 3]
    assert text_without_encoding("p.read_text('utf-8')\np.write_text('x', 'utf-8')") == []
