"""The drawing of the layers, from the import contract: ``python docs/build_architecture.py``.

Each row is a layer of the contract in pyproject.toml, each box a package or module with the
first line of its docstring. Below them stands the way of the data through the house.
"""

from __future__ import annotations

import ast
import re
import textwrap
import tomllib
from html import escape
from pathlib import Path

from kilter.tell.palette import RAMP, ROLES

ROOT = Path(__file__).resolve().parents[1]
PICTURE = ROOT / "docs" / "images" / "architecture.svg"
WIDTH, ROW, LEFT, GAP = 860, 50, 20, 10
WAY = ("file", "assembly", "contacts", "program", "verdict", "facts", "words")
HOMES = ("files", "assembly", "contact", "mechanics", "analysis", "tell", "tell, show")
INK, SOFT, PAPER, PALE, BOX, STEP = (
    ROLES[name].light for name in ("ink", "soft", "surface", "page", "stable", "unstable")
)
STYLE = f"""
  text {{ font-family: system-ui, sans-serif; fill: {INK} }}
  .box {{ fill: {PALE}; stroke: {BOX}; stroke-width: 1.2 }}
  .name {{ font-size: 15px; font-weight: 600 }}
  .line {{ font-size: 11.5px; fill: {SOFT} }}
  .step {{ fill: {RAMP[0]}; stroke: {STEP}; stroke-width: 1.2 }}
  .arrow {{ stroke: {SOFT}; stroke-width: 1.5; fill: none; marker-end: url(#tip) }}
"""


def layers() -> list[list[str]]:
    """The rooms of each layer, the highest first."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    [found] = [c for c in contracts if c["type"] == "layers" and "containers" not in c]
    return [re.split(r"\s*[|:]\s*", line.replace("kilter.", "")) for line in found["layers"]]


def question(room: str) -> str:
    """The first line of a room's docstring, as far as its first stop."""
    home = ROOT / "src" / "kilter" / room
    path = home / "__init__.py" if home.is_dir() else home.with_suffix(".py")
    said = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return re.split(r"(?<=\w)[.;](?:\s|$)", said.splitlines()[0])[0].replace("`", "")


def box(x: float, y: float, width: float, name: str, lines: list[str], kind: str) -> str:
    """A rounded box with a name and small lines below it."""
    middle = x + width / 2
    words = [
        f'<rect class="{kind}" x="{x:g}" y="{y:g}" width="{width:g}" height="{ROW - 8}" rx="6"/>',
        f'<text class="name" x="{middle:g}" y="{y + 17:g}" text-anchor="middle">{name}</text>',
    ]
    for k, line in enumerate(lines):
        words.append(
            f'<text class="line" x="{middle:g}" y="{y + 32 + 12 * k:g}" '
            f'text-anchor="middle">{escape(line)}</text>'
        )
    return "\n".join(words)


def drawing() -> str:
    """The whole picture as SVG."""
    rows, y = [], 12.0
    for rooms in layers():
        width = (WIDTH - 2 * LEFT - GAP * (len(rooms) - 1)) / len(rooms)
        for k, room in enumerate(rooms):
            said = textwrap.shorten(question(room), int(width / 5.7), placeholder=" ...")
            rows.append(box(LEFT + k * (width + GAP), y, width, room, [said], "box"))
        y += ROW
    y += 18
    rows.append(f'<text class="line" x="{LEFT}" y="{y:g}">how data flow:</text>')
    y += 8
    width = (WIDTH - 2 * LEFT - 22 * (len(WAY) - 1)) / len(WAY)
    for k, (step, home) in enumerate(zip(WAY, HOMES, strict=True)):
        x = LEFT + k * (width + 22)
        rows.append(box(x, y, width, step, [home], "step"))
        if k:
            rows.append(f'<path class="arrow" d="M{x - 21:g} {y + 21:g} h15"/>')
    tip = (
        '<marker id="tip" viewBox="0 0 8 8" refX="6" refY="4" markerWidth="6" markerHeight="6" '
        'orient="auto"><path d="M0 0 8 4 0 8z" '
        f'fill="{SOFT}"/></marker>'
    )
    height = y + ROW + 8
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:g}" role="img" '
        'aria-label="The layers of kilter, the highest first, and the way of the data">'
    )
    paper = f'<rect width="{WIDTH}" height="{height:g}" fill="{PAPER}"/>'
    return "\n".join([head, f"<style>{STYLE}</style><defs>{tip}</defs>", paper, *rows, "</svg>\n"])


if __name__ == "__main__":
    PICTURE.write_text(drawing(), encoding="utf-8")
