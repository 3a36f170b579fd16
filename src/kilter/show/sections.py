"""Text sections of a report's page: verdict, facts, parts, contacts, warnings, reproduction.

The words come from `kilter.tell` and the data of the answers. Every word from a file is escaped
by `text` or `name_html`, so that it is never read as HTML.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from kilter.show.packing import readable
from kilter.show.scene import coincide
from kilter.tell.csv_cells import rest_table
from kilter.tell.facts import facts
from kilter.tell.numbers import Name, number, vector
from kilter.tell.region_facts import region_words
from kilter.tell.tables import (
    Table,
    forces_table,
    load_table,
    movement_tables,
    moving_table,
    open_table,
    push_table,
    ranges_table,
    sentences,
    tables,
)

if TYPE_CHECKING:
    from kilter.analysis.everything import Everything
    from kilter.analysis.placing.place import Places
    from kilter.analysis.placing.upright_prisms import PlacedPrism


LISTED = 1000
"""Maximum rows of a table. A note counts the remaining rows, and `--json` lists all."""
ABOVE = ("seconds", "level")
"""Facts that the page does not list: the banner shows the level, and times would change the page.
"""
OPEN = 60
"""Number of rows above which a section is closed at first."""
RESTS = (
    "Without friction, the assembly returns to a strict minimum after small pushes. The tilt is "
    "the largest turn of gravity for which the assembly stays. For a single body on a table it is "
    "the largest turn from which the body returns."
)
LIVE = (
    "Turning gravity starts no computation. The answer for a direction comes from the cone of "
    "stable directions in this page; its margin is the angle to the nearest side of the cone. "
    "Colours and moving parts come from the stability map (displacement program, without "
    "friction). These answers are of first order."
)


def text(value: object) -> str:
    """Escape a value as text for HTML.

    Examples
    --------
    >>> text('<b>"&')
    '&lt;b&gt;&quot;&amp;'
    """
    return html.escape(readable(str(value)), quote=True)


def name_html(name: str) -> str:
    """A name as HTML, isolated so that its writing direction does not affect other text."""
    return f'<bdi class="name">{text(name)}</bdi>'


def sections(answers: Everything, *, command: str, versions: dict[str, str]) -> str:
    """HTML of all text sections of a report's page, below the picture."""
    parts = [_verdict(answers), _open_pairs(answers), _parts(answers), _contacts(answers)]
    parts[2:2] = [_movement(answers), _rests(answers), _pushes(answers), _loads(answers)]
    warnings = [
        *answers.given.check["warnings"],
        *(answers.region or {}).get("warnings", ()),
        *(answers.margin or {}).get("warnings", ()),
    ]
    parts.append(warnings_section(warnings))
    return "\n".join(
        filter(None, [*parts, made_section(command, versions, ("live answers", LIVE))])
    )


def answer_html(answer: Mapping[str, Any]) -> str:
    """HTML of the answer of a command: sentences, facts, tables and warnings, every word escaped.

    Parameters
    ----------
    answer : mapping
        Data of the answer (`to_dict()`).
    """
    first = "".join(f"<p>{text(sentence)}</p>" for sentence in sentences(answer))
    listed = moving_table(answer)
    shown = [*([] if listed is None else [listed]), *tables(answer)]
    body = [facts_html((term, text(words)) for term, words in facts(answer) if term not in ABOVE)]
    for table in shown:
        body += [f"<h3>{text(table.title.rstrip(':'))}</h3>", _table(table)]
    warnings = "".join(f"<li>{text(warning)}</li>" for warning in answer.get("warnings", ()))
    if warnings:
        body.append(f"<h3>Warnings</h3><ul>{warnings}</ul>")
    return first + "".join(body)


def ranges_html(data: Mapping[str, Any]) -> str:
    """HTML of ranges of contact forces: a sentence and a table."""
    table = ranges_table(data)
    return f"<p>{text(data['sentence'])}</p><h3>{text(table.title)}</h3>{_table(table)}"


def movement_html(data: Mapping[str, Any]) -> str:
    """HTML of a movement of supports: the outcome, contacts that open, and movements of parts."""
    opened, *moves = movement_tables(data)
    rest = [f"<h3>{text(table.title.rstrip(':'))}</h3>{_table(table)}" for table in moves]
    return "".join([f"<p>{text(opened.title)}</p>", _table(opened) if opened.head else "", *rest])


def section(title: str, *body: str, rows: int = 0) -> str:
    """HTML of a section that can be opened and closed; with many rows it is closed at first."""
    state = " open" if rows <= OPEN else ""
    inner = "\n".join(body)
    return f"<details{state}><summary><h2>{text(title)}</h2></summary>\n{inner}\n</details>"


