"""Rules of packing programs for the next box, beside kilter, on random stacks of boxes.

    python benchmarks/place_rules.py [STACKS] [FIRST SEED] [--figure FILE.svg]

Each stack has 8 boxes of 1 to 10 kg, each put down at a random place at which the stack stood.
For 50 random places of a ninth box on other boxes, each rule accepts or
rejects the place; `kilter.check` (level equilibrium, no friction) decides whether the stack stands
there. A linear program that is written here from the geometry, and solved by scipy, rechecks every
fifth place. Prints the table of docs/explanation/placing.md; returns 1 if an answer disagrees.

Rules: a least share of the underside is supported; the centre of mass lies over the convex hull of
the contact; LBCP, the load-bearable convex polygon (arXiv 2507.09123). The polygon of a box on the
base is its top. The polygon of another box is the hull of the polygons below, each cut to its
outline. A box stands if its centre lies over this hull.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

import numpy as np
import shapely
from scipy.optimize import linprog

import kilter
from kilter import Pile
from kilter.arrays import Array
from kilter.tell.palette import ROLES

BASE = (1.2, 0.8)
BOXES, PLACES = 8, 50
SIZES = (0.2, 0.5)
"""Shortest and longest side of a box seen from above [m]."""
HEIGHTS = (0.125, 0.25)
"""Sums of these heights are exact, so equal tops are exactly level [m]."""
MASSES = (1.0, 10.0)
TRIES = 30
"""Places that are tried for a box of the stack."""
EVERY = 5
"""One of this number of places is rechecked by a separate program."""
FULL = 1 - 1e-9
"""Share of the underside from which a support is full [-]."""
RULES = ("full support", "75 % support", "60 % support", "centre over the hull of its contact",
         "LBCP", "kilter")  # fmt: skip


@dataclass
class RuleCounts:
    """Places of the next box, counted by the answer of each rule and by the decision.

    Attributes
    ----------
    stands, falls : int
        Places at which the stack stands and falls with the box.
    accepted_falls, rejected_stands : dict of str to int
        Wrong answers by rule.
    undecided, rechecked, disagreements : int
        Places that check leaves undecided (not counted above), places of the separate program, and
        its answers that differ.
    gaps : list of float
        Gaps of the pairs of boxes whose contact decides the undecided places [m].
    """

    stands: int = 0
    falls: int = 0
    accepted_falls: dict[str, int] = field(default_factory=lambda: dict.fromkeys(RULES, 0))
    rejected_stands: dict[str, int] = field(default_factory=lambda: dict.fromkeys(RULES, 0))
    undecided: int = 0
    rechecked: int = 0
    disagreements: int = 0
    gaps: list[float] = field(default_factory=list)

    def add(self, accepted: dict[str, bool], stands: bool) -> None:
        """Count a place."""
        self.stands += stands
        self.falls += not stands
        wrong = self.rejected_stands if stands else self.accepted_falls
        for rule in RULES:
            wrong[rule] += accepted[rule] != stands

    def shares(self, rule: str) -> tuple[float, float]:
        """Shares of the accepted places that fall, and of the standing places rejected [-]."""
        falls, rejected = self.accepted_falls[rule], self.rejected_stands[rule]
        return falls / max(self.stands - rejected + falls, 1), rejected / max(self.stands, 1)


def main() -> int:
    """Print the table; return 1 if kilter or a recheck disagrees."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stacks", nargs="?", type=int, default=60)
    parser.add_argument("first", nargs="?", type=int, default=1)
    parser.add_argument("--figure", type=Path, help="write the shares as bars (.svg)")
    given = parser.parse_args()
    counts = counted(range(given.first, given.first + given.stacks))
    print(table(counts))
    print(f"\n{undecided_words(counts)}; {counts.rechecked} places rechecked by scipy, "
          f"{counts.disagreements} disagreements")  # fmt: skip
    if given.figure:
        given.figure.write_text(figure(counts), encoding="utf-8")
    wrong = counts.accepted_falls["kilter"] + counts.rejected_stands["kilter"]
    return 1 if wrong or counts.disagreements else 0


