"""The command transport: exit codes, words, proofs, wrong input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck

import kilter
from kilter.analysis.transport.codes import CODES, code_cases
from kilter.cli import main
from kilter.scenes.arches import arch


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
