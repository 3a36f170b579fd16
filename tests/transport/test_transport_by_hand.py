"""Transport by hand, by the command, and limits of collapse."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck

import kilter
from kilter import Assembly, Box, CarrierMotion, CarrierPath, Part
from kilter.analysis.transport.carrier import carried_assembly
from kilter.analysis.transport.transport import CODES, code_cases
from kilter.cli import main
from kilter.scenes.arches import arch, oppenheim_arch
from kilter.scenes.pieces import block

G = 9.81
TIPS = np.array([50, 100]) / 150
"""Accelerations along x and y at which the box of 100 x 200 x 300 tips [g]."""
BASE = block("base", [-500, -500, -10], [500, 500, 0], grounded=True)
BOX = Part("box", Box([100, 200, 300]), [0, 0, 150], density=2000.0)
HIGH = Assembly([BASE, BOX], units="mm", friction=0.8)
LOW = Assembly([BASE, Part("low", Box([200, 200, 20]), [0, 0, 10])], units="mm", friction=0.4)


@pytest.mark.slow
def test_a_box_tips_along_each_axis():
    answer = kilter.transport(HIGH).to_dict()
    assert answer["gravity"] == G
    expected = {"x": TIPS[0], "y": TIPS[1], "z": 1.0}
    # the sense of the tilt, and its turn per length moved: the fastest part moves by 1 mm
    radius = math.hypot(50, 100, 150)
    for limit in answer["limits"][:6]:
        sign, axis = limit["name"]
        sign = 1.0 if sign == "+" else -1.0
        assert limit["direction"] == [sign * (axis == one) for one in "xyz"]
        if limit["name"] == "+z":
            assert (limit["acceleration"], limit["upper"], limit["g"]) == (None, None, None)
            continue
        share = expected[axis]
        assert limit["g"] == pytest.approx(share, rel=2e-7)
        assert limit["acceleration"] == pytest.approx(share * G, rel=2e-7)
        assert limit["upper"] == pytest.approx(share * G, rel=2e-7)
        assert 0 <= limit["limit"]["gap"] <= 2e-7
        assert limit["limit"]["residual"] <= 1e-9
        if axis == "x":
            turn = 1 / math.hypot(50, 150, radius)
            moved = turn * np.array([-150 * sign, 0, 50, 0, -sign, 0])
            assert limit["limit"]["mechanism"]["box"] == pytest.approx(moved, abs=1e-6)
    least = answer["limits"][6]
    assert np.abs(least["direction"]) == pytest.approx([1, 0, 0], abs=1e-6)
    assert least["g"] == pytest.approx(TIPS[0], rel=1e-6)
    polar = answer["polar"]
    assert np.abs(polar["axes"]) == pytest.approx(np.eye(3)[:2])
    points, normals = np.array(polar["points"]), np.array(polar["normals"])
    # it tips over any side of its base, or slides
    inside = np.maximum(np.abs(points / TIPS).max(axis=1), np.linalg.norm(points, axis=1) / 0.8)
    assert inside == pytest.approx(np.ones(len(points)), rel=1e-6)
    corners = np.array([[x, y] for x in (-1, 1) for y in (-1, 1)]) * TIPS
    assert polar["reach"] == pytest.approx((normals @ corners.T).max(axis=1), rel=1e-5)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)))
    # between its points the boundary is at most `gap` outside of the straight line
    assert 0 <= polar["gap"] < 0.05


@pytest.mark.slow
def test_the_gap_of_the_boundary_is_that_of_a_circle():
    """A slab slides at mu in every direction: points and tangents of a circle."""
    polar = kilter.transport(LOW).to_dict()["polar"]
    count = len(polar["points"])
    assert np.linalg.norm(polar["points"], axis=1) == pytest.approx([0.4] * count, rel=1e-6)
    assert polar["reach"] == pytest.approx([0.4] * count, rel=1e-6)
    # a corner of the tangents, from the chord between the points beside it
    angle = math.pi / count
    assert polar["gap"] == pytest.approx(0.4 * (1 / math.cos(angle) - math.cos(angle)), rel=1e-4)


@pytest.mark.slow
def test_a_carrier_that_turns_or_brakes():
    """The box stands 1 m from an axis about which the carrier turns at 1 rad/s: 1 m/s^2."""
    turn = CarrierMotion([0, 0, 0], [0, 0, 1.0], [0, 0, 0], [-1000, 0, 0])
    (case,) = kilter.transport(HIGH, turn=turn).to_dict()["cases"]
    assert case["factor"] == pytest.approx(TIPS[0] * G, rel=1e-6)
    assert (case["angular_velocity"], case["about"]) == ([0, 0, 1], [-1000, 0, 0])
    # it tips outwards over its edge at x = 50; the fastest part moves by 1 mm
    unit = 1 / math.hypot(50, 150, math.hypot(50, 100, 150))
    expected = unit * np.array([150, 0, 50, 0, 1, 0])
    assert case["limit"]["mechanism"]["box"] == pytest.approx(expected, abs=1e-6)
    answer = kilter.transport(HIGH, code="en12195", mu_range=(0.9, 1.1)).to_dict()
    assert answer["mu_range"] == [0.9, 1.1]
    for case, axis, size in zip(answer["cases"], "xxyy", (0.8, 0.5, 0.5, 0.5), strict=True):
        assert case["g"] == pytest.approx(size)
        assert np.linalg.norm(case["acceleration"]) == pytest.approx(size * G)
        assert case["factor"] == pytest.approx(TIPS["xy".index(axis)] / size, rel=1e-6)
        assert case["carried"] is (case["factor"] > 1)
        assert case["limit"]["residual"] <= 1e-9
        assert case["limit"]["gap"] <= 2e-7


def test_a_path_of_two_accelerations():
    """A slab slides beyond mu g; the squared speed factor multiplies the acceleration."""
    time, along = np.array([0.0, 0.5, 2.0]), np.array([1.0, 2.0, 4.0])
    none = np.zeros((3, 3))
    path = CarrierPath(
        time, np.repeat(np.eye(3)[None], 3, axis=0), along[:, None] * [1.0, 0, 0], none, none,
        np.zeros(3), True,
    )  # fmt: skip
    speed = kilter.transport(LOW, path=path).to_dict()["speed"]
    expected = np.sqrt(0.4 * G / along)
    assert speed["factors"] == pytest.approx(expected, rel=1e-6)
    assert (speed["factor"], speed["lower"]) == pytest.approx((expected[2], expected[2]), rel=1e-6)
    assert speed["lower"] <= speed["factor"]
    assert (speed["samples"], speed["duration"], speed["time"]) == (3, 2.0, 2.0)
    assert (speed["times"], speed["slowest"]) == ([0.0, 0.5, 2.0], 0.0)


@pytest.fixture
def stack(tmp_path: Path) -> str:
    path = tmp_path / "stack.kilter.json"
    kilter.dump(stack_on_deck([[1, 1, 1], [1, 1, 1]], 0.6), path)
    return str(path)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        ([], 0, "up to 0.5 g"),
        (["--accelerate", "0.45g", "0", "0"], 0, "Carried"),
        (["--accelerate", "5", "0", "0"], 1, "Not carried"),
        (["--code", "gdv"], 1, "forward"),
        (["--code", "eumos:0.3"], 0, "rigid statics under the accelerations of eumos:0.3"),
        (["--turn", "0", "0", "1", "--about", "1", "0", "0"], 0, "Carried"),
        (["--turn-faster", "0", "6", "0", "--about", "0", "0", "-5"], 1, "tips"),
        (["--accelerate", "0.45g", "0", "0", "--mu-range", "0.5", "1"], 1, "limits at 0.5"),
    ],
)
def test_answers_and_exit_codes(stack, words, code, sentence, capsys):
    assert main(["transport", stack, *words, "--require", "equilibrium"]) == code
    assert sentence in capsys.readouterr().out


@pytest.mark.quick(3)
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--accelerate", "fast", "0", "0"], "numbers in m/s^2, or in g as 0.5g"),
        (["--accelerate", "0", "0", "-1g"], "falls freely"),
        (["--code", "en12194"], "did you mean en12195"),
        (["--code", "eumos:0"], "not a positive number"),
        (["--code", "gdv", "--forward", "0", "0", "1"], "vertical"),
        (["--code", "gdv", "--accelerate", "1", "0", "0"], "ask one question"),
        (["--path", "missing.csv"], "no such file"),
        (["--figure", "polar.txt"], "polar.txt"),
        (["--mu-range", "1", "0.5"], "the interval is empty"),
    ],
)
def test_wrong_input_is_a_sentence(stack, words, message, capsys):
    assert main(["transport", stack, *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error


@pytest.mark.quick(1)
@pytest.mark.parametrize("question", [[], ["--accelerate", "1", "2", "0"]])
def test_proofs_are_verified_and_damage_is_found(stack, question, tmp_path):
    proof = tmp_path / "p.json"
    main(["transport", stack, *question, "--proof", str(proof), "--quiet"])
    assert main(["verify", stack, str(proof)]) == 0
    data = json.loads(proof.read_text())
    data["proofs"][0]["change"]["gravity"][0] *= 3
    proof.write_text(json.dumps(data))
    assert main(["verify", stack, str(proof)]) == 1


def test_every_code_brakes_and_turns():
    for name in CODES:
        sizes = [case.size for case in code_cases(name)]
        assert len(sizes) == 4
        assert min(sizes) > 0
    forward = code_cases("en12195")[0]
    braking = forward.acceleration(np.array([1.0, 0, 0]), np.array([0, 0, -1.0]), 10.0)
    assert braking.tolist() == [-8.0, 0.0, 0.0]  # the load is pressed forward


@pytest.mark.slow
def test_loads_and_bonds_are_fixed_in_the_carrier():
    """A downward load of its weight doubles the friction of a box, not its inertia."""
    box = stack_on_deck([[1, 1, 0.2]], 0.3)
    weight = box.geometry.mass[1] * 9.81
    pressed = kilter.Assembly(
        list(box.parts), friction=0.3, loads=[kilter.Load("box-0", force=[0, 0, -weight])]
    )
    answer = kilter.transport(pressed, polar=False)
    assert answer.limits[0].g == pytest.approx(0.6, rel=1e-7)


def test_a_planar_assembly_has_no_figure_and_two_horizontal_directions():
    answer = kilter.transport(arch(8))
    assert [limit.name for limit in answer.limits] == ["+x", "-x", "+z", "-z", "least"]
    assert answer.polar is None
    with pytest.raises(kilter.InputError, match="no horizontal accelerations"):
        kilter.draw(answer)


CUBES = stack_on_deck([[1, 1, 1]] * 3, 0.9)


def portal_of_equal_masses() -> kilter.Assembly:
    """Two posts .038 x .103 and a lintel of the same mass."""
    wide, high = 0.038, 0.103
    return kilter.Assembly(
        [
            block("deck", [-1, -1, -1], [2, 1, 0], grounded=True),
            block("left", [0, 0, 0], [wide, wide, high], mass=1.0),
            block("right", [0.2, 0, 0], [0.2 + wide, wide, high], mass=1.0),
            block("lintel", [0, 0, high], [0.2 + wide, wide, high + wide], mass=1.0),
        ],
        friction=0.9,
    )


def brick_wall(friction: float) -> kilter.Assembly:
    """Three courses of three bricks in running bond."""
    long, wide, high = 0.25, 0.12, 0.065
    parts = [block("deck", [-2, -2, -1], [2, 2, 0], grounded=True)]
    for course in range(3):
        for k in range(3):
            low = np.array([(k + 0.5 * (course % 2)) * long, 0, course * high])
            parts.append(block(f"brick-{course}-{k}", low, low + np.array([long, wide, high])))
    return kilter.Assembly(parts, friction=friction)


def entry_of(assembly: kilter.Assembly, name: str) -> dict[str, object]:
    answer = kilter.transport(assembly, polar=False, collapse=True)
    return next(dict(entry) for entry in answer.to_dict()["alpha"] if entry["name"] == name)


@pytest.mark.parametrize(
    ("assembly", "name", "alpha0", "e", "a0"),
    [
        (stack_on_deck([[0.2, 1, 1]], 0.9), "+x", 0.2, 1.0, 1.453333),
        (portal_of_equal_masses(), "+x", 0.368932, 8 / 9, 3.016019),
        (CUBES, "+x", 1 / 3, 27 / 35, 3.139918),
        (brick_wall(0.7), "+y", 0.615385, 27 / 35, 5.796771),
        (arch(20), "+x", 0.149350, 0.660600, 1.642867),
        (oppenheim_arch(), "+x", 0.373612, 0.771787, 3.517697),
    ],
    ids=["block", "portal", "3 cubes", "wall", "arch", "Oppenheim"],
)
@pytest.mark.slow
def test_known_mechanisms(assembly, name, alpha0, e, a0):
    entry = entry_of(assembly, name)
    assert [entry[key] for key in ("alpha0", "e", "a0")] == pytest.approx([alpha0, e, a0], abs=2e-6)
    assert entry["unique"]
    mass = float(assembly.geometry.mass[~assembly.geometry.grounded].sum())
    assert entry["participating_mass"] == pytest.approx(e * mass, rel=2e-6)
    ground = -G * alpha0 * np.array(entry["direction"])
    for share, held in ((0.999, True), (1.001, False)):
        felt = carried_assembly(assembly, CarrierMotion(share * ground))
        assert (kilter.check(felt, require="equilibrium").level is not None) == held


def test_a_stack_of_three_cubes():
    entry = entry_of(CUBES, "least")
    assert entry["alpha0"] == pytest.approx(1 / 3, abs=1e-6)
    assert entry["e"] == entry["e_moving"] == pytest.approx(27 / 35, abs=1e-6)
    assert entry["alpha0"] <= entry["upper"] <= entry["alpha0"] + 1e-5  # type: ignore[operator]


def test_parts_that_stand_still_raise_the_first_spectral_acceleration_only():
    """A wide plinth under a narrow block does not move."""
    plinth = stack_on_deck([[4, 4, 1], [0.2, 1, 1]], 0.9)
    entry = entry_of(plinth, "+x")
    assert entry["moves"] == ["box-1"]
    assert entry["e_moving"] == pytest.approx(1.0, abs=1e-6)
    assert entry["a0_moving"] == pytest.approx(0.2 * G / 1.35, abs=1e-5)
    assert entry["e"] == pytest.approx(0.2 / 16.2, rel=1e-5)


@pytest.mark.slow
def test_the_largest_mass_of_several_mechanisms():
    """A wall that slides course by course at mu: all of it moves in the chosen mechanism."""
    entry = entry_of(brick_wall(0.5), "+y")
    assert entry["unique"] is False
    assert entry["e"] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.quick(1)
def test_the_confidence_factor_divides_the_spectral_acceleration(tmp_path, capsys):
    file = tmp_path / "block.kilter.json"
    kilter.dump(stack_on_deck([[0.2, 1, 1]], 0.9), file)
    assert main(["transport", str(file), "--collapse", "--fc", "1"]) == 0
    assert "a0* 1.962 m/s^2 at FC 1" in capsys.readouterr().out
    assert main(["transport", str(file), "--collapse", "--fc", "0.9"]) == 2
    assert "at least 1" in capsys.readouterr().err
    assert main(["transport", str(file), "--collapse", "--code", "gdv"]) == 2
    assert "without another question" in capsys.readouterr().err
