"""Edges and corners: contacts of an oracle, constraints of first order, and verdicts."""

import dataclasses
from dataclasses import dataclass
from itertools import islice

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation
from sharp_oracle import (
    CLEAR,
    Body,
    Convex,
    contacts,
    enters,
    pairs_of_cubes,
    stacked,
    tips_on_cubes,
)

from kilter import Assembly, Box, Load, Mesh, Part, Pose, Prism, check
from kilter.analysis.decision.degenerate_branches import decide_degenerate
from kilter.analysis.verification import verify_proof
from kilter.contact import ContactSet, detect
from kilter.mechanics.degenerate import allowed_program, without_degenerate
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import block, floor, prism, turn
from sampled import sampled

KINDS = ("vertex-face", "edge-face", "edge-edge")
SEEDS = sampled(1, [range(8), range(8, 20)])


def assembly_of(a: Convex, b: Convex) -> Assembly:
    parts = [
        Part(n, Mesh(x.corners, x.triangles), grounded=n == "a") for n, x in (("a", a), ("b", b))
    ]
    return Assembly(parts)


def compared(kind: str, gap: float, tilt: float, seed: int, *, swap: bool = False) -> list[str]:
    """Differences between the contacts of the search and those of the oracle."""
    a, b = stacked(kind, gap, tilt, np.random.default_rng(seed))
    if swap:
        a, b = b, a
    assembly = assembly_of(a, b)
    found = detect.contacts(assembly)
    size = float(assembly.geometry.size.min())
    expected = contacts(a, b, 1e-5 * size)
    wrong = []
    if len(found.degenerate):
        wrong.append("degenerate")
    if found.patch_kind.tolist() != [kind] or len(expected) != 1:
        return [*wrong, f"{found.patch_kind} for {len(expected)} of {kind}"]
    points, normal = expected[0].points, expected[0].normal
    if len(found.points) != len(points):
        return [*wrong, f"{len(found.points)} points for {len(points)}"]
    apart = np.linalg.norm(found.points[:, None] - points[None], axis=2)
    if (
        apart.min(axis=1).max() > 1e-7 * size + (2 * gap if tilt else 0)
        or (apart.min(axis=0)).max() > 1e-5 * size
    ):
        wrong.append(f"points off by {apart.min(axis=1).max():.1e}")
    if np.abs(found.normals - normal).max() > 1e-9 + (1e-3 if tilt else 0):
        wrong.append(f"normal off by {np.abs(found.normals - normal).max():.1e}")
    if not tilt and np.abs(found.patch_gap - gap).max() > 1e-11:
        wrong.append(f"gap {found.patch_gap} for {gap}")
    return wrong


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-7, 1e-6])
@pytest.mark.parametrize("seeds", SEEDS)
def test_contact_is_found_and_no_other(kind, gap, seeds):
    wrong = {}
    for seed in seeds:
        answer = compared(kind, gap, 0.0, seed, swap=bool(seed % 2))
        if answer:
            wrong[seed] = answer
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tilt", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("seeds", SEEDS)
def test_tilted_contact_is_found_and_no_other(kind, tilt, seeds):
    wrong = {seed: answer for seed in seeds if (answer := compared(kind, 1e-7, tilt, seed))}
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("gap", [2e-5, 1e-3])
def test_nothing_is_found_across_a_gap(kind, gap):
    for seed in range(20):
        a, b = stacked(kind, 2 * gap, 0.0, np.random.default_rng(seed))
        found = detect.contacts(assembly_of(a, b))
        assert len(found) == 0
        assert found.unsupported == ()


Array = NDArray[np.float64]
FAMILIES = {"cubes": pairs_of_cubes, "tips": tips_on_cubes}


@dataclass
class Examined:
    """The tests of a pair of bodies, and the errors."""

    counts: list[int]
    wrong: list[str]
    kinds: list[str]


