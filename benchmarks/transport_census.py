"""Census of carried accelerations: compares the limits of transport with `kilter.check`.

    python benchmarks/transport_census.py                    300 assemblies, 20 directions each
    python benchmarks/transport_census.py 60 --first 100     seeds 100 to 159
    python benchmarks/transport_census.py 60 --family stack  a single family
    python benchmarks/transport_census.py 40 --family cad    drawn CAD with friction 0.3 (slower)

Families: stack (boxes of random size, turn, density, friction, gravity), arch, pile, wedge, round
(`tests/scenes/random_turned.py`), voronoi (3D cells with shared faces); on request also cad
(`cad_assemblies.py`, with pairs that overlap or look fastened joined). Directions are random in
space. For each direction the limit of the acceleration is computed; then `check` of the assembly
that feels the acceleration must hold at (1 - 1e-3) of the limit and must not hold at (1 + 1e-3) of
it. For a quarter of the directions the carrier also turns, and the loads of the turn are given to
`check` part by part. Each case has a limit of 60 CPU s. Exit code 1 if there is a contradiction.
"""

from __future__ import annotations

import argparse
import collections
import dataclasses
import os
import signal
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

import numpy as np
from boxes_on_deck import random_stack
from random_turned import random_turned
from random_voronoi import random_voronoi

import kilter
from kilter.analysis.load_limit import Limit
from kilter.analysis.transport.carried_set import CarriedSet
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.contact import contacts
from kilter.errors import InputError
from kilter.mechanics.program import build_program

FAMILIES = ("stack", "arch", "pile", "wedge", "round", "voronoi")
NEAR = 1e-3
"""Distance of the tests from a limit, relative to the larger of the limit and `SMALL`."""
SMALL = 0.01
"""Limits below this are tested at an absolute distance [factor of 1 g]."""
LIMIT = 60.0
"""Limit of a case [CPU s]."""


class Cut(Exception):
    """A case reached its limit."""


def assembly_of(family: str, seed: int) -> kilter.Assembly:
    """A random assembly of a family."""
    if family == "stack":
        return random_stack(seed)
    if family == "voronoi":
        return random_voronoi(seed)
    if family == "cad":
        return drawn_cad(seed)
    return random_turned(family, seed)


def drawn_cad(seed: int) -> kilter.Assembly:
    """A drawn CAD assembly on its base, friction 0.3; pairs that overlap are joined."""
    from cad_assemblies import draw, write_drawn  # needs OCCT

    with tempfile.TemporaryDirectory() as folder:
        drawn = kilter.load(write_drawn(draw(seed), Path(folder) / "drawn.step"))
    parts = [
        dataclasses.replace(part, grounded=part.name.split("/")[-1] == "base")
        for part in drawn.parts
    ]
    assembly = dataclasses.replace(drawn, parts=parts, friction=0.3)
    return kilter.fastened(assembly, suggested=True, overlaps=True)


def motions(seed: int, count: int, planar: bool, size: float) -> list[CarrierMotion]:
    """Random motions of a carrier with accelerations of about 1 g."""
    rng = np.random.default_rng([seed, 38])
    result = []
    for k in range(count):
        along = rng.normal(size=3) * ([1, 0, 0.5] if planar else [1, 1, 0.5])
        along *= 9.81 / np.linalg.norm(along)
        if k % 4:
            result.append(CarrierMotion(along))
            continue
        spin, turn = rng.normal(size=(2, 3)) * ([0, 1, 0] if planar else [1, 1, 1])
        about = rng.normal(size=3) * size * ([1, 0, 1] if planar else [1, 1, 1])
        result.append(CarrierMotion(along, spin, turn, about))
    return result


def part_of(motion: CarrierMotion, share: float) -> CarrierMotion:
    """The motion with all accelerations multiplied by a share."""
    return CarrierMotion(
        share * np.asarray(motion.acceleration),
        np.sqrt(max(share, 0.0)) * np.asarray(motion.angular_velocity),
        share * np.asarray(motion.angular_acceleration),
        motion.about,
    )


def level_of(assembly: kilter.Assembly, motion: CarrierMotion) -> str | None:
    """The level that check reaches; None if it falls or is undecided."""
    verdict = kilter.check(carried_assembly(assembly, motion), require="equilibrium")
    return "open" if verdict.verdict == "undecided" else verdict.level


def case(family: str, seed: int, directions: int, counts: collections.Counter[str]) -> list[str]:
    """Compare a case; return its contradictions."""
    assembly = assembly_of(family, seed)
    touching = contacts(assembly)
    program = build_program(assembly, touching)
    carried = CarriedSet(program)
    wrong = []
    if touching.open_pairs:
        counts["with open pairs, left out"] += 1
        return []
    if kilter.check(assembly, contacts=touching, require="equilibrium").level is None:
        counts["falls at rest"] += 1
        return []
    size = float(np.median(program.radius))
    for k, motion in enumerate(motions(seed, directions, assembly.planar, size)):
        limit = carried.share(motion)
        if not isinstance(limit, Limit):
            counts[f"no limit: {limit.why}"] += 1
            continue
        if not np.isfinite(limit.value):
            counts["unlimited"] += 1
            sides = [(10.0, True)]
        else:
            away = NEAR * max(limit.value, SMALL)
            sides = [(limit.value - away, True), (limit.value + away, False)]
        for share, held in sides:
            if share < 0:
                continue
            try:
                level = level_of(assembly, part_of(motion, share))
            except InputError:
                counts["free fall"] += 1
                continue
            counts["turning" if motion.turns else "straight"] += 1
            if level == "open":
                counts["undecided by check"] += 1
            elif (level is not None) != held:
                wrong.append(f"{family} {seed} motion {k} at {share:.6g}: level {level}")
    return wrong


def _cut(*_: object) -> None:
    raise Cut


def main() -> int:
    """Run the census."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("count", nargs="?", type=int, default=300)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--family", choices=(*FAMILIES, "cad"))
    parser.add_argument("--directions", type=int, default=20)
    given = parser.parse_args()
    counts: collections.Counter[str] = collections.Counter()
    wrong: list[str] = []
    worst = (0.0, "")
    signal.signal(signal.SIGPROF, _cut)
    for seed in range(given.first, given.first + given.count):
        family = given.family or FAMILIES[seed % len(FAMILIES)]
        began = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, LIMIT)
        try:
            lines = case(family, seed, given.directions, counts)
        except Cut:
            counts["cut"] += 1
            lines = []
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        worst = max(worst, (time.process_time() - began, f"{family} {seed}"))
        counts[family] += 1
        for line in lines:
            print("CONTRADICTION", line, flush=True)
        wrong += lines
    for name, count in sorted(counts.items()):
        print(f"{count:7d}  {name}")
    print(f"worst case: {worst[0]:.1f} CPU s ({worst[1]})")
    print(f"{len(wrong)} contradictions")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
