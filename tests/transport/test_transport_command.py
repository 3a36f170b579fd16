"""The command transport: exit codes, words, proofs, wrong input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck

import kilter
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.codes import CODES, code_cases
from kilter.cli import main
from kilter.scenes.arches import arch

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"


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
def test_answers_and_exit_codes(
    stack: str, words: list[str], code: int, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["transport", stack, *words, "--require", "equilibrium"]) == code
    assert sentence in capsys.readouterr().out


@pytest.mark.slow
def test_the_data_state_each_limit_its_first_parts_and_the_weakest_direction(
    stack: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two unit cubes, mu 0.6: the tower of height 2 and width 1 tips at g / 2."""
    assert main(["transport", stack, "--json"]) == 0
    limits = json.loads(capsys.readouterr().out)["limits"]
    assert [limit["name"] for limit in limits] == ["+x", "-x", "+y", "-y", "+z", "-z", "least"]
    assert [limit["least"] for limit in limits] == [False] * 6 + [True]
    for limit in (*limits[:4], limits[6]):
        assert limit["acceleration"] == pytest.approx(9.81 / 2, rel=1e-6)
        assert limit["acceleration"] <= limit["upper"] * (1 + 1e-12)
        assert limit["moves"]
        assert limit["how"] == "tips"
    assert limits[4]["acceleration"] is None  # upward, weight grows
    assert limits[5]["acceleration"] == pytest.approx(9.81, rel=1e-6)  # it falls freely
    for acceleration, carried in (("4.9", True), ("4.91", False)):
        main(["transport", stack, "--accelerate", acceleration, "0", "0", "--json"])
        case = json.loads(capsys.readouterr().out)["cases"][0]
        assert case["carried"] is carried
        assert case["acceleration"] == [float(acceleration), 0.0, 0.0]


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
def test_wrong_input_is_a_sentence(
    stack: str, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["transport", stack, *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error


@pytest.mark.quick(1)
@pytest.mark.parametrize("question", [[], ["--accelerate", "1", "2", "0"]])
def test_proofs_are_verified_and_damage_is_found(
    stack: str, question: list[str], tmp_path: Path
) -> None:
    proof = tmp_path / "p.json"
    main(["transport", stack, *question, "--proof", str(proof), "--quiet"])
    assert main(["verify", stack, str(proof)]) == 0
    data = json.loads(proof.read_text())
    data["proofs"][0]["change"]["gravity"][0] *= 3
    proof.write_text(json.dumps(data))
    assert main(["verify", stack, str(proof)]) == 1


@pytest.mark.slow
def test_python_and_the_command_give_the_same_answer(
    stack: str, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["transport", stack, "--json"])
    printed = json.loads(capsys.readouterr().out)
    answer = json.loads(json.dumps(kilter.transport(kilter.load(stack)).to_dict()))
    assert printed.keys() == answer.keys()
    for key in printed.keys() - {"seconds"}:
        assert printed[key] == answer[key], key


@pytest.mark.slow
def test_inner_rows_are_carried_and_outer_rows_enclose() -> None:
    answer = kilter.transport(stack_on_deck([[1, 0.5, 1], [0.4, 0.4, 0.5]], 0.45))
    inner, outer = answer.rows(), answer.rows(inner=False)
    rng = np.random.default_rng(0)
    counted = 0
    for acceleration in rng.uniform(-6, 6, (20, 3)) * [1, 1, 0.2]:
        in_inner = (inner[0] @ acceleration <= inner[1]).all()
        in_outer = (outer[0] @ acceleration <= outer[1]).all()
        felt = carried_assembly(answer.assembly, CarrierMotion(acceleration))
        carried = kilter.check(felt, require="equilibrium").level is not None
        assert not (in_inner and not carried)
        assert not (carried and not in_outer)
        counted += in_inner
    assert 1 < counted < 19


def test_every_code_brakes_and_turns() -> None:
    for name in CODES:
        sizes = [case.size for case in code_cases(name)]
        assert len(sizes) == 4
        assert min(sizes) > 0
    forward = code_cases("en12195")[0]
    braking = forward.acceleration(np.array([1.0, 0, 0]), np.array([0, 0, -1.0]), 10.0)
    assert braking.tolist() == [-8.0, 0.0, 0.0]  # the load is pressed forward


@pytest.mark.slow
def test_loads_and_bonds_are_fixed_in_the_carrier() -> None:
    """A downward load of its weight doubles the friction of a box, not its inertia."""
    box = stack_on_deck([[1, 1, 0.2]], 0.3)
    weight = box.geometry.mass[1] * 9.81
    pressed = kilter.Assembly(
        list(box.parts), friction=0.3, loads=[kilter.Load("box-0", force=[0, 0, -weight])]
    )
    answer = kilter.transport(pressed, polar=False)
    assert answer.limits[0].g == pytest.approx(0.6, rel=1e-7)


def test_a_planar_assembly_has_no_figure_and_two_horizontal_directions() -> None:
    answer = kilter.transport(arch(8))
    assert [limit.name for limit in answer.limits] == ["+x", "-x", "+z", "-z", "least"]
    assert answer.polar is None
    with pytest.raises(kilter.InputError, match="no horizontal accelerations"):
        kilter.draw(answer)


@pytest.mark.slow
def test_the_figure_shows_all_horizontal_accelerations(stack: str, tmp_path: Path) -> None:
    figure = tmp_path / "polar.svg"
    assert main(["transport", stack, "--figure", str(figure), "--quiet"]) == 0
    assert "acceleration along x [g]" in figure.read_text()


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.exists(), reason="the real assemblies are not beside the checkout")
def test_a_pallet_of_groceries() -> None:
    """The 24 standing items of a published packing plan, mu .5, without straps."""
    plan = json.loads((SHARED / "packing" / "bed_bpp_plans.json").read_text())["00100408"]
    parts = [kilter.Part("pallet", kilter.Box([1200, 800, 100]), kilter.Pose([600, 400, -50]),
                         grounded=True)]  # fmt: skip
    for k, entry in enumerate(plan[:24]):
        item = entry["item"]
        size = [item["length/mm"], item["width/mm"], item["height/mm"]]
        size = size if entry["orientation"] == 0 else [size[1], size[0], size[2]]
        corner = np.array(entry["flb_coordinates"])
        pose = kilter.Pose(corner + np.array(size) / 2)
        parts.append(kilter.Part(f"{k}", kilter.Box(size), pose, mass=item["weight/kg"]))
    answer = kilter.transport(kilter.Assembly(parts, units="mm", friction=0.5), polar=False)
    values = [limit.g for limit in answer.limits[:4]]
    assert values == pytest.approx([0.208044, 0.110242, 0.146499, 0.155983], abs=2e-6)
