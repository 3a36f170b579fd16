"""Proofs of regions, with friction and in one file; tilt limits three ways."""

import copy
import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from cones import KINDS, MORE, region_of
from random_turned import random_turned, springer_arch
from scipy.optimize import linprog

import kilter
from kilter import Assembly, ContactSet, InputError, Mesh, Part, Region
from kilter.analysis.analysis_tolerances import BEYOND_CONE
from kilter.analysis.decision.judge import judge
from kilter.analysis.margins.tilt import TiltMargin, find_tilt_margin, tilt_about
from kilter.analysis.verification import proof_tolerance, verify_proof
from kilter.arrays import cross
from kilter.contact import detect
from kilter.files import from_dict, to_dict
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes import rails, scene, stacks, wedges
from sampled import sampled


@pytest.mark.slow
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_proofs_pass_verify(name):
    region = region_of(name)
    proofs = region.proofs()
    assert len(proofs) == _count(region)
    for proof in proofs:
        assembly = from_dict(json.loads(json.dumps(to_dict(proof.assembly))))
        data = json.loads(json.dumps(proof.data, allow_nan=False))
        answer = verify_proof(
            assembly, detect.contacts(assembly, tolerance=proof_tolerance(data)), data
        )
        stable = proof.about in ("ray", "line")
        # on the boundary a part may stand exactly above an edge: the forces prove equilibrium
        at_limit = stable and answer.level == "equilibrium" and not answer.reasons
        assert answer.holds or at_limit, (proof.about, proof.vector, answer.reasons)
        assert answer.verdict == ("stable" if stable else "unstable")
        assert bool(region.contains(proof.assembly.down)) == stable


def _count(region) -> int:
    equations = len(region.equations) - region.assemblies[0].planar
    return len(region.rays) + 2 * len(region.lines) + len(region.facets) + 2 * equations


def test_the_motion_of_a_facet_is_its_normal():
    region = kilter.region(wedges.corner_wedges())
    for proof in region.found[0].proofs:
        if proof.about != "facet":
            continue
        assembly = region.assemblies[0]
        sum_of_motions = assembly.geometry.mass @ proof.certificate.motion[:, :3]
        sum_of_motions /= np.linalg.norm(sum_of_motions)
        assert np.allclose(sum_of_motions, -proof.vector, atol=1e-7)
        # just outside, by one of the steps: which one suffices depends on the solver's vertex
        beyond = -proof.vector @ proof.down
        assert any(step <= beyond < 1.1 * step for step in BEYOND_CONE[:3]), beyond


def test_facets_are_not_claimed_where_friction_may_hold():
    assembly = rails.railed("-x -z").with_friction(0.5)
    region = kilter.common_region([assembly])
    assert {proof.about for proof in region.proofs()} == {"ray"}
    assert any("left out: friction" in text for text in region.warnings)


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
def test_proofs_with_friction_are_verified(planar):
    assembly = rails.railed("-z", planar=planar).with_friction(0.5)
    region = kilter.region(assembly, gap_deg=3.0)
    proofs = region.proofs()
    assert {proof.about for proof in proofs} >= {"ray", "facet"}
    assert region.proved
    for proof in proofs:
        assert verify_proof(proof.assembly, detect.contacts(proof.assembly), proof.data).holds


CASES = {
    "arch": lambda: springer_arch(4, 0.25, friction=0.7),
    "planar arch": lambda: springer_arch(5, 0.2, friction=0.6, planar=True),
    "pile": lambda: random_turned("pile", 6),
    "wedge": lambda: random_turned("wedge", 3),
    "thin": lambda: rails.railed("-x -z").with_friction(0.4),
    "stack": lambda: stacks.tower(3, friction=0.5).with_down([0.03, 0.01, -1]),
    "smooth": lambda: rails.railed("-x -z"),
}


def through_json(data):
    return json.loads(json.dumps(data, allow_nan=False))


@pytest.mark.slow
def test_one_number_flipped_is_caught():
    assembly = CASES["arch"]()
    data = through_json(kilter.region(assembly).proof())
    place = {entry["about"]: k for k, entry in enumerate(data["proofs"])}

    def broken(about, flip, *, signed=True):
        changed = copy.deepcopy(data)
        entry = changed["proofs"][place[about]]
        flip(entry)
        if signed:  # as one who knows how files are signed would
            entry["proof"]["digest"] = digest_of({**changed["common"], **entry["proof"]})
        return kilter.verify(assembly, changed)

    def turn(entry):
        entry["vector"] = [-x for x in entry["vector"]]

    def push(entry):
        entry["proof"]["forces"][3][2] += 1.0

    def still(entry):
        entry["proof"]["motion"]["v1"] = [0.0] * 6

    assert broken("ray", lambda entry: None).holds
    assert any("beyond another facet" in text for text in broken("facet", turn).reasons)
    assert not broken("ray", push).holds
    assert any("digest" in text for text in broken("ray", push, signed=False).reasons)
    assert not broken("facet", still).holds
    other = springer_arch(4, 0.24, friction=0.7)
    assert not kilter.verify(other, data).holds


