"""Write docs/contributing/growth.md from `benchmarks/growth.csv`: ``python docs/build_growth.py``.

`python benchmarks/growth.py --output benchmarks/growth.csv` adds rows; the last row of a
cell counts.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks/growth.csv"
PAGE = ROOT / "docs/contributing/growth.md"
sys.path.append(str(ROOT / "benchmarks"))
TITLES = {
    "wall": "Running-bond walls",
    "boxes": "Boxes that stand apart on a table, friction 0.5",
    "pile": "Piles of boxes",
    "frames": "Bolted frames in STEP; the rows contain the contacts",
    "scene": "Stacks of objects on a table, in MJCF",
}
HEAD = """# Growth with the number of parts

CPU seconds of each command on one core, and in brackets the largest memory [GiB], by the number of
parts. The seconds exclude imports and the reading of the file. The last column is the exponent p of
seconds = c n^p over the cells of at least 0.1 s. `>` marks a cell that was ended at its limit, and
`-` a cell that was not measured. All cells are of version aa9fcdce, measured two at a time on two
busy cores: the median cell of a command that did not change took 1.85 times as long as in the run
before (version b163eb87). `plan` of frames joins what looks fastened (`--assume fits`), since the
nuts fall as drawn.

`python benchmarks/growth.py` measures, and `python docs/build_growth.py` writes this page from
`benchmarks/growth.csv`.
"""


def page() -> str:
    """The text of the page."""
    import growth  # the benchmark, in the folder of benchmarks

    cells: dict[str, dict[str, dict[int, dict[str, object]]]] = {}
    with RESULTS.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            code = row["code"] if row["code"] in (growth.OVER, growth.WRONG) else int(row["code"])
            cell = {key: float(row[key]) if row[key] else None for key in ("seconds", "peak")}
            family = cells.setdefault(row["family"], {}).setdefault(row["command"], {})
            family[int(row["parts"])] = {**cell, "code": code}
    text = [HEAD]
    for family, title in TITLES.items():
        commands = cells.get(family, {})
        sizes = sorted({size for row in commands.values() for size in row})
        if not sizes:
            continue
        text += [f"\n## {title}\n", "| command | " + " | ".join(f"{n:,}" for n in sizes) + " | p |"]
        text.append("|---|" + "--:|" * (len(sizes) + 1))
        for name, row in commands.items():
            slope = growth.exponent(row.items())
            figures = [growth.figure(row[n]) if n in row else "-" for n in sizes]
            figures.append("-" if slope is None else f"{slope:.2f}")
            text.append(f"| {name} | " + " | ".join(figures) + " |")
    return "\n".join(text) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
