"""Motions that obey Coulomb's law, near it, and beyond a limit."""

import json
from pathlib import Path

import numpy as np
import pytest
from beyond_limits import beyond_limit, thinnest_arch
from cases import planar, program, random_block
from coulomb_oracle import explained
from held_or_not import cylinders, equilibrium, slope, thin_bracket, worst_by_hand
from modes_oracle import greatest_power
from transformations import tilted

import kilter
from kilter import Joint
from kilter.analysis.decision.motion import NO_MOTION_BY_LAW, find_motion
from kilter.cli import main
from kilter.friction.law import breach, coulomb_law, may_obey
from kilter.friction.motion_search import find_coulomb_motion
from kilter.friction.seating import find_seating
from kilter.mechanics.law_check import check_law
from kilter.scenes import friction, stacks, traps, walls
from kilter.scenes import friction as accelerations
from kilter.scenes.arches import arch_with_held_ends
from kilter.scenes.stacks import block_on_slope
from kilter.tell.tables import NO_ACCELERATION
from kilter.tell.words import GAINS
from kilter.work import Work, units_of
from sampled import sampled

G = 9.81


def found_and_checked(assembly, effort=3):
    """The motion, also checked by explicit formulas."""
    built = program(assembly)
    witness = find_coulomb_motion(built, work=effort)
    assert witness is not None
    assert witness.exact
    assert witness.law.residual <= 1e-9
    assert worst_by_hand(built, witness.acceleration, witness.forces) < 1e-8
    return built, witness


@pytest.mark.quick(4)
@pytest.mark.parametrize(
    "assembly",
    [
        friction.h_block(),
        friction.h_block(planar=True),
        friction.a_block(),
        friction.squeezed_row(4),
        friction.squeezed_row(5, thickness=0.3, height=0.4, friction=0.7),
    ],
    ids=["H", "planar H", "A", "books", "flat arch"],
)
def test_what_squeeze_alone_holds_can_fall_freely(assembly):
    built, witness = found_and_checked(assembly)
    assert equilibrium(built)
    free = witness.acceleration[built.free]
    assert free[:, :3] == pytest.approx(np.tile(built.gravity, (len(free), 1)), abs=1e-6)
    assert free[:, 3:] == pytest.approx(0, abs=1e-6)


def test_a_bracket_is_seated_and_can_fall():
    built, witness = found_and_checked(thin_bracket(1.1))
    assert equilibrium(built)
    assert find_seating(built).holds
    assert witness.law.power == pytest.approx(1)


@pytest.mark.slow
@pytest.mark.parametrize(("tilt", "tips"), [(40.0, False), (41.5, True), (50.0, True)])
def test_a_wedge_in_a_steep_v_tips_out_past_its_corner(tilt, tips):
    """The V of 60 degrees holds by wedging; the prism tips where its centre passes its corner.

    The centre is 2/3 of the rise above the lowest edge, whose end is half a length away.
    """
    limit = np.degrees(np.arctan(1.0 / (2 / 3 * np.tan(np.radians(60)))))
    assert limit == pytest.approx(40.893, abs=1e-3)
    wedge = friction.trough(60, tilt=tilt, friction=0.84, length=2.0)
    assert equilibrium(program(wedge))
    if tips:
        _, witness = found_and_checked(wedge)
        assert witness.found == "contact modes"
        assert abs(witness.acceleration[1, 3]) > 1e-3 * G
    else:
        assert find_coulomb_motion(program(wedge), work=1) is None


@pytest.mark.slow
@pytest.mark.parametrize(
    "assembly",
    [
        slope(26.5),
        friction.ladder(51.5, planar=False),
        friction.v_block(friction=0.5),
        stacks.tower(6),
        cylinders(0.3, 0.1),
    ],
    ids=["slope", "ladder", "V", "tower", "cylinders"],
)
def test_what_must_hold_has_no_motion(assembly):
    assert find_coulomb_motion(program(assembly), work=1) is None


# where no equilibrium exists, the motion is the impending one -------------------------------


@pytest.mark.parametrize("tilt", [26.6, 30.0, 60.0])
def test_a_block_slides_with_the_closed_form(tilt):
    built, witness = found_and_checked(slope(tilt))
    t = np.radians(tilt)
    speed = np.linalg.norm(witness.acceleration[built.free][0, :3])
    assert speed == pytest.approx(G * (np.sin(t) - 0.5 * np.cos(t)), abs=1e-9)


@pytest.mark.parametrize("tilt", [44.15, 47.0])
def test_a_prism_slides_down_its_trough(tilt):
    built, witness = found_and_checked(friction.trough(30, tilt=tilt, friction=0.84))
    t = np.radians(tilt)
    along = G * (np.sin(t) - 0.84 / np.cos(np.radians(30)) * np.cos(t))
    assert equilibrium(built)  # to 47.961 degrees
    assert witness.acceleration[1, 1] == pytest.approx(along, abs=1e-8)


def test_without_friction_it_is_gauss():
    built = program(accelerations.wedge_on_wedge(30))
    _, witness = found_and_checked(accelerations.wedge_on_wedge(30))
    assert witness.acceleration == pytest.approx(find_motion(built).acceleration, abs=1e-6)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "assembly",
    [
        friction.ladder(51.0),
        friction.ladder(45.0, friction_wall=0.3, planar=False),
        friction.a_block(friction=0.1),
        friction.books(4, force=30.0),
        # the search finds a motion of about two in three of such walls
        walls.tilted_wall(13.0, courses=4, per_course=3, friction=0.15),
    ],
    ids=["ladder", "rough ladder", "A", "books", "wall"],
)
def test_what_cannot_hold_moves_exactly(assembly):
    built, _ = found_and_checked(assembly)
    assert not equilibrium(built)