def posed(a: Body, b: Body, rng: np.random.Generator) -> tuple[Assembly, Body, Body]:
    """Both bodies in the same random pose."""
    turn = Rotation.random(rng=rng)
    shift = rng.normal(size=3)
    parts = [
        Part(name, Mesh(body.vertices, body.triangles), Pose(shift, turn.as_quat()[[3, 0, 1, 2]]),
             grounded=name == "a")
        for name, body in (("a", a), ("b", b))
    ]  # fmt: skip
    rotation = turn.as_matrix()
    return Assembly(parts), a.moved(rotation, shift), b.moved(rotation, shift)


def rows_of(assembly: Assembly, contacts: ContactSet) -> tuple[Array, list[Array]]:
    """Constraints on the motion of b about its centre: rows, and clauses of rows."""
    program = build_program(assembly, contacts)
    center = assembly.geometry.center[1]
    sign = np.where(program.part_b == 1, 1.0, -1.0)[:, None]
    rows = sign * lever(program.point - center, program.normal)
    points = contacts.degenerate
    clauses = []
    for k in range(len(points)):
        normals = points.normals[points.start[k] : points.start[k + 1]]
        sense = 1.0 if points.part_b[k] == 1 else -1.0
        arm = np.tile(points.points[k] - center, (len(normals), 1))
        clauses.append(sense * lever(arm, normals))
    return rows, clauses


def lever(arm: Array, normal: Array) -> Array:
    return np.hstack([normal, np.cross(arm, normal)])


def motion_within(rows: Array, right: Array, aim: Array) -> Array | None:
    """The motion of size at most 1 furthest along `aim` with rows @ motion >= right."""
    answer = linprog(-aim, A_ub=-rows, b_ub=-right, bounds=[(-1, 1)] * 6, method="highs")
    return answer.x if answer.status == 0 else None


def examine(a: Body, b: Body, rng: np.random.Generator, motions: int = 12) -> Examined:
    """Motions that are allowed, and motions that break a single constraint, against the oracle."""
    assembly, a, b = posed(a, b, rng)
    contacts = detect.contacts(assembly)
    center = assembly.geometry.center[1]
    rows, clauses = rows_of(assembly, contacts)
    result = Examined([0, 0, 0, 0], [], contacts.patch_kind.tolist())
    result.counts[3] = len(clauses)

    def branch() -> Array:
        chosen = [clause[rng.integers(len(clause))] for clause in clauses]
        return np.vstack([rows, *(c[None] for c in chosen)])

    for _ in range(motions):
        free = branch()
        motion = motion_within(free, np.zeros(len(free)), rng.normal(size=6))
        if motion is None or np.abs(motion).max() < 0.5 or crosses(assembly, contacts, motion):
            continue
        result.counts[0] += 1
        if enters(a, b, motion, center):
            result.wrong.append(f"lost: {motion.round(3).tolist()} enters")
    for k in range(len(rows)):
        same = np.abs(branch() - rows[k]).max(axis=1) < 1e-6
        free = branch()
        right = np.where(same, -np.inf, 0.0)
        keep = ~same
        bound = np.vstack([free[keep], -rows[k][None]])
        right = np.append(np.zeros(int(keep.sum())), CLEAR)
        motion = motion_within(bound, right, rng.normal(size=6))
        if motion is not None:
            result.counts[1] += 1
            if not enters(a, b, motion, center):
                result.wrong.append(f"invented: row {k} {motion.round(3).tolist()} enters not")
    for clause in clauses:
        free = np.vstack([branch(), -clause])
        keep = ~(np.abs(free[:, None] - clause[None]).max(axis=2) < 1e-6).any(axis=1)
        right = np.where(np.arange(len(free)) >= len(free) - len(clause), CLEAR, 0.0)
        motion = motion_within(free[keep], right[keep], rng.normal(size=6))
        if motion is not None:
            result.counts[2] += 1
            if not enters(a, b, motion, center):
                result.wrong.append(f"invented clause: {motion.round(3).tolist()} enters not")
    return result