def counted(seeds: Iterable[int]) -> RuleCounts:
    """Counts over the random stacks of these seeds."""
    counts = RuleCounts()
    for seed in seeds:
        rng = np.random.default_rng(seed)
        pile = random_stack(rng)
        size, mass = random_box(rng)
        polygons = load_bearing(pile.boxes)
        for number, corner in enumerate(candidate_places(rng, pile, size)):
            grown = pile.copy()
            grown.add(size, mass, corner)
            verdict = kilter.check(grown.assembly(), require="equilibrium")
            if verdict.verdict == "undecided" or grown.stands is None:
                counts.undecided += 1
                counts.gaps += [
                    pair["gap"] for pair in verdict.to_dict()["open_pairs"] if pair["decides"]
                ]
                continue
            stands = verdict.level is not None
            counts.add(answers(grown.boxes, polygons) | {"kilter": grown.stands}, stands)
            if number % EVERY == 0:
                counts.rechecked += 1
                counts.disagreements += balanced(grown.boxes, grown.masses) != stands
    return counts


def undecided_words(counts: RuleCounts) -> str:
    """The number of undecided places, and the reason."""
    words = f"{counts.undecided} places undecided"
    if not counts.gaps:
        return words
    least, most = 1e3 * min(counts.gaps), 1e3 * max(counts.gaps)
    return (
        f"{words} (the pile holds only if boxes touch that stand side by side, {least:.2f} to "
        f"{most:.2f} mm apart)"
    )


# stacks ---------------------------------------------------------------------------------------


def random_box(rng: np.random.Generator) -> tuple[Array, float]:
    """Size [m] and mass [kg] of a box."""
    return np.append(rng.uniform(*SIZES, 2), rng.choice(HEIGHTS)), float(rng.uniform(*MASSES))


def random_stack(rng: np.random.Generator) -> Pile:
    """A pile of boxes, each at a random place at which the pile stands."""
    pile = Pile(BASE)
    while len(pile) < BOXES:
        size, mass = random_box(rng)
        for corner in rng.uniform(0, np.array(BASE) - size[:2], (TRIES, 2)):
            grown = pile.copy()
            grown.add(size, mass, corner)
            if grown.stands:
                pile = grown
                break
    return pile


def candidate_places(rng: np.random.Generator, pile: Pile, size: Array) -> Array:
    """Corners of the next box at random places above other boxes, shape (n, 2)."""
    corners = rng.uniform(0, np.array(BASE) - size[:2], (20 * PLACES, 2))
    low, high = pile.boxes[:, :2], pile.boxes[:, :2] + pile.boxes[:, 3:5]
    above = (corners[:, None] < high) & (corners[:, None] + size[:2] > low)
    return corners[above.all(axis=2).any(axis=1)][:PLACES]


# rules ----------------------------------------------------------------------------------------


def outline(box: Array) -> shapely.Polygon:
    """A box (corner and size) from above."""
    return shapely.box(*box[:2], *(box[:2] + box[3:5]))


def polygon_below(
    box: Array, boxes: Array, polygons: list[shapely.Geometry]
) -> list[shapely.Geometry]:
    """Polygons of the boxes, or of the base, on which a box lies, cut to its outline."""
    own = outline(box)
    if box[2] == 0:
        return [own]
    tops = boxes[:, 2] + boxes[:, 5]
    return [own & polygons[k] for k in np.flatnonzero(tops == box[2])]


def load_bearing(boxes: Array) -> list[shapely.Geometry]:
    """The load-bearable convex polygon of each box; a box lies on boxes before it."""
    polygons: list[shapely.Geometry] = []
    for k, box in enumerate(boxes):
        below = polygon_below(box, boxes[:k], polygons)
        polygons.append(shapely.convex_hull(shapely.union_all(below)))
    return polygons


def answers(boxes: Array, polygons: list[shapely.Geometry]) -> dict[str, bool]:
    """Whether each rule accepts the last box."""
    new, others = boxes[-1], boxes[:-1]
    center = shapely.Point(new[:2] + new[3:5] / 2)
    contact = shapely.union_all(polygon_below(new, others, [outline(box) for box in others]))
    bearing = shapely.union_all(polygon_below(new, others, polygons))
    share = contact.area / (new[3] * new[4])
    return {
        "full support": share > FULL,
        "75 % support": share > 0.75,
        "60 % support": share > 0.6,
        "centre over the hull of its contact": contact.convex_hull.covers(center),
        "LBCP": bearing.convex_hull.covers(center),
    }


# a second method ------------------------------------------------------------------------------


