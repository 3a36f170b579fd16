"""Fewest supports, grips and held parts."""

import json
from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest
from random_turned import random_turned
from read_proofs import Proof, proof_of, signed
from staggered_dome import staggered_dome

import kilter
from kilter import Assembly, Fixture, InputError, State, States, Support, contacts
from kilter.analysis.decision.judge import judge
from kilter.analysis.planning.hold import least_supports
from kilter.analysis.planning.hold.hold import candidates_of
from kilter.analysis.planning.hold.supported import Supported, grips_that_hold
from kilter.analysis.planning.states.holds import Holds
from kilter.analysis.planning.states.known_proofs import build_state_programs
from kilter.analysis.smallest_set import least_cover, least_hitting_set
from kilter.analysis.verification import verify_bundle, verify_proof
from kilter.cli import main
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor
from kilter.scenes.stacks import staircase
from kilter.work import Work


def rechecked(found: Fixture, change: Callable[[Proof], object] | None = None) -> str:
    """Why the proof, changed and signed anew, does not hold; empty where it does."""
    proof = proof_of(found)
    if change is not None:
        change(proof)
        signed(proof)
    answer = verify_bundle(found.assembly, kilter.contacts(found.assembly), proof)
    assert answer.holds == (not answer.reasons)
    return "; ".join(answer.reasons)


def part_of_an_arch(count: int, standing: int, *, sides: str) -> Assembly:
    """The first voussoirs from the left, or from both sides in turn."""
    made, order = arch(count, ratio=0.2, friction=0.6), list(range(count))
    if sides == "both":
        order.sort(key=lambda k: min(k, count - 1 - k))
    return made.without([f"voussoir-{k}" for k in order[standing:]]) if standing < count else made


def under(made: Assembly, kind: str) -> list[Support]:
    """A prop under each centre of mass, or a finger that pushes away from the arch's centre."""
    center = {part.name: made.geometry.center[k] for k, part in enumerate(made)}
    free = [part.name for part in made if not part.grounded]
    if kind == "prop":
        return [Support("prop", name, center[name]) for name in free]
    return [Support("finger", name, center[name], center[name] * [1, 0, 1]) for name in free]


LEFT_PROPS = [0, 0, 0, 0, *range(1, 16)]
BOTH_FINGERS = [0] * 8 + [1, 2, 2, 2, 2, 2, 3, 4, 5, 6, 7]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "sides", "standing", "least"),
    [
        ("prop", "left", 7, LEFT_PROPS[6]),
        ("finger", "both", 14, BOTH_FINGERS[13]),
        ("finger", "both", 16, BOTH_FINGERS[15]),
        *(
            pytest.param("prop", "left", k, LEFT_PROPS[k - 1], marks=pytest.mark.slow)
            for k in range(1, 20)
        ),
        *(
            pytest.param("finger", "both", k, BOTH_FINGERS[k - 1], marks=pytest.mark.slow)
            for k in range(1, 20)
        ),
    ],
)
def test_props_and_fingers_of_an_arch_of_twenty(kind, sides, standing, least):
    made = part_of_an_arch(20, standing, sides=sides)
    found = kilter.hold(made, candidates=under(made, kind))
    assert (found.verdict, found.least, found.fewest) == ("held", least, True)
    assert rechecked(found) == ""


@pytest.mark.slow
def test_fingers_cannot_hold_more_than_ten_voussoirs_from_one_side():
    ten, eleven = (part_of_an_arch(20, k, sides="left") for k in (10, 11))
    assert kilter.hold(ten, candidates=under(ten, "finger")).least == 4
    none = kilter.hold(eleven, candidates=under(eleven, "finger"))
    assert (none.verdict, none.supports) == ("impossible", None)
    assert rechecked(none) == ""
    assert "even with all 11 candidates as supports" in none.to_dict()["sentence"]


def hanging(mu: float = 0.5) -> tuple[Assembly, float]:
    """A cube of 10 N beside a held wall, and nothing under it."""
    made = Assembly(
        [
            kilter.Part("wall", kilter.Box([1, 3, 3]), kilter.Pose([-0.5, 0, 0]), grounded=True),
            kilter.Part("cube", kilter.Box([1, 1, 1]), kilter.Pose([0.5, 0, 0]), mass=1.0),
        ],
        friction=mu,
    ).with_down([0, 0, -1])
    return made, float(np.linalg.norm(made.gravity))


