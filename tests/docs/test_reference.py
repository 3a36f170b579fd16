"""The reference has every public name, and says of each what it holds."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import re
from pathlib import Path
from typing import Any

import pytest

import kilter

PAGES = sorted((Path(__file__).resolve().parents[2] / "docs" / "reference").glob("*.md"))
NAMED = sorted(
    {
        name
        for page in PAGES
        for name in re.findall(r"^::: ([\w.]+)$", page.read_text(encoding="utf-8"), flags=re.M)
    }
)


def found(name: str) -> Any:
    home, _, own = name.rpartition(".")
    return getattr(importlib.import_module(home), own)


def unexplained(value: Any) -> list[str]:
    """Fields of a class that its docstring leaves out, and members without one."""
    listed = r"^ *(?:\w+, )*\b%s\b(?:, \w+)* *(?::|$)"
    text = inspect.getdoc(value) or ""
    fields = dataclasses.fields(value) if dataclasses.is_dataclass(value) else ()
    names = [field.name for field in fields if not field.name.startswith("_")]
    missing = [name for name in names if not re.search(listed % name, text, flags=re.M)]
    for name, member in vars(value).items():
        said = member.fget if isinstance(member, property) else member
        own = isinstance(member, property | classmethod | staticmethod) or inspect.isfunction(said)
        if own and not name.startswith("_") and not inspect.getdoc(said):
            missing.append(name)
    return missing


@pytest.mark.quick(22)
@pytest.mark.parametrize("name", sorted(set(kilter.__all__)))
def test_a_public_name_has_its_place(name: str) -> None:
    value = getattr(kilter, name)
    assert f"{value.__module__}.{value.__qualname__}" in NAMED


@pytest.mark.quick(22)
@pytest.mark.parametrize("name", NAMED)
def test_what_it_holds_is_explained(name: str) -> None:
    value = found(name)
    assert inspect.getdoc(value)
    if inspect.isclass(value):
        assert unexplained(value) == []


def test_what_is_left_out_is_seen() -> None:
    @dataclasses.dataclass
    class Half:
        """Two numbers.

        Attributes
        ----------
        told : int
        """

        told: int
        hidden: int

        @property
        def both(self) -> int:
            return self.told + self.hidden

    assert unexplained(Half) == ["hidden", "both"]