def crosses(assembly: Assembly, contacts: ContactSet, motion: Array) -> bool:
    """Whether a motion that all points allow enters on a line between degenerate points."""
    both = np.vstack([np.zeros(6), motion])
    program = allowed_program(assembly, contacts, both)
    return program is not None and program.velocities(both).min(initial=0.0) < -1e-7


@pytest.mark.slow
@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("seed", sampled(1, 3))
def test_no_constraint_is_lost_or_invented(name, seed):
    counts = np.zeros(4, dtype=int)
    wrong = []
    for k, (a, b) in enumerate(islice(FAMILIES[name](seed), 8)):
        result = examine(a, b, np.random.default_rng(k), 8)
        counts += result.counts
        wrong += [f"{name}/{seed}/{k}: {w}" for w in result.wrong]
    assert not wrong, "\n".join(wrong)
    assert (counts > 1).all()  # each question was asked


FLOOR = floor([-9, -9], [9, 9])


def judged(assembly: Assembly, *, pushed: bool = True) -> str:
    """The verdict, with its proof verified on recomputed contacts."""
    verdict = check(assembly)
    if verdict.verdict != "undecided":
        answer = verify_proof(assembly, detect.contacts(assembly), verdict.proof())
        assert answer.holds, answer.reasons
        assert answer.verdict == verdict.verdict
    return verdict.verdict if pushed else verdict.first_order


# the paper's Figure 2 --------------------------------------------------------------------


def test_a_bend_has_three_constraints_in_the_plane():
    # m touches n along ab; beyond b the surface of n bends towards m, along bc
    n = Prism([[0, 0], [1, 0], [2, 1], [2, -1], [0, -1]], 1)
    m = Prism([[0.2, 0], [1, 0], [1, 1], [0.2, 1]], 1)
    contacts = detect.contacts(Assembly([Part("n", n, grounded=True), Part("m", m)]))
    slope = np.array([-1, 0, 1]) / np.sqrt(2)
    assert sorted(contacts.patch_kind) == ["edge-face", "plane"]
    in_plane = {
        (round(x, 9), round(z, 9), *np.round(normal[[0, 2]], 9))
        for (x, _, z), normal in zip(contacts.points, contacts.normals, strict=True)
    }
    half = round(float(slope[2]), 9)
    assert in_plane == {(0.2, 0, 0, 1), (1, 0, 0, 1), (1, 0, -half, half)}
    assert contacts.unsupported == ()


# ladder ----------------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [20, 45, 70])
@pytest.mark.parametrize(
    ("share", "word"), [(1.0, "stable"), (1 - 1e-6, "unstable"), (1 + 1e-6, "unstable")]
)
def test_a_ladder_without_friction_needs_one_push_exactly(degrees, share, word):
    # about the foot: wall force N at height h, weight at d from the foot: N h = W d
    angle = np.radians(degrees)
    long, thick = 4.0, 0.2
    corners = np.array([[-long, 0.0], [0, 0], [0, thick], [-long, thick]])
    spin = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    corners = corners @ spin.T  # x, z; foot at the origin, rising to the left
    wall = corners[:, 0].min()
    height = corners[corners[:, 0].argmin(), 1]
    weight = 10.0 * 9.81
    push = share * weight * -corners.mean(axis=0)[0] / height
    parts = [
        FLOOR,
        Part("wall", Box([1, 4, 9]), Pose([wall - 0.5, 0, 4.5]), grounded=True),
        Part("ladder", Prism(corners, 1), mass=10.0),
    ]
    load = Load("ladder", force=[-push, 0, 0], point=[0, 0, 0])
    assembly = Assembly(parts, loads=[load])
    kinds = detect.contacts(assembly).patch_kind.tolist()
    assert kinds == ["edge-face", "edge-face"]
    # it may slide on: a small push is open
    assert judged(assembly, pushed=False) == word


# cubes on edges and corners ---------------------------------------------------------------


def on_edge(offset: float = 0.0) -> Part:
    quarter = turn([0, 1, 0], 45)
    own = Rotation.from_quat(np.array(quarter)[[1, 2, 3, 0]]).inv().apply([offset, 0, 0])
    return Part("cube", Box([1, 1, 1]), Pose([0, 0, np.sqrt(0.5)], quarter), center_of_mass=own)


