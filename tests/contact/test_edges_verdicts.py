"""Verdicts that edges and corners decide, on both sides of their limits."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kilter import Assembly, Box, Load, Mesh, Part, Pose, Prism, check
from kilter.analysis.decision.degenerate_branches import decide_degenerate
from kilter.analysis.verification import verify_proof
from kilter.contact import detect
from kilter.mechanics.degenerate import without_degenerate
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import block, floor, prism, turn

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
    from first_order import cubes

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
