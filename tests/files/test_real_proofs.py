"""Real STEP files whose answer needs a solver beside the first."""

from __future__ import annotations

from pathlib import Path

import pytest

from kilter.analysis.check import check
from kilter.files import load

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
    ),
]


def test_a_mount_with_coordinates_far_from_the_origin_is_proved() -> None:
    """Rounding errors of 1e-12 in the rows made every simplex fail: no motion, no forces."""
    pytest.importorskip("OCP")
    verdict = check(load(DATA / "voron" / "MiniSB_adxl_mount.step", floor=True))
    assert verdict.verdict == "unstable"
    assert verdict.decision.judgement.motion.holds
