"""JSON read strictly: UTF-8, no key twice in an object, faults with line and column."""

from __future__ import annotations

import json
from typing import Any

from kilter.errors import InputError

__all__ = ["parse_json"]


def parse_json(data: bytes) -> Any:
    """The value of a JSON text.

    NaN and Infinity are let through as numbers, so that who knows their place can name it.

    Raises
    ------
    InputError
        If it is not UTF-8, not JSON, too deep, or an object has a key twice.

    Examples
    --------
    >>> parse_json(b'{"a": 1,\\n "b": }')
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: not JSON: Expecting value at line 2, column 7; ...
    >>> parse_json(b'{"name": "C1", "mass": 1, "mass": 2}')
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: part 'C1': key 'mass' stands twice in one object; keep one
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"not UTF-8 at byte {error.start}", hint="save it as UTF-8") from None
    if not text.strip():
        raise InputError("the file is empty", hint="give a file with contents")
    try:
        return json.loads(text, object_pairs_hook=_once)
    except json.JSONDecodeError as error:
        raise InputError(
            f"not JSON: {error.msg} at line {error.lineno}, column {error.colno}",
            hint="mend the text there",
        ) from None
    except RecursionError:
        raise InputError("lists or objects are nested too deep", hint="flatten them") from None
    except ValueError as error:  # a whole number of thousands of digits
        raise InputError(f"not a number: {error}"[:120], hint="give fewer digits") from None


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        name = result.get("name")
        raise InputError(
            f"key {twice!r} stands twice in one object",
            part=name if isinstance(name, str) else None,
            hint="keep one",
        )
    return result
