"""Contacts of random and real assemblies against the brute-force oracle: none lost or invented."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracle import clip_triangles, discrepancies, oracle, polygon_measures
from random_scenes import FAMILIES, block, column, random_scene, ring

import kilter.contact
from kilter.assembly import Assembly, Part
from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet
from kilter.rigid import Pose
from kilter.shape.primitives import Prism

DATA = Path(__file__).parents[3] / "shared" / "data"
SCENES = int(os.environ.get("KILTER_SCENES", "0"))
"""Scenes compared in place of the 300 of a run; 10,000 take some minutes."""
REAL = {
    "compas_cra/cubes.json": Tolerance(),
    "compas_cra/H.json": Tolerance(),
    "compas_cra/A.json": Tolerance(),
    "compas_cra/bridge.json": Tolerance(),
    "compas_cra/shelf-stable.json": Tolerance(),
    "compas_cra/type-a.json": Tolerance(),
    "compas_cra/type-c.json": Tolerance(),
    "learn2assemble/tetris-2": Tolerance(),
    "learn2assemble/dome": Tolerance(),
}


def scene(*pieces) -> Assembly:
    return Assembly([Part(f"p{k}", s, Pose(o)) for k, (s, o) in enumerate(pieces)])


# the oracle by itself ----------------------------------------------------------------


def test_triangles_are_clipped_to_their_overlap():
    first = np.array([[[0, 0], [2, 0], [0, 2]]] * 4, dtype=float)
    second = np.array(
        [
            [[0, 0], [2, 0], [0, 2]],  # the same
            [[1, 0], [3, 0], [1, 2]],  # shifted by half
            [[2, 0], [2, 2], [0, 2]],  # the other half of the square
            [[5, 5], [6, 5], [5, 6]],  # apart
        ],
        dtype=float,
    )
    polygons = clip_triangles(first, second)
    areas = polygon_measures(polygons)[0]
    assert np.nan_to_num(areas).tolist() == pytest.approx([2, 0.5, 0, 0], abs=1e-15)
    assert np.isnan(polygons[3]).all()


def test_oracle_cube_on_cube():
    (region,) = oracle(scene(block([0, 0, 0], [1, 1, 1]), block([0.25, 0.5, 1], [1.25, 1.5, 2])))
    assert region.area == pytest.approx(0.75 * 0.5, rel=1e-14)
    assert region.normal.tolist() == [0, 0, 1]
    assert region.gap == (0.0, 0.0)
    assert region.sure.min(axis=0).tolist() == [0.25, 0.5, 1]
    assert region.sure.max(axis=0).tolist() == [1, 1, 1]


def test_oracle_box_in_the_corner_of_an_l():
    corner = Prism([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], 2)
    regions = oracle(scene((corner, np.array([0, 1.0, 0])), block([1, 0, 1], [2.5, 2, 4])))
    assert sorted(r.area for r in regions) == pytest.approx([3.0, 4.0], rel=1e-14)


def test_oracle_box_over_a_hole():
    square = np.array([[1.0, 1], [-1, 1], [-1, -1], [1, -1]])
    lid = block([-1.5, -1.5, 0.5], [1.5, 1.5, 1])
    (region,) = oracle(scene((ring(2 * square, square, 1.0), np.zeros(3)), lid))
    assert region.area == pytest.approx(5.0, rel=1e-14)


def test_oracle_plug_in_a_hole():
    square = np.array([[1.0, 1], [-1, 1], [-1, -1], [1, -1]])
    plug = (column(square, -0.25, 2.0), np.zeros(3))
    regions = oracle(scene((ring(2 * square, square, 1.0), np.zeros(3)), plug))
    assert [r.area for r in regions] == pytest.approx([1.5] * 4, rel=1e-14)


@pytest.mark.parametrize(("gap", "count"), [(0.9, 1), (-0.9, 1), (1.1, 0), (-1.1, 0)])
def test_oracle_gap_at_the_tolerance(gap, count):
    gap *= 1e-5 * np.sqrt(3)
    regions = oracle(scene(block([0, 0, 0], [2, 2, 2]), block([0, 0, 2 + gap], [1, 1, 3 + gap])))
    assert len(regions) == count


def test_oracle_edge_on_edge_is_no_patch():
    assert oracle(scene(block([0, 0, 0], [1, 1, 1]), block([1, 0, 1], [2, 1, 2]))) == []


def test_oracle_finds_both_feet_of_a_u_in_one_plane():
    arch = Prism([[0, 0], [1, 0], [1, 2], [3, 2], [3, 0], [4, 0], [4, 3], [0, 3]], 2)
    (region,) = oracle(scene((arch, np.zeros(3)), block([-1, -1, -1], [5, 1, 0])))
    assert region.area == pytest.approx(4.0, rel=1e-14)


def altered(contacts: ContactSet, change: str) -> ContactSet:
    """A ContactSet with a single error."""
    points, normal = contacts.points.copy(), contacts.patch_normal.copy()
    area, gap = contacts.patch_area.copy(), contacts.patch_gap.copy()
    parts = contacts.patch_parts.copy()
    if change == "area":
        area[0] *= 1 + 1e-9
    elif change == "corner":
        points[0] += 1e-9 * (points[1] - points[0])
    elif change == "normal":
        normal[0] *= -1
    elif change == "gap":
        gap[0, 1] += 1e-9
    elif change == "pair":
        parts[0] = [0, 3]
    elif change == "moved":
        points[: contacts.patch_start[1]] += 1e-4 * normal[0]
    return replace(
        contacts, points=points, patch_normal=normal, patch_area=area, patch_gap=gap,
        patch_parts=parts,
    )  # fmt: skip


@pytest.mark.quick(5)
@pytest.mark.parametrize("change", ["", "area", "corner", "normal", "gap", "pair", "moved"])
def test_comparison_sees_what_is_wrong(change):
    boxes = [block([0.2 * k, 0.1 * k, k], [1 + 0.2 * k, 1 + 0.1 * k, k + 1]) for k in range(4)]
    assembly = scene(*boxes)
    wrong = discrepancies(assembly, altered(kilter.contact.contacts(assembly), change))
    assert bool(wrong) == bool(change)


# random scenes -----------------------------------------------------------------------


def complaints(seeds, name: str | None = None) -> list[str]:
    wrong = []
    for seed in seeds:
        assembly = random_scene(seed, name)
        try:
            contacts = kilter.contact.contacts(assembly)
        except Exception as error:  # said with its seed, and the other seeds tried too
            wrong.append(f"{assembly.source}: {error!r}")
            continue
        wrong += [f"{assembly.source}: {text}" for text in discrepancies(assembly, contacts)]
    return wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_random_scenes_agree_with_the_oracle(name):
    count = -(-(SCENES or 140) // len(FAMILIES))
    wrong = complaints(range(count), name)
    assert not wrong, "\n".join(wrong)


@pytest.mark.slow
@pytest.mark.parametrize("block_of_scenes", range(3))
def test_hundreds_of_random_scenes_agree_with_the_oracle(block_of_scenes):
    wrong = complaints(range(1000 + 200 * block_of_scenes, 1200 + 200 * block_of_scenes))
    assert not wrong, "\n".join(wrong)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(FAMILIES) - {"gaps", "tilts"}))
def test_one_patch_a_pair_and_plane(name):
    wrong = []
    for seed in range(8):
        assembly = random_scene(seed, name, "pose")
        regions = oracle(assembly)
        found, expected = len(kilter.contact.contacts(assembly)), len(regions)
        if found != expected and not any(region.borderline for region in regions):
            wrong.append(f"{assembly.source}: {found} patches in {expected} planes")
    assert not wrong, "\n".join(wrong)


# real assemblies ---------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("file", sorted(REAL))
def test_real_assemblies_agree_with_the_oracle(file):
    if not (DATA / file).exists():
        pytest.skip(f"no {DATA / file}")
    assembly = kilter.load(DATA / file)
    regions = oracle(assembly, REAL[file])
    assert regions, "the oracle finds no contact: nothing is tested"
    found = kilter.contact.contacts(assembly, tolerance=REAL[file])
    wrong = discrepancies(assembly, found, regions)
    assert not wrong, "\n".join(wrong)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1131, 2147])
def test_a_way_along_a_facet_at_a_corner_is_no_number_too_many(seed):
    """A direction and a target at the same height over a facet: the way runs along its plane."""
    assert complaints([seed]) == []
