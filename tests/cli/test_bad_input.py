"""Wrong input: exit 2, one message that says what, where and what to do; no traceback ever."""

import copy
import json
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import kilter
from kilter.cli import main
from kilter.cli.interruption import interruptible
from kilter.scenes import scene

FLAT = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2], [0, 2, 1]]}
CLOSED = {
    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def base() -> dict:
    return {
        "kilter": 1,
        "parts": [
            {"name": "table", "box": [2, 2, 1], "grounded": True},
            {"name": "cube", "box": [1, 1, 1], "pose": {"position": [0, 0, 1]}},
        ],
    }


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """The one message of a refused command."""
    capsys.readouterr()
    before = sorted(Path().iterdir())
    assert main(list(words)) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert error.startswith("kilter: ")
    assert "Traceback" not in error
    assert sorted(Path().iterdir()) == before
    return error


def set_part(**changes: object) -> Callable[[dict], None]:
    def change(data: dict) -> None:
        data["parts"][1].update(changes)

    return change


def mesh(value: dict) -> Callable[[dict], None]:
    def change(data: dict) -> None:
        data["parts"][1].pop("box")
        data["parts"][1]["mesh"] = copy.deepcopy(value)

    return change


def nan_mesh(data: dict) -> None:
    mesh({**CLOSED, "vertices": [[0, 0, "NaN"], *CLOSED["vertices"][1:]]})(data)


CASES: dict[str, tuple[Callable[[dict], object], list[str]]] = {
    # each fault of a file has a row in tests/files/test_kilter_json_errors.py
    "unknown key": (set_part(densty=5), ["densty", "density", "cube"]),
    "nothing held": (lambda d: d["parts"][0].pop("grounded"), ["held", "--ground", "table"]),
    "nan vertex": (nan_mesh, ["cube", "mesh"]),
    "zero volume": (mesh(FLAT), ["cube"]),
    "unknown part": (
        lambda d: d.update(loads=[{"part": "cub", "force": [0, 0, -1]}]),
        ["cub", "did you mean 'cube'"],
    ),
    "missing mesh": (
        lambda d: (d["parts"][1].pop("box"), d["parts"][1].update(mesh="no.stl")),
        ["no.stl"],
    ),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", CASES)
def test_a_wrong_assembly_file(case, capsys):
    change, expected = CASES[case]
    data = base()
    change(data)
    Path("a.kilter.json").write_text(json.dumps(data))
    error = refused(capsys, "check", "a.kilter.json", "--proof", "p.json", "-o", "out.txt")
    assert "a.kilter.json" in error
    for word in expected:
        assert word in error, error


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("a.kilter.json", b"{", "a.kilter.json"),
        ("a.kilter.json", b"\xff\xfe{}", "a.kilter.json"),
        ("a.kilter.json", b"[1, 2]", "a.kilter.json"),
        ("a.kilter.json", b"", "a.kilter.json"),
        ("a.stl", b"solid cut short", "a.stl"),
        ("a.glb", b"glTF????", "a.glb"),
        ("a.3mf", b"PK", "a.3mf"),
        ("a.obj", b"v 0 0 nan\nf 1 1 1\n", "a.obj"),
        ("a.step", b"ISO-10303-21;", "STEP"),
        ("a.doc", b"hello", "a.doc"),
    ],
)
def test_a_broken_file(name, content, expected, capsys):
    Path(name).write_bytes(content)
    assert expected in refused(capsys, "check", name, "--floor")


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["check"], "FILE"),
        (["check", "nope.json"], "no such file"),
        (["chek", "a.json"], "check"),
        (["check", "a.json", "--grond", "x"], "--ground"),
        (["check", "a.json", "--down", "0", "0"], "--down"),
        (["check", "a.json", "--down", "0", "0", "0"], "down"),
        (["check", "a.json", "--down", "0", "0", "nan"], "down"),
        (
            ["check", "a.json", "--friction", "abc"],
            "--friction has 'abc'; give a coefficient, a share or an angle",
        ),
        (
            ["check", "a.json", "--down", "0", "0", "z"],
            "--down has 'z', not a number; write --down X Y Z",
        ),
        (["view", "a.json", "--port", "x"], "--port has 'x', not a whole number; write --port N"),
        (["draw", "a.json", "--what", "y"], "--what has 'y', not one of assembly|region|changes"),
        (["check", "a.json", "--ground", "cubes"], "did you mean 'cube'"),
        (["check", "a.json", "--without", "c?be", "--without", "table"], "all parts are left out"),
        (["check", "a.json", "--gap", "0"], "--gap"),
        (["check", "a.json", "--angle", "90"], "--angle"),
        (["check", "a.json", "--friction", "-1"], "friction"),
        (["check", "a.json", "--units", "mm"], "units"),
        (["check", "a.json", "-o", "no/such/folder/x.txt"], "no/such/folder"),
        (["example", "towr"], "tower"),
        (["verify", "a.json", "nope.json"], "nope.json"),
        (["verify", "a.json", "a.json"], "a.json"),
    ],
)
def test_wrong_usage(words, expected, capsys):
    Path("a.json").write_text(json.dumps(base()))
    assert expected in refused(capsys, *words)


