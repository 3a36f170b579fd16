"""The question that leaves an assembly undecided: open pairs on which its verdict depends.

The certain contacts do not hold such an assembly, but forces of open pairs may. The question names
the smallest set of open pairs that decides (`kilter.analysis.decision.deciding_pairs`), and the
verdict of the assembly with the parts of these pairs joined.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kilter.assembly import Assembly, Joint
from kilter.contact import ContactSet
from kilter.contact.open_pairs import OpenPair, rigid_groups, still_open
from kilter.errors import some
from kilter.mechanics.program import Program
from kilter.work import Work

if TYPE_CHECKING:
    from kilter.analysis.decision.deciding_pairs import DecidingPairs
    from kilter.tell.answer_data.check_data import JoinedData
    from kilter.tell.answer_data.common_data import OpenPairData

__all__ = ["OpenQuestion", "ask_open", "open_pair_names", "open_pairs_answer"]


@dataclass(frozen=True, slots=True)
class OpenQuestion:
    """The open pairs that decide, with verdict and level if the parts of these pairs are joined."""

    deciding: DecidingPairs
    verdict: str
    level: str | None

    def to_dict(self, names: tuple[str, ...]) -> JoinedData:
        """JSON data for the key `if_joined` of an answer; `names` are the names of all parts."""
        return {
            "pairs": [[names[k] for k in pair.ends] for pair in self.deciding.pairs],
            "verdict": self.verdict,
            "smallest": self.deciding.smallest,
            "irreducible": self.deciding.irreducible,
        }


def ask_open(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    decide: Callable[[Assembly], tuple[str, str | None]],
    *,
    work: Work | None = None,
) -> OpenQuestion | None:
    """Find the open pairs that decide, and the verdict if they are joined; None if none decide.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    program : Program
        Program of the certain contacts, which do not hold the assembly.
    decide : callable
        Function that returns verdict and level of an assembly with the same parts and contacts.
    work : Work, optional
        The time limit applies.

    Returns
    -------
    OpenQuestion or None
        None if no set of joined open pairs gives forces of equilibrium, or if the empty set seems
        to suffice because the program is near its limit.
    """
    # imported late: only open pairs need these modules
    from kilter.analysis.decision.deciding_pairs import find_deciding

    pairs = still_open(contacts.open_pairs, assembly)
    deciding = find_deciding(program, rigid_groups(assembly), pairs, work=work)
    if deciding is None or not deciding.pairs:
        return None
    names = assembly.names
    joints = [Joint((names[p.ends[0]], names[p.ends[1]])) for p in deciding.pairs]
    return OpenQuestion(deciding, *decide(assembly.with_joints(joints)))


def open_pair_names(assembly: Assembly, contacts: ContactSet) -> str:
    """The names of the parts of the first open pairs, as a phrase for messages."""
    names = assembly.names
    pairs = still_open(contacts.open_pairs, assembly)
    return some([f"{names[pair.ends[0]]!r} and {names[pair.ends[1]]!r}" for pair in pairs])


def open_pairs_answer(
    assembly: Assembly, contacts: ContactSet, question: OpenQuestion | None = None
) -> list[OpenPairData]:
    """Entries of the key `open_pairs` of an answer, the deciding pairs first."""
    decides: tuple[OpenPair, ...] = () if question is None else question.deciding.pairs
    pairs = still_open(contacts.open_pairs, assembly)
    entries: list[OpenPairData] = [
        {**pair.to_dict(assembly.names), "decides": pair in decides} for pair in pairs
    ]
    return sorted(entries, key=lambda entry: not entry["decides"])
