"""Lists of assemblies, threads and clusters have the verdicts of `check`."""

import dataclasses
import importlib
import json
import multiprocessing
import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import arrays_of
from judged import judged

import kilter
from kilter import (
    Assembly,
    AssemblyArrays,
    Box,
    Cylinder,
    InputError,
    Joint,
    Load,
    Mesh,
    Part,
    Pose,
    contacts,
)
from kilter.analysis.decision.judge import judge
from kilter.analysis.verdict.displacement import LIMIT, find_displacement
from kilter.assembly.array_geometry import arrays_side_by_side
from kilter.assembly.hexahedra import box_orders
from kilter.mechanics import clusters as groups
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import Program, build_program
from kilter.rigid import common_frame, common_frames
from kilter.scenes import friction, paper, scene, stacks, walls
from kilter.scenes.random_bricks import box_pile
from kilter.shape.primitives import BOX_CORNERS, BOX_TRIANGLES

FLOOR = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)


def turned(assembly: Assembly, seed: int) -> Assembly:
    """The assembly turned at random, gravity too."""
    turn = Pose((0, 0, 0), np.random.default_rng(seed).normal(size=4))
    parts = [
        dataclasses.replace(part, pose=Pose(turn.apply([part.pose.position])[0], turn.rotation))
        for part in assembly.parts
    ]
    return Assembly(parts, gravity=turn.apply([assembly.gravity])[0], friction=assembly.friction)


def piles(seeds: range) -> list[Assembly]:
    """Piles upright and turned, on level ground and anywhere."""
    found = [box_pile(5 + s % 12, seed=s, cells=4, level=bool(s % 2)) for s in seeds]
    return [turned(one, s) if s % 3 else one for s, one in zip(seeds, found, strict=True)]


def overhanging(share: float, size: float = 1.0, gravity: float = 9.81) -> Assembly:
    """A box whose centre is `share` of half the width of the one below beyond its middle."""
    boxes = [
        Part("lower", Box([size] * 3), Pose([0, 0, size / 2]), grounded=True),
        Part("upper", Box([2 * size, size, size]), Pose([share * size / 2, 0, 1.5 * size])),
    ]
    return Assembly(boxes, gravity=[0, 0, -gravity])


def mixed() -> list[Assembly]:
    """Every way in which an assembly may be asked, side by side or by itself."""
    cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    slope = Pose((0, 0, 0), [np.cos(0.1), np.sin(0.1), 0, 0])
    leaning = [
        dataclasses.replace(p, pose=Pose(slope.apply([p.pose.position])[0], slope.rotation))
        for p in (FLOOR, cube)
    ]
    return [
        scene("tower"),
        scene("paper-figure-8"),
        Assembly([FLOOR, cube], units="mm"),
        Assembly([FLOOR, cube], planar=True),
        Assembly(leaning),
        Assembly(leaning, friction=0.5),
        Assembly(leaning, friction=0.1),
        Assembly([FLOOR, cube], loads=[Load("cube", force=[0, 0, 2e4])]),
        Assembly([FLOOR, dataclasses.replace(cube, pose=Pose([0, 0, 3]))],
                 joints=[Joint(("floor", "cube"), "fixed")]),
        Assembly([FLOOR, Part("can", Cylinder(1, 2), Pose([0, 0, 1]))]),
        Assembly([FLOOR, dataclasses.replace(FLOOR, name="other")]),
        Assembly([FLOOR]),
        Assembly([cube]),
        scene("tower").with_friction(0.3),
    ]  # fmt: skip


def alone(assembly: Assembly) -> str:
    """The verdict of `check`, or "error"."""
    try:
        return kilter.check(assembly).verdict
    except InputError:
        return "error"


def require_proved(found: kilter.Verdicts) -> None:
    """Every proof that was kept, judged anew by the program of its own assembly, holds."""
    for k, word in enumerate(found.verdict.tolist()):
        kept = found.certificate(k)
        assert (kept is None) == (word in ("undecided", "error")), k
        assert kept is None or kept[1].holds, k


@pytest.mark.slow
def test_hundreds_of_piles_get_the_verdicts_of_check_from_assemblies_and_from_arrays():
    given = piles(range(1000, 1250))
    words = [alone(one) for one in given]
    for many in (given, arrays_of(given)):
        found = kilter.check_many(many, proofs=True)
        for k, (word, expected) in enumerate(zip(found.verdict.tolist(), words, strict=True)):
            # boxes and meshes list their corners in different orders: one order may leave second
            # order open, which makes "balanced" a "stable"
            assert word == expected or {word, expected} == {"stable", "balanced"}, k
            assert word == expected or alone(many[k]) == word, k
        require_proved(found)


