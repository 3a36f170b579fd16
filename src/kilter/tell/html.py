"""Answers as HTML for notebooks: the sentence and the facts, with every word escaped."""

from __future__ import annotations

import html
from typing import Any

from kilter.hooks import hook
from kilter.tell.check_facts import Answer
from kilter.tell.facts import facts
from kilter.tell.palette import ink_of
from kilter.tell.tables import moving_table, sentences

# Base class of the answers that a notebook can show as a page.


class InCells:
    """Base class of answers that a notebook can display as an interactive page."""

    __slots__ = ()

    def show(self, *, height: int = 720, title: str = "") -> Any:
        """Return the interactive page of the answer as the output of a notebook cell.

        It is the page that `kilter.report` writes. Viewers that run no scripts show a figure
        instead, if matplotlib is installed.

        Parameters
        ----------
        height : int
            Height of the frame [px].
        title : str
            Title above the page; the name of the file by default.

        Returns
        -------
        kilter.Shown

        Raises
        ------
        InputError
            As `kilter.report`.
        """
        # the page is drawn by an upper package, which this package cannot import
        return hook("cell")(self, height=height, title=title)


ROWS = 12
"""Largest number of moving parts, the fastest first, and of warnings that are listed."""
LONG = 80
"""Largest number of characters of a name."""


def html_of(answer: Answer) -> str:
    """Return an answer as HTML: the sentence, the moving parts, the facts and the warnings.

    Examples
    --------
    >>> "&lt;b&gt;" in html_of({"kilter": 1, "parts": [{"name": "<b>", "grounded": True}]})
    True
    """
    moving = moving_table(answer)
    rows: list[tuple[str, str]] = []
    if moving is not None:
        rows += [(row[0], row[1]) for row in moving.rows(ROWS)]
        if len(moving.items) > ROWS:
            rows.append(("…", f"and {len(moving.items) - ROWS} more"))
    body = "".join(
        f'<tr><td style="text-align:left"><bdi>{_text(name)}</bdi></td>'
        f'<td style="text-align:left">{_text(value, 1000)}</td></tr>'
        for name, value in [*rows, *facts(answer)]
    )
    warnings = answer.get("warnings", ())
    items = "".join(f"<li>{_text(warning, 400)}</li>" for warning in warnings[:ROWS])
    word = str(answer.get("verdict", "none" if answer.get("kind") == "none" else "stable"))
    style = f"color:{ink_of(word)};font-weight:bold"
    head = "".join(f'<p style="{style}">{_text(line, 1000)}</p>' for line in sentences(answer))
    return (
        f'<div class="kilter">{head}<table><tbody>{body}</tbody></table>'
        f"{f'<ul>{items}</ul>' if items else ''}</div>"
    )


def _text(value: str, length: int = LONG) -> str:
    """Escape text for HTML, join it to one line, and cut it to a length."""
    value = value if len(value) <= length else value[: length - 1] + "…"
    plain = "".join(c if c.isprintable() else "\ufffd" for c in value)
    return html.escape(plain, quote=True)
