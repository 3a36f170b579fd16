"""Cost of the second order: its CPU time, that of the verdict, and their ratio.

    python benchmarks/second_order_cost.py

The cases are walls of bricks on level faces, scenes without neutral motions, and balls in bowls,
each a separate cluster. The time of the verdict includes contact detection and equilibrium forces.
Each time is the least of several runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import kilter
from kilter import Assembly, Feature, GivenContact, Part, Pose, Sphere
from kilter.analysis.decision.judge import judge
from kilter.mechanics.program import build_program
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.second_order.answer.whole import find_second_order
from kilter.shape.primitives import Box
from kilter.threads import on_one_thread

RUNS = 7


def bowls(count: int) -> Assembly:
    """Balls of radius 0.7 in bowls of radius 1.3."""
    parts, contacts = [Part("base", Box([1, 1, 1]), Pose([0, 0, -2]), grounded=True)], []
    feature = (Feature("face", curvature=-1 / 1.3), Feature("face", curvature=1 / 0.7))
    for k in range(count):
        x, y = 3.0 * (k % 10), 3.0 * (k // 10)
        parts.append(Part(f"{k}", Sphere(0.7), Pose([x, y, 0.7]), mass=1.0))
        contacts.append(GivenContact(("base", f"{k}"), [[x, y, 0]], [0, 0, 1], feature=feature))
    return Assembly(parts, contacts=contacts, detect=False)


def cases() -> Iterator[tuple[str, Assembly]]:
    """Yield names and assemblies."""
    for count in (20, 100, 1000):
        yield f"wall of {count}", wall_of(count)
    for name in ("wall-with-lintel", "laden-slab", "corner-wedges", "pit-wedges", "closed-frame"):
        yield name, scene(name)
    for count in (10, 100):
        yield f"{count} balls in bowls", bowls(count)


def least(run: Callable[[], object]) -> float:
    """CPU seconds of the fastest run."""
    seconds = []
    for _ in range(RUNS):
        started = time.process_time()
        run()
        seconds.append(time.process_time() - started)
    return min(seconds)


@on_one_thread
def main() -> None:
    """Print a row for each case."""
    print(f"{'':22} {'parts':>6} {'verdict':>9} {'second':>9} {'ratio':>6}  state")
    for name, assembly in cases():
        contacts = kilter.contacts(assembly)
        program = build_program(assembly, contacts).frictionless
        judgement = judge(program)
        forces = judgement.forces.forces if judgement.forces else None

        def verdict(assembly: Assembly = assembly) -> None:
            judge(build_program(assembly, kilter.contacts(assembly)).frictionless)

        found = find_second_order(assembly, contacts, program, forces)
        alone = least(verdict)
        more = least(lambda: find_second_order(assembly, contacts, program, forces))  # noqa: B023
        state = "nothing neutral" if found is None else found.state
        free = int(program.free.sum())
        print(f"{name:22} {free:6} {alone:9.4f} {more:9.4f} {more / alone:6.2f}  {state}")


if __name__ == "__main__":
    main()
