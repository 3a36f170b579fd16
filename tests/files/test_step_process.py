"""STEP read ahead in a separate process: the answer belongs to the right file and state."""

from __future__ import annotations

import os

import pytest

pytest.importorskip("OCP")

from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from step_maker import placement, write_step

from kilter.cli import main
from kilter.errors import InputError
from kilter.files import step_process
from kilter.files.step import read_step


def box(path, *size):
    """Write a STEP file of a box."""
    write_step(path, [("block", BRepPrimAPI_MakeBox(*size).Shape(), placement())])
    return path


def depth(found):
    return float(found.shapes[0].vertices[:, 2].max())


@pytest.fixture
def fresh():
    step_process._end()
    yield
    step_process._end()


@pytest.mark.slow
def test_what_is_read_ahead_is_what_is_asked_for(fresh, tmp_path):
    path = box(tmp_path / "one.step", 1.0, 2.0, 3.0)
    step_process.begin_early(path)
    process = step_process._kept[0]
    assert process.ahead is not None
    assert depth(read_step(path)) == pytest.approx(3.0)
    assert step_process._kept == [process]
    assert process.ahead is None
    assert depth(read_step(path)) == pytest.approx(3.0)  # the file is requested again


@pytest.mark.slow
def test_another_file_and_another_state_of_it_are_read_anew(fresh, tmp_path):
    one, other = (box(tmp_path / f"{n}.step", 1.0, 2.0, n) for n in (3.0, 4.0))
    step_process.begin_early(one)
    assert depth(read_step(other)) == pytest.approx(4.0)
    step_process._end()
    step_process.begin_early(one)
    box(one, 1.0, 2.0, 5.0)
    os.utime(one, ns=(1, 1))
    assert depth(read_step(one)) == pytest.approx(5.0)
    step_process._end()
    step_process.begin_early(one)
    left_out = read_step(one, without=("block",))
    assert left_out.left_out == ("block",)


@pytest.mark.slow
def test_a_file_that_is_refused_leaves_nothing_behind(fresh, tmp_path):
    bad, good = tmp_path / "bad.step", box(tmp_path / "good.step", 1.0, 2.0, 3.0)
    bad.write_text(good.read_text().replace("END-ISO-10303-21", ""))
    step_process.begin_early(bad)
    with pytest.raises(InputError, match="incomplete"):
        read_step(bad)
    assert depth(read_step(good)) == pytest.approx(3.0)


@pytest.mark.parametrize("word", ["missing.step", "x" * 5000 + ".step"])
def test_a_name_that_is_no_file_starts_nothing(fresh, word, capsys):
    assert main(["check", word, "--floor"]) == 2
    assert step_process._kept == []
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.slow
def test_what_comes_to_no_end_is_tried_once_more_and_refused(fresh, tmp_path, monkeypatch):
    path = box(tmp_path / "one.step", 1.0, 2.0, 3.0)
    made = []
    start = step_process.ReaderProcess
    monkeypatch.setattr(
        step_process, "ReaderProcess", lambda module: made.append(module) or start(module)
    )
    with monkeypatch.context() as short:
        short.setattr(step_process, "STALLS", 1e-4)
        short.setattr(step_process, "STALLS_PER_MEGABYTE", 0.0)
        with pytest.raises(InputError, match="OCCT crashes on it"):
            read_step(path)
    assert len(made) == 2
    assert depth(read_step(path)) == pytest.approx(3.0)
