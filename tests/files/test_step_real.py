"""The CAx-IF test assembly, beside the checkout: 18 solids, cylinders stored as B-splines."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("OCP")

import kilter
from kilter.assembly import Assembly
from kilter.contact import detect
from kilter.files import from_dict, load, to_dict
from kilter.shape.closed import open_edges
from kilter.shape.recognition import recognise
from kilter.shape.solid import Solid

FILE = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if" / "as1-oc-214.stp"

pytestmark = pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")

FACES = {
    "plate": {"plane": 6, "hollow cylinder": 6},
    "l-bracket": {"plane": 8, "hollow cylinder": 4},
    "bolt": {"plane": 3, "cylinder": 2},
    "nut": {"plane": 6, "hollow cylinder": 1},
    "rod": {"plane": 2, "cylinder": 1},
}
SPLINES = 1e-6
"""Relative difference in volume between the file's splines and cylinders (2.6e-5 mm of 5 mm)."""


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return load(FILE)


def solid_of(assembly: Assembly, product: str) -> Solid:
    name = next(n for n in assembly.names if n.split("/")[-1].split("_")[0] == product)
    shape = assembly.parts[assembly.index_of(name)].shape
    assert isinstance(shape, Solid)
    return shape


def test_names_units_and_instances(assembly: Assembly) -> None:
    below = [f"nut-bolt-assembly_{k}/{part}" for k in (1, 2, 3) for part in ("bolt", "nut")]
    sides = [f"l-bracket-assembly_{k}/{n}" for k in (1, 2) for n in [*below, "l-bracket"]]
    rods = ["nut_1", "nut_2", "rod"]  # the only nut in the rod assembly
    assert sorted(assembly.names) == sorted(["plate", *rods, *sides])
    assert assembly.units == "mm"
    assert assembly.notes == ()
    assert len({id(part.shape) for part in assembly.parts}) == 5


@pytest.mark.parametrize("product", FACES)
def test_every_face_is_known(product: str, assembly: Assembly) -> None:
    solid = solid_of(assembly, product)
    found = Counter(f"hollow {s.kind}" if s.hollow else s.kind for s in solid.surfaces)
    assert found == FACES[product]
    assert (solid.triangle_surface >= 0).all()
    assert solid.accuracy < 3e-5
    radii = {round(s.radius, 5) for s in solid.surfaces if s.kind == "cylinder"}
    assert radii == ({5.0, 7.5} if product == "bolt" else {5.0})
    on_mesh = recognise(solid.vertices, solid.triangles, solid.accuracy)[0]
    assert Counter(f"hollow {s.kind}" if s.hollow else s.kind for s in on_mesh) == FACES[product]


def test_volumes_by_formula(assembly: Assembly) -> None:
    def between(solid: Solid, normal: list[float]) -> np.ndarray:
        """Heights of the planes perpendicular to a direction."""
        planes = [s for s in solid.surfaces if s.kind == "plane"]
        return np.sort([s.point @ normal for s in planes if abs(s.axis @ normal) > 0.999])

    rod = solid_of(assembly, "rod")
    assert rod.volume == pytest.approx(np.pi * 25 * 200, rel=SPLINES)
    across, along = rod.volume * 25 / 4, rod.volume * 200**2 / 12
    assert rod.second_moment == pytest.approx(
        np.diag([across, across, along]), rel=SPLINES, abs=SPLINES * across
    )
    bolt = solid_of(assembly, "bolt")
    low, middle, high = between(bolt, bolt.surfaces[0].axis.tolist())
    head, shank = sorted((middle - low, high - middle))
    assert bolt.volume == pytest.approx(np.pi * (7.5**2 * head + 25 * shank), rel=SPLINES)
    plate = solid_of(assembly, "plate")
    x, y, z = np.ptp(plate.vertices, axis=0)
    assert plate.volume == pytest.approx(x * y * z - 6 * np.pi * 25 * z, rel=SPLINES)


@pytest.mark.slow
def test_it_is_read_quickly_and_written_exactly(assembly: Assembly) -> None:
    start = time.process_time()
    load(FILE)
    assert time.process_time() - start < 4.0  # 0.5 s on a free core
    written = to_dict(assembly)
    assert to_dict(from_dict(written)) == written


SPACESHIP = FILE.parent / "s1-tu-203" / "s1-tu-203.stp"
OVERLAPS = {
    ("foot_2/footback", "mainbodyback"): 97.4,
    ("foot_2/footback", "mainbodyfront"): 81.3,
    ("foot_2/footfront", "mainbodyfront"): 152.3,
}
"""Overlap volumes by exact Boolean operations of the faces [mm^3]."""


@pytest.mark.slow
@pytest.mark.skipif(not SPACESHIP.is_file(), reason="real data is not here")
def test_shells_on_one_axis_do_not_interfere_and_what_overlaps_does() -> None:
    # mainbodyback has a solid cylinder of radius 73, mainbodyfront holes of 67 and 72 on its axis
    assembly = load(SPACESHIP)
    contacts = detect.contacts(assembly)
    found = {
        tuple(sorted(assembly.names[k] for k in overlap.parts)): overlap
        for overlap in contacts.overlaps
    }
    assert set(found) == set(OVERLAPS)
    for parts, volume in OVERLAPS.items():
        assert found[parts].volume == pytest.approx(volume, rel=0.02)
    # both are parts of the same foot, whose copy is placed correctly
    asked = next(word for word in contacts.warnings if "in the right place" in word)
    assert "is 'foot_2/footback' in the right place?" in asked
    assert "its copy 'foot_1/footfront' overlaps nothing" in asked


CLIPS = FILE.parents[1] / "voron" / "SKR_3_Din_Mount.step"


@pytest.mark.slow
@pytest.mark.skipif(not CLIPS.is_file(), reason="real data is not here")
def test_a_file_with_faces_that_the_mesher_leaves_out_is_read_whole() -> None:
    assembly = load(CLIPS)
    assert Counter(name[:-2] for name in assembly.names) == {"DIN Clips (3)": 2, "SKR Bracket": 2}
    for part in assembly.parts:
        shape = part.shape
        assert isinstance(shape, Solid)
        assert len(shape.holes) == 0
        assert not shape.stand_in
        assert len(open_edges(shape.vertices, shape.triangles)) == 0
        corners = shape.vertices[shape.triangles]
        cut = np.einsum("ni,ni->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        assert shape.volume == pytest.approx(cut, rel=0.01)


@pytest.mark.slow
def test_with_its_bolts_joined_it_is_stable_although_shafts_turn_in_their_bores() -> None:
    held = load(FILE, ground=["plate"], friction=0.3)
    verdict = kilter.check(kilter.fastened(held, suggested=True))
    assert (verdict.verdict, verdict.level) == ("stable", "proved")
