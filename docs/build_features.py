"""Write docs/contributing/features.md from the names of the tests in tests/test_features.py.

python docs/build_features.py
"""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TESTS = ROOT / "tests/test_features.py"
PAGE = ROOT / "docs/contributing/features.md"
MISSING = "TestMissing"
HEAD = """# Features and missing features

Each row is the name of a test in `tests/test_features.py`: a row exists because a test shows it.
`python docs/build_features.py` writes this page.
For other questions, [alternatives](../explanation/alternatives.md) names other programs.
"""


def sections() -> dict[str, list[str]]:
    """Rows of each class of tests: their names in words."""
    tree = ast.parse(TESTS.read_text(encoding="utf-8"))
    return {
        node.name: [
            one.name.removeprefix("test_").replace("_", " ")
            for one in node.body
            if isinstance(one, ast.FunctionDef) and one.name.startswith("test_")
        ]
        for node in tree.body
        if isinstance(node, ast.ClassDef)
    }


def page() -> str:
    """Text of the page."""
    lines = [HEAD]
    for name, rows in sections().items():
        title = "Missing" if name == MISSING else name.removeprefix("Test")
        sign = "no" if name == MISSING else "yes"
        lines += [f"## {title}", "", "| | |", "|---|---|"]
        lines += [f"| {sign} | {_capital(row)} |" for row in rows]
        lines.append("")
    return "\n".join(lines)


def _capital(row: str) -> str:
    """A row that begins with a capital letter; names of formats are written as usual."""
    for word in ("stl", "obj", "glb", "3mf", "step", "json", "ply"):
        row = " ".join(word.upper() if one == word else one for one in row.split())
    return row[0].upper() + row[1:]


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
