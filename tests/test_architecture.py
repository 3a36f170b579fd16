"""The house as its page draws it (docs/contributing): layers, names, no circles, from imports."""

from __future__ import annotations

import ast
import re
import tomllib
from collections import Counter, defaultdict
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
HOUSE = ROOT / "src" / "kilter"
SLOW_TO_IMPORT = {
    "numpy",
    "scipy",
    "highspy",
    "clarabel",
    "pydantic",
    "matplotlib",
    "OCP",
    "shapely",
    "numba",
    "kilter.friction",
}
"""Packages for whose sake an import may wait inside a function: start-up."""


def name_of(path: Path) -> str:
    parts = ("kilter", *path.relative_to(HOUSE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {name_of(path): path for path in sorted(HOUSE.rglob("*.py"))}


class Imports(ast.NodeVisitor):
    """Modules that a file imports: at its top, for types only, inside a function."""

    def __init__(self) -> None:
        self.top: set[str] = set()
        self.types: set[str] = set()
        self.inside: set[str] = set()
        self._into = self.top

    def _within(self, target: set[str], nodes: list[ast.stmt]) -> None:
        before, self._into = self._into, target
        for node in nodes:
            self.visit(node)
        self._into = before

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        self._within(self.inside, node.body)

    def visit_If(self, node: ast.If) -> None:
        checking = isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        self._within(self.types if checking else self._into, node.body)
        self._within(self._into, node.orelse)

    def visit_Import(self, node: ast.Import) -> None:
        self._into.update(alias.name for alias in node.names)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        for alias in node.names:
            full = f"{node.module}.{alias.name}"
            self._into.add(full if full in FILES else str(node.module))


@cache
def tree_of(module: str) -> ast.Module:
    """Syntax tree of a module: each file is read once for all tests."""
    return ast.parse(FILES[module].read_text(encoding="utf-8"))


@cache
def imports(module: str) -> Imports:
    found = Imports()
    found.visit(tree_of(module))
    return found


def room(module: str) -> str:
    """The package at the top, or the module at the top, that a module belongs to."""
    return ".".join(module.split(".")[:2])


ROOMS = sorted({room(module) for module in FILES} - {"kilter"})


def circles(arrows: dict[str, set[str]]) -> list[list[str]]:
    """Strongly connected components of more than one node, by Tarjan's method."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(arrows[node]):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            at = stack.index(node)
            group, stack[at:] = stack[at:], []
            if len(group) > 1:
                found.append(sorted(group))

    for node in sorted(arrows):
        if node not in index:
            visit(node)
    return found


def test_circles_finds_a_circle():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == [["b", "c"]]


@pytest.mark.slow
def test_no_two_files_import_each_other():
    """Not even for types, or from inside a function."""
    arrows: dict[str, set[str]] = defaultdict(set)
    for module in set(FILES) - {"kilter"}:
        found = imports(module)
        mine = {m for m in found.top | found.types | found.inside if m in FILES}
        arrows[module] = mine - {module, "kilter"}
    assert circles(arrows) == []


@pytest.mark.slow
def test_no_two_folders_of_analysis_import_each_other():
    """Not even for types, or from inside a function."""
    arrows: dict[str, set[str]] = defaultdict(set)
    for module in FILES:
        found = imports(module)
        for other in found.top | found.types | found.inside:
            here, there = (name.split(".")[1:4] for name in (module, other))
            if here[0:1] == there[0:1] == ["analysis"] and len(here) == len(there) == 3:
                arrows[here[1]].add(there[1])
    pairs = [(a, b) for a in arrows for b in arrows[a] if a < b and a in arrows[b]]
    assert pairs == []
    assert len(arrows) > 10


@pytest.mark.slow
def test_the_longest_chain_of_rooms_is_short():
    below: dict[str, set[str]] = {name: set() for name in ROOMS}
    for module in set(FILES) - {"kilter"}:
        found = imports(module)
        below[room(module)] |= {
            room(m) for m in found.top | found.types | found.inside if m in FILES and m != "kilter"
        } - {room(module)}

    @cache
    def floor(name: str) -> int:
        return 1 + max((floor(other) for other in below[name]), default=0)

    assert circles(below) == []
    assert max(floor(name) for name in ROOMS) <= 15


def slow(modules: set[str]) -> set[str]:
    return ({m.split(".")[0] for m in modules} | {room(m) for m in modules}) & SLOW_TO_IMPORT


@cache
def slow_at_start(module: str) -> frozenset[str]:
    """Slow packages that importing a module brings with it."""
    seen, waiting, found = set(), [module], set()
    while waiting:
        one = waiting.pop()
        if one in seen or one not in FILES:
            continue
        seen.add(one)
        found |= slow(imports(one).top)
        parents = [one.rsplit(".", k)[0] for k in range(1, one.count(".") + 1)]
        waiting += [*imports(one).top, *parents]
    return frozenset(found)


MANY = 3
"""Number of further modules of the house for whose sake an import may wait."""


@cache
def brought(module: str) -> frozenset[str]:
    """Modules of the house that importing a module brings with it, itself included."""
    seen, waiting = set(), [module]
    while waiting:
        one = waiting.pop()
        if one not in seen and one in FILES:
            seen.add(one)
            waiting += imports(one).top
    return frozenset(seen)


ABSENT = ("kilter.contact.pair_findings", "kilter.contact.sharp.feature_pairs")
"""A family of contacts that is absent is not imported (`tests/cli/test_process.py`)."""


@pytest.mark.slow
def test_an_import_waits_inside_a_function_only_for_the_start_up():
    """A late import brings a slow package, or many modules that the importer lacks."""
    needless = [
        f"{module} imports {late} late"
        for module in sorted(set(FILES) - {"kilter"})
        if room(module) not in ("kilter.cli", "kilter.publish", "kilter.__main__")
        for late in sorted(imports(module).inside)
        if late in FILES
        and (module, late) != ABSENT
        and not slow_at_start(late) - slow_at_start(module)
        and len(brought(late) - brought(module)) < MANY
    ]
    assert needless == []


BY_NAME = {
    "kilter.cli.commands": "imports the module of the command that is called, from a table",
    "kilter.health": "imports packages of other projects, to report whether they work",
}
"""Modules that may call `import_module`, with the reason. The lazy tables in `__init__` may too."""


@pytest.mark.slow
def test_no_module_imports_another_by_a_string():
    """An import that the reader of the code, and the tests of layers and circles, cannot see."""
    calls = {
        module
        for module, path in FILES.items()
        if path.name != "__init__.py"
        for node in ast.walk(tree_of(module))
        if isinstance(node, ast.Name | ast.Attribute)
        and (node.id if isinstance(node, ast.Name) else node.attr)
        in ("import_module", "__import__")
    }
    assert calls == set(BY_NAME)


def test_no_two_files_have_one_name():
    names = Counter(p.name for p in FILES.values() if p.name not in ("__init__.py", "__main__.py"))
    assert [name for name, times in names.items() if times > 1] == []


@pytest.mark.slow
def test_no_two_classes_have_one_name():
    names: dict[str, list[str]] = defaultdict(list)
    for module in FILES:
        for node in ast.walk(tree_of(module)):
            if isinstance(node, ast.ClassDef):
                names[node.name].append(module)
    assert {name: places for name, places in names.items() if len(places) > 1} == {}


def layers() -> list[str]:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    [found] = [
        contract
        for contract in contracts["tool"]["importlinter"]["contracts"]
        if contract["type"] == "layers" and "containers" not in contract
    ]
    return [name for line in found["layers"] for name in re.split(r"\s*[|:]\s*", line)]


def test_every_room_has_its_layer():
    assert sorted(layers()) == [name for name in ROOMS if name != "kilter.__main__"]


@pytest.mark.parametrize("page", ["architecture.md"])
def test_the_page_about_the_architecture_names_every_room(page):
    text = (ROOT / "docs/contributing" / page).read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([a-z_]+)` \|", text, flags=re.M)
    assert ["kilter." + row for row in rows] == layers()


def test_the_paths_that_the_page_names_are_there():
    text = (ROOT / "docs/contributing/architecture.md").read_text(encoding="utf-8")
    paths = re.findall(r"`((?:src|web|tests|benchmarks)/[\w/.-]+)`", text)
    assert len(paths) > 10
    assert [path for path in paths if not (ROOT / path).exists()] == []


def test_the_drawing_is_that_of_the_contract():
    """``python docs/build_architecture.py`` draws it anew."""
    source = (ROOT / "docs" / "build_architecture.py").read_text(encoding="utf-8")
    space: dict[str, object] = {"__name__": "drawn", "__file__": str(ROOT / "docs" / "x.py")}
    exec(compile(source, "build_architecture.py", "exec"), space)
    picture = ROOT / "docs" / "images" / "architecture.svg"
    assert space["drawing"]() == picture.read_text(encoding="utf-8")  # type: ignore[operator]


DOUBT_MARKS = {"degenerate", "patch_doubt", "possible"}
"""Attributes of a contact set that mark doubts."""
DOUBT_STEPS = {
    "decide_degenerate",
    "explained_by_accuracy",
    "rests_on_fits",
    "why_fits_leave_it_open",
}
"""Steps of the decision that act on doubts."""


def doubt_readers(tree: ast.Module) -> set[str]:
    """Marks of doubts that a module reads, and steps of the decision that it imports."""
    read = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            read |= {node.attr} & DOUBT_MARKS
        if isinstance(node, ast.ImportFrom):
            read |= {alias.name for alias in node.names} & DOUBT_STEPS
    return read


def test_doubt_readers_finds_a_mark_and_a_step():
    assert doubt_readers(ast.parse("x = contacts.patch_doubt > 0")) == {"patch_doubt"}
    assert doubt_readers(ast.parse("from a import decide_degenerate")) == {"decide_degenerate"}
    assert doubt_readers(ast.parse("doubts.degenerate_points")) == set()


@pytest.mark.slow
def test_only_the_decision_reads_doubts():
    """One cascade: every other analysis calls `decide`, or `Doubts` for the mask of its arrays."""
    # the joined contacts of open pairs are built without the marks, on behalf of the decision
    exempt = {"kilter.analysis.decision.ordinary_contacts"}
    readers = {
        module: doubt_readers(tree_of(module))
        for module in FILES
        if module.startswith(("kilter.analysis.", "kilter.cli.", "kilter.publish"))
        and not module.startswith("kilter.analysis.decision.")
        and module not in exempt
    }
    # Doubts offers its own columns under the name of the mark
    readers["kilter.analysis.planning.states.states"] -= {"degenerate"}
    assert {module: found for module, found in readers.items() if found} == {}


LONGEST, MOST_ARGUMENTS = 60, 10
"""Lines of a function without its docstring, and arguments of a function."""


@pytest.mark.slow
def test_no_function_is_long_or_has_many_arguments():
    """But for `Part`, whose keywords are the keys of a part in a file."""
    found = set()
    for module in FILES:
        for node in ast.walk(tree_of(module)):
            if isinstance(node, ast.FunctionDef):
                text = node.body[0].end_lineno - node.body[0].lineno + 1
                lines = node.end_lineno - node.lineno + 1
                lines -= text if ast.get_docstring(node) else 0
                given = len(node.args.posonlyargs + node.args.args + node.args.kwonlyargs)
                if lines > LONGEST or given > MOST_ARGUMENTS + 1:
                    found.add(f"{module}.{node.name}")
    assert found == {"kilter.assembly.part.__init__"}
