"""One offline page: template, style, program and data in one file that asks for nothing.

The page forbids every connection by its own policy (Content-Security-Policy), and runs only
the programs whose digests it names: words from a file cannot run even if they got that far.
"""

from __future__ import annotations

import base64
import hashlib
import re
from importlib import resources
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from kilter.show.packing import as_json, readable
from kilter.show.plan_scene import build_plan_scene
from kilter.show.plan_sections import plan_sections
from kilter.show.scene import build_scene
from kilter.show.sections import change_card, margin_card, sections, text
from kilter.tell.palette import as_css

if TYPE_CHECKING:
    from kilter.analysis.everything import Everything
    from kilter.analysis.planning.order.explained import Explained
    from kilter.analysis.planning.order.order import Order

__all__ = ["error_page", "render", "render_plan"]

MAIN = "<main>"
"""Where a page begins in its template; titles are escaped."""
REPORT = {"motion": "motion.html", "player": "fall.html", "side": "ball.html"}
PLAN = {"player": "player.html", "side": "step.html"}
"""What stands at the places of the template in which pages differ."""
PACKAGES = ("kilter", "numpy", "scipy", "highspy", "clarabel")


def render(answers: Everything, title: str, *, command: str = "", live: bool = False) -> str:
    """The page of an assembly and its answers.

    Parameters
    ----------
    answers : Everything
    title : str
        Shown above; usually the name of the file.
    command : str
        How to make the page again.
    live : bool
        For `kilter view`: the page asks its own server whether it has changed.
    """
    data = as_json({"title": readable(title), **build_scene(answers)})
    body = sections(answers, command=command, versions=_versions())
    return _filled(
        title, body, data, live=live, margins=change_card(answers) + margin_card(answers)
    )


def render_plan(order: Order, explained: Explained, title: str, *, command: str = "") -> str:
    """The page of a plan: its steps as a film and a strip, and what each rests on.

    Parameters
    ----------
    order : Order
    explained : Explained
        Of that order.
    title : str
        Shown above; usually the name of the file.
    command : str
        How to make the page again.
    """
    data = as_json({"title": readable(title), **build_plan_scene(order, explained)})
    body = plan_sections(order, explained, command=command, versions=_versions())
    return _filled(title, body, data, live=False, pieces=PLAN)


def error_page(message: str, last: str) -> str:
    """What `kilter view` shows while the file cannot be judged: why, above its last page."""
    said = (
        f'<p class="problem" role="alert">{text(message)}<br>Below: the file as it was before.</p>'
    )
    return last.replace(MAIN, f"{MAIN}\n{said}", 1)


def _filled(
    title: str,
    body: str,
    data: str,
    *,
    live: bool,
    margins: str = "",
    pieces: dict[str, str] | None = None,
) -> str:
    """The template, with `pieces`: the files of the parts in which pages differ."""
    style, program = as_css() + _asset("page.css"), _asset("page.js")
    scripts = [program, _asset("reload.js")] if live else [program]
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
    chosen = {"motion": "", "player": "", "side": "", **(pieces or REPORT)}
    values = {
        **{place: _asset(name) if name else "" for place, name in chosen.items()},
        "policy": policy,
        "title": text(title),
        "style": style,
        "body": body,
        "margins": margins,
        "data": data,
        "program": "".join(f"<script>{script}</script>\n" for script in scripts),
    }
    # one pass: what is filled in is not looked at again
    return re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], _asset("page.html"))


def _versions() -> dict[str, str]:
    """Of kilter and of what it computes with."""
    found = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "unknown"
    return found


def _digest(script: str) -> str:
    digest = base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")
    return f"'sha256-{digest}'"


def _asset(name: str) -> str:
    return (resources.files("kilter.show") / "assets" / name).read_text(encoding="utf-8")
