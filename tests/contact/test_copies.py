"""Bodies that a drawing contains twice: exact copies and steps of features, on both sides."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import kilter
from kilter import Assembly, Mesh, Part
from kilter.contact.contact_tolerances import GAP, SAME_SURFACE
from kilter.contact.fits.copies import _spread_points, copies

box, cylinder = trimesh.creation.box, trimesh.creation.cylinder


def moved(mesh: trimesh.Trimesh, *offset: float) -> trimesh.Trimesh:
    changed = mesh.copy()
    changed.apply_translation(offset)
    return changed


def less(mesh: trimesh.Trimesh, *others: trimesh.Trimesh) -> trimesh.Trimesh:
    return trimesh.boolean.difference([mesh, *others], engine="manifold")


def drawing(**bodies: trimesh.Trimesh) -> Assembly:
    return Assembly([Part(name, Mesh(m.vertices, m.faces)) for name, m in bodies.items()])


SLAB = box((100, 100, 10))
HOLE = cylinder(10, 40, sections=48)
POCKET = less(SLAB, HOLE)
BOSS = trimesh.boolean.union([SLAB, moved(box((20, 20, 30)), 0, 0, 15)], engine="manifold")
SHELL = less(box((100, 100, 100)), moved(box((96, 96, 100)), 0, 0, 4))
COPIES = {
    "equal": ({"slab": SLAB, "again": SLAB}, {"again": "slab"}),
    "pocket": ({"pad": SLAB, "result": POCKET}, {"pad": "result"}),
    "result first": ({"result": POCKET, "pad": SLAB}, {"pad": "result"}),
    "boss": ({"plate": SLAB, "result": BOSS}, {"plate": "result"}),
    "shell": ({"block": box((100, 100, 100)), "result": SHELL}, {"block": "result"}),
    "steps": (
        {"pad": SLAB, "pocket": POCKET, "body": less(POCKET, moved(HOLE, 30, 30, 0))},
        {"pad": "pocket", "pocket": "body"},
    ),
    "rounder": (
        {"rough": trimesh.creation.icosphere(3), "fine": trimesh.creation.icosphere(3).subdivide()},
        {"rough": "fine"},
    ),
}
OTHERS = {
    "bolt in a block without a hole": {"block": SLAB, "bolt": cylinder(5, 30)},
    "pin with flush ends": {"block": SLAB, "pin": cylinder(5, 10)},
    "flush panel in a slab without an opening": {"slab": SLAB, "panel": box((85, 85, 10))},
    "inlay in a slab without a recess": {"slab": SLAB, "inlay": moved(box((95, 95, 4)), 0, 0, 3)},
    "wire in a solid sheath": {"sheath": cylinder(5, 40), "wire": cylinder(4.9, 40)},
    "shaft in its bore": {"slab": POCKET, "shaft": cylinder(10, 60, sections=48)},
    "crossed bars": {"bar": box((100, 10, 10)), "across": box((10, 100, 10))},
    "stack": {"low": SLAB, "up": moved(SLAB, 0, 0, 10)},
}


@pytest.mark.parametrize(("bodies", "expected"), COPIES.values(), ids=COPIES)
def test_a_copy_or_a_step_of_a_feature_is_found(bodies, expected):
    assert copies(drawing(**bodies)) == expected


@pytest.mark.parametrize("bodies", OTHERS.values(), ids=OTHERS)
def test_a_body_inside_another_is_no_copy(bodies):
    assert copies(drawing(**bodies)) == {}


def test_both_sides_of_the_place_of_a_copy():
    near = GAP * np.linalg.norm([100, 100, 10])
    assert copies(drawing(slab=SLAB, again=moved(SLAB, 0.5 * near, 0, 0))) == {"again": "slab"}
    assert copies(drawing(slab=SLAB, again=moved(SLAB, 5 * near, 0, 0))) == {}


@pytest.mark.parametrize(("width", "shared"), [(80, 0.7333), (88, 0.6773)])
def test_both_sides_of_the_share_of_the_surface(width, shared):
    tray = less(SLAB, moved(box((width, width, 9)), 0, 0, 1))
    assert 1 - width**2 / SLAB.area == pytest.approx(shared, abs=1e-4)
    expected = {"block": "tray"} if shared > SAME_SURFACE else {}
    assert copies(drawing(block=SLAB, tray=tray)) == expected


def test_the_points_stand_for_the_whole_surface():
    corners = np.array([[[0, 0, 0], [4, 0, 0], [0, 3, 0]], [[0, 0, 1], [0.01, 0, 1], [0, 0.01, 1]]])
    points, areas = _spread_points(corners.astype(float))
    assert areas.sum() == pytest.approx(6 + 5e-5, rel=1e-12)
    middle = (areas[:, None] * points).sum(axis=0) / areas.sum()
    np.testing.assert_allclose(
        middle, (6 * corners[0].mean(0) + 5e-5 * corners[1].mean(0)) / 6.00005
    )


@pytest.fixture
def files(tmp_path: Path) -> Path:
    scene = trimesh.Scene({"pad": SLAB, "result": POCKET, "bolt": moved(HOLE, 0, 0, 25)})
    scene.export(tmp_path / "s.obj")
    (tmp_path / "folder").mkdir()
    for name, mesh in scene.geometry.items():
        mesh.export(tmp_path / "folder" / f"{name}.stl")
    return tmp_path


def test_a_file_is_read_without_its_copies(files):
    assembly = kilter.load(files / "s.obj")
    assert assembly.names == ("result", "bolt")
    note = "1 body is in the file twice, left out: 'pad' (as 'result'); --keep-copies keeps it"
    assert assembly.notes == (note,)
    whole = kilter.load(files / "s.obj", keep_copies=True)
    assert (whole.names, whole.notes) == (("pad", "result", "bolt"), ())
    for pattern in ("pad", "p*"):
        assert kilter.load(files / "s.obj", without=pattern).names == ("result", "bolt")
    assert kilter.load(files / "s.obj", without=["pad", "bolt"]).names == ("result",)


def test_bodies_of_different_files_of_a_folder_are_no_copies(files):
    """The files may be drawn in frames of their own."""
    assert sorted(kilter.load(files / "folder").names) == ["bolt", "pad", "result"]


def test_choices_keep_the_copies(files):
    choices = kilter.save(files / "s.obj", files / "c.json", keep_copies=True)
    assert choices.keep_copies
    assert len(kilter.load(files / "c.json")) == 3
    assert len(kilter.load(files / "c.json", off="keep_copies")) == 2


def test_a_proof_is_verified_with_the_same_bodies(files):
    verdict = kilter.check(files / "s.obj")
    assert (verdict.verdict, verdict.assembly.names[-1]) == ("stable", "floor")
    assert kilter.verify(files / "s.obj", verdict.proof()).holds
    whole = kilter.load(files / "s.obj", keep_copies=True, floor=True)
    assert not kilter.verify(whole, verdict.proof()).holds
