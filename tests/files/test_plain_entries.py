"""A small kilter file is read without pydantic: the same entries as by the models."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from kilter.files.kilter_json import to_dict
from kilter.files.models import AssemblyFile
from kilter.files.plain_entries import MOST_VALUES, plain_entries
from kilter.scenes import example

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
CUBE = {"name": "a", "box": [1, 2.5, 1e-3]}


def plain(entry: Any) -> Any:
    """The values of an entry of either kind, with the type of each number."""
    if isinstance(entry, BaseModel):
        return {key: plain(getattr(entry, key)) for key in type(entry).model_fields}
    if isinstance(entry, SimpleNamespace):
        return {key: plain(value) for key, value in vars(entry).items()}
    if isinstance(entry, list):
        return [plain(value) for value in entry]
    return type(entry), entry


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.kilter.json")), ids=lambda p: p.stem)
def test_the_entries_of_an_example_are_those_of_the_models(path: Path) -> None:
    data = json.loads(path.read_text("utf-8"))
    entries = plain_entries(data)
    assert entries is not None
    assert plain(entries) == plain(AssemblyFile.model_validate(data))


@pytest.mark.parametrize("name", ["arch", "tower", "paper-figure-8"])
def test_the_entries_of_a_scene_are_those_of_the_models(name: str) -> None:
    data = json.loads(json.dumps(to_dict(example(name))))
    entries = plain_entries(data)
    assert entries is not None
    assert plain(entries) == plain(AssemblyFile.model_validate(data))


@pytest.mark.parametrize(
    "change",
    [
        {"units": "km"},
        {"gravity": [0, 0]},
        {"gravity": [0, 0, True]},
        {"gravity": [0, 0, "-9.81"]},
        {"gravity": [0, 0, float("nan")]},
        {"friction": -0.1},
        {"planar": 1},
        {"parts": []},
        {"parts": {}},
        {"parts": [CUBE | {"densty": 1}]},
        {"parts": [CUBE | {"density": 0}]},
        {"parts": [CUBE | {"name": ""}]},
        {"parts": [CUBE | {"name": "\ud800"}]},
        {"parts": [{"box": [1, 1, 1]}]},
        {"parts": [CUBE | {"brick": {"cells": [2.0, 4]}}]},
        {"bonds": [{"parts": ["a", "b"], "shear": "mo"}]},
        {"joints": [{"parts": ["a", "b"], "kind": "ball"}]},
        {"loads": [{"part": "a", "force": None}]},
    ],
    ids=str,
)
def test_what_the_models_reject_is_left_to_them(change: dict[str, Any]) -> None:
    data = {"kilter": 1, "parts": [CUBE]} | change
    with pytest.raises(ValidationError):
        AssemblyFile.model_validate(data)
    assert plain_entries(data) is None


def test_many_values_and_solids_are_left_to_the_models() -> None:
    many = [CUBE | {"name": f"part {k}"} for k in range(MOST_VALUES)]
    assert plain_entries({"kilter": 1, "parts": many}) is None
    assert plain_entries({"kilter": 1, "parts": [{"name": "a", "solid": {}}]}) is None
    assert plain_entries([]) is None
