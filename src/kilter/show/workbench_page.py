"""The page of the workbench: the template without data, which arrive through a WebSocket."""

from __future__ import annotations

from kilter.show.packing import as_json
from kilter.show.page import fill_template

__all__ = ["workbench_page"]

WORKBENCH = {
    "bar": "bench_bar.html",
    "above": "bench_start.html",
    "panels": "bench_decide.html",
    "actions": "bench_actions.html",
    "later": "bench_forces.html ball.html",
    "motion": "motion.html",
    "player": "bench_tabs.html fall.html",
    "body": "bench_body.html",
}
"""Asset files of the workbench, by the slot of the template."""


def workbench_page(token: str) -> str:
    """HTML of the page of the workbench."""
    data = as_json({"workbench": {"token": token}})
    return fill_template("", "", data, live=True, pieces=WORKBENCH)