def test_what_cannot_be_written_is_said():
    one = rails.railed("-x -z")
    with pytest.raises(InputError, match="several files"):
        kilter.common_region([one, one]).proof()


Bundle = dict[str, Any]
SCENES: dict[str, Callable[[], kilter.Assembly]] = {
    "ray": lambda: scene("tower"),
    "cone": lambda: scene("corner-wedges"),
    "fan": lambda: scene("paper-figure-10"),
    "friction": lambda: stacks.block_on_slope(0.0, friction=0.5),
}


@cache
def proof_of(name: str) -> Bundle:
    bundle: Bundle = json.loads(json.dumps(kilter.region(SCENES[name]()).proof()))
    return bundle


def verified(name: str, change: Callable[[Bundle], object]) -> kilter.Verification:
    """Result for a changed copy of a proof with a fresh digest."""
    bundle = copy.deepcopy(proof_of(name))
    change(bundle)
    bundle["digest"] = digest_of(bundle)
    return kilter.verify(SCENES[name](), bundle)


@pytest.mark.quick("cone")
@pytest.mark.parametrize("name", SCENES)
def test_a_whole_region_holds_and_states_its_gap(name):
    found = verified(name, lambda bundle: None)
    assert found.holds, found.reasons
    assert found.notes[0].startswith("a direction without a proof lies at most")


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["ray", "cone", "friction"])
@pytest.mark.parametrize("subject", ["ray", "facet", "equation"])
def test_a_region_without_some_of_its_proofs_is_not_closed(name, subject):
    left = [entry for entry in proof_of(name)["proofs"] if entry["about"] == subject]
    if not left:
        pytest.skip("this region has none")
    if name == "friction":  # of a round boundary a single facet is within the stated gap
        left = left[: len(left) // 2]

    def without(bundle: Bundle) -> None:
        bundle["proofs"] = [entry for entry in bundle["proofs"] if entry not in left]

    found = verified(name, without)
    assert not found.holds
    assert any("rays and facets differ by" in reason for reason in found.reasons)


def test_a_motion_of_an_unknown_part_is_a_reason():
    def other(bundle: Bundle) -> None:
        entry = next(entry for entry in bundle["proofs"] if entry["about"] == "facet")
        entry["proof"]["motion"]["nobody"] = [0.0] * 6

    assert not verified("cone", other).holds


CASES_FRICTION = sampled(4, [("arch", 1), ("pile", 4), ("wedge", 1), ("round", 5), ("arch", 3),
                             ("arch", 5), ("pile", 9), ("wedge", 4), ("round", 6),
                             ("round", 11)])  # fmt: skip


@cache
def asked(family: str, seed: int) -> tuple[Assembly, ContactSet, Program, Region]:
    """An assembly with its contacts, its program and its region."""
    assembly = random_turned(family, seed)
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return assembly, contacts, program, kilter.region(assembly, contacts=contacts)


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), CASES_FRICTION)
def test_every_direction_is_judged_as_the_region_says(family, seed):
    assembly, _, program, found = asked(family, seed)
    assert found.proved
    assert (found.gap_deg or 0.0) <= 0.1
    random = np.random.default_rng(seed)
    directions = random.normal(size=(30, 3))
    points = np.array([p.vector for p in found.found[0].proofs if p.about == "ray"])
    if len(points):  # half of them near the boundary
        scatter = 0.05 * random.normal(size=(15, 3))
        directions[:15] = points[random.integers(0, len(points), size=15)] + scatter
    if assembly.planar:
        directions[:, 1] = 0.0
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    slack = found.found[0].slack + 1e-6
    for down in directions:
        if found.contains(down):
            assert judge(program.turned(down)).stable is not False
        elif not found.exact and (found.facets @ down).min(initial=1.0) < -np.sin(slack):
            assert judge(program.turned(down)).stable is not True


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), CASES_FRICTION)
def test_three_margins_are_one(family, seed):
    assembly, contacts, program, found = asked(family, seed)
    turned = kilter.orient(assembly, contacts=contacts)
    gap = (found.gap_deg or 0.0) + 1e-6
    assert (turned.verdict == "found") == (found.kind != "none")
    if found.dimension == 3 and found.half_angle_deg < 90:
        assert turned.tilt_margin_deg == pytest.approx(found.half_angle_deg, abs=gap)
    tilt = find_tilt_margin(program)
    if isinstance(tilt, TiltMargin) and tilt.limit.motion is not None:
        inner = np.degrees(found.cone.depth(program.down))
        outer = np.degrees(np.arcsin(np.clip((found.facets @ program.down).min(), -1, 1)))
        assert inner - 1e-7 <= np.degrees(tilt.angle) <= outer + 1e-6
        assert outer - inner <= 2 * gap
        for step, held in ((-1e-6, True), (1e-6, False)):
            aside = tilt.down - (tilt.down @ program.down) * program.down
            aside /= np.linalg.norm(aside)
            angle = tilt.angle + step
            there = np.cos(angle) * program.down + np.sin(angle) * aside
            assert judge(program.turned(there)).stable is not (not held)