def test_nothing_touches_and_all_falls():
    built, witness = found_and_checked(traps.floating_block(1, count=2).without(["floor"]))
    assert not len(built.part_a)
    assert not find_seating(built).holds
    assert witness.law.power == pytest.approx(1)


# against every mode, one by one --------------------------------------------------------------


@pytest.mark.slow
def test_planar_blocks_at_random_by_every_mode():
    rng = np.random.default_rng(2)
    counts = {"moves": 0, "rests": 0, "both": 0}
    for _ in range(24):
        assembly = random_block(rng, int(rng.integers(2, 4)))
        built = program(assembly.with_down([0.7 * rng.normal(), 0, -1]))
        power = greatest_power(built)
        witness = find_coulomb_motion(built, work=2 if power > 1e-6 else 0.2)
        assert (witness is not None) == (power > 1e-6)
        if witness is not None:
            assert witness.law.power <= power * (1 + 1e-6)
        word = "rests" if witness is None else "both" if equilibrium(built) else "moves"
        counts[word] += 1
    assert min(counts.values()) >= 2


# what must be refused ---------------------------------------------------------------------------


def test_a_witness_perturbed_or_flipped_is_refused():
    built, witness = found_and_checked(slope(35))
    assert check_law(built, witness.acceleration, witness.forces).holds
    rng = np.random.default_rng(0)
    for size in (1e-6, 1e-3):
        noise = rng.normal(size=witness.acceleration.shape) * size * G
        assert not check_law(built, witness.acceleration + noise, witness.forces).holds
    most = np.abs(witness.forces).max()
    for k, axis in np.argwhere(np.abs(witness.forces) > 1e-3 * most):
        forces = witness.forces.copy()
        forces[k, axis] *= -1
        assert not check_law(built, witness.acceleration, forces).holds


@pytest.mark.slow
def test_tells_what_it_does_keeps_to_its_budget_and_repeats_itself():
    said = []
    built = program(slope(10))
    assert find_coulomb_motion(built, work=Work(units_of(0.5), said.append)) is None
    assert len(said) >= 1
    assert all(isinstance(line, str) for line in said)
    assert find_coulomb_motion(built, work=0.5, impending=True) is None
    assert find_coulomb_motion(program(slope(10).with_grounded(["*"])), work=1) is None
    built = program(friction.a_block())
    one, two = (find_coulomb_motion(built, work=2, seed=3) for _ in range(2))
    assert np.array_equal(one.acceleration, two.acceleration)


WITNESSED = {
    "H": friction.h_block(),
    "planar H": planar(friction.h_block()),
    "books": friction.books(2),
    "a slope too steep": stacks.block_on_slope(40.0, friction=0.5),
    "a planar slope": planar(stacks.block_on_slope(40.0, friction=0.5)),
    "joints": tilted(
        stacks.tower(2).with_friction(0.5)._replace(joints=[Joint(("cube-1", "cube-2"))]),
        [0, 1, 0],
        35.0,
    ),
}


@pytest.fixture(scope="module", params=WITNESSED)
def witnessed(request):
    """Law, and x and scaled forces of a motion that obeys it."""
    built = program(WITNESSED[request.param])
    law, witness = coulomb_law(built), find_coulomb_motion(built, work=1)
    assert witness.exact
    own = np.einsum("kij,kj->ki", law.basis, witness.forces)
    return law, law.columns(witness.acceleration), own * (law.sigma / law.strength)[:, None]


@pytest.mark.quick(1)
def test_a_witness_is_not_dismissed_and_has_no_breach(witnessed):
    law, x, forces = witnessed
    assert may_obey(law, x, forces)
    assert abs(breach(law, x, forces)) < 1e-8


@pytest.mark.quick(2)
def test_what_is_dismissed_would_not_pass(witnessed):
    """Errors of all sizes: the two checks differ by at most the allowance."""
    law, x, forces = witnessed
    rng, said = np.random.default_rng(0), []
    for size in np.geomspace(1e-13, 1e-2, 23):
        off = x + size * rng.normal(size=x.shape)
        pushes = forces + size * rng.normal(size=forces.shape) * (forces != 0)
        exact = check_law(law.program, law.acceleration(off), law.forces(pushes)).holds
        said.append((may_obey(law, off, pushes), exact))
    assert all(cheap or not exact for cheap, exact in said)
    assert said[0] == (True, True)
    assert said[-1] == (False, False)


def test_a_motion_that_loses_power_is_dismissed(witnessed):
    law, x, forces = witnessed
    assert not may_obey(law, -x, forces)
    assert not may_obey(law, 0 * x, forces)


def test_a_breach_is_the_power_of_a_force_where_it_may_not_push():
    """The breach of a falling block with forces f at its corners is their power."""
    law = coulomb_law(program(stacks.block_on_slope(0.0, friction=0.5)))
    pushes = np.zeros((len(law.mu), 3))
    pushes[:, 0] = 0.25
    up = -law.load
    assert breach(law, up, pushes) == pytest.approx(float((law.matrix @ up) @ pushes.ravel()))
    assert breach(law, up, pushes) > 0.1
    assert breach(law, 0 * up, pushes) == 0


@pytest.mark.quick(1)
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
