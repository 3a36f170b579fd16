"""Census of regions, orientations and margins with friction: correctness and times.

    python benchmarks/region_census.py arch 300 -o census.jsonl     seeds 0 to 299
    python benchmarks/region_census.py pile 500 -o census.jsonl     continues a file
    python benchmarks/region_census.py --table census.jsonl
    python benchmarks/region_census.py --voronoi 30 -o cells.jsonl  8 to 25 cells, mu .5 to 1

Families: arch, pile, wedge, round (`tests/scenes/random_turned.py`). Region, orientation and
margin of each assembly are computed in a separate process; more than a minute for any of them is
a fault. Then `judge` tests random directions, and both sides of the boundary, of the tilt margin
and of the least friction. The three margins are compared with each other.

With `--voronoi`, region and orientation of convex cells in a box (`random_voronoi.py`) are timed,
and `check` decides directions on both sides of the region.
"""

from __future__ import annotations

import argparse
import collections
import json
import multiprocessing
import os
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

os.environ.setdefault("OMP_NUM_THREADS", "1")

LIMIT = 60.0
"""Time limit of each answer [CPU s]."""
WAIT = 20 * LIMIT
"""A process without any message for this time is ended; generous for a busy machine [s]."""
RANDOM, EDGE = 200, 20
"""Random directions, and directions at the boundary, that are tested per assembly."""
NEAR = 1e-6
"""Distance of tests from a boundary of directions [rad], and from a least friction [relative]."""
BALANCED = 1e-12
"""Largest residual of the forces at the least friction [-]."""

CELLS, ROUGH = (8, 25), (0.5, 0.7, 0.84, 1.0)
"""Numbers of cells of a Voronoi assembly, and its coefficients of friction [-]."""

Answered = Callable[[str, int, int], Any]
"""Function that yields the parts of a row: of a family, a seed and a number of directions."""


def work(family: str, seed: int, pipe: Any, directions: int, answered: Answered) -> None:
    """Compute the row of a case and send each new part to a pipe."""
    row: dict[str, Any] = {"family": family, "seed": seed}
    try:
        for part in answered(family, seed, directions):
            row |= part
            pipe.send(dict(row, cut=True))
        pipe.send(row)
    except BaseException as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{os.path.basename(last.filename)}:{last.lineno}"
        pipe.send(dict(row, fault=f"{type(error).__name__}: {error} ({where})"[:300]))


def turned(family: str, seed: int, directions: int) -> Any:
    """Yield the parts of a case's row: sizes, answers with times, contradictions."""
    import numpy as np
    from random_turned import random_turned

    import kilter
    from kilter.mechanics.program import build_program

    assembly = random_turned(family, seed)
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    yield {"parts": int(program.free.sum()), "points": len(program.rough)}

    def timed(name: str, ask: Any) -> Any:
        wall, used = time.perf_counter(), time.process_time()
        found = ask()
        times = {
            f"{name}_s": round(time.perf_counter() - wall, 3),
            f"{name}_cpu": round(time.process_time() - used, 3),
        }
        if times[f"{name}_cpu"] > LIMIT:
            raise TimeoutError(f"{name} took {times[f'{name}_cpu']:g} s of the processor")
        return found, times

    region, times = timed("region", lambda: kilter.region(assembly, contacts=contacts))
    yield times | {
        "kind": region.kind,
        "gap": region.gap_deg,
        "proved": region.proved,
        "programs": region.programs,
        "words": [w for w in region.warnings if "apart" in w or "proofs" in w],
    }
    oriented, times = timed("orient", lambda: kilter.orient(assembly, contacts=contacts))
    yield times | {"orient": oriented.verdict, "orient_margin": oriented.tilt_margin_deg}
    margin, times = timed("margin", lambda: kilter.margin(assembly, contacts=contacts))
    yield times | {
        "verdict": margin.verdict,
        "tilt": margin.tilt_deg,
        "tilt_lower": None if margin.tilt is None else float(np.degrees(margin.tilt.lower)),
        "friction": None if margin.friction is None else float(margin.friction),
        "missing": margin.missing,
    }
    wall = time.perf_counter()
    yield rechecked(program, region, margin, oriented, directions)
    yield {"recheck_s": round(time.perf_counter() - wall, 1)}


