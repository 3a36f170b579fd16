"""The answer of `kilter verify` as a sentence."""

from __future__ import annotations

from kilter.tell.check_facts import Answer
from kilter.tell.levels import level_rank


def verify_sentence(answer: Answer) -> str:
    """Return the result of a verification: the recomputed level, and the claimed level.

    Examples
    --------
    >>> verify_sentence({"reasons": [], "holds": False, "verdict": "settles",
    ...                  "level": "equilibrium", "claimed": "settles", "require": None})
    'Equilibrium is proved; settles is claimed by the file.'
    """
    if answer["reasons"]:
        return "The proof does not hold."
    level, claimed, require = answer["level"], answer["claimed"], answer["require"]
    if level_rank(level) < level_rank(claimed):
        return f"{str(level).capitalize()} is proved; {claimed} is claimed by the file."
    if answer["holds"]:
        return f"The proof holds: {answer['verdict']}."
    if level is None:
        return f"The proof holds: {answer['verdict']}, so no level is reached."
    return f"The proof holds: {answer['verdict']}. Its level is {level}; {require} is required."