FACES = np.array([[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6], [0, 5, 1], [0, 4, 5],
                  [1, 6, 2], [1, 5, 6], [2, 7, 3], [2, 6, 7], [3, 4, 0], [3, 7, 4]])  # fmt: skip
AZIMUTHS = np.radians([0, 45, 90, 135, 180, 225, 270, 315])


def wedge(name: str, low, high, **options) -> Part:
    """The part of a pyramid with its tip in the origin over a rectangle of z = 1, z 1 to 1.2."""
    (x, y), (u, v) = low, high
    base = np.array([[x, y, 1.0], [x, v, 1.0], [u, v, 1.0], [u, y, 1.0]])
    return Part(name, Mesh(np.concatenate([base, 1.2 * base]), FACES), **options)


def shell(rows: int = 8, each: int = 5, seed: int = 2) -> Assembly:
    """Rows of wedges whose joints never line up, between four held ones."""
    random = np.random.default_rng(seed)
    ys = np.linspace(-0.2, 0.2, rows + 1)
    ys[1:-1] += random.uniform(-0.008, 0.008, rows - 1)
    parts = []
    for row in range(rows):
        xs = np.linspace(-0.25, 0.25, each + 1)
        xs[1:-1] += random.uniform(-0.03, 0.03, each - 1)
        parts += [
            wedge(f"w{row}-{k}", (xs[k], ys[row]), (xs[k + 1], ys[row + 1])) for k in range(each)
        ]
    frame = {
        "north": ((-0.35, 0.2), (0.35, 0.3)),
        "south": ((-0.35, -0.3), (0.35, -0.2)),
        "west": ((-0.35, -0.2), (-0.25, 0.2)),
        "east": ((0.25, -0.2), (0.35, 0.2)),
    }
    parts += [wedge(name, *corners, grounded=True) for name, corners in frame.items()]
    return Assembly(parts)


def held(program: Program, down) -> bool:
    """Whether some f >= 0 has J^T f + w = 0: written apart, from J alone."""
    jacobian = program.jacobian().toarray()
    weight = np.zeros((len(program.names), 6))
    weight[:, :3] = program.mass[:, None] * np.asarray(down)
    load = weight[program.free].reshape(-1) / program.mass.max()
    answer = linprog(
        np.zeros(len(jacobian)), A_eq=jacobian.T, b_eq=-load, bounds=(0, None), method="highs-ds"
    )
    return answer.status == 0


def by_bisection(program: Program, aside) -> float:
    """Largest tilt of gravity toward `aside` that is held [deg]."""
    low, high = 0.0, 89.0
    while high - low > 2e-5:
        middle = (low + high) / 2
        angle = np.radians(middle)
        down = np.cos(angle) * program.down + np.sin(angle) * aside
        low, high = (middle, high) if held(program, down) else (low, middle)
    return (low + high) / 2


@pytest.fixture(scope="module")
def found():
    assembly = shell()
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return assembly, program, kilter.region(assembly, contacts=contacts)


@pytest.mark.slow
def test_tilt_limits_at_eight_azimuths_agree(found):
    _, program, region = found
    assert int(program.free.sum()) == 40
    assert region.kind == "cone"
    assert region.proved
    for azimuth in AZIMUTHS:
        aside = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        tilt = tilt_about([program], cross(program.down, aside))
        expected = by_bisection(program, aside)
        assert tilt.tilt_deg == pytest.approx(expected, abs=1e-4)
        assert tilt.limit.gap < 2e-5
        # q.(cos t down + sin t aside) = 0 at the facet that is met first
        with np.errstate(divide="ignore"):
            turns = np.arctan2(region.facets @ program.down, -(region.facets @ aside))
        assert np.degrees(turns[turns > 0].min()) == pytest.approx(expected, abs=1e-4)


@pytest.mark.slow
def test_the_nearest_is_the_margin(found):
    _, program, region = found
    tilt = find_tilt_margin(program)
    nearest = np.degrees(np.arcsin((region.facets @ program.down).min()))
    assert np.degrees(tilt.angle) == pytest.approx(nearest, abs=1e-6)
    assert np.degrees(tilt.lower) == pytest.approx(nearest, abs=1e-6)
