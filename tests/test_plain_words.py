"""Plain technical English: rates of vague words in docstrings, documents, messages and the page."""

import ast
import inspect
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "kilter"
VAGUE = {
    "what": (r"\bwhat\b", 1.5),
    "one": (r"\b(?:one|ones)\b", 3.0),
    "where": (r"\bwhere\b", 3.0),
    "is told": (
        r"\b(?:is|are|was|were|be|been|being)\s+(?:not\s+|only\s+|never\s+|also\s+)?"
        r"(?:told|asked|said|sought)\b",
        0.1,
    ),
}
"""Vague words as regular expressions, with the most per 1,000 words."""
OPENING = re.compile(r"(?:What|Of|Such|Some|Those)\b")
"""First words of a docstring whose sentence has no subject yet."""
SENTENCE = 3
"""Strings of the code with fewer words than this are keys and names, not messages."""
WORD = re.compile(r"[A-Za-z][A-Za-z'-]*")


def rates(texts: list[str]) -> dict[str, float]:
    """Vague words per 1,000 words."""
    count = sum(len(WORD.findall(text)) for text in texts)
    return {
        name: 1000 * sum(len(re.findall(form, text, re.I)) for text in texts) / max(count, 1)
        for name, (form, _) in VAGUE.items()
    }


def too_many(texts: list[str]) -> dict[str, float]:
    """Rates above their limits."""
    return {name: rate for name, rate in rates(texts).items() if rate > VAGUE[name][1]}


@cache
def tree_of(path: Path) -> ast.Module:
    """Syntax tree of a file: each file is read once for all tests."""
    return ast.parse(path.read_text(encoding="utf-8"))


def docstrings(folder: Path) -> Iterator[tuple[str, str]]:
    """Place and text of each docstring below a folder, those under fields and constants too."""
    for path in sorted(folder.rglob("*.py")):
        for node in ast.walk(tree_of(path)):
            bare = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            if bare and isinstance(node.value.value, str):
                text = inspect.cleandoc(node.value.value)
                text = re.sub(r"(?m)^\s*(?:>>>|\.\.\.).*$", "", text)  # examples are code
                yield f"{path.relative_to(ROOT)}:{node.lineno}", text


def messages() -> list[str]:
    """String constants of the code that are sentences, docstrings left out."""
    found = []
    for path in sorted(SOURCE.rglob("*.py")):
        tree = tree_of(path)
        bare = {
            id(node.value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        }
        for node in ast.walk(tree):
            value = getattr(node, "value", None) if isinstance(node, ast.Constant) else None
            if isinstance(value, str) and id(node) not in bare:
                found += [value] * (len(WORD.findall(value)) >= SENTENCE)
    return found


def prose(path: Path) -> str:
    """The text of a document without code, targets of links, and questions ("what if?")."""
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"```.*?```|<code>.*?</code>", "", text, flags=re.S)
    text = re.sub(r"`[^`]*`|(?<=\])\([^)\s]*\)", "", text)
    return re.sub(r"[^.!?|\[\n]*\?", "", text)


def page_strings() -> list[str]:
    """Strings of the page's program that are sentences."""
    found = []
    for path in sorted((ROOT / "web" / "src").rglob("*.js")):
        text = re.sub(r"^\s*(?://|\*|/\*).*$", "", path.read_text(encoding="utf-8"), flags=re.M)
        for groups in re.findall(r'"([^"\n]*)"|`([^`]*)`', text):
            string = re.sub(r"\$\{[^}]*\}", "", groups[0] or groups[1])
            if len(WORD.findall(string)) >= SENTENCE and "=" not in string:
                found.append(string)
    return found


def test_the_counter_finds_vague_words():
    found = rates(["What stands is said where one asks"])
    assert {name: round(rate * 7 / 1000) for name, rate in found.items()} == dict.fromkeys(VAGUE, 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    "package", sorted(path.name for path in SOURCE.iterdir() if (path / "__init__.py").exists())
)
def test_docstrings_of_a_package_are_plain(package):
    assert too_many([text for _, text in docstrings(SOURCE / package)]) == {}


@pytest.mark.slow
def test_no_docstring_begins_without_a_subject():
    bad = [f"{place}: {text.splitlines()[0]}" for place, text in docstrings(SOURCE)]
    assert [line for line in bad if OPENING.match(line.split(": ", 1)[1])] == []


@pytest.mark.parametrize(
    "path",
    [*sorted((ROOT / "docs").rglob("*.md")), ROOT / "README.md", ROOT / "CHANGELOG.md"],
    ids=lambda path: str(path.relative_to(ROOT)),
)
def test_a_document_is_plain(path):
    text = prose(path)
    few = 1000 / max(len(WORD.findall(text)), 1)  # a short page may have a single such word
    over = {name: rate for name, rate in too_many([text]).items() if rate > few + 1e-9}
    assert over == {}


@pytest.mark.slow
def test_messages_are_plain():
    assert too_many(messages()) == {}


def test_strings_of_the_page_are_plain():
    strings = page_strings()
    assert len(strings) > 20
    assert too_many(strings) == {}
