"""Many states of a scene: each at rest as by itself, written, continued, and simulated."""

import json
import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import InputError
from kilter.analysis.many import settle_states as module
from kilter.cli import main

mujoco = pytest.importorskip("mujoco")

HALF = 0.03
SCENE = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 .1"/>
    <body name="tray" pos="0 0 .01"><freejoint/>
      <geom type="box" size=".2 .2 .01"/><geom type="box" size=".01 .2 .05" pos=".2 0 .05"/></body>
    <body name="a" pos="0 0 .1"><freejoint/><geom type="box" size=".03 .03 .03"/></body>
    <body name="b" pos="0 .1 .1"><freejoint/><geom type="box" size=".03 .03 .03"/></body>
  </worldbody>
</mujoco>
"""


def scene(folder: Path, text: str = SCENE) -> Path:
    path = folder / "scene.xml"
    path.write_text(text)
    return path


def states(count: int, seed: int = 0) -> np.ndarray:
    """States with a tray on the floor and two boxes above it, side by side, or on each other."""
    rng = np.random.default_rng(seed)
    rows = np.zeros((count, 21))
    rows[:, [3, 10, 17]] = 1
    rows[:, 2] = 0.01
    rows[:, 7:10] = rng.uniform([-0.1, -0.1, 0.055], [0.1, -0.05, 0.12], (count, 3))
    rows[:, 14:17] = rng.uniform([-0.1, 0.05, 0.055], [0.1, 0.1, 0.12], (count, 3))
    rows[1::2, 14:16] = rows[1::2, 7:9]
    rows[1::2, 16] = rows[1::2, 9] + rng.uniform(0.065, 0.1, len(rows[1::2]))
    return rows


def expected(rows: np.ndarray) -> np.ndarray:
    """The states at rest: boxes of height .06 on the tray, whose top is at .02."""
    rest = rows.copy()
    rest[:, 9] = 0.02 + HALF
    rest[:, 16] = np.where(np.arange(len(rows)) % 2, 0.02 + 3 * HALF, 0.02 + HALF)
    return rest


def drift(path: Path, qpos: np.ndarray) -> float:
    """Largest way of a body in 2 s of MuJoCo [m]."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    start = data.xpos.copy()
    while data.time < 2:
        mujoco.mj_step(model, data)
    return float(np.linalg.norm(data.xpos - start, axis=1).max())


@pytest.mark.slow
def test_boxes_above_a_tray_come_to_rest_on_it_and_stay_in_the_simulator(tmp_path):
    path, rows = scene(tmp_path), states(4)
    answer = kilter.settle_states(path, rows)
    assert answer.at_rest
    assert answer.counts == {"at-rest": 4}
    assert (answer.free, answer.rests, answer.found_there) == (12, 12, 0)
    assert np.allclose(answer.qpos, expected(rows), rtol=0, atol=1e-8)
    for k, row in enumerate(answer.states):
        drop = rows[k] - expected(rows)[k]
        assert row.moved == pytest.approx(max(drop[9], drop[16]), abs=1e-8)
        assert (row.index, row.farthest) == (k, "ab"[int(drop[16] > drop[9])])
        assert drift(path, answer.qpos[k]) < 1e-3


def test_full_states_keep_their_form_and_lose_their_velocities(tmp_path):
    path, rows = scene(tmp_path), states(2)
    full = np.hstack([np.full((2, 1), 7.0), rows, np.ones((2, 18))])
    answer = kilter.settle_states(mujoco.MjModel.from_xml_path(str(path)), full)
    assert np.allclose(answer.rows[:, 1:22], expected(rows), rtol=0, atol=1e-8)
    assert (answer.rows[:, 0] == 7).all()
    assert not answer.rows[:, 22:].any()


