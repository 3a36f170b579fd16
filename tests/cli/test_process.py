"""The process of a command: start, streams, outputs, doctor, and what it leaves behind."""

import gc
import json
import locale
import logging
import os
import random
import re
import signal
import stat
import subprocess
import sys
import threading
import tomllib
import warnings
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from threadpoolctl import threadpool_info

import kilter
import kilter.cli.output
import kilter.files
from kilter import health
from kilter.cli import main
from kilter.errors import InputError
from kilter.files.writing import write_bytes
from kilter.scenes import scene

HEAVY = (
    "clarabel", "highspy", "manifold3d", "matplotlib", "numpy", "pydantic", "scipy", "shapely",
    "trimesh",
)  # fmt: skip
"""Packages whose import is slow."""
UNUSED = (
    "kilter.analysis.assumptions.assume", "kilter.assembly.array_geometry",
    "kilter.contact.curved.curved_contacts", "kilter.contact.sharp.normals",
    "kilter.files.cad.step_solids", "kilter.second_order.answer.one_cluster",
    "manifold3d", "matplotlib", "numpy.f2py", "numpy.testing", "pydantic", "scipy.linalg",
    "scipy.optimize", "scipy.spatial", "shapely", "trimesh",
)  # fmt: skip
"""Modules and packages that a check of boxes without friction does not need."""


def loaded_by(code: str) -> set[str]:
    """Names of the modules that a new process has loaded after running `code`."""
    listing = f"{code}\nimport sys\nprint(*sys.modules, file=sys.stderr)"
    ended = subprocess.run(
        [sys.executable, "-c", listing], capture_output=True, text=True, check=True, timeout=60
    )
    return set(ended.stderr.split())


@pytest.mark.parametrize(
    ("code", "allowed"),
    [
        pytest.param("import kilter", set(), id="library"),
        pytest.param("from kilter.cli import main; main(['--help'])", set(), id="help"),
        pytest.param("import kilter; kilter.Assembly", {"numpy"}, id="assembly"),
    ],
)
@pytest.mark.quick("help")
def test_the_start_imports_few_packages(code, allowed):
    loaded = {name.partition(".")[0] for name in loaded_by(code)}
    assert "kilter" in loaded
    assert loaded & set(HEAVY) <= allowed


@pytest.mark.slow
def test_a_check_of_boxes_imports_no_module_that_it_does_not_need(tmp_path):
    """The variables of the environment are those that a command sets for itself."""
    path = tmp_path / "a.kilter.json"
    boxes = [{"name": "a", "box": [1, 1, 1], "grounded": True}]
    boxes += [{"name": "b", "box": [1, 1, 1], "pose": {"position": [0.1, 0, 1]}}]
    path.write_text(json.dumps({"kilter": 1, "parts": boxes}), "utf-8")
    names = loaded_by(
        "import sys\nfrom kilter.cli import main\n"
        f"sys.argv = ['kilter', 'check', {str(path)!r}, '--quiet']\nmain()\n"
    )
    assert "kilter.analysis.check" in names
    assert names & set(UNUSED) == set()


@pytest.mark.slow
def test_numpy_lists_all_its_submodules_after_the_import_of_scipy():
    code = (
        "import numpy\nbefore = dir(numpy), numpy.__all__\n"
        "from kilter.cli.asked import import_scipy_quickly\nimport_scipy_quickly()\n"
        "assert (sorted(dir(numpy)), numpy.__all__) == (sorted(before[0]), before[1])\n"
        "import numpy.f2py, numpy.testing\n"
    )
    assert {"scipy.sparse", "numpy.f2py"} <= loaded_by(code)


@pytest.mark.parametrize("own", [True, False], ids=["own process", "process of a caller"])
def test_a_command_leaves_no_objects_to_the_collections_at_the_end_of_its_process(own):
    code = (
        "import gc, sys\nfrom kilter.cli import main\nsys.argv = ['kilter', '--version']\n"
        f"main({'' if own else 'sys.argv[1:]'})\n"
        "print('frozen' if gc.get_freeze_count() else 'free', file=sys.stderr)\n"
    )
    assert ("frozen" in loaded_by(code)) == own


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("streams")
    kilter.dump(scene("slope"), folder / "slope.kilter.json")
    (folder / "no.kilter.json").write_text('{"kilter": 1}', "utf-8")
    return folder


def ended(files: Path, words: str, redirect: str) -> tuple[int, str]:
    """Exit code and error stream of a command under a shell's redirection."""
    shell = f'cd "{files}" && exec "{sys.executable}" -m kilter {words} {redirect}'
    run = subprocess.run(["sh", "-c", shell], capture_output=True, text=True, timeout=60)
    return run.returncode, run.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full of Linux")
