"""kilter: the whole verdict, and the question of equilibrium alone."""

from __future__ import annotations

from collections.abc import Callable

from question import Question

WORDS = {"stable": "holds", "settles": "holds", "unstable": "falls"}
"""What else `check` says leaves the question open."""


def verdict(question: Question) -> Callable[[], tuple[str, str]]:
    """`kilter.check` with the contacts found before: with tries and neutral motions."""
    import kilter

    assembly, contacts = question.assembly, question.contacts

    def run() -> tuple[str, str]:
        found = kilter.check(assembly, contacts=contacts)
        return WORDS.get(found.verdict, "open"), found.verdict

    return run


def equilibrium(question: Question) -> Callable[[], tuple[str, str]]:
    """Are there contact forces that balance: with a certificate either way."""
    from kilter.analysis.decision.judge import judge

    program = question.program

    def run() -> tuple[str, str]:
        found = judge(program)
        word = {True: "holds", False: "falls", None: "open"}[found.stable]
        return word, found.solvers[-1] if found.solvers else ""

    return run