@pytest.mark.parametrize(
    ("offset", "word"), [(0, "balanced"), (1e-6, "unstable"), (-1e-6, "unstable")]
)
def test_a_cube_on_its_edge_is_neutral_over_it(offset, word):
    assert judged(Assembly([FLOOR, on_edge(offset)])) == word


@pytest.mark.parametrize("offset", [0, 0.1, -0.3])
def test_a_cube_on_its_edge_between_two_walls_stands_over_its_foot_only(offset):
    half = np.sqrt(0.5)
    left = block("left", [-half - 1, -1, 0], [-half, 1, 2], grounded=True)
    right = block("right", [half, -1, 0], [half + 1, 1, 2], grounded=True)
    assembly = Assembly([FLOOR, left, right, on_edge(offset)])
    # the walls push against each other along one line: no torque, so it stands only where
    # its centre of mass is over its foot
    assert judged(assembly) == ("balanced" if offset == 0 else "unstable")


def test_a_corner_in_a_corner_has_one_normal_a_wall():
    # a corner pointed into the octant: a tetrahedron with its tip at the origin
    tetra = np.array([[0, 0, 0], [1, 0.3, 0.2], [0.2, 1, 0.3], [0.3, 0.2, 1]])
    corner = Mesh(*_octant_hole())
    tetra_part = Part("tip", Mesh(tetra, [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]))
    contacts = detect.contacts(Assembly([Part("corner", corner, grounded=True), tetra_part]))
    assert contacts.unsupported == ()
    normals = sorted(np.round(contacts.normals, 12).tolist())
    assert normals == [[0, 0, 1], [0, 1, 0], [1, 0, 0]]
    assert np.abs(contacts.points).max() < 1e-12
    center = tetra.mean(axis=0)
    toward = -center / np.linalg.norm(center) * 9.81
    base = [Part("corner", corner, grounded=True), tetra_part]
    assert judged(Assembly(base, gravity=toward), pushed=False) == "stable"  # it may tip
    aside = toward + 1e-5 * np.array([1.0, -1.0, 0.0])
    assert judged(Assembly(base, gravity=aside)) == "unstable"  # it tips about its corner


def _octant_hole() -> tuple[np.ndarray, list[list[int]]]:
    """The cube [-1, 1]^3 without its positive octant."""
    from sharp_oracle import cubes

    cells = {(x, y, z) for x in (-1, 0) for y in (-1, 0) for z in (-1, 0)} - {(0, 0, 0)}
    body = cubes(cells)
    return body.vertices, body.triangles.tolist()


@pytest.mark.parametrize(("offset", "word"), [(0.0, "balanced"), (1e-6, "unstable")])
def test_a_tetrahedron_balances_on_its_tip(offset, word):
    points = [[0, 0, 0], [1, 0, 1], [-0.5, 0.8, 1], [-0.5, -0.8, 1]]
    faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
    center = [offset, 0, 0.75]
    tetra = Part("tetra", Mesh(points, faces), center_of_mass=center)
    assembly = Assembly([FLOOR, tetra])
    contacts = detect.contacts(assembly)
    assert contacts.patch_kind.tolist() == ["vertex-face"]
    assert judged(assembly) == word


# degenerate points ------------------------------------------------------------------------


def test_a_corner_on_a_corner_slides_off():
    lower = Mesh([[0, 0, 0], [1, 0, -1], [-0.5, 0.8, -1], [-0.5, -0.8, -1]],
                 [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])  # fmt: skip
    points = [[0, 0, 0], [1, 0, 1], [-0.5, 0.8, 1], [-0.5, -0.8, 1]]
    upper = Mesh(points, [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]])
    assembly = Assembly([Part("lower", lower, grounded=True), Part("upper", upper)])
    contacts = detect.contacts(assembly)
    assert [u.kind for u in contacts.unsupported] == ["vertex"]
    assert len(contacts) == 0
    assert contacts.approximate.normals == pytest.approx(np.array([[0, 0, 1.0]]), abs=1e-9)
    answer = decide_degenerate(assembly, contacts)
    assert (answer.branching, answer.approximation) == (False, True)
    assert judged(assembly) == "unstable"


