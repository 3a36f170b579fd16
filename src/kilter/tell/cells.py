"""Base class of the answers that a notebook can show as a page."""

from __future__ import annotations

from typing import Any

from kilter.hooks import hook

__all__ = ["InCells"]


class InCells:
    """An answer that a notebook can show as a page."""

    __slots__ = ()

    def show(self, *, height: int = 720, title: str = "") -> Any:
        """Return the page of this answer for the cell of a notebook. It needs no network.

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
