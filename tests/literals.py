"""Small numbers that stand in the code of a package without a name."""

import ast
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src" / "kilter"
SMALL = 0.01


def unnamed(package: str, but: str) -> list[str]:
    """Places of numbers from 0 to `SMALL` in a package, without modules whose name ends so."""
    found = []
    for path in sorted((SOURCE / package).rglob("*.py")):
        if path.name.endswith(but):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            value = getattr(node, "value", None)
            if isinstance(node, ast.Constant) and isinstance(value, float) and 0 < value < SMALL:
                found.append(f"{path.relative_to(SOURCE)}:{node.lineno}: {value}")
    return found
