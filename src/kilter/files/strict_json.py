"""Parse JSON strictly: UTF-8, no duplicate keys, errors with line and column.

Python keeps half of a surrogate pair that an escape names alone, and no encoder can write it. It
is rejected here, so that every text of a file can be printed and written.
"""

from __future__ import annotations

import json
import re
from typing import Any

from kilter.errors import InputError
from kilter.files.limits import MOST_VALUES

__all__ = ["parse_json"]

_SURROGATE = re.compile(r"[\ud800-\udfff]")
_SURROGATE_ESCAPE = re.compile(rb"\\u[dD][89a-fA-F]")


def parse_json(data: bytes) -> Any:
    """Parse JSON text strictly: no duplicate keys, only finite numbers.

    NaN and Infinity are accepted as numbers, so that the caller can name their place in an error.

    Raises
    ------
    InputError
        If the text is not UTF-8 or not JSON, is nested too deeply, has too many values, a
        duplicate key, or half of a surrogate pair.

    Examples
    --------
    >>> parse_json(b'{"a": 1,\\n "b": }')
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: not JSON: Expecting value at line 2, column 7; ...
    >>> parse_json(b'{"name": "C1", "mass": 1, "mass": 2}')
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: part 'C1': duplicate key 'mass' in an object; keep a single value
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"not UTF-8 at byte {error.start}", hint="save it as UTF-8") from None
    if not text.strip():
        raise InputError("the file is empty", hint="give a file with contents")
    _require_few_values(data)
    try:
        content = json.loads(text, object_pairs_hook=_without_duplicates)
        if _SURROGATE_ESCAPE.search(data):
            _require_no_surrogates(content)
        return content
    except json.JSONDecodeError as error:
        raise InputError(
            f"not JSON: {error.msg} at line {error.lineno}, column {error.colno}",
            hint="correct the text there",
        ) from None
    except RecursionError:
        raise InputError("lists or objects are nested too deeply", hint="flatten them") from None
    except ValueError as error:  # an integer of thousands of digits
        raise InputError(f"not a number: {error}"[:120], hint="give fewer digits") from None


def _require_few_values(data: bytes) -> None:
    """Raise `InputError` if a JSON text has too many values for the memory."""
    count = sum(data.count(mark) for mark in (b",", b"[", b"{"))
    if count > MOST_VALUES:
        raise InputError(
            f"its JSON has {count:,} values; the limit is {MOST_VALUES:,}",
            hint="make its meshes coarser, or write them as STL",
        )


def _require_no_surrogates(content: Any) -> None:
    """Raise `InputError` if a text within JSON data has half of a surrogate pair."""
    text = json.dumps(content, ensure_ascii=False)
    half = _SURROGATE.search(text)
    if half is not None:
        around = text[max(half.start() - 20, 0) : half.end() + 20]
        raise InputError(
            f"a text has half of a surrogate pair, near {around!r}",
            hint="give a text of valid characters",
        )


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Build the dict of a JSON object; raises `InputError` for a duplicate key."""
    result = dict(pairs)
    if len(result) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        name = result.get("name")
        raise InputError(
            f"duplicate key {twice!r} in an object",
            part=name if isinstance(name, str) else None,
            hint="keep a single value",
        )
    return result
