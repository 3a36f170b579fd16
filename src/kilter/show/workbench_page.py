"""The page of the workbench: the template without data, which arrive through a WebSocket."""

from __future__ import annotations

from kilter.show.packing import as_json
from kilter.show.page import fill_template

__all__ = ["workbench_page"]


def workbench_page(token: str) -> str:
    """HTML of the page of the workbench.

    Parameters
    ----------
    token : str
        Token that each request of the page sends.
    """
    return fill_template("workbench", "", as_json({"workbench": {"token": token}}), live=True)