def test_a_hinge_and_a_slide_keep_up_with_their_bodies(tmp_path):
    """Positions of joints after a motion of parts, by the kinematics of MuJoCo."""
    from kilter.files.format_options import FormatOptions
    from kilter.files.objects.state_scenes import open_scene

    text = """
    <mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body name="base" pos=".1 .2 1" euler="10 20 30"><freejoint/>
        <geom type="box" size=".1 .1 .1"/>
        <body name="door" pos=".3 0 0" euler="0 40 0"><joint axis="1 2 3" pos=".1 0 0"/>
          <geom type="box" size=".1 .1 .1"/>
          <body name="drawer" pos=".3 .1 0"><joint type="slide" axis="0 1 1"/>
            <geom type="box" size=".1 .1 .1"/></body>
          <body name="ball" pos="0 .4 0" euler="5 6 7"><joint type="ball"/>
            <geom type="box" size=".1 .1 .1"/></body></body></body>
    </worldbody></mujoco>
    """
    model = mujoco.MjModel.from_xml_path(str(scene(tmp_path, text)))
    data = mujoco.MjData(model)
    rng = np.random.default_rng(1)
    opened = open_scene(model, FormatOptions())
    drawn = opened.assembly()
    wanted = np.array(model.qpos0) + rng.normal(size=model.nq) / 5
    data.qpos[:] = wanted
    mujoco.mj_normalizeQuat(model, data.qpos)
    mujoco.mj_kinematics(model, data)
    names = ("base", "door", "drawer", "ball")
    poses = {n: kilter.Pose(data.body(n).xpos, data.body(n).xquat) for n in names}
    found = opened.positions(drawn, drawn.with_poses(poses))
    data_again = mujoco.MjData(model)
    data_again.qpos[:] = found
    mujoco.mj_kinematics(model, data_again)
    assert np.allclose(data_again.xpos, data.xpos, rtol=0, atol=1e-12)
    assert np.allclose(data_again.xmat, data.xmat, rtol=0, atol=1e-12)


def test_an_object_that_leaves_is_named_and_the_others_rest(tmp_path):
    text = SCENE.replace('type="plane" size="2 2 .1"', 'type="box" size=".5 .5 .1" pos="0 0 -.1"')
    rows = states(2)
    rows[0, 7:10] = 3, 0, 1
    answer = kilter.settle_states(scene(tmp_path, text), rows)
    first, second = answer.states
    assert (first.state, first.leaves, first.rests, first.free) == ("partly", ("a",), 2, 3)
    assert second.state == "at-rest"
    assert answer.qpos[0, 7:10].tolist() == [3, 0, 1]
    assert answer.qpos[0, 16] == pytest.approx(0.02 + HALF, abs=1e-8)


def test_an_error_of_a_state_does_not_stop_the_others(tmp_path, monkeypatch, capsys):
    from kilter.analysis.many import state_rows

    path, rows = scene(tmp_path), states(3)
    np.save(tmp_path / "S.npy", rows)
    real, calls = state_rows.settle, []

    def failing(*given: object, **named: object) -> object:
        calls.append(1)
        if len(calls) == 2:
            raise InputError("a fault", part="a", hint="mend it")
        return real(*given, **named)

    monkeypatch.setattr(state_rows, "settle", failing)
    words = [
        "settle",
        str(path),
        "--states",
        str(tmp_path / "S.npy"),
        "-o",
        str(tmp_path / "R.npy"),
    ]
    assert main([*words, "--json", "--quiet"]) == 1
    answer = json.loads(capsys.readouterr().out)
    assert [row["state"] for row in answer["states"]] == ["at-rest", "error", "at-rest"]
    assert "a fault" in answer["states"][1]["why"]
    new = np.load(tmp_path / "R.npy")
    assert np.array_equal(new[1], rows[1])
    assert np.allclose(new[[0, 2]], expected(rows)[[0, 2]], rtol=0, atol=1e-8)


def test_the_time_limit_is_that_of_each_state(tmp_path):
    answer = kilter.settle_states(scene(tmp_path), states(2), time_limit=0.0)
    assert [(row.state, row.why) for row in answer.states] == [
        ("not-found", "the time limit was reached")
    ] * 2
    assert np.array_equal(answer.qpos, states(2))


