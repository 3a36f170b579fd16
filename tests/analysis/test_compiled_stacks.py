"""Compiled code decides clear assemblies of prisms as the computation without it, or not at all."""

import dataclasses

import numpy as np
import pytest
from builders import arrays_of

import kilter
from kilter import Assembly, AssemblyArrays, Box, Mesh, Part, Pose
from kilter.analysis.many import clear_stacks
from kilter.analysis.many.compiled_tolerances import LEFT, STABLE, UNSTABLE
from kilter.contact import Tolerance
from kilter.scenes.random_bricks import box_pile
from kilter.shape.primitives import Prism, surface

pytestmark = pytest.mark.slow  # with numba the first compilation takes tens of seconds

FLOOR = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
HEXAGON = [[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3]


@pytest.fixture(autouse=True)
def few_are_enough(monkeypatch):
    """Also without numba: the code is then plain Python."""
    monkeypatch.setattr(clear_stacks, "FEWEST", 1)
    monkeypatch.setattr(clear_stacks, "has_numba", lambda: True)


def codes(given: list[Assembly] | AssemblyArrays) -> list[int]:
    """Answers of the compiled code; assemblies that it is not given are left."""
    clear = clear_stacks.clear_answers(given, Tolerance())
    found = np.full(len(given), LEFT)
    if clear is not None:
        found[clear[0]] = clear[1].code
    return found.tolist()


def on_floor(*parts: Part, **more: object) -> Assembly:
    return Assembly([FLOOR, *parts], **more)


def cube(x: float, z: float, name: str = "cube", **more: object) -> Part:
    return Part(name, Box([1, 1, 1]), Pose([x, 0, z]), **more)


def overhanging(share: float, **more: object) -> Assembly:
    """A cube whose centre is `share` of half its width beyond the middle of the cube below."""
    lower = cube(0, 0.5, "lower", grounded=True)
    upper = dataclasses.replace(cube(share / 2, 1.5), shape=Box([2, 1, 1]))
    return on_floor(lower, upper, **more)


def turned(assembly: Assembly, seed: int) -> Assembly:
    """The assembly turned at random, gravity too."""
    turn = Pose((0, 0, 0), np.random.default_rng(seed).normal(size=4))
    parts = [
        dataclasses.replace(part, pose=Pose(turn.apply([part.pose.position])[0], turn.rotation))
        for part in assembly.parts
    ]
    return Assembly(parts, gravity=turn.apply([assembly.gravity])[0], friction=assembly.friction)


def upright(name: str, outline: object, tall: float, bottom: tuple[float, float, float]) -> Part:
    """A prism along z, whose lower face has the origin of its outline at `bottom`."""
    corners, faces = surface(Prism(outline, tall))  # along y
    standing = corners[:, [0, 2, 1]] - [0, 0, corners[:, 1].min()]
    return Part(name, Mesh(standing, faces[:, ::-1]), Pose(bottom))


def random_towers(count: int, *, corners: int, seed: int) -> list[Assembly]:
    """Stacks of three prisms with regular outlines, shifted and turned at random."""
    random, found = np.random.default_rng(seed), []
    angle = 2 * np.pi * np.arange(corners) / corners
    for _ in range(count):
        top, parts, place = 0.0, [], np.zeros(2)
        for k in range(3):
            radius, tall = random.uniform(0.5, 1.0), random.uniform(0.2, 1.0)
            own = angle + random.uniform(0, 2 * np.pi)
            place = place + random.uniform(-0.3, 0.3, 2)
            outline = radius * np.column_stack([np.cos(own), np.sin(own)])
            parts.append(upright(str(k), outline, tall, (*place, top)))
            top += tall
        found.append(on_floor(*parts))
    return found


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_the_verdicts_are_those_without_compiled_code(friction, monkeypatch):
    piles = [box_pile(4 + k % 8, seed=k, cells=12, level=bool(k % 2)) for k in range(24)]
    given = [*piles, *random_towers(18, corners=6, seed=1), *random_towers(18, corners=3, seed=2)]
    given = [turned(one, k) if k % 3 == 0 else one for k, one in enumerate(given)]
    arrays = arrays_of(given, friction=friction)
    compiled = kilter.check_many(arrays, proofs=True)
    decided = np.array(codes(arrays)) != LEFT
    monkeypatch.setattr(clear_stacks, "has_numba", lambda: False)
    pure = kilter.check_many(arrays)
    assert compiled.verdict.tolist() == pure.verdict.tolist()
    assert decided.mean() > 0.5
    assert set(compiled.verdict[decided].tolist()) == {"stable", "unstable"}
    assert compiled.rechecked().all()
    for k in np.flatnonzero(decided).tolist():
        kept = compiled.certificate(k)
        assert kept is not None
        assert kept[1].holds


def test_a_wrong_word_of_compiled_code_is_found():
    found = kilter.check_many(arrays_of([overhanging(0.5), overhanging(1.5)]))
    assert found.verdict.tolist() == ["stable", "unstable"]
    assert found.rechecked().all()
    found.verdict[0] = "unstable"
    assert found.rechecked().tolist() == [False, True]


def test_both_sides_of_the_limit_are_decided_and_what_is_near_it_is_left():
    shares = [0.9, 1 - 1e-5, 1 - 1e-7, 1.0, 1 + 1e-7, 1 + 1e-4, 1.1]
    expected = [STABLE, STABLE, LEFT, LEFT, LEFT, UNSTABLE, UNSTABLE]
    given = [overhanging(share) for share in shares]
    assert codes(given) == codes(arrays_of(given)) == expected
    assert codes([turned(one, k) for k, one in enumerate(given)]) == expected
    slipping = [overhanging(share, friction=0.7) for share in shares]
    assert codes(slipping) == expected


def test_pairs_that_are_not_clear_are_left():
    alone, beside = cube(0, 0.5), cube(1.5, 0.5, "other")
    assert codes([on_floor(alone, beside)]) == [STABLE]
    for gap, code in ((0.4e-5, STABLE), (2e-5, LEFT), (-1e-4, LEFT)):  # of the diagonal
        assert codes([on_floor(cube(0, 0.5 + gap))]) == [code], gap
    falls = overhanging(1.1).parts[1:]
    wall = Part("wall", Box([1, 1, 9]), Pose([0, 1.001, 4.5]), grounded=True)
    far = dataclasses.replace(wall, pose=Pose([0, 1.1, 4.5]))
    assert codes([on_floor(*falls, wall), on_floor(*falls, far)]) == [LEFT, UNSTABLE]
    assert codes([on_floor(alone, cube(1.0, 0.5, "other"))]) == [LEFT]
    assert codes([on_floor(cube(0, 0.4))]) == [LEFT]


def test_a_part_in_the_air_drops_with_all_that_it_carries():
    found = kilter.check_many([on_floor(cube(0, 2.5), cube(0, 3.5, "upper"))])
    assert found.verdict.tolist() == ["unstable"]
    assert found.power[0] == pytest.approx(2 * 1000 * 9.81)
    assert codes([on_floor(cube(0, 2.5), cube(0, 3.5, "upper"))]) == [UNSTABLE]


def test_a_plank_on_two_cubes_of_unequal_heights_shares_its_load():
    plank = Part("plank", Box([4, 1, 0.2]), Pose([0.3, 0, 1.1]))
    legs = [cube(-1.5, 0.5, "left"), cube(1.5, 0.5, "right")]
    assert codes([on_floor(*legs, plank)]) == [STABLE]
    found = kilter.check_many([on_floor(*legs, plank)])
    assert found.residual[0] < 1e-12


def test_given_masses_count():
    """The heavier half of a beam decides on which side it tips."""
    base = Part("base", Box([1, 1, 1]), Pose([0, 0, 0.5]), grounded=True)
    beam = Part("beam", Box([4, 1, 0.1]), Pose([0.3, 0, 1.05]), mass=1.0)
    load = Part("load", Box([0.5, 0.5, 0.5]), Pose([1.9, 0, 1.35]))
    light = dataclasses.replace(load, mass=0.1)
    heavy = dataclasses.replace(load, mass=1.0)
    assert codes([on_floor(base, beam, light), on_floor(base, beam, heavy)]) == [STABLE, UNSTABLE]


def test_meshes_that_are_no_upright_prisms_are_left():
    good = arrays_of([overhanging(0.5)] * 6)
    vertices, faces = good.vertices.copy(), good.faces.copy()
    upper = [24 * k + 16 for k in range(6)]  # the first corner of the upper box
    faces[24:36] = faces[24:36, ::-1]  # inwards
    faces[36 + 30] = faces[36 + 31]  # a hole
    vertices[upper[2]] += [0, 0, 1e-3]  # a corner off its level
    vertices[upper[3]] += [1e-3, 0, 0]  # a wall that leans
    vertices[upper[4]] = np.nan
    bad = AssemblyArrays(
        vertices, faces, good.vertex_start, good.face_start, good.part_start, good.held
    )
    assert codes(bad) == [LEFT] * 5 + [STABLE]
    single = dataclasses.replace(good, vertices=good.vertices.astype(np.float32))
    assert codes(single) == [LEFT] * 6
    loose = dataclasses.replace(good, held=np.zeros(18, dtype=bool))
    assert codes(loose) == [LEFT] * 6


def test_outlines_that_are_not_convex_are_left():
    notch = [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]
    notched = upright("notched", notch, 1.0, (0, 0, 0))
    whole = upright("hexagon", HEXAGON, 1.0, (0, 0, 0))
    assert codes(arrays_of([on_floor(notched), on_floor(whole)])) == [LEFT, STABLE]


def test_a_clearance_and_few_assemblies_use_no_compiled_code(monkeypatch):
    given = [overhanging(0.5)]
    assert clear_stacks.clear_answers(given, Tolerance(clearance=1e-3)) is None
    monkeypatch.setattr(clear_stacks, "FEWEST", 2)
    assert clear_stacks.clear_answers(given, Tolerance()) is None


def test_a_mesh_is_read_whatever_the_order_of_its_corners():
    corners, faces = surface(Box([1, 1, 1]))
    order = np.random.default_rng(3).permutation(8)
    mixed = Mesh(corners[order], np.argsort(order)[faces])
    part = Part("cube", mixed, Pose([0, 0, 0.5]))
    assert codes(arrays_of([on_floor(part)])) == [STABLE]
