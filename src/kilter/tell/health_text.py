"""The answer of `kilter doctor` as text, for a terminal and for a bug report."""

from __future__ import annotations

from kilter.tell.shared_facts import Answer
from kilter.tell.text import aligned

__all__ = ["health_text"]


def health_text(answer: Answer) -> str:
    """Return the text of `kilter doctor`: a sentence, then each item with its state and its remedy.

    Examples
    --------
    >>> broken = {"name": "HiGHS", "state": "broken", "found": "no answer", "remedy": "try again"}
    >>> print(health_text({"works": False, "looks": [broken]}))
    kilter does not work here: HiGHS.
    <BLANKLINE>
    HiGHS  broken  no answer; try again
    """
    broken = [look["name"] for look in answer["looks"] if look["state"] == "broken"]
    head = "kilter works here."
    if broken:
        head = f"kilter does not work here: {', '.join(broken)}."
    rows = [
        (look["name"], look["state"], "; ".join(filter(None, (look["found"], look["remedy"]))))
        for look in answer["looks"]
    ]
    return "\n".join([head, "", *aligned(rows)])