def test_an_interrupted_run_continues(tmp_path, monkeypatch):
    path, out, rows = scene(tmp_path), tmp_path / "R.npy", states(4)
    journal = tmp_path / "R.npy.rows"
    real, calls = module.settled_rows, []

    def interrupted(*given: object) -> object:
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return real(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "settled_rows", interrupted)
    with pytest.raises(KeyboardInterrupt):
        kilter.settle_states(path, rows, output=out)
    assert not out.exists()
    with journal.open("ab") as stream:
        stream.write(b'{"index": 2, "sta')  # as of a run that is killed while it writes
    with pytest.raises(InputError, match="holds rows of another run; remove it, or give another"):
        kilter.settle_states(path, rows + 1e-3, output=out)
    answer = kilter.settle_states(path, rows, output=out)
    assert answer.found_there == 2
    assert len(calls) == 5
    assert np.allclose(np.load(out), expected(rows), rtol=0, atol=1e-8)
    assert not journal.exists()


@pytest.mark.slow
def test_worker_processes_give_the_same_rows(tmp_path):
    path, rows = scene(tmp_path), states(4)
    alone, together = (kilter.settle_states(path, rows, processes=n) for n in (1, 2))
    assert np.array_equal(alone.qpos, together.qpos)
    same = [{**row.to_dict(), "seconds": 0} for row in alone.states]
    assert [{**row.to_dict(), "seconds": 0} for row in together.states] == same


def test_the_command_prints_a_row_for_each_state_of_a_benchmark_file(tmp_path, capsys):
    path, rows = scene(tmp_path), states(2)
    given = tmp_path / "task.pruned_init"
    with zipfile.ZipFile(given, "w") as made:
        full = np.hstack([np.zeros((2, 1)), rows, np.zeros((2, 18))])
        made.writestr("archive/data.pkl", pickle.dumps(full, protocol=2))
    assert main(["settle", str(path), "--states", str(given)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "2 of 2 states at rest; 6 of 6 objects at rest."
    assert lines[2].split("  ")[0] == "state"
    assert [line.split()[:2] for line in lines[3:]] == [["0", "at-rest"], ["1", "at-rest"]]


FIXED = '<mujoco><worldbody><geom size="1"/></worldbody></mujoco>'
LOOSE = '<mujoco><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>'
WRONG = {
    "another length": (SCENE, np.ones((2, 5)), [], "a state has 5 numbers, but a state of the mod"),
    "no joint": (FIXED, np.ones((2, 5)), [], "the model has no joint; give a body a free joint"),
    "no static body": (LOOSE, np.eye(7)[3:4], [], "no body of the scene is static, so nothing sup"),
    "an unknown part": (SCENE, states(1), ["--keep", "c"], "no part is named 'c'"),
    "a scene as output": (SCENE, states(1), ["-o", "x.xml"], "states are written to a NumPy file"),
    "a proof": (SCENE, states(1), ["--proof", "p.json"], "--proof is that of one state"),
    "a state beside": (SCENE, states(1), ["--state", "S.npy"], "state and states are both given"),
    "no process": (SCENE, states(1), ["--processes", "0"], "processes is 0; give a whole number"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_is_a_sentence(name, tmp_path, capsys, monkeypatch):
    text, rows, words, sentence = WRONG[name]
    monkeypatch.chdir(tmp_path)
    scene(tmp_path, text)
    np.save("S.npy", rows)
    assert main(["settle", "scene.xml", "--states", "S.npy", *words]) == 2
    out, error = capsys.readouterr()
    assert sentence in error
    assert (out, error.count("\n")) == ("", 1)


def test_a_floor_of_a_given_height_supports_states_without_a_static_body(tmp_path):
    rows = np.array([[0, 0, height, 1, 0, 0, 0] for height in (0.1, 0.3)])
    answer = kilter.settle_states(scene(tmp_path, LOOSE), rows, floor=-0.2)
    assert answer.qpos[:, 2] == pytest.approx(-0.1, abs=1e-9)


def test_states_of_another_file_are_refused(tmp_path):
    kilter.dump(kilter.example("tower"), tmp_path / "t.kilter.json")
    with pytest.raises(InputError, match="states belong to an MJCF scene, and this is another"):
        kilter.settle_states(tmp_path / "t.kilter.json", states(1))
    with pytest.raises(InputError, match="states belong to a MuJoCo model, not to int"):
        kilter.settle_states(3, states(1))
