"""The precedence graph of a plan as SVG: required successions, and parts that touch.

A row contains the steps of equal depth. The depth of a step is 1 plus the largest depth of its
predecessors. Edges that follow from others are left out. Within a row, a step is near the
mean position of its neighbours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kilter.show.sections import text

__all__ = ["graph_svg"]

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
