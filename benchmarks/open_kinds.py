"""Census of contacts at curved faces that have no contact formula, by the surfaces that meet.

    python benchmarks/open_kinds.py FOLDER           all STEP files in a folder
    python benchmarks/open_kinds.py --seeds 300      300 assemblies of `cad_assemblies`
    python benchmarks/open_kinds.py FOLDER --seeds 300 --first 1000

For each pair of parts with such a contact, the command finds the faces at the point that the answer
states; further points of the pair are not examined. A point on several faces of a part lies on
their common edge or corner. A row of the table is a kind:
the features of both parts, and the reason why the pair is open. A pair that overlaps, or has
clearance, is open whatever its curved faces are; these pairs are counted apart. The columns are the
pairs of the kind that are open only for this reason, the other pairs, and the files.
"""

from __future__ import annotations

import argparse
import collections
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "files"))

import kilter
from kilter import Assembly, Tolerance
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import KINDS
from kilter.contact.common.contact_search import begin_search
from kilter.contact.common.distances import surface_distance
from kilter.contact.pair_findings import PairFindings, examine
from kilter.errors import KilterError

Array = NDArray[np.float64]
Kind = tuple[str, str, str]
"""Feature of one part, feature of the other part, reason."""
NO_FORMULA = "the two surfaces have no contact formula"
AT_AN_EDGE = "an edge or corner lies on a curved face or beside it"


@dataclass
class Count:
    """Pairs of a kind that are open only for this reason, other pairs, and their files."""

    alone: int = 0
    beside: int = 0
    files: set[str] = field(default_factory=set)


def step_files(folder: Path) -> list[Path]:
    """STEP files in a folder that no other STEP file of their folder refers to."""
    files = [path for path in sorted(folder.rglob("*")) if path.suffix.lower() in (".step", ".stp")]
    texts = {path: path.read_text(errors="replace") for path in files}
    referred = {
        path
        for path in files
        for other in files
        if other != path and other.parent == path.parent and f"'{path.name}'" in texts[other]
    }
    return [path for path in files if path not in referred]


def drawn_files(count: int, first: int, folder: Path) -> Iterator[Path]:
    """Write the STEP files of `count` random assemblies, from seed `first` on."""
    from cad_assemblies import draw
    from step_maker import write_step

    for seed in range(first, first + count):
        drawn = draw(seed)
        yield write_step(folder / f"seed-{seed}.step", drawn.tree, units=drawn.units)


def feature_at(geometry: Geometry, part: int, point: Array, reach: float) -> str:
    """Kinds of the faces of a part within `reach` of a point, joined by " and "."""
    span = slice(int(geometry.triangle_start[part]), int(geometry.triangle_start[part + 1]))
    corners = geometry.vertices[geometry.triangles[span]]
    surface = geometry.triangle_surface[span]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    near = (corners.min(axis=1) <= point + reach).all(axis=1)
    near &= (corners.max(axis=1) >= point - reach).all(axis=1)
    found: dict[tuple[float, ...], str] = {}
    for k in np.flatnonzero(near):
        if surface_distance(point[None], corners[k : k + 1])[0] <= reach:
            row = int(surface[k])
            key = (float(row),) if row >= 0 else (-1.0, *np.round(normal[k], 3).tolist())
            found[key] = _name(geometry, row)
    return " and ".join(sorted(found.values())) or "nothing"


def _name(geometry: Geometry, row: int) -> str:
    if row < 0:
        return "plane"
    hollow = bool(geometry.surfaces.hollow[row])
    return ("hollow " if hollow else "") + KINDS[geometry.surfaces.kind[row]]


def kinds_of(findings: PairFindings) -> dict[tuple[int, int], set[Kind]]:
    """Kinds of the unmodelled contacts at curved faces, by the point that each of them reports."""
    geometry = findings.search.geometry
    kinds: dict[tuple[int, int], set[Kind]] = collections.defaultdict(set)
    for contact in findings.sharp.unsupported:
        if contact.kind != "curved":
            continue
        a, b = contact.ends
        slack = float(geometry.slack[[a, b]].max())
        reach = 2 * slack + 2e-3 * float(geometry.size[[a, b]].min())
        point = np.array(contact.point)
        first, second = sorted(feature_at(geometry, part, point, reach) for part in (a, b))
        at_edge = " and " in first or " and " in second
        kinds[a, b].add((first, second, AT_AN_EDGE if at_edge else NO_FORMULA))
    return kinds


def add(counts: dict[Kind, Count], file: str, assembly: Assembly) -> str:
    """Add the kinds of an assembly to the counts; return the number of open pairs in words."""
    tolerance = Tolerance()
    search = begin_search(assembly, tolerance, lambda stage: None)
    findings = examine(assembly, search, tolerance)
    open_for = {frozenset(p.ends): p.kind for p in kilter.contacts(assembly).open_pairs}
    kinds = kinds_of(findings)
    for pair, of_pair in kinds.items():
        alone = open_for.get(frozenset(pair)) == "free-form"
        for kind in of_pair:
            counts[kind].alone += alone
            counts[kind].beside += not alone
            counts[kind].files.add(file)
    return f"{len(kinds)} of {len(search.pairs)} near pairs"


def main() -> int:
    """Print the table of kinds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--seeds", type=int, default=0, help="number of drawn assemblies")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    options = parser.parse_args()
    counts: dict[Kind, Count] = collections.defaultdict(Count)
    read = faults = 0
    with tempfile.TemporaryDirectory() as scratch:
        given = step_files(options.folder) if options.folder else []
        drawn = drawn_files(options.seeds, options.first, Path(scratch))
        for file in (*given, *drawn):
            try:
                words = add(counts, file.stem, kilter.load(file))
            except KilterError as error:
                faults += 1
                print(f"{file.name}: {str(error).splitlines()[0][:100]}", flush=True)
                continue
            read += 1
            if options.folder and file in given:
                print(f"{file.name}: {words}", flush=True)
    print(f"\n{read} files, {faults} that kilter rejects\n")
    print(" alone  beside  files  kind")
    order = sorted(counts.items(), key=lambda row: (-row[1].alone, -row[1].beside, row[0]))
    for (first, second, reason), count in order:
        names = ", ".join(sorted(count.files)[:4]) + (", ..." if len(count.files) > 4 else "")
        print(f"{count.alone:6d}  {count.beside:6d}  {len(count.files):5d}  ", end="")
        print(f"{first} | {second}: {reason} ({names})")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