def test_two_warnings_that_are_no_refusal(capsys):
    data = base()
    data["parts"].append(dict(data["parts"][1], name="twin"))
    data["parts"][0]["grounded"] = data["parts"][1]["grounded"] = True
    data["parts"][2]["grounded"] = True
    Path("a.json").write_text(json.dumps(data))
    assert main(["check", "a.json"]) == 0
    error = capsys.readouterr().err
    assert "every part is held" in error


def test_the_same_body_under_two_names_is_named(capsys):
    data = base()
    data["parts"].append(dict(data["parts"][1], name="twin"))
    Path("a.json").write_text(json.dumps(data))
    main(["check", "a.json"])
    assert "'cube' and 'twin' are the same body twice" in capsys.readouterr().err


@pytest.mark.slow
def test_a_mesh_turned_inside_out_is_turned_back(capsys):
    kilter.dump(scene("tower"), "a.json")
    data = base()
    mesh({**CLOSED, "faces": [face[::-1] for face in CLOSED["faces"]]})(data)
    data["parts"][1]["pose"]["position"] = [0, 0, 0.5]
    Path("a.json").write_text(json.dumps(data))
    assert main(["check", "a.json"]) == 0
    assert "'cube'" in capsys.readouterr().err


def test_a_fault_of_kilter_exits_70_and_says_how_to_report_it(capsys, monkeypatch):
    Path("a.json").write_text(json.dumps(base()))

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("a fault\nof two lines")

    monkeypatch.setattr("kilter.analysis.decision.cascade.judge", broken)
    assert main(["check", "a.json", "--proof", "p.json"]) == 70
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "ZeroDivisionError" in error
    assert "report" in error
    assert not Path("p.json").exists()


def test_an_interrupt_exits_130(capsys, monkeypatch):
    Path("a.json").write_text(json.dumps(base()))

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("kilter.analysis.decision.cascade.judge", interrupted)
    assert main(["check", "a.json"]) == 130
    assert capsys.readouterr().err == (
        'kilter: interrupted in the step "verdict"; known so far: it has 2 parts, 1 of them held, '
        "1 pair of parts touches\n"
    )


def test_a_name_cannot_disturb_the_terminal(capsys):
    data = base()
    data["parts"][1].update(name="a\x1b[31m\nb" + "x" * 10_000, pose={"position": [0, 0, 5]})
    Path("a.json").write_text(json.dumps(data))
    assert main(["check", "a.json"]) == 1
    out, error = capsys.readouterr()
    assert "\x1b" not in out + error
    assert len(out) < 4000


@pytest.mark.slow
def test_a_mesh_of_three_hundred_thousand_faces_works(capsys):
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=7)
    ball.apply_translation([0, 0, 5])
    assert len(ball.faces) > 300_000
    ball.export("ball.stl")
    data = base()
    data["parts"].append({"name": "ball", "mesh": "ball.stl"})
    Path("a.json").write_text(json.dumps(data))
    assert main(["check", "a.json", "--quiet"]) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_command_started_with_the_signal_ignored_is_interrupted_all_the_same(number):
    """As a script starts it in the background; what was inherited is given back at the end."""
    inherited = signal.signal(number, signal.SIG_IGN)
    try:
        with interruptible(alone=False), pytest.raises(KeyboardInterrupt):
            signal.raise_signal(number)
        assert signal.getsignal(number) is signal.SIG_IGN
    finally:
        signal.signal(number, inherited)


@pytest.mark.parametrize(
    "call",
    [
        lambda assembly: kilter.save(assembly, "x.kilter.json"),
        lambda assembly: kilter.place(assembly, None),
        lambda assembly: kilter.place(assembly, "box"),
        lambda assembly: kilter.check(assembly, contacts="file"),
        lambda assembly: kilter.check(assembly, effort="much"),
        lambda assembly: kilter.margin(assembly, time_limit=-1),
    ],
    ids=["save", "place None", "place str", "contacts", "effort", "time_limit"],
)
def test_values_of_wrong_types_get_a_sentence(call):
    with pytest.raises(kilter.InputError) as caught:
        call(kilter.example("tower"))
    assert "\n" not in str(caught.value)
    assert caught.value.hint