@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "check slope.kilter.json",
        pytest.param("check slope.kilter.json --json", marks=pytest.mark.slow),
        pytest.param("example", marks=pytest.mark.slow),
        pytest.param("--version", marks=pytest.mark.slow),
    ],
)
def test_a_full_output_is_one_sentence(files, words):
    code, error = ended(files, words, "> /dev/full")
    assert code == 2
    assert error == (
        "kilter: the answer cannot be written: No space left on device; write to another place\n"
    )


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full of Linux")
@pytest.mark.slow
@pytest.mark.parametrize(
    "redirect",
    [
        ">&- 2>&- <&-",
        *(pytest.param(one, marks=pytest.mark.slow) for one in (">&-", "2>&-", "2> /dev/full")),
    ],
)
def test_the_code_says_it_where_a_stream_is_closed(files, redirect):
    assert ended(files, "check slope.kilter.json", redirect)[0] == 1
    assert ended(files, "check no.kilter.json", redirect)[0] == 2


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full of Linux")
@pytest.mark.slow
def test_closed_streams_are_no_place_for_files(files):
    """The first opened file gets the number of a closed stream, and the prints of libraries."""
    proof = files / "proof.json"
    assert ended(files, "check slope.kilter.json --proof proof.json", ">&- 2>&-")[0] == 1
    assert kilter.verify(files / "slope.kilter.json", proof).holds


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full of Linux")
@pytest.mark.slow
def test_nothing_comes_from_a_closed_input(files):
    code, error = ended(files, "check -", "<&-")
    assert code == 2
    assert error.startswith("kilter: standard input: the file is empty")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full of Linux")
@pytest.mark.slow
def test_a_pipe_that_nobody_reads_is_no_fault(files):
    out, into = os.pipe()
    os.close(out)
    words = [sys.executable, "-m", "kilter", "contacts", str(files / "slope.kilter.json")]
    run = subprocess.run(words, stdout=into, stderr=subprocess.PIPE, text=True, timeout=60)
    os.close(into)
    assert (run.returncode, run.stderr) == (0, "")


DATA = b"x" * 300_000
"""More than a pipe holds."""


@pytest.fixture
def tower(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), tmp_path / "tower.kilter.json")
    return tmp_path


def kind(path: str | Path) -> tuple[int, int]:
    """Kind and number of a file, which replacing it would change."""
    found = os.lstat(path)
    return stat.S_IFMT(found.st_mode), found.st_ino


def device(path: Path, minor: int) -> None:
    """A device of its own, like /dev/null (3) or /dev/full (7): the test must not harm those."""
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, minor))
        path.write_bytes(b"")
    except OSError:
        pytest.skip("no device can be made here")


@pytest.mark.skipif(os.name != "posix", reason="devices, pipes and links of POSIX")
@pytest.mark.parametrize("option", ["-o", "--proof"])
@pytest.mark.parametrize(("minor", "code"), [(3, 0), (7, 2)], ids=["null", "full"])
def test_a_device_is_written_into(option, minor, code, tower, capsys):
    device(tower / "device", minor)
    before = kind("device")
    assert main(["check", "tower.kilter.json", option, "device", "--quiet"]) == code
    assert kind("device") == before
    assert sorted(os.listdir()) == ["device", "tower.kilter.json"]
    if code:
        assert "device: cannot be written: No space left" in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="devices, pipes and links of POSIX")
def test_a_pipe_gets_all_data_and_stays(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match=r"pipe: cannot be written: No such device"):
        write_bytes(pipe, DATA)  # without a reader it does not wait
    heard: list[bytes] = []
    keeper = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    reader = threading.Thread(target=lambda: heard.append(pipe.read_bytes()))
    reader.start()
    write_bytes(pipe, DATA)
    os.close(keeper)
    reader.join(20)
    assert b"".join(heard) == DATA
    assert stat.S_ISFIFO(os.lstat(pipe).st_mode)


@pytest.mark.skipif(os.name != "posix", reason="devices, pipes and links of POSIX")
def test_an_inherited_pipe_is_written_into():
    """As a shell gives it: `kilter check FILE -o >(program)`."""
    if not Path("/dev/fd").exists():
        pytest.skip("no /dev/fd here")
    out, into = os.pipe()
    write_bytes(f"/dev/fd/{into}", b"answer")
    os.close(into)
    with open(out, "rb") as stream:
        assert stream.read() == b"answer"


