"""Sentences of the site that claim a number of time, memory or size, or are absolute."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GENERATED = {"options.md"}
"""Pages that programs write from tests and code."""
ABSOLUTE = r"\b(?:always|never|at most|the same|cannot)\b"
NUMBER = r"\d\s?(?:s|ms|seconds?|minutes?|hours?|[kMG]B|bytes)\b(?!\^|²)|hundredth of a second"
SIZE = r"\d[\d,]* (?:free )?(?:parts|bricks|contact points|corners|states|objects|pairs)\b"
CLAIM = re.compile(f"(?i:{ABSOLUTE})|{NUMBER}|{SIZE}")


def sentences(text: str) -> list[str]:
    """Sentences and cells of tables of a page, without its code."""
    text = re.sub(r"^```.*?^```$|\A---\n.*?^---\n|^ {4}[^\n]*$", "", text, flags=re.S | re.M)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"^(#.*|- |\d+\. )", "\n", text, flags=re.M)
    rows = re.findall(r"^\|.*$", text, flags=re.M)
    pieces = re.split(r"\n\s*\n", re.sub(r"^\|.*$", "\n", text, flags=re.M))
    pieces += [cell for row in rows for cell in row.strip("|").split("|")]
    found = []
    for piece in pieces:
        found += re.split(r"(?<=[.!?:;])\s+(?=[A-Z`*(])", " ".join(piece.split()))
    return [each.strip() for each in found if each.strip()]


def claims() -> list[tuple[str, str]]:
    """Page and sentence of each claim of README and the site."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return [
        (page.relative_to(ROOT).as_posix(), sentence)
        for page in pages
        if "contributing" not in page.parts and page.name not in GENERATED
        for sentence in sentences(page.read_text(encoding="utf-8"))
        if CLAIM.search(re.sub(r"`[^`]*`", "", sentence))
    ]
