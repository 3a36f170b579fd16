"""The question that leaves an assembly undecided: open pairs on which its verdict depends.

The certain contacts do not hold such an assembly, but forces of open pairs may. The question names
the smallest set of open pairs that decides (`kilter.analysis.decision.deciding_pairs`), and the
verdict of the assembly with the parts of these pairs joined.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from kilter.assembly import Assembly, Joint
from kilter.contact import ContactSet
from kilter.contact.open_pairs import OpenPair, rigid_groups, still_open
from kilter.errors import some
from kilter.mechanics.program import Program
from kilter.tell.record import InPython, Record, Word, key
from kilter.work import Work

if TYPE_CHECKING:
    from kilter.analysis.decision.deciding_pairs import DecidingPairs


class OpenQuestion(Record, kw_only=False):
    """The open pairs that decide, and the verdict if the parts of these pairs are joined."""

    deciding: InPython[DecidingPairs]
    """The pairs that decide."""
    verdict: Word
    """The verdict with these pairs joined."""
    level: InPython[str | None]
    """The level with these pairs joined."""

    @property
    @key
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Names of the parts of each pair."""
        return tuple(pair.parts for pair in self.deciding.pairs)

    @property
    @key
    def smallest(self) -> bool:
        """Whether no smaller set of pairs decides."""
        return self.deciding.smallest

    @property
    @key
    def irreducible(self) -> bool:
        """Whether no pair can be left out."""
        return self.deciding.irreducible


class AnsweredPair(OpenPair):
    """An open pair, and whether it decides the verdict."""

    decides: bool
    """Whether the pair decides the verdict."""


def ask_open(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    decide: Callable[[Assembly], tuple[str, str | None]],
    *,
    work: Work | None = None,
) -> OpenQuestion | None:
    """Find the open pairs that decide, and the verdict if they are joined; None if none decide.

    Arguments: `decide`: function that returns verdict and level of an assembly with the same parts
    and contacts. Returns None if no set of joined open pairs gives forces of equilibrium, or if the
    empty set seems to suffice because the program is near its limit.
    """
    # imported late: only open pairs need these modules
    from kilter.analysis.decision.deciding_pairs import find_deciding

    pairs = still_open(contacts.open_pairs, assembly)
    deciding = find_deciding(program, rigid_groups(assembly), pairs, work=work)
    if deciding is None or not deciding.pairs:
        return None
    joints = [Joint(pair.parts) for pair in deciding.pairs]
    return OpenQuestion(deciding, *decide(assembly.with_joints(joints)))


def open_pair_names(assembly: Assembly, contacts: ContactSet) -> str:
    """The names of the parts of the first open pairs, as a phrase for messages."""
    pairs = still_open(contacts.open_pairs, assembly)
    return some(["{!r} and {!r}".format(*pair.parts) for pair in pairs])


def answered_pairs(
    assembly: Assembly, contacts: ContactSet, question: OpenQuestion | None = None
) -> tuple[AnsweredPair, ...]:
    """Entries of the key `open_pairs` of an answer, the deciding pairs first."""
    decide = {pair.ends for pair in question.deciding.pairs} if question is not None else set()
    entries = [
        AnsweredPair(**vars(pair), decides=pair.ends in decide)
        for pair in still_open(contacts.open_pairs, assembly)
    ]
    return tuple(sorted(entries, key=lambda entry: not entry.decides))
