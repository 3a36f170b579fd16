"""Irregular assemblies of the census of agreement: ten families, most of them small."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

import numpy as np
from random_bonded import random_bonded
from random_friction import random_assembly
from random_pushed import pushed_assembly
from random_turned import random_turned
from random_voronoi import random_voronoi

import kilter
from kilter.assembly import Assembly
from kilter.assembly.bricks.brick_assembly import assembly_of_bricks
from kilter.contact import contacts
from kilter.contact.contact_tolerances import GAP
from kilter.scenes.random_bricks import random_bricks

__all__ = ["FAMILIES", "census_assembly", "turn_of"]

AGAIN = 10_000
"""Step of the seeds of an assembly that is drawn again."""
FEW, MANY = 4, 12
"""Largest number of free parts of most assemblies, and of one of eight."""
FAMILIES = (
    *("arch", "pile", "wedge", "round", "voronoi"),
    *("squeezed", "bricks", "bonded", "open", "real"),
)
REAL: dict[str, dict[str, Any]] = {
    "compas_cra/A.json": {"ground": ["0", "1"]},
    "compas_cra/H.json": {"ground": ["0", "1"]},
    "compas_cra/cubes.json": {"ground": ["0"]},
    "compas_cra/type-a.json": {"ground": ["0", "1"]},
    "compas_cra/type-c.json": {"ground": ["0", "1"]},
    "stablelego/stair_19.json": {},
    "stablelego/stair_20.json": {},
    "stablelego/external_weight_good.json": {},
    "stablelego/external_weight_fail.json": {},
}
"""Real files and the options of reading them."""
SLOW_REAL: dict[str, dict[str, Any]] = {
    "compas_cra/bridge.json": {"ground": ["0"]},
    "learn2assemble/tetris-2": {"ground": ["0"]},
    "compas_cra/shelf-stable.json": {"ground": ["0"]},
    "cax-if/dm1-id-214.stp": {"floor": True},
    "cad/flange_coupling.step": {"floor": True},
    "compas_cra/curve-3-blocks.json": {"ground": ["0"]},
    "cad/one_plate.step": {"floor": True},
    "cax-if/as1-oc-214.stp": {"ground": ["plate"]},
}
"""Real files of which each is read in one of eight cases only."""


def census_assembly(family: str, seed: int, real: Path | None) -> Assembly | None:
    """The assembly of a family and a seed; None without the folder of real files.

    It is the first assembly with few free parts (`FEW`, `MANY`) of a sequence of seeds. One of
    eight has no friction: its ladder has a row with friction.
    """
    most = MANY if turn_of(seed) % 8 == 0 else FEW
    for k in range(1000):
        assembly = _drawn(family, seed + k * AGAIN, real)
        if assembly is None or family == "real":
            return assembly
        if _free_count(assembly) <= most:
            smooth = turn_of(seed) % 8 == 7 and family not in ("bonded", "bricks")
            return replace(assembly, friction=0.0, friction_pairs=()) if smooth else assembly
    raise ValueError(f"no small assembly of the family {family} for seed {seed}")


def turn_of(seed: int) -> int:
    """Number of the case within its family, if all families alternate."""
    return seed // len(FAMILIES)


def _free_count(assembly: Assembly) -> int:
    return sum(not part.grounded for part in assembly.parts)


def _drawn(family: str, seed: int, real: Path | None) -> Assembly | None:
    """The assembly of a family and a seed, of any size; None without the folder of real files."""
    random = np.random.default_rng([seed, 17])
    if family in ("arch", "pile", "wedge", "round"):
        return random_turned(family, seed)
    if family == "voronoi":
        return random_voronoi(seed)
    if family == "squeezed":
        return random_assembly(seed)[1]
    if family == "bricks":
        return assembly_of_bricks(random_bricks(int(random.integers(3, 14)), seed=seed))
    if family == "bonded":
        return random_bonded(seed).assembly
    if family == "open":
        return pushed_assembly(seed, _touching).drawn
    return None if real is None else _real(random, turn_of(seed), real)


def _touching(assembly: Assembly) -> tuple[Any, Any, Any]:
    found = contacts(assembly)
    gap = GAP * assembly.geometry.size[found.patch_parts].min(axis=1)
    return found.patch_parts, found.patch_normal, gap


def _real(random: np.random.Generator, turn: int, folder: Path) -> Assembly:
    """A real file with random friction, often with a further held part, or tilted by up to 20 deg.

    Files with bonds are not tilted, since bond forces do not turn with gravity.
    """
    files = SLOW_REAL if turn % 8 == 0 else REAL
    name = list(files)[(turn // 8 if turn % 8 == 0 else turn) % len(files)]
    options = {**files[name], "friction": float(random.choice([0.0, 0.05, 0.3, 0.84]))}
    assembly = kilter.load(folder / name, **options)
    free = [part.name for part in assembly.parts if not part.grounded]
    if len(free) > 1 and random.random() < 1 / 3:
        assembly = assembly.with_grounded(str(random.choice(free)))
    if random.random() < 0.5 or assembly.bonds:
        return assembly
    across = np.cross(assembly.down, random.normal(size=3))
    tilt = np.radians(random.uniform(0, 20))
    down = np.cos(tilt) * assembly.down + np.sin(tilt) * across / np.linalg.norm(across)
    return assembly.with_down(down)
