"""The offline HTML page: template, style, program and data in a single file.

The Content-Security-Policy of the page forbids every connection and allows only the programs
whose digests it lists. Words from a file therefore cannot run as a program.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Sequence
from importlib import resources
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from kilter.show.packing import as_json, readable
from kilter.show.plan_scene import build_plan_scene, plan_sections
from kilter.show.scene import build_scene
from kilter.show.sections import (
    build_place_layer,
    margin_card,
    place_card,
    sections,
    text,
)
from kilter.tell.palette import as_css

if TYPE_CHECKING:
    from kilter.analysis.everything import Everything
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.explained import Explained
    from kilter.analysis.planning.order.order import Order


SLOTS = ("bar", "above", "rungs", "panels", "side", "actions", "later", "motion", "player", "body")
"""Slots of the template that hold asset files of one kind of page."""
REPORT = {
    "motion": "motion.html",
    "player": "fall.html supports.html",
    "side": "ball.html",
    "panels": "ladder.html",
}
"""Asset files of a report, by the slot of the template."""
PLAN = {"player": "player.html", "side": "step.html"}
"""Asset files of a plan, by the slot of the template."""
PACKAGES = ("kilter", "numpy", "scipy", "highspy", "clarabel")
"""Packages whose versions the page states."""


def render(
    answers: Everything, title: str, *, command: str = "", places: Places | None = None
) -> str:
    """Build the HTML page of an assembly and its answers.

    Arguments: `places`: a map of the next part on this assembly, which the page shows as a layer.
    """
    scene = {"title": readable(title), **build_scene(answers)}
    first = ""
    if places is not None:
        scene["places"] = build_place_layer(places)
        first = place_card(places)
    body = sections(answers, command=command, versions=_versions())
    cards = margin_card(answers)
    return fill_template(title, body, as_json(scene), first=first, margins=cards)


def render_plan(order: Order, explained: Explained, title: str, *, command: str = "") -> str:
    """Build the HTML page of a plan: its steps as a film and as pictures, with facts."""
    data = as_json({"title": readable(title), **build_plan_scene(order, explained)})
    body = plan_sections(order, explained, command=command, versions=_versions())
    return fill_template(title, body, data, pieces=PLAN)


def fill_template(
    title: str,
    body: str,
    data: str,
    *,
    live: bool = False,
    first: str = "",
    margins: str = "",
    pieces: dict[str, str] | None = None,
) -> str:
    """Fill the page template.

    Arguments: `pieces`: slots of the template and the names of their asset files, separated by
    spaces; by default `REPORT`.
    """
    style, program = as_css() + _asset("page.css"), _asset("page.js")
    scripts = [program]
    policy = "; ".join(
        [
            "default-src 'none'",
            "script-src " + " ".join(_digest(script) for script in scripts),
            f"style-src {_digest(style)}",
            "base-uri 'none'",
            "form-action 'none'",
            *(["connect-src 'self'"] if live else []),
        ]
    )
    chosen = {**dict.fromkeys(SLOTS, ""), **(pieces or REPORT)}
    values = {
        **{slot: "".join(map(_asset, names.split())) for slot, names in chosen.items()},
        "policy": policy,
        "title": text(title),
        "style": style,
        "margins": margins,
        "data": data,
        "program": "".join(f"<script>{script}</script>\n" for script in scripts),
    }
    values["body"] += body
    values["panels"] = first + values["panels"]
    # one pass, so that a slot name inside a filled-in value is not replaced
    return re.sub(r"\{\{(\w+)\}\}", lambda match: values[match[1]], _asset("page.html"))


def _versions() -> dict[str, str]:
    """Versions of kilter and of the packages it computes with, by name."""
    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "unknown"
    return versions


def _digest(script: str) -> str:
    digest = base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")
    return f"'sha256-{digest}'"


def _asset(name: str) -> str:
    return (resources.files("kilter.show") / "assets" / name).read_text(encoding="utf-8")


# The page of the workbench: the template without data, which arrive through a WebSocket.


WORKBENCH = {
    "bar": "bench_bar.html",
    "above": "bench_start.html",
    "rungs": "bench_rungs.html",
    "panels": "ladder.html bench_decide.html",
    "actions": "bench_actions.html",
    "later": "bench_forces.html ball.html",
    "motion": "motion.html",
    "player": "bench_tabs.html fall.html supports.html",
}
"""Asset files of the workbench, by the slot of the template."""


def workbench_page(token: str, guides: Sequence[Sequence[str]] = ()) -> str:
    """HTML of the page of the workbench; `guides`: name and title of each page of its help."""
    data = as_json({"workbench": {"token": token, "guides": guides}})
    return fill_template("", "", data, live=True, pieces=WORKBENCH)
