"""Turn the validation errors of pydantic into an `InputError` with place, fault and remedy."""

from __future__ import annotations

import json
import re
import reprlib
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError, nearest_name
from kilter.files.limits import MOST_VALUES

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError


_TAGS = re.compile(r"as path|inline|named|constrained-\w+|literal\[.*\]|float|list\[float\]")
"""Tags of union types (kinds of mesh, step, number) that pydantic inserts into the place."""


def complaint(error: ValidationError, data: dict[str, Any], model: type[BaseModel]) -> InputError:
    """Convert a validation error of a file to one clear `InputError`, for its first fault."""
    faults = error.errors(include_url=False, include_context=True)
    fault = next((f for f in faults if f["type"] == "extra_forbidden"), faults[0])
    place = _fault_place(fault)
    part, shown = _part_and_place(place, data)
    keys = _keys_at(model, place[:-1])
    what, _ = _fault_and_remedy(fault, shown, keys)
    # a value of a union type has one fault for each type: each contributes its remedy
    same_place = [other for other in faults if _fault_place(other) == place]
    remedies = [_fault_and_remedy(other, shown, keys)[1] for other in same_place]
    hint = ", or ".join(dict.fromkeys(remedies))
    more = len({_fault_place(other) for other in faults}) - 1
    if more:
        what += f" (and {more} more faults)"
    return InputError(what, part=part, hint=hint)


def _fault_place(fault: Any) -> tuple[Any, ...]:
    """Keys and indices that lead to a fault in the file, without internal tags of pydantic."""
    return tuple(key for key in fault["loc"] if not _TAGS.fullmatch(str(key)))


def _part_and_place(place: tuple[Any, ...], data: dict[str, Any]) -> tuple[str | None, str]:
    """Name of the part at fault, if known, and the place in it as text (``pose.position``)."""
    part = None
    if len(place) >= 2 and place[0] == "parts" and isinstance(place[1], int):
        entry = data["parts"][place[1]]
        name = entry.get("name") if isinstance(entry, dict) else None
        if isinstance(name, str) and name:
            part, place = name, place[2:]
    text = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in place)
    return part, text.lstrip(".")


def _fault_and_remedy(fault: Any, place: str, keys: list[str]) -> tuple[str, str]:
    """Two phrases for a fault that pydantic reports: the fault, and what to do."""
    kind, context, value = fault["type"], fault.get("ctx", {}), fault["input"]
    if kind == "extra_forbidden":
        return _unknown_key(place, keys)
    if kind == "missing":
        return f"{place} is missing", f"add the key {place.rpartition('.')[2]!r}"
    if kind in ("too_short", "too_long"):
        wanted = context.get("min_length", context.get("max_length"))
        return f"{place} has {context['actual_length']} entries", f"give {_count(place, wanted)}"
    hints = {
        "list_type": "give a list",
        "string_type": "give a text in quotes",
        "string_too_short": "give a text that is not empty",
        "bool_type": "give true or false",
        "finite_number": "give a finite number",
        "float_type": "give a number",
        "int_type": "give a whole number",
        "int_from_float": "give a whole number",
        "model_type": "give an object in braces",
        "greater_than": f"give a number above {context.get('gt', 0):g}",
        "greater_than_equal": f"give a number of at least {context.get('ge', 0):g}",
        "less_than": f"give a number below {context.get('lt', 0):g}",
        "literal_error": f"use {context.get('expected', '')}",
        "string_unicode": "give a text of valid characters",
    }
    return f"{place} is {_short_text(value)}", hints.get(kind, fault["msg"])


def _count(place: str, wanted: Any) -> str:
    """Phrase for the required number of entries of a list; "or more" if there is no upper limit."""
    several = re.search(r"(^parts|(^|\.)(polygon|points|faces\[\d+\]))$", place)
    return f"{wanted} or more" if several else str(wanted)


def _unknown_key(place: str, keys: list[str]) -> tuple[str, str]:
    """Two phrases for an unknown key: the fault, and the nearest known key or all known keys."""
    key = place.rpartition(".")[2]
    near = nearest_name(key, keys)
    if key == "radius" and "curvature" in keys:
        return f"unknown key {place!r}", "give its curvature, 1 / radius, negative if hollow"
    hint = f"did you mean {near!r}?" if near else f"known keys are {', '.join(keys)}"
    return f"unknown key {place!r}", hint


def _keys_at(model: type[BaseModel], place: tuple[Any, ...]) -> list[str]:
    """Keys that the file format allows for the object at a place in the file."""
    from pydantic import BaseModel

    for key in place:
        if isinstance(key, str) and key in model.model_fields:
            inner = _models_in(model.model_fields[key].annotation, BaseModel)
            if not inner:
                break
            model = inner[0]
    return list(model.model_fields)


def _models_in(annotation: Any, base: type) -> list[Any]:
    """All subclasses of `base` that occur in a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, base):
        return [annotation]
    inner = getattr(annotation, "__args__", ())
    return [model for argument in inner for model in _models_in(argument, base)]


def _short_text(value: Any) -> str:
    """A value as text of at most 40 characters; "a list" or "an object" for a compound value."""
    if value is None or isinstance(value, bool | int | float | str):
        text = json.dumps(value, ensure_ascii=False)
        return text if len(text) <= 40 else text[:37] + "..."
    if isinstance(value, dict):
        return "an object"
    return "a list" if isinstance(value, list) else reprlib.repr(value)


# Parse JSON strictly: UTF-8, no duplicate keys, errors with line and column.


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