def cells(family: str, seed: int, directions: int) -> Any:
    """Yield the parts of the row of a Voronoi assembly: times, gap, and sides by `check`."""
    from random_voronoi import random_voronoi

    import kilter

    assembly = random_voronoi(seed, CELLS, ROUGH)
    contacts = kilter.contacts(assembly)
    yield {
        "parts": len(assembly),
        "points": len(contacts.points),
        "mu": float(contacts.patch_mu.max(initial=0.0)),
    }
    used = time.process_time()
    region = kilter.region(assembly, contacts=contacts)
    yield {
        "region_cpu": round(time.process_time() - used, 3),
        "kind": region.kind,
        "gap": region.gap_deg,
        "proved": region.proved,
        "programs": region.programs,
        "words": [w for w in region.warnings if "boundary" in w or "proofs" in w],
    }
    used = time.process_time()
    oriented = kilter.orient(assembly, contacts=contacts)
    used = time.process_time() - used
    yield {"orient_cpu": round(used, 3), "orient": oriented.verdict}
    if used > LIMIT:
        raise TimeoutError(f"orient took {used:g} s of the processor")
    yield sides_checked(assembly, contacts, region, seed, directions)


def sides_checked(
    assembly: Any, contacts: Any, region: Any, seed: int, count: int
) -> dict[str, Any]:
    """Decide directions by `check`: counts of sides, and all contradictions with the region."""
    import numpy as np

    import kilter
    from kilter.mechanics.program import build_program

    program = build_program(assembly, contacts)
    slack = max(found.slack for found in region.found)
    tally: collections.Counter[str] = collections.Counter()
    wrong = []
    for down in directions_of(program, region, np.random.default_rng(seed), count):
        inside, outside = side_of(region, down, slack)
        side = "inside" if inside else "outside" if outside else "between"
        tally[side] += 1
        turned = assembly.with_down(down)
        verdict = kilter.check(
            turned, contacts=contacts.of(turned), require="equilibrium", effort=0
        )
        if verdict.verdict == "undecided":
            tally["open"] += 1
        elif side != "between" and (verdict.verdict != "unstable") is not inside:
            wrong.append(f"{side} {down.tolist()}: {verdict.verdict}")
    return {"tally": dict(tally), "wrong": wrong}


def rechecked(program: Any, region: Any, margin: Any, turned: Any, count: int) -> dict[str, Any]:
    """Test the answers with `judge`: counts of tests, and all contradictions."""
    import numpy as np

    from kilter.analysis.decision.judge import judge

    wrong: list[str] = []
    tally: collections.Counter[str] = collections.Counter()
    rubs = program if region.friction else program.frictionless
    slack = max(found.slack for found in region.found)

    def ask(what: str, down: Any, held: bool) -> None:
        judged = judge(rubs.turned(down)).stable
        tally["inside" if held else "outside"] += 1
        if judged is None:
            tally["open"] += 1
        elif judged is not held:
            wrong.append(f"{what} {np.asarray(down).tolist()}: {'not ' * held}held")

    random = np.random.default_rng(program.names.__len__())
    for down in directions_of(program, region, random, count):
        inside, outside = side_of(region, down, slack)
        if inside or outside:
            ask("direction", down, bool(inside))
        else:
            tally["between"] += 1
    for inner, outer in edges(region, program, random, EDGE):
        if inner is not None:
            ask("inner edge", inner, True)
        if outer is not None:
            ask("outer edge", outer, False)
    wrong += margins_wrong(program, margin, turned, region)
    return {"tally": dict(tally), "wrong": wrong}


