"""Throughput of `check_many` on small assemblies, with a comparison with `check`.

    python benchmarks/many.py                        10,000 assemblies of 5 to 20 boxes
    python benchmarks/many.py 1000 --compare 1000    1,000, all compared (default 200)
    python benchmarks/many.py 1000 --piles           boxes on a grid; edges and corners meet
    python benchmarks/many.py 1000 --piles --turned  each rotated at random with its gravity
    python benchmarks/many.py 1000 --friction 0.5    with friction
    python benchmarks/many.py 1000 --boxes 10        a table and ten boxes each
    python benchmarks/many.py 100000 --towers        ten boxes on each other, by the closed form
    python benchmarks/many.py 100000 --towers --simulated 20    20 of them in MuJoCo, too

The assemblies are given as arrays and as a list. Every proof is verified
with the program of its assembly, independently of the solver. Different verdicts and invalid
proofs are printed, and the exit code is then 1. Seconds are CPU time on a single core. With numba
(`kilter[fast]`) compiled code decides most of the assemblies; `--pure` does without it.

The boxes of a tower lie with parallel sides, each on the next lower one. So a tower stands iff the
centre of mass of the boxes above each face is over the overlap of the two boxes that meet there.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

FEWEST, MOST = 5, 20
KEPT = 2000
"""Number of proofs that are kept and verified at a time."""
SIDE = 4
"""Cells of the floor of a pile; with fewer cells piles are higher and more of them fall."""
WIDEST = 0.2
"""Largest shift of a box of a tower over the box below [its width]."""
NEAR = 1e-6
"""Towers with a centre of mass this near to an edge are left out [m]."""
MOVED = 0.1
"""Way of a box in a second of simulation from which its tower counts as falling [m]."""
SHIFT = 0.3
"""Largest shift of a box over the box below [width of the box below]."""


def boxes(seed: int, count: int | None = None) -> Any:
    """Random boxes, 5 to 20 by default, each on the floor or on an earlier box."""
    from kilter.assembly import Assembly, Part
    from kilter.rigid import Pose
    from kilter.shape.primitives import Box

    random = np.random.default_rng(seed)
    count = int(random.integers(FEWEST, MOST + 1)) if count is None else count
    sizes, middles = random.uniform(0.5, 2.0, (count, 3)), np.zeros((count, 3))
    for k in range(count):
        middles[k, :2] = random.uniform(-8.0, 8.0, 2)
        if k and random.random() < 0.5:
            below = int(random.integers(k))
            shift = random.uniform(-SHIFT, SHIFT, 2)
            middles[k, :2] = middles[below, :2] + shift * sizes[below, :2]
        apart = np.abs(middles[:k, :2] - middles[k, :2])
        under = (apart < (sizes[:k, :2] + sizes[k, :2]) / 2).all(axis=1)
        tops = (middles[:k, 2] + sizes[:k, 2] / 2)[under]
        middles[k, 2] = tops.max(initial=0.0) + sizes[k, 2] / 2
    free = [Part(f"box-{k}", Box(sizes[k]), Pose(middles[k])) for k in range(count)]
    return Assembly([Part("floor", Box([40, 40, 1]), Pose([0, 0, -0.5]), grounded=True), *free])


def pile(seed: int) -> Any:
    """A random pile of boxes on a grid; every second pile uses only level ground."""
    from kilter.scenes.random_bricks import box_pile

    count = int(np.random.default_rng(seed).integers(FEWEST, MOST + 1))
    return box_pile(count, seed=seed, cells=SIDE, level=bool(seed % 2))


def turned(assembly: Any, seed: int) -> Any:
    """The assembly rotated at random, with its gravity."""
    from kilter.rigid import Pose

    turn = Pose((0, 0, 0), np.random.default_rng(seed).normal(size=4))
    parts = [
        dataclasses.replace(part, pose=Pose(turn.apply([part.pose.position])[0], turn.rotation))
        for part in assembly.parts
    ]
    return dataclasses.replace(assembly, parts=parts, gravity=turn.apply([assembly.gravity])[0])


def as_arrays(piles: list[Any]) -> Any:
    """The assemblies as `AssemblyArrays` of meshes."""
    from kilter import AssemblyArrays
    from kilter.arrays import starts
    from kilter.shape.primitives import surface

    parts = [part for one in piles for part in one.parts]
    surfaces = [surface(part.shape) for part in parts]
    first = starts([len(vertices) for vertices, _ in surfaces])
    return AssemblyArrays(
        np.concatenate([part.pose.apply(v) for part, (v, _) in zip(parts, surfaces, strict=True)]),
        np.concatenate([faces + k for (_, faces), k in zip(surfaces, first[:-1], strict=True)]),
        first,
        starts([len(faces) for _, faces in surfaces]),
        starts([len(one) for one in piles]),
        [part.grounded for part in parts],
        gravity=np.array([one.gravity for one in piles]),
        friction=piles[0].friction,
    )


def towers(count: int, friction: float, *, height: int = 10, seed: int = 0) -> tuple[Any, Any]:
    """Towers of boxes on a table as `AssemblyArrays`, and by the closed form whether each stands.

    No centre of mass is within `NEAR` of an edge of the face under it.
    """
    from kilter import AssemblyArrays
    from kilter.shape.primitives import BOX_CORNERS, BOX_TRIANGLES

    random = np.random.default_rng(seed)
    size = random.uniform(0.5, 2.0, (2 * count, height, 3))
    shift = random.uniform(-WIDEST, WIDEST, (2 * count, height, 2)) * size[..., :2]
    middle = np.concatenate([np.cumsum(shift, axis=1), size[..., 2:]], axis=2)
    middle[..., 2] = np.cumsum(size[..., 2], axis=1) - size[..., 2] / 2
    margin = least_margin(size, middle)
    clear = np.flatnonzero(np.abs(margin) > NEAR)[:count]
    size, middle, stands = size[clear], middle[clear], margin[clear] > 0
    count = len(size)
    table = np.broadcast_to([100.0, 100.0, 1.0], (count, 1, 3))
    size = np.concatenate([table, size], axis=1).reshape(-1, 3)
    place = np.broadcast_to([0.0, 0.0, -0.5], (count, 1, 3))
    middle = np.concatenate([place, middle], axis=1).reshape(-1, 3)
    first = 8 * np.arange(len(size) + 1)
    arrays = AssemblyArrays(
        (BOX_CORNERS * size[:, None] + middle[:, None]).reshape(-1, 3),
        (BOX_TRIANGLES + first[:-1, None, None]).reshape(-1, 3),
        first,
        len(BOX_TRIANGLES) * np.arange(len(size) + 1),
        (height + 1) * np.arange(count + 1),
        np.arange(len(size)) % (height + 1) == 0,
        friction=friction,
    )
    return arrays, stands


def least_margin(size: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Least distance of the centre of mass above a face from the edges of the face, inwards [m].

    Arguments: `size`, `middle` (n, height, 3): sizes and centres of boxes that form towers.
    """
    mass = size.prod(axis=2)[..., None]
    above = np.cumsum((mass * middle)[:, ::-1], axis=1)[:, ::-1]
    centre = (above / np.cumsum(mass[:, ::-1], axis=1)[:, ::-1])[..., :2]
    low, high = (middle + sign * size / 2 for sign in (-1, 1))
    low, high = low[..., :2], high[..., :2]
    low[:, 1:], high[:, 1:] = (
        np.maximum(low[:, 1:], low[:, :-1]),
        np.minimum(high[:, 1:], high[:, :-1]),
    )
    return np.minimum(centre - low, high - centre).min(axis=(1, 2))