@pytest.mark.skipif(os.name != "posix", reason="devices, pipes and links of POSIX")
def test_a_link_stays_and_its_target_is_written(tower):
    Path("link").symlink_to("made.json")
    Path("loop").symlink_to("loop")
    before = kind("link")
    assert main(["check", "tower.kilter.json", "--json", "-o", "link", "--quiet"]) == 0
    assert kind("link") == before
    assert Path("made.json").read_bytes().endswith(b"}\n")
    assert main(["check", "tower.kilter.json", "-o", "loop", "--quiet"]) == 2
    assert main(["check", "tower.kilter.json", "-o", "link", "--proof", "made.json"]) == 2


@pytest.mark.skipif(os.name != "posix", reason="devices, pipes and links of POSIX")
def test_a_name_that_is_too_long_is_a_sentence(tower, capsys):
    long = "x" * 4000
    for words in (["check", f"{long}.json"], ["check", f"{long}.step"], ["batch", long, "-o", "d"],
                  ["check", "tower.kilter.json", "-o", long]):  # fmt: skip
        assert main([*words, "--quiet"]) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert len(error) < 500


SETTINGS = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text())
FOR_OURSELVES = {"docs", "test", "browser", "notebook", "peers", "dev"}
"""Extras of who works on kilter."""


def package(requirement: str) -> str:
    return re.split(r"[\[<>=]", requirement)[0]


@pytest.mark.slow
def test_here_all_that_is_installed_works(capsys):
    assert main(["doctor", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    looks = {look["name"]: look for look in answer["looks"]}
    assert answer["works"]
    assert {look["state"] for look in looks.values()} <= {"works", "absent"}
    assert set(looks) > {"kilter", "HiGHS", "Clarabel", "verdicts", "page", "terminal"}
    assert all(f"{name} " in looks["packages"]["found"] for name in health.NEEDED)
    for name in health.EXTRAS:
        absent = looks[name]["state"] == "absent"
        assert looks[name]["remedy"] == (f"pip install 'kilter[{name}]'" if absent else "")


def test_packages_and_extras_are_those_of_the_project():
    assert list(health.NEEDED) == [package(one) for one in SETTINGS["project"]["dependencies"]]
    extras = SETTINGS["project"]["optional-dependencies"]
    assert set(health.EXTRAS) == set(extras) - FOR_OURSELVES
    for name, (_, brought, _) in health.EXTRAS.items():
        assert package(extras[name][0]) == brought


@pytest.mark.parametrize("name", ["HiGHS", "Clarabel"])
def test_a_solver_that_answers_wrong_is_seen(name, monkeypatch):
    from kilter.solvers import clarabel, highs

    home: ModuleType = highs if name == "HiGHS" else clarabel
    verb = "solve_linear" if name == "HiGHS" else "solve_conic"
    right = getattr(home, verb)

    def wrong(*given: object, **named: object) -> object:
        found = right(*given, **named)
        object.__setattr__(found, "x", np.asarray(found.x) * (1 + 1e-5))
        return found

    monkeypatch.setattr(home, verb, wrong)
    look = health._look(name, health._CHECKS[name])
    assert look.state == "broken"
    assert "optimal: [" in look.found


@pytest.mark.slow
def test_what_cannot_be_imported_is_broken_and_costs_no_other_look(monkeypatch, capsys):
    def lost(*given: object) -> None:
        raise ImportError("libhighs.so is not there")

    monkeypatch.setattr("kilter.solvers.highs.new_highs", lost)
    monkeypatch.setitem(health.EXTRAS, "figures", ("no_such_module", "none", "kilter draw"))
    assert main(["doctor"]) == 1
    first, _, *lines = capsys.readouterr().out.splitlines()
    assert first.startswith("kilter does not work here: HiGHS")
    rows = {line.split()[0]: line for line in lines}
    assert "broken  ImportError: libhighs.so is not there; install kilter again" in rows["HiGHS"]
    assert "works" in rows["Clarabel"]
    assert rows["figures"].endswith("absent  kilter draw; pip install 'kilter[figures]'")


def test_a_package_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr(health, "NEEDED", ("numpy", "no_such_module"))
    look = health._look("packages", health._packages)
    assert look.state == "broken"
    assert "no_such_module" in look.found
    assert "numpy" not in look.found


@pytest.mark.slow
def test_a_solid_of_another_volume_is_seen(monkeypatch):
    pytest.importorskip("OCP")
    assert health._extra("step").state == "works"
    monkeypatch.setattr(health, "BALL", health.BALL.replace("#10,1.);", "#10,2.);"))
    look = health._extra("step")
    assert look.state == "broken"
    assert "ball of radius 1" in look.found


POSIX = pytest.mark.skipif(os.name != "posix", reason="signals and processes of POSIX")

COMMANDS = {
    "check": (["check", "tower.kilter.json", "--proof", "p.json"], 0),
    "check with friction": (["check", "wall.kilter.json", "--friction", "0.6", "--json"], 0),
    "contacts": (["contacts", "tower.kilter.json"], 0),
    "region": (["region", "tower.kilter.json"], 0),
    "margin": (["margin", "tower.kilter.json"], 0),
    "report": (["report", "tower.kilter.json", "-o", "tower.html"], 0),
    "draw": (["draw", "tower.kilter.json", "-o", "tower.svg"], 0),
    "verify": (["verify", "tower.kilter.json", "kept.json"], 0),
    "help": (["check", "--help"], 0),
    "wrong input": (["check", "no-such-file.json"], 2),
    "wrong usage": (["check", "tower.kilter.json", "--effort", "x"], 2),
}
QUICK = ("check", "contacts", "help", "wrong input", "wrong usage")


def handled(number: int, frame: object) -> None:
    """A signal, by a program that listens for itself."""


@pytest.fixture
def assemblies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), "tower.kilter.json")
    kilter.dump(scene("wall"), "wall.kilter.json")
    proof = kilter.check(scene("tower")).proof()
    kilter.files.write_text(Path("kept.json"), kilter.cli.output.as_json(proof))


