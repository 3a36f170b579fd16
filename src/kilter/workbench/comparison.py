"""Comparison of the answers of two states of a session."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from kilter.analysis.check import check
from kilter.show.sections import rows_html, text
from kilter.tell.facts import facts
from kilter.workbench.live_assembly import LiveAssembly

__all__ = ["comparison_data"]


def comparison_data(
    live: LiveAssembly,
    labels: Sequence[str],
    states: Sequence[dict[str, Any]],
    progress: Callable[[str], None],
) -> dict[str, Any]:
    """The verdicts on two states side by side, as a table, and whether they differ."""
    answers = []
    for label, keys in zip(labels, states, strict=True):
        progress(label)
        prepared = live.prepare(keys)
        verdict = check(prepared.assembly, contacts=prepared.contacts, tolerance=prepared.tolerance)
        answers.append(verdict.to_dict())
    columns = [_facts(answer) for answer in answers]
    terms = list(dict.fromkeys(term for column in columns for term in column))
    rows = [
        [text(term), *(text(column.get(term, "")) for column in columns)]
        for term in terms
        if columns[0].get(term) != columns[1].get(term) or term == "verdict"
    ]
    same = answers[0]["verdict"] == answers[1]["verdict"]
    sentence = (
        f"Both states are {answers[0]['verdict']}."
        if same
        else f"The verdict changes from {answers[0]['verdict']} to {answers[1]['verdict']}."
    )
    return {
        "name": "compare",
        "data": {"verdicts": [answer["verdict"] for answer in answers], "labels": list(labels)},
        "html": f"<p>{text(sentence)}</p>" + rows_html(["", *labels], rows, len(rows)),
        "sentence": sentence,
        "command": "",
        "orientation": None,
    }


def _facts(answer: Any) -> dict[str, str]:
    """Facts of an answer by term, with the verdict, the moving parts and the warnings."""
    moving = [part["name"] for part in answer["parts"] if part["moves"]]
    listed = {term: words for term, words in facts(answer) if term != "seconds"}
    return {
        "verdict": answer["verdict"],
        "sentence": answer["sentence"],
        "moving parts": ", ".join(moving[:MOST]) + (" ..." if len(moving) > MOST else ""),
        **listed,
        "warnings": " ".join(answer["warnings"]),
    }


MOST = 12
"""Largest number of moving parts that the comparison names."""
