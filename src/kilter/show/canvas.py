"""Figures that matplotlib makes: without pyplot, a display, or a file of settings.

Words from a file are never read as formulas, and never run over the picture: see `label`.
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

__all__ = ["SUFFIXES", "blank", "label", "legend", "rendered", "require", "title"]

SUFFIXES = (".svg", ".png", ".pdf")
"""What a figure can be written as."""
SHORT = 24
"""Characters of a name that are shown."""
LINE = 72
"""Characters of a line of the title."""
LINES = 3
DOTS = 200
"""Of a PNG, an inch."""
INK = ROLES["ink"].light
PAPER = ROLES["surface"].light


def require() -> None:
    """See that matplotlib is there.

    Raises
    ------
    InputError
        If not, with the command that installs it.
    """
    if importlib.util.find_spec("matplotlib") is None:
        raise InputError("drawing needs matplotlib", hint="pip install 'kilter[figures]'")


def blank(width: float, height: float) -> Figure:
    """An empty figure, sizes in inches, that shows itself in a notebook."""
    require()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    class Picture(Figure):  # type: ignore[misc, unused-ignore]
        """A figure that a notebook shows without any settings."""

        def _repr_png_(self) -> bytes:
            return rendered(self, ".png")

    figure = Picture(figsize=(width, height), facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def rendered(figure: Figure, suffix: str) -> bytes:
    """The figure as the bytes of a file: the same bytes for the same picture.

    Raises
    ------
    InputError
        If `suffix` is none of `SUFFIXES`.
    """
    import matplotlib

    suffix = suffix.lower()
    if suffix not in SUFFIXES:
        kinds = ", ".join(SUFFIXES)
        raise InputError(f"{suffix or 'no ending'!r} is no kind of figure", hint=f"one of {kinds}")
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
        # scripts that the font lacks are shown as boxes in a PNG, as themselves in an SVG
        warnings.filterwarnings("ignore", message=".*[Gg]lyph.*")
        figure.savefig(target, format=suffix[1:], dpi=DOTS, metadata=metadata[suffix])
    return target.getvalue()


def label(name: str, length: int = SHORT) -> str:
    """A name, short and in one line of characters that can be shown.

    Examples
    --------
    >>> label("a" * 100, 5)
    'aaaa…'
    """
    # cut first: a name may be very long
    name = readable(name[: length + 1])
    return name if len(name) <= length else name[: length - 1] + "…"


def title(figure: Figure, sentence: str, verdict: str = "") -> None:
    """The sentence above a picture, in the colour of its verdict."""
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
    """What the signs below a picture mean, and in which units."""
    if not entries:
        return
    drawn = figure.legend(
        [handle for handle, _ in entries],
        [words for _, words in entries],
        loc="lower center",
        ncols=min(columns, len(entries)),
        frameon=False,
        fontsize=8.5,
        handlelength=2.2,
        labelcolor=INK,
    )
    for text in drawn.get_texts():
        text.set_parse_math(False)
