"""The public names: one map, its types, the reference and the commands agree."""

import importlib
import re
import sys
from pathlib import Path

import pytest

import kilter
from kilter.cli.commands import COMMANDS

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs"))

import build_stub  # noqa: E402 (a program of the docs)

HOMES = kilter._HOMES
BESIDE = {
    "animate",
    "box_to_place",
    "check_contacts",
    "check_many",
    "common_region",
    "fastened",
    "dump",
    "limit",
    "load",
    "load_answer",
    "settle_states",
    "states",
}
BESIDE |= {"load_answer"}
"""Functions that are no command: what they do is an option of one, or its reading."""


def test_what_a_type_checker_sees_is_what_is_there():
    assert build_stub.STUB.read_text(encoding="utf-8") == build_stub.page()
    assert sorted(HOMES) == kilter.__all__
    assert set(kilter.__all__) <= set(dir(kilter))


@pytest.mark.parametrize("name", sorted(HOMES))
def test_each_name_is_at_home_where_the_map_says(name):
    value = getattr(kilter, name)
    assert value is getattr(importlib.import_module(HOMES[name]), name)
    assert (value.__module__, value.__name__) == (HOMES[name], name)
    assert value.__doc__


def test_the_reference_has_every_name():
    pages = sorted((ROOT / "docs/reference/python").glob("*.md"))
    named = re.findall(r"^::: (\S+)$", "".join(p.read_text("utf-8") for p in pages), flags=re.M)
    for name, home in HOMES.items():  # of functions with shared keywords, the stub is shown
        assert {f"{home}.{name}", f"kilter.{name}"} & set(named), name
    for one in named:
        home, _, name = one.rpartition(".")
        assert hasattr(importlib.import_module(home), name), one


def test_every_command_is_a_function_and_every_function_a_command():
    functions = {name for name in HOMES if name.islower()}
    commands = {name.replace("-", "_") for name in COMMANDS}
    # a server for other programs; a question about a file of states; pages of the documentation
    assert commands - {"mcp", "why", "help"} == functions - BESIDE - {"judge"}


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'chek'"):
        kilter.chek  # noqa: B018
