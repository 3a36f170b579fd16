"""Open pairs: those that decide, bad fits, and coefficients that are offered."""

import importlib.util
import json
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from judged import judged, reloaded, verified
from random_fits import random_fit
from random_voronoi import random_voronoi
from staggered_dome import staggered_dome

from kilter import (
    Assembly,
    ContactSet,
    FrictionPair,
    Joint,
    Tolerance,
    check,
    contacts,
    load,
)
from kilter.analysis.decision import deciding_pairs
from kilter.analysis.decision import judge as judging
from kilter.analysis.decision.deciding_pairs import (
    MOST,
    DecidingPairs,
    find_deciding,
    joining_wrenches,
)
from kilter.analysis.decision.judge import Judgement, judge
from kilter.arrays import Index, connected
from kilter.contact.contact_tolerances import GAP
from kilter.contact.open_pairs import OpenPair, rigid_groups
from kilter.mechanics.locked_parts import merge_parts
from kilter.mechanics.mechanics_tolerances import RULED_OUT
from kilter.mechanics.program import Program, build_program
from kilter.scenes.pieces import block, floor
from sampled import sampled

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
REAL = pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here: ../shared/data")


def resting(gap: float, **options: object) -> Assembly:
    """A unit cube `gap` over a slab."""
    cube = block("cube", [-0.5, -0.5, gap], [0.5, 0.5, 1 + gap])
    return Assembly([floor([-2, -2], [2, 2]), cube], **options)


@pytest.mark.slow
@pytest.mark.parametrize("tolerances", [1.5, 50.0, -1.5, -50.0, -5000.0])
def test_what_is_not_quite_in_contact_is_undecided_and_decides(tolerances):
    verdict = judged(resting(tolerances * GAP * 3**0.5))
    assert verdict.verdict == "undecided"
    answer = verdict.to_dict()
    (pair,) = answer["open_pairs"]
    assert (pair["kind"], pair["decides"]) == ("near" if tolerances > 0 else "overlap", True)
    assert answer["if_joined"] == {
        "pairs": [pair["parts"]],
        "verdict": "stable",
        "smallest": True,
        "irreducible": True,
    }
    assert "as drawn it falls; it would hold if 'floor' and 'cube'" in verdict.sentence
    joined = verdict.assembly.with_joints([Joint(("floor", "cube"))])
    assert judged(joined).verdict == "stable"


@pytest.mark.quick(2)
@pytest.mark.parametrize("gap", [1e-4, -1e-4, -0.3])
def test_what_no_open_pair_can_hold_is_unstable_and_its_proof_names_them(gap):
    resting_parts = resting(gap).parts
    assembly = Assembly([*resting_parts, block("loose", [-0.5, -0.5, 3], [0.5, 0.5, 4])])
    verdict = judged(assembly)
    assert verdict.verdict == "unstable"
    proof = json.loads(json.dumps(verdict.proof()))
    kind = "near" if gap > 0 else "overlap"
    assert proof["open_pairs"] == [{"parts": ["floor", "cube"], "kind": kind}]
    answer = verified(reloaded(assembly), proof)
    assert answer.holds
    assert any("1 open pairs" in note for note in answer.notes)
    # a motion that an open pair could stop proves nothing
    proof["motion"]["cube"] = [0.0, 0, -1, 0, 0, 0]
    assert not verified(reloaded(assembly), proof).holds
    assert not any(pair["decides"] for pair in verdict.to_dict()["open_pairs"])


def test_the_smallest_set_is_found_among_many_and_the_rest_do_not_decide():
    # a tower of four over a gap between the second and the third; a wall beside all of them
    gap = 1e-4
    heights = [0.0, 1.0, 2.0 + gap, 3.0 + gap]
    tower = [block(f"c{k}", [0, 0, z], [1, 1, z + 1]) for k, z in enumerate(heights)]
    wall = block("wall", [1 + gap, 0, 0], [2, 1, 5], grounded=True)
    verdict = judged(Assembly([floor([-2, -2], [3, 3]), *tower, wall]))
    answer = verdict.to_dict()
    assert len(answer["open_pairs"]) == 5
    assert answer["if_joined"]["smallest"]
    assert len(answer["if_joined"]["pairs"]) == 1
    (pair,) = answer["if_joined"]["pairs"]
    assert set(pair) in ({"c1", "c2"}, {"c2", "wall"})