def balanced(boxes: Array, masses: Array) -> bool:
    """Whether forces at the corners of the contacts balance every box: a program of its own.

    Each corner has an upward force f >= 0 on the upper box, and -f on the lower box. Rows: force
    along z and moments about the level axes through the origin, for each box.
    """
    low, high = boxes[:, :3], boxes[:, :3] + boxes[:, 3:]
    columns = []
    for upper in range(len(boxes)):
        below = [-1] if low[upper, 2] == 0 else np.flatnonzero(high[:, 2] == low[upper, 2])
        for lower in below:
            first, last = low[upper, :2], high[upper, :2]
            if lower >= 0:
                first = np.maximum(first, low[lower, :2])
                last = np.minimum(last, high[lower, :2])
            if (first >= last).any():
                continue
            for x in (first[0], last[0]):
                for y in (first[1], last[1]):
                    column = np.zeros((len(boxes), 3))
                    column[upper] = 1, x, y
                    if lower >= 0:
                        column[lower] = -1, -x, -y
                    columns.append(column.ravel())
    center = (low + high) / 2
    weights = masses[:, None] * np.column_stack([np.ones(len(boxes)), center[:, :2]])
    matrix = np.array(columns).T
    return linprog(np.zeros(matrix.shape[1]), A_eq=matrix, b_eq=weights.ravel()).status == 0


# table and figure -----------------------------------------------------------------------------


def table(counts: RuleCounts) -> str:
    """The counts as Markdown, with a sentence about the total."""
    lines = [
        f"The stack stands at {counts.stands:,} of {counts.stands + counts.falls:,} places.",
        "",
        "| rule | accepts, but the stack falls | share of accepted places | "
        "rejects, but the stack stands | share of standing places |",
        "|---|---|---|---|---|",
    ]
    for rule in RULES:
        falls, rejected = counts.shares(rule)
        lines.append(
            f"| {rule} | {counts.accepted_falls[rule]:,} | {falls:.0%} | "
            f"{counts.rejected_stands[rule]:,} | {rejected:.0%} |"
        )
    return "\n".join(lines).replace("%", " %").replace("  %", " %")


ROW, BAR, LEFT, LONG, TOP = 46, 15, 240, 300, 34
"""Heights of a row and of a bar, left end and length of a full bar, height of the legend [px]."""


def figure(counts: RuleCounts) -> str:
    """Shares of wrong answers as bars, as SVG in the reader's light or dark theme."""
    colours = (("falls", "unstable"), ("rejected", "stable"), ("ink", "ink"))
    light, dark = (
        "".join(f".{name}{{fill:{getattr(ROLES[role], theme)}}}" for name, role in colours)
        for theme in ("light", "dark")
    )
    width, height = LEFT + LONG + 60, TOP + ROW * len(RULES)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">',
        "<title>Wrong answers of rules for the next box</title>",
        f"<style>text{{font:13px system-ui,sans-serif}}{light}"
        f"@media(prefers-color-scheme:dark){{{dark}}}</style>",
    ]
    legend = (
        ("falls", "share of accepted places that fall"),
        ("rejected", "share of standing places rejected"),
    )
    for k, (name, words) in enumerate(legend):
        x = 12 + 260 * k
        lines.append(f'<rect class="{name}" x="{x}" y="8" width="{BAR}" height="{BAR - 3}"/>')
        lines.append(f'<text class="ink" x="{x + 22}" y="19">{words}</text>')
    for k, rule in enumerate(RULES):
        y = TOP + ROW * k
        lines.append(f'<text class="ink" x="{LEFT - 10}" y="{y + 22}" text-anchor="end">'
                     f"{escape(rule)}</text>")  # fmt: skip
        for row, (name, share) in enumerate(
            zip(("falls", "rejected"), counts.shares(rule), strict=True)
        ):
            at = y + 2 + row * (BAR + 1)
            lines.append(f'<rect class="{name}" x="{LEFT}" y="{at}" width="{LONG * share:.1f}" '
                         f'height="{BAR}"/>')  # fmt: skip
            lines.append(f'<text class="ink" x="{LEFT + LONG * share + 6:.1f}" y="{at + 12}">'
                         f"{100 * share:.0f} %</text>")  # fmt: skip
    return "\n".join([*lines, "</svg>"]) + "\n"


if __name__ == "__main__":
    sys.exit(main())
