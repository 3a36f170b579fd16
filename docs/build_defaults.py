"""Write docs/contributing/defaults.md: the defaults of the public functions, from their signatures.

python docs/build_defaults.py

A default of None stands for a value that depends on the assembly; its meaning is the sentence of
the docstring that contains the word "default".
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

PAGE = Path(__file__).resolve().parent / "contributing/defaults.md"
HEAD = """# Defaults

The defaults of the public functions, computed from the code by `python docs/build_defaults.py`.
A keyword that is None by default appears only if its docstring states a default.
"""


def functions() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Public functions by name."""
    import kilter

    for name in sorted(kilter.__all__):
        value = getattr(kilter, name)
        if inspect.isfunction(value):
            yield name, value


def meaning(function: Callable[..., Any], keyword: str) -> str:
    """Sentence of the docstring about the default of a keyword; empty without such a sentence."""
    text = inspect.getdoc(function) or ""
    found = re.search(
        rf"(?m)^(?:\w+, )*{keyword}(?:, \w+)* ?:?[^\n]*\n((?:    [^\n]*\n?|\n)+)", text
    )
    sentences = re.split(r"(?<=[.;])\s+", " ".join(found[1].split())) if found else []
    return next((one for one in sentences if re.search("default|None", one)), "")


def page() -> str:
    """Text of the page."""
    lines = [HEAD]
    for name, function in functions():
        rows = []
        for keyword, parameter in inspect.signature(function).parameters.items():
            said = meaning(function, keyword)
            known = parameter.default is not None or said
            if parameter.default is not inspect.Parameter.empty and known:
                rows.append(f"| `{keyword}` | `{parameter.default!r}` | {said} |")
        if rows:
            lines += [
                f"## {name}",
                "",
                "| keyword | default | meaning |",
                "|---|---|---|",
                *rows,
                "",
            ]
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
