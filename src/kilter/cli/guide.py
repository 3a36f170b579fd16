"""The command `help`: pages of the documentation for a terminal, and the example files they use."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from kilter.cli.exit_codes import WRITTEN
from kilter.cli.options import takes
from kilter.errors import InputError, nearest_name
from kilter.tell.guide_pages import CLONE, PACKAGE, WIDTH, as_text, title, topics
from kilter.values.declaration import argument

OWN = (".py", ".ipynb", ".kilter.json")
"""Endings of examples that are no input files: programs, notebooks, and scenes of the library."""


def shipped() -> dict[str, Path]:
    """Example files that are no scenes, by name: drawings, tables and models of the guides."""
    home = next((p for p in (PACKAGE / "examples", CLONE / "examples") if p.is_dir()), None)
    files = [] if home is None else sorted(home.iterdir())
    return {path.name: path for path in files if not path.name.endswith(OWN)}


@dataclass(frozen=True, kw_only=True)
class HelpOptions:
    """Options of `help`."""

    topic: str | None = argument(
        "[TOPIC]", "Page or command. Without a topic all pages are listed.", default=None
    )


@takes
def help(options: HelpOptions) -> int:
    """Print a page of the documentation, or the list of the pages. It needs no network.

    With the name of a command, its options are printed, as by 'kilter COMMAND --help'.
    """
    from kilter.cli.commands import COMMANDS
    from kilter.cli.option_parser import help_text

    pages, name = topics(), options.topic
    if name is None:
        kind = ""
        for topic, path in pages.items():
            if path.parent.name != kind:
                kind = path.parent.name
                print(kind)
            print(f"  {topic:20}{title(path)}")
        print("\nkilter help TOPIC prints a page, kilter COMMAND --help the options of a command.")
    elif name in pages:
        columns = min(shutil.get_terminal_size().columns, WIDTH)
        print(as_text(pages[name].read_text(encoding="utf-8"), columns))
    elif name in COMMANDS:
        print(help_text(name))
    else:
        near = nearest_name(name, [*pages, *COMMANDS])
        hint = f"did you mean {near!r}?" if near else "'kilter help' lists the pages"
        raise InputError(f"there is no page {name!r:.60}", hint=hint)
    return WRITTEN
