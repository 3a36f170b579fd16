"""Random assemblies as engineers draw them in CAD, written as STEP files, with a known outcome.

An assembly is a base plate with one to seven modules: bolted stacks, flanges, press fits, inserts,
bearings, dovetails, keys, tabs in slots, snaps, threads, and so on. The drawing has the usual
properties of such files: clearances, cosmetic or interfering threads, fillets and chamfers,
engraved text, nested and mirrored sub-assemblies, mixed units, bodies drawn twice, variants drawn
over each other, misplaced copies.

The outcome is known by construction. `Drawn.joined` are the pairs that a designer would call
joined. `Drawn.falls` are the parts that fall although these pairs are joined; the assembly holds if
there are none. OCCT makes all solids; lengths are mm inside this module.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
from cad_machine_modules import ball_bearing, cabinet, flange, snap_cover, threaded
from cad_modules import (
    Drawn,
    Module,
    Site,
    ball_seat,
    bearing,
    bolted_stack,
    dovetail,
    insert,
    key,
    lid,
    o_ring,
    press_fit,
    tabs,
)
from cad_solids import box, eased, engraved_text, mirrored, placed, scaled

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "files"))

from step_maker import write_step

__all__ = ["MODULES", "Drawn", "draw", "write_drawn"]

UNITS = ("mm", "mm", "mm", "in", "m")
"""Units of the files; millimetres are the most frequent."""
INCH = 25.4
"""Length of an inch [mm]."""
MODULES: tuple[Module, ...] = (
    bolted_stack,
    bolted_stack,
    flange,
    press_fit,
    insert,
    bearing,
    ball_bearing,
    threaded,
    dovetail,
    key,
    tabs,
    cabinet,
    lid,
    snap_cover,
    ball_seat,
    o_ring,
)
"""The modules; a bolted stack is twice as frequent."""
SITES = [(x, y) for y in (-50.0, 0.0, 50.0) for x in (-50.0, 0.0, 50.0)]
"""Middles of the sites on the base [mm]."""
FAR = 110.0
"""The plane of this x mirrors a sub-assembly [mm]."""
MOST = 40
"""Largest number of solids in an assembly."""


# flaws of a drawing -----------------------------------------------------------------------


def _some_part(rng: np.random.Generator, drawn: Drawn) -> tuple[str, Any, Any]:
    """A random part beside the base."""
    return drawn.tree[int(rng.integers(1, len(drawn.tree)))]


def _drawn_twice(rng: np.random.Generator, drawn: Drawn) -> None:
    """Add a copy of a part in the same place."""
    name, solid, place = _some_part(rng, drawn)
    drawn.tree.append((f"{name}_copy", placed(solid, place), None))
    drawn.joined.append((f"{name}_copy", name))
    if any(fall == name or fall.startswith(f"{name}_") for fall in drawn.falls):
        drawn.falls.add(f"{name}_copy")
    drawn.kinds.append("drawn twice")


def _hidden_variant(rng: np.random.Generator, drawn: Drawn) -> None:
    """Add a box with a foot on the base, and a hidden second variant of it in the same place."""
    low, high = float(rng.uniform(5, 15)), float(rng.uniform(16, 30))
    drawn.add("block", box((-6, -6, 0), (6, 6, low)), (-85.0, -85.0, 0.0))
    drawn.add("block_long", box((-6, -6, 0), (6, 6, high)), (-85.0, -85.0, 0.0))
    drawn.joined.append(("block_long", "block"))
    drawn.kinds.append("hidden variant")


def _misplaced(rng: np.random.Generator, drawn: Drawn) -> None:
    """Add two equal blocks on the base; one is sunk, shifted or raised by 0.1 to 10 mm."""
    step = float(10 ** rng.uniform(-1, 1))
    how = str(rng.choice(["sunk", "shifted", "raised"]))
    solid = box((0, 0, 0), (12, 12, 12))
    move = {"sunk": (0.0, 0.0, -min(step, 9.0)), "shifted": (step, 0.3 * step, 0.0)}
    drawn.add("post", solid, (70.0, 75.0, 0.0))
    x, y, z = move.get(how, (0.0, 0.0, step))
    drawn.add("post", solid, (-20.0 + x, 75.0 + y, z))
    if how == "sunk":
        drawn.joined.append(("post_2", "base"))
    elif how == "raised":
        drawn.falls.add("post_2")
    drawn.kinds.append(f"misplaced: {how}")


def _nested(drawn: Drawn) -> dict[str, list[tuple[str, Any, Any]]]:
    """Put the parts of each site into a sub-assembly; return the parts by site."""
    groups: dict[str, list[tuple[str, Any, Any]]] = {}
    top = []
    for node in drawn.tree:
        site = node[0].split("_")[0]
        if re.fullmatch(r"m\d+", site):
            groups.setdefault(site, []).append(node)
        else:
            top.append(node)
    drawn.tree = top + [(f"unit_{site}", nodes, None) for site, nodes in groups.items()]
    drawn.kinds.append("nested")
    return groups


def _mirrored_unit(
    rng: np.random.Generator, drawn: Drawn, groups: dict[str, list[tuple[str, Any, Any]]]
) -> None:
    """Add the mirror image of a sub-assembly on the far side of the base, one level deeper."""
    site = str(rng.choice(sorted(groups)))
    nodes = []
    for name, solid, at in groups[site]:
        if name in drawn.inches:  # its numbers are inches, and those of the image millimetres
            solid = scaled(solid, INCH)
        nodes.append((name, mirrored(placed(solid, at), FAR), None))
    drawn.tree.append(("far_side", [(f"unit_{site}", nodes, None)], None))
    own = {name for name in drawn.falls if name.split("_")[0] == site}
    drawn.falls -= own
    drawn.falls |= {f"{above}unit_{site}/{name}" for name in own for above in ("", "far_side/")}
    drawn.kinds.append("mirrored sub-assembly")


def draw(seed: int) -> Drawn:
    """The random assembly of a seed."""
    rng = np.random.default_rng(seed)
    drawn = Drawn(units=str(rng.choice(UNITS)))
    far = rng.random() < 0.15
    base = box((-100, -100, -10), (2 * FAR + 100 if far else 100, 100, 0))
    drawn.add("base", eased(engraved_text(base, "TOP", (-95, 85, 0), 8.0, 0.3), rng, 1.0))
    count = int(rng.integers(1, 8))
    for k, place in enumerate(rng.permutation(len(SITES))[:count].tolist()):
        before = len(drawn.tree)
        module = MODULES[int(rng.integers(len(MODULES)))]
        module(rng, drawn, Site(*SITES[place], 0.0, f"m{k}"))
        if len(drawn.tree) > MOST // 2 or len(drawn.tree) + len(drawn.tree) - before > MOST:
            break
    for chance, flaw in ((0.1, _drawn_twice), (0.1, _hidden_variant), (0.15, _misplaced)):
        if rng.random() < chance:
            flaw(rng, drawn)
    if drawn.units == "mm" and rng.random() < 0.2:
        _mixed_units(rng, drawn)
    if far or rng.random() < 0.4:
        groups = _nested(drawn)
        if far:
            _mirrored_unit(rng, drawn, groups)
    drawn.tree = [("product", drawn.tree, None)]  # a root product has no placement of its own
    return drawn


# files ------------------------------------------------------------------------------------


def _mixed_units(rng: np.random.Generator, drawn: Drawn) -> None:
    """State the lengths of one product in inches."""
    solids = [id(solid) for _, solid, _ in drawn.tree]
    alone = [k for k in range(1, len(solids)) if solids.count(solids[k]) == 1]
    k = alone[int(rng.integers(len(alone)))]
    name, solid, place = drawn.tree[k]
    drawn.tree[k] = (name, scaled(solid, 1 / INCH), place)
    drawn.inches.append(name)
    drawn.kinds.append("mixed units")


def write_drawn(drawn: Drawn, path: Path) -> Path:
    """Write a drawing as a STEP file; the text of products in inches gets that unit."""
    write_step(path, drawn.tree, units=drawn.units)
    text = path.read_text()
    for name in drawn.inches:
        text = _in_inches(text, name)
    path.write_text(text)
    return path


def _in_inches(text: str, name: str) -> str:
    """The text of a STEP file after the unit of the product `name` became the inch."""
    lines = dict(re.findall(r"(#\d+)\s*=\s*(.*?);\s*\n", text, re.DOTALL))

    def user(entity: str, of: str) -> str:
        return next(k for k, v in lines.items() if v.startswith(f"{entity}(") and of_in(of, v))

    def of_in(reference: str, value: str) -> bool:
        return re.search(rf"{reference}\b", value) is not None

    product = next(k for k, v in lines.items() if v.startswith(f"PRODUCT('{name}'"))
    formation = user("PRODUCT_DEFINITION_FORMATION", product)
    definition = user("PRODUCT_DEFINITION", formation)
    shape = user("PRODUCT_DEFINITION_SHAPE", definition)
    representation = re.findall(r"#\d+", lines[user("SHAPE_DEFINITION_REPRESENTATION", shape)])[1]
    context = re.findall(r"#\d+", lines[representation])[-1]
    units = re.search(r"GLOBAL_UNIT_ASSIGNED_CONTEXT\(\s*\(([^)]*)\)", lines[context])
    millimetre = units[1].split(",")[0].strip()
    first = max(int(key[1:]) for key in lines) + 1
    inch, measure, size = (f"#{first + k}" for k in range(3))
    added = (
        f"{size} = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
        f"{measure} = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({INCH}),{millimetre});\n"
        f"{inch} = (CONVERSION_BASED_UNIT('INCH',{measure}) LENGTH_UNIT() NAMED_UNIT({size}));\n"
    )
    changed = lines[context].replace(units[0], units[0].replace(millimetre, inch, 1))
    text = text.replace(lines[context], changed, 1)
    return text.replace("ENDSEC;\nEND-ISO", f"{added}ENDSEC;\nEND-ISO")
