"""JSON schemas of the answers, made from the models of their data.

The module is imported only when schemas are built, since importing pydantic is slow.
`kilter.files.schema` reads the published files.
"""

from __future__ import annotations

from types import GenericAlias
from typing import Any

from pydantic import ConfigDict, TypeAdapter
from pydantic.json_schema import GenerateJsonSchema

from kilter.files.choices_model import build_choices_schema
from kilter.files.models import build_schema
from kilter.tell.answer_data.check_data import CheckData
from kilter.tell.answer_data.contacts_data import ContactsData
from kilter.tell.answer_data.directions_data import OrientData, RegionData
from kilter.tell.answer_data.margin_data import MarginData
from kilter.tell.answer_data.other_data import (
    BatchData,
    ImproveData,
    IncompleteData,
    VerifyData,
)
from kilter.tell.answer_data.packing_data import PackingData
from kilter.tell.answer_data.place_data import PlaceData
from kilter.tell.answer_data.plan_data import HoldData, PlanData
from kilter.tell.answer_data.scene_data import SceneData
from kilter.tell.answer_data.settle_data import SettleData
from kilter.tell.answer_data.transport_data import TransportData
from kilter.tell.json_answer import SCHEMA_VERSION

__all__ = ["ANSWERS", "build_all_schemas", "build_answer_schema"]

ANSWERS: dict[str, Any] = {
    "batch": BatchData,
    "check": CheckData,
    "check-plan": PackingData,
    "contacts": ContactsData,
    "hold": HoldData,
    "improve": ImproveData,
    "incomplete": IncompleteData,
    "margin": MarginData,
    "orient": OrientData,
    "place": PlaceData,
    "plan": PlanData,
    "region": RegionData,
    "scene": SceneData,
    "settle": SettleData,
    "transport": TransportData,
    "verify": VerifyData,
}
"""Model of each answer's data, by verb; "incomplete" is that of any verb at its time limit."""


class _PlainSchema(GenerateJsonSchema):
    """Schemas without titles of keys, which only repeat the keys."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """No key has a title."""
        return False


def build_answer_schema(verb: str) -> dict[str, Any]:
    """The JSON schema of the answer of a verb; a key that it does not list is an error.

    The keys "answer" and "schema" are optional: `to_json` writes them, ``--json`` does not.
    """
    # a list, since pydantic accepts no settings for a typed dictionary itself
    several: Any = GenericAlias(list, (ANSWERS[verb],))
    adapter = TypeAdapter(several, config=ConfigDict(extra="forbid"))
    content = adapter.json_schema(schema_generator=_PlainSchema)
    definitions: dict[str, Any] = content.pop("$defs", {})
    # a model that refers to no other stands in place
    root = definitions.pop(ANSWERS[verb].__name__, content["items"])
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
