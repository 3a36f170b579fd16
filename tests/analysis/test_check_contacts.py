"""Contacts as arrays: against closed forms, a linear program of the test, and `kilter.check`."""

import json
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

import kilter
from kilter import Assembly, Box, GivenContact, InputError, Load, Part

Array = NDArray[np.float64]
SIDES = 32
FOOT = [[x, y, 0.0] for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
UP = [[0.0, 0.0, 1.0]] * 4


def on_slope(slope: float, mu: float) -> kilter.Verdict:
    """A body of 2 kg on four points, its centre 1 m above them; gravity leans."""
    return kilter.check_contacts(
        FOOT, UP, mu, [[-1, 0]] * 4, [[0, 0, 1]], mass=[2], gravity=[9.81 * slope, 0, -9.81]
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize("mu", [0.1, 0.5, 0.9])
def test_a_body_slides_from_the_slope_of_its_friction_on(mu):
    assert on_slope(mu * (1 - 1e-6), mu).stable
    falls = on_slope(mu * (1 + 1e-6), mu)
    assert falls.verdict == "unstable"
    assert falls.certificate.kind == "motion"


def test_a_body_tips_from_the_slope_of_its_foot_on():
    assert on_slope(1 - 1e-6, 2.0).stable
    assert on_slope(1 + 1e-6, 2.0).verdict == "unstable"


@pytest.mark.parametrize("mu", [0.3, 0.7])
def test_a_pinch_holds_up_to_twice_the_friction(mu):
    """A part between the world and a pushed plate: m g <= 2 mu N."""
    push = 12.0

    def pinched(weight: float) -> kilter.Verdict:
        corners = [[0, y, z] for y in (-0.1, 0.1) for z in (-0.1, 0.1)]
        points = np.vstack([np.add(corners, [x, 0, 0]) for x in (-0.1, 0.1)])
        # the plate slides on the world without friction, below and above it
        rails = [[0.2, y, z] for y in (-0.1, 0.1) for z in (-0.1, 0.1)]
        normals = [*[[1, 0, 0]] * 8, *[[0, 0, 1]] * 2, *[[0, 0, -1]] * 2]
        return kilter.check_contacts(
            [*points, rails[0], rails[2], rails[1], rails[3]],
            normals,
            [*[mu] * 8, *[0.0] * 4],
            [*[[-1, 0]] * 4, *[[0, 1]] * 4, *[[-1, 1]] * 4],
            [[0, 0, 0], [0.2, 0, 0]],
            wrenches=[[0, 0, -weight, 0, 0, 0], [-push, 0, 0, 0, 0, 0]],
            require="equilibrium",
        )

    assert pinched(2 * mu * push * (1 - 1e-6)).level is not None
    assert pinched(2 * mu * push * (1 + 1e-6)).verdict == "unstable"


def test_a_stack_of_arrays_has_the_forces_of_its_weights():
    points = np.vstack([np.add(FOOT, [0, 0, 2 * k]) for k in range(3)])
    bodies = np.repeat([[-1, 0], [0, 1], [1, 2]], 4, axis=0)
    verdict = kilter.check_contacts(
        points, UP * 3, 0.4, bodies, [[0, 0, 1], [0, 0, 3], [0, 0, 5]], mass=[1, 2, 4]
    )
    assert (verdict.verdict, verdict.level) == ("stable", "proved")
    forces = verdict.forces
    assert forces is not None
    # the points are in the given order, and the force acts on the second body
    assert np.allclose(np.concatenate([patch.points for patch in forces.patches]), points)
    loads = [patch.resultant[2] for patch in forces.patches]
    assert loads == pytest.approx([7 * 9.81, 6 * 9.81, 4 * 9.81])


def test_wrenches_alone_are_all_loads():
    given: dict[str, Any] = {"require": "equilibrium"}

    def pushed(side: float) -> kilter.Verdict:
        load = [[side, 0, -10.0, 0, 0, 0]]
        return kilter.check_contacts(
            FOOT, UP, 0.5, [[-1, 0]] * 4, [[0, 0, 0.1]], wrenches=load, **given
        )

    assert pushed(5 * (1 - 1e-6)).level is not None
    assert pushed(5 * (1 + 1e-6)).verdict == "unstable"


def test_a_body_without_a_contact_falls_and_the_others_stay():
    verdict = kilter.check_contacts(
        FOOT, UP, 0.5, [[-1, 0]] * 4, [[0, 0, 1], [5, 0, 1]], mass=[1, 1]
    )
    assert verdict.moving == ["1"]
    assert verdict["1"].motion.startswith("falls")
    assert kilter.check_contacts([], [], [], [], [[0, 0, 1]], mass=[1]).moving == ["0"]


def test_a_curved_body_on_a_point_is_not_claimed_to_stay():
    one = ([[0, 0, 0]], [[0, 0, 1]], 0.5, [[-1, 0]], [[0, 0, 1]])
    curved = kilter.check_contacts(*one, mass=[1], curved=[True])
    assert curved.level == "equilibrium"
    assert not curved.stable


def random_contacts(random: np.random.Generator) -> tuple[Any, ...]:
    """Contacts of three bodies with each other and the world, in random places and directions."""
    center = random.normal(size=(3, 3))
    pairs = np.array([[-1, 0], [0, 1], [1, 2], [-1, 2], [-1, 1]])
    bodies = np.repeat(pairs, random.integers(2, 5, size=5), axis=0)
    below = np.array([0, 0, -0.5]) + random.normal(size=(len(bodies), 3))
    points = center[bodies[:, 1]] + below
    normals = random.normal(size=points.shape) * 0.6 + [0, 0, 1.5]
    mu = random.uniform(0.2, 0.9, len(points))
    return points, normals, mu, bodies, center, random.uniform(0.5, 2, 3)


def by_linear_program(case: tuple[Any, ...], outer: bool) -> bool:
    """Whether forces in pyramids inside, or around, the cones balance all weights."""
    points, normals, mu, bodies, center, mass = case
    columns = []
    grow = 1 / np.cos(np.pi / SIDES) if outer else 1.0
    for at, normal, rough, (a, b) in zip(points, normals, mu, bodies, strict=True):
        n = normal / np.linalg.norm(normal)
        u = np.linalg.svd(n[None])[2][1]
        v = np.cross(n, u)
        for turn in 2 * np.pi * np.arange(SIDES) / SIDES:
            force = n + grow * rough * (np.cos(turn) * u + np.sin(turn) * v)
            column = np.zeros((3, 6))
            for body, sense in ((a, -1.0), (b, 1.0)):
                if body >= 0:
                    column[body] += sense * np.r_[force, np.cross(at - center[body], force)]
            columns.append(column.ravel())
    load = np.zeros((3, 6))
    load[:, 2] = -9.81 * mass
    answer = linprog(np.zeros(len(columns)), A_eq=np.array(columns).T, b_eq=-load.ravel())
    return bool(answer.status == 0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_random_contacts_agree_with_a_linear_program_and_with_check(seed):
    case = random_contacts(np.random.default_rng(seed))
    points, normals, mu, bodies, center, mass = case
    verdict = kilter.check_contacts(
        points, normals, mu, bodies, center, mass=mass, require="equilibrium"
    )
    assert verdict.verdict != "undecided"
    if by_linear_program(case, outer=False):
        assert verdict.level is not None
    if not by_linear_program(case, outer=True):
        assert verdict.verdict == "unstable"
    # the same contacts on parts of other sizes and shapes
    names = ["0", "1", "2", "floor"]
    parts = [Part(names[k], Box(2, 3, 4), center[k], mass=mass[k]) for k in range(3)]
    listed = [
        GivenContact((names[a], names[b]), [at], normal, mu=rough)
        for at, normal, rough, (a, b) in zip(points, normals, mu, bodies, strict=True)
    ]
    floor = Part("floor", Box(9, 9, 1), [0, 0, -9], grounded=True)
    same = kilter.check(
        Assembly([*parts, floor], contacts=listed, detect=False), require="equilibrium"
    )
    assert (same.level is None) == (verdict.level is None)


@pytest.mark.slow
def test_the_linear_program_of_this_file_sees_both_sides():
    found = [by_linear_program(random_contacts(np.random.default_rng(k)), False) for k in range(30)]
    assert 3 <= sum(found) <= 27


def test_a_proof_is_recomputed_from_the_assembly_of_the_arrays(tmp_path):
    for slope in (0.4, 0.6):
        verdict = on_slope(slope, 0.5)
        kilter.dump(verdict.assembly, tmp_path / "a.kilter.json")
        (tmp_path / "p.json").write_text(json.dumps(verdict.proof()))
        answer = kilter.verify(tmp_path / "a.kilter.json", tmp_path / "p.json")
        assert answer.holds
        assert answer.verdict == verdict.verdict


def test_loads_beside_masses_add_up():
    load = Load("cube", force=[3.0, 0, 0])
    cube = Part("cube", Box(2, 2, 2), [0, 0, 1], mass=2)
    table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    by_shape = kilter.check(Assembly([cube, table], loads=[load], friction=0.2))
    by_array = kilter.check_contacts(
        FOOT, UP, 0.2, [[-1, 0]] * 4, [[0, 0, 1]], mass=[2], wrenches=[[3, 0, 0, 0, 0, 0]]
    )
    assert (by_shape.verdict, by_shape.level) == (by_array.verdict, by_array.level)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"points": [[0, 0]]}, "points has shape"),
        ({"normals": [[0, 0, 0]]}, "the normal of contact 0 is zero"),
        ({"normals": [[0, 0, 1]] * 2}, "normals has shape"),
        ({"mu": -0.1}, "mu is -0.1"),
        ({"mu": [-0.1]}, "mu of contact 0 is -0.1"),
        ({"bodies": [[0, 0]]}, "contact 0 is of the bodies"),
        ({"bodies": [[-1, 1]]}, "contact 0 is of the bodies"),
        ({"bodies": [[-2, 0]]}, "contact 0 is of the bodies"),
        ({"bodies": [[0.0, 1.0]]}, "bodies is an array of float64"),
        ({"center_of_mass": [[np.nan, 0, 0]]}, "not finite"),
        ({"center_of_mass": []}, "there are no bodies"),
        ({"mass": None}, "neither masses nor wrenches"),
        ({"mass": [1, 2]}, "mass has shape"),
        ({"mass": [0.0]}, "mass is 0"),
        ({"wrenches": [[0, 0, 0]]}, "wrenches has shape"),
        ({"gravity": [0, 0, 0]}, "gravity"),
        ({"curved": [True, False]}, "curved has shape"),
        ({"points": "abc"}, "points is 'abc'"),
    ],
)
def test_wrong_arrays_are_named(change, words):
    given: dict[str, Any] = {
        "points": [[0, 0, 0]],
        "normals": [[0, 0, 1]],
        "mu": 0.5,
        "bodies": [[-1, 0]],
        "center_of_mass": [[0, 0, 1]],
        "mass": [1.0],
    }
    with pytest.raises(InputError, match=words.replace("(", r"\(")):
        kilter.check_contacts(**{**given, **change})
