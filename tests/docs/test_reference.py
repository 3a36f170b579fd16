"""The reference has every public name, and says of each what it holds."""

import dataclasses
import importlib
import inspect
import re
from pathlib import Path
from typing import Any

import pytest
from answer_schemas import texts_of

import kilter

PAGES = sorted((Path(__file__).resolve().parents[2] / "docs/reference/python").glob("*.md"))
SCHEMAS = Path(kilter.__file__).parent / "files/schemas"
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
    """Fields of a class without a text in its docstring or under them, and members without one."""
    listed = r"^ *(?:\w+, )*\b%s\b(?:, \w+)* *(?::|$)"
    under = (
        name for base in value.__mro__ if dataclasses.is_dataclass(base) for name in texts_of(base)
    )
    text = "\n".join([inspect.getdoc(value) or "", *under])
    fields = dataclasses.fields(value) if dataclasses.is_dataclass(value) else ()
    names = [field.name for field in fields if not field.name.startswith("_")]
    missing = [name for name in names if not re.search(listed % name, text, flags=re.M)]
    for name, member in vars(value).items():
        said = member.fget if isinstance(member, property) else member
        own = isinstance(member, property | classmethod | staticmethod) or inspect.isfunction(said)
        if own and not name.startswith("_") and not inspect.getdoc(said):
            missing.append(name)
    return missing


def test_the_python_page_lists_every_verb_and_every_answer():
    page = (PAGES[0].parents[2] / "tutorials/python.md").read_text(encoding="utf-8")
    [verbs] = re.findall(
        r"^((?:`\w+`(?:, | and ))+`\w+`) accept an assembly or a path", page, flags=re.M
    )
    accepting = {
        name
        for name in kilter.__all__
        if inspect.isfunction(verb := getattr(kilter, name))
        and "AssemblyOrPath" in str(next(iter(inspect.signature(verb).parameters.values()), ""))
    }
    assert set(re.findall(r"`(\w+)`", verbs)) == accepting - {"check_many"}  # the next sentence
    [answers] = re.findall(r"^The names are (.*?`batch`)\.", page, flags=re.M)
    schemas = {path.name.partition(".")[0] for path in SCHEMAS.glob("*.schema.json")}
    others = {"assembly", "choices", "incomplete"}  # named in the sentences after them
    assert set(re.findall(r"`([\w-]+)`", answers)) == schemas - others


@pytest.mark.quick(22)
@pytest.mark.parametrize("name", sorted(set(kilter.__all__)))
def test_a_public_name_has_its_place(name):
    value = getattr(kilter, name)
    assert {f"{value.__module__}.{value.__qualname__}", f"kilter.{name}"} & set(NAMED)


@pytest.mark.quick(22)
@pytest.mark.parametrize("name", NAMED)
def test_what_it_holds_is_explained(name):
    value = found(name)
    assert inspect.getdoc(value)
    if inspect.isclass(value):
        assert unexplained(value) == []


def test_what_is_left_out_is_seen():
    @dataclasses.dataclass
    class Half:
        """Two numbers."""

        told: int
        """A number."""
        hidden: int

        @property
        def both(self) -> int:
            return self.told + self.hidden

    assert unexplained(Half) == ["hidden", "both"]
