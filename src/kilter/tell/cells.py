"""What answers share that a notebook shows as a page."""

from __future__ import annotations

import importlib
from typing import Any

__all__ = ["InCells"]


class InCells:
    """An answer with a page of its own."""

    __slots__ = ()

    def show(self, *, height: int = 720, title: str = "") -> Any:
        """The page of this answer in the cell of a notebook; it turns without a network.

        It is the page that `kilter.report` writes. Viewers that run no programs get a figure, where
        matplotlib is there.

        Parameters
        ----------
        height : int
            Of the frame [px].
        title : str
            Above the page; the name of the file where it is not given.

        Returns
        -------
        kilter.Shown

        Raises
        ------
        InputError
            As `kilter.report`.
        """
        # drawing knows answers, not they it: it is asked for by name, when it is used
        return importlib.import_module("kilter.notebook").cell(self, height=height, title=title)
