"""Files that the workbench exports: report, proof, answer, contacts, figure, film and plan."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from kilter import publish
from kilter.analysis.check import check
from kilter.analysis.planning.order.plan import plan
from kilter.errors import InputError
from kilter.files.own.choices import Choices
from kilter.files.writing import json_lines, write_text
from kilter.show.sections import rows_html, text
from kilter.tell.csv_cells import csv_text
from kilter.tell.facts import facts
from kilter.workbench.live_assembly import LiveAssembly, Prepared

# Comparison of the answers of two states of a session.


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


Tell = Callable[[str], None]


def export(
    kind: str, prepared: Prepared, folder: Path, job: Mapping[str, Any], progress: Tell
) -> Path:
    """Write a file of some kind to a folder and return its path.

    Arguments: `job`: `keys` of the choices, `title` of the page, and the command line `command`.
    Raises `InputError` if there is no such kind, or this answer has no such file.
    """
    if kind not in EXPORTS:
        raise InputError(f"there is no export {kind!r:.40}", hint=f"use {', '.join(EXPORTS)}")
    path = folder / kind
    EXPORTS[kind](prepared, path, job, progress)
    return path


def _report(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    publish.report(
        prepared.assembly,
        path,
        title=job["title"],
        contacts=prepared.contacts,
        tolerance=prepared.tolerance,
        command=job["command"],
        progress=progress,
    )


def _answer(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    data = _verdict(prepared, progress).to_dict()
    write_text(path, json.dumps(data, ensure_ascii=False, indent=1) + "\n")


def _proof(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    verdict = _verdict(prepared, progress)
    if verdict.evidence is None:
        raise InputError("this answer has no proof", hint="decide the open pairs first")
    write_text(path, json.dumps(verdict.proof(), ensure_ascii=False) + "\n")


def _choices(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    write_text(path, json_lines(Choices.from_dict(dict(job["keys"])).to_dict()))


def _contacts(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    head = ["part_a", "part_b", "kind", "area", "gap", "mu", "nx", "ny", "nz"]
    rows: list[list[Any]] = [
        [*p["parts"], p["kind"], p["area"], p["gap"], p["mu"], *p["normal"]]
        for p in prepared.contacts.to_dict()["patches"]
    ]
    write_text(path, csv_text([head, *rows]))


def _figure(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    publish.require_figure(path, None)
    publish.draw(_verdict(prepared, progress), path)


def _film(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    publish.animate(_verdict(prepared, progress), path)


def _plan(prepared: Prepared, path: Path, job: Mapping[str, Any], progress: Tell) -> None:
    order = plan(prepared.assembly, contacts=prepared.contacts, progress=progress)
    if not order.found:
        raise InputError(order.to_dict()["sentence"], hint="see the tab 'plan'")
    publish.report(order, path, title=job["title"], command=job["command"])


def _verdict(prepared: Prepared, progress: Tell) -> Any:
    return check(
        prepared.assembly,
        contacts=prepared.contacts,
        tolerance=prepared.tolerance,
        progress=progress,
    )


EXPORTS: dict[str, Callable[[Prepared, Path, Mapping[str, Any], Tell], None]] = {
    "report.html": _report,
    "answer.json": _answer,
    "proof.json": _proof,
    "choices.kilter.json": _choices,
    "contacts.csv": _contacts,
    "figure.svg": _figure,
    "film.glb": _film,
    "plan.html": _plan,
}
"""Function of each export, by the name of its file."""
