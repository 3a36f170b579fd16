"""Write docs/kilter.1, the man page, from the commands, the exit codes and the list of the pages.

`python docs/build_man.py`; a wheel installs it as `share/man/man1/kilter.1`.
"""

from __future__ import annotations

import re
from pathlib import Path

from kilter.cli.overview import GROUPS
from kilter.tell.guide_pages import as_text, title, topics

DOCS = Path(__file__).resolve().parent
PAGE = DOCS / "kilter.1"
CODES = "exit-codes"
"""Page whose first table has the exit codes."""


def escaped(text: str) -> str:
    """A text whose signs have no meaning for troff."""
    text = text.replace("\\", r"\e").replace("-", r"\-")
    return re.sub(r"(?m)^([.'])", r"\&\1", text)


def entries(rows: list[tuple[str, str]]) -> str:
    """Paragraphs with a bold name and a text."""
    return "".join(f".TP\n.B {escaped(name)}\n{escaped(text)}\n" for name, text in rows)


def page() -> str:
    """The man page."""
    pages = topics()
    commands = [(name, words) for group in GROUPS.values() for name, words in group.items()]
    text = pages[CODES].read_text(encoding="utf-8")
    [table] = re.findall(r"^\| code \|.*?\n\|[-|: ]+\|\n(.*?)\n\n", text, flags=re.S | re.M)
    codes = [[cell.strip() for cell in row.split("|")[1:3]] for row in table.splitlines()]
    return (
        '.TH KILTER 1 "" "kilter" "User commands"\n.SH NAME\n'
        "kilter \\- does an assembly of rigid parts stay together under gravity?\n"
        ".SH SYNOPSIS\n.B kilter\n.I COMMAND\n[options] [FILE...]\n.SH COMMANDS\n"
        + entries(commands)
        + ".P\n.B kilter COMMAND \\-\\-help\nprints the options of a command.\n.SH EXIT STATUS\n"
        + entries([(code, as_text(words, 10_000)) for code, words in codes])
        + ".SH PAGES\n.B kilter help PAGE\nprints a page without a network:\n"
        + entries([(name, title(path)) for name, path in pages.items()])
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
