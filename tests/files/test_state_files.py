"""Files of states: arrays in every form that simulators and PyTorch write, and nothing else."""

import io
import os
import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import InputError
from kilter.cli import main
from kilter.files.objects.state_files import read_states, state_row

ROWS = np.arange(12.0).reshape(3, 4) / 7
PROTOCOLS = range(2, 6)


def archive(data: bytes, **more: bytes) -> bytes:
    """An archive of PyTorch with a pickle and other files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as made:
        made.writestr("archive/data.pkl", data)
        made.writestr("archive/version", "3\n")
        for name, content in more.items():
            made.writestr(f"archive/data/{name}", content)
    return stream.getvalue()


def saved(values: object, **words: object) -> bytes:
    stream = io.BytesIO()
    np.save(stream, values, **words)  # type: ignore[arg-type]
    return stream.getvalue()


def written(folder: Path, data: bytes) -> Path:
    path = folder / "states.bin"
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("protocol", PROTOCOLS)
@pytest.mark.parametrize(
    "values",
    [ROWS, np.asfortranarray(ROWS), ROWS.astype(">f8"), ROWS.astype("f4"), list(ROWS)],
    ids=["C", "Fortran", "big-endian", "float32", "list"],
)
def test_a_pickled_array_is_read_from_each_protocol(values, protocol, tmp_path):
    data = pickle.dumps(values, protocol=protocol)
    wanted = np.array(values, dtype=float)
    assert np.array_equal(read_states(written(tmp_path, data)), wanted)
    assert np.array_equal(read_states(written(tmp_path, archive(data))), wanted)


def test_numpy_files_are_read(tmp_path):
    several = io.BytesIO()
    np.savez_compressed(several, states=ROWS)
    for data in (saved(ROWS), saved(np.asfortranarray(ROWS)), several.getvalue()):
        assert np.array_equal(read_states(written(tmp_path, data)), ROWS)
    assert np.array_equal(read_states(written(tmp_path, saved(ROWS[1]))), ROWS[1:2])


def test_a_tensor_of_pytorch_is_read(tmp_path):
    """The opcodes that `torch.save` writes for a tensor of three rows."""
    text = (
        b"\x80\x02ctorch._utils\n_rebuild_tensor_v2\n((X\x07\x00\x00\x00storagectorch\n"
        b"DoubleStorage\nX\x01\x00\x00\x000X\x03\x00\x00\x00cpuK\x0ctQK\x00K\x03K\x04\x86"
        b"K\x04K\x01\x86\x89ccollections\nOrderedDict\n)RtR."
    )
    data = archive(text, **{"0": ROWS.tobytes()})
    assert np.array_equal(read_states(written(tmp_path, data)), ROWS)


class Call:
    """An object whose pickle calls a function."""

    def __init__(self, *call: object) -> None:
        self.call = call

    def __reduce__(self) -> tuple[object, object]:
        return self.call[0], tuple(self.call[1:])


HUGE = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000, 4), }"
ONLY = "only arrays of numbers are read from a pickle"
WRONG = {
    "a call of the system": (pickle.dumps(Call(os.system, "touch here")), f"system; {ONLY}"),
    "a call in an archive": (archive(pickle.dumps(Call(eval, "1"))), f"eval; {ONLY}"),
    "a call in an object array": (
        pickle.dumps(np.array([Call(os.getcwd)], dtype=object)),
        f"do not hold plain numbers; {ONLY}",
    ),
    "a changed maker": (b"\x80\x02cnumpy\ndtype\n}b.", f"changes a function; {ONLY}"),
    "a dict": (pickle.dumps({"states": ROWS}), f"something else than an array; {ONLY}"),
    "a text": (pickle.dumps("states"), f"something else than an array; {ONLY}"),
    "a cut pickle": (pickle.dumps(ROWS)[:-40], "the pickle is damaged: "),
    "a large claim": (b"\x80\x05\x96" + b"\xff" * 7 + b"\x00.", "the pickle is cut off"),
    "a cut archive": (archive(pickle.dumps(ROWS))[:-30], "damaged: File is not a zip file"),
    "another archive": (archive(b"")[:0] + b"PK\x03\x04", "damaged: File is not a zip file"),
    "a large header": (
        b"\x93NUMPY\x01\x00" + (118).to_bytes(2, "little") + HUGE.ljust(117) + b"\n",
        "the file is damaged: cannot reshape",
    ),
    "objects": (saved(np.array([None]), allow_pickle=True), "holds object and no numbers"),
    "three axes": (saved(ROWS[None]), r"the states have the shape \(1, 3, 4\)"),
    "no rows": (saved(ROWS[:0]), r"the states have the shape \(0, 4\)"),
    "an infinite number": (saved(ROWS + np.inf), "state 0 has a number that is not finite"),
    "a text file": (b"1 2 3\n", "neither a NumPy file nor a pickle"),
}


@pytest.mark.parametrize("name", WRONG)
def test_other_content_is_a_sentence_and_is_never_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    data, words = WRONG[name]
    path = written(tmp_path, data)
    with pytest.raises(InputError, match=words):
        read_states(path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["states.bin"]


def test_a_row_is_named_by_its_number(tmp_path):
    path = written(tmp_path, saved(ROWS))
    assert np.array_equal(state_row(str(path)).rows, ROWS[:1])
    assert np.array_equal(state_row(f"{path}:2").rows, ROWS[2:])
    assert np.array_equal(state_row(f"{path}:-1").rows, ROWS[2:])
    with pytest.raises(InputError, match="there is no state 3; the states are 0 to 2"):
        state_row(f"{path}:3")


SCENE = """
<mujoco><worldbody><geom name="floor" type="plane" size="2 2 .1"/>
<body name="a" pos="0 0 .05"><freejoint/><geom type="box" size=".03 .03 .03"/></body>
<body name="arm" pos="1 0 .5"><joint type="hinge" axis="0 0 1"/><geom type="box" size=".1 .1 .1"/>
</body></worldbody></mujoco>
"""


def test_every_command_reads_a_state(tmp_path, capsys):
    pytest.importorskip("mujoco")
    scene, states = tmp_path / "s.xml", tmp_path / "S.npy"
    scene.write_text(SCENE)
    qpos = np.array([[0, 0, 0.05, 1, 0, 0, 0, 0.0], [0.3, 0, 0.03, 1, 0, 0, 0, 0.5]])
    np.save(states, qpos)
    first, second = (kilter.load(scene, state=f"{states}:{k}") for k in (0, 1))
    assert first["a"].pose.position.tolist() == [0, 0, 0.05]
    assert second["a"].pose.position.tolist() == [0.3, 0, 0.03]
    turn = second["arm"].pose.rotation
    assert np.allclose(turn, [np.cos(0.25), 0, 0, np.sin(0.25)])
    # time, qpos, qvel is the same state
    np.save(states, np.hstack([np.ones((2, 1)), qpos, np.ones((2, 7))]))
    assert kilter.load(scene, state=f"{states}:1")["a"].pose == second["a"].pose
    # choices keep the state, relative to their place
    (tmp_path / "deeper").mkdir()
    assert main(["save", str(scene), "--state", f"{states}:1", "-o", f"{tmp_path}/c.json"]) == 0
    assert '"state": "S.npy:1"' in (tmp_path / "c.json").read_text()
    assert kilter.load(tmp_path / "c.json")["a"].pose == second["a"].pose
    # a given keyframe replaces a saved state
    scene.write_text(SCENE.replace("</mujoco>", f"<keyframe>{KEY}</keyframe></mujoco>"))
    keyed = kilter.load(tmp_path / "c.json", keyframe="k")
    assert keyed["a"].pose.position.tolist() == [0, 0, 2]
    assert any('keyframe "k" replaces state' in note for note in keyed.notes)
    capsys.readouterr()


KEY = '<key name="k" qpos="0 0 2 1 0 0 0 0"/>'


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--state", "W.npy"], "a state has 3 numbers, but a state of the model has 8 (qpos), 15 "),
        (["--state", "W.npy", "--keyframe", "k"], "state and keyframe are both given"),
        (["--state", "none.npy"], "none.npy: no such file"),
    ],
)
def test_a_wrong_state_is_a_sentence(words, sentence, tmp_path, capsys, monkeypatch):
    pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)
    Path("s.xml").write_text(SCENE)
    np.save("W.npy", np.ones(3))
    assert main(["check", "s.xml", *words]) == 2
    error = capsys.readouterr().err
    assert sentence in error
    assert error.count("\n") == 1


def test_a_state_of_another_format_is_a_sentence(tmp_path, capsys):
    np.save(tmp_path / "S.npy", ROWS)
    kilter.dump(kilter.example("tower"), tmp_path / "t.kilter.json")
    words = ["check", f"{tmp_path}/t.kilter.json", "--state", f"{tmp_path}/S.npy"]
    assert main(words) == 2
    assert "states belong to an MJCF scene, and this is another file" in capsys.readouterr().err
