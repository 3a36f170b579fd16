"""Figures of matplotlib without pyplot, a display or a settings file.

Words from a file are never read as formulas, and are cut so that they fit (`label`).
"""

from __future__ import annotations

import importlib.util
import io
import textwrap
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError
from kilter.show.packing import readable
from kilter.tell.palette import ROLES, ink_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


SUFFIXES = (".svg", ".png", ".pdf")
"""File endings of the supported figure formats."""
SHORT = 24
"""Largest length of a name; a longer name is cut [characters]."""
LINE = 72
"""Length of a title line [characters]."""
LINES = 3
"""Maximum number of title lines; a longer title ends in an ellipsis."""
DOTS = 200
"""Resolution of a PNG [dots per inch]."""
INK = ROLES["ink"].light
PAPER = ROLES["surface"].light


def require() -> None:
    """Raise an error with installation advice if matplotlib is missing.

    Raises
    ------
    InputError
        If matplotlib is missing; the hint is the command that installs it.
    """
    if importlib.util.find_spec("matplotlib") is None:
        raise InputError("drawing needs matplotlib", hint="pip install 'kilter[figures]'")


def new_figure(width: float, height: float) -> Figure:
    """Create an empty figure with a width and height in inches; a notebook displays it."""
    require()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    class Picture(Figure):  # type: ignore[misc, unused-ignore]
        """A figure that a notebook shows as PNG."""

        def _repr_png_(self) -> bytes:
            return encode_figure(self, ".png")

    figure = Picture(figsize=(width, height), facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def encode_figure(figure: Figure, suffix: str) -> bytes:
    """Encode a figure as a file; equal figures give equal bytes.

    Raises `InputError` if `suffix` is not in `SUFFIXES`.
    """
    import matplotlib

    suffix = suffix.lower()
    if suffix not in SUFFIXES:
        kinds = ", ".join(SUFFIXES)
        raise InputError(
            f"{suffix or 'no ending'!r} is not a figure format", hint=f"use one of {kinds}"
        )
    metadata: dict[str, dict[str, Any]] = {
        ".svg": {"Date": None, "Creator": "kilter"},
        ".pdf": {"CreationDate": None, "Creator": "kilter", "Producer": None},
        ".png": {"Software": "kilter"},
    }
    settings: dict[Any, Any] = {
        "svg.fonttype": "none",
        "svg.hashsalt": "kilter",
        "pdf.fonttype": 42,
    }
    target = io.BytesIO()
    with matplotlib.rc_context(settings), warnings.catch_warnings():
        # a script that the font lacks: an SVG keeps its text, a PNG shows boxes
        warnings.filterwarnings("ignore", message=".*[Gg]lyph.*")
        figure.savefig(target, format=suffix[1:], dpi=DOTS, metadata=metadata[suffix])
    return target.getvalue()


def label(name: str, length: int = SHORT) -> str:
    """Cut a name for a figure to `length` printable characters on one line.

    Examples
    --------
    >>> label("a" * 100, 5)
    'aaaa…'
    """
    # cut first, because a name may be very long
    name = readable(name[: length + 1])
    return name if len(name) <= length else name[: length - 1] + "…"


def title(figure: Figure, sentence: str, verdict: str = "") -> None:
    """Write a sentence above the picture, in the colour of its verdict."""
    text = " ".join(label(word, LINE) for word in sentence[: LINE * (LINES + 1)].split())
    lines = textwrap.wrap(text, LINE, max_lines=LINES, placeholder=" …")
    figure.text(
        0.03,
        1 - 0.18 / figure.get_figheight(),
        "\n".join(lines),
        color=ink_of(verdict) if verdict else INK,
        fontsize=11,
        fontweight="bold",
        va="top",
        parse_math=False,
    )


def legend(figure: Figure, entries: Sequence[tuple[Any, str]], columns: int = 2) -> None:
    """Add a legend below the picture, with an entry for each pair (drawn sign, words)."""
    if not entries:
        return
    box = figure.legend(
        [handle for handle, _ in entries],
        [words for _, words in entries],
        loc="lower center",
        ncols=min(columns, len(entries)),
        frameon=False,
        fontsize=8.5,
        handlelength=2.2,
        labelcolor=INK,
    )
    for text in box.get_texts():
        text.set_parse_math(False)
