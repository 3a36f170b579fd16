"""Read the entries of a small kilter file by the published schema, without pydantic.

The import of pydantic takes longer than a small assembly takes to check. `plain_entries` therefore
reads small valid files itself. All others, and each faulty file, are left to the models, which
name the fault.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

SHAPES = ("mesh", "box", "cylinder", "sphere", "polygon", "step", "solid")
"""Keys for the shape of a part; a part has exactly one of them."""
SCHEMA = Path(__file__).parents[1] / "schemas" / "assembly.schema.json"
MOST_VALUES = 2000
"""Most values that are read without pydantic, whose compiled code reads many values faster."""
TYPES = {"string": str, "boolean": bool, "array": list, "object": dict, "integer": int}
"""Type in Python of the values of each type of the schema, except for numbers and null."""


class _NotPlainError(Exception):
    """The value is invalid, or must be read by the models."""


def plain_entries(data: Any) -> Any | None:
    """The entries of a small valid kilter file, with the attributes of `AssemblyFile`.

    Returns `entries`: None if the content is invalid, has more than `MOST_VALUES` values or defines
    a solid.
    """
    schema = json.loads(SCHEMA.read_text("utf-8"))
    try:
        return _Reader(schema["$defs"]).read(data, schema)
    except _NotPlainError:
        return None


class _Reader:
    """Reader of values by their schema; it counts the values."""

    def __init__(self, definitions: Mapping[str, Any]) -> None:
        self._definitions = definitions
        self._values = 0

    def read(self, value: Any, schema: Mapping[str, Any]) -> Any:
        """The value as the models would return it; raises `_NotPlainError` if it is invalid."""
        self._values += 1
        if self._values > MOST_VALUES:
            raise _NotPlainError
        if "$ref" in schema:
            return self.read(value, self._definitions[schema["$ref"].rpartition("/")[2]])
        kind = schema.get("type")
        if kind is None:
            return self._read_union(value, schema.get("anyOf") or schema["oneOf"])
        if kind == "number":
            return _number(value, schema)
        wrong = value is not None if kind == "null" else type(value) is not TYPES[kind]
        if kind == "string" and not wrong:
            wrong = any("\ud800" <= character <= "\udfff" for character in value)  # no UTF-8
        allowed = schema.get("enum", [schema.get("const", value)])
        if wrong or value not in allowed:
            raise _NotPlainError
        if kind in ("string", "array"):
            shortest = schema.get("minLength", schema.get("minItems", 0))
            if not shortest <= len(value) <= schema.get("maxItems", len(value)):
                raise _NotPlainError
        if "prefixItems" in schema:
            raise _NotPlainError
        if kind == "array":
            return [self.read(item, schema["items"]) for item in value]
        return self._read_object(value, schema) if kind == "object" else value

    def _read_union(self, value: Any, schemas: list[Mapping[str, Any]]) -> Any:
        """The value by the first of the schemas that it satisfies."""
        for schema in schemas:
            try:
                return self.read(value, schema)
            except _NotPlainError:
                continue
        raise _NotPlainError

    def _read_object(self, value: dict[str, Any], schema: Mapping[str, Any]) -> SimpleNamespace:
        """The entry of a JSON object, with defaults for the missing keys."""
        keys = schema["properties"]
        if value.keys() - keys.keys() or set(schema.get("required", ())) - value.keys():
            raise _NotPlainError
        # the reader of a solid needs the methods of its model
        if value.get("solid") is not None:
            raise _NotPlainError
        entries = {
            key: self.read(value[key], entry) if key in value else entry["default"]
            for key, entry in keys.items()
        }
        return SimpleNamespace(**entries)


def _number(value: Any, schema: Mapping[str, Any]) -> float:
    """The number as a float; raises `_NotPlainError` if it is invalid."""
    if type(value) not in (int, float) or abs(value) > 1e300 or not math.isfinite(value):
        raise _NotPlainError
    if value < schema.get("minimum", value) or value <= schema.get("exclusiveMinimum", -math.inf):
        raise _NotPlainError
    return float(value)
