"""Open pairs in words: what was left open, what decides, and the option that settles it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from kilter.errors import shell_words, some
from kilter.tell.numbers import number
from kilter.tell.words import VERDICTS

__all__ = ["open_facts", "pair_words", "settling_options", "undecided_sentence"]

Pair = Mapping[str, Any]
FEW = 4
"""Up to so many pairs are fastened one by one; more of one kind by one option."""
TILT = "tilted"
"""In the reason of a pair whose faces lie at an angle: a gap closes none."""
ABOVE = 1.01
"""By so much an option is wider than the gap that it has to close."""


def pair_words(pair: Pair, units: str) -> str:
    """A pair, and what is open about it.

    Examples
    --------
    >>> pair = {"parts": ["a", "b"], "kind": "near", "gap": 0.25, "depth": None, "why": ""}
    >>> pair_words(pair, "mm")
    "'a' and 'b' (0.25 mm apart)"
    """
    a, b = pair["parts"]
    return f"{a!r} and {b!r} ({_state(pair, units)})"


def _state(pair: Pair, units: str) -> str:
    kind, gap, depth = pair["kind"], pair["gap"], pair["depth"]
    if kind == "overlap":
        return "they overlap" if depth is None else f"they overlap by {number(depth, 3)} {units}"
    if kind == "clearance":
        return f"{number(gap, 3)} {units} of clearance"
    if kind == "near":
        if not gap or TILT in pair["why"]:
            return str(pair["why"])
        word = "apart" if gap > 0 else "into each other"
        return f"{number(abs(gap), 3)} {units} {word}"
    if kind == "free-form":
        return "a curved contact of a kind that is not modelled yet"
    return "edges or corners alone touch"


def undecided_sentence(open_pairs: Sequence[Pair], units: str, *, more: Sequence[str] = ()) -> str:
    """What an assembly hangs on that nothing holds as it is drawn; `more` is said beside.

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


def settling_options(open_pairs: Sequence[Pair]) -> list[str]:
    """Options that say of the deciding pairs that they hold, one after the other.

    Examples
    --------
    >>> settling_options([{"parts": ["a", "b c"], "kind": "overlap", "gap": None, "decides": True}])
    ['--fasten a "b c"']
    >>> settling_options(
    ...     [{"parts": ["a", "b"], "kind": "near", "gap": 0.2, "why": "", "decides": True}]
    ... )
    ['--gap 0.202']
    """
    decides = [pair for pair in open_pairs if pair["decides"]]
    found: list[str] = []
    for kind in dict.fromkeys(pair["kind"] for pair in decides):
        mine = [pair for pair in decides if pair["kind"] == kind]
        if kind == "clearance":
            found.append(f"--clearance {_above(mine)}")
        elif kind == "near":
            loose = any(not pair["gap"] or TILT in pair["why"] for pair in mine)
            found.append("--loose" if loose else f"--gap {_above(mine)}")
        elif kind == "overlap" and len(mine) > FEW:
            found.append("--fasten-overlaps")
        else:
            found += [f"--fasten {shell_words(pair['parts'])}" for pair in mine]
    return found


def _above(pairs: Sequence[Pair]) -> str:
    """A length a little above the widest gap, of three digits."""
    widest = ABOVE * max(abs(pair["gap"]) for pair in pairs)
    step = 10.0 ** (math.floor(math.log10(widest)) - 2)
    return f"{math.ceil(widest / step - 1e-9) * step:.3g}"


def open_facts(answer: Mapping[str, Any]) -> list[tuple[str, str]]:
    """How many pairs are open, by kind, and of an undecided verdict what settles it.

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
    found = [("open pairs", f"{len(kinds)}: {counted}")]
    if joined is not None:
        least = (
            "no fewer open pairs do it" if joined["smallest"] else "none of them can be left out"
        )
        found.append(("if joined", f"{VERDICTS[joined['verdict']].lower()}; {least}"))
        found.append(("to settle it", " ".join(settling_options(pairs))))
    return found