def magnets(count: int, capacity: float, mu: float = 0.0) -> list[Support]:
    """Magnets over the cube, at its centre: they push it down and pull it up."""
    top = [0.5, 0, 0.5]
    return [
        Support("magnet", "cube", top, [0, 0, -1], mu=mu, capacity=capacity, name=f"m{k}")
        for k in range(count)
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("share", "least"), [(1.01, 1), (0.99, 2), (0.251, 4), (0.249, 5)])
def test_magnets_carry_a_weight_together(share, least):
    """N magnets of F hold the weight W where n F >= W; six of them are there."""
    made, weight = hanging(0.0)
    found = kilter.hold(made, candidates=magnets(6, share * weight))
    assert (found.verdict, found.least, found.fewest) == ("held", least, True)
    pull = sum(support.force[2] for support in found.supports)
    assert pull == pytest.approx(weight, rel=1e-6)
    assert rechecked(found) == ""


@pytest.mark.parametrize(("mu", "verdict"), [(0.33, "held"), (0.32, "impossible")])
def test_a_vacuum_carries_across_by_its_friction(mu, verdict):
    """F = 2 W, gravity off by 20 degrees: mu (F - W cos 20) = W sin 20 at mu = .3226."""
    made, weight = hanging(0.0)
    angle = np.radians(20)
    leaning = made.with_down([0, np.sin(angle), -np.cos(angle)])
    center = [0.5, 0, 0]
    cup = Support("vacuum", "cube", center, [0, 0, -1], mu=mu, capacity=2 * weight)
    found = kilter.hold(leaning, candidates=[cup])
    assert found.verdict == verdict
    assert rechecked(found) == ""


@pytest.mark.parametrize(("friction", "verdict"), [(0.01, "held"), (0.0, "impossible")])
def test_a_finger_presses_against_a_wall(friction, verdict):
    """A finger without friction: what presses hard enough holds if the wall has any."""
    smooth = Support("finger", "cube", [1, 0, 0], [-1, 0, 0])
    found = kilter.hold(hanging(friction)[0], candidates=[smooth])
    assert found.verdict == verdict
    assert rechecked(found) == ""


@pytest.mark.slow
@pytest.mark.parametrize(("mu", "held"), [(0.35, False), (0.37, True)])
def test_a_finger_holds_within_its_cone(mu, held):
    """One finger under a sphere's centre, off the vertical by 20 degrees: tan 20 = .364."""
    ball = kilter.Part("ball", kilter.Sphere(1), kilter.Pose([0, 0, 5]), mass=1.0)
    made = Assembly([floor([-3, -3], [3, 3]), ball])
    angle = np.radians(20)
    lean = np.array([-np.sin(angle), 0, np.cos(angle)])
    point = np.array([0, 0, 5]) - np.array([0, 0, 1.0])
    found = kilter.hold(made, candidates=[Support("finger", "ball", point, lean, mu=mu)])
    assert found.verdict == ("held" if held else "impossible")
    assert rechecked(found) == ""


@pytest.mark.quick(1)
@pytest.mark.parametrize(("weight", "least"), [(1.9, 1), (2.1, 2)])
def test_a_prop_on_a_part_loads_that_part(weight, least):
    """A plank over an edge, tipped by a cube propped on its end: weight w at 1 against 2 at 1."""
    parts = [
        block("table", [-2, 0, -1], [0, 1, 0], grounded=True),
        block("plank", [-2, 0, 0], [2, 1, 0.1], mass=1e-3),
        block("stone", [-2, 0, 0.1], [0, 1, 1], mass=2.0),
        block("cube", [0.5, 0, 2], [1.5, 1, 3], mass=weight),
    ]
    made = Assembly(parts)
    props = [
        Support("prop", "cube", [1, 0.5, 2], on="plank", name="on the plank"),
        Support("prop", "plank", [1, 0.5, 0], name="under the plank"),
    ]
    found = kilter.hold(made, candidates=props)
    assert (found.verdict, found.least) == ("held", least)
    assert rechecked(found) == ""


