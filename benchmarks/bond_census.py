"""Random bonded blocks against a program written apart: which share of their strength bonds need.

    python benchmarks/bond_census.py                       300 assemblies
    python benchmarks/bond_census.py 500 --seed 1000       as many, from a seed on
    python benchmarks/bond_census.py 500 --limit 60        seconds of the processor for each

The assemblies are those of `tests/scenes/random_bonded.py`. Nothing of kilter but masses is used on
the other side: where blocks touch follows from their sizes, a stress acts at the middle of a
rectangle, friction lies in pyramids inside and around Coulomb's cone, and linprog says the least
share. Asked are: contacts; verdict and share; verdicts on both sides of the share; that proofs are
verified; that no bond is used beyond its strength; that no margin fails. The command ends with 1
where they disagree.
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
"""Sides of a pyramid: the two differ by half a hundredth."""
BESIDE = 1e-3
"""Verdicts are asked at the share found less and more by this [-]."""
NEAR = 1e-6
"""Up to which two shares are one, over 1 and them [-]."""

# the program written apart ------------------------------------------------------------------


@dataclass(frozen=True)
class Point:
    """A point where two blocks press or pull: whether any shear is borne there, and friction."""

    parts: tuple[int, int]
    place: Array
    normal: Array
    tied: bool
    mu: float


Pull = tuple[tuple[int, int], Array, Array]
"""Two blocks, a place, and the force on the second."""


def apart(scene: Bonded) -> tuple[list[Point], list[Pull]]:
    """Points of force, and the pulls of full strength."""
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
    """Whether it bears shear of any size: as the page on bonds says."""
    return bond.shear is None and bond.kind not in ("mortar", "magnet", "suction")


def least_share(scene: Bonded, stretch: float) -> float:
    """The least share, infinite where none is enough; pyramids of `stretch` times the radius."""
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
    for method in ("highs", "highs-ipm"):  # the second where the numbers of the first end it
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


# what kilter says ---------------------------------------------------------------------------


def with_share(assembly: Assembly, share: float) -> Assembly:
    """The assembly with a share of the strength of all bonds."""
    return dataclasses.replace(assembly, bonds=[one.with_strength(share) for one in assembly.bonds])


def other_contacts(scene: Bonded, contacts: ContactSet) -> list[str]:
    """What of the contacts is not as the sizes of the blocks say."""
    found = contacts.patch_kind != "bond"
    pairs = {frozenset(pair) for pair in contacts.patch_parts[found].tolist()}
    wrong = [] if pairs == {frozenset(one.parts) for one in scene.touches} else ["other pairs"]
    area, known = contacts.patch_area[found].sum(), sum(one.area for one in scene.touches)
    return wrong + ([] if abs(area - known) <= 1e-9 * known else [f"area {area}, not {known}"])


def judged(scene: Bonded) -> tuple[str, list[str]]:
    """An answer in a word, and what disagrees."""
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
        if margin.verdict.verdict not in ("unstable", "undecided"):
            wrong.append(f"{margin.verdict.verdict}, and no share is enough")
        return "no share is enough", wrong
    if why is not None:
        return "no share", wrong
    share = margin.bond.value
    if not least - NEAR * max(1.0, least) <= share <= most + NEAR * max(1.0, most):
        wrong.append(f"share {share}, not {least} to {most}")
    if share and not verified(assembly, margin):
        wrong.append("the proof of margin is refused")
    if share == 0:
        return "none needed", wrong + otherwise(assembly, contacts, {1.0: True, 0.0: True})
    asked = {1.0: share < 1, share * (1 - BESIDE): False, share * (1 + BESIDE): True}
    return ("falls" if share > 1 else "stands"), wrong + otherwise(assembly, contacts, asked)


def otherwise(assembly: Assembly, contacts: ContactSet, asked: dict[float, bool]) -> list[str]:
    """What check says otherwise at shares at which it holds, or does not."""
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
    """Whether the proof of an answer is verified as it is read back."""
    return kilter.verify(assembly, json.loads(json.dumps(answer.proof()))).holds


def asked(seed: int) -> tuple[str, list[str]]:
    """Of what kind a scene is and what is said of it, and what disagrees."""
    one = random_bonded(seed)
    answer, wrong = judged(one)
    rough = "smooth" if one.assembly.friction == 0 else "friction"
    where = "plane" if one.assembly.planar else "space"
    return f"{one.family}, {where}, {rough}: {answer}", wrong


def main() -> int:
    """Ask them all; 1 where something disagrees."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("assemblies", nargs="?", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0, help="the first")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for each")
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
    """Leave a case that takes too long."""
    raise TimeoutError


if __name__ == "__main__":
    raise SystemExit(main())