def _table(table: Table) -> str:
    """HTML of a table of an answer, cut to `LISTED` rows."""
    rows = table.rows(LISTED)
    return rows_html(table.head, [[_cell(cell) for cell in row] for row in rows], len(table.items))


def _cell(cell: str) -> str:
    return name_html(cell) if isinstance(cell, Name) else text(cell)


def rows_html(head: Sequence[str], rows: Iterable[Sequence[str]], of: int) -> str:
    """HTML table from cells that are HTML; `of` is the number of rows before any cut."""
    lines = ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
    more = of - len(lines)
    note = f"<p>{more} more rows; the command with --json lists all.</p>" if more > 0 else ""
    top = "<tr>" + "".join(f'<th scope="col">{text(cell)}</th>' for cell in head) + "</tr>"
    return (
        f'<div class="wide"><table><thead>{top if head else ""}</thead><tbody>'
        + "\n".join(lines)
        + f"</tbody></table></div>{note}"
    )


def facts_html(rows: Iterable[tuple[str, str]]) -> str:
    """HTML list of terms and values; the values are HTML already."""
    return "<dl>" + "".join(f"<dt>{text(k)}</dt><dd>{v}</dd>" for k, v in rows) + "</dl>"


def _verdict(answers: Everything) -> str:
    """HTML section with facts, notes and contact forces for the given direction of gravity."""
    check, region, best = answers.given.check, answers.region, answers.recommended
    rows = [(term, text(words)) for term, words in facts(check) if term not in ABOVE]
    if region is not None:
        rows.append(("stable directions", text(region_words(region, proved_none=answers.none))))
    if best is not None:
        words = "gravity as given" if coincide(answers) else f"gravity along {vector(best.down)}"
        rows.append(("recommended", f"{words}: {text(best.sentence)}"))
    rows += [("note", text(note)) for note in answers.notes]
    forces = forces_table(check)
    body = [f"<h3>{text(forces.title)}</h3>", _table(forces)] if forces.items else []
    plain = f"<noscript><p>{text(check['sentence'])}</p></noscript>"
    return section("Gravity as given", plain, facts_html(rows), *body)


def margin_card(answers: Everything) -> str:
    """HTML card with the margins for the given gravity; empty if they were not computed."""
    margin = answers.margin
    if margin is None:
        return ""
    rows = [(k, text(words)) for k, words in facts(margin) if k not in ("joints", "helps", "")]
    pushes = push_table(margin)
    if pushes.items:
        name, *words = pushes.row(pushes.items[0])
        weakest = f"{text(' '.join(filter(None, words)))}, {name_html(name)}"
        rows.append(("weakest push", weakest))
    items = "".join(f"<li>{text(change['sentence'])}</li>" for change in margin["improvements"])
    if items:
        rows.append(("what helps", f"<ul>{items}</ul>"))
    button, best = "", answers.change
    if best is not None:
        button = (
            '<p class="buttons"><button id="show-change" type="button" aria-pressed="false">'
            f"Show the brick to {best.what}</button></p>"
        )
    if best is not None and best.what == "add":
        button += '<p class="key"><span><i class="swatch added"></i> to add</span></p>'
    return (
        '<section class="card" id="margins" aria-labelledby="margins-title">'
        f'<h2 id="margins-title">Margins, gravity as given</h2>{facts_html(rows)}'
        f"{button}</section>\n"
    )


def _movement(answers: Everything) -> str:
    """HTML section with the movement of supports; empty if no support moves."""
    found = answers.movement
    if found is None:
        return ""
    data = {"movement": found.to_dict(), "units": answers.assembly.units}
    return section("Supports that move", movement_html(data))


def _rests(answers: Everything) -> str:
    """HTML section with the directions of gravity at which the assembly rests; else empty."""
    if answers.region is None or not answers.region["rests"]:
        return ""
    table = rest_table(answers.region)
    return section(f"Places of rest ({len(table.items)})", f"<p>{text(RESTS)}</p>", _table(table))


def _loads(answers: Everything) -> str:
    """HTML section with the load capacity of each part; empty if it was not computed."""
    table = None if answers.margin is None else load_table(answers.margin)
    if table is None or not table.items:
        return ""
    title = f"Load capacities ({len(table.items)})"
    return section(title, f"<p>{text(table.title)}</p>", _table(table), rows=len(table.items))


def _pushes(answers: Everything) -> str:
    """HTML section with the weakest push of each part; empty for fewer than two parts."""
    table = None if answers.margin is None else push_table(answers.margin)
    if table is None or len(table.items) < 2:
        return ""
    return section(f"Weakest pushes ({len(table.items)})", _table(table), rows=len(table.items))


