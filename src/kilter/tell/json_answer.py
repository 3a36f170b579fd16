"""Base classes of answers that are not records yet."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import wraps
from typing import Any, ClassVar

from kilter.tell.record import SCHEMA_VERSION, json_value
from kilter.values.guesses import Guessable

__all__ = ["Answer", "AnswerInWords"]


class OldAnswer(Guessable):
    """Base class of the answers of all functions; its JSON data are as printed with ``--json``."""

    __slots__ = ()

    answer: ClassVar[str] = ""
    """Name of the verb that gives the answer."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "to_dict" in vars(cls):  # records inside become data
            write = cls.to_dict
            cls.to_dict = wraps(write)(lambda self: json_value(write(self)))  # type: ignore[method-assign]

    def to_dict(self) -> Mapping[str, Any]:
        """The answer as JSON data."""
        raise NotImplementedError

    def to_json(self, *, indent: int | None = 2) -> str:
        """The answer as JSON text that `kilter.load_answer` reads.

        The text has all keys of `to_dict`, and before them "answer", the name of the verb, and
        "schema", the version of the data.

        Parameters
        ----------
        indent : int or None
            Number of spaces for each level; None for a single line.
        """
        data = {"answer": self.answer, "schema": SCHEMA_VERSION, **self.to_dict()}
        return json.dumps(data, indent=indent, ensure_ascii=False, allow_nan=False)


class OldAnswerInWords(OldAnswer):
    """Base class of answers whose sentence is made from their data."""

    __slots__ = ()

    @property
    def sentence(self) -> str:
        """The answer in a sentence: the first line that the command prints."""
        from kilter.tell.tables import sentences

        return sentences(self.to_dict())[0]


Answer = OldAnswer
AnswerInWords = OldAnswerInWords