def test_props_are_found_where_there_is_room():
    """Two cubes one above the other with room between, and one that lies on the lower."""
    made = Assembly(
        [
            floor([-3, -3], [3, 3]),
            block("low", [0, 0, 1], [1, 1, 2]),
            block("on it", [0, 0, 2], [1, 1, 3]),
            block("high", [0, 0, 4], [1, 1, 5]),
        ]
    )
    found = kilter.hold(made, candidates=["props"])
    assert [(one.part, one.on, one.point.tolist()) for one in found.offered] == [
        ("low", None, [0.5, 0.5, 1.0]),
        ("high", "on it", [0.5, 0.5, 4.0]),
    ]
    assert found.least == 2
    assert rechecked(found) == ""


def test_fingers_are_found_on_faces_that_are_free():
    made = Assembly([floor([-3, -3], [3, 3]), block("a", [0, 0, 0], [1, 1, 1]),
                     block("b", [1, 0, 0], [2, 1, 1])])  # fmt: skip
    found = kilter.hold(made, candidates="fingers")
    places = {(one.part, *one.direction.tolist()) for one in found.offered}
    assert ("a", 1.0, 0.0, 0.0) in places
    assert not {("a", -1.0, 0.0, 0.0), ("a", 0.0, 0.0, 1.0), ("b", 1.0, 0.0, 0.0)} & places
    assert len(places) == 8
    assert (found.least, found.supports) == (0, ())


def random_supports(random: np.random.Generator, made: Assembly) -> list[Support]:
    """Up to seven supports of every kind but grips, at random corners of parts."""
    geometry, found = made.geometry, []
    free = [k for k, part in enumerate(made) if not part.grounded]
    for number in range(int(random.integers(3, 8))):
        k = int(random.choice(free))
        corners = geometry.corners_of(k).reshape(-1, 3)
        point = corners[random.integers(len(corners))]
        inwards = geometry.center[k] - point + 0.3 * random.normal(size=3)
        inwards[1] *= not made.planar
        kind = str(random.choice(["finger", "prop", "magnet", "vacuum", "grip"]))
        name = f"{kind} {number}"
        weight = float(geometry.mass[k]) * 9.81
        if kind == "grip":
            found.append(Support(kind, made.names[k], name=name))
        elif kind == "prop":
            found.append(Support(kind, made.names[k], point, name=name))
        else:
            pull = weight * float(random.uniform(0.2, 2)) if kind != "finger" else 0.0
            found.append(
                Support(kind, made.names[k], point, inwards, mu=0.3, capacity=pull, name=name)
            )
    return found


def enumerated(found: Fixture) -> int | None:
    """The fewest supports by trying every set; None where one is undecided."""
    count = found.candidates
    given = Supported(found.assembly, found.contacts, found.offered)
    for size in range(count + 1):
        for chosen in combinations(range(count), size):
            stable = given.judge(chosen, Work()).stable
            if stable is None:
                return None
            if stable:
                return size
    return count + 1


def agree(seeds: range) -> list[tuple[str, int]]:
    answers = []
    made = [arch(7, ratio=0.3, friction=0.6), scene("paper-figure-9").with_friction(0.1),
            arch(6, ratio=0.2, friction=0.3)]  # fmt: skip
    for seed in seeds:
        random = np.random.default_rng(seed)
        whole = made[seed % len(made)]
        free = [part.name for part in whole if not part.grounded]
        gone = random.choice(free, size=int(random.integers(1, len(free) - 1)), replace=False)
        state = whole.without(gone.tolist())
        found = kilter.hold(state, candidates=random_supports(random, state))
        expected = enumerated(found)
        if expected is None or found.verdict == "undecided":
            continue
        answers.append((found.verdict, found.least))
        assert found.least == expected, seed
        assert rechecked(found) == "", seed
    return answers


@pytest.mark.slow
def test_fewest_supports_are_those_of_enumeration():
    assert len({verdict for verdict, _ in agree(range(8))}) == 2


