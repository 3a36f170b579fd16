"""Census of agreement: every command reports the findings of `check`.

    python benchmarks/agreement.py                       600 assemblies, 2 processes
    python benchmarks/agreement.py 50 --first 100        seeds 100 to 149
    python benchmarks/agreement.py --family voronoi      the 60 assemblies of a single family
    python benchmarks/agreement.py --real ../shared/data real files too, in place of a tenth
    python benchmarks/agreement.py --log rows.jsonl      a row a case; a later run continues it

Families: arch, pile, wedge, round, voronoi (3D cells with shared faces), squeezed (blocks between
walls, troughs, ladders), bricks, bonded, open (parts pushed into overlap or out of contact), real.
Each command has a limit of 20 CPU s; a command that reaches it is counted as cut. Most assemblies
have up to 4 free parts, one of eight has up to 12. One case of eight is decided with the usual
effort of every command, the others with effort 0.1.

Rules, each counted as tests and contradictions:

plan        the verdict of the finished assembly in a plan = the verdict of check
hold        with the supports of `hold --require L`, check reaches level L; if check reaches it
            as drawn, there are no supports
limit       just inside a limit check holds at the level of the limit, just outside it does not:
            tilt, least friction, load factor of a body force, the weakest push of a part; at
            equilibrium in every case. At settles in the cases of usual effort: tilt and friction,
            and in turn the load factor or a push
region      a direction is in the region iff check holds there at equilibrium; directions between
            the inner and the outer cone, and regions that open pairs decide, are left out
orient      check holds at the recommended direction, at the reported level
report      the page and the notebook show the verdict and the sentence of check
many        check_many and the row of batch give the verdict of check, batch also its level
ladder      as a drawing, each row of the ladder has the verdict of check on its rung
verify      the proof of check passes `verify`

Balanced assemblies are counted apart: the tests of their rules have names that end in "balanced".
Exit code 1 if there is a contradiction.
"""

from __future__ import annotations

import argparse
import html
import json
import os
import subprocess
import sys
import tempfile
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from agreement_assemblies import FAMILIES, census_assembly, turn_of
from agreement_cases import Case, catch_limit, logged_cases, print_counts
from agreement_limits import NEAR, beside_level_limits, beside_limits

import kilter
from kilter.analysis.everything import everything
from kilter.analysis.many.batch_rows import BatchQuestion, judged_rows
from kilter.assembly import Assembly
from kilter.mechanics.bundle import apply_change
from kilter.tell.levels import holds
from kilter.work import EFFORT

USUAL_EVERY = 8
"""One of so many cases of a family is decided with the usual effort."""
LITTLE = 0.1
"""Effort of the other cases [-]."""
DIRECTIONS = 6
"""Random directions that are compared with the region."""
LEVELS = ("equilibrium", "settles", "proved")


def judge(family: str, seed: int, real: Path | None, folder: Path) -> Case | None:
    """Run every command on a case and compare the answers; keep its file in a folder."""
    catch_limit()
    # shifted, so that the large assemblies of the slow families take little effort
    usual = (turn_of(seed) + FAMILIES.index(family) + 3) % USUAL_EVERY == 0
    case = Case(family, seed, EFFORT if usual else LITTLE)
    try:
        assembly = census_assembly(family, seed, real)
        if assembly is None:
            return None
        verdict = case.run("check", lambda: kilter.check(assembly, effort=case.effort))
        if verdict is None:
            return case
        case.verdict = verdict.verdict
        kilter.dump(assembly, folder / f"{family}-{seed}.kilter.json")
        for rule in (_verify, _plan, _hold, _limits, _region, _orient, _report, _many, _ladder):
            rule(case, assembly, verdict)
        _batch(case, verdict, folder / f"{family}-{seed}.kilter.json")
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(last.filename).name}:{last.lineno}"
        case.wrong.append(f"{family} {seed}: fault: {type(error).__name__}: {error} ({place})")
    return case


def _verify(case: Case, assembly: Assembly, verdict: Any) -> None:
    if verdict.evidence is None:
        return
    held = case.run("verify", lambda: kilter.verify(assembly, verdict.proof()))
    if held is not None:
        case.test("verify", held.holds, f"{held}")