@pytest.mark.slow
@pytest.mark.parametrize("count", [MOST, MOST + 1])
def test_of_many_open_pairs_none_of_the_set_can_be_left_out(count):
    cubes = [block(f"c{k}", [2 * k, 0, 1e-4], [2 * k + 1, 1, 1]) for k in range(count)]
    verdict = check(Assembly([floor([-2, -2], [60, 3]), *cubes]))
    joined = verdict.to_dict()["if_joined"]
    assert joined["smallest"] == (count <= MOST)
    assert {name for pair in joined["pairs"] for name in pair} == {
        "floor",
        *(f"c{k}" for k in range(count)),
    }


def sloped(gap: float, mu: float) -> Assembly:
    """A cube on a slope of 20 degrees, its downhill end over a second support `gap` below."""
    rough = block("rough", [-1, -1, -1], [0.3, 1, 0], grounded=True)
    smooth = block("smooth", [0.3, -1, -1 - gap], [1, 1, -gap], grounded=True)
    pairs = [FrictionPair(("smooth", "cube"), mu)]
    cube = block("cube", [-0.5, -0.5, 0], [0.5, 0.5, 1])
    down = [np.sin(np.radians(20)), 0, -np.cos(np.radians(20))]
    parts = [rough, smooth, cube]
    return Assembly(parts, friction=0.5, friction_pairs=pairs).with_down(down)


@pytest.mark.slow
def test_what_friction_proves_holds_with_the_open_pairs_as_contacts_too():
    assert judged(sloped(5e-3, 0.01)).verdict == "stable"  # nothing is open
    touching = judged(sloped(0.0, 0.01))
    assert touching.guarantee == "refuted"
    for gap in (1e-4, -1e-4):
        verdict = judged(sloped(gap, 0.01))
        assert verdict.verdict == "potentially-stable"
        assert any("'smooth' and 'cube'" in text for text in verdict.warnings)


def test_a_widened_tolerance_says_what_it_rests_on():
    wide = check(resting(5e-4), tolerance=Tolerance(gap=1e-3))
    assert wide.verdict == "stable"
    assert wide.to_dict()["counted_gap"] == pytest.approx(5e-4)
    assert wide.sentence.startswith("Stable, counting gaps up to 0.0005 m as closed")
    assert "without friction" not in wide.sentence
    exact = check(resting(0.0), tolerance=Tolerance(gap=1e-3))
    assert exact.to_dict()["counted_gap"] is None
    assert "without friction" in exact.sentence


def census() -> object:
    path = BENCHMARKS / "open_pairs_census.py"
    spec = importlib.util.spec_from_file_location("open_pairs_census", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 5, 7, 8, 11])
def test_no_contact_set_between_contradicts_a_verdict(seed):
    assert census().asked(seed)[1] == []  # type: ignore[attr-defined]


@pytest.mark.slow
@REAL
def test_curved_joints_that_are_cut_differently_are_not_called_unstable():
    blocks = load(DATA / "compas_cra" / "curve-3-blocks.json", ground=["0"]).with_friction(0.84)
    assert check(blocks, effort=0).verdict != "unstable"


def joined(program: Program, group: Index, pairs: list[OpenPair]) -> bool | None:
    """Whether forces of equilibrium exist with these pairs joined, by a program of its own."""
    ends = np.array([pair.ends for pair in pairs], dtype=np.int64).reshape(-1, 2)
    same = np.argmax(group[:, None] == group[None], axis=1)
    first = np.concatenate([np.arange(len(group)), ends[:, 0]])
    label = connected(len(group), first, np.concatenate([same, ends[:, 1]]))
    bodies = np.unique(label, return_inverse=True)[1].reshape(-1)
    return judge(merge_parts(program, bodies)).stable


