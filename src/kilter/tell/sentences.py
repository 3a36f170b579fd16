"""The verdict in one sentence."""

from __future__ import annotations

__all__ = ["verdict_sentence"]

SENTENCES = {
    ("stable", None): "Stable{within}: it cannot start to move, however slippery the parts.",
    ("stable", "proved"): (
        "Stable{within}: with this friction no motion can start, whatever the contact forces "
        "were before."
    ),
    ("potentially-stable", "refuted seated"): (
        "Potentially stable{within}: its own weight can make the friction that holds it, but "
        "released loose it could also move like this."
    ),
    ("potentially-stable", "refuted"): (
        "Potentially stable{within}, held only by squeeze: it stays only if something other than "
        "its weight presses the parts together; else it moves like this."
    ),
    ("potentially-stable", "open seated"): (
        "Potentially stable{within}: forces that hold it exist and its weight makes them; no "
        "motion was found; not proved."
    ),
    ("potentially-stable", "open"): (
        "Potentially stable{within}: forces that hold it exist; neither seated nor a motion found."
    ),
    ("unstable", None): (
        "Unstable{beyond}: no contact forces can hold it; here is how it starts to move."
    ),
}
"""Sentence of a verdict and of what friction guarantees."""


def verdict_sentence(verdict: str, *, guarantee: str | None, seated: bool, coarse: bool) -> str:
    """The sentence of a verdict that is not undecided.

    Parameters
    ----------
    verdict : {"stable", "potentially-stable", "unstable"}
    guarantee : str, optional
        What friction guarantees, where the verdict rests on it.
    seated : bool
    coarse : bool
        The data are coarser than float64.

    Examples
    --------
    >>> verdict_sentence("stable", guarantee=None, seated=False, coarse=False)
    'Stable: it cannot start to move, however slippery the parts.'
    """
    key = None
    if verdict == "stable":
        key = guarantee
    elif verdict == "potentially-stable":
        key = f"{guarantee} seated" if seated else guarantee
    return SENTENCES[verdict, key].format(
        within=" within the accuracy of the data" if coarse else "",
        beyond=" beyond the accuracy of the data" if coarse else "",
    )
