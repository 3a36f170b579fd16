"""Files that commands write, whole or not at all; plans and random saved options."""

import contextlib
import io
import json
import os
import shlex
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from forked import SAID, Commands

import kilter
from kilter.cli import main
from kilter.errors import KilterError
from kilter.files.own.choices_writing import OFF
from kilter.mechanics.bundle_changes import restored
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.shape.primitives import BOX_CORNERS, BOX_QUADS

FILE, SLIDES, BRICKS = "tower.kilter.json", "slope.kilter.json", "stair.txt"
PACKED, SIMULATED = "packed.csv", "box.xml"
BOX = """<mujoco><worldbody>
  <geom type="plane" size="1 1 1"/>
  <body name="box" pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
</worldbody></mujoco>
"""
"""A box on a floor, for MuJoCo."""
WRITERS = {
    "proof.json": ["check", FILE, "--quiet", "--proof"],
    "check.json": ["check", FILE, "--quiet", "--json", "-o"],
    "check.txt": ["check", FILE, "--quiet", "-o"],
    "region.json": ["region", FILE, "--quiet", "--proof"],
    "margin.json": ["margin", FILE, "--quiet", "--proof"],
    "transport.json": ["transport", FILE, "--quiet", "--proof"],
    "orient.json": ["orient", FILE, "--quiet", "--json", "-o"],
    "contacts.json": ["contacts", FILE, "--quiet", "--json", "-o"],
    "improve.json": ["margin", BRICKS, "--quiet", "--improve", "--write"],
    "hold.json": ["hold", FILE, "--quiet", "--json", "-o"],
    "plan.json": ["plan", FILE, "--quiet", "--json", "-o"],
    "plan.csv": ["plan", FILE, "--quiet", "-o"],
    "plan.html": ["plan", FILE, "--quiet", "-o"],
    "plan.glb": ["plan", FILE, "--quiet", "-o"],
    "report.html": ["report", FILE, "--quiet", "-o"],
    "place.json": ["place", FILE, "--quiet", "--json", "--box", ".5x.5x.5", "--mass", "1", "-o"],
    "scene.json": ["scene", FILE, "--quiet", "--json", "-o"],
    "why.json": ["why", SIMULATED, "--quiet", "--json", "-o"],
    "settle.svg": ["settle", FILE, "--quiet", "-o"],
    "packed.json": ["check-plan", PACKED, "--quiet", "--json", "-o"],
    "draw.svg": ["draw", FILE, "--quiet", "-o"],
    "draw.png": ["draw", FILE, "--quiet", "-o"],
    "draw.glb": ["draw", SLIDES, "--quiet", "-o"],
    "choices.json": ["save", FILE, "--quiet", "--ground", "cube-1", "-o"],
    "example.kilter.json": ["example", "wall", "--force", "-o"],
}
"""Commands by the file that each writes."""
OLD = b"an answer of before\n"
OLD_CHOICES = b'{"kilter": 1, "file": "tower.kilter.json"}\n'
"""An earlier file of save, which replaces choices only."""
ENDS = {
    ".json": b"}\n",
    ".html": b"</html>",
    ".svg": b"</svg>",
    ".png": b"IEND\xaeB`\x82",
    ".csv": b"\n",
    ".txt": b"\n",
}
"""What a whole file ends with."""


