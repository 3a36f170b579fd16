"""The text of a page: verdict and facts, parts, contacts, warnings, how it was made.

The words are those of `kilter.tell`, from the data of the answers. Every word from a file goes
through `text` or `named`: it is shown, and never read as HTML.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from kilter.show.packing import readable
from kilter.show.scene import coincide
from kilter.tell.facts import facts
from kilter.tell.numbers import number, vector
from kilter.tell.region_facts import region_words
from kilter.tell.rest_table import rest_table
from kilter.tell.tables import Name, Table, forces_table, load_table, open_table, push_table, tables

if TYPE_CHECKING:
    from kilter.analysis.everything import Everything

__all__ = [
    "LISTED",
    "change_card",
    "facts_html",
    "made_section",
    "margin_card",
    "named",
    "rows_html",
    "section",
    "sections",
    "text",
    "warnings_section",
]

LISTED = 1000
"""Rows of a table; what is left out is counted, and `--json` gives all."""
ABOVE = ("seconds", "level")
"""Facts that are not listed: the banner has the level, and no time belongs to an answer."""
OPEN = 60
"""A section with more rows than this begins closed."""
RESTS = (
    "Without friction: a strict minimum comes back after small pushes. The tilt is that of gravity "
    "up to which it stays, or of one body on a table, from which it comes back."
)
LIVE = (
    "Turning gravity solves nothing: a direction is answered by the cone of directions that is in "
    "this page, and its margin is the angle to the nearest side of that cone. Colour and moving "
    "parts come from the stability map (LP (9), without friction). All of it is of first order."
)


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


def sections(answers: Everything, *, command: str, versions: dict[str, str]) -> str:
    """The sections below the picture."""
    parts = [_verdict(answers), _left_open(answers), _parts(answers), _contacts(answers)]
    parts[2:2] = [_rests(answers), _tried(answers), _pushes(answers), _loads(answers)]
    warned = [
        *answers.given.check["warnings"],
        *(answers.region or {}).get("warnings", ()),
        *(answers.margin or {}).get("warnings", ()),
    ]
    parts.append(warnings_section(warned))
    return "\n".join(
        filter(None, [*parts, made_section(command, versions, ("live answers", LIVE))])
    )


def section(title: str, *body: str, rows: int = 0) -> str:
    """A part of the page; one of many rows begins closed."""
    state = " open" if rows <= OPEN else ""
    inner = "\n".join(body)
    return f"<details{state}><summary><h2>{text(title)}</h2></summary>\n{inner}\n</details>"


def _table(table: Table) -> str:
    """A list of an answer."""
    rows = table.rows(LISTED)
    return rows_html(table.head, [[_cell(cell) for cell in row] for row in rows], len(table.items))


def _cell(cell: str) -> str:
    return named(cell) if isinstance(cell, Name) else text(cell)


def rows_html(head: Sequence[str], rows: Iterable[Sequence[str]], of: int) -> str:
    """A table; cells are HTML, `of`: how many rows there would be."""
    lines = ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
    more = of - len(lines)
    note = f"<p>and {more} more; the command with --json lists all.</p>" if more > 0 else ""
    top = "<tr>" + "".join(f'<th scope="col">{text(cell)}</th>' for cell in head) + "</tr>"
    return (
        f'<div class="wide"><table><thead>{top if head else ""}</thead><tbody>'
        + "\n".join(lines)
        + f"</tbody></table></div>{note}"
    )


def facts_html(rows: Iterable[tuple[str, str]]) -> str:
    """Terms and what they are; the values are HTML."""
    return "<dl>" + "".join(f"<dt>{text(k)}</dt><dd>{v}</dd>" for k, v in rows) + "</dl>"


def _verdict(answers: Everything) -> str:
    check, found, one = answers.given.check, answers.region, answers.recommended
    rows = [(term, text(words)) for term, words in facts(check) if term not in ABOVE]
    if found is not None:
        rows.append(("stable directions", text(region_words(found, proved_none=answers.none))))
    if one is not None:
        words = "gravity as given" if coincide(answers) else f"gravity along {vector(one.down)}"
        rows.append(("recommended", f"{words}: {text(one.sentence)}"))
    rows += [("note", text(note)) for note in answers.notes]
    forces = forces_table(check)
    body = [f"<h3>{text(forces.title)}</h3>", _table(forces)] if forces.items else []
    plain = f"<noscript><p>{text(check['sentence'])}</p></noscript>"
    return section("Gravity as given", plain, facts_html(rows), *body)


def margin_card(answers: Everything) -> str:
    """By how much it holds, for gravity as given; nothing where it was not asked."""
    margin = answers.margin
    if margin is None:
        return ""
    rows = [(k, text(words)) for k, words in facts(margin) if k not in ("joints", "helps", "")]
    pushes = push_table(margin)
    if pushes.items:
        name, *words = pushes.row(pushes.items[0])
        said = f"{text(' '.join(filter(None, words)))}, {named(name)}"
        rows.append(("weakest push", said))
    items = "".join(f"<li>{text(one['sentence'])}</li>" for one in margin["helps"])
    if items:
        rows.append(("what helps", f"<ul>{items}</ul>"))
    return (
        '<section class="card" id="margins" aria-labelledby="margins-title">'
        f'<h2 id="margins-title">Margins, gravity as given</h2>{facts_html(rows)}</section>\n'
    )


def change_card(answers: Everything) -> str:
    """Which brick to add or to take away, and a button that shows it; nothing of other parts."""
    found = answers.change
    if found is None:
        return ""
    added = found.best is not None and found.best.what == "add"
    button = (
        f'<p class="buttons"><button id="show-change" type="button" aria-pressed="false">'
        f"Show the brick to {'add' if added else 'take away'}</button></p>"
        if found.best is not None
        else ""
    )
    key = '<p class="key"><span><i class="swatch added"></i> to add</span></p>' if added else ""
    rows = facts_html((term, text(words)) for term, words in facts(found.to_dict()))
    return (
        '<section class="card" id="change" aria-labelledby="change-title">'
        f'<h2 id="change-title">What to change</h2><p>{text(found.sentence)}</p>{rows}{button}{key}'
        "</section>\n"
    )


def _rests(answers: Everything) -> str:
    """How it rests in the directions of its region."""
    if answers.region is None or not answers.region["rests"]:
        return ""
    table = rest_table(answers.region)
    return section(f"How it rests ({len(table.items)})", f"<p>{text(RESTS)}</p>", _table(table))


def _tried(answers: Everything) -> str:
    """The changes that were tried."""
    if answers.change is None or not answers.change.tried:
        return ""
    [table] = tables(answers.change.to_dict())
    return section(f"Changes tried ({len(table.items)})", _table(table), rows=len(table.items))


def _loads(answers: Everything) -> str:
    """The load that each part still takes."""
    table = None if answers.margin is None else load_table(answers.margin)
    if table is None or not table.items:
        return ""
    title = f"Loads that are still taken ({len(table.items)})"
    return section(title, f"<p>{text(table.title)}</p>", _table(table), rows=len(table.items))


def _pushes(answers: Everything) -> str:
    """The weakest push of each part, where there are several."""
    table = None if answers.margin is None else push_table(answers.margin)
    if table is None or len(table.items) < 2:
        return ""
    return section(f"Weakest pushes ({len(table.items)})", _table(table), rows=len(table.items))


def _parts(answers: Everything) -> str:
    """The parts, those that move first, then as in the file."""
    told, geometry = answers.given.check["parts"], answers.assembly.geometry
    order = sorted(range(len(told)), key=lambda k: not told[k]["moves"])

    possible = answers.given.check["verdict"] == "potentially-stable"
    moves = "could move" if possible else "moves"

    def row(k: int) -> Sequence[str]:
        part = told[k]
        return (
            f'<button class="link" data-part="{k}">{named(part["name"])}</button>',
            "held" if part["grounded"] else moves if part["moves"] else "stays",
            "" if part["grounded"] else text(part["motion"]),
            number(part["mass"]),
            vector(geometry.center[k], 5),
        )

    units = answers.assembly.units
    head = ["part", "state", "how it starts to move", "mass [kg]", f"centre [{units}]"]
    body = rows_html(head, [row(k) for k in order[:LISTED]], len(told))
    return section(f"Parts ({len(told)})", body, rows=len(told))


def _left_open(answers: Everything) -> str:
    """Pairs that the geometry leaves open; nothing where there are none."""
    table = open_table(answers.contacts.to_dict())
    if not len(table.items):
        return ""
    return section(f"Left open ({len(table.items)})", _table(table), rows=len(table.items))


def _contacts(answers: Everything) -> str:
    touching = answers.contacts.to_dict()
    body = [facts_html((term, text(words)) for term, words in facts(touching))]
    for table in tables(touching):
        if table.title == open_table(touching).title:
            continue  # it has a section of its own
        body += [f"<h3>{text(table.title.rstrip(':'))}</h3>", _table(table)]
    count = len(touching["patches"])
    return section(f"Contacts ({count})", *body, rows=count)


def warnings_section(found: Iterable[str]) -> str:
    """Warnings, each once."""
    listed = [f"<li>{text(warning)}</li>" for warning in dict.fromkeys(found)]
    body = f"<ul>{''.join(listed)}</ul>" if listed else "<p>None.</p>"
    return section(f"Warnings ({len(listed)})", body)


def made_section(command: str, versions: dict[str, str], *more: tuple[str, str]) -> str:
    """How to make the page again, with what, and what else is to know of it."""
    used = ", ".join(f"{text(k)} {text(v)}" for k, v in versions.items())
    rows = [
        ("command", f"<code>{text(command)}</code>"),
        ("versions", used),
        *more,
    ]
    return section("How to reproduce", facts_html(rows))
