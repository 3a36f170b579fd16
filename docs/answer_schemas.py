"""JSON schemas of the answers, made from their records.

A key has the type of its annotation and the text of the literal under it, which are read from the
source. The module is imported only when schemas are built, since importing pydantic is slow.
`kilter.files.schema` reads the published files, which `build_schemas.py` writes.
"""

from __future__ import annotations

import ast
import inspect
import sys
import textwrap
from collections.abc import Mapping, Sequence
from enum import Enum
from functools import cache
from itertools import pairwise
from types import GenericAlias, UnionType
from typing import Annotated, Any, NotRequired, Union, get_args, get_origin

import numpy as np
from pydantic import ConfigDict, Field, TypeAdapter
from pydantic.json_schema import GenerateJsonSchema
from typing_extensions import TypedDict

from kilter.analysis.engine_contacts.judged import Judged
from kilter.analysis.many.batch import Batch
from kilter.analysis.many.settle_states import SettledStates
from kilter.analysis.margins.margin_answer import Margin
from kilter.analysis.placing.check_plan import CheckedPlan
from kilter.analysis.placing.place import Places
from kilter.analysis.planning.hold.fixture import Fixture
from kilter.analysis.planning.order.order import Order
from kilter.analysis.regions.region import Region
from kilter.analysis.scene_states.scene_report import SceneReport
from kilter.analysis.settled_pose.settle import Settled
from kilter.analysis.transport.transport_answer import Transport
from kilter.analysis.turning.orientation import Orientation
from kilter.analysis.verdict.verdict import Verdict
from kilter.analysis.verification import Verification
from kilter.contact import ContactSet
from kilter.files.own.models import build_choices_schema, build_schema
from kilter.tell.record import (
    SCHEMA_VERSION,
    Answer,
    AnswerInWords,
    Incomplete,
    OneOf,
    OrNull,
    Record,
    Shape,
    keys_of,
)

__all__ = ["ANSWERS", "build_all_schemas", "build_answer_schema", "texts_of"]

ANSWERS: dict[str, Any] = {
    "batch": Batch,
    "check": Verdict,
    "check-plan": CheckedPlan,
    "contacts": ContactSet,
    "hold": Fixture,
    "incomplete": Incomplete,
    "margin": Margin,
    "orient": Orientation,
    "place": Places,
    "plan": Order,
    "region": Region,
    "scene": SceneReport,
    "settle": Settled,
    "settle-states": SettledStates,
    "transport": Transport,
    "verify": Verification,
    "why": Judged,
}
"""Record of each answer, by verb; "incomplete" is that of any verb at its time limit."""