def test_out_of_effort_a_bound_is_told():
    made = part_of_an_arch(20, 14, sides="left")
    found = kilter.hold(made, candidates=under(made, "prop"), effort=0.0001)
    assert (found.verdict, found.exhausted, found.fewest) == ("undecided", False, False)
    assert "effort limit was reached" in found.to_dict()["sentence"]
    with pytest.raises(InputError, match="nothing is proved"):
        found.proof()


@pytest.mark.parametrize("seed", range(20))
def test_least_covers_by_brute_force(seed):
    random = np.random.default_rng(seed)
    motions = [
        {int(k): float(random.choice([0.3, 0.5, 1.0])) for k in
         random.choice(7, size=int(random.integers(1, 6)), replace=False)}
        for _ in range(int(random.integers(1, 6)))
    ]  # fmt: skip

    def enough(chosen: tuple[int, ...]) -> bool:
        return all(sum(one.get(k, 0) for k in chosen) > 0.999 for one in motions)

    sets = [c for size in range(8) for c in combinations(range(7), size) if enough(c)]
    found = least_cover(motions, 7)
    assert (found is None) == (not sets)
    if found is not None:
        assert enough(tuple(found))
        assert len(found) == len(sets[0])
        assert least_cover(motions, len(sets[0]) - 1) is None


CUBE = {"kind": "finger", "part": "cube-1", "point": [0, 0, 1], "direction": [0, 0, -1]}


@pytest.mark.parametrize(
    ("data", "why"),
    [
        ({**CUBE, "kind": "hand"}, "the kind of support 'hand' is unknown"),
        ({**CUBE, "where": 1}, "a support has the unknown key 'where'"),
        ({**CUBE, "poit": [0, 0, 1]}, "did you mean 'point'"),
        ({"kind": "finger"}, "give its kind and its part"),
        ({**CUBE, "point": None}, "the point is missing"),
        ({**CUBE, "direction": None}, "the direction is missing"),
        ({**CUBE, "direction": [0, 0]}, "direction: expected 3 numbers"),
        ({**CUBE, "mu": -1}, "mu is -1"),
        ({**CUBE, "kind": "magnet"}, "a capacity is missing"),
        ({**CUBE, "capacity": 3}, "a capacity is not allowed"),
        ({**CUBE, "on": "base"}, "it stands on 'base'"),
        ({"kind": "grip", "part": "cube-1", "mu": 0.3}, "a grip holds the whole part"),
        ({**CUBE, "part": "nobody"}, "no part is named"),
        ({**CUBE, "part": "base"}, "held already"),
        ({**CUBE, "point": [0, 0, 900]}, "is not on the part"),
    ],
)
def test_supports_that_make_no_sense_are_one_sentence(data, why):
    with pytest.raises(InputError, match=why) as caught:
        kilter.hold(scene("tower"), candidates=[Support.from_dict(data)])
    assert "\n" not in str(caught.value)


def test_wrong_candidates():
    with pytest.raises(InputError, match="a candidate is 'hands'"):
        kilter.hold(scene("tower"), candidates=["hands"])
    with pytest.raises(InputError, match="no candidates for supports"):
        kilter.hold(scene("tower"), candidates=[])
    with pytest.raises(InputError, match="most is -1"):
        kilter.hold(scene("tower"), most=-1)