def _plan(case: Case, assembly: Assembly, verdict: Any) -> None:
    order = case.run(
        "plan",
        lambda: kilter.plan(
            assembly, contacts=verdict.contact_set, require=verdict.require, effort=case.effort
        ),
    )
    if order is None or order.interrupted:
        return
    finished = order.finished
    case.test(
        "plan",
        (finished.verdict, finished.level) == (verdict.verdict, verdict.level),
        f"finished {finished.verdict}, check {verdict.verdict}",
    )
    if verdict.verdict == "unstable":
        case.test("plan", order.verdict == "impossible", f"{order.verdict} of a falling assembly")
    if order.found:
        case.test("plan", LEVELS.index(order.level) <= LEVELS.index(verdict.level), "level")


def _hold(case: Case, assembly: Assembly, verdict: Any) -> None:
    for level in ("equilibrium", "settles"):
        fixture = case.run(
            f"hold {level}",
            lambda level=level: kilter.hold(
                assembly, contacts=verdict.contact_set, require=level, most=3, effort=case.effort
            ),
        )
        if fixture is None:
            continue
        if holds(verdict.level, level):
            needless = fixture.supports or not fixture.holds
            case.test("hold", not needless, f"{fixture.supports} for {level}, which check reaches")
        if not fixture.holds:
            continue
        if fixture.supports:
            entry = next(e for e in fixture.proof()["proofs"] if e["about"] == "held")
            held, touching = apply_change(assembly, verdict.contact_set, entry["change"])
            other = case.run(
                "check", partial(kilter.check, held, contacts=touching, effort=case.effort)
            )
        else:
            other = verdict
        if other is not None:
            reached = holds(other.level, level)
            case.test("hold", reached, f"{fixture.supports} for {level}: {other.verdict}")


def _limits(case: Case, assembly: Assembly, verdict: Any) -> None:
    push = np.random.default_rng(case.seed).normal(size=3)
    push /= np.linalg.norm(push)
    if assembly.planar:
        push = np.array([1.0, 0.0, 0.0])
    free = [part.name for part in assembly.parts if not part.grounded]
    pushed = free[case.seed % len(free) :][:1] if free else []
    questions = [("equilibrium", push, pushed)]
    if case.effort == EFFORT:
        factor = (turn_of(case.seed) + FAMILIES.index(case.family)) // USUAL_EVERY % 2 == 0
        questions.append(("settles", push if factor else None, [] if factor else pushed))
    for level, force, names in questions:
        margin = case.run(
            f"margin {level}",
            lambda level=level, force=force, names=names: kilter.margin(
                assembly,
                contacts=verdict.contact_set,
                push=force,
                pushed=names,
                require=level,
                effort=case.effort,
            ),
        )
        if margin is None:
            continue
        beside = beside_limits(assembly, margin, push)
        if level != "equilibrium":
            beside = beside_level_limits(assembly, margin, force) if margin.at_level else ()
        for words, other, reached, expected in beside:
            answer = case.run("check", partial(_decide, other, verdict, reached))
            if answer is None:
                continue
            # open pairs, or a time limit, may leave either side undecided: this is no "holds"
            agrees = holds(answer.level, reached) is expected
            case.test(f"limit at {reached}", agrees, f"{words}: {answer.verdict}")


def _decide(assembly: Assembly, verdict: Any, level: str) -> Any:
    touching = verdict.contact_set
    if assembly.friction != verdict.assembly.friction:
        touching = touching.with_friction(assembly.friction)
    touching = touching.of(assembly)
    return kilter.check(assembly, contacts=touching, require=level, effort=verdict.effort)


def _region(case: Case, assembly: Assembly, verdict: Any) -> None:
    region = case.run("region", lambda: kilter.region(assembly, contacts=verdict.contact_set))
    if region is None or region.pairs_decide:
        return
    random = np.random.default_rng(case.seed)
    directions = [assembly.down, *random.normal(size=(DIRECTIONS, 3))]
    for down in directions:
        unit = np.array(down) / np.linalg.norm(down)
        if assembly.planar:
            unit = np.array([unit[0], 0.0, unit[2]]) / np.hypot(unit[0], unit[2])
        inside = bool(region.contains(unit, NEAR if region.dimension == 3 else 0.0))
        outside = bool((region.facets @ unit < -NEAR).any()) and region.complete
        if not (inside or outside):
            continue
        turned = assembly.with_down(unit)
        answer = case.run("check", lambda turned=turned: _decide(turned, verdict, "equilibrium"))
        if answer is not None:
            words = f"{unit.tolist()} is {'in' if inside else 'out'}side: {answer.verdict}"
            case.test("region", (answer.level is not None) is inside, words)