def directions_of(program: Any, region: Any, random: Any, count: int) -> Any:
    """Unit directions to test, half random and half near the region; in the plane if planar."""
    import numpy as np

    anywhere = random.normal(size=(count, 3))
    points = np.array([p.vector for f in region.found for p in f.proofs if p.about == "ray"])
    if len(points):
        chosen = points[random.integers(0, len(points), size=count // 2)]
        anywhere[: count // 2] = (
            chosen + random.uniform(0, 0.3, (count // 2, 1)) * anywhere[: count // 2]
        )
    if program.planar:
        anywhere[:, 1] = 0.0
    return anywhere / np.linalg.norm(anywhere, axis=1)[:, None]


def side_of(region: Any, down: Any, slack: float) -> tuple[bool, bool]:
    """Whether a direction is within the inner cone, and whether it is outside the outer cone."""
    import numpy as np

    if region.exact or not len(region.facets):
        inside = bool(region.contains(down))
        across = region.equations[np.abs(region.equations @ [0.0, 1.0, 0.0]) < 1.0 - 1e-9]
        walls = across if region.assemblies[0].planar else region.equations
        sines = np.abs(np.concatenate([walls @ down, region.cone.facets @ down]))
        near = float(sines.min(initial=1.0)) < max(10 * region.cone.blur, slack)
        return inside and not near, not inside and not near
    inside = bool(region.cone.contains(down, margin=0.0)) and (
        region.dimension < 3 or bool(region.cone.contains(down, margin=1e-9))
    )
    return inside, float((region.facets @ down).min(initial=1.0)) < -np.sin(slack + NEAR)


def edges(region: Any, program: Any, random: Any, count: int) -> Any:
    """Yield pairs of directions just inside the inner cone and just outside the outer cone."""
    import numpy as np

    center = region.center
    if center is None:
        center = region.rays[0] if len(region.rays) else None
    if center is None and len(region.lines):
        center = region.lines[0]
    if center is None:
        return
    slack = max(found.slack for found in region.found)
    for _ in range(count):
        aside = random.normal(size=3)
        if program.planar:
            aside[1] = 0.0
        aside = aside - (aside @ center) * center
        if np.linalg.norm(aside) < 1e-9:
            continue
        aside = aside / np.linalg.norm(aside)

        def turned(angle: float, aside: Any = aside) -> Any:
            return np.cos(angle) * center + np.sin(angle) * aside

        def last(held: Any) -> float:
            low, high = 0.0, np.pi
            for _ in range(60):
                middle = (low + high) / 2
                low, high = (middle, high) if held(middle) else (low, middle)
            return low

        inner = last(lambda a: bool(region.cone.contains(turned(a), margin=1e-9)))
        outer = last(lambda a: not side_of(region, turned(a), slack)[1])
        yield (
            turned(inner - NEAR) if inner > NEAR and region.dimension == 3 else None,
            turned(outer + NEAR) if outer < np.pi - 1e-3 else None,
        )


def margins_wrong(program: Any, margin: Any, turned: Any, region: Any) -> list[str]:
    """Contradictions between the margins, the verdicts on both sides of them, and the region."""
    import numpy as np

    from kilter.analysis.decision.judge import judge

    wrong = []
    gap = np.radians(region.gap_deg or 0.0) + 1e-7
    down = program.down
    if margin.tilt_deg is not None and margin.tilt_down is not None and not program.applied.any():
        tilt = np.radians(margin.tilt_deg)
        aside = margin.tilt_down - (margin.tilt_down @ down) * down
        size = float(np.linalg.norm(aside))
        limited = margin.tilt is None or margin.tilt.limit.motion is not None
        if size > 0 and limited:
            aside = aside / size

            def at(angle: float) -> Any:
                return np.cos(angle) * down + np.sin(angle) * aside

            asked = [(tilt - NEAR, at(tilt - NEAR), True), (tilt + NEAR, at(tilt + NEAR), False)]
            if margin.nearest is not None:
                before = margin.nearest.lower - NEAR
                asked = [(-before, at(before), False)]
                if region.center is not None and region.dimension == (2 if program.planar else 3):
                    # straight on, the path may leave the region by a side that it follows
                    asked.append((tilt, margin.tilt_down + NEAR * region.center, True))
            for angle, there, held in asked:
                judged = judge(program.turned(there)).stable
                if angle * tilt > 0 and judged is not None and judged is not held:
                    wrong.append(f"tilt {margin.tilt_deg} at {angle} rad: judged {judged}")
        if tilt > 0 and limited and region.dimension == (2 if program.planar else 3):
            outer = np.arcsin(np.clip((region.facets @ down).min(initial=1.0), -1, 1))
            inner = np.arcsin(np.clip((region.cone.facets @ down).min(initial=1.0), -1, 1))
            if not inner - 1e-7 <= tilt <= outer + 1e-7:
                wrong.append(
                    f"tilt {margin.tilt_deg} outside region's"
                    f" {np.degrees(inner)} to {np.degrees(outer)}"
                )
            if outer - inner > 2 * gap + 1e-6:
                wrong.append(f"facets {np.degrees(outer - inner)} deg apart, gap {region.gap_deg}")
    if margin.friction is not None and margin.friction > 0:
        wrong += friction_wrong(program, margin.friction_limit)
    if turned.verdict == "found" and turned.tilt_margin_deg is not None:
        half = region.half_angle_deg
        if half is not None and 0 < half < 90 and region.dimension == 3:
            most = half + np.degrees(gap)
            if not half - 1e-6 <= turned.tilt_margin_deg <= most + 1e-6:
                wrong.append(f"orient {turned.tilt_margin_deg}, half angle {half}")
    if (turned.verdict == "found") != (region.kind != "none") and turned.verdict != "undecided":
        wrong.append(f"orient {turned.verdict}, region {region.kind}")
    return wrong


def friction_wrong(program: Any, found: Any) -> list[str]:
    """Contradictions of a least friction: on its two sides, and in the distance of the bounds.

    The bounds may be farther apart than `NEAR` only if no motion narrows them: at a quarter of
    the distance no motion exists.
    """
    import numpy as np

    from kilter.analysis.decision.judge import judge
    from kilter.mechanics.certificate import check_forces
    from kilter.mechanics.rows import CONTACT

    def even(mu: float) -> Any:
        return program.with_rows(mu=np.where(program.kind == CONTACT, mu, 0.0))

    wrong = []
    near = found.value * (1 - NEAR)
    for mu, held in ((min(near, found.lower), False), (found.value * (1 + NEAR), True)):
        judged = judge(even(mu)).stable
        if judged is not None and judged is not held:
            wrong.append(f"friction {found.value} at {mu}: judged {judged}")
    if not program.doubt.any():
        above = even(found.value * (1 + NEAR))
        rest = check_forces(above, found.forces.forces, found.forces.friction).residual
        if rest > BALANCED:
            wrong.append(f"friction {found.value}: its forces leave {rest}")
    nearer = 0.75 * found.value + 0.25 * found.lower
    if found.lower < near and judge(even(nearer)).stable is False:
        wrong.append(f"friction {found.value}: its lower side {found.lower} is too far off")
    return wrong


def run(
    family: str, seed: int, directions: int, answered: Answered | None = None
) -> dict[str, Any]:
    """Compute the row of a case in a separate process."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    given = (family, seed, theirs, directions, answered or turned)
    process = context.Process(target=work, args=given)
    process.start()
    theirs.close()
    row: dict[str, Any] = {"family": family, "seed": seed, "cut": True}
    while True:
        if not ours.poll(WAIT):
            row["fault"] = f"not ended after {WAIT:g} s"
            break
        try:
            row = ours.recv()
        except EOFError:
            row["fault"] = f"the process ended, code {process.exitcode}"
            break
        if not row.get("cut") or "fault" in row:
            break
    process.kill()
    process.join()
    return row


def table(rows: list[dict[str, Any]]) -> None:
    """Print the counts and longest times of each family."""
    for family in sorted({row["family"] for row in rows}):
        own = [row for row in rows if row["family"] == family]
        faults = [row for row in own if "fault" in row]
        kinds = collections.Counter(row.get("kind", "?") for row in own)
        tally: collections.Counter[str] = collections.Counter()
        for row in own:
            tally.update(row.get("tally", {}))
        worst = {
            name: max((row.get(f"{name}_cpu", 0.0) for row in own), default=0.0)
            for name in ("region", "orient", "margin")
        }
        wide = sum(bool(row.get("words")) for row in own)
        wrong = [row for row in own if row.get("wrong")]
        print(
            f"{family}: {len(own)} assemblies, {len(faults)} faults, {len(wrong)} with"
            f" contradictions, {wide} that report a wide gap or a missing proof;"
            f" kinds {dict(kinds)}; tests {dict(tally)}; longest CPU seconds {worst}"
        )
        for name in ("region", "orient"):
            times = sorted(row[f"{name}_cpu"] for row in own if f"{name}_cpu" in row)
            if times:
                print(
                    f"  {name}: median {times[len(times) // 2]:.2f} CPU s, longest {times[-1]:.2f}"
                )
        gaps = [row["gap"] or 0.0 for row in own if "gap" in row]
        print(f"  largest gap {max(gaps, default=0.0):.4f} deg")
        for row in faults:
            print(f"  seed {row['seed']}: {row['fault']}")
        for row in wrong:
            print(f"  seed {row['seed']}: {row['wrong'][:3]}")


def main(answered: Answered = turned, told: Callable[[list[dict[str, Any]]], None] = table) -> int:
    """Run the census and print its table; return 1 if there is a fault or a contradiction."""
    parser = argparse.ArgumentParser()
    parser.add_argument("family", nargs="?")
    parser.add_argument("count", nargs="?", type=int, default=10)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seeds", type=int, nargs="*")
    parser.add_argument("--directions", type=int, default=RANDOM)
    parser.add_argument("-o", default=None)
    parser.add_argument("--table", default=None)
    parser.add_argument("--voronoi", type=int, default=None, metavar="COUNT")
    given = parser.parse_args()
    if given.voronoi is not None:
        given.family, given.count, answered = "voronoi", given.voronoi, cells
    if given.table:
        with open(given.table) as lines:
            told([json.loads(line) for line in lines])
        return 0
    if given.family is None:
        parser.error("give a family, --voronoi COUNT or --table FILE")
    done = set()
    if given.o and os.path.exists(given.o):
        with open(given.o) as lines:
            done = {(row["family"], row["seed"]) for row in map(json.loads, lines)}
    rows = []

    for seed in given.seeds or range(given.first, given.first + given.count):
        if (given.family, seed) in done:
            continue
        row = run(given.family, seed, given.directions, answered)
        rows.append(row)
        if given.o:
            with open(given.o, "a") as file:
                file.write(json.dumps(row) + "\n")
    told(rows)
    return int(any("fault" in row or row.get("wrong") for row in rows))


if __name__ == "__main__":
    raise SystemExit(main())
