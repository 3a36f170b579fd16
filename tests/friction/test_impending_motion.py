"""The motion of an unstable assembly with friction obeys Coulomb's law, or the answer says so."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from beyond_limits import beyond_limit, thinnest_arch
from coulomb_oracle import explained

import kilter
from kilter.analysis.decision.motion import NO_MOTION_BY_LAW, find_motion
from kilter.cli import main
from kilter.scenes.arches import arch_with_held_ends
from kilter.scenes.stacks import block_on_slope
from kilter.tell.tables import NO_ACCELERATION
from kilter.tell.words import GAINS
from sampled import sampled


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", sampled(9, 36))
def test_a_motion_beyond_a_limit_obeys_the_law_and_that_without_friction_does_not(seed):
    verdict = kilter.check(beyond_limit(seed).assembly)
    assert verdict.verdict == "unstable"
    assert verdict.motion.known
    assert explained(verdict.modelled, verdict.motion.acceleration).obeys
    smooth = find_motion(verdict.modelled.with_rows(mu=0.0 * verdict.modelled.mu))
    assert not explained(verdict.modelled, smooth.acceleration).obeys


@pytest.mark.slow
def test_a_thin_arch_turns_about_hinges_ever_slower_toward_its_limit():
    """Accelerations vanish in proportion to the distance from the critical thickness."""
    limit, found = thinnest_arch(20), []
    for distance in (1e-2, 1e-3):
        arch = arch_with_held_ends(20, thickness=limit * (1 - distance), inner=5.0, friction=0.7)
        verdict = kilter.check(arch)
        assert all(verdict.words(name).startswith("tips about ") for name in verdict.moving)
        found.append(float(np.linalg.norm(verdict.motion.acceleration, axis=1).max()) / distance)
    assert found[1] == pytest.approx(found[0], rel=0.05)


@pytest.fixture
def unfound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A file of a block that slides, whose motion no search finds."""
    name = "kilter.friction.motion_search.find_coulomb_motion"
    monkeypatch.setattr(name, lambda *_, **__: None)
    monkeypatch.chdir(tmp_path)
    kilter.dump(block_on_slope(30.0, friction=0.5), "slope.json")
    return "slope.json"


def test_where_no_motion_is_found_the_answer_says_so_and_shows_that_of_the_proof(unfound, capsys):
    assert main(["check", unfound, "--json", "--quiet"]) == 1
    answer = json.loads(capsys.readouterr().out)
    (block,) = (part for part in answer["parts"] if part["moves"])
    assert block["acceleration"] is None
    assert block["motion"].endswith(GAINS)
    assert " g" not in block["motion"].removesuffix(GAINS)
    assert answer["summary"].endswith(GAINS)
    assert answer["instability"] is None
    assert NO_MOTION_BY_LAW in answer["warnings"]
    assert main(["check", unfound, "--quiet"]) == 1
    out = capsys.readouterr().out
    assert GAINS in out
    assert NO_ACCELERATION in out
