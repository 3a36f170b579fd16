"""The command `help`: pages of the documentation for a terminal, and the example files they use.

The pages are the Markdown files of the site. A wheel has them in `kilter/pages`, a clone in `docs`.
"""

from __future__ import annotations

import re
import shutil
import textwrap
from dataclasses import dataclass
from pathlib import Path

from kilter.cli.exit_codes import WRITTEN
from kilter.cli.options import takes
from kilter.errors import InputError, nearest_name
from kilter.values.declaration import argument

PACKAGE = Path(__file__).resolve().parents[1]
CLONE = PACKAGE.parents[1]
KINDS = ("tutorials", "guides", "reference", "explanation")
"""Folders of the pages, in the order of the list."""
WIDTH = 96
"""Largest number of columns of a page; narrower where the terminal is narrower."""
OWN = (".py", ".ipynb", ".kilter.json")
"""Endings of examples that are no input files: programs, notebooks, and scenes of the library."""


def topics() -> dict[str, Path]:
    """The file of each page by its topic, in the order of the list."""
    home = next((p for p in (PACKAGE / "pages", CLONE / "docs") if p.is_dir()), None)
    if home is None:
        return {}
    return {path.stem: path for kind in KINDS for path in sorted((home / kind).glob("*.md"))}


def shipped() -> dict[str, Path]:
    """Example files that are no scenes, by name: drawings, tables and models of the guides."""
    home = next((p for p in (PACKAGE / "examples", CLONE / "examples") if p.is_dir()), None)
    files = [] if home is None else sorted(home.iterdir())
    return {path.name: path for path in files if not path.name.endswith(OWN)}


def title(path: Path) -> str:
    """The heading of a page."""
    return path.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")


def as_text(page: str, columns: int = WIDTH) -> str:
    """Convert a page from Markdown to text: tables become paragraphs, links a last line.

    >>> print(as_text("# A page\\n\\nSee [the levels](../reference/levels.md#proved)."))
    A PAGE
    <BLANKLINE>
    See the levels.
    <BLANKLINE>
    See also: kilter help levels
    """
    lines, code, block = [], False, ""
    linked = dict.fromkeys(re.findall(r"\]\((?:[\w./-]*/)?([\w-]+)\.md[#)]", page))

    def close() -> None:
        nonlocal block
        if block:
            mark = re.match(r"(?:- |\d+\. )?", block)[0]  # type: ignore[index]
            lines.append(textwrap.fill(block, columns, subsequent_indent=" " * len(mark)))
            block = ""

    for line in page.splitlines():
        if line.startswith("```"):
            close()
            code = not code
        elif code:
            lines.append(f"    {line}".rstrip())
        elif line.startswith("|"):
            close()
            cells = [_plain(cell.strip()) for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            if not re.fullmatch(r"[\s:|-]+", line):
                row = "  ".join(cell for cell in cells if cell)
                lines.append(textwrap.fill(row, columns, subsequent_indent="    "))
        elif line.startswith("#"):
            close()
            words = _plain(line.lstrip("# "))
            lines.append(words.upper() if line.startswith("# ") else words)
        elif not line.strip() or line.startswith(("<", "![")):
            close()
            lines.append("")
        elif re.match(r"- |\d+\. ", line):
            close()
            block = _plain(line)
        else:
            block = f"{block} {_plain(line.strip())}".strip()
    close()
    if linked:
        words = f"See also: kilter help {', '.join(linked)}"
        lines += ["", textwrap.fill(words, columns, break_on_hyphens=False)]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip()


def _plain(line: str) -> str:
    """A line without the marks of Markdown."""
    line = re.sub(r"!\[([^\]]*)\]\([^)]*\)", r"(picture: \1)", line)
    line = re.sub(r"\[([^\]]+)\]\([^)]*\.md(?:#[^)]*)?\)", r"\1", line)
    line = re.sub(r"\[([^\]]+)\]\((?:\.\./)*examples/([^)]+)\)", r"\1 (kilter example \2)", line)
    line = re.sub(r"\[([^\]]+)\]\(([^)]+)\)", r"\1 (\2)", line)
    return re.sub(r"\*\*|`|(?<!\w)\*(?=\w)|(?<=\w)\*(?!\w)|</?\w+[^>]*>", "", line)


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
