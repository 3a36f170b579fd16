"""Base class of the answers that a notebook can show as a page."""

from __future__ import annotations

from typing import Any

from kilter.hooks import hook

__all__ = ["InCells"]


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
