"""Open pairs on which a verdict hangs: the assembly falls as drawn, and holds if they are joined.

It names the smallest set of open pairs that decides (`kilter.analysis.open_pairs.deciding_pairs`),
and the verdict of the assembly with the parts of these joined.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kilter.analysis.open_pairs.deciding_pairs import DecidingPairs, find_deciding
from kilter.assembly import Assembly, Joint
from kilter.contact import ContactSet
from kilter.contact.open_pairs import OpenPair, rigid_groups, still_open
from kilter.errors import some
from kilter.mechanics.program import Program
from kilter.work import Work

__all__ = ["OpenQuestion", "ask_open", "open_pair_names", "open_pairs_answer"]


@dataclass(frozen=True, slots=True)
class OpenQuestion:
    """The open pairs that decide, and the verdict with them joined."""

    deciding: DecidingPairs
    verdict: str

    def to_dict(self, names: tuple[str, ...]) -> dict[str, Any]:
        """As JSON data: `if_joined` of the answer."""
        return {
            "pairs": [[names[k] for k in one.parts] for one in self.deciding.pairs],
            "verdict": self.verdict,
            "smallest": self.deciding.smallest,
        }


def ask_open(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    verdict_of: Callable[[Assembly], str],
    *,
    work: Work | None = None,
) -> OpenQuestion | None:
    """Which open pairs decide.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    program : Program
        Of the certain contacts, which do not hold it.
    verdict_of : callable
        From an assembly of the same parts and contacts to the word of its verdict.
    work : Work, optional
        Its time limit is kept.

    Returns
    -------
    OpenQuestion or None
        None if no joined open pairs give forces of equilibrium, or the numbers are so
        near the limit that it seems to take none.
    """
    pairs = still_open(contacts.open_pairs, assembly)
    found = find_deciding(program, rigid_groups(assembly), pairs, work=work)
    if found is None or not found.pairs:
        return None
    names = assembly.names
    joints = [Joint((names[p.parts[0]], names[p.parts[1]])) for p in found.pairs]
    return OpenQuestion(found, verdict_of(assembly.with_joints(joints)))


def open_pair_names(assembly: Assembly, contacts: ContactSet) -> str:
    """The open pairs by their parts, the first of them."""
    names = assembly.names
    pairs = still_open(contacts.open_pairs, assembly)
    return some([f"{names[one.parts[0]]!r} and {names[one.parts[1]]!r}" for one in pairs])


def open_pairs_answer(
    assembly: Assembly, contacts: ContactSet, question: OpenQuestion | None = None
) -> list[dict[str, Any]]:
    """`open_pairs` of an answer: those that decide first."""
    decides: tuple[OpenPair, ...] = () if question is None else question.deciding.pairs
    pairs = still_open(contacts.open_pairs, assembly)
    entries = [{**one.to_dict(assembly.names), "decides": one in decides} for one in pairs]
    return sorted(entries, key=lambda entry: not entry["decides"])
