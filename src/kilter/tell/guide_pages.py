"""Pages of the documentation as text, without a network.

The pages are the Markdown files of the site. A wheel has them in `kilter/pages`, a clone in `docs`.
"""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
CLONE = PACKAGE.parents[1]
KINDS = ("tutorials", "guides", "reference", "explanation")
"""Folders of the pages, in the order of the list."""
WIDTH = 96
"""Largest number of columns of a page; narrower where the terminal is narrower."""


def topics() -> dict[str, Path]:
    """The file of each page by its topic, in the order of the list."""
    home = next((p for p in (PACKAGE / "pages", CLONE / "docs") if p.is_dir()), None)
    if home is None:
        return {}
    return {path.stem: path for kind in KINDS for path in sorted((home / kind).glob("*.md"))}


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
