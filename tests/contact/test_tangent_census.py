"""A slice of the census of bodies that touch in a point: `benchmarks/tangent_census.py`."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("OCP")

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def census():
    sys.path.append(str(FOLDER))
    spec = importlib.util.spec_from_file_location("tangent_census", FOLDER / "tangent_census.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["tangent_census"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(60))
def test_the_contact_point_of_two_bodies_is_that_of_their_nearest_points(census, seed):
    scene = census.random_scene(np.random.default_rng(seed))
    assert scene is None or census.judged(scene) == []
