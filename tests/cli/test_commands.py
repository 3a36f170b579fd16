"""The commands: answers, exit codes, files written whole, and JSON alone on standard output."""

from __future__ import annotations

import io
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import kilter
from kilter.cli import main
from kilter.cli.commands import COMMANDS, functions_of
from kilter.cli.declarations import declared_of
from kilter.scenes import scene
from kilter.threads import VARIABLES

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"
EXIT = {
    "stable": 0,
    "settles": 0,
    "unstable": 1,
    "potentially-stable": 3,
    "balanced": 3,
    "undecided": 4,
}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(name: str) -> str:
    path = f"{name}.kilter.json"
    kilter.dump(scene(name), path)
    return path


def answered(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, dict]:
    capsys.readouterr()
    code = main([*words, "--json"])
    return code, json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_text_of_an_unstable_assembly_names_the_parts_that_move(capsys):
    assert main(["check", written("hanging-brick")]) == 1
    out = capsys.readouterr().out
    assert out.startswith("Unstable")
    assert "brick-2-2  falls 0.06 m onto brick-0-3" in out


@pytest.mark.slow
def test_contacts_shows_patches_histogram_and_what_came_near(capsys):
    file = written("tower")
    assert main(["contacts", file]) == 0
    assert "touch in 5 pairs, 5 patches, 20 points" in capsys.readouterr().out
    code, answer = answered(capsys, "contacts", file)
    assert code == 0
    assert len(answer["patches"]) == 5
    assert sum(answer["histogram"]["counts"]) == 5
    assert len(answer["histogram"]["edges"]) == len(answer["histogram"]["counts"]) + 1


@pytest.mark.slow
def test_contacts_needs_nothing_held(capsys):
    data = kilter.files.to_dict(scene("tower"))
    for part in data["parts"]:
        part.pop("grounded", None)
    Path("free.json").write_text(json.dumps(data))
    assert main(["contacts", "free.json"]) == 0
    assert main(["check", "free.json"]) == 2
    error = capsys.readouterr().err
    assert "nothing is held" in error
    assert "--ground" in error


def test_standard_input_is_read(monkeypatch, capsys):
    text = json.dumps(kilter.files.to_dict(scene("tower"))).encode()
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text)))
    code, answer = answered(capsys, "check", "-")
    assert (code, answer["verdict"]) == (0, "stable")


def test_saved_choices_on_standard_input_are_refused_in_one_sentence(monkeypatch, capsys):
    text = json.dumps({"kilter": 1, "file": "tower.step", "held": ["base"]}).encode()
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text)))
    assert main(["check", "-"]) == 2
    error = capsys.readouterr().err
    assert "saved choices" in error
    assert "give the path" in error
    assert "unknown key" not in error


@pytest.mark.slow
def test_floor_ground_without_and_down_change_what_is_judged(capsys):
    data = kilter.files.to_dict(scene("tower"))
    data["parts"] = [dict(part, grounded=False) for part in data["parts"]]
    Path("free.json").write_text(json.dumps(data))
    assert main(["check", "free.json", "--floor", "--quiet"]) == 0
    assert main(["check", "free.json", "--floor", "-9", "--quiet"]) == 1
    assert main(["check", "free.json", "--ground", data["parts"][0]["name"], "--quiet"]) == 0
    assert main(["check", "free.json", "--ground", "*", "--quiet"]) == 0
    assert "every part is held" not in capsys.readouterr().err
    names = [part["name"] for part in data["parts"]]
    words = ["--ground", names[0], "--without", names[1], "--quiet"]
    assert main(["check", "free.json", *words]) == 1  # the rest hangs in the air
    assert main(["check", "free.json", "--ground", names[0], "--down", "0.1", "0", "-1"]) == 1


@pytest.mark.slow
def test_the_options_a_file_was_read_with_are_part_of_the_proof(capsys):
    file = written("tower")
    words = ["--down", "0.1", "0", "-1", "--floor", "-3", "--proof", "p.json"]
    assert main(["check", file, *words]) == 1
    assert main(["verify", file, "p.json"]) == 0
    out = capsys.readouterr().out
    assert "The proof holds: unstable" in out
    assert "floor -3" in out


@pytest.mark.slow
def test_a_proof_of_another_assembly_does_not_hold(capsys):
    file, other = written("tower"), written("staircase")
    assert main(["check", file, "--proof", "p.json"]) == 0
    assert main(["verify", other, "p.json"]) == 1
    assert "does not hold" in capsys.readouterr().out


@pytest.mark.slow
def test_units_and_density_of_files_without_them(capsys):
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((1, 1, 1)).export("a.stl")
    code, answer = answered(
        capsys, "check", "a.stl", "--floor", "--units", "mm", "--density", "2000"
    )
    assert code == 0
    assert answer["units"] == "mm"
    assert answer["parts"][0]["mass"] == pytest.approx(2e-6)


