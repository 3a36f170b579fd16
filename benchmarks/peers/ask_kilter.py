"""Adapter for kilter: the complete verdict, and equilibrium alone."""

from __future__ import annotations

from collections.abc import Callable

from question import Question

WORDS = {"stable": "holds", "settles": "holds", "unstable": "falls"}
"""Answers by verdict; every other verdict counts as open."""


def verdict(question: Question) -> Callable[[], tuple[str, str]]:
    """`kilter.check` with known contacts, including tries and neutral motions."""
    import kilter

    assembly, contacts = question.assembly, question.contacts

    def run() -> tuple[str, str]:
        found = kilter.check(assembly, contacts=contacts)
        return WORDS.get(found.verdict, "open"), found.verdict

    return run


def equilibrium(question: Question) -> Callable[[], tuple[str, str]]:
    """Existence of equilibrium forces, with a certificate for either answer."""
    from kilter.analysis.decision.judge import judge

    program = question.program

    def run() -> tuple[str, str]:
        found = judge(program)
        word = {True: "holds", False: "falls", None: "open"}[found.stable]
        return word, found.solvers[-1] if found.solvers else ""

    return run