def simulated(arrays: Any, stands: Any, count: int) -> None:
    """Simulate the first towers for a second in MuJoCo; print the rate and other answers."""
    import mujoco
    from mujoco import rollout

    wrong, seconds = 0, 0.0
    parts = arrays.part_start[1]
    corners = arrays.vertices.reshape(len(stands), parts, 8, 3)
    for k in range(min(count, len(stands))):
        low, high = corners[k].min(axis=1), corners[k].max(axis=1)
        bodies = "".join(
            f'<body pos="{p[0]} {p[1]} {p[2]}"><freejoint/>'
            f'<geom type="box" size="{s[0]} {s[1]} {s[2]}"/></body>'
            for p, s in zip((low + high)[1:] / 2, (high - low)[1:] / 2, strict=True)
        )
        text = f"""<mujoco><option timestep="0.005"/><default><geom friction="{arrays.friction}"
            density="1000"/></default><worldbody><geom type="plane" size="50 50 1"/>{bodies}
            </worldbody></mujoco>"""
        model = mujoco.MjModel.from_xml_string(text)
        data, size = mujoco.MjData(model), int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
        state = np.zeros(mujoco.mj_stateSize(model, size))
        mujoco.mj_getState(model, data, state, size)
        started = time.process_time()
        states, _ = rollout.rollout(model, data, state[None], nstep=200)
        seconds += time.process_time() - started
        places = states[0, -1, 1 : 1 + model.nq].reshape(-1, 7)[:, :3]
        moved = np.abs(places - (low + high)[1:] / 2).max()
        wrong += (moved < MOVED) != bool(stands[k])
    rate = count / max(seconds, 1e-9)
    print(f"{'MuJoCo':12} {rate:8,.0f} a second  {wrong} of {count} differ from the closed form")


