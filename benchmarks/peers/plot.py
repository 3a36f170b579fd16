"""Plot with two logarithmic axes as plain SVG; equal numbers give equal text."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from math import ceil, floor, log10
from typing import NamedTuple

__all__ = ["Line", "plotted"]

WIDTH, HEIGHT = 860, 480
LEFT, RIGHT, TOP, BOTTOM = 70, 190, 40, 50
COLOURS = (
    "#0b6e6e", "#35a7a7", "#c2571a", "#e39a5f", "#7a3e9d", "#b0307a", "#d977b0", "#2f5fb3",
    "#7d7d7d",
)  # fmt: skip
STYLE = """
  text { font-family: system-ui, sans-serif; font-size: 13px; fill: #24313c }
  .ground { fill: #ffffff }
  .grid { stroke: #d8dee2; stroke-width: 1 }
  .line { fill: none; stroke-width: 2.2 }
"""
APART = 16
"""Least distance of two names at the ends of lines [px]."""


class Line(NamedTuple):
    """A line of the plot: its name, and points with positive coordinates."""

    name: str
    points: list[tuple[float, float]]


def plotted(lines: Sequence[Line], across: str, up: str, title: str) -> str:
    """SVG of the plot, with the name of each line at its end."""
    xs = [x for line in lines for x, _ in line.points] or [1.0, 10.0]
    ys = [y for line in lines for _, y in line.points] or [1.0, 10.0]
    columns, rows = decades(xs), decades(ys)

    def place(x: float, y: float) -> tuple[float, float]:
        return (
            LEFT + (log10(x) - columns[0]) / (columns[-1] - columns[0]) * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM - (log10(y) - rows[0]) / (rows[-1] - rows[0]) * (HEIGHT - TOP - BOTTOM),
        )

    drawn = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">',
        f"<title>{escape(title)}</title>",
        f"<style>{STYLE}</style>",
        f'<rect class="ground" width="{WIDTH}" height="{HEIGHT}"/>',
        f'<text x="{LEFT}" y="22" font-weight="600">{escape(title)}</text>',
        f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 10}">{escape(across)}</text>',
        f'<text x="8" y="{TOP - 6}">{escape(up)}</text>',
    ]
    for k in columns:
        x, y = place(10.0**k, 10.0 ** rows[0])
        drawn.append(f'<path class="grid" d="M{x:.1f} {y:.1f}V{TOP}"/>')
        drawn.append(f'<text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">{10**k:,}</text>')
    for k in rows:
        x, y = place(10.0 ** columns[0], 10.0**k)
        drawn.append(f'<path class="grid" d="M{x:.1f} {y:.1f}H{WIDTH - RIGHT}"/>')
        drawn.append(f'<text x="{x - 8:.1f}" y="{y + 4:.1f}" text-anchor="end">{10.0**k:g}</text>')
    ends = []
    for line, colour in zip(lines, COLOURS, strict=False):
        spots = [place(x, y) for x, y in line.points]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in spots)
        drawn.append(f'<path class="line" stroke="{colour}" d="M{path}"/>')
        drawn += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{colour}"/>' for x, y in spots]
        ends.append((spots[-1][1], line.name, colour))
    lowest = -1e9
    for y, name, colour in sorted(ends):
        lowest = max(y + 4, lowest + APART)
        text = f'<text x="{WIDTH - RIGHT + 10}" y="{lowest:.1f}" style="fill: {colour}">'
        drawn.append(f"{text}{escape(name)}</text>")
    return "\n".join([*drawn, "</svg>\n"])


def decades(values: Sequence[float]) -> list[int]:
    """Exponents of the powers of ten that enclose all values, at least two."""
    low, high = floor(log10(min(values))), ceil(log10(max(values)))
    return list(range(low, max(high, low + 1) + 1))