def _parts(answers: Everything) -> str:
    """HTML section with a table of the parts, the moving parts first."""
    parts, geometry = answers.given.check["parts"], answers.assembly.geometry
    order = sorted(range(len(parts)), key=lambda k: not parts[k]["moves"])

    possible = answers.given.check["verdict"] == "potentially-stable"
    moves = "could move" if possible else "moves"

    def row(k: int) -> Sequence[str]:
        part = parts[k]
        return (
            f'<button class="link" data-part="{k}">{name_html(part["name"])}</button>',
            "held" if part["grounded"] else moves if part["moves"] else "stays",
            "" if part["grounded"] else text(part["motion"]),
            number(part["mass"]),
            vector(geometry.center[k], 5),
        )

    units = answers.assembly.units
    head = ["part", "state", "first motion", "mass [kg]", f"centre [{units}]"]
    body = rows_html(head, [row(k) for k in order[:LISTED]], len(parts))
    return section(f"Parts ({len(parts)})", body, rows=len(parts))


def _open_pairs(answers: Everything) -> str:
    """HTML section with the open pairs (pairs whose contact is uncertain); else empty."""
    table = open_table(answers.contacts.to_dict())
    if not len(table.items):
        return ""
    return section(f"Open pairs ({len(table.items)})", _table(table), rows=len(table.items))


def _contacts(answers: Everything) -> str:
    """HTML section with the facts and tables of the contacts."""
    touching = answers.contacts.to_dict()
    body = [facts_html((term, text(words)) for term, words in facts(touching))]
    for table in tables(touching):
        if table.title == open_table(touching).title:
            continue  # the open pairs have a separate section
        body += [f"<h3>{text(table.title.rstrip(':'))}</h3>", _table(table)]
    count = len(touching["patches"])
    return section(f"Contacts ({count})", *body, rows=count)


def warnings_section(warnings: Iterable[str]) -> str:
    """HTML section with the warnings, without repetitions."""
    listed = [f"<li>{text(warning)}</li>" for warning in dict.fromkeys(warnings)]
    body = f"<ul>{''.join(listed)}</ul>" if listed else "<p>None.</p>"
    return section(f"Warnings ({len(listed)})", body)


def made_section(command: str, versions: dict[str, str], *more: tuple[str, str]) -> str:
    """HTML section with the command and the versions that reproduce the page, and notes.

    `more` lists further terms and their values.
    """
    used = ", ".join(f"{text(k)} {text(v)}" for k, v in versions.items())
    rows = [
        ("command", f"<code>{text(command)}</code>"),
        ("versions", used),
        *more,
    ]
    return section("How to reproduce", facts_html(rows))


# The map of places of the next part on a page: data of the layer, and its card.


KEYS = (
    ("stable", "the centre here: everything stands"),
    ("falls", "something falls"),
    ("undecided", "open"),
)
"""Swatches and words of the key of the map."""


def placed_part(prism: PlacedPrism) -> dict[str, Any]:
    """The part of a map of places for the picture: corners of its underside, and its heights."""
    return {
        "footprint": prism.footprint.tolist(),
        "below": prism.below,
        "above": prism.above,
    }


def build_place_layer(places: Places) -> dict[str, Any]:
    """JSON data of the map: its polygons by height, and the part."""
    assert places.prism is not None
    return {"levels": places.to_dict()["levels"], "part": placed_part(places.prism)}


def place_card(places: Places) -> str:
    """HTML card of the map: its sentence, the state at the pointer, a key, and facts."""
    answer = places.to_dict()
    keys = " ".join(
        f'<span><i class="swatch {name}"></i> {text(words)}</span>' for name, words in KEYS
    )
    rows = facts_html((term, text(words)) for term, words in facts(answer) if term != "seconds")
    return (
        '<section class="card" id="places" aria-labelledby="places-title">'
        f'<h2 id="places-title">Places of the next part</h2><p>{text(answer["sentence"])}</p>'
        '<p id="place-state" role="status">move the pointer over the map</p>'
        f'<p class="key">{keys}</p>{rows}</section>\n'
    )


# The precedence graph of a plan as SVG: required successions, and parts that touch.


HIGH, ROW, GAP = 24.0, 62.0, 10.0
"""Height of a node, distance between two rows, gap between two nodes of a row [px]."""
WIDE = (30.0, 128.0)
"""Width of a node with its number alone, and with a name [px]."""
NAMED = 40
"""Largest number of steps for which names are written in the nodes."""
LETTERS = 15
"""Largest length of a name; a longer name is cut [characters]."""
MARGIN = 8.0
"""Margin around the graph [px]."""
SWEEPS = 6
"""Passes that sort the rows; more passes give fewer crossings."""
Edge = tuple[int, int]


