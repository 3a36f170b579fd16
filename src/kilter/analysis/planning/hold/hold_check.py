"""Verify a fixture file: that its supports hold the assembly, and that fewer are not enough.

That each state holds or falls is judged with its forces or its motion
(`kilter.analysis.verification`). Here: that each is one of the candidates it names; and that, by
the shares that the candidates take of each motion, found anew, no smaller set is enough.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kilter.analysis.planning.hold.supported import shares_of
from kilter.analysis.smallest_set import least_cover
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.supports import Support, with_supports
from kilter.mechanics.bundle import apply_change
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.program import build_program

__all__ = ["wrong_hold"]

About = Mapping[str, Any]


def wrong_hold(
    assembly: Assembly, contacts: ContactSet, bundle: About, verdicts: Sequence[str]
) -> Iterator[str]:
    """Yield the reasons why the proofs of a fixture do not show the fewest supports.

    Malformed data ends as in `kilter.analysis.planning.order.order_check`.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    bundle : mapping
        As `Fixture.proof` makes it.
    verdicts : sequence of str
        Of its proofs.
    """
    rules = bundle["rules"]
    candidates = [Support.from_dict(item) for item in rules["candidates"]]
    for item in candidates:
        item.require_of(assembly)
    held: list[tuple[frozenset[int], About]] = []
    falling: list[tuple[frozenset[int], About]] = []
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        present = frozenset(entry["supports"])
        if entry["change"] != _change(assembly, candidates, present):
            yield f"{entry['about']}: its supports differ from the candidates that it names"
            continue
        if entry["about"] not in FALLS or (verdict == "unstable") != FALLS[entry["about"]]:
            yield f"it states {entry['about']!r:.40}, but its proof gives the verdict {verdict}"
            continue
        if FALLS[entry["about"]] and not entry["proof"]["motion"].keys() <= set(assembly.names):
            yield f"{entry['about']}: its motion names a part that the assembly does not have"
            continue
        (falling if FALLS[entry["about"]] else held).append((present, entry))
    shares = [_shares(assembly, contacts, candidates, *item) for item in falling]
    least = len(candidates) + 1 if not held else rules["least"]
    if len(held) > 1 or (held and len(held[0][0]) < least):
        yield "it has no proof that the fewest supports hold it"
    if least_cover(shares, min(least - 1, len(candidates))) is not None:
        yield f"fewer than {least} supports may be enough"


FALLS = {"held": False, "not fewer": True}
"""Subjects of the proofs of a fixture, and whether the state of such a proof falls."""


def _change(
    assembly: Assembly, candidates: Sequence[Support], present: frozenset[int]
) -> dict[str, Any]:
    """Change of an assembly that adds a subset of the candidate supports, as data for its file."""
    chosen = [candidates[k] for k in sorted(present)]
    gripped = {support.part for support in chosen if support.kind == "grip"}
    return {
        "held": [name for name in assembly.names if name in gripped],
        "supports": [support.to_dict() for support in chosen if support.kind != "grip"],
    }


def _shares(
    assembly: Assembly,
    contacts: ContactSet,
    candidates: Sequence[Support],
    present: frozenset[int],
    entry: About,
) -> dict[int, float]:
    """Fraction of the work of a proved motion that each absent candidate support would take."""
    every = with_supports(
        assembly, contacts, [support for support in candidates if support.kind != "grip"]
    )
    program = build_program(*apply_change(assembly, contacts, entry["change"]), possible=True)
    motion = np.zeros((len(program.names), 6))
    number = {name: k for k, name in enumerate(program.names)}
    for name, six in entry["proof"]["motion"].items():
        motion[number[name]] = six
    proof = check_motion(program, motion)
    return shares_of(candidates, build_program(*every), len(contacts.patch_mu), proof, present)
