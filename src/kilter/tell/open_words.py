"""Open pairs in words: their state, the deciding pairs, and the options that decide them.

An open pair is a pair of parts whose geometry does not determine how they touch.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from kilter.errors import shell_words, some
from kilter.tell.numbers import number
from kilter.tell.words import VERDICTS

Pair = Mapping[str, Any]
FEW = 4
"""Up to this number of overlapping pairs, each pair gets an option of its own."""
TILT = "tilted"
"""Word in the reason of a pair whose faces are not parallel; no gap tolerance closes it."""
REMEDY_RESULTS = {
    "potentially-stable": "forces that hold it exist",
    None: "forces that hold it exist; the work limit was reached before more was decided",
}
"""Result of a remedy in words, if it is not the verdict word itself."""
ABOVE = 1.01
"""Ratio of a suggested tolerance to the gap that it must close [-]."""


def pair_words(pair: Pair, units: str) -> str:
    """Return a phrase about two parts whose contact is undecided, and how they lie.

    Examples
    --------
    >>> pair = {"parts": ["a", "b"], "kind": "near", "gap": 0.25, "depth": None, "why": ""}
    >>> pair_words(pair, "mm")
    "'a' and 'b' (0.25 mm apart)"
    """
    a, b = pair["parts"]
    return f"{a!r} and {b!r} ({lie_words(pair, units)})"


def lie_words(pair: Pair, units: str) -> str:
    """Return how the two parts of an open (undecided) pair lie: near, overlapping and so on."""
    kind, gap, depth = pair["kind"], pair["gap"], pair["depth"]
    if kind == "overlap":
        return "they overlap" if depth is None else f"they overlap by {number(depth, 3)} {units}"
    if kind == "clearance":
        return f"{number(gap, 3)} {units} of clearance"
    if kind == "near":
        if not gap or TILT in pair["why"]:
            return str(pair["why"])
        word = "apart" if gap > 0 else "deep in each other"
        return f"{number(abs(gap), 3)} {units} {word}"
    if kind == "unexamined":
        return "their contacts were not examined: the time limit was reached"
    if kind == "free-form":
        return "a curved contact of a kind that is not modelled yet"
    return "only edges or corners touch"


def undecided_sentence(open_pairs: Sequence[Pair], units: str, *, more: Sequence[str] = ()) -> str:
    """Return the sentence of an assembly whose verdict depends on undecided contacts.

    It falls as drawn, but holds if its open pairs are joined.

    Parameters
    ----------
    open_pairs : sequence of mapping
        Open pairs of the answer; the sentence names those that decide.
    units : str
        Length unit.
    more : sequence of str
        Further reasons.

    Examples
    --------
    >>> pair = {"parts": ["a", "b"], "kind": "overlap", "gap": None, "depth": 2.0}
    >>> undecided_sentence([{**pair, "decides": True}], "mm")
    "Undecided: as drawn it falls; it would hold if 'a' and 'b' (they overlap by 2 mm) were \
joined."
    """
    words = [pair_words(pair, units) for pair in open_pairs if pair["decides"]]
    if len(words) > 1:
        hold = f"it would hold if these {len(words)} pairs were joined: {some(words)}"
    else:
        hold = f"it would hold if {some(words)} were joined"
    return f"Undecided: {'; '.join(['as drawn it falls', hold, *more])}."


@dataclass(frozen=True, slots=True)
class OpenOption:
    """A command-line option that joins undecided pairs or makes them touch, and its values."""

    text: str
    fasten: tuple[tuple[str, str], ...] = ()
    overlaps: bool = False
    loose: bool = False
    gap: float | None = None
    clearance: float | None = None


def settling_options(open_pairs: Sequence[Pair]) -> list[str]:
    """Return the options that join, or bring into contact, the undecided pairs that matter.

    Examples
    --------
    >>> settling_options([{"parts": ["a", "b c"], "kind": "overlap", "gap": None, "decides": True}])
    ['--fasten a "b c"']
    >>> settling_options(
    ...     [{"parts": ["a", "b"], "kind": "near", "gap": 0.2, "why": "", "decides": True}]
    ... )
    ['--gap 0.202']
    """
    return [option.text for option in open_options(open_pairs)]


def open_options(open_pairs: Sequence[Pair]) -> list[OpenOption]:
    """Options by which the user states that the deciding undecided pairs hold together."""
    decides = [pair for pair in open_pairs if pair["decides"]]
    options: list[OpenOption] = []
    for kind in dict.fromkeys(pair["kind"] for pair in decides):
        alike = [pair for pair in decides if pair["kind"] == kind]
        if kind == "clearance":
            above = _widest_gap(alike)
            options.append(OpenOption(f"--clearance {above:.6g}", clearance=above))
        elif kind == "near":
            loose = any(not pair["gap"] or TILT in pair["why"] for pair in alike)
            if loose:
                options.append(OpenOption("--loose", loose=True))
            else:
                above = _widest_gap(alike)
                options.append(OpenOption(f"--gap {above:.6g}", gap=above))
        elif kind == "overlap" and len(alike) > FEW:
            options.append(OpenOption("--fasten-overlaps", overlaps=True))
        elif kind != "unexamined":  # no option of the assembly decides what a longer search finds
            options += [
                OpenOption(f"--fasten {shell_words(pair['parts'])}", fasten=(tuple(pair["parts"]),))
                for pair in alike
            ]
    return options


def _widest_gap(pairs: Sequence[Pair]) -> float:
    """Return a gap tolerance of three digits, just above the widest gap of the pairs."""
    return rounded_up(max(abs(pair["gap"]) for pair in pairs))


def rounded_up(gap: float) -> float:
    """Return a tolerance of three digits just above a gap.

    Examples
    --------
    >>> rounded_up(0.2), rounded_up(0.0123456)
    (0.202, 0.0125)
    """
    above = ABOVE * gap
    step = 10.0 ** (math.floor(math.log10(above)) - 2)
    return float(f"{math.ceil(above / step - 1e-9) * step:.3g}")


def remedy_words(option: str, leads_to: str | None, moved: float | None, units: str) -> str:
    """Return an option that was tried, with its result, in words.

    Examples
    --------
    >>> remedy_words("--loose", "stable", None, "mm")
    '--loose: stable'
    >>> remedy_words("--settle", "stable", 0.41, "mm")
    'kilter settle FILE --nearest: at rest after moving 0.41 mm, then stable'
    """
    result = REMEDY_RESULTS.get(leads_to, leads_to)
    if moved is None:
        return f"{option}: {result}"
    far = f"{number(moved, 3)} {units}"
    return f"kilter settle FILE --nearest: at rest after moving {far}, then {result}"


def remedy_facts(answer: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the lines about options that kilter tried as remedies, each with its result.

    Examples
    --------
    >>> remedy_facts({"remedies": [{"words": "--loose: stable"}]})
    [('with', '--loose: stable')]
    """
    rows = [remedy["words"] for remedy in answer.get("remedies", ())]
    return [("" if row else "with", words) for row, words in enumerate(rows)]


def open_facts(answer: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the lines about undecided pairs: their number by kind, and options that decide them.

    Examples
    --------
    >>> pairs = [{"kind": "near"}, {"kind": "overlap"}, {"kind": "near"}]
    >>> open_facts({"open_pairs": pairs, "if_joined": None})
    [('open pairs', '3: 2 near, 1 overlap')]
    """
    pairs, joined = answer["open_pairs"], answer["if_joined"]
    if not pairs:
        return []
    kinds = [pair["kind"] for pair in pairs]
    counted = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    facts = [("open pairs", f"{len(kinds)}: {counted}")]
    if joined is not None:
        least = "a smallest set was not searched for"
        if joined["smallest"]:
            least = "no smaller set of open pairs is enough"
        elif joined["irreducible"]:
            least = "all these pairs are needed, but joining other pairs may be enough, too"
        facts.append(("if joined", f"{VERDICTS[joined['verdict']].lower()}; {least}"))
    return facts