@pytest.fixture(scope="module")
def commands() -> Iterator[Commands]:
    found = Commands()
    yield found
    found.end()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A tower of three cubes, a block that slides, two bricks, a box on a floor: all is quick."""
    kilter.dump(scene("tower"), tmp_path / FILE)
    kilter.dump(scene("slope"), tmp_path / SLIDES)
    (tmp_path / PACKED).write_text(
        "length,width,height,mass,x,y,z\n1,1,1,1,0,0,0\n", encoding="utf-8"
    )
    (tmp_path / SIMULATED).write_text(BOX, encoding="utf-8")
    (tmp_path / BRICKS).write_text("4x2 (0,0,0)\n4x2 (2,0,1)\n", encoding="utf-8")
    return tmp_path


def old_content(name: str) -> bytes:
    """Content of the earlier file that a command replaces."""
    return OLD_CHOICES if name == "choices.json" else OLD


def whole(path: Path) -> bool:
    """It is there to its end."""
    data = path.read_bytes()
    if path.suffix == ".glb":
        return data[:4] == b"glTF" and int.from_bytes(data[8:12], "little") == len(data)
    if path.suffix == ".json":
        json.loads(data)
    return data.rstrip(b"\n").endswith(ENDS[path.suffix].rstrip(b"\n"))


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
def test_every_command_that_writes_is_here():
    from kilter.cli.commands import COMMANDS

    # batch: tests/cli/test_batch.py; mcp: tests/agents
    quiet = {"view", "verify", "batch", "doctor", "mcp", "help"}
    assert {words[0] for words in WRITERS.values()} == set(COMMANDS) - quiet


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
@pytest.mark.slow
@pytest.mark.parametrize("name", WRITERS)
def test_a_command_that_is_killed_leaves_a_whole_file_or_the_old_one(
    name, commands, folder, request
):
    """At any of many moments, half of them near the end, where files are written."""
    kills = request.config.getoption("--kills")
    words, target, old = [*WRITERS[name], name], folder / name, old_content(name)
    took = min(commands.run(words, folder)[1] for _ in range(3))
    assert whole(target)
    rng, kept = np.random.default_rng(len(name)), 0
    for k in range(kills):
        before = k % 2 == 0
        target.write_bytes(old) if before else target.unlink(missing_ok=True)
        after = rng.uniform(0.0 if k % 4 < 2 else 0.6 * took, 1.1 * took)
        code, _ = commands.run(words, folder, after=after, number=signal.SIGKILL)
        kept += code == -signal.SIGKILL
        if target.exists() and (target.read_bytes() != old or not before):
            assert whole(target), f"killed after {after} s"
        else:
            assert target.exists() == before
            assert code == -signal.SIGKILL
    assert kept  # some of the moments came before the end; on a busy machine, where times vary, few


STEPS = """
import os, signal, sys
from kilter.files import write_bytes
left = int(sys.argv[2])
def counted(function):
    def called(*given, **named):
        global left
        left -= 1
        if left < 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return function(*given, **named)
    return called
for name in ("open", "fdopen", "fsync", "chmod", "replace", "unlink", "umask"):
    setattr(os, name, counted(getattr(os, name)))
