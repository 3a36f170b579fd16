"""Straight paths: against parts that manifold3d moves step by step, and in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.planning.part_sets import bits_of, mask_of, members
from kilter.analysis.planning.sweeps import Sweeps
from kilter.contact.fits.shared_body import PartSolids
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block
from kilter.scenes.random_turned import random_turned

Direction = tuple[float, float, float]


def shared(solids: PartSolids, p: int, q: int, offset: np.ndarray) -> float:
    """Volume that part p, moved by an offset, shares with part q."""
    g = solids.geometry
    away = g.center[p] + offset - g.center[q]
    return float((solids.of(p).translate(tuple(away.tolist())) ^ solids.of(q)).volume())


def sampled(solids: PartSolids, p: int, q: int, along: np.ndarray, count: int) -> float:
    """The greatest volume shared on the way until the parts are past each other."""
    low, high = solids.geometry.part_boxes
    reach = float(np.linalg.norm(np.maximum(high[p], high[q]) - np.minimum(low[p], low[q])))
    return max(shared(solids, p, q, t * along) for t in np.linspace(0.0, 2 * reach, count))


def held_against_samples(assembly: Assembly, seed: int, tries: int, count: int) -> list[bool]:
    contacts = kilter.contacts(assembly)
    sweeps, solids = Sweeps(contacts), PartSolids(assembly.geometry)
    random, answers = np.random.default_rng(seed), []
    size, grounded = assembly.geometry.size, assembly.geometry.grounded
    normals = np.vstack([contacts.patch_normal, -contacts.patch_normal, np.eye(3), -np.eye(3)])
    for _ in range(tries):
        p = int(random.choice(np.flatnonzero(~grounded)))
        q = int(random.choice([k for k in range(len(size)) if k != p]))
        d = (
            normals[random.integers(len(normals))]
            if random.random() < 0.7
            else random.normal(size=3)
        )
        d = d / np.linalg.norm(d)
        x, y, z = (float(one) for one in d)
        stopped = sweeps.pair_stops(p, q, (x, y, z))
        volume = sampled(solids, p, q, d, count)
        tolerance = sweeps.tolerance(p, q)
        least = min(size[p], size[q])
        if stopped:  # somewhere on the way it enters by more than rounding, maybe for a moment
            if volume <= tolerance**3:
                volume = sampled(solids, p, q, d, 40 * count)
            assert volume > tolerance**3, (p, q, d)
        else:  # nowhere does it enter by more than a skin of the tolerance
            assert volume <= 6 * 2 * tolerance * least**2, (p, q, d)
        answers.append(stopped)
    return answers


def test_paths_against_parts_moved_step_by_step() -> None:
    answers = []
    for k, assembly in enumerate(
        [scene("paper-figure-9"), arch(9, ratio=0.3), random_turned("pile", 1), scene("pit-wedges")]
    ):
        answers += held_against_samples(assembly, k, 25, 60)
    assert min(answers.count(True), answers.count(False)) > 15


@pytest.mark.slow
def test_many_paths_against_parts_moved_by_five_hundredths_of_the_way() -> None:
    answers = []
    for seed in range(20):
        family = ("pile", "arch", "wedge")[seed % 3]
        answers += held_against_samples(random_turned(family, seed), seed, 60, 500)
    assert min(answers.count(True), answers.count(False)) > 300


@pytest.mark.parametrize("gap", [-2e-5, 0.0, 2e-5])
def test_sliding_along_a_face_is_free_within_the_tolerance(gap: float) -> None:
    """Unit cubes side by side: 1e-5 of a size, or twice as deep as they are drawn."""
    beside = Part("b", Box([1, 1, 1]), Pose([1.5 + gap, 0.5, 0.5]))
    pair = Assembly([block("a", [0, 0, 0], [1, 1, 1]), beside])
    sweeps = Sweeps(kilter.contacts(pair))
    assert sweeps.tolerance(0, 1) == pytest.approx(max(1e-5 * np.sqrt(3), -2 * gap), rel=1e-6)
    assert not sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0))
    assert sweeps.pair_stops(0, 1, (1.0, 0.0, 0.0))
    assert not sweeps.pair_stops(0, 1, (-1.0, 0.0, 0.0))


@pytest.mark.parametrize(("shift", "stops"), [(0.999, True), (0.9999999, False), (1.001, False)])
def test_an_overlap_counts_where_it_is_wider_than_the_tolerance(shift: float, stops: bool) -> None:
    pair = Assembly(
        [block("a", [0, 0, 0], [1, 1, 1]), block("b", [shift, 0, 3], [shift + 1, 1, 4])]
    )
    assert Sweeps(kilter.contacts(pair)).pair_stops(0, 1, (0.0, 0.0, 1.0)) == stops


@pytest.mark.parametrize(("distance", "stops"), [(1.999, False), (2.001, True), (np.inf, True)])
def test_a_path_ends_where_it_ends(distance: float, stops: bool) -> None:
    pair = Assembly([block("a", [0, 0, 0], [1, 1, 1]), block("b", [0, 0, 3], [1, 1, 4])])
    sweeps = Sweeps(kilter.contacts(pair))
    assert sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0), distance=distance) == stops
    aside = np.array([1.5, 0.0, 0.0])
    assert not sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0), distance=distance, start=aside)


def test_a_set_of_parts_stops_what_one_of_them_stops() -> None:
    made = scene("wall")
    sweeps, up = Sweeps(kilter.contacts(made)), (0.0, 0.0, 1.0)
    random, count = np.random.default_rng(0), len(made)
    for _ in range(30):
        present, part = random.random(count) < 0.4, int(random.integers(count))
        each = [sweeps.pair_stops(part, k, up) for k in np.flatnonzero(present) if k != part]
        assert sweeps.stops(part, bits_of(present), up) == any(each)
    assert members(bits_of(present), count).tolist() == np.flatnonzero(present).tolist()
    assert (mask_of(bits_of(present), count) == present).all()
