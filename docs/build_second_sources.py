"""Write docs/contributing/sources.md from `tests/second_sources.toml`.

python docs/build_second_sources.py

The table names, for each number of each answer, the test that compares it with a closed form or
with a second method. The numbers are the leaves of the published JSON schemas.
"""

from __future__ import annotations

import ast
import json
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SCHEMAS = ROOT / "src/kilter/files/schemas"
TABLE = ROOT / "tests/second_sources.toml"
PAGE = ROOT / "docs/contributing/sources.md"
INPUTS = ("assembly", "choices")
"""Schemas that are not those of answers."""
HEAD = """# How do we know?

Each number of an answer has a second source: a test compares it with a closed form, or with a
second method that shares no code with kilter. This page lists the test of each key. A key that
nobody can compare is a convention of kilter: a tolerance, a count of its own work, or a time.

`python docs/build_second_sources.py` writes this page from `tests/second_sources.toml`. A test
fails if an answer has a number without an entry, or if the named test does not exist. In a key, `*`
stands for any name. `a.b` is the key `b` of the object at `a`, or of each object of this list.

{keys} keys are numbers: {compared} are compared, and {conventions} are conventions.

"""


def numeric_keys() -> list[str]:
    """Paths of all numbers of all answers, such as "check.parts.mass", sorted."""
    found: set[str] = set()
    for path in SCHEMAS.glob("*.schema.json"):
        answer = path.name.removesuffix(".schema.json")
        if answer not in INPUTS:
            schema = json.loads(path.read_text(encoding="utf-8"))
            found.update(_numbers(schema, answer, schema.get("$defs", {})))
    return sorted(found)


def _numbers(node: dict[str, Any], path: str, named: dict[str, Any]) -> Iterator[str]:
    """Paths of the numbers of a schema; items of lists have the path of their list."""
    if "$ref" in node:
        yield from _numbers(named[node["$ref"].rpartition("/")[2]], path, named)
    if node.get("type") in ("number", "integer"):
        yield path
    for kind in ("anyOf", "oneOf", "allOf", "prefixItems"):
        for branch in node.get(kind, []):
            yield from _numbers(branch, path, named)
    for key, inner in node.get("properties", {}).items():
        yield from _numbers(inner, f"{path}.{key}", named)
    for key, suffix in (("items", ""), ("additionalProperties", ".<name>")):
        if isinstance(node.get(key), dict):
            yield from _numbers(node[key], path + suffix, named)


def entries() -> list[dict[str, Any]]:
    """Rows of the table: keys with a test and a method, or with the reason of a convention."""
    rows: list[dict[str, Any]] = tomllib.loads(TABLE.read_text(encoding="utf-8"))["row"]
    return rows


def matches(pattern: str, key: str) -> bool:
    """Whether a key has the form of a pattern, whose stars stand for one name each."""
    return re.fullmatch(re.escape(pattern).replace(r"\*", r"[^.]+"), key) is not None


def names_in(path: str) -> set[str]:
    """Names of the functions and methods of a file of tests."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}


def page() -> str:
    """Text of the page."""
    rows, keys = entries(), numeric_keys()
    known = {key for row in rows if "test" in row for key in keys if _covers(row, key)}
    lines = [
        HEAD.format(keys=len(keys), compared=len(known), conventions=len(keys) - len(known)),
        "## Compared numbers\n\n| keys | compared with | test |\n|---|---|---|\n",
    ]
    for row in rows:
        if "test" in row:
            test = row["test"].removeprefix("tests/")
            lines.append(f"| {_keys(row)} | {row['by']} | `{test}` |\n")
    lines.append("\n## Conventions\n\n| keys | reason |\n|---|---|\n")
    lines += [f"| {_keys(row)} | {row['why']} |\n" for row in rows if "why" in row]
    return "".join(lines)


def _covers(row: dict[str, Any], key: str) -> bool:
    return any(matches(pattern, key) for pattern in row["keys"])


def _keys(row: dict[str, Any]) -> str:
    return ", ".join(f"`{key}`" for key in row["keys"])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