write_bytes(sys.argv[1], b"new" * 100_000)
"""


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
@pytest.mark.slow
@pytest.mark.parametrize("before", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_write_that_is_killed_at_any_of_its_steps(before, tmp_path):
    import sys

    target, ended, step = tmp_path / "a.json", -1, 0
    while ended != 0:
        target.write_bytes(OLD) if before else target.unlink(missing_ok=True)
        run = subprocess.run([sys.executable, "-c", STEPS, str(target), str(step)], timeout=60)
        ended, step = run.returncode, step + 1
        assert ended in (0, -signal.SIGKILL)
        data = target.read_bytes() if target.exists() else None
        assert data in ((OLD if before else None), b"new" * 100_000)
    assert step >= 5
    assert data == b"new" * 100_000


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
@pytest.mark.slow
@pytest.mark.parametrize("ignored", [False, True], ids=["heard", "inherited as ignored"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("name", WRITERS)
def test_a_command_that_is_asked_to_end_leaves_nothing_beside(
    name, number, ignored, commands, folder
):
    """One line and code 130, or its answer where it had it already."""
    words, target, old = [*WRITERS[name], name], folder / name, old_content(name)
    _, took = commands.run(words, folder)
    rng = np.random.default_rng([len(name), number])
    for _ in range(2):
        target.write_bytes(old)
        after = rng.uniform(0.2, 1.0) * took
        code, _ = commands.run(words, folder, after=after, number=number, ignored=ignored)
        said = (folder / SAID).read_text("utf-8")
        assert "Traceback" not in said
        assert {path.name for path in folder.iterdir()} == {
            FILE,
            SLIDES,
            BRICKS,
            PACKED,
            SIMULATED,
            SAID,
            name,
        }
        if code == 130:
            assert "kilter: interrupted" in said.splitlines()[-1]  # a plan says what it knew so far
            assert target.read_bytes() == old or whole(target)
        elif code == -number:
            assert not ignored  # before it listened: the system ends it
        else:
            assert whole(target), (code, said)


@pytest.fixture(params=["full", "read-only"])
def no_room(request: pytest.FixtureRequest, folder: Path) -> Iterator[Path]:
    """A file system of its own, without room or rights, where one may be mounted."""
    place = folder / "disk"
    place.mkdir()
    try:
        mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(place)]
        subprocess.run(mount, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("nothing may be mounted here")
    try:
        for name in WRITERS:
            (place / name).write_bytes(old_content(name))
        if request.param == "full":
            with open(place / "ballast", "wb", buffering=0) as ballast, suppress(OSError):
                while ballast.write(bytes(1024)):
                    pass
        else:
            subprocess.run(["mount", "-o", "remount,ro", str(place)], check=True)
        yield place
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True)


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
@pytest.mark.slow
def test_without_room_or_rights_the_old_file_stays(no_room, commands):
    """One sentence that says why, and code 2."""
    before = {path.name: path.read_bytes() for path in no_room.iterdir()}
    for name, words in WRITERS.items():
        if words[0] == "save":
            continue  # choices lie in a folder above their file, which is on another disk
        code, _ = commands.run([*words, f"disk/{name}"], no_room.parent)
        said = (no_room.parent / SAID).read_text("utf-8")
        assert (code, said.count("\n")) == (2, 1), said
        assert said.startswith(f"kilter: disk/{name}: cannot be written: ")
        assert "No space left" in said or "Read-only file system" in said
    assert {path.name: path.read_bytes() for path in no_room.iterdir()} == before


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
@pytest.mark.slow
def test_a_file_that_goes_while_it_is_read_is_one_sentence(commands, folder):
    """Removed, cut, or replaced by a folder, at any moment: an answer, or what is missing."""
    import threading

    words, text = ["check", FILE, "--quiet"], (folder / FILE).read_bytes()
    _, took = commands.run(words, folder)
    rng = np.random.default_rng(0)
    for k in range(60):
        path = folder / FILE
        shutil.rmtree(path, ignore_errors=True)
        path.unlink(missing_ok=True) if path.is_file() else None
        path.write_bytes(text)

        def goes(path: Path = path, way: int = k % 3) -> None:
            if way == 1:
                os.truncate(path, len(text) // 2)
                return
            path.unlink()
            if way == 2:
                path.mkdir()

        timer = threading.Timer(rng.uniform(0, took), goes)
        timer.start()
        code, _ = commands.run(words, folder)
        timer.join()
        said = (folder / SAID).read_text("utf-8")
        assert code in (0, 2), said
        assert "Traceback" not in said
        if code == 2:
            assert said.count("\n") == 1
            assert said.startswith(f"kilter: {FILE}: ")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "arch.kilter.json"
    kilter.dump(arch(9, ratio=0.3, friction=0.6), path)
    return path


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("options", "code"),
    [
        ([], 0),
        (["--hold", "0"], 1),
        (["--effort", "0"], 4),
        (["--require", "proved", "--effort", "0.1"], 3),
        (["--never-hold", "voussoir*"], 1),
        (["--directions", "0,0,-1"], 4),
        (["--before", "voussoir-1", "voussoir-0", "--before", "voussoir-0", "voussoir-1"], 2),
        (["--before", "voussoir-1", "nobody"], 2),
        (["--directions", "up"], 2),
        (["--screws", "voussoir-1"], 2),
        (["--ground", "*"], 0),
        (["--friction", "0.1"], 1),
    ],
)
def test_exit_codes(file, options, code):
    assert main(["plan", str(file), *options]) == code


@pytest.mark.slow
def test_the_proof_is_verified_from_the_file(file, tmp_path, capsys):
    proof = tmp_path / "p.json"
    assert main(["plan", str(file), "--proof", str(proof), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["found"], answer["holds_max"], answer["impossible"]["kind"]) == (
        True, 1, "closure",
    )  # fmt: skip
    assert main(["verify", str(file), str(proof)]) == 0
    assert "The proof holds: plan." in capsys.readouterr().out
    data = restored(json.loads(proof.read_text()))
    step = next(one for one in data["proofs"] if one["about"] == "step" and one["change"]["held"])
    step["proof"]["forces"][0][2] += 1e4
    proof.write_text(json.dumps(data))
    assert main(["verify", str(file), str(proof)]) == 1


@pytest.mark.slow
def test_steps_are_written_as_a_table(file, tmp_path):
    table = tmp_path / "plan.csv"
    assert main(["plan", str(file), "-o", str(table)]) == 0
    lines = table.read_text().splitlines()
    assert lines[0].startswith("step,part,held")
    assert len(lines) == 10


@pytest.mark.slow
def test_what_falls_when_it_is_finished_is_named(file, capsys):
    assert main(["plan", str(file), "--friction", "0.1"]) == 1
    said = capsys.readouterr().out
    assert "the finished assembly falls: 'voussoir-" in said


@pytest.mark.slow
def test_a_page_is_written_that_says_how_it_was_made(file, tmp_path, capsys):
    page = tmp_path / "plan.html"
    options = ["--hold", "1", "--before", "voussoir-8", "voussoir-0"]
    assert main(["plan", str(file), *options, "-o", str(page)]) == 0
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith(f"{page}: ")
    assert told.err.count("\n") == 1
    assert "put together in 9 steps" in told.err
    html = page.read_text(encoding="utf-8")
    assert "--hold 1 --before voussoir-8 voussoir-0 -o" in html
    assert main(["plan", str(file), "--hold", "0", "-o", str(page), "--quiet"]) == 1
    assert "impossible" in page.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "begins"),
    [
        ("plan.glb", b"glTF"),
        ("plan.svg", b"<?xml"),
        ("plan.png", b"\x89PNG"),
        ("plan.pdf", b"%PDF"),
    ],
)
def test_films_and_figures_are_written_where_there_are_steps(name, begins, file, tmp_path, capsys):
    made = tmp_path / name
    assert main(["plan", str(file), "-o", str(made)]) == 0
    assert made.read_bytes().startswith(begins)
    made.unlink()
    capsys.readouterr()
    assert main(["plan", str(file), "--hold", "0", "-o", str(made)]) == 1
    told = capsys.readouterr()
    assert "with nothing held no order exists" in told.out
    assert "not written, because the plan has no steps" in told.err
    assert not made.exists()


@pytest.mark.slow
@pytest.mark.parametrize("page", [[], ["-o", "plan.html"]])
def test_an_earlier_proof_stays_where_there_is_none_and_that_is_said(
    page, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), "tower.json")
    Path("p.json").write_text("earlier")
    Path("order.txt").write_text("\n".join(f"cube-{k}" for k in (5, 4, 3, 2, 1)))
    words = ["plan", "tower.json", "--sequence", "order.txt", "--proof", "p.json", *page]
    assert main(words) == 1
    assert "p.json was not changed" in capsys.readouterr().err
    assert Path("p.json").read_text() == "earlier"


@pytest.mark.quick(1)
@pytest.mark.parametrize("command", ["check", "plan", "hold", "region", "margin"])
def test_a_proof_is_never_written_over_the_file(command, tmp_path, capsys):
    path = tmp_path / "tower.json"
    kilter.dump(scene("tower"), path)
    before = path.read_text()
    assert main([command, str(path), "--proof", str(path)]) == 2
    assert "would be overwritten" in capsys.readouterr().err
    assert path.read_text() == before


ROOT = Path(__file__).resolve().parents[2]
SETS, EACH = 48, 6


def run(words: list[str]) -> tuple[int, str, str]:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    return code, out.getvalue(), err.getvalue()


def timeless(answer: Any) -> Any:
    if isinstance(answer, dict):
        return {key: timeless(value) for key, value in answer.items() if key != "seconds"}
    return [timeless(value) for value in answer] if isinstance(answer, list) else answer


def unnoted(text: str) -> Any:
    """Data of an answer without its warnings about replaced choices."""
    answer = timeless(json.loads(text))
    warnings = [words for words in answer["warnings"] if "of the choices" not in words]
    return {**answer, "warnings": warnings}


def write_files(folder: Path) -> dict[str, tuple[str, ...]]:
    """A file of each kind, with the names of its parts."""
    kilter.dump(kilter.example("tower"), folder / "tower.kilter.json")
    kilter.dump(kilter.example("wall", size=(3, 3)), folder / "wall.kilter.json")
    (folder / "bricks.txt").write_text("4x2 (0,0,0)\n4x2 (2,0,1)\n2x2 (5,0,2)\n", "utf-8")
    quads = {str(k): quad for k, quad in enumerate(BOX_QUADS.tolist())}
    nodes = {}
    (folder / "mesh").mkdir()
    for k, shift in enumerate((0.0, 0.2, 0.6)):
        corners = (BOX_CORNERS + np.array([shift, 0, k])).tolist()
        places = {str(n): dict(zip("xyz", x, strict=True)) for n, x in enumerate(corners)}
        data = {"attributes": {}, "vertex": places, "face": quads}
        block = {"dtype": "compas_assembly.datastructures/Block", "data": data}
        nodes[str(k)] = {"block": block, "is_support": k == 0}
        lines = ["v " + " ".join(map(str, x)) for x in corners]
        lines += ["f " + " ".join(str(n + 1) for n in quad) for quad in BOX_QUADS.tolist()]
        (folder / "mesh" / f"m{k}.obj").write_text("\n".join(lines), "utf-8")
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes}}
    kind = "compas_assembly.datastructures/Assembly"
    compas = {"dtype": kind, "data": {"graph": graph}}
    (folder / "compas.json").write_text(json.dumps(compas), "utf-8")
    shutil.copy(ROOT / "examples" / "clamp.step", folder)
    files = ["tower.kilter.json", "wall.kilter.json", "compas.json", "mesh", "bricks.txt"]
    names = {file: kilter.load(folder / file).names for file in files}
    return {**names, "clamp.step": ("base", "arm", "bolt", "nut")}


def random_options(rng: np.random.Generator, file: str, names: tuple[str, ...]) -> list[str]:
    """Random options of reading; a set may be invalid."""
    pick = lambda: str(rng.choice(names))  # noqa: E731
    number = lambda low, high: f"{rng.uniform(low, high):.17g}"  # noqa: E731
    turned = ["--down", *(f"{x:.17g}" for x in [*rng.normal(0, 0.1, 2), -1.0])]
    pattern = f"{pick()[:2]}*"
    options: list[tuple[float, list[str]]] = [
        (0.7, ["--ground", names[0], *([pick()] if rng.random() < 0.3 else [])]),
        (0.3, ["--floor"] if rng.random() < 0.6 else ["--floor", number(-1, 0)]),
        (0.25, ["--without", pattern if rng.random() < 0.3 else pick()]),
        (0.5, turned if rng.random() < 0.7 else ["--up", str(rng.choice(["y", "z", "-x"]))]),
        (0.5, ["--friction", number(0, 1)]),
        (0.3, ["--density", number(100, 8000)]),
        (0.3, ["--fasten", pick(), pattern]),
        (0.2, ["--bond", pick(), pattern, number(0, 100)]),
        (0.2, ["--fasten-suggested"]),
        (0.2, ["--fasten-overlaps"]),
        (0.3, ["--gap", number(1e-6, 1e-2)]),
        (0.2, ["--angle", number(0.01, 3)]),
        (0.2, ["--clearance", number(1e-6, 1e-2)]),
        (0.2, ["--loose"]),
    ]
    if file in ("compas.json", "mesh"):
        options.append((0.4, ["--units", str(rng.choice(["mm", "cm", "in"]))]))
    if file == "compas.json":
        options.append((0.3, ["--contacts", "geometry"]))
    if file == "bricks.txt":
        options += [
            (0.4, ["--stud-pull", number(0, 2)]),
            (0.3, ["--stud-shear", str(rng.choice(["mu", "unlimited", "0.7"]))]),
            (0.3, ["--brick-sides", str(rng.choice(["face", "none"]))]),
        ]
    return [word for chance, words in options if rng.random() < chance for word in words]


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, SETS, EACH))
def test_random_options_answer_the_same_when_they_are_saved(first, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = write_files(tmp_path)
    try:
        import OCP  # noqa: F401
    except ModuleNotFoundError:
        del files["clamp.step"]
    answers = 0
    for k in range(first, first + EACH):
        rng = np.random.default_rng([35, k])
        file = list(files)[k % len(files)]
        words = random_options(rng, file, files[file])
        given = run(["check", file, *words, "--effort", "0", "--json"])
        saved = run(["save", file, *words, "-o", "saved.json", "--quiet"])
        line = shlex.join([file, *words])
        if saved[0] == 2:
            assert given[0] == 2, line
            assert saved[2] == given[2].replace("check", "save"), line
            continue
        code, out, err = run(["check", "saved.json", "--effort", "0", "--json"])
        assert code == given[0], (line, err, given[2])
        assert err == given[2], line
        if code != 2:
            answers += 1
            assert timeless(json.loads(out)) == timeless(json.loads(given[1])), line
        plain = run(["check", file, "--effort", "0", "--json"])
        choices = kilter.Choices.read("saved.json")
        # the saved floor is switched off, and so is the one that a plain answer would assume
        assumes = "assumed: a floor" in plain[1]
        off = [name for name in OFF if name != "floor" or not assumes]
        if not (assumes and choices.floor):
            code, bare, _ = run(["check", "saved.json", "--off", *off, "--effort", "0", "--json"])
            assert code == plain[0], line
            assert not bare or unnoted(bare) == unnoted(plain[1]), line
        run(["save", "saved.json", "-o", "again.json", "--quiet"])
        assert kilter.Choices.read("again.json") == choices, line
        with contextlib.suppress(KilterError):
            verdict = kilter.check(kilter.load("saved.json"), effort=0)
            assert timeless(verdict.to_dict()) == timeless(json.loads(out)), line
    assert answers >= 1
