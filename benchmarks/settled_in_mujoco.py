"""Settled scenes beside the disturbed scenes in MuJoCo: how far do their parts drift in 2 s?

    pip install -e ".[mujoco]"
    python benchmarks/settled_in_mujoco.py            100 scenes of convex parts
    python benchmarks/settled_in_mujoco.py 20 --first 100

Scenes are those of `settle_census.py`: stacks, arches, walls and Voronoi cells, each part disturbed
in all six freedoms. Those that `kilter.settle` brings to rest at the level "settles" or above are
exported as MJCF in both poses and simulated. The drift is the largest displacement of a part over
its size. A scene whose settled pose drifts by more than `MOVED` is listed. Stiff contacts, elliptic
cones and the Noslip solver are set as in `benchmarks/peers`; without them soft contacts creep.
"""

from __future__ import annotations

import argparse

import mujoco
import numpy as np
from settle_census import FLAT, disturbed

import kilter
from kilter import Assembly
from kilter.tell.levels import holds

SECONDS = 2.0
"""Simulated time [s]."""
MOVED = 0.01
"""Drift above which a scene is listed [size of the part]."""
STEP = 0.002
"""Time step [s]; the time constant of the contacts is twice as long, the least possible."""
KINDS = ("stacks", "arches", "stacks", "walls", "stacks", "voronoi")


def drift_of(assembly: Assembly) -> float:
    """Largest displacement of a part in the simulation, over its size [-]."""
    model = mujoco.MjModel.from_xml_string(assembly.to_mjcf())
    option = model.opt
    option.timestep = STEP
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.tolerance, option.iterations = 1e-10, 200
    option.impratio, option.noslip_iterations = 100.0, 20
    model.geom_solref[:] = [2 * STEP, 1.0]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    begin = data.xipos.copy()
    while data.time < SECONDS:
        mujoco.mj_step(model, data)
    moved = np.linalg.norm(data.xipos - begin, axis=1)
    drift = 0.0
    for name, size, held in zip(
        assembly.names, assembly.geometry.size, assembly.geometry.grounded, strict=True
    ):
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        if not held and body >= 0:
            drift = max(drift, float(moved[body] / size))
    return drift


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("count", type=int, nargs="?", default=100, help="number of scenes")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    options = parser.parse_args()
    before: list[float] = []
    after: list[float] = []
    seed = options.first
    while len(after) < options.count:
        kind = KINDS[seed % len(KINDS)]
        rng = np.random.default_rng([seed, 7])
        drawn, most = disturbed(FLAT[kind](rng), rng)
        seed += 1
        if drawn.geometry.grounded.all():
            continue
        settled = kilter.settle(drawn, nearest=True)
        if settled.state != "at-rest" or not holds(settled.level, "settles"):
            print(f"  {kind} {seed - 1}: not simulated, {settled.state} {settled.level}")
            continue
        before.append(drift_of(drawn))
        after.append(drift_of(settled.assembly))
        if after[-1] > MOVED:
            size = float(np.median(drawn.geometry.size))
            print(
                f"  {kind} {seed - 1}: settled {after[-1]:.2%}, disturbed {before[-1]:.2%}, "
                f"shift applied {most / size:.1e}, level {settled.level}",
                flush=True,
            )
        if len(after) % 10 == 0 or len(after) == options.count:
            table(before, after)


def table(before: list[float], after: list[float]) -> None:
    """Print the median and the worst drift of both poses until now."""
    print(f"{'pose':10} {'scenes':>6} {'median':>9} {'worst':>9} {'above 1 %':>9}")
    for name, drifts in (("disturbed", before), ("settled", after)):
        above = sum(drift > MOVED for drift in drifts)
        print(
            f"{name:10} {len(drifts):6} {np.median(drifts):9.2e} {max(drifts):9.2e} {above:9}",
            flush=True,
        )


if __name__ == "__main__":
    main()
