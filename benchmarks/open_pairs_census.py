"""Census of open pairs: each verdict must be valid for every possible contact set.

    python benchmarks/open_pairs_census.py           300 assemblies
    python benchmarks/open_pairs_census.py 1000 7    1,000 assemblies, from seed 7 on

Parts are pushed into overlap or out of contact by 1.5 to 50 gap tolerances
(`tests/scenes/random_pushed.py`). Each open pair is then absent, the intended contact, or a fixed
joint, in all combinations, with and without friction. The deciding set is compared with all sets
of open pairs. The exit code is 1 if there is a contradiction.
"""

from __future__ import annotations

import collections
import itertools
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from kilter import check
from kilter.analysis.decision.judge import judge
from kilter.analysis.decision.ordinary_contacts import with_ordinary_contacts
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index
from kilter.assembly import Assembly, Joint
from kilter.contact import ContactSet, contacts
from kilter.contact.contact_tolerances import GAP
from kilter.contact.open_pairs import OpenPair
from kilter.friction.answer import ask_friction
from kilter.mechanics.program import Program, build_program

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from random_pushed import pushed_assembly

MOST = 5
"""All combinations are tested for up to this many open pairs, else those with two changed pairs."""
ABSENT, ORDINARY, JOINED = range(3)


@dataclass(frozen=True)
class Scene:
    """An assembly as drawn, and the intended contacts."""

    drawn: Assembly
    meant: ContactSet


def touching(assembly: Assembly) -> tuple[Index, Array, Array]:
    """Contacts of an assembly: pairs of parts, normals and gap tolerances [length unit]."""
    found = contacts(assembly)
    gap = GAP * assembly.geometry.size[found.patch_parts].min(axis=1)
    return found.patch_parts, found.patch_normal, gap


def ways(count: int) -> Iterator[tuple[int, ...]]:
    """Yield the combinations of states of `count` open pairs."""
    if count <= MOST:
        yield from itertools.product(range(3), repeat=count)
        return
    for others in range(3):
        for some in itertools.combinations(range(count), 2):
            for values in itertools.product(range(3), repeat=2):
                way = [others] * count
                for place, value in zip(some, values, strict=True):
                    way[place] = value
                yield tuple(way)


def joined(assembly: Assembly, pairs: Sequence[OpenPair]) -> Assembly:
    """The assembly with fixed joints between the parts of the given pairs."""
    return assembly.with_joints([Joint(pair.parts) for pair in pairs])


def program_of(scene: Scene, verdict: Verdict, way: tuple[int, ...]) -> Program:
    """The program of a combination `way` of states of the open pairs."""
    pairs = verdict.contact_set.open_pairs
    ordinary = tuple(p for p, what in zip(pairs, way, strict=True) if what == ORDINARY)
    tied = [p for p, what in zip(pairs, way, strict=True) if what == JOINED]
    meant = with_ordinary_contacts(verdict.contact_set, scene.meant, ordinary)
    return build_program(joined(scene.drawn, tied), meant)


def contradictions(scene: Scene, verdict: Verdict, effort: float) -> list[str]:
    """Contact sets that contradict a verdict."""
    wrong = []
    word, rubs = verdict.verdict, verdict.friction_answer is not None
    for way in dict.fromkeys(ways(len(verdict.contact_set.open_pairs))):
        program = program_of(scene, verdict, way)
        holds = judge(program).stable
        if word == "unstable" and holds:
            wrong.append(f"unstable, but forces exist with {way}")
        if word in ("stable", "settles", "potentially-stable") and holds is False:
            wrong.append(f"{word}, but no forces with {way}")
        smooth = judge(program.frictionless).stable
        if word == "stable" and not rubs and smooth is False:
            wrong.append(f"stable, but without friction unstable with {way}")
        if word == "stable" and rubs and JOINED not in way and not smooth:
            answer = ask_friction(program, work=effort)
            if answer.guarantee == "refuted":
                wrong.append(f"proved, but a motion obeys the law with {way}")
    if word == "undecided":
        wrong += not_smallest(scene, verdict)
    return wrong


def not_smallest(scene: Scene, verdict: Verdict) -> list[str]:
    """Contradictions of the deciding set: it does not hold, or a smaller set holds."""
    if verdict.question is None:
        return [f"undecided without a set that decides: {verdict.sentence}"]
    pairs, chosen = verdict.contact_set.open_pairs, verdict.question.deciding
    inner = build_program(scene.drawn, verdict.contact_set)
    if judge(inner).stable:
        return ["undecided, but it holds as drawn"]
    wrong = []
    for size in range(len(pairs) + 1):
        sets = [
            some
            for some in itertools.combinations(pairs, size)
            if judge(build_program(joined(scene.drawn, some), verdict.contact_set)).stable
        ]
        if sets:
            break
    if size != len(chosen.pairs) or set(chosen.pairs) not in [set(some) for some in sets]:
        wrong.append(f"the set has {len(chosen.pairs)} pairs, the smallest {size}")
    if chosen.smallest != (len(pairs) <= 12):
        wrong.append("the flag `smallest` is wrong")
    return wrong


def asked(seed: int, effort: float = 1.0) -> tuple[str, list[str]]:
    """Answers and contradictions of a random scene, with its friction and without friction."""
    scene = pushed_assembly(seed, touching)
    answers, wrong = [], []
    for mu in dict.fromkeys((scene.drawn.friction, 0.0)):
        drawn = scene.drawn.with_friction(mu)
        one = Scene(drawn, contacts(scene.meant.with_friction(mu)))
        verdict = check(drawn, effort=effort)
        count = len(verdict.contact_set.open_pairs)
        answers.append(f"{verdict.verdict}, {min(count, 5)}{'+' * (count > 5)} open")
        wrong += [f"mu {mu:.3g}: {word}" for word in contradictions(one, verdict, effort)]
    return f"{scene.family:8} " + " | ".join(answers), wrong


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    words = sys.argv[1:]
    count = int(words[0]) if words else 300
    first = int(words[1]) if len(words) > 1 else 0
    answers: collections.Counter[str] = collections.Counter()
    found: list[str] = []
    started = time.process_time()
    for seed in range(first, first + count):
        answer, wrong = asked(seed)
        answers[answer] += 1
        found += [f"seed {seed}: {word}" for word in wrong]
        if wrong:
            print(f"seed {seed} ({answer}): {wrong[:3]}", flush=True)
    for answer, number in sorted(answers.items()):
        print(f"{number:>6}  {answer}")
    print(f"{len(found)} contradictions, {time.process_time() - started:.0f} s of CPU")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
