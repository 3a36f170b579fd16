"""Write a plan as a page, a film, a figure or a table, by the suffix of the output file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from kilter.cli.output import tell_warnings, tell_written, write_whole

if TYPE_CHECKING:
    from kilter.analysis.planning.order.order import Order
    from kilter.cli.asked import Asked

__all__ = ["as_typed", "written"]


def written(order: Order, answer: Mapping[str, Any], asked: Asked, typed: list[str]) -> bool:
    """Write a plan in the format of the output suffix; False if the suffix is no plan format.

    With any other suffix nothing is written: the caller writes text or JSON.

    Parameters
    ----------
    order : Order
    answer : dict
        Data of the plan, with the warnings of the command.
    asked : Asked
        Request with an output file.
    typed : list of str
        Options of the plan, for the command that a page shows.
    """
    from kilter import publish
    from kilter.show.canvas import SUFFIXES

    assert asked.output is not None
    ending = asked.output.suffix.lower()
    if ending == ".csv":
        write_whole(asked.output, order.table())
    elif ending in publish.PAGES:
        publish.report(
            order,
            asked.output,
            title=publish.title_of(asked.file),
            command=asked.command("plan", *typed, "-o", str(asked.output)),
        )
    elif ending in (*publish.FILMS, *SUFFIXES):
        if not order.found or not order.steps:
            replace(asked, output=None).tell(answer)
            return _report(asked, "not written, because the plan has no steps")
        if ending in publish.FILMS:
            publish.animate(order, asked.output)
        else:
            publish.draw(order, asked.output)
    else:
        return False
    tell_warnings(answer["warnings"], asked.quiet)
    return _report(asked, answer["sentence"])


def _report(asked: Asked, words: str) -> bool:
    """Print a line about the output file on the error stream; always returns True."""
    tell_written(asked.output, words, asked.quiet)
    return True


def as_typed(options: Any, *names: str) -> list[str]:
    """Words of a command line for a record of options, or for some of them, without defaults."""
    words: list[str] = []
    for entry in fields(options):
        value = getattr(options, entry.name)
        if (names and entry.name not in names) or value == entry.default:
            continue
        name = entry.metadata["option"].names[-1]
        if value is True:
            words.append(name)
            continue
        for each in value if isinstance(value, list) else [value]:
            values = each if isinstance(each, tuple) else (each,)
            words += [name, *(f"{v:.12g}" if isinstance(v, float) else str(v) for v in values)]
    return words
