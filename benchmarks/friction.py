"""Times of friction: equilibrium in Coulomb's cones, seating and proofs, by size.

    python benchmarks/friction.py                 walls of 300 and 1,000 bricks, proofs
    python benchmarks/friction.py 300 1000 10000

Walls are tilted out of their plane by half of the overturning angle, so that they need friction.
`frictionless` is the time without friction, `equilibrium` that in Coulomb's cones; `points` is the
number of contact points. On a busy machine, compare only ratios within a run.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

SEATED = ((6, 6), (15, 14))
"""Courses and bricks per course of the seated walls: about 500 and 2,300 contact points."""


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Run a function and return its time [s] and its result."""
    started = time.perf_counter()
    result = work()
    return time.perf_counter() - started, result


def program_of(assembly: Any) -> Any:
    """The program of an assembly with its detected contacts."""
    from kilter.contact import detect
    from kilter.mechanics.program import build_program

    return build_program(assembly, detect.contacts(assembly))


def leaning(assembly: Any, share: float) -> Any:
    """The wall tilted by a share of the angle at which it overturns as a whole."""
    from transformations import tilted

    high = assembly.geometry.vertices.max(axis=0)
    depth = min(float(np.ptp(assembly.geometry.vertices[:, k])) for k in (0, 1))
    free = assembly.geometry.vertices[~assembly.geometry.grounded[assembly.geometry.vertex_part]]
    height = float(high[2] - free[:, 2].min())
    return tilted(assembly, [1, 0, 0], share * float(np.degrees(np.arctan(depth / height))))


def walls(sizes: list[int]) -> None:
    """Print times of the verdicts on leaning walls."""
    from kilter.analysis.decision.judge import judge
    from kilter.scenes.walls import wall_of

    print(f"{'wall':>7} {'points':>8} {'frictionless':>13} {'equilibrium':>12}  answer")
    for count in sizes:
        program = program_of(leaning(wall_of(count, friction=0.6), 0.5))
        smooth, _ = timed(lambda p=program: judge(p.frictionless))
        rough, judged = timed(lambda p=program: judge(p))
        residual = judged.forces.residual if judged.forces else float("nan")
        print(
            f"{count:>7} {len(program.part_a):>8} {smooth:>13.3f} {rough:>12.3f}  "
            f"{judged.stable}, residual {residual:.1e}, {judged.solvers[-1]}",
            flush=True,
        )


def seatings() -> None:
    """Print times of seating walls with about 500 and 2,300 contact points."""
    from kilter.friction.seating import find_seating
    from kilter.scenes.walls import wall

    print(f"{'points':>7} {'seating':>9}  answer")
    for courses, bricks in SEATED:
        program = program_of(leaning(wall(courses, bricks, friction=0.6), 0.5))
        seconds, found = timed(lambda p=program: find_seating(p))
        print(f"{len(program.part_a):>7} {seconds:>9.3f}  {found.seated}, {found.residual:.1e}")


def proofs() -> None:
    """Print times of searches and proofs for assemblies with friction."""
    from transformations import tilted

    from kilter import check
    from kilter.scenes import arches, friction, stacks

    def planar(assembly: Any) -> Any:
        import dataclasses

        return dataclasses.replace(assembly, planar=True)

    limit = float(np.degrees(np.arctan(0.5)))
    cases = {
        "block on an incline at .98": stacks.block_on_slope(0.98 * limit, friction=0.5),
        "block on an incline at .999": stacks.block_on_slope(0.999 * limit, friction=0.5),
        "trough at 20 degrees": friction.trough(30.0, tilt=20.0),
        "trough at 35 degrees": friction.trough(30.0, tilt=35.0),
        "trough at 44 degrees": friction.trough(30.0, tilt=44.0),
        "stack of 10, planar, tilted": planar(
            tilted(stacks.tower(10).with_friction(0.5), [0, 1, 0], 3.0)
        ),
        "arch of 7, planar": arches.arch(7, friction=0.7, planar=True),
        "arch of 20, planar": arches.arch(20, friction=0.7, planar=True),
        "two cubes on a plane": tilted(stacks.tower(2).with_friction(0.5), [0, 1, 0], 15.0),
        "block between walls": friction.h_block(),
        "bracket at 1.1": friction.bracket(1.1 / 1.2),
    }
    print(f"{'case':<30} {'seconds':>8} {'verdict':<19} guarantee  programs")
    for name, assembly in cases.items():
        seconds, verdict = timed(lambda a=assembly: check(a, effort=3))
        exclusion = verdict.friction_answer.exclusion if verdict.friction_answer else None
        count = exclusion.programs if exclusion else 0
        print(
            f"{name:<30} {seconds:>8.2f} {verdict.verdict:<19} {verdict.guarantee:<10} {count}",
            flush=True,
        )


if __name__ == "__main__":
    walls([int(word) for word in sys.argv[1:]] or [300, 1000])
    seatings()
    proofs()