def test_output_goes_to_a_file_as_a_whole():
    assert main(["check", written("tower"), "--json", "-o", "a.json"]) == 0
    assert json.loads(Path("a.json").read_text())["verdict"] == "stable"


def test_an_example_never_replaces_a_file_unasked(capsys):
    Path("tower.kilter.json").write_text("mine")
    assert main(["example", "tower"]) == 2
    assert Path("tower.kilter.json").read_text() == "mine"
    assert "--force" in capsys.readouterr().err
    assert main(["example", "tower", "--force"]) == 0


@pytest.mark.slow
def test_help_and_version_answer_with_zero(capsys):
    for words in ([], ["--help"], ["check", "--help"], ["verify", "-h"]):
        assert main(words) == 0
    assert main(["--version"]) == main(["-V"]) == 0
    assert kilter.__version__ in capsys.readouterr().out


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", COMMANDS)
def test_a_help_has_every_option_and_its_sentence(name, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    assert main([name, "--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    shown = " ".join(" ".join(lines).split())
    [function] = functions_of(name)
    assert " ".join((function.__doc__ or "").split()) in shown
    for each in declared_of(function):
        # a long sentence may be broken at a hyphen
        assert each.declaration.help.replace(" ", "") in shown.replace(" ", ""), each.name
        assert all(option in shown for option in each.declaration.names)


@pytest.mark.slow
def test_a_text_is_brief_unless_more_is_asked_for(capsys):
    file = written("paper-figure-8")
    assert main(["check", file]) == 1
    brief = capsys.readouterr().out
    assert main(["check", file, "--verbose"]) == 1
    full = capsys.readouterr().out
    for word in ("kappa", "neutral", "proof", "seconds", "mass  "):
        assert word not in brief
        assert word in full
    assert brief.rstrip().endswith("finds the fewest supports that hold it")


@pytest.mark.slow
def test_the_next_step_that_is_named_runs(capsys):
    for name in ("paper-figure-8", "tower"):
        file = written(name)
        for words in (["check"], ["orient"], ["region"], ["contacts"], ["margin"], ["plan"]):
            capsys.readouterr()
            main([*words, file, "--down", "0", "0.6", "-1"])
            step = re.search(r"^next: kilter (.*)$", capsys.readouterr().out, flags=re.M)
            if step is None:  # there is no order, and nothing to show of it
                assert words == ["plan"]
                continue
            assert main(shlex.split(step[1])) in (0, 1, 3, 4), step[1]


@pytest.mark.slow
def test_what_only_balances_is_looked_at_next(capsys):
    """A margin of first order says nothing of it; a model of bricks that falls is mended."""
    balanced = written("paper-figure-1-in-space")
    assert main(["check", balanced]) == 3
    assert main(["check", balanced, "--require", "equilibrium"]) == 0
    assert f"next: kilter view {balanced}\n" in capsys.readouterr().out
    Path("air.txt").write_text("2x4 (0,0,0)\n2x4 (0,0,2)\n")
    assert main(["check", "air.txt"]) == 1
    assert "next: kilter margin air.txt --improve\n" in capsys.readouterr().out


@pytest.mark.slow
def test_what_strict_asked_for_in_vain_is_said(capsys):
    file = written("mortared-corbel")
    for words, said in (([], False), (["--require", "strict"], True)):
        assert main(["check", file, *words]) == (3 if said else 0)
        out = capsys.readouterr().out
        assert ("second order does not model bonds and straps" in out) is said


@pytest.mark.slow
def test_several_files_have_a_line_each_and_the_worst_code(capsys):
    good, bad = written("tower"), written("paper-figure-8")
    for files, code in (([good, good], 0), ([good, bad], 1), ([bad, "none.json", good], 2)):
        assert main(["check", *files]) == code
        said = capsys.readouterr()
        lines = said.out.splitlines()
        assert [line.split()[0] for line in lines] == files
        assert ("none.json" in said.err) == (code == 2)
    moves = "C2 drops at 0.75 g and C3 slides +x at 0.433 g"
    assert lines[0].split(maxsplit=2) == [bad, "unstable", moves]
    code, answers = answered(capsys, "check", good, "none.json")
    assert code == 2
    assert [one["file"] for one in answers] == [good, "none.json"]
    assert answers[0]["verdict"] == "stable"
    assert "no such file" in answers[1]["error"]
    assert main(["check", good, bad, "--proof", "p.json"]) == 2
    assert main(["check", good, bad, "-o", bad]) == 2
    assert kilter.load(bad) is not None


def test_a_fault_of_one_file_is_the_worst(monkeypatch, capsys):
    from kilter.files.reading import Reading

    good, read = written("tower"), Reading.read

    def broken(self: Reading, file: str, **more: object) -> object:
        if file == "bad.json":
            raise ZeroDivisionError("a fault")
        return read(self, file, **more)

    monkeypatch.setattr(Reading, "read", broken)
    assert main(["check", "bad.json", good, "none.json"]) == 70
    said = capsys.readouterr()
    assert [line.split()[1] for line in said.out.splitlines()] == ["error", "stable", "error"]
    assert "a fault of kilter itself: ZeroDivisionError" in said.err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("set_", "coloured"),
    [({}, False), ({"FORCE_COLOR": "1"}, True), ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, False)],
)
def test_the_verdict_has_its_colour_where_colours_are_shown(set_, coloured, monkeypatch, capsys):
    file = written("tower")
    for name in ("FORCE_COLOR", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    for name, value in set_.items():
        monkeypatch.setenv(name, value)
    main(["check", file])
    out = capsys.readouterr().out
    assert out.startswith("\x1b[1;34mStable") == coloured
    assert ("\x1b" in out) == coloured
    main(["check", file, "--json"])
    assert "\x1b" not in capsys.readouterr().out


@pytest.mark.slow
def test_a_wall_of_any_size(capsys):
    assert main(["example", "wall", "--size", "4x3"]) == 0
    wall = kilter.load("wall.kilter.json")
    assert len(wall) - 1 == 4 + 5 + 4  # a course of whole bricks, one with halves at its ends
    for words in (["tower", "--size", "4x3"], ["wall", "--size", "4"], ["--size", "4x3"]):
        assert main(["example", *words, "--force"]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
    assert main(["example", "wall", "--size", "0x3", "--force"]) == 2


@pytest.mark.slow
def test_the_module_runs_as_a_program():
    done = subprocess.run(
        [sys.executable, "-m", "kilter", "--version"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout.strip()) == (0, f"kilter {kilter.__version__}")


def test_importing_kilter_loads_no_solver_and_no_reader():
    code = "import sys, kilter; print([m for m in sys.modules if m.split('.')[0] in HEAVY])"
    heavy = "{'highspy', 'clarabel', 'scipy', 'shapely', 'pydantic', 'argparse', 'numpy'}"
    done = subprocess.run(
        [sys.executable, "-c", code.replace("HEAVY", heavy)], capture_output=True, text=True
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper-figure-8", "tower"])
def test_a_small_check_loads_only_what_it_needs(name):
    """What takes as long to load as the check of a small assembly takes."""
    heavy = ["scipy.spatial", "scipy.special", "scipy.optimize", "scipy.sparse.csgraph"]
    heavy += ["kilter.friction", "matplotlib", "OCP", "rich"]
    if name == "tower":  # nothing moves: no accelerations
        heavy += ["scipy.linalg"]
    code = (
        f"import sys; from kilter.cli import main; sys.argv[1:] = ['check', {written(name)!r}]; "
        f"main(); print([m for m in {heavy} if m in sys.modules])"
    )
    free = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=free)
    assert done.stdout.strip().endswith("\n[]")


@pytest.mark.slow
def test_the_program_makes_no_threads_for_linear_algebra():
    code = (
        "import sys; from kilter.cli import main; sys.argv[1:] = ['example', 'tower', '-o', '-']; "
        "main(); import threadpoolctl; "
        "print({one['num_threads'] for one in threadpoolctl.threadpool_info()})"
    )
    free = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=free)
    assert done.stdout.strip().endswith("{1}")


@pytest.mark.slow
def test_verify_loads_no_solver():
    written("tower")
    assert main(["check", "tower.kilter.json", "--proof", "p.json"]) == 0
    code = (
        "import sys; from kilter.cli import main; "
        "main(['verify', 'tower.kilter.json', 'p.json']); "
        "print([m for m in sys.modules if m.split('.')[0] in ('highspy', 'clarabel')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip().endswith("[]")


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="the folder of real assemblies is not there")
@pytest.mark.parametrize(
    ("file", "held", "verdict"),
    [
        ("compas_cra/cubes.json", ["0"], "stable"),
        ("compas_cra/H.json", ["0", "1"], "unstable"),
        ("compas_cra/A.json", ["0", "1"], "unstable"),
        ("compas_cra/bridge.json", ["0", "1"], "unstable"),
        ("compas_cra/shelf-stable.json", ["0"], "unstable"),
        ("compas_cra/type-a.json", ["0", "1"], "stable"),
        ("compas_cra/type-c.json", ["0", "1"], "stable"),
        ("learn2assemble/tetris-2", ["0"], "stable"),
        ("learn2assemble/dome", ["72"], "unstable"),
    ],
)
def test_real_assemblies(file, held, verdict, capsys):
    words = [str(SHARED / file)] + [w for name in held for w in ("--ground", name)]
    code, answer = answered(capsys, "check", *words, "--proof", "p.json")
    assert (code, answer["verdict"]) == (EXIT[verdict], verdict)
    assert main(["verify", words[0], "p.json"]) == 0
    if file.endswith("H.json"):
        falling = answer["parts"][2]
        assert falling["motion"] == "falls freely at 1 g"
        assert falling["acceleration"][:3] == pytest.approx([0, 0, -9.81], abs=1e-9)
