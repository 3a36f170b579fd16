"""Messages of a page: parse them strictly, so that each gets an answer and none harms the others.

A message is a JSON object with an `id`, which its answer repeats. A message that could not be sent
on to the other pages is refused: lone surrogates, numbers that are not finite, deep nesting.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any, NoReturn

from kilter.errors import InputError

__all__ = ["index_of", "message_id", "parse_message", "to_json"]

MOST = 10**9
"""All indices are below this number."""
DEEPEST = 20
"""Deepest nesting of lists and objects in a message."""
NUMBER = re.compile(r'\s*\{\s*"id"\s*:\s*([0-9]{1,9})\s*[,}]')
"""Beginning of a message of the page, with its number."""


def parse_message(text: str) -> dict[str, Any]:
    """The JSON object of a message.

    Raises `InputError` if the text is no JSON object, is nested too deeply, has a lone surrogate,
    or a number that is not finite.

    Examples
    --------
    >>> parse_message('{"id": 1, "do": "undo"}')
    {'id': 1, 'do': 'undo'}
    >>> parse_message('{"do": "go", "index": Infinity}')
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the message has the number Infinity; reload the page
    """
    try:
        message = json.loads(
            text, parse_float=_finite, parse_int=_short_integer, parse_constant=_no_number
        )
    except InputError:
        raise
    except RecursionError:
        raise _wrong("is nested too deeply") from None
    except ValueError as error:
        raise _wrong(f"is no JSON: {error}") from None
    if not isinstance(message, dict):
        raise _wrong("is no JSON object")
    _validate(message)
    return message


def message_id(text: str) -> int | None:
    """The number of a message that cannot be parsed, as the page writes it; None without one."""
    found = NUMBER.match(text)
    return int(found[1]) if found else None


def index_of(message: Mapping[str, Any], key: str) -> int:
    """An index in a message, which is a whole number from 0 to `MOST`.

    Raises `InputError` if it is missing, or something else.
    """
    value = message.get(key)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < MOST:
        raise InputError(f"{key} is {value!r:.40}", hint="give a whole number, 0 or more")
    return value


def to_json(message: Mapping[str, Any]) -> str:
    """JSON text that every page can read: ASCII, and null for a number that is not finite."""
    try:
        return json.dumps(message, separators=(",", ":"), allow_nan=False)
    except ValueError:
        return json.dumps(_only_finite(message), separators=(",", ":"))


def _only_finite(value: Any) -> Any:
    """JSON data with None for each number that is not finite."""
    if isinstance(value, Mapping):
        return {key: _only_finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_only_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _validate(message: dict[str, Any]) -> None:
    """Raise `InputError` for deep nesting and for texts with a lone surrogate."""
    layer: list[Any] = [message]
    for _ in range(DEEPEST):
        below: list[Any] = []
        for value in layer:
            if isinstance(value, dict):
                below += [*value.keys(), *value.values()]
            elif isinstance(value, list):
                below += value
            elif isinstance(value, str) and not value.isascii():
                _require_encodable(value)
        layer = below
        if not layer:
            return
    raise _wrong("is nested too deeply")


def _require_encodable(text: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise _wrong("has an invalid character (a lone surrogate)") from None


def _finite(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        _no_number(digits)
    return value


def _short_integer(digits: str) -> int:
    _finite(digits)
    return int(digits)


def _no_number(digits: str) -> NoReturn:
    raise _wrong(f"has the number {digits:.30}")


def _wrong(words: str) -> InputError:
    return InputError(f"the message {words}"[:160], hint="reload the page")
