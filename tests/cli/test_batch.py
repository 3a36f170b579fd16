"""`kilter batch`: whatever is killed, full or interrupted, no row is lost or doubled."""

import contextlib
import csv
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import pipes
from kilter.analysis.many.batch import KILLED, listed_files
from kilter.analysis.many.batch_folder import open_folder
from kilter.analysis.many.batch_rows import COLUMNS, BatchQuestion, error_row, judged_rows
from kilter.cli import main
from kilter.errors import InputError, KilterError
from kilter.scenes.random_bricks import box_pile

FILES = 24
POSIX = pytest.mark.skipif(os.name != "posix", reason="signals and processes of POSIX")


@pytest.fixture(scope="module")
def piles(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of piles, and of one file that is none."""
    folder = tmp_path_factory.mktemp("piles")
    for seed in range(FILES - 1):
        pile = box_pile(5, seed=seed, cells=4, level=bool(seed % 2))
        kilter.dump(pile, folder / f"pile-{seed}.kilter.json")
    (folder / "wrong.json").write_text("{")
    return folder


def rows_of(folder: Path) -> list[dict[str, str]]:
    """All rows of a folder, in order of its files."""
    found = []
    for path in sorted(folder.glob("part-*.csv")):
        with open(path, encoding="utf-8", newline="") as stream:
            found += list(csv.DictReader(stream))
    return found


def require_whole(piles: Path, folder: Path) -> None:
    """Every file has one row, with its own verdict, and nothing else is left."""
    rows = rows_of(folder)
    names = listed_files(piles)[1]
    assert [(int(row["index"]), row["file"]) for row in rows] == list(enumerate(names))
    asked = judged_rows([(n, name) for n, name in enumerate(names)], BatchQuestion(base=piles))
    assert [row["verdict"] for row in rows] == [row["verdict"] for row in asked]
    assert not [path for path in folder.iterdir() if path.name.startswith(".part")]


@pytest.fixture(autouse=True)
def tables_are_csv(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether pyarrow is there or not."""
    import importlib.util

    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "pyarrow" else find(name)
    )


