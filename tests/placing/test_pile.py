"""Piles that grow box by box, and parts of uncertain mass."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely
from planks import bridge, overhang

import kilter
from kilter import Assembly, InputError, Pile, PileFit, Places, box_to_place, contacts, place
from kilter.analysis.check import check_equilibrium
from kilter.analysis.placing.piles.pile_hulls import surround
from kilter.analysis.placing.place_at import part_cases
from kilter.cli import main
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import Program, build_program

NEAR = 1e-6
"""Distance from a limit, on both sides [lengths of a box]."""


def plank_on_block(length: float, weight: float, beyond: float) -> Pile:
    """A plank that extends beyond the edge of a block at x = 1."""
    pile = Pile((3, 1))
    pile.add((1, 1, 0.5), 5, (0, 0))
    pile.add((length, 1, 0.1), weight, (1 + beyond - length, 0))
    return pile


def stands_with(pile: Pile, size: tuple, mass: float, x: float, y: float = 0.5) -> bool | None:
    """Whether a copy of the pile stands with a box whose centre is at a place."""
    grown = pile.copy()
    grown.add(size, mass, (x - size[0] / 2, y - size[1] / 2))
    return grown.stands


@pytest.mark.parametrize(
    ("length", "weight", "beyond", "load"), [(1, 2, 0.3, 2.5), (1, 2, 0.4, 1), (1.2, 5, 0.5, 2)]
)
def test_a_load_beyond_the_edge(length, weight, beyond, load):
    """W (L / 2 - e) / w beyond the edge."""
    pile = plank_on_block(length, weight, beyond)
    limit = 1 + weight * (length / 2 - beyond) / load
    small = (1e-3, 1e-3, 0.1)
    assert stands_with(pile, small, load, limit - NEAR) is True
    assert stands_with(pile, small, load, limit + NEAR) is False


@pytest.mark.parametrize(("x", "heaviest"), [(0.1, 4.0), (0.2, 2.0), (0.25, 1.6)])
def test_the_heaviest_load_beyond_the_edge(x, heaviest):
    pile = plank_on_block(1, 2, 0.3)
    small = (1e-3, 1e-3, 0.1)
    assert stands_with(pile, small, heaviest * (1 - NEAR), 1 + x) is True
    assert stands_with(pile, small, heaviest * (1 + NEAR), 1 + x) is False


@pytest.mark.parametrize(("weight", "half", "load"), [(2, 0.1, 1), (2, 0.1, 8), (3, 0.15, 2.5)])
def test_a_load_on_a_seesaw(weight, half, load):
    """The limit is a (1 + W / w) from the middle; a second load farther out balances the first."""
    pile = Pile((2, 1))
    pile.add((2 * half, 1, 0.5), 5, (1 - half, 0))
    pile.add((2, 1, 0.1), weight, (0, 0))
    limit = half * (1 + weight / load)
    small = (1e-3, 1e-3, 0.1)
    for side in (-1, 1):
        assert stands_with(pile, small, load, 1 + side * (limit - NEAR)) is True
        assert stands_with(pile, small, load, 1 + side * (limit + NEAR)) is False
    inner = 0.9 * limit
    pile.add(small, load, (1 + inner, 0.5))
    balanced = 1 - inner
    assert stands_with(pile, small, load, balanced) is True
    # moments about the left edge of the base
    farthest = (weight * half + load * (half + inner) + load * half) / load
    assert stands_with(pile, small, load, 1 - farthest + 1e-2) is True
    assert stands_with(pile, small, load, 1 - farthest - 1e-2) is False


def test_a_box_that_bridges_two_planks():
    """The limit: x (3 - 1.1 / (.7 - x)) = .05, for a box of 3 kg over two planks of 1 kg."""
    pile = Pile((2, 1))
    for x in (0.6, 1.4):
        pile.add((0.1, 1, 0.5), 5, (x - 0.05, 0))
    for x in (0.6, 1.4):
        pile.add((0.5, 1, 0.1), 1, (x - 0.25, 0))
    assert pile.stands
    limit = 0.0373107
    for side in (-1, 1):
        assert stands_with(pile, (0.7, 0.5, 0.2), 3, 1 + side * (limit - 1e-6)) is True
        assert stands_with(pile, (0.7, 0.5, 0.2), 3, 1 + side * (limit + 1e-6)) is False


def test_a_pile_that_falls_stands_again_under_a_counterweight():
    pile = plank_on_block(1, 2, 0.6)
    assert pile.stands is False
    small = (1e-3, 1e-3, 0.1)
    # moments about the edge: 2 x 0.1 = 1 x 0.2
    assert stands_with(pile, small, 1, 0.8 - NEAR) is True
    assert stands_with(pile, small, 1, 0.8 + NEAR) is False
    fit = pile.fits(small, 1, 0.1)
    assert fit.mask[:, 5].tolist() == [False] * 6 + [True] * 2 + [False] * 22
    assert not fit.undecided.any()


def test_a_centre_above_an_edge_stands():
    pile = Pile((2, 1))
    pile.add((1, 1, 0.5), 1, (0, 0))
    mask, heights = pile.fits((1, 1, 0.5), 1, 0.25)
    assert mask[:, 0].tolist() == [True, True, True, False, True, False, False, False]
    assert heights[:5, 0].tolist() == [0.5, 0.5, 0.5, 0.5, 0.0]
    assert np.isnan(heights[5:]).all()


def test_tops_within_the_tolerance_carry_together():
    """The gap tolerance is 1e-5 of the size of the smaller box, here 1.5e-5."""
    for lower, verdict in ((1e-5, True), (1e-2, False)):
        pile = Pile((3, 1))
        pile.add((1, 1, 0.5), 1, (0, 0))
        pile.add((1, 1, 0.5 - lower), 1, (2, 0))
        assert stands_with(pile, (2, 0.5, 0.5), 1, 1.7) is verdict


def test_a_near_top_is_undecided_as_in_check():
    pile = Pile((3, 1))
    pile.add((1, 1, 0.5), 1, (0, 0))
    pile.add((1, 1, 0.5 - 1e-4), 1, (2, 0))
    size, at = (2, 0.5, 0.5), (0.7, 0.25)
    grown = pile.copy()
    grown.add(size, 1, at)
    assert grown.stands is None
    assert grown.verdict().verdict == "undecided"
    fit = pile.fits(size, 1, 0.25)
    assert fit.undecided[3, 1]
    assert not fit.mask[3, 1]
    assert fit.share < 1


def test_narrow_overlaps_are_passed():
    """A box beside another passes it although rounding makes them overlap."""
    pile = Pile((1, 1))
    pile.add((0.3, 1, 0.2), 1, (0, 0))
    assert pile.copy().add((0.3, 1, 0.2), 1, (0.1 + 0.2, 0)) == 0.0
    assert pile.copy().add((0.3, 1, 0.2), 1, (0.29, 0)) == 0.2


def random_pile(seed: int, boxes: int, mu: float = 0.0) -> tuple[Pile, np.random.Generator]:
    """Boxes at random places at which the pile stands; some heights are equal."""
    rng = np.random.default_rng(seed)
    pile = Pile((1.2, 0.8), mu)
    while len(pile) < boxes:
        size, mass = random_box(rng)
        fit = pile.fits(size, mass, 0.1)
        standing = np.argwhere(fit.mask)
        i, j = standing[rng.integers(len(standing))]
        pile.add(size, mass, (fit.x[i], fit.y[j]))
    return pile, rng


def random_box(rng: np.random.Generator) -> tuple[np.ndarray, float]:
    height = rng.choice([0.1, 0.15, rng.uniform(0.08, 0.25)])
    return np.append(rng.uniform(0.1, 0.45, 2), height), float(rng.uniform(1, 10))


def answers(fit: PileFit, i: int, j: int) -> bool | None:
    return None if fit.undecided[i, j] else bool(fit.mask[i, j])


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(12))
def test_equal_to_check_with_proofs_that_check_accepts(seed):
    """Forces and motions are proofs on the contacts that are detected in the assembly."""
    pile, rng = random_pile(seed, 8)
    size, mass = random_box(rng)
    fit = pile.fits(size, mass, 0.1)
    proved = 0
    for i, j in rng.permutation(np.argwhere(np.isfinite(fit.heights)))[:12]:
        grown = pile.copy()
        grown.add(size, mass, (fit.x[i], fit.y[j]))
        assembly = grown.assembly()
        found = contacts(assembly)
        program = build_program(assembly, found)
        verdict = check_equilibrium(assembly, found)
        expected = None if verdict.verdict == "undecided" else verdict.level is not None
        assert answers(fit, i, j) is expected
        assert grown.stands is expected
        row = int(np.flatnonzero(fit.rows == i * len(fit.y) + j)[0])
        if expected:
            assert check_forces(program, forces_of(grown, program)).holds
        elif expected is False and row in fit.decision.motions:
            motion, plane = fit.decision.motions[row]
            assert is_proof(program, motion, plane)
            proved += 1
    assert proved > 2


def forces_of(pile: Pile, program: Program) -> np.ndarray:
    """The forces of a pile at the rows of its program."""
    state = pile._state
    lower = np.repeat(state.statics.contacts.lower, 4)
    upper = np.repeat(state.statics.contacts.upper, 4)
    points = state.statics.contacts.corners.reshape(-1, 2)
    forces = np.zeros(len(program.part_a))
    pairs = np.sort(np.stack([program.part_a, program.part_b]), axis=0)
    for k in np.flatnonzero(state.forces > 0):
        rows = np.flatnonzero((pairs[0] == lower[k]) & (pairs[1] == upper[k]))
        distance = np.linalg.norm(program.point[rows, :2] - points[k], axis=1)
        assert distance.min() < 1e-9
        forces[rows[distance.argmin()]] += state.forces[k]
    return forces


def is_proof(program: Program, motion: np.ndarray | None, plane: np.ndarray) -> bool:
    """Whether fields of heights, with boxes that part sideways, exclude an equilibrium."""
    count = len(program.names)
    fields = np.zeros((count, 3))
    if motion is not None:
        fields[:-1] = motion
    fields[-1] = plane
    full = np.zeros((count, 6))
    full[:, 2] = fields[:, 0] + (fields[:, 1:] * program.center[:, :2]).sum(axis=1)
    full[:, 3], full[:, 4] = fields[:, 2], -fields[:, 1]
    spread = np.zeros((count, 6))
    spread[:, :2] = np.where(program.free[:, None], program.center[:, :2] + 10.0, 0.0)
    size = np.abs(full).max()
    return any(check_motion(program, full + s * size * spread).holds for s in (0, 1, 10, 100))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_equal_to_check_with_friction(seed):
    pile, rng = random_pile(seed, 5, mu=0.4)
    size, mass = random_box(rng)
    fit = pile.fits(size, mass, 0.1)
    for i, j in rng.permutation(np.argwhere(np.isfinite(fit.heights)))[:10]:
        grown = pile.copy()
        grown.add(size, mass, (fit.x[i], fit.y[j]))
        verdict = grown.verdict()
        assert verdict.level is not None or not fit.mask[i, j]
        if not fit.undecided[i, j]:
            assert fit.mask[i, j] == (verdict.level is not None)


@pytest.mark.slow
def test_a_neighbour_with_friction_holds_a_box_that_tips():
    """The centre is beside the block below; the tall neighbour holds the upper edge."""
    masks = []
    for mu in (0.0, 0.5):
        pile = Pile((1.0, 0.4), mu)
        pile.add((0.15, 0.4, 0.1), 9, (0.3, 0))
        pile.add((0.25, 0.4, 0.4), 9, (0.7, 0))
        fit = pile.fits((0.4, 0.4, 0.2), 1, 0.1)
        assert fit.heights[3, 0] == 0.1
        masks.append(fit.mask[3, 0])
        for i, j in np.argwhere(np.isfinite(fit.heights))[1::2]:
            grown = pile.copy()
            grown.add((0.4, 0.4, 0.2), 1, (fit.x[i], fit.y[j]))
            verdict = grown.verdict()
            assert answers(fit, i, j) == (
                None if verdict.verdict == "undecided" else verdict.level is not None
            )
            assert grown.stands == answers(fit, i, j)
    assert masks == [False, True]


def test_a_copy_is_independent_and_shares_what_is_known():
    pile, _ = random_pile(1, 4)
    before = pile.assembly()
    copy = pile.copy()
    assert copy._state is pile._state
    copy.add((0.2, 0.2, 0.2), 1, (0, 0))
    assert (len(pile), len(copy)) == (4, 5)
    assert [part.name for part in pile.assembly().parts] == [part.name for part in before.parts]
    assert pile.boxes.shape == (4, 6)
    assert pile.masses.shape == (4,)
    assert repr(pile) == "Pile(4 boxes, mu 0, m)"


def test_the_verdict_is_that_of_check():
    pile = plank_on_block(1, 2, 0.3)
    verdict, direct = pile.verdict(), kilter.check(pile.assembly(), require="equilibrium")
    assert (verdict.verdict, verdict.level) == (direct.verdict, direct.level)
    assert pile.assembly().units == "m"
    empty = Pile((1, 1))
    assert empty.stands is True
    assert empty.fits((2, 0.5, 0.5), 1, 0.1).mask.sum() == 0


def test_surround_names_the_points():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(200, 7, 2)) + rng.normal(size=(200, 1, 2))
    valid = rng.random((200, 7)) < 0.8
    found = surround(points, valid)
    import shapely

    for k in range(200):
        hull = shapely.convex_hull(shapely.multipoints(points[k][valid[k]]))
        assert found.inside[k] == hull.covers(shapely.Point(0, 0))
        if found.inside[k]:
            mean = found.weight[k] @ points[k][found.which[k]]
            assert np.abs(mean).max() < 1e-9
            assert valid[k][found.which[k][found.weight[k] > 0]].all()
        elif valid[k].any():
            assert (points[k][valid[k]] @ found.away[k] < 0).all()


WRONG = [
    (lambda: Pile((0, 1)), "base of the pile"),
    (lambda: Pile((1, float("nan"))), "base of the pile"),
    (lambda: Pile((1, 1, 1)), "base of the pile"),
    (lambda: Pile((1, 1), mu=-0.1), "mu"),
    (lambda: Pile((1, 1), units="feet"), "feet"),
    (lambda: Pile((1, 1), gravity=0), "gravity"),
    (lambda: Pile((1, 1)).fits((1, 1, -1), 1, 0.1), "size of the box"),
    (lambda: Pile((1, 1)).fits((1, 1, float("inf")), 1, 0.1), "size of the box"),
    (lambda: Pile((1, 1)).fits((0.1, 0.1, 0.1), 0, 0.1), "mass of the box"),
    (lambda: Pile((1, 1)).fits((0.1, 0.1, 0.1), 1, 0), "step"),
    (lambda: Pile((1, 1)).fits((0.1, 0.1, 0.1), 1, 1e-9), "step"),
    (lambda: Pile((1, 1)).fits((0.1, 0.1, 0.1), 1, 2), "step"),
    (lambda: Pile((1, 1)).add((0.1, 0.1, 0.1), 1, (0.95, 0)), "does not lie on the base"),
    (lambda: Pile((1, 1)).add((0.1, 0.1, 0.1), 1, (float("nan"), 0)), "place of the box"),
    (lambda: Pile((1, 1)).add((0.1, 0.1, 0.1), "heavy", (0, 0)), "mass of the box"),
]


@pytest.mark.parametrize(("wrong", "said"), WRONG)
def test_wrong_input_is_a_sentence(wrong, said):
    with pytest.raises(InputError, match=said) as error:
        wrong()
    assert "\n" not in str(error.value)


LENGTH, WEIGHT, BEYOND = 1.0, 2.0, 0.3
PLANK = overhang(LENGTH, WEIGHT, BEYOND)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("mass", "share"), [((2, 5), 0.0), ((4, 4), 0.1), ((2, 5), 0.1)])
def test_the_worst_mass_and_centre_limit_a_load_on_a_plank(mass, share):
    """The heaviest load with its centre farthest out: x + share size = W (L/2 - e) / w."""
    size = 0.2
    limit = WEIGHT * (LENGTH / 2 - BEYOND) / max(mass) - share * size
    part = box_to_place([size, size, 0.1], 1.0)
    places = place(PLANK, part, mass=mass, center_within=share, accuracy=1e-3)
    level = places.levels[-1]
    assert level.stands.bounds[2] == pytest.approx(limit, abs=1e-9)
    # falls: with some mass and centre within the limits
    assert level.falls.covers(shapely.Point(limit + 1e-3, 0))
    for side in (-1e-6, 1e-6):
        at = place(
            PLANK,
            part,
            at=[limit + side, 0],
            mass=mass,
            center_within=share,
        ).at
        assert at is not None
        assert (at.verdict == "unstable") == (side > 0)
        assert at.level == (None if side > 0 else "proved")


def test_the_heaviest_mass_has_every_centre():
    """With the centre up to .02 beyond x = .1, the heaviest load is W (L/2 - e) / .12."""
    at = place(
        PLANK,
        box_to_place([0.2, 0.2, 0.1], 1.0),
        at=[0.1, 0],
        center_within=0.1,
    ).at
    assert at is not None
    assert at.heaviest == pytest.approx(0.4 / 0.12, rel=1e-6)


def test_shifts_follow_the_axes_of_a_turned_box():
    part = box_to_place([4, 2, 1], 5.0, turn=90)
    shifts = [Assembly([case]).geometry.center[0] for case in part_cases(part, (5, 5), 0.1)]
    assert np.ptp(shifts, axis=0) == pytest.approx([0.4, 0.8, 0], abs=1e-12)


def test_with_friction_corners_prove_equilibrium_alone():
    part = box_to_place([0.2, 0.2, 0.1], 1.0)
    answer = place(
        PLANK.with_friction(0.5),
        part,
        at=[-0.2, 0],
        mass=(1, 2),
        require="equilibrium",
    )
    assert answer.stands
    assert answer.level == "equilibrium"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_check_agrees_at_masses_and_centres_inside_the_limits(seed):
    rng = np.random.default_rng(seed)
    stack, part, mass, share = bridge(), LOAD, (2.0, 3.5), 0.04
    places = mapped(mass, share)
    [level] = [
        level
        for level in places.levels
        if level.stands.area > 0 and level.height > places.prism.below
    ]
    low, high = np.array(level.stands.bounds).reshape(2, 2)
    points = rng.uniform(low, high, (2000, 2))
    inside = points[shapely.contains_xy(level.stands, points)][:8]
    assert len(inside) == 8
    for point in inside:
        shift = rng.uniform(-share, share, 2) * [0.7, 0.5]
        case = replace(part, given_mass=float(rng.uniform(*mass)), center_of_mass=[*shift, 0.0])
        at = place(stack, case, at=point + shift, require="equilibrium").at
        assert at is not None
        assert at.verdict != "unstable"


LOAD = box_to_place([0.7, 0.5, 0.2], 3.0, name="load")


@cache
def mapped(mass: tuple[float, float], share: float) -> Places:
    return place(bridge(), LOAD, mass=mass, center_within=share, accuracy=0.08)


@pytest.mark.parametrize("mass", [0, -1, (5, 2), (0, 1), (1, 2, 3), "heavy", (1, np.inf)])
def test_a_wrong_mass_is_refused(mass):
    with pytest.raises(InputError, match="mass"):
        place(PLANK, box_to_place([0.1, 0.1, 0.1], 1), mass=mass)  # type: ignore[arg-type]


@pytest.mark.parametrize("share", [-0.1, 0.5, np.nan])
def test_a_wrong_share_is_refused(share):
    with pytest.raises(InputError, match="cent"):
        place(PLANK, box_to_place([0.1, 0.1, 0.1], 1), center_within=share)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--mass", "8..5"], "--mass is '8..5'"),
        (["--mass", "5..6..7"], "--mass is '5..6..7'"),
        (["--mass", "5", "--centre-within", "60%"], "--centre-within is '60%'"),
        (["--mass", "5", "--centre-within", "some"], "--centre-within is 'some'"),
    ],
)
def test_wrong_limits_are_refused(words, said, tmp_path, capsys):
    file = tmp_path / "plank.kilter.json"
    kilter.dump(PLANK, file)
    assert main(["place", str(file), "--box", "1x1x1", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_the_answer_names_its_limits(tmp_path, capsys):
    file = tmp_path / "plank.kilter.json"
    kilter.dump(PLANK, file)
    box = ["--box", "0.2x0.2x0.1", "--mass", "5..8", "--centre-within", "10%"]
    assert main(["place", str(file), *box, "--at", "-0.3", "0"]) == 0
    said = capsys.readouterr().out
    assert "every mass of 5 to 8 kg and every centre within 10 % of the middle" in said
