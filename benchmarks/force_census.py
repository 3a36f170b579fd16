"""Census of ranges of forces and of moving supports, against a conic program on rows built anew.

    python benchmarks/force_census.py 200

The census computes three ranges of each irregular assembly (arches, piles, wedges, squeezed blocks,
Voronoi cells): the normal force of a pair, the force of a pair along an axis, and the force on a
held part. The second program has the exact friction cones: Clarabel finds the least and the
greatest value over forces at the contact points. Their balance is written here from points, normals
and weights.
Then the held parts of every second assembly move a little: the released energy and the least work
agree, no contact closes, and none opens and carries if the answer is called exact. The exit code is
1 if anything disagrees.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import clarabel
import numpy as np
from agreement_assemblies import census_assembly
from numpy.typing import NDArray
from scipy.sparse import csc_array, vstack

import kilter
from kilter.errors import KilterError
from kilter.mechanics.program import build_program
from kilter.mechanics.rows import CONTACT

Array = NDArray[np.float64]
FAMILIES = ("arch", "pile", "wedge", "squeezed", "voronoi")
AGREES = 2e-7
"""Largest difference of both programs [weight of the parts]: the accuracy of Clarabel here."""
MOVEMENT = 1e-3
"""Size of a movement of a support [size of the smallest free part]."""


def second_range(program: Any, gain: Array) -> tuple[float, float]:
    """Least and greatest value of gain.f, shape (K, 3), by a program with exact cones."""
    free = np.flatnonzero(program.free)
    column = np.full(len(program.names), -1)
    column[free] = np.arange(len(free))
    count = len(program.part_a)
    balance = np.zeros((6 * len(free), 3 * count))
    for k in range(count):
        for part, sign in ((program.part_b[k], 1.0), (program.part_a[k], -1.0)):
            if part < 0 or column[part] < 0:
                continue
            arm = program.point[k] - program.center[part]
            turned = np.array([np.cross(arm, axis) for axis in np.eye(3)]).T
            row = 6 * column[part]
            balance[row : row + 3, 3 * k : 3 * k + 3] += sign * np.eye(3)
            balance[row + 3 : row + 6, 3 * k : 3 * k + 3] += sign * turned / program.radius[part]
    load = program.load[free].copy()
    load[:, 3:] /= program.radius[free][:, None]
    weight = float(program.weight[free].sum())
    cones, rows = [clarabel.ZeroConeT(6 * len(free))], []
    for k in range(count):
        n, mu = program.normal[k], float(program.mu[k])
        across = np.linalg.svd(n[None])[2][1:]
        block = np.zeros((3, 3 * count))
        block[0, 3 * k : 3 * k + 3] = mu * n if mu > 0 else n
        block[1:, 3 * k : 3 * k + 3] = across
        rows.append(-block)
        cones += (
            [clarabel.SecondOrderConeT(3)]
            if mu > 0
            else [clarabel.NonnegativeConeT(1), clarabel.ZeroConeT(2)]
        )
    if program.planar:  # nothing acts across the plane, and nothing turns out of it
        balance = balance.reshape(-1, 6, 3 * count)[:, [0, 2, 4]].reshape(-1, 3 * count)
        load = load[:, [0, 2, 4]]
        rows.append(np.kron(np.eye(count), [[0.0, 1.0, 0.0]]))
        cones.append(clarabel.ZeroConeT(count))
        cones[0] = clarabel.ZeroConeT(len(balance))
    matrix = csc_array(vstack([csc_array(balance), *map(csc_array, rows)]))
    right = np.concatenate([-load.reshape(-1) / weight, np.zeros(matrix.shape[0] - load.size)])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    ends = []
    for sense in (1.0, -1.0):
        cost = sense * gain.reshape(-1)
        empty = csc_array((3 * count, 3 * count))
        found = clarabel.DefaultSolver(empty, cost, matrix, right, cones, settings).solve()
        if "DualInfeasible" in str(found.status):
            ends.append(-sense * np.inf)
        elif "Solved" in str(found.status):
            ends.append(sense * found.obj_val * weight)
        else:
            ends.append(np.nan)
    return ends[0], ends[1]


def compared(verdict: Any, program: Any, random: np.random.Generator) -> list[str]:
    """Disagreements of three ranges of an assembly."""
    pairs = np.unique(np.column_stack([program.part_a, program.part_b]), axis=0)
    pairs = pairs[program.free[pairs].any(axis=1)]
    held = np.unique(pairs[~program.free[pairs]])
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    first, second = pairs[random.integers(len(pairs), size=2)]
    support = int(held[random.integers(len(held))])
    weight = float(program.weight[program.free].sum())
    wrong = []
    for parts, along in ((first, None), (second, axis), ([support], np.array([0.0, 0, 1]))):
        names = [program.names[part] for part in parts]
        (one,) = verdict.force_ranges([names if len(names) > 1 else names[0]], along)
        if len(parts) > 1:
            chosen = (program.part_a == parts[0]) & (program.part_b == parts[1])
            sign = np.ones(len(chosen))
        else:
            chosen = (program.part_a == support) | (program.part_b == support)
            sign = np.where(program.part_b == support, 1.0, -1.0)
        vectors = program.normal if along is None else sign[:, None] * along
        # forces between held parts are not determined
        chosen &= program.free[program.part_a] | program.free[program.part_b]
        low, high = second_range(program, np.where(chosen[:, None], vectors, 0.0))
        for end, other, infinite in ((one.least, low, -np.inf), (one.greatest, high, np.inf)):
            value = infinite if end.value is None and end.proved else end.value
            if value is None or not end.proved:
                wrong.append(f"{names} not proved")
            elif np.isnan(other):
                wrong.append(f"{names} the second program gave nothing")
            elif value != other and not abs(value - other) <= AGREES * weight:
                wrong.append(f"{names} {value!r} {other!r}")
    return wrong


def moved(verdict: Any, program: Any, random: np.random.Generator) -> tuple[str, list[str]]:
    """The outcome of a random movement of the held parts, and a sentence for each fault."""
    size = MOVEMENT * float(program.radius[program.free].min())
    touched = np.unique(np.concatenate([program.part_a, program.part_b]))
    held = [k for k in touched.tolist() if k >= 0 and not program.free[k]]
    found = verdict.support_movement(
        {program.names[k]: size * random.normal(size=3) / 2 for k in held}
    )
    if found.forces is None:
        return found.outcome, []
    scale, weight = 2 * size, float(program.weight[program.free].sum())
    metres = kilter.units.METRES[program.units]
    released = float((program.load * found.motion)[program.free].sum())
    least = found.least_work.value / metres
    wrong = [] if abs(released - least) <= 1e-7 * weight * scale else ["energy and work differ"]
    opening = program.velocities(found.motion)
    if opening.min() < -1e-5 * scale:
        wrong.append(f"a contact closes by {-opening.min() / scale:.2g} of the movement")
    both = np.minimum(opening / scale, found.forces[0] / weight)
    if found.exact and both.max() > 1e-5:
        wrong.append("a contact opens and carries")
    return found.outcome, wrong


def main() -> int:
    """Run the census; its argument is the number of assemblies."""
    count, outcomes, bad, done = int(sys.argv[1]), dict[str, int](), 0, 0
    started, seed = time.process_time(), 0
    while done < count:
        family = FAMILIES[seed % len(FAMILIES)]
        random = np.random.default_rng(seed)
        try:
            assembly = census_assembly(family, seed, None)
            verdict = None if assembly is None else kilter.check(assembly, require="equilibrium")
        except KilterError:
            verdict = None
        seed += 1
        if verdict is None or verdict.level is None:
            continue
        program = build_program(verdict.assembly, verdict.contact_set)
        both = program.free[program.part_a] | program.free[program.part_b]
        if (
            not both.any()
            or (program.kind != CONTACT).any()
            or program.pull.any()
            or program.cohesion.any()
        ):
            continue
        done += 1
        wrong = compared(verdict, program, random)
        if done % 2:
            outcome, more = moved(verdict, program, random)
            outcomes[outcome] = outcomes.get(outcome, 0) + 1
            wrong += more
        bad += bool(wrong)
        for text in wrong:
            print(f"{family} {seed - 1}: {text}", flush=True)
    seconds = time.process_time() - started
    print(
        f"{done} assemblies, {bad} with a disagreement, movements {outcomes}, {seconds:.0f} CPU s"
    )
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
