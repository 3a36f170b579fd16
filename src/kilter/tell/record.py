"""Records: answers and their pieces, whose fields are the keys of their JSON data.

A record declares each key once: the type is its annotation, the text is the string literal under
it. The JSON schemas and the reference are made from them.

    class Push(Record):
        name: str
        "Part that is pushed."
        contacts: InPython[ContactSet]
        "A field without a key."

        @property
        @key
        def share(self) -> float:
            "A key that is computed on request [-]."
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field, fields
from enum import Enum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeVar, dataclass_transform

import numpy as np

from kilter.arrays import Array
from kilter.tell.levels import LEVELS, VerdictWord
from kilter.units import METRES
from kilter.values.guesses import Guessable

SCHEMA_VERSION = 1
"""Version of the data of all answers; a key that is removed or changes its meaning raises it."""

T = TypeVar("T")
Getter = TypeVar("Getter", bound=Callable[..., Any])

InPython = Annotated[T, "field without a key"]
"""Type of a field that is no key of the JSON data: ``contacts: InPython[ContactSet]``."""
OrAbsent = Annotated[T | None, "key that is absent instead of null"]
"""Type of a key that the JSON data lack if its value is None."""


class OneOf:
    """Mark of a text: its possible words."""

    def __init__(self, words: tuple[str, ...]) -> None:
        self.words = words


class Shape:
    """Mark of an array: its shape, None for any number; whether its numbers may be infinite."""

    def __init__(self, *sizes: int | None, infinite: bool = False) -> None:
        self.sizes = sizes
        self.infinite = infinite


Vector = Annotated[Array, Shape(3)]
Twist = Annotated[Array, Shape(6)]
Lines = Annotated[Array, Shape(None, 3)]
Rows = Annotated[Array, Shape(None, None)]
OrNull = Annotated[float, "null if it is infinite or not known"]
"""Type of a number that is infinite without a limit, and nan if it is not known."""
Ends = tuple[OrNull, OrNull]
PairNames = tuple[str, str]
Seconds = Mapping[str, float]
Word = Annotated[str, OneOf(tuple(word.value for word in VerdictWord))]
Guarantee = Annotated[str, OneOf(("proved", "refuted", "open"))]
LevelWord = Annotated[str, OneOf(LEVELS)]
UnitWord = Annotated[str, OneOf(tuple(METRES))]


def key(getter: Getter) -> Getter:
    """Mark the function under a property, or a cached property, as a key of the JSON data."""
    getter.is_key = True  # type: ignore[attr-defined]
    return getter


@dataclass_transform(
    kw_only_default=True, frozen_default=True, eq_default=False, field_specifiers=(field,)
)
class Record(Guessable):
    """Base class of answers and their pieces: frozen, compared by identity.

    Each subclass becomes a dataclass without further words. Its `to_dict` has a key for each public
    field, but for those with the type `InPython`, and for each property marked as `key`. The option
    `kw_only=False` of a class lets its fields be given by position, too.

    Examples
    --------
    >>> class Pushed(Record):
    ...     "A pushed part."
    ...     name: str
    ...     force: Vector
    >>> pushed = Pushed(name="box", force=np.array([0.0, np.inf, 1.0]))
    >>> pushed, pushed.to_dict()
    (<Pushed: 'box'>, {'name': 'box', 'force': [0.0, None, 1.0]})
    """

    if TYPE_CHECKING:
        __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    def __init_subclass__(cls, *, kw_only: bool = True) -> None:
        super().__init_subclass__()
        # methods of this class instead of generated ones, since generating takes time at start-up
        dataclass(init=False, repr=False, eq=False, match_args=False, kw_only=kw_only)(cls)

    def __init__(self, *listed: Any, **given: Any) -> None:
        kind: Any = type(self)
        own = _fields_of(kind)
        if listed:
            names = [each.name for each in own if not each.kw_only]
            if len(listed) > len(names):
                raise TypeError(f"{type(self).__name__} takes {len(names)} arguments by position")
            given |= zip(names, listed, strict=False)
        values = self.__dict__
        for each in own:
            if each.name in given:
                values[each.name] = given.pop(each.name)
            elif each.default is not MISSING:
                values[each.name] = each.default
            elif each.default_factory is not MISSING:
                values[each.name] = each.default_factory()
            else:
                raise TypeError(f"{type(self).__name__} lacks the argument {each.name!r}")
        if given:
            raise TypeError(f"{type(self).__name__} has no argument {next(iter(given))!r}")
        self.__post_init__()

    def __post_init__(self) -> None:
        """Complete a new record."""

    def __setattr__(self, name: str, value: Any) -> None:
        raise FrozenInstanceError(f"{type(self).__name__} is read-only: {name}")

    def __delattr__(self, name: str) -> None:
        raise FrozenInstanceError(f"{type(self).__name__} is read-only: {name}")

    def __repr__(self) -> str:
        kind: Any = type(self)
        named = getattr(self, _fields_of(kind)[0].name)
        if isinstance(named, str):
            return f"<{kind.__name__}: {named!r}>"
        values = {name: self.__dict__.get(name) for name in keys_of(kind)}
        plain = [f"{name}={v!r}" for name, v in values.items() if isinstance(v, int | float)]
        return f"{kind.__name__}({', '.join(plain)})"

    def to_dict(self) -> dict[str, Any]:
        """The JSON data: arrays as lists, and null for infinite numbers."""
        return self.data_without()

    def data_without(self, *left_out: str) -> dict[str, Any]:
        """The JSON data without some keys, of which another key is made."""
        data = {}
        kind: Any = type(self)
        for name, absent in keys_of(kind).items():
            if name in left_out:
                continue
            value = getattr(self, name)
            if not (absent and value is None):
                data[name] = json_value(value)
        return data


@cache
def _fields_of(kind: Any) -> tuple[Field[Any], ...]:
    """Fields of a class of records, kept since a large answer has thousands of records."""
    return fields(kind)


class Answer(Record):
    """Base class of the answers of all functions; its JSON data are as printed with ``--json``."""

    answer: ClassVar[str] = ""
    """Name of the verb that gives the answer."""

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

    def _repr_html_(self) -> str:
        """The answer as HTML for a notebook."""
        from kilter.tell.html import html_of

        return html_of(self.to_dict())


class AnswerInWords(Answer):
    """Base class of answers whose sentence is made from their data."""

    @property
    def sentence(self) -> str:
        """The answer in a sentence: the first line that the command prints."""
        from kilter.tell.tables import sentences

        return sentences(self.to_dict())[0]


class Incomplete(Record):
    """Data that a command prints if the time limit ended its computation without an answer."""

    verdict: Literal["undecided"] = "undecided"
    """Always this word."""
    sentence: str
    """The answer in a sentence."""
    time_limit: float | None
    """The time limit [s]; null without a --time-limit."""
    warnings: tuple[str, ...] = ()
    """No warnings."""


@cache
def keys_of(kind: Any) -> Mapping[str, bool]:
    """Names of the keys of a record; True for a key that is absent if it is None.

    The keys of a base class come first, and in a class its fields before its properties.
    """
    types: dict[str, str] = {}
    public = {each.name: str(each.type) for each in fields(kind)}
    for base in reversed(kind.__mro__):
        names = vars(base).get("__annotations__", {})
        types |= {name: public[name] for name in names if name in public}
        for name, member in vars(base).items():
            getter = getattr(member, "fget", None) or getattr(member, "func", None)
            if hasattr(getter, "is_key"):
                types[name] = str(getter.__annotations__["return"])
    return {
        name: words.startswith("OrAbsent[")
        for name, words in types.items()
        if not name.startswith("_") and not words.startswith("InPython[")
    }


AS_THEY_ARE = frozenset({str, int, bool, type(None)})
"""Types whose values are JSON data."""


def json_value(value: Any) -> Any:
    """A value as JSON data; None for infinite numbers and NaN, and 0 for -0.

    Examples
    --------
    >>> json_value({"a": (1, np.array([-0.0, np.nan]), np.float64(2.0))})
    {'a': [1, [0.0, None], 2.0]}
    """
    kind = type(value)
    if kind in AS_THEY_ARE:
        return value
    if kind is float:
        return value + 0.0 if math.isfinite(value) else None
    if kind is list or kind is tuple:
        return [json_value(entry) for entry in value]
    if isinstance(value, Record):
        return value.to_dict()
    if isinstance(value, np.ndarray):
        if value.dtype.kind != "f":
            return value.tolist()
        return (value + 0.0).tolist() if np.isfinite(value).all() else json_value(value.tolist())
    if isinstance(value, np.generic):
        return json_value(value.item())
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return {str(name): json_value(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [json_value(entry) for entry in value]
    return value
