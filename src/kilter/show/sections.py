"""The text of a page: verdict and proof in words, parts, contacts, warnings, gaps, how made.

Every word from a file goes through `text` or `named`: it is shown, and never read as HTML.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from kilter.show.answers import Answers
from kilter.show.packing import readable

__all__ = ["LISTED", "named", "sections", "text"]

LISTED = 1000
"""Rows of a table; what is left out is counted, and `--json` gives all."""
WORDS = {
    "stable": "Stable",
    "potentially-stable": "Potentially stable",
    "unstable": "Unstable",
    "undecided": "Undecided",
}


def text(value: object) -> str:
    """Any text as HTML.

    Examples
    --------
    >>> text('<b>"&')
    '&lt;b&gt;&quot;&amp;'
    """
    return html.escape(readable(str(value)), quote=True)


def named(name: str) -> str:
    """A name as HTML: apart from the direction of the text around it."""
    return f'<bdi class="name">{text(name)}</bdi>'


def sections(answers: Answers) -> str:
    """The sections below the picture."""
    return "\n".join(
        [
            _verdict(answers),
            _parts(answers),
            _contacts(answers),
            _warnings(answers),
            _gaps(answers),
            _made(answers),
        ]
    )


def _section(title: str, *body: str, open_: bool = True) -> str:
    state = " open" if open_ else ""
    return (
        f"<details{state}><summary><h2>{text(title)}</h2></summary>\n"
        + "\n".join(body)
        + ("\n</details>")
    )


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], *, of: int = 0) -> str:
    """A table; cells are HTML, `of`: how many rows there would be."""
    listed = list(rows)
    lines = ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in listed]
    more = of - len(listed)
    note = f"<p>and {more} more; the command with --json lists all.</p>" if more > 0 else ""
    top = "<tr>" + "".join(f'<th scope="col">{text(cell)}</th>' for cell in head) + "</tr>"
    return (
        f'<div class="wide"><table><thead>{top}</thead><tbody>'
        + "\n".join(lines)
        + f"</tbody></table></div>{note}"
    )


def _facts(rows: Iterable[tuple[str, str]]) -> str:
    """Terms and what they are; the values are HTML."""
    return "<dl>" + "".join(f"<dt>{text(k)}</dt><dd>{v}</dd>" for k, v in rows) + "</dl>"


def _number(value: float, digits: int = 4) -> str:
    return f"{float(value) + 0.0:.{digits}g}"


def _vector(values: Iterable[float], digits: int = 6) -> str:
    return "(" + ", ".join(f"{round(float(v), digits) + 0.0:g}" for v in values) + ")"


def _verdict(answers: Answers) -> str:
    check, contacts = answers.given.check, answers.contacts
    assembly = answers.assembly
    size = float(np.linalg.norm(assembly.gravity))
    rows = [
        ("verdict", f"<strong>{text(WORDS.get(check['verdict'], check['verdict']))}</strong>"),
        ("in words", text(check["sentence"])),
        ("gravity", f"{_number(size)} m/s² along {_vector(assembly.down)}"),
        ("proof", _proof(answers)),
    ]
    if check.get("guarantee"):
        rows.append(("guarantee", text(_GUARANTEE.get(check["guarantee"], check["guarantee"]))))
    if check.get("seated") is not None:
        seated = "yes: its own weight seats it" if check["seated"] else "no: only squeeze holds it"
        rows.append(("seated", seated))
    if check.get("instability") is not None:
        rows.append(
            ("instability", f"κ = {_number(check['instability'], 6)} (0 stable, 1 free fall)")
        )
    if check.get("z") is not None:
        z = f"z = {_number(check['z'], 6)} (LP (9): kg, {assembly.units}, gravity of length 1)"
        rows.append(("optimum", z))
    neutral = check.get("neutral")
    if neutral is not None:
        count = f"{neutral['two_sided']} two-sided, {neutral['one_sided']} one-sided"
        rows.append(("neutral motions", f"{count}: they cost no energy to first order"))
    rows.append(
        (
            "contacts",
            f"{contacts.pairs} pairs, {len(contacts)} patches, {len(contacts.points)} points",
        )
    )
    rows += _turned(answers)
    return _section("Verdict and proof", _facts(rows))


_GUARANTEE = {
    "proved": "proved: no other motion obeys the contact law",
    "refuted": "refuted: a motion that obeys the contact law exists",
    "open": "open: neither proved nor refuted",
}


def _proof(answers: Answers) -> str:
    """What proves the verdict."""
    certificate = answers.given.check.get("certificate") or {}
    verdict, kind = answers.given.check["verdict"], certificate.get("kind")
    if kind == "forces" and certificate.get("residual") is not None:
        return (
            "contact forces that balance every part to "
            f"{certificate['residual']:.1e} of its weight, recomputed apart from the solver"
        )
    if kind == "motion" and certificate.get("power") is not None:
        return (
            f"a motion that gains {_number(certificate['power'])} W where the fastest part moves "
            "at 1 m/s, and violates no contact, recomputed apart from the solver"
        )
    return "none" if verdict == "undecided" else "see the command's --proof"


def _turned(answers: Answers) -> list[tuple[str, str]]:
    """What is known about other directions of gravity."""
    rows = []
    if answers.region is not None:
        region = answers.region
        half = region["half_angle_deg"]
        width = "" if half is None else f", half angle {_number(half, 6)}°"
        exact = (
            ""
            if region["exact"] or answers.none
            else "; an inner one: further forces may make it larger"
        )
        rows.append(("stable directions", f"{text(region['kind'])}{width}{exact}"))
    if answers.recommended is not None:
        one = answers.recommended
        rows.append(("recommended", f"gravity along {_vector(one.down)}: {text(one.sentence)}"))
    rows += [("note", text(note)) for note in answers.notes]
    return rows


def _parts(answers: Answers) -> str:
    geometry, units = answers.assembly.geometry, answers.assembly.units
    told = answers.given.check["parts"]
    grounded = geometry.grounded
    moves = np.array([part["moves"] for part in told], dtype=bool)
    # what moves first, then as in the file
    order = np.argsort(~moves, kind="stable")[:LISTED] if len(told) else np.arange(0)
    rows = [
        (
            f'<button class="link" data-part="{k}">{named(told[k]["name"])}</button>',
            "held" if grounded[k] else "moves" if moves[k] else "stays",
            "" if grounded[k] else text(told[k]["motion"]),
            _number(geometry.mass[k], 6),
            _vector(geometry.center[k], 5),
        )
        for k in order.tolist()
    ]
    head = ["part", "state", "how it starts to move", "mass [kg]", f"centre [{units}]"]
    title = f"Parts ({len(told)})"
    return _section(title, _table(head, rows, of=len(told)), open_=len(told) <= 60)


def _contacts(answers: Answers) -> str:
    contacts, names, units = answers.contacts, answers.assembly.names, answers.assembly.units
    counts = np.diff(contacts.patch_start)
    shown = min(len(contacts), LISTED)
    rows = [
        (
            named(names[contacts.patch_parts[k, 0]]),
            named(names[contacts.patch_parts[k, 1]]),
            text(contacts.patch_kind[k]),
            _number(contacts.patch_area[k], 6),
            f"{contacts.patch_gap[k, np.abs(contacts.patch_gap[k]).argmax()] + 0.0:.1e}",
            _vector(contacts.patch_normal[k], 4),
            _number(contacts.patch_mu[k]),
            str(counts[k]),
        )
        for k in range(shown)
    ]
    head = ["first", "second", "kind", f"area [{units}²]", f"gap [{units}]"]
    head += ["normal, first to second", "friction", "points"]
    body = [_table(head, rows, of=len(contacts))]
    for title, entries in (
        ("Of a kind that is not modelled", _unsupported(answers)),
        ("Near, but not touching", _rejected(answers)),
        ("Overlapping", _overlaps(answers)),
    ):
        if entries:
            body.append(f"<h3>{title}</h3>")
            body.append(_table(["first", "second", "what"], entries[:LISTED], of=len(entries)))
    return _section(f"Contacts ({len(contacts)})", *body, open_=len(contacts) <= 60)


def _pair(answers: Answers, parts: Sequence[int], what: str) -> tuple[str, str, str]:
    names = answers.assembly.names
    return named(names[parts[0]]), named(names[parts[1]]), text(what)


def _unsupported(answers: Answers) -> list[tuple[str, str, str]]:
    return [
        _pair(answers, u.parts, f"{u.kind} at {_vector(u.point)}")
        for u in answers.contacts.unsupported
    ]


def _rejected(answers: Answers) -> list[tuple[str, str, str]]:
    units = answers.assembly.units
    return [
        _pair(
            answers,
            r.parts,
            f"gap {_number(r.gap)} {units}, angle {_number(np.degrees(r.angle))} deg: {r.why}",
        )
        for r in answers.contacts.rejected
    ]


def _overlaps(answers: Answers) -> list[tuple[str, str, str]]:
    units = answers.assembly.units
    return [
        _pair(
            answers,
            o.parts,
            f"depth {_number(o.depth)} {units}"
            + ("" if o.volume is None else f", volume {_number(o.volume)} {units}³"),
        )
        for o in answers.contacts.overlaps
    ]


def _warnings(answers: Answers) -> str:
    found = list(answers.given.check.get("warnings", []))
    if answers.region is not None:
        found += answers.region.get("warnings", [])
    listed = [f"<li>{text(warning)}</li>" for warning in dict.fromkeys(found)]
    body = f"<ul>{''.join(listed)}</ul>" if listed else "<p>None.</p>"
    return _section(f"Warnings ({len(listed)})", body)


def _gaps(answers: Answers) -> str:
    contacts = answers.contacts
    most = max(int(contacts.gap_counts.max(initial=0)), 1)
    rows = []
    bins = zip(contacts.gap_edges[:-1], contacts.gap_edges[1:], contacts.gap_counts, strict=True)
    for low, high, count in bins:
        if count:
            meter = f'<meter min="0" max="{most}" value="{count}">{count}</meter>'
            rows.append((f"{low:.0e} to {high:.0e}", str(count), meter))
    angle = np.degrees(contacts.tolerance.angle)
    note = (
        f"<p>Gaps of opposing faces over the size of the smaller part. Faces count as touching up "
        f"to a gap of {contacts.gap:.3g} {answers.assembly.units} and an angle of {angle:.3g} "
        "degrees.</p>"
    )
    body = _table(["gap over size", "faces", ""], rows) if rows else "<p>None.</p>"
    return _section("Gaps", note, body)


def _made(answers: Answers) -> str:
    versions = ", ".join(f"{text(k)} {text(v)}" for k, v in answers.versions.items())
    seconds: dict[str, Any] = answers.given.check.get("seconds") or {}
    took = ", ".join(f"{text(k)} {float(v):.2g}" for k, v in seconds.items())
    rows = [
        ("command", f"<code>{text(answers.command)}</code>"),
        ("versions", versions),
        ("seconds", took),
        (
            "live answers",
            "Turning gravity solves nothing: a direction is stable where it lies in the exact "
            "cone of stable directions that is in this page, and its margin is the angle to the "
            "nearest facet of that cone. Colour and moving parts come from the stability map "
            "(LP (9)). All of it is of first order.",
        ),
    ]
    return _section("How to reproduce", _facts(rows))
