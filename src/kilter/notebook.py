"""Answers in a notebook: the page of `kilter.report` in the output of a cell.

The page is embedded in an iframe, which runs its program and makes no request. It works in
Jupyter, VS Code and marimo without a network. Viewers that run no programs show a figure (with
the extra ``kilter[figures]``) and text.
"""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.publish import draw, report
from kilter.show.canvas import encode_figure

if TYPE_CHECKING:
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.verdict.verdict import Verdict


FRAME = (
    '<iframe class="kilter" title="{title}" sandbox="allow-scripts allow-downloads" '
    'style="width:100%;height:{height}px;border:0" srcdoc="{page}"></iframe>'
)


class Shown:
    """An answer with its page, for display in a notebook cell.

    Attributes
    ----------
    html : str
        The page of `kilter.report`.
    answer : Verdict, Region or Order
    height : int
        Height of the frame [px].
    """

    __slots__ = ("_figure", "answer", "height", "html")

    def __init__(self, answer: Any, html: str, height: int) -> None:
        self.answer, self.html, self.height = answer, html, height
        self._figure: str | None = None

    def _repr_html_(self) -> str:
        page = html.escape(self.html, quote=True)
        title = html.escape(str(self), quote=True)
        return FRAME.format(title=title, height=self.height, page=page)

    def _repr_svg_(self) -> str | None:
        """Figure of the answer as SVG; None without matplotlib or without anything to draw."""
        if self._figure is None:
            try:
                figure = draw(self.answer)
            except InputError:
                return None
            self._figure = encode_figure(figure, ".svg").decode("utf-8")
        return self._figure

    def __str__(self) -> str:
        return str(getattr(self.answer, "sentence", self.answer))

    def __repr__(self) -> str:
        return f"<Shown: {self.answer!r}>"


def cell(
    answer: Verdict | Region | Order | Assembly, *, height: int = 720, title: str = ""
) -> Shown:
    """Build the page of an answer for the output of a notebook cell.

    Parameters
    ----------
    answer : Verdict, Region, Order or Assembly
        For a verdict or a region, the page shows their assembly with the contacts of the answer.
    height : int
        Height of the frame [px].
    title : str
        Title of the page; by default the name of the file.

    Raises
    ------
    InputError
        If the region belongs to several assemblies, or for the reasons of `kilter.report`.

    Examples
    --------
    >>> from kilter.analysis.check import check
    >>> from kilter.scenes import scene
    >>> cell(check(scene("tower")), height=400)._repr_html_()[:22]
    '<iframe class="kilter"'
    """
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region

    if not (isinstance(height, int) and height > 0):
        raise InputError(f"the height is {height!r:.40}", hint="give a whole number of pixels")
    if isinstance(answer, Assembly):
        return Shown(answer, report(answer, title=title).html, height)
    if isinstance(answer, Order):
        return Shown(answer, report(answer, title=title).html, height)
    if isinstance(answer, Region):
        if len(answer.assemblies) > 1:
            raise InputError(
                f"the region belongs to {len(answer.assemblies)} assemblies, but a page shows one",
                hint="draw it with kilter.draw(region)",
            )
        page = report(answer.assemblies[0], contacts=answer.contacts[0], title=title)
        return Shown(answer, page.html, height)
    page = report(
        answer.assembly,
        contacts=answer.contact_set,
        effort=answer.effort,
        time_limit=answer.time_limit,
        title=title,
    )
    return Shown(answer, page.html, height)