def graph_svg(answer: Mapping[str, Any], needs: Sequence[tuple[str, str]]) -> str:
    """Draw the precedence graph as SVG; node 0 is the base, node k is step k."""
    steps = answer["steps"]
    node = dict.fromkeys(answer["base"], 0)
    node |= {name: k for k, step in enumerate(steps, 1) for name in step["parts"]}
    must = {(node[a], node[b]) for a, b in needs if a in node and b in node}
    must = {(a, b) for a, b in must if a and a < b}
    put = {(node[name], k) for k, step in enumerate(steps, 1) for name in step["touches"]}
    edges = _transitive_reduction(len(steps) + 1, must | {(a, b) for a, b in put if a < b})
    rows = _rows(len(steps) + 1, edges)
    return _to_svg(answer, rows, edges, must)


def _transitive_reduction(count: int, edges: set[Edge]) -> set[Edge]:
    """Edges (a, b), a < b, of a graph without those that follow from other edges."""
    above = [0] * count
    kept: set[Edge] = set()
    for b in range(count):
        for a in sorted((a for a, k in edges if k == b), reverse=True):
            if not above[b] >> a & 1:
                kept.add((a, b))
                above[b] |= above[a] | 1 << a
    return kept


def _rows(count: int, edges: set[Edge]) -> list[list[int]]:
    """Nodes of a graph in rows by depth; each row is sorted so that few edges cross."""
    depth = [0] * count
    for a, b in sorted(edges, key=lambda edge: edge[1]):
        depth[b] = max(depth[b], depth[a] + 1)
    rows: list[list[int]] = [[] for _ in range(max(depth) + 1)]
    for k in range(count):
        rows[depth[k]].append(k)
    near: list[list[int]] = [[] for _ in range(count)]
    for a, b in edges:
        near[a].append(b)
        near[b].append(a)
    for _ in range(SWEEPS):
        place = {k: i - len(row) / 2 for row in rows for i, k in enumerate(row)}
        for row in rows:
            row.sort(
                key=lambda k: (
                    sum(place[j] for j in near[k]) / len(near[k]) if near[k] else place[k],
                    k,
                )
            )
            place |= {k: i - len(row) / 2 for i, k in enumerate(row)}
    return rows


def _to_svg(
    answer: Mapping[str, Any], rows: list[list[int]], edges: set[Edge], must: set[Edge]
) -> str:
    """SVG of nodes in rows; edges in `must` are arrows, other edges are pale lines."""
    steps = answer["steps"]
    wide = WIDE[len(steps) <= NAMED]
    width = max(len(row) for row in rows) * (wide + GAP) - GAP + 2 * MARGIN
    height = (len(rows) - 1) * ROW + HIGH + 2 * MARGIN
    at: dict[int, tuple[float, float]] = {}
    for r, row in enumerate(rows):
        left = (width - len(row) * (wide + GAP) + GAP) / 2
        for i, k in enumerate(row):
            at[k] = left + i * (wide + GAP) + wide / 2, MARGIN + r * ROW
    lines = [_line(at[a], at[b], (a, b) in must) for a, b in sorted(edges)]
    names = [answer["base"], *(step["parts"] for step in steps)]
    held = {name for step in steps for name in step["held"]}
    nodes = []
    for k, (x, y) in sorted(at.items()):
        whole = ", ".join(names[k])
        short = whole if len(whole) <= LETTERS else whole[: LETTERS - 1] + "…"
        label = "base" if k == 0 else f"{k}  {short}" if len(steps) <= NAMED else str(k)
        if k == 0 and wide < WIDE[1]:
            label = "•"
        kind = "base" if k == 0 else "held" if held & set(names[k]) else "part"
        data = f' data-step="{k - 1}"' if k else ""
        nodes.append(
            f'<g class="{kind}"{data}><title>{text(f"{k}: {whole}" if k else whole)}</title>'
            f'<rect x="{x - wide / 2:g}" y="{y:g}" width="{wide:g}" height="{HIGH:g}" rx="6"/>'
            f'<text x="{x:g}" y="{y + 16.5:g}">{text(label)}</text></g>'
        )
    return (
        f'<svg viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}" role="img" '
        f'aria-label="precedence of the steps">{"".join(lines)}{"".join(nodes)}</svg>'
    )


def _line(start: tuple[float, float], end: tuple[float, float], must: bool) -> str:
    """SVG curve from the lower side of a node to the upper side of another.

    With `must`, it ends in an arrow head.
    """
    (x, y), (u, v) = (start[0], start[1] + HIGH), end
    bend = (v - y) / 2
    kind = "must" if must else "touch"
    path = f"M{x:g} {y:g}C{x:g} {y + bend:g} {u:g} {v - bend:g} {u:g} {v:g}"
    if not must:
        return f'<path class="touch" d="{path}"/>'
    head = f"M{u:g} {v:g}l-3.5 -7h7z"
    return f'<path class="{kind}" d="{path}"/><path class="head" d="{head}"/>'