@pytest.mark.slow
def test_limits_have_both_sides_whatever_stands_beside():
    shares = np.repeat([1 - 1e-6, 1 + 1e-6], 8)
    sizes, gravities = np.tile([1e-3, 1.0, 40.0, 1e4], 4), np.tile([1e-3, 9.81, 1e4, 2.0, 80.0], 4)
    given = [
        turned(overhanging(share, size, gravity), seed)
        for seed, (share, size, gravity) in enumerate(
            zip(shares, sizes, gravities[: len(shares)], strict=True)
        )
    ]
    expected = np.where(shares < 1, "stable", "unstable").tolist()
    for many in (given, arrays_of(given)):
        assert kilter.check_many(many).verdict.tolist() == expected


def test_a_list_of_verdicts_needs_no_further_check(monkeypatch):
    found = kilter.check_many(arrays_of([overhanging(0.9), overhanging(1.1)]))

    def fails(*_: object, **__: object) -> None:
        raise TypeError

    monkeypatch.setattr("kilter.analysis.many.verdicts.check", fails)
    listed = list(found)
    assert [(one.verdict, one.level, one.stable) for one in listed] == [
        ("stable", "proved", True),
        ("unstable", None, False),
    ]
    assert listed[0].assembly.names == ("0", "1")
    with pytest.raises(TypeError):
        _ = listed[0].sentence


@pytest.mark.slow
def test_every_field_of_a_listed_verdict_is_that_of_check():
    assemblies = piles(range(3))
    for listed, assembly in zip(kilter.check_many(assemblies), assemblies, strict=True):
        single = kilter.check(assembly)
        assert listed.sentence == single.sentence
        assert listed.warnings == single.warnings
        several, data = listed.to_dict(), single.to_dict()
        assert {**several, "seconds": None} == {**data, "seconds": None}
        again = dataclasses.replace(listed, effort=2.0)
        assert (again.effort, again.sentence) == (2.0, single.sentence)


def test_proofs_are_of_their_own_assembly():
    found = kilter.check_many([overhanging(0.5), overhanging(0.5, gravity=1.0)], proofs=True)
    program, proof = found.certificate(0) or (None, None)
    other, _ = found.certificate(1) or (None, None)
    assert program is not None
    assert other is not None
    assert check_forces(program, proof.forces).holds
    assert not check_forces(other, proof.forces).holds


