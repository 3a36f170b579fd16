"""Options that change the question: every command reads them, and a next step repeats them."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.cli import main
from kilter.scenes.pieces import block, floor

G = 9.81
MU, MASS, PULL = 0.3, 500.0, 2000.0


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A box on a bed, and two straps that pull it forward: a weak one and a strong one."""
    monkeypatch.chdir(tmp_path)
    bed = floor([-5, -2], [5, 2], name="bed")
    parts = [bed, block("box", [-0.5, -0.5, 0], [0.5, 0.5, 1], mass=MASS)]
    kilter.dump(kilter.Assembly(parts, friction=MU), "lorry.json")
    path = [["bed", [4, 0, 0]], ["box", [0.5, 0, 1]]]
    straps = [{"path": path, "capacity": capacity} for capacity in (PULL / 10, 2 * PULL)]
    Path("both.json").write_text(json.dumps(straps))
    Path("weak.json").write_text(json.dumps(straps[:1]))


def answered(capsys: pytest.CaptureFixture[str], code: int, *words: str) -> str:
    capsys.readouterr()
    assert main([*words, "--quiet"]) == code
    return capsys.readouterr().out


def test_the_next_step_of_transport_keeps_the_acceleration(capsys):
    asked = ("lorry.json", "--straps", "weak.json", "--accelerate", ".5g", "0", "0")
    out = answered(capsys, 1, "transport", *asked)
    (line,) = (line for line in out.splitlines() if line.startswith("next: "))
    words = shlex.split(line.removeprefix("next: kilter "))
    assert words[:4] == ["hold", "lorry.json", "--straps", "weak.json"]
    assert [float(x) for x in words[words.index("--accelerate") + 1 :][:3]] == [0.5 * G, 0, 0]
    assert "falls even with" in answered(capsys, 1, *words)


def test_the_next_step_under_a_code_asks_about_the_direction_that_fails(capsys):
    out = answered(capsys, 1, "transport", "lorry.json", "--code", "en12195")
    assert "kilter hold lorry.json --accelerate -7.848 0 0" in out


def test_hold_names_the_straps_that_an_acceleration_needs(capsys):
    """One strap is needed where m (a - mu g) exceeds what friction and its pull resist."""
    still = json.loads(answered(capsys, 0, "hold", "lorry.json", "--straps", "both.json", "--json"))
    assert still["straps"] == []
    asked = ("lorry.json", "--straps", "both.json", "--accelerate", "0.5g", "0", "0")
    braking = json.loads(answered(capsys, 0, "hold", *asked, "--json"))
    (strap,) = braking["straps"]
    assert strap["candidate"] == 2
    assert "kilter plan" not in answered(capsys, 0, "hold", *asked)  # plan refuses straps
    along = np.array([3.5, 0, -1]) / np.linalg.norm([3.5, 0, -1])
    assert strap["pull"] * (along[0] - MU * along[2]) >= MASS * G * (0.5 - MU) * (1 - 1e-9)


@pytest.mark.quick("check")
@pytest.mark.parametrize("command", ["check", "margin", "hold"])
def test_an_acceleration_is_that_of_transport(capsys, command):
    """At 0.29 g friction of 0.3 holds, at 0.31 g it does not."""
    for share, falls in (("0.29g", False), ("0.31g", True)):
        asked = ("lorry.json", "--accelerate", share, "0", "0", "--json")
        carried = json.loads(answered(capsys, int(falls), "transport", *asked))["carried"]
        assert carried is not falls
        code = int(falls and command != "hold")
        data = json.loads(answered(capsys, code, command, *asked))
        if command == "hold":
            assert bool(data["supports"]) is falls


def test_masses_and_loads_are_read_and_proved(capsys):
    """A load of half the weight along the bed is more than friction holds; twice the mass holds."""
    load = f"box={0.5 * MASS * G},0,0"
    asked = ("lorry.json", "--load", load)
    answered(capsys, 1, "check", *asked)
    answered(capsys, 0, "check", *asked, "--mass", f"b?x={2 * MASS}", "--proof", "p.json")
    answered(capsys, 0, "verify", "lorry.json", "p.json")


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (("--mass", "box"), 'write --mass "bolt*=0.2"'),
        (("--load", "box=1,2"), "write --load lid=0,0,-20"),
        (("--accelerate", "x", "0", "0"), "0.5g"),
        (("--accelerate", "0", "0", "-1g"), "another acceleration"),
        (("--mass", "bax=1"), "box"),
    ],
)
def test_a_wrong_value_names_the_right_form(capsys, words, hint):
    assert main(["check", "lorry.json", *words, "--quiet"]) == 2
    assert hint in " ".join(capsys.readouterr().err.split())


def test_saved_choices_keep_no_question(capsys):
    assert main(["save", "lorry.json", "--mass", "box=3", "-o", "x.kilter.json", "--quiet"]) == 2
    assert not Path("x.kilter.json").exists()
