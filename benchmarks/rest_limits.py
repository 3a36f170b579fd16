"""Large assemblies and scenes whose pose at rest has a limit of CPU time and memory.

    python benchmarks/rest_in_mujoco.py --limits           all, each in a process of its own
    python benchmarks/rest_in_mujoco.py --limits dome      one, in this process

    vessels    20 bowls and mugs of up to 60 pieces, above a plane: 5 s
    parts      100 parts of assemblies that are drawn with play: 10 s
    clusters   100 floating stacks of three boxes, apart from each other: 10 s
    dome       512 blocks, each scaled by 1.01 about its centre: 60 s

The memory limit is 1 GB for each. The seconds include the reading of the file, not the start of
Python.
"""

from __future__ import annotations

import itertools
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from mujoco_scenes import Scene, vessel
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Box, Mesh, Part
from kilter.scenes.pieces import moved

ROOT = Path(__file__).resolve().parents[1]
sys.path += [str(ROOT / "tests" / "settled_pose"), str(ROOT / "tests" / "scenes")]
MEMORY = 1e9
"""Limit of the memory [bytes]."""


def vessels() -> Assembly:
    """20 bowls and mugs of 20 to 60 pieces, of which every second is above another."""
    rng = np.random.default_rng(20)
    things = []
    for k in range(20):
        made, floor = vessel(rng, f"vessel{k}"), k % 2 == 0
        height = 0.02 if floor else things[-1].position[2] + things[-1].high + 0.02
        place, lean = divmod(k // 2, 4), rng.uniform(0, 0.05)
        turn = Rotation.from_euler("zx", [rng.uniform(-3, 3), lean])
        things.append(made.placed(np.array([0.4 * place[0], 0.4 * place[1], height]), turn))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.xml"
        file.write_text(Scene("vessels", things, 0.7).xml())
        return kilter.load(str(file))


def parts() -> Assembly:
    """Assemblies with play beside each other, 100 parts or a few more."""
    from play_scenes import EXACT

    joined: list[Part] = []
    known = [build() for build in EXACT]
    for each in itertools.cycle(k for k in known if not (k.assembly.joints or k.leaves)):
        number = len(joined)
        if number >= 100:
            return Assembly(joined, friction=0.3)
        placed = moved(each.assembly, (1, 0, 0, 0), [1.5 * number, 0, 0])
        joined += [replace(part, name=f"{number} {part.name}") for part in placed.parts]
    raise AssertionError


def clusters() -> Assembly:
    """100 floating stacks of three boxes."""
    rng = np.random.default_rng(300)
    made = [Part("floor", Box([30, 30, 1]), [0, 0, -0.5], grounded=True)]
    for k in range(100):
        height = 0.0
        for j in range(3):
            size = rng.uniform(0.2, 0.6, 3)
            height += float(np.exp(rng.uniform(np.log(1e-3), np.log(0.3)))) + size[2] / 2
            at = [2.0 * (k % 10) - 9, 2.0 * (k // 10) - 9, height]
            made.append(Part(f"box {k}-{j}", Box(size), at))
            height += size[2] / 2
    return Assembly(made, friction=0.6)


def dome() -> Assembly:
    """A dome of 512 blocks, each scaled by 1.01 about its centre; the lowest ring is held."""
    from staggered_dome import staggered_dome

    exact = staggered_dome(rings=16, per_ring=32, staggered=False)
    grown = []
    for part, middle in zip(exact.parts, exact.geometry.center, strict=True):
        corners, faces = part.shape.vertices, part.shape.triangles
        mesh = Mesh(middle + 1.01 * (corners - middle), faces)
        grown.append(Part(part.name, mesh, grounded=part.grounded, density=part.density))
    return Assembly(grown, friction=exact.friction)


LIMITS: dict[str, tuple[Callable[[], Assembly], float]] = {
    "vessels": (vessels, 5.0), "parts": (parts, 10.0), "clusters": (clusters, 10.0),
    "dome": (dome, 60.0),
}  # fmt: skip


def measure(name: str) -> int:
    """Settle a large assembly, or each in a process of its own; 1 if a limit is exceeded."""
    if name == "all":
        file = str(Path(__file__).with_name("rest_in_mujoco.py"))
        runs = [subprocess.run([sys.executable, file, "--limits", each]) for each in LIMITS]
        return int(any(run.returncode for run in runs))
    build, most = LIMITS[name]
    begun = time.process_time()
    assembly = build()
    built = time.process_time()
    try:
        answer = kilter.settle(assembly, require="equilibrium", time_limit=10 * most)
        said = f"{answer.state} {answer.level} {answer.why} {', '.join(answer.leaves)}"
        good = answer.state == "at-rest"
    except kilter.KilterError as error:
        said, good = str(error), False
    seconds = time.process_time() - begun
    memory = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(
        f"{name}: {len(assembly)} parts, {seconds:.1f} CPU s of {most:g} ({built - begun:.1f} of "
        f"them until the assembly was read), {memory / 1e9:.2f} GB: {said.strip()}",
        flush=True,
    )
    return int(not good or seconds > most or memory > MEMORY)
