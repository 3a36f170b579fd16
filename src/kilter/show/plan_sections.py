"""The text of the page of a plan: what was found, its steps, which must come first, how made."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kilter.show.precedence import graph_svg
from kilter.show.sections import (
    facts_html,
    made_section,
    named,
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
"""Steps up to which the graph is drawn."""
PLAYED = (
    "Playing solves nothing: ways, held parts and forces are those of the plan. Forces are one "
    "possible set, as the proof of the step has them; a nut turns for the picture alone."
)


def plan_sections(
    order: Order, explained: Explained, *, command: str, versions: dict[str, str]
) -> str:
    """The sections below the picture."""
    answer = order.to_dict()
    parts = [_found(answer), _steps(answer), _graph(answer, explained)]
    parts.append(warnings_section(answer["warnings"]))
    parts.append(made_section(command, versions, ("the film", PLAYED)))
    return "\n".join(filter(None, parts))


def _found(answer: dict[str, Any]) -> str:
    rows = [("in words", text(answer["sentence"]))]
    rows += [(term, text(words)) for term, words in facts(answer)]
    if answer["level"] is not None:
        rows.append(("what that says", text(LEVELS[answer["level"]])))
    return section("What was found", facts_html(rows))


def _steps(answer: dict[str, Any]) -> str:
    """A row a step."""
    if not answer["steps"]:
        return ""

    def row(k: int, step: dict[str, Any]) -> list[str]:
        way, held, freed, level = step_cells(step)
        names = "".join(named(name) for name in step["parts"])
        button = f'<button type="button" class="link" data-step="{k}">{names}</button>'
        touches = ", ".join(step["touches"])
        return [str(k + 1), button, *map(text, (way, touches, held, freed, level))]

    head = ["", "part", "comes in", "touches", "held meanwhile", "then let go", "level"]
    body = rows_html(head, [row(k, s) for k, s in enumerate(answer["steps"])], len(answer["steps"]))
    return section(f"Steps ({len(answer['steps'])})", body)


def _graph(answer: dict[str, Any], explained: Explained) -> str:
    if not answer["steps"] or len(answer["steps"]) > DRAWN:
        return ""
    needs = [(one.before, one.after) for one in explained.needs]
    way = "would be in its way" if explained.swept else "(ways are not compared at this size)"
    note = (
        f"Dark arrows: the first has to come before the second, which was asked for or {way}. Pale "
        "lines: the second touches the first once it is in place. What others imply is left out. "
        "Nodes are steps; blue ones are held at some time."
    )
    body = (
        f'<div id="graph" class="wide">{graph_svg(answer, needs)}</div><p class="small">{note}</p>'
    )
    return section("Precedence", body)