def opened(assembly: Assembly, seed: int) -> tuple[Program, Index, list[OpenPair]]:
    """The program without the contacts of random pairs, and these pairs as open pairs."""
    random = np.random.default_rng(seed)
    touching: ContactSet = contacts(assembly)
    pairs = np.unique(np.sort(touching.patch_parts, axis=1), axis=0)
    chosen = pairs[random.random(len(pairs)) < 0.6]
    kinds = random.choice(["overlap", "near", "clearance"], len(chosen))
    open_pairs = [
        OpenPair((int(a), int(b)), kind, gap=float(random.uniform(0, 1e-3)))
        for (a, b), kind in zip(chosen, kinds, strict=True)
    ]
    program = build_program(assembly, touching)
    ends = np.sort(np.column_stack([program.part_a, program.part_b]), axis=1)
    is_open = (ends[:, None] == chosen[None]).all(axis=2).any(axis=1)
    return program.taking(np.flatnonzero(~is_open)), rigid_groups(assembly), open_pairs


def asserted(program: Program, group: Index, answer: DecidingPairs) -> None:
    """The set holds, and if it is called irreducible, no pair can be left out."""
    pairs = list(answer.pairs)
    assert joined(program, group, pairs) is True
    if answer.irreducible:
        for k in range(len(pairs)):
            assert joined(program, group, pairs[:k] + pairs[k + 1 :]) is False


def asked(seed: int, most: int) -> None:
    """Compare the search on a random assembly with all subsets of its open pairs."""
    program, group, pairs = opened(random_voronoi(seed), seed)
    if judge(program).stable is not False:
        return
    answer = find_deciding(program, group, pairs)
    if answer is None:
        assert joined(program, group, pairs) is not True
        return
    asserted(program, group, answer)
    assert answer.irreducible
    if len(pairs) > most:
        return
    sizes = (
        size
        for size in range(len(pairs) + 1)
        if any(joined(program, group, list(some)) for some in combinations(pairs, size))
    )
    least = next(sizes)
    assert len(answer.pairs) >= least
    assert not answer.smallest or len(answer.pairs) == least


@pytest.mark.slow
@pytest.mark.parametrize("most", [0, 12])
@pytest.mark.parametrize("block", range(6))
def test_random_sets_decide_and_agree_with_all_subsets(block, most, monkeypatch):
    monkeypatch.setattr(deciding_pairs, "MOST", most)
    for seed in range(10 * block, 10 * block + 10):
        asked(seed, 7)


@pytest.mark.quick(2)
@pytest.mark.parametrize("rows", [1, 2000, 10**6])
def test_a_search_that_stops_reports_a_set_that_holds(rows, monkeypatch):
    assembly = staggered_dome(1, rings=5, per_ring=10)
    touching = contacts(assembly)
    assert {pair.kind for pair in touching.open_pairs} == {"overlap"}
    assert len(touching.open_pairs) == 2 * 4 * 10
    program, group = build_program(assembly, touching), rigid_groups(assembly)
    monkeypatch.setattr(deciding_pairs, "FREE_ROWS", rows)
    monkeypatch.setattr(deciding_pairs, "JUDGEMENTS", 0)
    answer = find_deciding(program, group, touching.open_pairs)
    assert answer is not None
    asserted(program, group, answer)
    assert answer.irreducible == (rows == 10**6)
    assert not answer.smallest


def test_the_least_wrench_of_a_single_pair_is_the_weight_and_its_torque():
    assembly = staggered_dome(2, rings=2, per_ring=8)
    group = rigid_groups(assembly)
    program = build_program(assembly, contacts(assembly)).taking(np.empty(0, np.int64))
    free = np.flatnonzero(program.free)
    # each free block hangs by a wrench at its held neighbour, whose mass is smaller or larger
    held = np.flatnonzero(~program.free)
    ends = np.column_stack([held[: len(free)], free])
    norms = joining_wrenches(program, ends)
    assert norms is not None
    smaller = np.where(program.radius[ends[:, 0]] <= program.radius[free], ends[:, 0], free)
    unit = np.exp(np.log(program.weight[free]).mean())
    arm = program.center[free] - program.center[smaller]
    torque = np.linalg.norm(np.cross(arm, [0.0, 0.0, -1.0]), axis=1) / program.radius[smaller]
    expected = program.weight[free] / unit * np.hypot(1.0, torque)
    assert norms == pytest.approx(expected, rel=1e-6)
    assert len(np.unique(group)) == len(free) + 1


