"""Facts that the running command knows so far, for the message of an interruption.

A signal may arrive in any stack frame, and a thread may have to end the process. The facts are
therefore kept in the process, as the names of unfinished files are (`kilter.files.writing`).
"""

from __future__ import annotations

from kilter.errors import visible

__all__ = ["begin_facts", "interruption_words", "known_words", "remember_fact", "remember_step"]

_FACTS: dict[str, str] = {}
_STEPS: list[str] = []


def begin_facts() -> None:
    """Forget the facts of an earlier question."""
    _FACTS.clear()
    _STEPS.clear()


def remember_fact(subject: str, words: str) -> None:
    """Keep a fact as a clause. Of several facts with the same subject, the first is kept."""
    _FACTS.setdefault(subject, words)


def remember_step(words: str) -> None:
    """Keep the name of the step that runs now."""
    _STEPS[:] = [words]


def interruption_words() -> str:
    """Sentence about an interruption, with the step that was running and the known facts.

    Examples
    --------
    >>> begin_facts()
    >>> interruption_words()
    'interrupted'
    >>> remember_step("near pairs")
    >>> remember_fact("parts", "it has 3 parts, 1 of them held")
    >>> interruption_words()
    'interrupted in the step "near pairs"; known so far: it has 3 parts, 1 of them held'
    >>> begin_facts()
    """
    step = "".join(f' in the step "{words}"' for words in _STEPS)
    known = known_words()
    return visible(f"interrupted{step}{'; ' if known else ''}{known}")


def known_words() -> str:
    """Clause about the known facts; empty without facts."""
    return f"known so far: {', '.join(_FACTS.values())}" if _FACTS else ""
