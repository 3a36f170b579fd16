"""Text sections of a plan's page: result, steps, precedence graph, warnings, reproduction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from kilter.show.precedence import graph_svg
from kilter.show.sections import (
    facts_html,
    made_section,
    name_html,
    rows_html,
    section,
    text,
    warnings_section,
)
from kilter.tell.facts import facts
from kilter.tell.plan_words import step_cells
from kilter.tell.step_facts import LEVELS

if TYPE_CHECKING:
    from kilter.analysis.planning.order.explained import Explained
    from kilter.analysis.planning.order.order import Order

__all__ = ["plan_sections"]

DRAWN = 150
"""Largest number of steps for which the precedence graph is drawn."""
PLAYED = (
    "Playing starts no computation: paths, held parts and forces are those of the plan. The forces "
    "are those of the proof of the step, and not unique. The turning of a nut is illustration."
)


def plan_sections(
    order: Order, explained: Explained, *, command: str, versions: dict[str, str]
) -> str:
    """HTML of all text sections of a plan's page, below the picture."""
    answer = order.to_dict()
    parts = [_result(answer), _steps(answer), _graph(answer, explained)]
    parts.append(warnings_section(answer["warnings"]))
    parts.append(made_section(command, versions, ("the film", PLAYED)))
    return "\n".join(filter(None, parts))


def _result(answer: Mapping[str, Any]) -> str:
    rows = [("in words", text(answer["sentence"]))]
    rows += [(term, text(words)) for term, words in facts(answer)]
    if answer["level"] is not None:
        rows.append(("meaning of the level", text(LEVELS[answer["level"]])))
    return section("Result", facts_html(rows))


def _steps(answer: Mapping[str, Any]) -> str:
    """HTML section with a table of the steps of a plan; empty without steps."""
    if not answer["steps"]:
        return ""

    def row(k: int, step: Mapping[str, Any]) -> list[str]:
        way, held, freed, level = step_cells(step)
        names = "".join(name_html(name) for name in step["parts"])
        button = f'<button type="button" class="link" data-step="{k}">{names}</button>'
        touches = ", ".join(step["touches"])
        return [str(k + 1), button, *map(text, (way, touches, held, freed, level))]

    head = ["", "part", "inserted", "touches", "held during the step", "released after", "level"]
    body = rows_html(head, [row(k, s) for k, s in enumerate(answer["steps"])], len(answer["steps"]))
    return section(f"Steps ({len(answer['steps'])})", body)


def _graph(answer: Mapping[str, Any], explained: Explained) -> str:
    """HTML section with the precedence graph of a plan.

    Empty without steps or with more than `DRAWN` steps.
    """
    if not answer["steps"] or len(answer["steps"]) > DRAWN:
        return ""
    needs = [(need.before, need.after) for need in explained.needs]
    reason = (
        "because of an option or because the second would block the path of the first"
        if explained.swept
        else "because of `--before` or `--screws` (paths are not compared for this many parts)"
    )
    note = (
        f"Nodes are steps. A dark arrow: the first step must come before the second, {reason}. "
        "A pale line: the part of the second step touches that of the first. Arrows and lines that "
        "follow from others are left out. Blue: the part is held by a hand at some time."
    )
    body = (
        f'<div id="graph" class="wide">{graph_svg(answer, needs)}</div><p class="small">{note}</p>'
    )
    return section("Precedence", body)