@pytest.mark.slow
def test_a_dome_of_a_thousand_pairs_is_searched_within_its_work():
    assembly = staggered_dome(0)
    touching = contacts(assembly)
    assert len(touching.open_pairs) == 1008
    program, group = build_program(assembly, touching), rigid_groups(assembly)
    answer = find_deciding(program, group, touching.open_pairs)
    assert answer is not None
    assert joined(program, group, list(answer.pairs)) is True
    assert answer.programs < 300


@pytest.mark.parametrize(("play", "first"), [(0.01, "plate"), (0.5, "nut")])
def test_a_clearance_too_wide_for_a_fit_is_the_last_to_be_asked_about(play, first):
    """A screw that hangs between a plate with a hole and a nut of free-form threads, both held."""
    parts = [block(name, [3 * k, 0, 0], [3 * k + 1, 1, 1]) for k, name in enumerate("abc")]
    names = ("plate", "nut", "screw")
    held = [
        replace(part, name=n, grounded=n != "screw") for part, n in zip(parts, names, strict=True)
    ]
    assembly = Assembly(held)
    pairs = [OpenPair((0, 2), "clearance", gap=play), OpenPair((1, 2), "free-form", gap=0.0)]
    program = build_program(assembly, contacts(assembly))
    answer = find_deciding(program, rigid_groups(assembly), pairs)
    assert answer is not None
    assert answer.smallest
    assert [names[pair.ends[0]] for pair in answer.pairs] == [first]


SEEDS, BLOCK = 200, 10


def proves_by_matrix(program: Program, judgement: Judgement) -> bool:
    """Recheck the proof of a judgement by the matrix J alone, not by the certificate."""
    rows, per = program.jacobian(), len(program.freedoms)
    radius = np.where(np.arange(6) < 3, 1.0, program.radius[program.free, None])
    load = program.load[program.free]
    if judgement.stable:
        forces = judgement.forces.forces
        assert (forces[~program.two_sided] >= 0.0).all()
        rest = ((rows.T @ forces).reshape(-1, per) + load) / radius
        rounded = 1e-14 * program.force_sums(forces)[program.free, None]
        return bool((np.abs(rest) <= 2e-9 * program.weight[program.free, None] + rounded).all())
    motion = judgement.motion.motion[program.free]
    opening = rows @ motion.reshape(-1)
    violation = np.where(program.two_sided, np.abs(opening), -opening).max(initial=0.0)
    moving = np.abs(motion * radius).max(axis=1) > 0.0
    power = (load * motion).sum()
    weight = program.weight[program.free][moving].max()
    return bool(power > 0.0 and power >= RULED_OUT * violation * weight)


@pytest.mark.parametrize("start", sampled(1, range(0, SEEDS, BLOCK)))
def test_each_assembly_with_a_bad_fit_is_proved(start):
    for seed in range(start, start + BLOCK):
        program = random_fit(seed)
        judgement = judge(program)
        assert judgement.stable is not None, (seed, judgement)
        assert proves_by_matrix(program, judgement), seed


@pytest.mark.parametrize("seed", sampled(3, 40))
def test_rounded_rows_alone_prove_the_same(seed, monkeypatch):
    program = random_fit(seed)
    known = judge(program).stable
    monkeypatch.setattr(judging, "_by_load_factor", lambda *_, **__: iter(()))
    monkeypatch.setattr(judging, "_by_equilibrium", lambda *_: iter(()))
    rounded = judging._by_rounded_rows
    monkeypatch.setattr(
        judging, "_candidates_without_friction",
        lambda program, work: rounded(judging.scaled_problem(program), work),
    )  # fmt: skip
    assert judge(program).stable is known


@pytest.mark.parametrize("seed", sampled(3, 40))
def test_a_program_of_many_points_is_proved_from_rounded_rows(seed, monkeypatch):
    program = random_fit(seed)
    known = judge(program).stable
    monkeypatch.setattr(judging, "MANY_POINTS", 0)
    tried = []
    once = judging._by_least_imbalance

    def noted(problem, **options):
        tried.append(options["presolve"])
        yield from once(problem, **options)

    monkeypatch.setattr(judging, "_by_least_imbalance", noted)
    judgement = judge(program)
    assert tried[:1] in ([], [False])  # an earlier method proves a few of these programs
    assert judgement.stable is known
    assert proves_by_matrix(program, judgement)