def begun(piles: Path, folder: Path, chunk: int = 2, **more: Any) -> subprocess.Popen[str]:
    """A run of the command in a process of its own, tables as CSV."""
    code = (
        "import sys, importlib.util; find = importlib.util.find_spec; "
        "importlib.util.find_spec = lambda n, *m: None if n == 'pyarrow' else find(n, *m); "
        "from kilter.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    words = ["batch", str(piles), "-o", str(folder), "--chunk", str(chunk), "--processes", "2"]
    return subprocess.Popen(
        [sys.executable, "-c", code, *words], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL,
        text=True, **more,
    )  # fmt: skip


def ended(run: subprocess.Popen[str]) -> tuple[int, str]:
    """Its exit code, and what it said."""
    _, said = run.communicate(timeout=120)
    return run.returncode, said


def children(process: subprocess.Popen[str]) -> list[int]:
    path = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    return [int(pid) for pid in path.read_text().split()] if path.exists() else []


def until(ready: Any, seconds: float = 60.0) -> bool:
    """Wait for something; whether it came."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if ready():
            return True
        time.sleep(0.01)
    return False


@pytest.mark.slow
def test_rows_are_the_verdicts_of_check_and_a_bad_file_is_a_row(piles, tmp_path, capsys):
    words = ["batch", str(piles), "-o", str(tmp_path / "out"), "--chunk", "10", "--processes", "1"]
    assert main(words) == 1
    assert "24 rows in 3 files" in capsys.readouterr().out
    require_whole(piles, tmp_path / "out")
    rows = rows_of(tmp_path / "out")
    assert list(rows[0]) == list(COLUMNS)
    for row in rows[:4]:
        verdict = kilter.check(kilter.load(piles / row["file"]))
        assert (row["verdict"], row["level"]) == (verdict.verdict, verdict.level or "")
        assert row["stable"] == str(verdict.stable)
    assert rows[-1]["verdict"] == "error"
    assert rows[-1]["error"].startswith("not JSON")
    assert main([*words, "--json"]) == 1
    again = json.loads(capsys.readouterr().out)
    assert (again["rows"], again["found_there"], len(again["errors"])) == (24, 24, 1)
    assert main([*words, "--friction", "0.3"]) == 2
    assert "has another batch" in capsys.readouterr().err


@pytest.mark.slow
def test_a_list_names_files_beside_it_and_options_reach_them(piles, tmp_path):
    listed = tmp_path / "some.txt"
    first = os.path.relpath(piles / "pile-1.kilter.json", tmp_path)
    listed.write_text(f"# two\n{first}\n\n{first}\n")
    found = kilter.batch(listed, tmp_path / "out", processes=1, down=[1, 0, 0])
    assert found.counts == {"unstable": 2}
    assert [row["file"] for row in rows_of(tmp_path / "out")] == [first] * 2
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="it contains no assembly; subfolders are not searched"):
        kilter.batch(tmp_path / "empty", tmp_path / "other")
    with pytest.raises(InputError, match="is an assembly, not a list"):
        kilter.batch(piles / "pile-1.kilter.json", tmp_path / "other")
    with pytest.raises(InputError, match="no such file"):
        kilter.batch(tmp_path / "none", tmp_path / "other")
    with pytest.raises(InputError, match="contains the files to check"):
        kilter.batch(piles, piles)
    (tmp_path / "barred" / ".batch.lock").mkdir(parents=True)  # where the lock should be
    with pytest.raises(InputError, match="cannot be written"):
        kilter.batch(listed, tmp_path / "barred")
    with pytest.raises(InputError, match="processes is 0"):
        kilter.batch(listed, tmp_path / "out", processes=0)
    with pytest.raises(InputError, match="chunk is 0"):
        kilter.batch(listed, tmp_path / "out", chunk=0)


@pytest.mark.slow
def test_damaged_rows_are_told_and_never_counted(piles, tmp_path):
    kilter.batch(piles, tmp_path, chunk=12, processes=1)
    part = tmp_path / "part-000001.csv"
    part.write_text("".join(part.read_text().splitlines(keepends=True)[:-1]))
    with pytest.raises(InputError, match="holds other rows"):
        kilter.batch(piles, tmp_path, chunk=12, processes=1)
    part.unlink()
    kilter.batch(piles, tmp_path, chunk=12, processes=1)
    require_whole(piles, tmp_path)


@pytest.mark.slow
def test_an_assembly_that_kills_is_found_and_has_a_row(piles, tmp_path, monkeypatch):
    deadly = (
        "import sys, os; sys.path[:] = {path!r}; import kilter.analysis.many.batch_rows as w; "
        "judged = w.judged_rows; "
        "w.judged_rows = lambda files, question: "
        "os.kill(os.getpid(), 9) if any('pile-5.' in f for _, f in files) "
        "else judged(files, question); w.serve()"
    )
    monkeypatch.setattr(pipes, "_SERVE", deadly)
    found = kilter.batch(piles, tmp_path, chunk=4, processes=2)
    assert [entry.file for entry in found.errors if entry.error == KILLED] == ["pile-5.kilter.json"]
    rows = rows_of(tmp_path)
    assert [int(row["index"]) for row in rows] == list(range(FILES))
    assert [row["file"] for row in rows if row["verdict"] == "error"] == [
        "pile-5.kilter.json", "wrong.json",
    ]  # fmt: skip


@pytest.mark.slow
def test_workers_that_do_not_come_up_blame_no_assembly(piles, tmp_path, monkeypatch):
    monkeypatch.setattr(pipes, "_SERVE", "raise SystemExit({path!r})")
    with pytest.raises(KilterError, match="no worker process starts"):
        kilter.batch(piles, tmp_path, processes=2)
    assert not list(tmp_path.glob("*part-*"))


@POSIX
@pytest.mark.slow
def test_a_killed_worker_costs_no_row_and_blames_none(piles, tmp_path):
    run = begun(piles, tmp_path)
    assert until(lambda: children(run))
    os.kill(children(run)[0], signal.SIGKILL)
    assert ended(run)[0] == 1
    require_whole(piles, tmp_path)


@pytest.mark.slow
def test_tables_are_the_same_bytes_with_any_number_of_processes(piles, tmp_path):
    for count in (1, 3):
        kilter.batch(piles, tmp_path / str(count), chunk=5, processes=count)
    for part in sorted((tmp_path / "1").glob("part-*")):
        assert part.read_bytes() == (tmp_path / "3" / part.name).read_bytes()


@POSIX
@pytest.mark.slow
def test_a_run_that_is_killed_eight_times_at_random_ends_whole(piles, tmp_path):
    random = np.random.default_rng(7)
    for seconds in random.uniform(0.0, 3.0, 8):
        run = begun(piles, tmp_path)
        time.sleep(float(seconds))
        left = children(run)
        run.kill()
        ended(run)
        assert until(
            lambda left=left: not any(Path(f"/proc/{pid}/cmdline").exists() for pid in left)
        )
    assert ended(begun(piles, tmp_path))[0] == 1
    require_whole(piles, tmp_path)


@POSIX
@pytest.mark.slow
def test_an_interrupted_run_ends_within_a_second_and_goes_on_where_it_was(piles, tmp_path):
    run = begun(piles, tmp_path)
    assert until(lambda: children(run))
    asked = time.monotonic()
    run.send_signal(signal.SIGINT)
    code, said = ended(run)
    assert (code, said.strip()) == (130, "kilter: interrupted")
    assert time.monotonic() - asked < 5.0  # a second where the machine is quiet
    assert ended(begun(piles, tmp_path))[0] == 1
    require_whole(piles, tmp_path)


@POSIX
@pytest.mark.slow
def test_a_full_disk_is_told_and_what_is_there_stays(piles, tmp_path):
    import resource

    def no_room() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (400, 400))

    code, said = ended(begun(piles, tmp_path, 8, preexec_fn=no_room))
    assert code == 2
    assert "cannot be written" in said
    assert len(said.splitlines()) == 1
    assert not list(tmp_path.glob("*part-*"))
    assert ended(begun(piles, tmp_path, 8))[0] == 1
    require_whole(piles, tmp_path)


@pytest.fixture(params=["tmpfs", "ext4"])
def disk(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Path]:
    """A small file system of its own, where one may be mounted."""
    place, image = tmp_path / "disk", tmp_path / "image"
    place.mkdir()
    mount = ["mount", "-t", request.param, "-o"]
    if request.param == "tmpfs":
        mount += ["size=1m", "tmpfs", str(place)]
    else:
        image.write_bytes(bytes(2**21))
        mount += ["loop", str(image), str(place)]
    try:
        if request.param == "ext4":
            subprocess.run(["mkfs.ext4", "-q", "-F", str(image)], check=True, capture_output=True)
        subprocess.run(mount, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("nothing may be mounted here")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


@POSIX
@pytest.mark.slow
@pytest.mark.parametrize("free", [0, 6])
def test_a_disk_that_fills_up_is_told_and_the_run_goes_on_when_there_is_room(piles, disk, free):
    ballast, out, block = disk / "ballast", disk / "out", os.statvfs(disk).f_frsize
    out.mkdir()
    with open(ballast, "wb", buffering=0) as stream, contextlib.suppress(OSError):
        while stream.write(bytes(block)):
            os.fsync(stream.fileno())
    os.truncate(ballast, max(0, ballast.stat().st_size // block - free) * block)
    code, said = ended(begun(piles, out, 2))
    assert code == 2
    assert "No space left on device" in said
    assert len(said.splitlines()) == 1
    there = rows_of(out)
    assert bool(there) is bool(free)
    assert len(there) < FILES
    ballast.unlink()
    assert ended(begun(piles, out, 2))[0] == 1
    require_whole(piles, out)


@pytest.mark.slow
def test_a_second_run_in_one_folder_is_refused(piles, tmp_path, capsys):
    files = listed_files(piles)[1]
    with open_folder(tmp_path, files, BatchQuestion(), size=1000):
        assert main(["batch", str(piles), "-o", str(tmp_path)]) == 2
        assert "another run is writing" in capsys.readouterr().err
    assert main(["batch", str(piles), "-o", str(tmp_path), "--processes", "1"]) == 1


@pytest.mark.slow
def test_tables_are_parquet_where_pyarrow_is(piles, tmp_path, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.undo()
    first = kilter.batch(piles, tmp_path, chunk=13, processes=1)
    assert [path.suffix for path in first.paths] == [".parquet"] * 2
    rows = [row for path in first.paths for row in parquet.read_table(path).to_pylist()]
    wanted = judged_rows(list(enumerate(listed_files(piles)[1])), BatchQuestion(base=piles))
    assert rows == wanted
    again = kilter.batch(piles, tmp_path, chunk=13, processes=1)
    assert (again.found_there, again.counts) == (FILES, first.counts)


@POSIX
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_cluster_that_loses_a_worker_finishes(piles, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        killed = []

        def kill_one(done: int, of: int) -> None:
            if done and not killed:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        found = kilter.batch(
            piles, tmp_path, chunk=1, cluster=cluster.scheduler_address, progress=kill_one
        )
    assert killed
    assert found.counts["error"] == 1
    require_whole(piles, tmp_path)


def test_no_scheduler_is_told(piles, tmp_path):
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match="no Dask scheduler answers"):
        kilter.batch(piles, tmp_path, cluster="nowhere")


def test_a_row_of_an_error_has_every_column():
    assert list(error_row(3, "a.json", "why")) == list(COLUMNS)


@pytest.mark.slow
def test_the_counts_of_a_run_are_those_of_its_tables(tmp_path, capsys):
    """A cube of .5 kg in the air, in millimetres: as it falls at 1 m/s it gains its weight [W]."""
    table = kilter.Part("table", kilter.Box([900, 900, 10]), [0, 0, -5], grounded=True)
    falls = kilter.Part("falls", kilter.Box([100] * 3), [0, 0, 90], density=500.0)
    listed = tmp_path / "in"
    listed.mkdir()
    kilter.dump(kilter.Assembly([table, falls], units="mm"), listed / "a.kilter.json")
    kilter.dump(kilter.example("tower"), listed / "b.kilter.json")
    (listed / "c.json").write_text("{")
    words = ["batch", str(listed), "-o", str(tmp_path / "out"), "--json", "--quiet"]
    assert main(words) == 1
    answer = json.loads(capsys.readouterr().out)
    rows = rows_of(tmp_path / "out")
    assert answer["rows"] == len(rows) == 3
    verdicts = [row["verdict"] for row in rows]
    assert verdicts == ["unstable", "stable", "error"]
    assert answer["counts"] == {verdict: verdicts.count(verdict) for verdict in verdicts}
    assert [row["parts"] for row in rows] == ["2", str(len(kilter.example("tower"))), ""]
    assert float(rows[0]["power"]) == pytest.approx(0.5 * 9.81)
    assert float(rows[0]["violation"]) == 0
    assert abs(float(rows[1]["residual"])) <= 1e-9
    assert answer["found_there"] == 0
    assert main(words) == 1
    assert json.loads(capsys.readouterr().out)["found_there"] == 3
