"""A slice of the census of round bodies: `benchmarks/round_census.py`."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

pytest.importorskip("OCP")

FILE = Path(__file__).resolve().parents[2] / "benchmarks" / "round_census.py"


@pytest.fixture(scope="module")
def census():
    spec = importlib.util.spec_from_file_location("round_census", FILE)
    module = importlib.util.module_from_spec(spec)
    sys.modules["round_census"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(80))
def test_round_bodies_touch_and_stay_as_closed_forms_say(census, seed):
    _, _, wrong = census.asked(seed)
    assert wrong == []