class _PlainSchema(GenerateJsonSchema):
    """Schemas without titles of keys, which only repeat the keys."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """No key has a title."""
        return False


def build_answer_schema(verb: str) -> dict[str, Any]:
    """The JSON schema of the answer of a verb; a key that it does not list is an error.

    The keys "answer" and "schema" are optional: `to_json` writes them, ``--json`` does not.
    """
    model = _model(ANSWERS[verb])
    # a list, since pydantic accepts no settings for a typed dictionary itself
    several: Any = GenericAlias(list, (model,))
    adapter = TypeAdapter(several, config=ConfigDict(extra="forbid"))
    content = adapter.json_schema(schema_generator=_PlainSchema)
    definitions: dict[str, Any] = content.pop("$defs", {})
    # a model that refers to no other stands in place
    root = definitions.pop(model.__name__, content["items"])
    added = {"answer": {"const": verb}, "schema": {"const": SCHEMA_VERSION}}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"kilter answer of {verb}",
        **{key: value for key, value in root.items() if key not in ("title", "properties")},
        "properties": {**added, **root["properties"]},
        "$defs": {name: _without_title(entry) for name, entry in definitions.items()},
    }


def build_all_schemas() -> dict[str, dict[str, Any]]:
    """All published schemas by name: the assembly file, the file of choices, and each answer."""
    files = {"assembly": build_schema(), "choices": build_choices_schema()}
    return {**files, **{verb: build_answer_schema(verb) for verb in ANSWERS}}


def _without_title(entry: dict[str, Any]) -> dict[str, Any]:
    """A definition without its title, the name of a class."""
    return {key: value for key, value in entry.items() if key != "title"}


def texts_of(kind: type) -> dict[str, str]:
    """The text under each field of a class itself, from its source; first paragraphs."""
    definition = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
    assert isinstance(definition, ast.ClassDef)
    return {
        node.target.id: _first_paragraph(str(text.value.value))
        for node, text in pairwise(definition.body)
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant)
    }


@cache
def _model(kind: Any) -> Any:
    """The typed dictionary with the keys of a record."""
    types: dict[str, Any] = {}
    texts: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        if not issubclass(base, Record) or base in (Record, Answer, AnswerInWords):
            continue
        scope = _scope(base.__module__)
        words = dict(inspect.get_annotations(base))
        texts |= texts_of(base)
        for name, member in vars(base).items():
            getter = getattr(member, "fget", None) or getattr(member, "func", None)
            if hasattr(getter, "is_key"):
                words[name] = getter.__annotations__["return"]
                texts[name] = _first_paragraph(str(getter.__doc__))
        keys = [name for name in words if name in keys_of(kind)]
        types |= {name: _plain(eval(words[name], scope)) for name in keys}
    entries: dict[str, Any] = {}
    for name, absent in keys_of(kind).items():
        entry: Any = types[name]
        if absent:  # the type without None
            entry = Union[tuple(each for each in get_args(entry) if each is not type(None))]  # noqa: UP007
        entry = Annotated[entry, Field(description=texts[name])]
        entries[name] = NotRequired[entry] if absent else entry
    model: Any = TypedDict(kind.__name__, entries)  # type: ignore[misc]
    model.__doc__ = _first_paragraph(kind.__doc__ or "")
    return model


@cache
def _scope(module: str) -> dict[str, Any]:
    """Names in a module, also those that it imports for type checkers only."""
    names = dict(vars(sys.modules[module]))
    for node in ast.parse(inspect.getsource(sys.modules[module])).body:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            exec(compile(ast.Module(node.body, []), module, "exec"), names)
    return names


def _plain(kind: Any) -> Any:
    """The type of a value in JSON data, from the type of the attribute."""
    origin, args = get_origin(kind), get_args(kind)
    if isinstance(kind, type) and issubclass(kind, Record):
        return _model(kind)  # type: ignore[arg-type]
    if isinstance(kind, type) and issubclass(kind, Enum):
        return _one_of([word.value for word in kind])
    if origin is Annotated and isinstance(args[1], OneOf):
        return _one_of(args[1].words)
    if origin is Annotated and isinstance(args[1], Shape):
        entry = _scalar(args[0])
        entry = entry | None if args[1].infinite else entry
        for size in reversed(args[1].sizes):
            entry = GenericAlias(list, (entry,)) if size is None else _several(entry, size)
        return entry
    if kind == OrNull:
        return float | None
    if origin is Annotated:
        plain = _plain(args[0])
        return plain if isinstance(args[1], str) else Annotated[(plain, *args[1:])]
    if origin is np.ndarray:
        return list[_scalar(kind)]  # type: ignore[misc]
    if origin is tuple and args[-1] is not Ellipsis:
        return _several(Union[tuple(map(_plain, args))], len(args))  # noqa: UP007
    if origin in (tuple, list, Sequence):
        return list[_plain(args[0])]  # type: ignore[misc]
    if origin in (dict, Mapping):
        return dict[str, _plain(args[1])]  # type: ignore[misc]
    if origin in (Union, UnionType):
        return Union[tuple(map(_plain, args))]  # noqa: UP007
    return kind


def _scalar(array: Any) -> Any:
    """The type of an entry in JSON data, from the type of the array; float of other types."""
    if get_origin(array) is not np.ndarray:
        return float
    [kind] = get_args(get_args(array)[1])
    return type(np.zeros(1, kind).item())


def _one_of(words: Sequence[str]) -> Any:
    """The type of a text that is one of the words."""
    return Annotated[str, Field(json_schema_extra={"enum": list(words)})]


def _several(entry: Any, size: int) -> Any:
    """The type of a list of so many entries."""
    return Annotated[GenericAlias(list, (entry,)), Field(min_length=size, max_length=size)]


def _first_paragraph(text: str) -> str:
    """The first paragraph of a text, in a single line."""
    return " ".join(inspect.cleandoc(text).partition("\n\n")[0].split())
