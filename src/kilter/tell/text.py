"""Answers as text for people."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.analysis.motion import MOVES
from kilter.assembly.geometry import DEFAULT_DENSITY
from kilter.errors import some
from kilter.tell.words import NAMED

if TYPE_CHECKING:
    from kilter.analysis.verdict import Verdict
    from kilter.assembly import Assembly
    from kilter.contact import ContactSet
    from kilter.contact.fits.suggestions import Suggestion

__all__ = [
    "check_text",
    "contacts_text",
    "force_lines",
    "joint_rows",
    "moving_lines",
    "plain",
    "suggestions_text",
    "table",
    "vector",
]

INTERFERENCE = "an interference fit: join it with --fasten"
LISTED = 20
"""Rows of a list that are shown; --json gives all."""


def plain(name: str, width: int = 40) -> str:
    """A name that cannot disturb a terminal: one line, no control characters.

    Examples
    --------
    >>> plain("a\\nb")
    'a?b'
    >>> plain("bracket-assembly_1/nut-bolt-assembly_2/nut", width=24)
    'bracket...assembly_2/nut'
    """
    shown = "".join(c if c.isprintable() else "?" for c in name)
    if len(shown) <= width:
        return shown
    # the end of a path tells more than its middle
    head = (width - 3) // 3
    return f"{shown[:head]}...{shown[head + 3 - width :]}"


def table(rows: list[list[str]], indent: str = "  ") -> list[str]:
    """Rows with their columns aligned to the left."""
    if not rows:
        return []
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return [
        (indent + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    ]


def _more(total: int) -> list[str]:
    return [f"  and {total - LISTED} more (--json lists all)"] if total > LISTED else []


def vector(v: Any, digits: int = 6) -> str:
    """A vector in brackets, rounded.

    Examples
    --------
    >>> vector([0.5, -0.0, 1])
    '(0.5, 0, 1)'
    """
    return "(" + ", ".join(f"{round(float(x), digits) + 0.0:g}" for x in v) + ")"


def check_text(verdict: Verdict) -> str:
    """The answer of `kilter check`."""
    lines = [verdict.sentence]
    if verdict.verdict == "unstable" and len(verdict.moving) > NAMED:
        lines.append(f"Fastest: {plain(verdict.summary, 400)}.")
    lines.append("")
    lines += moving_lines(verdict)
    lines += _facts(verdict)
    return "\n".join(lines)


def moving_lines(verdict: Verdict) -> list[str]:
    """The parts that move, the fastest first."""
    if verdict.verdict == "stable":
        return []
    speed = verdict.motion.relative.max(axis=1)
    which = np.flatnonzero(verdict.motion.moves)
    free = int(verdict.program.free.sum())
    if verdict.verdict == "potentially-stable" and verdict.guarantee != "refuted":
        return []
    left_out = bool(verdict.contacts.unsupported)
    if verdict.verdict == "undecided" or (left_out and len(which)):
        by = "modelled contacts" if left_out else "modelled, frictionless contacts"
        head = f"By its {by} alone, {len(which)} of {free} free parts move:"
    elif verdict.verdict == "potentially-stable":
        head = f"{len(which)} of {free} free parts could move:"
    elif len(which):
        head = f"{len(which)} of {free} free parts move:"
    else:
        head = f"No part starts faster than {MOVES:g} g; the fastest:"
        which = np.flatnonzero(speed > 0)
    order = which[np.argsort(-speed[which], kind="stable")]
    names = verdict.assembly.names
    rows = [[plain(names[k]), verdict.words(int(k), slow=True)] for k in order[:LISTED]]
    return [head, *table(rows), *_more(len(order)), ""]


def _facts(verdict: Verdict) -> list[str]:
    assembly, contacts = verdict.assembly, verdict.contacts
    held = [p.name for p in assembly.parts if p.grounded]
    shown = ", ".join(plain(n) for n in held[:5]) + (
        f" and {len(held) - 5} more" if len(held) > 5 else ""
    )
    down = verdict.assembly.down
    size = float(np.linalg.norm(assembly.gravity))
    rows = [
        ["parts", f"{len(assembly.parts)}, held: {shown or 'none (joints to the ground)'}"],
        ["units", f"{assembly.units}; {_density_words(assembly)}"],
        ["mass", f"{verdict.program.mass[verdict.program.free].sum():.6g} kg free"],
        ["gravity", f"{size:g} m/s^2 along {vector(down)}"],
        ["contacts", _touching(contacts)],
        *joint_rows(assembly),
        ["proof", _proof_words(verdict)],
    ]
    rows += _friction_rows(verdict)
    if verdict.verdict != "stable":
        z = f"z = {verdict.displacement.z:.6g} (LP (9): kg, {assembly.units}, gravity 1)"
        known = verdict.instability
        kappa = "" if known is None else f", kappa = {known:.6g} (0 stable, 1 free fall)"
        rows.append(["instability", z + kappa])
    neutral = verdict.neutral
    if neutral is not None:
        rows.append(["neutral", _neutral_words(neutral.two_sided, neutral.one_sided)])
    seconds = ", ".join(f"{key} {value:.2g}" for key, value in verdict.seconds.items())
    rows.append(["seconds", seconds])
    return table(rows, indent="")


def _friction_rows(verdict: Verdict) -> list[list[str]]:
    """What friction guarantees and how that is known, and the greatest contact force."""
    rows, answer = [], verdict.friction
    if answer is not None:
        words = {
            "proved": "proved: no other motion obeys Coulomb's law",
            "refuted": "refuted: another motion obeys Coulomb's law",
            "open": f"open after {answer.seconds:.2g} s (--budget SECONDS for a longer search)",
        }[answer.guarantee]
        exclusion, witness = answer.exclusion, answer.witness
        if exclusion is not None and exclusion.proved:
            words += f" ({exclusion.kind}, {exclusion.programs} programs)"
        if witness is not None:
            words += f" (to {witness.law.residual:.1e})"
        rows.append(["guarantee", words])
    if verdict.seated is not None:
        seated = "by its own weight" if verdict.seated else "no: its own weight does not hold it"
        rows.append(["seated", seated])
    forces = verdict.forces
    if forces is not None and len(forces.patch):
        rows.append(["forces", _force_words(verdict)])
    return rows


def _force_words(verdict: Verdict) -> str:
    """The greatest contact force, and where most of the friction is used."""
    forces, names = verdict.forces, verdict.assembly.names
    assert forces is not None
    size = np.linalg.norm(forces.resultant, axis=1)
    k = int(size.argmax())

    def pair(row: int) -> str:
        a, b = verdict.contacts.patch_parts[forces.patch[row]]
        return f"{plain(names[a])} on {plain(names[b])}"

    words = f"up to {size[k]:.4g} N, {pair(k)}"
    used = np.nan_to_num(forces.utilisation, nan=-1.0)
    if (used > 0).any():
        k = int(used.argmax())
        words += f"; friction used up to {100 * used[k]:.3g} %, {pair(k)}"
    return words + " (--forces lists them)"


def force_lines(verdict: Verdict) -> list[str]:
    """The contact forces of an equilibrium, the greatest first."""
    forces, names = verdict.forces, verdict.assembly.names
    if forces is None:
        return ["no contact forces: there is no equilibrium"]
    unit = verdict.assembly.units
    size = np.linalg.norm(forces.resultant, axis=1)
    rows = [["part", "on part", "force N", f"at {unit}", "friction used"]]
    for k in np.argsort(-size, kind="stable")[:LISTED]:
        a, b = verdict.contacts.patch_parts[forces.patch[k]]
        used = forces.utilisation[k]
        rows.append(
            [
                plain(names[a]),
                plain(names[b]),
                vector(forces.resultant[k], 4),
                vector(forces.center[k], 4) if np.isfinite(forces.center[k]).all() else "-",
                f"{100 * used:.3g} %" if np.isfinite(used) else "-",
            ]
        )
    which = "least sum of squares" if forces.least else "as the verdict's proof has them"
    head = f"Contact forces of equilibrium ({which}; one of many):"
    return ["", head, *table(rows), *_more(len(size))]


def joint_rows(assembly: Assembly) -> list[list[str]]:
    """The joints as rows of a table of facts, one a kind."""
    rows: list[list[str]] = []
    for kind in dict.fromkeys(joint.kind for joint in assembly.joints):
        pairs = [
            " - ".join(plain(name) for name in joint.parts)
            for joint in assembly.joints
            if joint.kind == kind
        ]
        rows.append(["" if rows else "joints", f"{len(pairs)} {kind}: {some(pairs)}"])
    return rows


def suggestions_text(suggestions: list[Suggestion]) -> str:
    """The list of `kilter check --suggest-joints`."""
    if not suggestions:
        return "No pair looks like a fastener: no shaft fills a hole."
    lines = [f"{_count(len(suggestions), 'pair')} may be fastened; nothing is joined by itself:"]
    for one in suggestions[:LISTED]:
        first, second = (plain(name) for name in one.parts)
        lines += [
            f"  {first} in {second}: {one.why}",
            f"    {one.option}",
            f"    {json.dumps(one.joint)}",
        ]
    return "\n".join([*lines, *_more(len(suggestions))])


def _density_words(assembly: Assembly) -> str:
    """What the masses of the free parts rest on."""
    free = [part for part in assembly.parts if not part.grounded and part.mass is None]
    given = sorted({part.density for part in free if part.density is not None})
    words = []
    if given:
        span = f"{given[0]:g}" if len(given) == 1 else f"{given[0]:g} to {given[-1]:g}"
        words.append(f"density {span} kg/m^3")
    if any(part.density is None for part in free):
        words.append(f"density {DEFAULT_DENSITY:g} kg/m^3 where none is given")
    return ", ".join(words) or "masses as given"


def _count(number: int, word: str) -> str:
    """A number of things.

    Examples
    --------
    >>> _count(1, "patch"), _count(2, "patch"), _count(2, "pair")
    ('1 patch', '2 patches', '2 pairs')
    """
    ending = "es" if word.endswith("ch") else "s"
    return f"{number} {word}{'' if number == 1 else ending}"


def _touching(contacts: ContactSet) -> str:
    counts = ((contacts.pairs, "pair"), (len(contacts), "patch"), (len(contacts.points), "point"))
    return ", ".join(_count(number, word) for number, word in counts)


def _proof_words(verdict: Verdict) -> str:
    forces, motion = verdict.judgement.forces, verdict.judgement.motion
    if verdict.verdict in ("stable", "potentially-stable") and forces is not None:
        return (
            f"contact forces that balance every part to {forces.residual:.1e} of its weight "
            f"(tolerance {verdict.tolerance:.0e}), recomputed apart from the solver"
        )
    if verdict.verdict == "unstable" and motion is not None:
        return (
            f"a motion that gains {motion.power:.4g} W at 1 m/s and violates contacts by "
            f"{abs(motion.violation):.0e}, recomputed apart from the solver"
        )
    return "none"


def _neutral_words(two_sided: int, one_sided: int) -> str:
    if two_sided + one_sided == 0:
        return "none: strictly held"
    return (
        f"{two_sided} two-sided, {one_sided} one-sided motions cost no energy to first order; "
        "only there does second order matter"
    )


def contacts_text(assembly: Assembly, contacts: ContactSet) -> str:
    """The answer of `kilter contacts`."""
    names, unit = assembly.names, assembly.units
    lines = [
        f"Parts touch in {_touching(contacts)}; gap up to {contacts.gap:.3g} {unit}, angle up to "
        f"{np.degrees(contacts.tolerance.angle):.3g} deg.",
    ]
    if contacts.tolerance.clearance is not None:
        lines.append(f"Clearances up to {contacts.tolerance.clearance:.3g} {unit} count as closed.")
    lines += [*table(joint_rows(assembly), indent=""), ""]
    lines += _patches(assembly, contacts)
    lines += ["", "gaps of opposing faces, over the size of the smaller part (no unit):"]
    lines += _histogram(assembly, contacts)
    if contacts.unsupported:
        lines += [
            "",
            f"touching in a way not modelled yet: {_count(len(contacts.unsupported), 'pair')}",
        ]
        rows = [
            [plain(names[u.parts[0]]), plain(names[u.parts[1]]), u.kind, f"at {vector(u.point)}"]
            for u in contacts.unsupported[:LISTED]
        ]
        lines += [*table(rows), *_more(len(contacts.unsupported))]
    if contacts.rejected:
        lines += ["", f"near, but not touching: {_count(len(contacts.rejected), 'pair')} of faces"]
        rows = [
            [
                plain(names[r.parts[0]]),
                plain(names[r.parts[1]]),
                f"gap {r.gap:.3g} {unit}",
                f"angle {np.degrees(r.angle):.3g} deg",
                r.why,
            ]
            for r in contacts.rejected[:LISTED]
        ]
        lines += [*table(rows), *_more(len(contacts.rejected))]
    if contacts.overlaps:
        lines += ["", f"overlapping: {_count(len(contacts.overlaps), 'pair')}"]
        rows = [
            [
                plain(names[o.parts[0]]),
                plain(names[o.parts[1]]),
                f"depth {o.depth:.3g} {unit}",
                "" if o.volume is None else f"volume {o.volume:.3g} {unit}^3",
                INTERFERENCE if o.why == "interfere" else o.why,
            ]
            for o in contacts.overlaps[:LISTED]
        ]
        lines += [*table(rows), *_more(len(contacts.overlaps))]
    return "\n".join(lines)


def _patches(assembly: Assembly, contacts: ContactSet) -> list[str]:
    names, unit = assembly.names, assembly.units
    rows = [
        ["part a", "part b", "kind", f"area [{unit}^2]", f"gap [{unit}]", "normal a to b", "points"]
    ]
    counts = np.diff(contacts.patch_start)
    for k in range(min(len(contacts), LISTED)):
        a, b = contacts.patch_parts[k]
        gap = contacts.patch_gap[k, np.abs(contacts.patch_gap[k]).argmax()]
        rows.append(
            [
                plain(names[a]),
                plain(names[b]),
                str(contacts.patch_kind[k]),
                f"{contacts.patch_area[k]:.6g}",
                f"{gap:.1e}",
                vector(contacts.patch_normal[k], 4),
                str(counts[k]),
            ]
        )
    return [*table(rows), *_more(len(contacts))] if len(rows) > 1 else []


def _histogram(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """One bar a decade of gaps that has any, and between which the tolerance lies."""
    rows = []
    unit, sizes = assembly.units, assembly.geometry.size
    largest = max(int(contacts.gap_counts.max(initial=0)), 1)
    for low, high, count in zip(
        contacts.gap_edges[:-1], contacts.gap_edges[1:], contacts.gap_counts, strict=True
    ):
        if count:
            bar = "#" * max(1, round(30 * int(count) / largest))
            rows.append([f"{low:8.0e} to {high:8.0e}", str(count), bar])
    if not rows:
        return ["  none"]
    least, most = float(sizes.min()), float(sizes.max())
    span = f"{least:.3g}" if least == most else f"{least:.3g} to {most:.3g}"
    rows = [["gap / size", "faces", ""], *rows]
    return [*table(rows), f"  sizes of the parts: {span} {unit}; negative gaps penetrate"]
