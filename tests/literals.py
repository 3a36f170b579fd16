"""Small numbers that stand in the code of a package without a name."""

import ast
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src" / "kilter"
SMALL = 0.01


def unnamed(package: str, but: str) -> list[str]:
    """Places of numbers from 0 to `SMALL` in a package, without modules whose name ends so.

    A constant of a module (`NAME = 1e-6`) is a name.
    """
    found = []
    for path in sorted((SOURCE / package).rglob("*.py")):
        if path.name.endswith(but):
            continue
        tree = ast.parse(path.read_text())
        named = {
            id(line.value) for line in tree.body if isinstance(line, ast.Assign | ast.AnnAssign)
        }
        for node in ast.walk(tree):
            if id(node) in named:
                continue
            value = getattr(node, "value", None)
            if isinstance(node, ast.Constant) and isinstance(value, float) and 0 < value < SMALL:
                found.append(f"{path.relative_to(SOURCE)}:{node.lineno}: {value}")
    return found
