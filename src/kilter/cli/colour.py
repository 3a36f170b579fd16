"""Colour of the verdict on a terminal, equal to its colour on pages and figures.

``NO_COLOR`` and ``TERM=dumb`` switch colours off. ``FORCE_COLOR`` switches them on without a
terminal.

References
----------
https://no-color.org, https://force-color.org
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from typing import Any

from kilter.tell.palette import VERDICT_ROLE

__all__ = ["coloured", "in_colour"]

TERMINAL = {"stable": "1;34", "unstable": "1;33"}
"""Terminal codes of the roles of verdicts: blue, and yellow as the nearest colour to orange."""


def coloured() -> bool:
    """Whether standard output is a terminal that shows colours."""
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR"):
        return True
    return sys.stdout.isatty() and os.environ.get("TERM") != "dumb"


def in_colour(text: str, answer: Mapping[str, Any]) -> str:
    """A text with its first line in the colour of its verdict, if the terminal shows colours."""
    code = TERMINAL.get(VERDICT_ROLE.get(str(answer.get("verdict")), ""))
    if code is None or not coloured():
        return text
    first, *rest = text.split("\n", 1)
    return "\n".join([f"\x1b[{code}m{first}\x1b[0m", *rest])