@pytest.mark.slow
def test_refusals_are_rows_with_their_reason():
    cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    sheet = Part("sheet", Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    inside = dataclasses.replace(cube, name="inside", pose=Pose([0.1, 0, 0.5]))
    third = dataclasses.replace(cube, name="third", pose=Pose([0, 0.1, 0.5]))
    bad = [Assembly([cube]), Assembly([FLOOR, sheet]), Assembly([FLOOR, cube, inside, third])]
    good = Assembly([FLOOR, cube])
    found = kilter.check_many([bad[0], good, *bad[1:]])
    assert found.verdict.tolist() == ["error", "stable", "error", "error"]
    assert sorted(found.errors) == [0, 2, 3]
    for place, one in zip((0, 2, 3), bad, strict=True):
        with pytest.raises(InputError) as refused:
            kilter.check(one)
        assert str(refused.value) == str(found.errors[place])
        with pytest.raises(InputError):
            found[place]
    assert found.stable.tolist() == [False, True, False, False]


@pytest.mark.slow
def test_meshes_that_are_not_plain_are_read_one_by_one():
    arrays = arrays_of([overhanging(0.5)] * 5)
    faces, vertices = arrays.faces.copy(), arrays.vertices.copy()
    faces[12:24] = faces[12:24, ::-1]  # inwards: turned, as a file's is
    faces[30] = faces[31]  # a hole in what is held
    vertices[5 * 16 - 1] = np.nan
    faces[96:108] = faces[96:108, ::-1]
    found = kilter.check_many(
        AssemblyArrays(vertices, faces, arrays.vertex_start, arrays.face_start, arrays.part_start,
                       arrays.held)
    )  # fmt: skip
    assert found.verdict.tolist() == ["stable", "stable", "stable", "stable", "error"]
    loose = arrays_of([overhanging(0.5)] * 2, held=[False, False, True, False])
    assert kilter.check_many(loose).verdict.tolist() == ["error", "stable"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"part_start": [0, 1]}, "part_start does not divide 2 rows"),
        ({"vertex_start": [0, 8, 17]}, "vertex_start does not divide 16 rows into 2"),
        ({"face_start": [0, 12, 12, 24]}, "face_start does not divide 24 rows into 2"),
        ({"faces": [[0.5, 1, 2]]}, "faces is"),
        ({"gravity": [0, 0]}, "gravity is not a vector"),
        ({"density": [1.0]}, "density has shape"),
        ({"units": "yd"}, "yd"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(change, said):
    with pytest.raises(InputError, match=said.split(" (")[0]):
        arrays_of([overhanging(0.5)], **change)


def test_what_is_no_assembly_is_refused():
    with pytest.raises(InputError, match="tower: no such file"):
        kilter.check_many([scene("tower"), "tower"])
    with pytest.raises(InputError, match="assembly 1 is of type int"):
        kilter.check_many([scene("tower"), 3])  # type: ignore[list-item]
    with pytest.raises(InputError, match="does not exist"):
        kilter.check_many([], require="always")
    assert len(kilter.check_many([])) == 0


@pytest.mark.slow
def test_progress_is_reported_after_each_run():
    steps: list[tuple[int, int]] = []
    kilter.check_many([overhanging(0.5)] * 301, progress=lambda done, of: steps.append((done, of)))
    assert steps == [(300, 301), (301, 301)]


def test_the_frames_of_runs_are_those_of_each():
    random = np.random.default_rng(4)
    turns = [Pose((0, 0, 0), random.normal(size=4)).matrix for _ in range(5)]
    normals = np.concatenate([np.vstack([turn.T, -turn.T]) for turn in turns])
    areas = np.tile([3.0, 2.0, 1.0], 10)
    frames = common_frames(normals, areas, np.arange(0, 31, 6))
    for k, frame in enumerate(frames):
        own = slice(6 * k, 6 * k + 6)
        np.testing.assert_allclose(frame, common_frame(normals[own], areas[own]), atol=1e-9)


def test_boxes_are_told_from_other_solids_of_eight_corners():
    random = np.random.default_rng(5)
    turn = Pose((1, 2, 3), random.normal(size=4))
    mixed = random.permutation(8)
    box = turn.apply(BOX_CORNERS * [1, 2, 3])[mixed]
    faces = np.argsort(mixed)[BOX_TRIANGLES]
    frustum = box + np.where(BOX_CORNERS[mixed, 2:] > 0, 1e-6, 0.0) * BOX_CORNERS[mixed]
    crossed = faces.copy()
    crossed[0] = np.argsort(mixed)[[0, 7, 1]]
    order, is_box = box_orders(
        np.stack([box, frustum, box]), np.stack([faces, faces, crossed]), np.full(3, 1e-15)
    )
    assert is_box.tolist() == [True, False, False]
    quads = box[order[0]] - box.mean(axis=0)
    edges = np.array([quads[1] - quads[0], quads[2] - quads[0], quads[4] - quads[0]])
    assert np.linalg.det(edges) == pytest.approx(6.0)


def test_geometry_in_arrays_is_that_of_the_meshes():
    corners = [[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 3]]
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    wedge = Part("wedge", Mesh(corners, faces), Pose([1, 2, 0]))
    given = [*piles(range(4)), Assembly([FLOOR, wedge]), turned(Assembly([FLOOR, wedge]), 3)]
    density = np.linspace(500.0, 2000.0, sum(len(one) for one in given))
    arrays = arrays_of(given, density=density, units="mm")
    apart, which = arrays_side_by_side(arrays)
    assert apart is not None
    assert which.tolist() == list(range(len(given)))
    found = apart.whole.geometry
    assert found.is_box.sum() == len(density) - 2
    for k, one in enumerate(arrays):
        own, wanted = slice(*apart.start[k : k + 2]), one.geometry
        for name in ("mass", "center", "volume", "radius", "size", "accuracy"):
            np.testing.assert_allclose(
                getattr(found, name)[own], getattr(wanted, name), rtol=1e-12, atol=1e-13
            )
        scale = wanted.mass * wanted.size**2
        off = np.abs(found.inertia[own] - wanted.inertia).max(axis=(1, 2)) / scale
        assert off.max() < 1e-14


THREADS, PROCESSES = 8, 4
SCENES: dict[str, Callable[[], Assembly]] = {
    "figure 8": paper.figure_8,
    "figure 9": lambda: paper.figure_9(planar=True),
    "slope": lambda: stacks.block_on_slope(20.0, friction=0.5),
    "bracket": lambda: friction.bracket(1.1 / 1.2, pad=1e-3),
    "wall": lambda: walls.wall_of(12, friction=0.6).with_down([0.0, 0.02, -1.0]),
}
ANSWERS: dict[str, Callable[[Assembly], str]] = {
    "check": lambda one: _text(kilter.check(one, effort=0.5).proof()),
    "contacts": lambda one: _text(kilter.contacts(one).to_dict()),
    "orient": lambda one: _text(_timeless(kilter.orient(one).to_dict())),
    "region": lambda one: _text(kilter.region(one).proof()),
}
ASKED = [("figure 9", "contacts"), ("figure 8", "check"), ("slope", "check")]
MORE = [(scene, "check") for scene in SCENES] + [("figure 9", answer) for answer in ANSWERS]


def _text(data: object) -> str:
    return json.dumps(data, sort_keys=True)


def _timeless(data: object) -> object:
    """An answer without how long it took."""
    if isinstance(data, dict):
        return {key: _timeless(value) for key, value in data.items() if key != "seconds"}
    return [_timeless(one) for one in data] if isinstance(data, list) else data


def answered(scene: str, answer: str) -> str:
    """In a process of its own, of an assembly of its own."""
    return ANSWERS[answer](SCENES[scene]())


Asked = list[tuple[str, str]]
FEW_OR_ALL = pytest.mark.parametrize(
    "asked", [ASKED, pytest.param(MORE, marks=pytest.mark.slow)], ids=["few", "more"]
)


def alone_runs(asked: Asked) -> dict[tuple[str, str], str]:
    """Questions of each, one after the other, about assemblies that no other has."""
    return {one: answered(*one) for one in asked}


@pytest.mark.slow
@FEW_OR_ALL
def test_threads_that_share_assemblies(asked):
    """All begin at once: what an assembly keeps once it is asked for is asked for by all."""
    shared = {name: build() for name, build in SCENES.items()}
    together = threading.Barrier(THREADS)

    def asks(number: int) -> dict[tuple[str, str], str]:
        together.wait()
        order = asked[number:] + asked[:number]
        return {one: ANSWERS[one[1]](shared[one[0]]) for one in order}

    often = sys.getswitchinterval()
    sys.setswitchinterval(1e-4)
    try:
        with ThreadPoolExecutor(THREADS) as threads:
            found = list(threads.map(asks, range(THREADS)))
    finally:
        sys.setswitchinterval(often)
    right = alone_runs(asked)
    for own in found:
        assert [one for one in right if own[one] != right[one]] == []


@pytest.mark.slow
@FEW_OR_ALL
@pytest.mark.parametrize(
    "method",
    [
        pytest.param("fork", marks=pytest.mark.skipif(os.name != "posix", reason="no fork there")),
        pytest.param("spawn", marks=pytest.mark.slow),
    ],
)
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork")
def test_processes(asked, method):
    """Forked, too, after solvers and linear algebra have run here."""
    right = alone_runs(asked)
    context = multiprocessing.get_context(method)
    with ProcessPoolExecutor(PROCESSES, mp_context=context) as processes:
        found = list(processes.map(answered, *zip(*asked, strict=True), timeout=240))
    assert [one for one, own in zip(asked, found, strict=True) if own != right[one]] == []


BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def towers(count: int, *, height: int = 3, hanging: int | None = None) -> Assembly:
    """Towers of boxes side by side on a plate; the top box of the tower `hanging` tips."""
    parts = [Part("plate", Box([4 * count, 4, 1]), Pose([2 * count, 0, -0.5]), grounded=True)]
    for k in range(count):
        for level in range(height):
            off = 0.8 if k == hanging and level == height - 1 else 0.1 * level
            place = [4 * k + 2 + off, 0.05 * level, 0.5 + level]
            parts.append(Part(f"t{k}-{level}", Box([1, 1, 1]), Pose(place)))
    return Assembly(parts)


def program_of(assembly: Assembly) -> Program:
    return build_program(assembly, contacts(assembly))


@pytest.fixture
def parted(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Divide programs of any size, into groups of two towers at most."""
    monkeypatch.setattr(groups, "PARTED", 0)
    monkeypatch.setattr(groups, "GROUP", 40)
    return monkeypatch


def test_groups_divide_the_free_parts_and_the_rows(parted):
    program = program_of(towers(7))
    divided = groups.cluster_groups(program)
    assert [int(group.program.free.sum()) for group in divided] == [6, 6, 6, 3]
    free = np.sum([group.program.free for group in divided], axis=0)
    assert free.tolist() == program.free.astype(int).tolist()
    rows = np.concatenate([group.rows for group in divided])
    assert np.sort(rows).tolist() == list(range(len(program.part_a)))
    parted.setattr(groups, "GROUP", 10)  # a cluster is never divided
    assert [int(g.program.free.sum()) for g in groups.cluster_groups(program)] == [3] * 7
    parted.setattr(groups, "PARTED", 6 * 21)
    assert len(groups.cluster_groups(program)) == 1


@pytest.mark.parametrize("hanging", [None, 0, 6])
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_the_judgement_of_groups_is_that_of_the_whole(hanging, mu, monkeypatch):
    program = program_of(towers(7, hanging=hanging).with_friction(mu))
    whole = judge(program)
    monkeypatch.setattr(groups, "PARTED", 0)
    monkeypatch.setattr(groups, "GROUP", 40)
    parts = judge(program)
    assert parts.stable is whole.stable is (hanging is None)
    if parts.stable:
        assert parts.forces is not None
        assert check_forces(program, parts.forces.forces, parts.forces.friction).holds
    else:
        assert parts.motion is not None
        assert check_motion(program, parts.motion.motion).holds
        moving = np.flatnonzero(np.abs(parts.motion.motion).max(axis=1) > 1e-9)
        tower = 3 * (hanging or 0)
        assert set(moving.tolist()) <= set(range(tower + 1, tower + 7))  # parts of one group


@pytest.mark.parametrize("hanging", [None, 2])
def test_the_displacement_program_adds_up(hanging, monkeypatch):
    program = program_of(towers(6, hanging=hanging))
    whole = find_displacement(program)
    monkeypatch.setattr(groups, "PARTED", 0)
    monkeypatch.setattr(groups, "GROUP", 40)
    parts = find_displacement(program)
    assert parts.z == pytest.approx(whole.z, rel=1e-7, abs=1e-9)
    assert parts.displacement is not None
    assert whole.displacement is not None
    np.testing.assert_allclose(parts.displacement, whole.displacement, atol=1e-5)


def test_a_capacity_shared_by_clusters_is_not_divided(parted):
    program = program_of(towers(3))
    capacity = np.full(len(program.part_a), np.inf)
    capacity[0] = 1.0
    assert len(groups.cluster_groups(program)) > 1
    assert len(groups.cluster_groups(program.with_rows(capacity=capacity))) == 1


def test_one_tower_of_many_falls():
    assembly = towers(LIMIT // 3 + 1, hanging=40)
    verdict = judged(assembly)
    assert verdict.verdict == "unstable"
    moving = zip(assembly.names, verdict.motion.moves, strict=True)
    assert "t40-2" in {name for name, moves in moving if moves} <= {f"t40-{k}" for k in range(3)}
    assert verdict.displacement.displacement is None
    assert verdict.displacement.z is not None
    alone = kilter.check(towers(1, hanging=0))
    assert verdict.displacement.z == pytest.approx(alone.displacement.z, rel=1e-6)


@pytest.fixture
def frames(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of the benchmark of bolted frames."""
    pytest.importorskip("OCP", reason="needs kilter[step]")
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    monkeypatch.setattr(sys, "path", [*sys.path])
    return importlib.import_module("cad_frames")


@pytest.mark.slow
@pytest.mark.parametrize("linked", [False, True], ids=["apart", "linked"])
def test_bolted_frames_need_their_nuts(linked, frames, tmp_path):
    file = frames.write_frames(300, 1, tmp_path / "frames.step", linked=linked)
    assembly = kilter.load(file, ground="base")
    assert len(assembly.parts) == 309 + 4 * linked
    verdict = kilter.check(assembly)
    pairs = zip(assembly.names, verdict.motion.moves, strict=True)
    moving = {name for name, moves in pairs if moves}
    assert verdict.verdict == "unstable"
    assert {name.split("/")[-1] for name in moving} == {"nut", "washer_2"}
    assert kilter.check(assembly, assume="fits").verdict == "stable"
