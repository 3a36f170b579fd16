"""Census of random bonded blocks: compares the least share of bond strength with linprog.

    python benchmarks/bond_census.py                       300 assemblies
    python benchmarks/bond_census.py 500 --seed 1000       500 assemblies, from seed 1000 on
    python benchmarks/bond_census.py 500 --limit 60        CPU time limit for each [s]

The assemblies are those of `tests/scenes/random_bonded.py`. The independent program uses only the
masses from kilter. Contacts follow from the sizes of the blocks, a stress acts at the middle of
its rectangle, and friction is in pyramids inside and around Coulomb's cone. linprog computes the
least share. The census compares contacts, verdict and share, and verdicts on both sides of the
share. It tests that all proofs are verified, that no bond exceeds its strength, and that no margin
fails. The exit code is 1 if there is a contradiction.
"""

from __future__ import annotations

import argparse
import collections
import dataclasses
import json
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import linprog

import kilter
from kilter import Assembly, Bond
from kilter.arrays import Array
from kilter.contact import ContactSet

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from random_bonded import Bonded, random_bonded

SIDES = 32
"""Sides of the friction pyramids; the inner and the outer pyramid differ by 0.5 %."""
BESIDE = 1e-3
"""Verdicts are tested at the least share times 1 - BESIDE and 1 + BESIDE [-]."""
NEAR = 1e-6
"""Largest difference of equal shares, relative to the larger of 1 and the share [-]."""

# independent program ------------------------------------------------------------------------


@dataclass(frozen=True)
class Point:
    """A point of force between two blocks; `tied`: whether it bears any shear."""

    parts: tuple[int, int]
    place: Array
    normal: Array
    tied: bool
    mu: float


Pull = tuple[tuple[int, int], Array, Array]
"""Two blocks, a point, and the force on the second block."""


def apart(scene: Bonded) -> tuple[list[Point], list[Pull]]:
    """Points of force between the blocks, and the pulls of the bonds at full strength."""
    assembly, turn = scene.assembly, scene.turn
    mus = {frozenset(pair.parts): pair.mu for pair in assembly.friction_pairs}
    points: list[Point] = []
    pulls: list[Pull] = []
    for touch in scene.touches:
        names = frozenset(f"p{k}" for k in touch.parts)
        mu, normal = mus.get(names, assembly.friction), turn.matrix[:, touch.axis]
        middle, corners = turn.apply(touch.corners.mean(axis=0)), turn.apply(touch.corners)
        bonds = [bond for bond in assembly.bonds if frozenset(bond.parts) == names]
        tied = any(any_shear(bond) for bond in bonds if bond.points is None)
        points += [Point(touch.parts, corner, normal, tied, mu) for corner in corners]
        for bond in bonds:
            if bond.points is not None:
                own = any_shear(bond)
                points += [Point(touch.parts, point, normal, own, mu) for point in bond.points]
            if bond.pull_per_area is not None:
                pulls.append((touch.parts, middle, -bond.pull_per_area * touch.area * normal))
                continue
            places = corners if bond.points is None else bond.points
            pulls += [(touch.parts, place, -bond.pull * normal) for place in places]
    return points, pulls


def any_shear(bond: Bond) -> bool:
    """Whether a bond bears shear of any size, as defined on the page about bonds."""
    return bond.shear is None and bond.kind not in ("mortar", "magnet", "suction")


def least_share(scene: Bonded, stretch: float) -> float:
    """Least share of the bond strength with equilibrium; infinite if no share is enough.

    `stretch`: factor on the radius of the friction pyramids.
    """
    assembly, geometry = scene.assembly, scene.assembly.geometry
    count = len(assembly.parts)
    length = float(np.ptp(geometry.center, axis=0).max()) + 1.0
    kept = [0, 2, 4] if assembly.planar else list(range(6))

    def wrench(parts: tuple[int, int], place: Array, force: Array) -> Array:
        column = np.zeros((count, 6))
        for part, sign in zip(parts, (-1.0, 1.0), strict=True):
            arm = (place - geometry.center[part]) / length
            column[part] += sign * np.append(force, np.cross(arm, force))
        return column[1:, kept].ravel()

    points, pulls = apart(scene)
    columns, low = [], []
    angle = 2 * np.pi * (np.arange(SIDES) + 0.5) / SIDES
    for point in points:
        u, v = np.linalg.svd(point.normal[None])[2][1:]
        around = np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)
        rays, ends = point.normal + point.mu * stretch * around, [0.0] * SIDES
        if point.tied:
            rays, ends = np.array([point.normal, u, v]), [0.0, -np.inf, -np.inf]
        columns += [wrench(point.parts, point.place, ray) for ray in rays]
        low += ends
    clamp = sum((wrench(*pull) for pull in pulls), np.zeros(len(columns[0])))
    load = np.zeros((count, 6))
    load[:, :3] = geometry.mass[:, None] * assembly.gravity
    for one in assembly.loads:
        load[assembly.index_of(one.part), :3] += one.force
    weight = float(np.abs(load[1:, :3]).sum())
    for method in ("highs", "highs-ipm"):  # the second if the first fails numerically
        answer = linprog(
            np.append(np.zeros(len(columns)), 1.0),
            A_eq=np.column_stack([*columns, clamp / weight]),
            b_eq=-load[1:, kept].ravel() / weight,
            bounds=[*((end, None) for end in low), (0, None)],
            method=method,
        )
        if answer.status in (0, 2):
            return np.inf if answer.status else float(answer.x[-1])
    raise ArithmeticError(answer.message)


