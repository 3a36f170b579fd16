"""Names of the commands, and the functions that they call."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from kilter.cli.overview import GROUPS

Command = Callable[..., int]
"""Function of a command: the values of its options become an exit code."""
COMMANDS = tuple(name for group in GROUPS.values() for name in group)
"""Names of all commands, in the order of the help text."""
HOMES = {
    "kilter.cli.judging": "check contacts example verify",
    "kilter.cli.directions": "margin orient region",
    "kilter.cli.pages": "draw report view",
    "kilter.cli.planning": "hold plan",
    "kilter.cli.placing": "place check-plan",
    "kilter.cli.explaining": "why",
    "kilter.cli.resting": "settle scene",
    "kilter.cli.transporting": "transport",
    "kilter.cli.file_commands": "batch save doctor mcp",
    "kilter.cli.guide": "help",
}
"""Names of the commands in each module; only the module of a command that is called is imported."""


def functions_of(name: str | None) -> list[Command]:
    """The function of a command, or for None of all commands in the order of the help text."""
    homes = {command: home for home, names in HOMES.items() for command in names.split()}
    return [
        getattr(import_module(homes[each]), each.replace("-", "_"))
        for each in (COMMANDS if name is None else (name,))
    ]
