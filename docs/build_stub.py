"""Write src/kilter/__init__.pyi: what type checkers and editors see of the public names.

python docs/build_stub.py

Functions with the keywords of `kilter.assembly.question.Question` have their signature and their
docstring there, as they are at run time. All other names are imported from their modules.
"""

from __future__ import annotations

import ast
import importlib
import inspect
from collections import defaultdict
from pathlib import Path
from typing import Any

import kilter

STUB = Path(__file__).resolve().parents[1] / "src/kilter/__init__.pyi"
RECORD = "kilter.assembly.question"
HEAD = '''"""Public names of kilter, written by `python docs/build_stub.py`."""

'''
TAIL = """
__version__: str
__all__: list[str]
_HOMES: dict[str, str]
"""


def is_asked(value: Any) -> bool:
    """Whether a public name is a function with the keywords of a question."""
    return inspect.isfunction(value) and hasattr(value, "__signature__")


def homes_of(module: str) -> dict[str, str]:
    """Module of each name that a module imports from a module, or defines."""
    tree = ast.parse(Path(importlib.import_module(module).__file__ or "").read_text("utf-8"))
    homes: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            homes |= {alias.name: node.module for alias in node.names}
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else [node]
        homes |= {name: module for each in targets if (name := _name(each))}
    return homes


def _name(node: ast.AST) -> str:
    """Name that a statement defines; empty for other statements."""
    return getattr(node, "id", "") or getattr(node, "name", "")


def function(name: str, value: Any) -> str:
    """The stub of a function: its signature and its docstring."""
    signature, lines, named = inspect.signature(value), [], False
    for each in signature.parameters.values():
        if each.kind is each.KEYWORD_ONLY and not named:
            lines.append("*,")
            named = True
        stars = "**" if each.kind is each.VAR_KEYWORD else ""
        default = "" if each.default is each.empty else f" = {each.default!r}".replace("'", '"')
        kind = each.annotation.replace("'", '"')
        lines.append(f"{stars}{each.name}: {kind}{default},")
    inner = "\n    ".join(lines)
    text = inspect.getdoc(value).replace("\n", "\n    ").replace("\n    \n", "\n\n")
    quotes = 'r"""' if "\\" in text else '"""'
    head = f"def {name}(\n    {inner}\n) -> {signature.return_annotation}:\n"
    return f'{head}    {quotes}{text}\n    """\n'


def page() -> str:
    """Text of the stub."""
    imports: dict[str, set[str]] = defaultdict(set)
    bodies = []
    for name, home in sorted(kilter._HOMES.items()):
        value = getattr(kilter, name)
        if not is_asked(value):
            imports[home].add(f"{name} as {name}")
            continue
        bodies.append(function(name, value))
        known = homes_of(RECORD) | homes_of(home)
        signature = inspect.signature(value)
        texts = [each.annotation for each in signature.parameters.values()]
        for text in [*texts, signature.return_annotation]:
            for node in ast.walk(ast.parse(text)):
                word = _name(node)
                if word in known and word not in kilter._HOMES:
                    imports[known[word]].add(word)
    lines = [
        f"from {home} import {word}"
        for home in sorted(imports, key=lambda home: (home.startswith("kilter"), home))
        for word in sorted(imports[home])
    ]
    return HEAD + "\n".join(lines) + "\n" + TAIL + "\n" + "\n".join(bodies)


if __name__ == "__main__":
    STUB.write_text(page(), encoding="utf-8")