def test_ridges_held_from_both_sides_are_stable_by_branching():
    # a roof upside down on a roof, walls at both sides: it can slide down neither slope
    ridge = prism("ridge", [[-1, -1], [1, -1], [0, 0]], 2.0, grounded=True)
    top = prism("top", [[0, 0], [1, 1], [1, 2], [-1, 2], [-1, 1]], 2.0)
    sides = [
        block("left", [-2, -1, 0], [-1, 1, 3], grounded=True),
        block("right", [1, -1, 0], [2, 1, 3], grounded=True),
    ]
    assembly = Assembly([ridge, top, *sides])
    answer = decide_degenerate(assembly, detect.contacts(assembly))
    assert answer.branching is True
    verdict = check(assembly)
    assert verdict.verdict == "undecided"
    assert "every possible normal was tried: it is stable for all of them" in verdict.sentence
    free = Assembly([ridge, top, sides[0]])
    assert judged(free) == "unstable"


def test_a_proof_by_a_branch_that_is_altered_does_not_hold():
    ridge = prism("ridge", [[-1, -1], [1, -1], [0, 0]], 2.0, grounded=True)
    assembly = Assembly([ridge, prism("top", [[0, 0], [1, 1], [-1, 1]], 2.0)])
    contacts = detect.contacts(assembly)
    proof = check(assembly).proof()
    assert verify_proof(assembly, contacts, proof).holds
    proof["motion"]["top"] = [0, 0, -1.0, 0, 0, 0]  # straight down: into the ridge
    assert not verify_proof(assembly, contacts, proof).holds


@pytest.mark.parametrize("seed", range(3))
def test_a_stack_bond_wall_accepts_nothing_at_its_corners(seed):
    rotation = Rotation.random(rng=np.random.default_rng(seed))
    quaternion = rotation.as_quat()[[3, 0, 1, 2]]
    parts = [
        Part(f"{i}/{j}", Box([1, 0.5, 0.5]), Pose(rotation.apply([i, 0, 0.5 * j]), quaternion),
             grounded=j == 0)
        for i in range(5) for j in range(4)
    ]  # fmt: skip
    contacts = detect.contacts(Assembly(parts))
    assert set(contacts.patch_kind) == {"plane"}
    assert len(contacts.unsupported) == 4 * 3 * 2
    assert contacts.degenerate.exact.all()


# rows by their labels ----------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(3))
def test_rows_of_degenerate_points_are_found_by_label_in_whatever_order_they_come(seed):
    ridge = prism("ridge", [[-1, -1], [1, -1], [0, 0]], 2.0, grounded=True)
    top = prism("top", [[0, 0], [1, 1], [-1, 1]], 2.0)
    shelf = block("shelf", [-3, -1, -1], [-2, 1, 0], grounded=True)
    box = block("box", [-3, -1, 0], [-2, 1, 1])
    assembly = Assembly([ridge, top, shelf, box], friction=0.3)
    contacts = detect.contacts(assembly)
    exact = int(contacts.degenerate.exact[contacts.degenerate.owner].sum())
    assert exact > 0
    order = np.random.default_rng(seed).permutation(len(contacts.possible))
    shuffled = dataclasses.replace(contacts, possible=contacts.possible.take(order))
    every = build_program(assembly, contacts, possible=True, sticking=True)
    left = [without_degenerate(assembly, c) for c in (contacts, shuffled)]
    for program in left:
        assert len(program.kind) == len(every.kind) - exact
    ends = [np.lexsort(np.column_stack([p.point, p.normal]).round(9).T) for p in left]
    for name in ("point", "normal", "kind", "two_sided"):
        first, second = (getattr(p, name)[end] for p, end in zip(left, ends, strict=True))
        assert np.allclose(first, second)
