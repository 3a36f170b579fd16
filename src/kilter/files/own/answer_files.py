"""Read answers that `to_json` wrote, such as `Verdict.to_json`."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from kilter.errors import InputError, nearest_name, some_names
from kilter.tell.record import SCHEMA_VERSION
from kilter.values.guesses import guarded


class _Piece(dict[str, Any]):
    """A piece of an answer, such as a part; keys are attributes."""

    __slots__ = ()

    def __getattr__(self, name: str) -> Any:
        if name in self:
            return self[name]
        raise AttributeError(f"this piece of the answer has no key {name!r}")


class LoadedAnswer(Mapping[str, Any]):
    """An answer read from a JSON file, read-only; keys are attributes, parts are found by name.

    Keys of its pieces are attributes, too, as in the answer that was written. Nothing is computed:
    what `to_json` did not write is not there.

    Examples
    --------
    >>> text = '{"answer": "check", "schema": 1, "verdict": "stable", "parts": [{"name": "a"}]}'
    >>> answer = load_answer(text)
    >>> answer.answer, answer.verdict, answer["verdict"], answer.parts[0].name
    ('check', 'stable', 'stable', 'a')
    """

    __slots__ = ("_data",)

    answer: str
    """Name of the verb that gave the answer."""
    schema: int
    """Version of the data."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self._data = dict(data)

    def __getitem__(self, key: str) -> Any:
        return self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    def __getattr__(self, name: str) -> Any:
        if name != "_data" and name in self._data:
            return self._data[name]
        raise AttributeError(f"the answer has no key {name!r}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._data})

    def __repr__(self) -> str:
        return f"<LoadedAnswer: {self.answer}, {len(self)} keys>"

    def part(self, name: str) -> dict[str, Any]:
        """The entry of the part with the given name.

        Raises
        ------
        InputError
            If the answer has no such part.
        """
        parts = {part["name"]: part for part in self._data.get("parts", ())}
        if name in parts:
            part: dict[str, Any] = parts[name]
            return part
        near = nearest_name(name, parts)
        hint = f"did you mean {near!r}?" if near else f"there are: {some_names(list(parts), 8)}"
        raise InputError(f"the answer has no part {name!r}", hint=hint)

    def to_dict(self) -> dict[str, Any]:
        """The data of the answer, equal to `to_dict` of the answer that was written."""
        return {k: v for k, v in self._data.items() if k not in ("answer", "schema")}


@guarded
def load_answer(source: str | os.PathLike[str]) -> LoadedAnswer:
    """Read an answer that `to_json` wrote, from its text or from a file.

    Parameters
    ----------
    source : str or path
        JSON text, which begins with a brace, or the path of a file.

    Raises
    ------
    InputError
        If the file cannot be read, the text is no JSON object with the keys "answer" and
        "schema", or a newer version of kilter wrote it.

    See Also
    --------
    kilter.load : reads an assembly, not an answer.
    kilter.verify : verifies a proof, not an answer.
    """
    text, place = source, "the text of an answer"
    if not isinstance(source, str) or not source.lstrip().startswith("{"):
        path, place = Path(source), os.fspath(source)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or "not UTF-8"
            raise InputError(
                f"the answer cannot be read: {reason}", file=place, hint="give a file of to_json"
            ) from None
    try:
        data = json.loads(str(text), object_hook=_Piece)
    except ValueError as error:
        raise InputError(
            f"not JSON: {error}", file=place, hint="give the text of to_json"
        ) from None
    if not isinstance(data, dict) or not {"answer", "schema"} <= set(data):
        raise InputError(
            'no keys "answer" and "schema"', file=place, hint="write it with the method to_json"
        )
    if not isinstance(data["schema"], int) or not 1 <= data["schema"] <= SCHEMA_VERSION:
        raise InputError(
            f"version {data['schema']!r:.20} of the answer is unknown, the newest is "
            f"{SCHEMA_VERSION}",
            file=place,
            hint="read it with the version of kilter that wrote it",
        )
    return LoadedAnswer(data)