@pytest.mark.slow
def test_a_file_of_supports(tmp_path, capsys):
    path, supports = tmp_path / "a.kilter.json", tmp_path / "s.json"
    kilter.dump(hanging(0.0)[0], path)
    supports.write_text(json.dumps([one.to_dict() for one in magnets(3, 6.0)]))
    assert main(["hold", str(path), "--candidates", str(supports), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["verdict"], answer["least"], len(answer["supports"])) == ("held", 2, 2)
    assert main(["hold", str(path), "--candidates", str(supports)]) == 0
    assert "2 supports of 3 candidates" in capsys.readouterr().out
    supports.write_text(json.dumps([one.to_dict() for one in magnets(1, 6.0)]))
    proof = str(tmp_path / "p.json")
    assert main(["hold", str(path), "--candidates", str(supports), "--proof", proof]) == 1
    assert main(["verify", str(path), proof]) == 0
    supports.write_text("{}")
    assert main(["hold", str(path), "--candidates", str(supports)]) == 2


def test_the_supports_raise_the_assembly_to_the_required_level():
    block = scene("squeezed-block")
    forces = kilter.hold(block, require="equilibrium")
    assert (forces.supports, forces.level, forces.holds) == ((), "equilibrium", True)
    settled = kilter.hold(block)
    assert [support.part for support in settled.supports or ()] == ["block"]
    assert (settled.level, settled.holds, settled.fewest) == ("proved", True, False)
    held = block.with_grounded([support.part for support in settled.supports or ()])
    assert kilter.check(held, require="settles").stable
    assert not kilter.check(block, require="settles").stable


@pytest.mark.slow
def test_a_balanced_assembly_needs_a_grip_as_check_states():
    """Without supports, the decision sees no part for the outside, which would cover all places."""
    assembly = scene("paper-figure-11-in-space")
    assert kilter.check(assembly).verdict == "balanced"
    fixture = kilter.hold(assembly)
    assert len(fixture.supports or ()) == 1
    assert fixture.holds
    assert fixture.level == "proved"


def enumerated_holds(found: States, present: np.ndarray) -> int | None:
    """The fewest holds by trying every set, each judged in exact cones by itself."""
    programs = build_state_programs(found.assembly, found.contacts)
    free = np.flatnonzero(programs.free & present)
    for size in range(len(free) + 1):
        for chosen in combinations(free, size):
            held = np.zeros(len(present), dtype=bool)
            held[list(chosen)] = True
            told = judge(programs.of(present, held)).stable
            if told is None:
                return None
            if told:
                return size
    raise AssertionError("all held, and it falls")


def small_assemblies() -> list[Assembly]:
    return [
        arch(7, ratio=0.3, friction=0.6),
        arch(6, ratio=0.2, friction=0.3),
        arch(7, ratio=0.3, friction=0.25),
        scene("paper-figure-9").with_friction(0.1),
        scene("pit-wedges"),
        staircase(5, offset=0.4),
        random_turned("arch", 1),
        random_turned("wedge", 2),
    ]


def shown(found: States, holds: Holds[State]) -> None:
    """Fewer are not enough: each motion is judged anew, and no smaller set stops all."""
    for cut in holds.cuts:
        assert cut.state.stable is False
        assert not (cut.state.moves & ~cut.parts).any()
        sub = found.sub_assembly(cut.state)
        again = verify_proof(sub, kilter.contacts(sub), found.proof(cut.state))
        assert again.holds, again.reasons
        assert again.verdict == "unstable"
    sets = [set(np.flatnonzero(cut.parts)) for cut in holds.cuts]
    parts = sorted(set().union(*sets))
    if sets:
        for fewer in combinations(parts, min(holds.least - 1, len(parts))):
            assert any(not one & set(fewer) for one in sets)


def agree_holds(count: int, *, verify: bool) -> list[int]:
    """Fewest holds of random states, each against enumeration."""
    random, sizes = np.random.default_rng(0), []
    all_states = [kilter.states(assembly) for assembly in small_assemblies()]
    while len(sizes) < count:
        found = all_states[int(random.integers(len(all_states)))]
        grounded = found.assembly.geometry.grounded
        present = (random.random(len(grounded)) < 0.7) | grounded
        expected = enumerated_holds(found, present)
        if expected is None:
            continue
        names = [name for name, here in zip(found.assembly.names, present, strict=True) if here]
        holds = found.fewest_holds(names)
        assert holds.fewest
        assert holds.held is not None
        assert holds.state is not None
        assert holds.state.stable
        assert int(holds.held.sum()) == holds.least == expected
        if verify:
            shown(found, holds)
        if expected:
            less = found.fewest_holds(names, most=expected - 1)
            assert (less.held, less.least) == (None, expected)
        sizes.append(expected)
    return sizes


@pytest.mark.slow
def test_fewest_holds_are_those_of_enumeration():
    assert len(set(agree_holds(8, verify=True))) > 1


@pytest.mark.parametrize(("friction", "sides", "most"), [(0.6, "one", 1), (0.6, "both", 2)])
def test_an_arch_built_from_one_side_or_both(friction, sides, most):
    """Most holds over the orders of `plan`'s known answers: 1 from one side, 2 from both."""
    count = 9
    found = kilter.states(arch(count, ratio=0.3, friction=friction))
    order = list(range(count))
    if sides == "both":
        order.sort(key=lambda k: min(k, count - 1 - k))
    needed = [
        found.fewest_holds(["springer*", *(f"voussoir-{k}" for k in order[:stand])]).least
        for stand in range(1, count + 1)
    ]
    assert max(needed) == most
    assert needed[-1] == 0


def test_parts_that_may_not_be_held():
    found = kilter.states(arch(9, ratio=0.3, friction=0.6))
    gap = [name for name in found.assembly.names if name != "voussoir-4"]
    free = found.fewest_holds(gap)
    assert free.least == 2
    cut = next(cut for cut in free.cuts)
    barred = {found.assembly.names[k] for k in np.flatnonzero(cut.parts)}
    others = [name for name in gap if name not in barred]
    none = found.fewest_holds(gap, among=others)
    assert none.parts is None
    assert any(set(none_cut.state.moving) <= barred for none_cut in none.cuts)


@pytest.mark.quick(24)
@pytest.mark.parametrize("seed", range(30))
def test_least_hitting_sets_by_brute_force(seed):
    random = np.random.default_rng(seed)
    sets = [int(random.integers(1, 2**8)) for _ in range(int(random.integers(1, 9)))]
    best = min((k for k in range(2**8) if all(k & one for one in sets)), key=int.bit_count)
    found = least_hitting_set(sets, 8)
    assert found is not None
    assert all(found & one for one in sets)
    assert found.bit_count() == best.bit_count()
    assert least_hitting_set(sets, best.bit_count() - 1) is None


@pytest.mark.slow
def test_the_fewest_grips_of_an_arch_are_the_same_with_known_grips(monkeypatch):
    half = arch(9, ratio=0.3, friction=0.6).without("voussoir-4")
    usual = kilter.hold(half)
    monkeypatch.setattr(least_supports, "LARGE", 0)
    large = kilter.hold(half)
    assert usual.fewest
    assert large.fewest
    assert len(large.supports) == len(usual.supports) == 2
    assert (large.level, large.least) == (usual.level, usual.least)


@pytest.mark.slow
def test_no_known_grip_can_be_left_out_and_open_pairs_do_not_hide_them():
    dome = staggered_dome(2, rings=3, per_ring=8)
    touching = contacts(dome)
    given = Supported(dome, touching, candidates_of(dome, touching, ["grips"]))
    assert given.judge((), Work()).stable is None
    grips = grips_that_hold(given, Work(), 0.0)
    assert grips
    assert given.judge(grips, Work()).stable
    for grip in grips:
        assert given.judge(grips - {grip}, Work()).stable is not True


def test_without_work_the_grips_still_hold():
    dome = staggered_dome(2, rings=3, per_ring=8)
    touching = contacts(dome)
    given = Supported(dome, touching, candidates_of(dome, touching, ["grips"]))
    few, many = grips_that_hold(given, Work(), 0.0), grips_that_hold(given, Work(0.0), 0.0)
    assert few
    assert many
    assert few <= many
    assert given.judge(many, Work()).stable


def test_without_grips_among_the_candidates_none_are_known():
    half = arch(9, ratio=0.3, friction=0.6).without("voussoir-4")
    touching = contacts(half)
    given = Supported(half, touching, candidates_of(half, touching, ["props"]))
    assert grips_that_hold(given, Work(), 0.0) is None


@pytest.mark.slow
def test_hold_of_a_dome_of_open_pairs_answers_with_grips():
    fixture = kilter.hold(staggered_dome(1, rings=6, per_ring=14))
    assert fixture.supports
    held = staggered_dome(1, rings=6, per_ring=14).with_grips([s.part for s in fixture.supports])
    assert kilter.check(held, require="equilibrium").stable