def measure_towers(count: int, friction: float, simulate: int) -> int:
    """Print the throughput for towers, and verdicts that differ from the closed form."""
    import kilter

    arrays, stands = towers(count, friction)
    kilter.check_many(arrays.among(np.arange(min(1000, len(arrays)))))  # imports, and compilation
    found, seconds = timed(lambda: kilter.check_many(arrays))
    print(f"{'towers':12} {len(found) / seconds:8,.0f} a second  {found!r}", flush=True)
    wrong = np.flatnonzero(found.verdict != np.where(stands, "stable", "unstable"))
    print(f"{'':12} {len(found)} rechecked by the closed form, {len(wrong)} wrong {wrong[:10]}")
    holds, seconds = timed(found.rechecked)
    rate = len(found) / seconds
    print(f"{'rechecked':12} {rate:8,.0f} a second, {(~holds).sum()} do not hold", flush=True)
    some = arrays.among(np.arange(min(KEPT, len(arrays))))
    proved, seconds = timed(lambda: broken(kilter.check_many(some, proofs=True)))
    print(f"{'certificates':12} {len(some) / seconds:8,.0f} a second, {len(proved)} do not hold")
    if simulate:
        simulated(arrays, stands, simulate)
    return 1 if len(wrong) or proved or not holds.all() else 0


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Run a function and return its result and its CPU seconds."""
    started = time.process_time()
    return work(), time.process_time() - started


def broken(found: Any) -> list[int]:
    """Indices of the verdicts whose proofs are invalid."""
    wrong = []
    for k, word in enumerate(found.verdict.tolist()):
        kept = found.certificate(k)
        if word in ("undecided", "error"):
            continue
        if kept is None or not kept[1].holds:
            wrong.append(k)
    return wrong


def measured(name: str, given: Any, words: list[str]) -> int:
    """Print throughput, invalid proofs and different verdicts; return the number of errors."""
    import kilter

    found, seconds = timed(lambda: kilter.check_many(given))
    print(f"{name:12} {len(found) / seconds:8,.0f} a second  {found!r}", flush=True)
    bad = []
    for first in range(0, len(found), KEPT):
        some = np.arange(first, min(first + KEPT, len(found)))
        few = given.among(some) if name == "arrays" else given[first : first + KEPT]
        bad += [first + k for k in broken(kilter.check_many(few, proofs=True))]
    print(f"{'':12} {len(found)} proofs rechecked, {len(bad)} do not hold {bad[:10]}", flush=True)
    other = np.flatnonzero(found.verdict[: len(words)] != np.array(words, dtype=str)).tolist()
    print(f"{'':12} {len(words)} compared with check, {len(other)} differ {other[:10]}", flush=True)
    return len(bad) + len(other)


def main() -> int:
    """Run the benchmark; return 1 if a verdict differs or a proof is invalid."""
    import kilter
    from kilter.analysis.many import clear_stacks

    parser = argparse.ArgumentParser()
    parser.add_argument("count", type=int, nargs="?", default=10_000)
    parser.add_argument("--compare", type=int, default=200)
    parser.add_argument("--piles", action="store_true")
    parser.add_argument("--turned", action="store_true")
    parser.add_argument("--friction", type=float, default=0.0)
    parser.add_argument("--boxes", type=int)
    parser.add_argument("--towers", action="store_true")
    parser.add_argument("--simulated", type=int, default=0)
    parser.add_argument("--pure", action="store_true")
    asked = parser.parse_args()
    if asked.pure:
        clear_stacks.has_numba = lambda: False
    if asked.towers:
        return measure_towers(asked.count, asked.friction, asked.simulated)
    piles = [pile(k) if asked.piles else boxes(k, asked.boxes) for k in range(asked.count)]
    piles = [one.with_friction(asked.friction) for one in piles]
    if asked.turned:
        piles = [turned(one, seed) for seed, one in enumerate(piles)]
    arrays = as_arrays(piles)
    kilter.check_many(arrays.among(np.arange(min(50, len(arrays)))))  # imports
    words, seconds = timed(lambda: [kilter.check(one).verdict for one in piles[: asked.compare]])
    rate = len(words) / max(seconds, 1e-9)
    print(f"{'check':12} {rate:8,.0f} a second  {len(words)} of {len(piles)}", flush=True)
    given = {"arrays": arrays, "assemblies": piles}
    wrong = [measured(name, one, words) for name, one in given.items()]
    return 1 if any(wrong) else 0


if __name__ == "__main__":
    sys.exit(main())
