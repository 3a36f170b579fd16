"""Answers as a notebook shows them: a sentence and a small table, every word escaped."""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from kilter.analysis.regions.region import Region
    from kilter.analysis.turning.orientation import Orientation
    from kilter.analysis.verdict import Verdict

__all__ = ["orientation_html", "region_html", "verdict_html"]

ROWS = 12
"""Parts that are listed, the fastest first."""
LONG = 80
"""Characters of a name that are shown."""
COLOURS = {
    "stable": "#00694E",
    "found": "#00694E",
    "potentially-stable": "#8A5A00",
    "unstable": "#B3261E",
    "none": "#B3261E",
    "undecided": "#4B5563",
}
"""Of the sentence; the word says it too."""


def verdict_html(verdict: Verdict) -> str:
    """The sentence, what moves and how, and the figures of the proof.

    Examples
    --------
    >>> from kilter.analysis.check import check
    >>> from kilter.scenes import scene
    >>> "C2" in verdict_html(check(scene("paper-figure-8")))
    True
    """
    assembly, motion = verdict.assembly, verdict.motion
    which = np.flatnonzero(motion.moves)
    order = which[np.argsort(-motion.relative[which].max(axis=1), kind="stable")]
    rows = [(assembly.names[k], verdict.words(int(k))) for k in order[:ROWS].tolist()]
    if len(order) > ROWS:
        rows.append(("…", f"and {len(order) - ROWS} more"))
    free = sum(not part.grounded for part in assembly.parts)
    rows += [
        ("parts", f"{free} free, {len(assembly.parts) - free} held"),
        ("contacts", f"{verdict.contacts.pairs} pairs, {len(verdict.contacts.points)} points"),
        ("gravity", f"{np.linalg.norm(assembly.gravity):.4g} m/s² along {_vector(assembly.down)}"),
    ]
    if not assembly.loads:
        rows.append(("instability κ", f"{motion.instability:.6g} (0 stable, 1 free fall)"))
    return _shown(verdict.sentence, verdict.verdict, rows, verdict.warnings)


def region_html(region: Region) -> str:
    """The kind of region, its width and its recommended direction."""
    half, center = region.half_angle_deg, region.center
    rows = [("kind", region.kind if region.exact else f"{region.kind} (inner: more may be stable)")]
    if half is not None:
        rows.append(("half angle", f"{half:.6g}°"))
    if center is not None:
        rows.append(("widest margin at", _vector(center)))
    rows += [("ray", _vector(ray)) for ray in region.rays[:ROWS]]
    rows += [("line", f"± {_vector(line)}") for line in region.lines]
    word = "none" if region.kind == "none" else "stable"
    return _shown(f"Stable directions of gravity: {region.kind}", word, rows, region.warnings)


def orientation_html(answer: Orientation) -> str:
    """The sentence, the direction, the turn to it and its margin."""
    rows = [
        ("gravity along", _vector(answer.down)),
        ("turn (w, x, y, z)", _vector(answer.rotation)),
    ]
    if answer.tilt_margin_deg is not None:
        rows.append(("tilt margin", f"{answer.tilt_margin_deg:.6g}°"))
    rows.append(("instability κ", f"{answer.instability:.6g}"))
    return _shown(answer.sentence, answer.verdict, rows, answer.warnings)


def _shown(
    sentence: str, word: str, rows: Sequence[tuple[str, str]], warnings: Sequence[str]
) -> str:
    body = "".join(
        f'<tr><td style="text-align:left"><bdi>{_text(name)}</bdi></td>'
        f'<td style="text-align:left">{_text(value)}</td></tr>'
        for name, value in rows
    )
    told = "".join(f"<li>{_text(warning, 400)}</li>" for warning in warnings[:ROWS])
    style = f"color:{COLOURS.get(word, COLOURS['undecided'])};font-weight:bold"
    return (
        f'<div class="kilter"><p style="{style}">{_text(sentence, 1000)}</p>'
        f"<table><tbody>{body}</tbody></table>{f'<ul>{told}</ul>' if told else ''}</div>"
    )


def _text(value: str, length: int = LONG) -> str:
    """Text as HTML: one line, of limited length, in the direction of the text around it."""
    value = value if len(value) <= length else value[: length - 1] + "…"
    plain = "".join(c if c.isprintable() else "\ufffd" for c in value)
    return html.escape(plain, quote=True)


def _vector(values: object) -> str:
    numbers = np.round(np.asarray(values, dtype=np.float64), 6) + 0.0
    return "(" + ", ".join(f"{v:.6g}" for v in numbers) + ")"
