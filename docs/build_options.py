"""Write docs/reference/options.md: the options of all commands, from their declarations.

`python docs/build_options.py`
"""

from __future__ import annotations

from pathlib import Path

from kilter.cli.commands import COMMANDS, functions_of
from kilter.cli.declarations import Declared, declared_of

PAGE = Path(__file__).resolve().parent / "reference/options.md"
SHARED = 8
"""Number of commands from which an option is listed once, for all of them."""
HEAD = """# Options

`kilter check --help` prints all options of a command with their texts. The first table has the
options of most commands, the second the names of the others. Values of lengths are in the unit of
the file. Every question is also a function of [Python](python/index.md), with these names as
keywords.

"""


def first_sentence(text: str) -> str:
    """The first sentence of a text."""
    return " ".join(text.split()).partition(". ")[0].rstrip(".").replace("|", r"\|")


def page() -> str:
    """The page."""
    users: dict[tuple[tuple[str, ...], str], list[str]] = {}
    seen: dict[tuple[tuple[str, ...], str], Declared] = {}
    for command in COMMANDS:
        [function] = functions_of(command)
        for each in declared_of(function):
            if each.declaration.names:
                key = tuple(each.declaration.names), each.declaration.help
                users.setdefault(key, []).append(command)
                seen[key] = each
    shared = [key for key, names in users.items() if len(names) >= SHARED]
    rows = []
    for names, words in shared:
        values = "" if seen[names, words].is_flag else f" {seen[names, words].metavar}"
        name = f"{names[-1]}{values}".replace("|", r"\|")
        rows.append(f"| `{name}` | {first_sentence(words)} |\n")
    rare = [(key[0][-1], names) for key, names in users.items() if key not in shared]
    own = {command: [n for n, names in rare if command in names] for command in COMMANDS}
    others = [
        f"| `{command}` | {', '.join(f'`{name}`' for name in names)} |\n"
        for command, names in own.items()
        if names
    ]
    return (
        HEAD
        + "| option of most commands | meaning |\n|---|---|\n"
        + "".join(rows)
        + "\n| command | its other options |\n|---|---|\n"
        + "".join(others)
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