def state() -> dict[str, object]:
    """Settings of the whole process."""
    signals = [one for one in signal.Signals if one not in (signal.SIGKILL, signal.SIGSTOP)]
    return {
        "warnings": (list(warnings.filters), warnings.showwarning),
        "signals": {one.name: signal.getsignal(one) for one in signals},
        "wakeup": wakeup(),
        "environment": dict(os.environ),
        "numpy": (np.geterr(), np.geterrcall(), np.get_printoptions()),
        "random": (random.getstate(), str(np.random.get_state())),  # noqa: NPY002
        "streams": (sys.stdin, sys.stdout, sys.stderr, sys.displayhook, sys.excepthook),
        "path": list(sys.path),
        "arguments": list(sys.argv),
        "folder": os.getcwd(),
        "mask": mask(),
        "locale": locale.setlocale(locale.LC_ALL),
        "logging": (logging.root.level, list(logging.root.handlers)),
        "garbage": (gc.isenabled(), gc.get_threshold()),
        "threads": sorted(one.name for one in threading.enumerate()),
        "recursion": (sys.getrecursionlimit(), sys.getswitchinterval()),
        "trace": (sys.gettrace(), threading.excepthook),
        "linear algebra": {one["filepath"]: one["num_threads"] for one in threadpool_info()},
    }


def wakeup() -> int:
    """Where the interpreter tells of signals."""
    number = signal.set_wakeup_fd(-1)
    signal.set_wakeup_fd(number)
    return number


def mask() -> int:
    """Places and kinds that written files may not have."""
    now = os.umask(0o077)
    os.umask(now)
    return now


@pytest.mark.usefixtures("assemblies")
@pytest.mark.quick(1)
@POSIX
@pytest.mark.parametrize(
    "name", [one if one in QUICK else pytest.param(one, marks=pytest.mark.slow) for one in COMMANDS]
)
def test_a_command_changes_nothing_of_the_process(name, capsys):
    words, code = COMMANDS[name]
    main(words)  # what is loaded once, is loaded
    before = signal.signal(signal.SIGINT, handled)
    try:
        with np.errstate(all="raise", under="ignore"), warnings.catch_warnings():
            warnings.simplefilter("error", ResourceWarning)
            was = state()
            assert main(words) == code, capsys.readouterr().err
            now = state()
    finally:
        signal.signal(signal.SIGINT, before)
    assert [key for key, value in was.items() if now[key] != value] == []


@pytest.mark.usefixtures("assemblies")
@POSIX
@pytest.mark.slow
def test_a_fault_changes_nothing_either(monkeypatch, capsys):
    main(["check", "tower.kilter.json"])

    def breaks(*given: object, **named: object) -> None:
        raise ZeroDivisionError("on purpose")

    monkeypatch.setattr("kilter.analysis.check.check", breaks)
    was = state()
    assert main(["check", "tower.kilter.json"]) == 70
    now = state()
    assert [key for key, value in was.items() if now[key] != value] == []


@pytest.mark.usefixtures("assemblies")
@POSIX
def test_a_command_in_a_thread_of_somebody_else(capsys):
    """No signal can be set there, and none is."""
    main(["check", "tower.kilter.json"])
    was, codes = state(), []
    thread = threading.Thread(target=lambda: codes.append(main(["check", "tower.kilter.json"])))
    thread.start()
    thread.join()
    now = state()
    assert codes == [0]
    assert [key for key, value in was.items() if now[key] != value] == []