# comparison with kilter ---------------------------------------------------------------------


def with_share(assembly: Assembly, share: float) -> Assembly:
    """The assembly with a share of the strength of all bonds."""
    return dataclasses.replace(assembly, bonds=[one.with_strength(share) for one in assembly.bonds])


def other_contacts(scene: Bonded, contacts: ContactSet) -> list[str]:
    """Differences between the detected contacts and those from the sizes of the blocks."""
    found = contacts.patch_kind != "bond"
    pairs = {frozenset(pair) for pair in contacts.patch_parts[found].tolist()}
    wrong = [] if pairs == {frozenset(one.parts) for one in scene.touches} else ["other pairs"]
    area, known = contacts.patch_area[found].sum(), sum(one.area for one in scene.touches)
    return wrong + ([] if abs(area - known) <= 1e-9 * known else [f"area {area}, not {known}"])


def judged(scene: Bonded) -> tuple[str, list[str]]:
    """Kind of the answer, and contradictions."""
    assembly = scene.assembly
    contacts = kilter.contacts(assembly)
    wrong = other_contacts(scene, contacts)
    margin = kilter.margin(assembly, contacts=contacts, pushed=[], effort=0)
    if not assembly.bonds:
        return "no bonds", wrong
    most, least = least_share(scene, 1.0), least_share(scene, 1 / np.cos(np.pi / SIDES))
    wrong += [f"margin has no {what}" for what, why in margin.missing.items() if why == "failed"]
    why = margin.missing.get("bond")
    if why == "none":
        if np.isfinite(most):
            wrong.append(f"no share is enough, not {most}")
        if margin.verdict not in ("unstable", "undecided"):
            wrong.append(f"{margin.verdict}, and no share is enough")
        return "no share is enough", wrong
    if why is not None:
        return "no share", wrong
    share = margin.bond_limit.value
    if not least - NEAR * max(1.0, least) <= share <= most + NEAR * max(1.0, most):
        wrong.append(f"share {share}, not {least} to {most}")
    if share and not verified(assembly, margin):
        wrong.append("the proof of margin is refused")
    if share == 0:
        return "none needed", wrong + otherwise(assembly, contacts, {1.0: True, 0.0: True})
    asked = {1.0: share < 1, share * (1 - BESIDE): False, share * (1 + BESIDE): True}
    return ("falls" if share > 1 else "stands"), wrong + otherwise(assembly, contacts, asked)


def otherwise(assembly: Assembly, contacts: ContactSet, asked: dict[float, bool]) -> list[str]:
    """Contradictions of `check` at shares with a known answer; `asked` maps share to answer."""
    wrong = []
    for share, holds in asked.items():
        one = with_share(assembly, share)
        verdict = kilter.check(one, contacts=contacts.of(one), effort=0)
        if verdict.verdict == "undecided" or (verdict.verdict != "unstable") is not holds:
            wrong.append(f"{verdict.verdict} at {share}")
        if not verified(one, verdict):
            wrong.append(f"the proof at {share} is refused")
        patches = verdict.to_dict()["forces"]["patches"] if holds else []
        used = [patch.get("bond_utilisation") or 0.0 for patch in patches]
        if max(used, default=0.0) > 1 + NEAR:
            wrong.append(f"a bond is used to {max(used)} at {share}")
    return wrong


def verified(assembly: Assembly, answer: Any) -> bool:
    """Whether the proof of an answer is verified after a round trip through JSON."""
    return kilter.verify(assembly, json.loads(json.dumps(answer.proof()))).holds


def asked(seed: int) -> tuple[str, list[str]]:
    """Kind of a random scene with its answer, and contradictions."""
    one = random_bonded(seed)
    answer, wrong = judged(one)
    rough = "smooth" if one.assembly.friction == 0 else "friction"
    where = "plane" if one.assembly.planar else "space"
    return f"{one.family}, {where}, {rough}: {answer}", wrong


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("assemblies", nargs="?", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0, help="first seed")
    parser.add_argument("--limit", type=float, default=60.0, help="CPU seconds for each assembly")
    chosen = parser.parse_args()
    answers: collections.Counter[str] = collections.Counter()
    begun, disagree = time.process_time(), 0
    signal.signal(signal.SIGVTALRM, stop)
    for seed in range(chosen.seed, chosen.seed + chosen.assemblies):
        signal.setitimer(signal.ITIMER_VIRTUAL, chosen.limit)
        try:
            answer, wrong = asked(seed)
        except TimeoutError:
            answer, wrong = "none", [f"not ended after {chosen.limit:g} s"]
        except ArithmeticError:
            answer, wrong = "linprog has no answer", []
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        answers[answer] += 1
        disagree += bool(wrong)
        for word in wrong:
            print(f"seed {seed} ({answer}): {word}", flush=True)
    for answer, number in sorted(answers.items()):
        print(f"{number:5d}  {answer}")
    print(f"{time.process_time() - begun:.0f} s of the processor")
    print(f"{disagree} disagree" if disagree else "nothing disagrees")
    return 1 if disagree else 0


def stop(*_: object) -> None:
    """Signal handler that ends a case at its time limit."""
    raise TimeoutError


if __name__ == "__main__":
    raise SystemExit(main())
