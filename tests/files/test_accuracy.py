"""Accuracy of coordinates, values out of range, sound meshes, bodies, and inertia of formats."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.assembly.mesh_surface import polyhedron_moments
from kilter.cli import main
from kilter.errors import InputError
from kilter.files.meshes.bodies import split_bodies
from kilter.files.meshes.placed import text_accuracy
from kilter.loading import load
from kilter.shape import closed as sound
from kilter.shape.closed import open_edges, weld, weld_valid_meshes
from kilter.shape.primitives import Box, Cylinder, Mesh, surface
from kilter.validate import LARGEST

RNG = np.random.default_rng(3)
FULL = RNG.uniform(-20, 20, (50, 3))


def judged(values: np.ndarray, **options: bool) -> float | None:
    return text_accuracy(values, **options)(values)


def test_float32_printed_in_full():
    single = FULL.astype(np.float32).astype(np.float64)
    assert judged(single) == np.abs(single).max() * 2**-24


def test_the_largest_of_each_mesh_counts():
    single = FULL.astype(np.float32).astype(np.float64)
    assert text_accuracy(single)(single[:1]) == np.abs(single[0]).max() * 2**-24


@pytest.mark.parametrize("places", range(5, 10))
def test_decimals_that_were_rounded(places):
    assert judged(np.round(FULL, places)) == pytest.approx(0.5 * 10**-places)


@pytest.mark.parametrize("places", range(5))
def test_few_decimals_are_meant(places):
    assert judged(np.round(FULL, places)) is None


@pytest.mark.parametrize("places", [10, 12])
def test_many_decimals_are_float64(places):
    assert judged(np.round(FULL, places)) is None


def test_full_float64():
    assert judged(FULL) is None


def test_short_dyadic_numbers_prove_nothing():
    assert judged(np.array([0.5, 0.25, 12.125, 3])) is None


def test_one_number_that_is_no_float32_decides():
    single = FULL.astype(np.float32).astype(np.float64)
    single[7, 1] = 1 / 3
    assert judged(single) is None


@pytest.mark.parametrize("digits", [5, 6, 7])
def test_digits_behind_an_exponent(digits):
    printed = np.array([float(f"{x:.{digits}e}") for x in FULL.ravel() * 50])
    assert judged(printed, exponent=True) == pytest.approx(0.5 * 10.0 ** (2 - digits))


def test_a_few_round_numbers_behind_an_exponent_are_meant():
    assert judged(np.array([0.0, 1e3, 2.5e-4]), exponent=True) is None


@pytest.mark.parametrize("values", [[], [np.nan], [np.inf, 1], [1e300, -1e300], [5e-324]])
def test_odd_values_do_no_harm(values):
    judged(np.array(values))
    judged(np.array(values), exponent=True)


def test_an_obj_of_float32_is_known_as_such(write, obj_box):
    single = np.float32(0.2525).item()
    assembly = load(write("a.obj", obj_box(2 * single)))
    assert assembly.geometry.accuracy == pytest.approx([single * 2**-24])
    assert assembly.geometry.single.all()


def test_an_obj_of_meant_numbers_is_exact(write, obj_box):
    assert not load(write("a.obj", obj_box(0.5))).geometry.single.any()


TETRAHEDRON = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
BEYOND = 1e101


@pytest.mark.parametrize("size", [1e308, BEYOND])
@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda size: kilter.Box([size, 1, 1]), "box"),
        (lambda size: kilter.Mesh(np.array(TETRAHEDRON) * size, FACES), "a vertex"),
        (lambda size: kilter.Prism([[0, 0], [size, 0], [0, size]], 1), "polygon"),
        (lambda size: kilter.Pose([size, 0, 0]), "position of the pose"),
        (lambda size: kilter.Pose([0, 0, 0], [size, 0, 0, size]), "rotation of the pose"),
        (lambda size: kilter.Cylinder(size, 1), "radius of the cylinder"),
    ],
)
def test_what_is_too_large_is_refused(make, what, size):
    make(LARGEST / 10)
    with pytest.raises(InputError, match=f"{what} is of size|pose has a number that is not finite"):
        make(size)


@pytest.mark.parametrize("place", [0.0, 5e-324, 1e-150])
def test_a_place_may_be_as_near_to_zero_as_it_likes(place):
    assert kilter.Pose([place, 0, 0]).position[0] == place
    assert kilter.Mesh(np.add(TETRAHEDRON, [place, 0, 0]), FACES).vertices[0, 0] == place


@pytest.mark.parametrize("face", [[0, 0, 0, 0], [0, 1, 1, 0], [0, 1, 0, 1], [0, 1, 2, 1, 0]])
def test_a_polygon_of_no_area_is_no_fault(face):
    """The flat face is dropped, and the mesh is closed without it."""
    mesh = kilter.Mesh(TETRAHEDRON, [*FACES, face])
    part = kilter.Part("one", mesh)
    assert kilter.Assembly([part]).geometry.volume == pytest.approx(1 / 6)


def test_an_obj_of_nothing_but_such_faces_is_refused(tmp_path):
    path = tmp_path / "flat.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2 1\nf 1 2 1 2\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"closed solid|no faces"):
        _ = kilter.load(path).geometry


Corners = tuple[np.ndarray, np.ndarray]


def soup(corners: Corners) -> Corners:
    """Triangles without shared vertices, as in STL."""
    vertices, triangles = corners
    return vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def damaged(corners: Corners, how: int, rng: np.random.Generator) -> Corners:
    """A valid mesh (`kind` 0 to 2) or an invalid mesh (3 to 8)."""
    vertices, triangles = (array.copy() for array in corners)
    k = int(rng.integers(len(triangles)))
    match how:
        case 1:
            return soup(corners)
        case 2:
            order = rng.permutation(len(vertices))
            return vertices[order], np.argsort(order)[triangles]
        case 3:
            return vertices, np.delete(triangles, k, axis=0)
        case 4:
            return vertices, np.vstack([triangles, triangles[k]])
        case 5:
            triangles[k] = triangles[k, ::-1]
        case 6:
            return np.vstack([vertices, [9.0, 9, 9]]), triangles
        case 7:
            return vertices, np.vstack([triangles, triangles[k, [0, 0, 1]]])
        case 8:  # a slightly displaced corner: the edge is open unless close corners are merged
            vertices, triangles = soup(corners)
            vertices[k] += 1e-12
    return vertices, triangles


@pytest.mark.parametrize("batch", [1, 40, 10**6])
def test_many_at_once_as_one_by_one(batch, monkeypatch):
    monkeypatch.setattr(sound, "BATCH", batch)
    rng = np.random.default_rng(0)
    kinds = [surface(Box([1, 2, 3])), surface(Cylinder(1.0, 2.0))]
    how = rng.integers(0, 9, size=60)
    meshes = [damaged(kinds[k % 2], int(one), rng) for k, one in enumerate(how)]
    found = weld_valid_meshes(meshes)
    assert [one is not None for one in found] == (how < 3).tolist()
    for (vertices, triangles), one in zip(meshes, found, strict=True):
        if one is None:
            continue
        alone, faces, notes = weld(vertices, triangles)
        assert notes == []
        assert len(open_edges(alone, faces)) == 0
        assert np.array_equal(alone, one[0])
        assert np.array_equal(faces, one[1])


def test_none_at_all():
    assert weld_valid_meshes([]) == []


def boxes(*places: tuple[float, float, float], size: float = 1.0, turned: bool = False) -> Mesh:
    """Several boxes as a single mesh."""
    return merged(*[box(place, size, turned) for place in places])


def box(at: tuple[float, float, float], size: float = 1.0, turned: bool = False) -> Mesh:
    vertices, faces = surface(Box([size] * 3))
    return Mesh(vertices + np.array(at), faces[:, ::-1] if turned else faces)


def merged(*meshes: Mesh) -> Mesh:
    start = np.cumsum([0, *[len(m.vertices) for m in meshes]])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.triangles + s for m, s in zip(meshes, start[:-1], strict=True)]),
    )


def volumes(mesh: Mesh) -> list[float]:
    return [
        float(polyhedron_moments(m.vertices, m.triangles, np.array([0, len(m.triangles)]))[0][0])
        for m in split_bodies(mesh)
    ]


TOUCHING = {
    "apart": [(0, 0, 0), (3, 0, 0)],
    "face on face": [(0, 0, 0), (0, 0, 1)],
    "edge on edge": [(0, 0, 0), (1, 0, 1)],
    "corner on corner": [(0, 0, 0), (1, 1, 1)],
    "shifted": [(0, 0, 0), (0.5, 0, 1)],
    "four around an edge": [(0, 0, 0), (1, 0, 0), (0, 0, 1), (1, 0, 1)],
    "eight around a corner": [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)],
    "a row": [(k, 0, 0) for k in range(20)],
}


@pytest.mark.parametrize("places", TOUCHING.values(), ids=TOUCHING)
@pytest.mark.parametrize("turned", [False, True], ids=["", "inside out"])
def test_boxes_that_touch(places, turned):
    expected = [-1.0 if turned else 1.0] * len(places)
    assert volumes(boxes(*places, turned=turned)) == pytest.approx(expected)


@pytest.mark.parametrize("seed", range(8))
def test_turned_and_rounded_to_float32(seed):
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    mesh = boxes((0, 0, 0), (0, 0, 1), (1, 0, 1), (0, 1, 0))
    single = (mesh.vertices @ turn.T + 5).astype(np.float32)
    order = rng.permutation(len(mesh.triangles))
    assert volumes(Mesh(single, mesh.triangles[order])) == pytest.approx([1] * 4, rel=1e-5)


def test_a_hole_stays_with_the_body_around_it():
    hollow = merged(box((0, 0, 0), 4), box((0, 0, 0), 2, turned=True))
    both = merged(hollow, box((0, 0, 0), 1), box((9, 0, 0), 1))
    assert volumes(both) == pytest.approx([64 - 8, 1, 1])


def test_a_body_whose_faces_share_no_corners_is_one():
    whole = box((0, 0, 0))
    soup = Mesh(whole.vertices[whole.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert len(split_bodies(soup)) == 1


def test_pieces_that_are_open_stay_together_where_they_share_a_corner():
    whole = box((0, 0, 0))
    lid = merged(Mesh(whole.vertices, whole.triangles[:2]), box((5, 0, 0)))
    assert len(split_bodies(lid)) == 2
    # the lid has an extra corner in the middle of its edge, so the sides have no such edge
    vertices = np.vstack([whole.vertices, (whole.vertices[4:8].sum(axis=0) / 4)[None]])
    fan = np.array([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]])
    sides = np.delete(whole.triangles, [2, 3], axis=0)
    assert len(split_bodies(Mesh(vertices, np.vstack([sides, fan])))) == 1


def test_accuracy_and_empty_meshes_pass_through():
    mesh = boxes((0, 0, 0), (3, 0, 0))
    parts = split_bodies(Mesh(mesh.vertices, mesh.triangles, accuracy=0.25))
    assert [part.accuracy for part in parts] == [0.25, 0.25]
    assert len(split_bodies(Mesh([], np.empty((0, 3), dtype=int)))) == 1


def test_a_face_of_two_corners_is_no_body():
    vertices, faces = surface(Box([1, 1, 1]))
    for extra in ([[0, 0, 1]], [[3, 2, 2], [5, 5, 5]]):
        (body,) = split_bodies(Mesh(vertices, np.vstack([faces, extra])))
        assert len(body.triangles) == 12


G = 9.81
FORMATS = ["kilter", "urdf", "usd"]


def written(
    folder: Path, kind: str, size: Any, at: Any, mass: float, moments: Any, mu: float = 0.0
) -> Path:
    """A box with principal moments about its middle, on the half space x, z < 0 that is held."""
    table, below = [4.0, 4.0, 1.0], [-2.0, 0.0, -0.5]
    if kind == "kilter":
        parts = [
            kilter.Part("table", kilter.Box(table), below, grounded=True),
            kilter.Part("body", kilter.Box(size), at, mass=mass, inertia=[*moments, 0, 0, 0]),
        ]
        path = folder / "a.kilter.json"
        kilter.dump(kilter.Assembly(parts, friction=mu), path)
        return path
    if kind == "urdf":
        six = dict(zip(("ixx", "iyy", "izz"), moments, strict=True))
        tensor = " ".join(f'{key}="{value:.17g}"' for key, value in six.items())
        inertial = f'<inertial><mass value="{mass}"/><inertia {tensor}/></inertial>'
        links = "".join(
            f'<link name="{name}">{inner}<collision><origin xyz="{place}"/><geometry>'
            f'<box size="{" ".join(map(str, box))}"/></geometry></collision></link>'
            for name, inner, place, box in (
                ("table", "", " ".join(map(str, below)), table),
                ("body", inertial, "0 0 0", size),
            )
        )
        joint = '<joint name="j" type="floating"><parent link="table"/><child link="body"/>'
        joint += f'<origin xyz="{" ".join(map(str, at))}"/></joint>'
        path = folder / "a.urdf"
        path.write_text(f"<robot>{links}{joint}</robot>")
        return path
    pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")
    from pxr import Gf, UsdPhysics
    from usd_maker import Stage

    path = folder / "a.usda"
    stage = Stage(path)
    stage.box("table", below, table, static=True)
    body = stage.box("body", at, size, mass=mass)
    values = UsdPhysics.MassAPI(stage.stage.GetPrimAtPath(body))
    # the axes of the moments are z, x, y of the body
    values.CreateDiagonalInertiaAttr(Gf.Vec3f(moments[2], moments[0], moments[1]))
    values.CreatePrincipalAxesAttr(Gf.Quatf(0.5, -0.5, -0.5, -0.5))
    stage.save()
    return path


@pytest.mark.slow
@pytest.mark.parametrize("kind", FORMATS)
def test_a_heavy_rim_does_not_turn_with_its_carrier(kind, tmp_path, capsys):
    """3 kg m2 need 24 N m at 8 rad/s2; mu m g r gives at most 8.3 with all weight at corners."""
    path = written(tmp_path, kind, [0.4, 0.4, 0.1], [-2, 0, 0.05], 10.0, [1.6, 1.6, 3.0])
    words = ["--turn-faster", "0", "0", "8", "--about", "-2", "0", "0", "--friction", "0.3"]
    assert main(["transport", str(path), *words, "--json"]) == 1
    case = json.loads(capsys.readouterr().out)["cases"][0]
    assert case["factor"] == pytest.approx(0.3 * 10 * G * 0.2 * np.sqrt(2) / 24, rel=1e-6)
    assert case["factor"] <= 0.35


@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize(
    ("size", "beyond", "mass", "inertia", "expected"),
    [
        ([1.0, 1.0, 0.2], 0.2, 10.0, 0.05, 43.6),
        ([1.0, 1.0, 0.2], 0.2, 10.0, 5.0, 3.63),
        ([2.0, 0.25, 0.25], 0.45, 1.0, 1.0 + 0.25**2 / 6, 3.64),
    ],
    ids=["light-plate", "heavy-plate", "bar-with-heavy-ends"],
)
def test_a_body_tips_over_an_edge_as_its_inertia_states(
    kind, size, beyond, mass, inertia, expected, tmp_path
):
    """The acceleration is m g d / (I + m d^2), with the centre d beyond the edge."""
    moments = [0.9 * inertia, inertia, inertia]
    path = written(tmp_path, kind, size, [beyond, 0, size[2] / 2], mass, moments)
    verdict = kilter.check(kilter.load(path))
    row = verdict.assembly.index_of("body")
    found = verdict.motion.acceleration[row, 4]
    assert found == pytest.approx(mass * G * beyond / (inertia + mass * beyond**2), rel=1e-6)
    assert found == pytest.approx(expected, abs=0.05)
