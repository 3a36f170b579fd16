"""Tests of a source file, for `pytest --for FILE`: they import it, or modules that import it."""

import functools
import re
import tomllib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENOUGH = 60
"""Test functions after which no file is added: with their cases they take less than 10 s."""
IMPORT = re.compile(r"^\s*(?:from ([\w.]+) import (\([^)]*\)|.*)|import ([\w.]+))", re.MULTILINE)
NAMED = re.compile(r"\"(kilter(?:\.\w+)+)\"")
TEST = re.compile(r"^\s*def test_", re.MULTILINE)


def near_tests(source: Path) -> list[Path]:
    """Test files of `source`, nearest first: those of `guards.toml`, then by imports and names."""
    name = _module(source.resolve())
    guards = tomllib.loads((ROOT / "tests/mutation/guards.toml").read_text(encoding="utf-8"))
    chosen = [ROOT / path for path in guards.get(name, [])]
    count = sum(_tests(path) for path in chosen)
    for path in _by_distance(name):
        if count < ENOUGH and path not in chosen and count + _tests(path) < 2 * ENOUGH:
            chosen.append(path)
            count += _tests(path)
    return chosen


def _by_distance(name: str) -> list[Path]:
    """Test files by their distance in imports, less two for each word of the module they share.

    Of equal ones the file that imports fewer modules comes first.
    """
    files = [*ROOT.glob("src/kilter/**/*.py"), *ROOT.glob("tests/*.py"), *ROOT.glob("tests/*/*.py")]
    places = {_module(path): path for path in files if path.parent.name != "browser"}
    imports = {module: _imports(path) & places.keys() for module, path in places.items()}
    words, distance, rank = _words(name.split(".")), 0, {}
    seen, level = {name}, {name}
    while level:
        distance += 1
        level = {module for module in imports if imports[module] & level} - seen
        seen |= level
        for module in level:
            if module.startswith("test_"):
                shared = words & _words((places[module].parent.name, module))
                rank[module] = (distance - 2 * len(shared), len(imports[module]), module)
    return [places[module] for module in sorted(rank, key=lambda module: rank[module])]


def _words(names: Iterable[str]) -> set[str]:
    """Beginnings of the words of names, without endings of a plural."""
    return {word[:5].rstrip("s") for name in names for word in name.split("_")} - {"analy", "test"}


@functools.cache
def _imports(path: Path) -> set[str]:
    """Names of modules, and of what is imported from them, that may be modules."""
    text = path.read_text(encoding="utf-8")
    found = set(NAMED.findall(text))
    for module, names, whole in IMPORT.findall(text):
        words = (module or whole).split(".")
        found |= {".".join(words[: k + 1]) for k in range(len(words))}
        found |= {f"{module}.{name}" for name in re.findall(r"\w+", names)}
    return found - {"kilter"}


def _module(path: Path) -> str:
    """Name by which a file of the library, or a file of the tests, is imported."""
    if path.is_relative_to(ROOT / "src"):
        words = path.relative_to(ROOT / "src").with_suffix("").parts
        return ".".join(words[:-1] if words[-1] == "__init__" else words)
    return path.stem


def _tests(path: Path) -> int:
    """Number of test functions of a file."""
    return len(TEST.findall(path.read_text(encoding="utf-8")))