def _orient(case: Case, assembly: Assembly, verdict: Any) -> None:
    answer = case.run("orient", lambda: kilter.orient(assembly, contacts=verdict.contact_set))
    if answer is None or answer.verdict != "found":
        return
    turned = assembly.with_down(answer.down)
    there = case.run("check", lambda: _decide(turned, verdict, "equilibrium"))
    if there is not None:
        words = f"{answer.level} at {answer.down.tolist()}: {there.verdict} {there.level}"
        case.test("orient", there.level is not None and there.level == answer.level, words)


def _report(case: Case, assembly: Assembly, verdict: Any) -> None:
    shown = case.run(
        "report", lambda: everything(assembly, contacts=verdict.contact_set, effort=case.effort)
    )
    if shown is not None:
        same = shown.given.check["verdict"] == verdict.verdict
        case.test("report", same, f"page {shown.given.check['verdict']}")
    cell = html.unescape(verdict._repr_html_())
    case.test("report", verdict.sentence in cell, "the notebook has another sentence")


def _many(case: Case, assembly: Assembly, verdict: Any) -> None:
    many = case.run(
        "check_many", lambda: kilter.check_many([assembly], effort=case.effort).verdict.tolist()
    )
    if many is not None:
        case.test("many", many == [verdict.verdict], f"check_many {many}, check {verdict.verdict}")


def _batch(case: Case, verdict: Any, path: Path) -> None:
    rows = case.run(
        "batch", lambda: judged_rows([(0, str(path))], BatchQuestion(effort=case.effort))
    )
    for row in rows or ():
        agrees = (row["verdict"], row["level"]) == (verdict.verdict, verdict.level)
        words = f"batch {row['verdict']} {row['level']}, check {verdict.verdict} {verdict.level}"
        case.test("batch", agrees, words)


def _ladder(case: Case, assembly: Assembly, verdict: Any) -> None:
    if verdict.level is not None:
        return
    drawing = replace(assembly, source="drawing.step")
    rows = case.run("ladder", lambda: kilter.check(drawing, effort=case.effort).ladder)
    for row in rows or ():
        if not row.decided:
            continue
        options = {"assume": row.assume, "friction": row.friction, "effort": case.effort}
        typed = case.run("rung", partial(kilter.check, drawing, **options))
        if typed is not None:
            words = f"{row}: check {typed.verdict} {typed.level}, {len(typed.moving)} fall"
            same = (row.level is None) == (typed.level is None) and row.falls == len(typed.moving)
            case.test("ladder", same, words)


def main() -> int:
    """Run the census and print its counts; return 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=600)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--family", choices=FAMILIES, action="append")
    parser.add_argument("--real", type=Path, help="folder of real assemblies")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--log", type=Path, help="a row a case; cases that it has are not repeated")
    given = parser.parse_args()
    seeds = range(given.first, given.first + given.count)
    jobs = [(FAMILIES[k % len(FAMILIES)], k) for k in seeds]
    jobs = [job for job in jobs if job[0] in (given.family or FAMILIES)]
    known = {} if given.log is None else logged_cases(given.log)
    cases = [known[job] for job in jobs if job in known]
    left = [job for job in jobs if job not in known]
    version = ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"]
    commit = subprocess.run(version, capture_output=True, text=True, check=False).stdout.strip()
    folder = Path(tempfile.mkdtemp(prefix="agreement-"))
    with ProcessPoolExecutor(given.processes) as pool:
        futures = [pool.submit(judge, *job, given.real, folder) for job in left]
        for future in as_completed(futures):
            case = future.result()
            if case is None:
                continue
            cases.append(case)
            for text in case.wrong:
                print(text, flush=True)
            case.commit = commit
            if given.log is not None:
                with given.log.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(vars(case)) + "\n")
    return print_counts(cases)


if __name__ == "__main__":
    sys.exit(main())
