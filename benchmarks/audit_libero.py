"""Audit of the start states of a robot benchmark: LIBERO, or any folder of scenes with states.

    python benchmarks/audit_libero.py FOLDER --rows 1        the first state of each task
    python benchmarks/audit_libero.py FOLDER                 all states
    python benchmarks/audit_libero.py FOLDER --engine OLD/bin/python --engine NEW/bin/python
    python benchmarks/audit_libero.py FOLDER --table         the table of what is done

The folder is not shipped. For each task it has TASK.xml, an MJCF file that MuJoCo compiles, and
TASK.npy with a state in each row, (time, positions, velocities) or positions alone. The docs state
how to write both from LIBERO (docs/explanation/benchmark-states.md).

For each state, the audit measures

    stored   how far each object moves in 2 s of simulation from the state as stored
    kilter   whether each object is at rest, its largest way there, and CPU seconds
    rest     how far each object moves in 2 s from the pose at rest

An object is a body with a free joint. `--engine` names an interpreter with NumPy and MuJoCo; each
runs `drift_of_states.py` in a process of its own, so that versions can be compared. Without it, the
interpreter of the audit simulates. If an object at rest moves by more than `DRIFT`, the pose is
simulated again with a time step `FINER` times as short, and without the creep of soft friction. The
table states this movement, and whether the engine had a contact outside of the object, which is a
fault of its collision detection. Results are stored
under FOLDER/audit as soon as they are known, and an interrupted audit continues: a state is not
settled twice, unless `--again` is given, and a pose is not simulated twice by the same version. The
exit code is 1 if an object that is reported at rest moves by more than `DRIFT` for none of these
two reasons.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

import kilter

Array = NDArray[np.float64]
DRIFT = 1e-4
"""Displacement above which an object reported at rest is listed [m]."""
FINER = 20.0
"""Divisor of the time step in the second simulation of a pose in which an object moves [-]."""
FINE_SECONDS = 0.5
"""Duration of this simulation [s]: a slip begins at once, and the steps are many."""
PATIENCE = 120.0
"""Time limit of kilter for a state [s]."""
CHUNK = 5
"""Number of states between two reports; an interruption loses at most so many."""
ENGINE = Path(__file__).with_name("drift_of_states.py")


@dataclass(frozen=True)
class Task:
    """A scene with its states, and the files of its results."""

    name: str
    scene: Path
    states: Array
    """Positions of the joints; shape (n, nq)."""
    objects: tuple[str, ...]
    """Bodies with a free joint."""
    places: NDArray[np.int64]
    """Index of the position of each object in a row."""
    results: Path

    def settled(self) -> dict[int, dict[str, Any]]:
        """The answers of kilter until now, by the row of the state."""
        lines = _lines(self.results / f"{self.name}.settled.jsonl")
        return {line["row"]: line for line in lines}

    def drifts(self, version: str, step: str = "drift") -> dict[str, dict[str, Any]]:
        """Results of a version of MuJoCo, by the key of the first pose.

        `moved`: displacements [m] of objects; `outside`: objects with a false contact. `step`:
        "drift", or "finer" for those of the shorter time step.
        """
        lines = _lines(self.results / f"{self.name}.{step}-{version}.jsonl")
        return {line["pose"]: line for line in lines}

    def moving(self, row: int, version: str) -> dict[str, float]:
        """Objects that are reported at rest in a state, and move in a version of MuJoCo [m]."""
        line = self.settled()[row]
        moved = self.drifts(version).get(_key(np.array(line["qpos"])), {"moved": {}})["moved"]
        return {
            n: far for n, far in moved.items() if line["states"].get(n) == "at-rest" and far > DRIFT
        }


def read_task(scene: Path, results: Path) -> Task:
    """Read the scene and the states of a task."""
    model = mujoco.MjModel.from_xml_path(str(scene))
    rows = np.load(scene.with_suffix(".npy"))
    if rows.shape[1] != model.nq:
        if rows.shape[1] != 1 + model.nq + model.nv + model.na:
            raise SystemExit(f"{scene.stem}: states of {rows.shape[1]} numbers do not fit")
        rows = rows[:, 1 : 1 + model.nq]
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    names = tuple(model.body(body).name for body in model.jnt_bodyid[free])
    places = model.jnt_qposadr[free].astype(np.int64)
    return Task(scene.stem, scene, rows, names, places, results)


def _lines(path: Path) -> list[dict[str, Any]]:
    """The complete lines of a file of results; an interrupted writer may leave a broken one."""
    lines = []
    for line in path.read_text().splitlines() if path.exists() else ():
        try:
            lines.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return lines


def _append(path: Path, line: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a") as file:
        file.write(json.dumps(line) + "\n")


def _key(state: Array) -> str:
    """A short name of a pose."""
    return hashlib.sha256(np.ascontiguousarray(state).tobytes()).hexdigest()[:16]


# kilter ----------------------------------------------------------------------------------------


def settle(task: Task, rows: list[int]) -> Iterator[dict[str, Any]]:
    """Bring states to rest, a few at a time, and yield a line of results for each."""
    for first in range(0, len(rows), CHUNK):
        some = rows[first : first + CHUNK]
        clock: list[float] = []
        answer = kilter.settle_states(
            task.scene,
            task.states[some],
            ease=True,
            time_limit=PATIENCE,
            progress=lambda done, of, clock=clock: clock.append(time.process_time()),
        )
        for k, row in enumerate(some):
            yield _line(task, row, answer.states[k], answer.qpos[k]) | {
                "cpu": clock[k + 1] - clock[k]
            }


def _line(task: Task, row: int, found: Any, rest: Array) -> dict[str, Any]:
    """The results of kilter for a state."""
    states = dict.fromkeys(task.objects, "at-rest" if found.rests else found.state)
    states |= dict.fromkeys(set(found.parts) & set(states), "no pose")
    states |= dict.fromkeys(set(found.leaves) & set(states), "leaves")
    places = task.places[:, None] + np.arange(3)
    far = np.linalg.norm(rest[places] - task.states[row][places], axis=1)
    moved = dict(zip(task.objects, far.tolist(), strict=True))
    return {
        "row": row,
        "states": states,
        "level": found.level,
        "why": found.why,
        "moved": moved,
        "qpos": rest.tolist(),
    }


# MuJoCo ----------------------------------------------------------------------------------------


def simulate(
    task: Task, interpreter: str, version: str, states: list[Array], step: str = "drift"
) -> None:
    """Simulate poses that this version of MuJoCo has not simulated yet, and store the drifts.

    `step`: as of `Task.drifts`.
    """
    known = task.drifts(version, step)
    todo = {_key(state): state for state in states if _key(state) not in known}
    if not todo:
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "states.npy"
        np.save(path, np.array(list(todo.values())))
        finer = FINER if step == "finer" else 1.0
        command = [interpreter, str(ENGINE), str(task.scene), str(path), "--finer", f"{finer}"]
        command += ["--seconds", f"{FINE_SECONDS if step == 'finer' else 2.0}"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            # MuJoCo prints its warnings among the results
            results = (line for line in process.stdout if line.startswith("{"))
            for key, line in zip(todo, results, strict=False):
                result = json.loads(line)
                target = task.results / f"{task.name}.{step}-{version}.jsonl"
                kept = {"moved": result["moved"], "outside": result["outside"]}
                _append(target, {"pose": key, **kept})


def version_of(interpreter: str) -> str:
    """Version of MuJoCo in an interpreter."""
    command = [interpreter, "-c", "import mujoco; print(mujoco.__version__)"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


# table -----------------------------------------------------------------------------------------


@dataclass
class Counts:
    """Numbers of a row of the table."""

    states: int = 0
    objects: int = 0
    at_rest: int = 0
    way: list[float] = field(default_factory=list)
    """Distances that objects at rest were moved [m]."""
    cpu: list[float] = field(default_factory=list)
    stored: dict[str, list[float]] = field(default_factory=dict)
    """Displacements from the stored states, by version [m]."""
    rest: dict[str, list[float]] = field(default_factory=dict)
    """Displacements of objects that are reported at rest, by version [m]."""
    moving: list[str] = field(default_factory=list)
    """Objects reported at rest that move by more than `DRIFT`."""
    unexplained: int = 0
    """Number of these that neither a false contact nor the time step explains."""

    def add(self, task: Task, versions: list[str]) -> None:
        """Count the results of a task."""
        drifts = {version: task.drifts(version) for version in versions}
        for row, line in sorted(task.settled().items()):
            pose, begun = _key(np.array(line["qpos"])), _key(task.states[row])
            self.states += 1
            self.cpu.append(line["cpu"])
            resting = [name for name in task.objects if line["states"][name] == "at-rest"]
            self.objects += len(task.objects)
            self.at_rest += len(resting)
            self.way += [line["moved"][name] for name in resting]
            for version, known in drifts.items():
                before, after = (known.get(key, {"moved": {}}) for key in (begun, pose))
                before, false, after = before["moved"], after.get("outside", ()), after["moved"]
                fine = task.drifts(version, "finer").get(pose, {"moved": {}})["moved"]
                self.stored.setdefault(version, []).extend(
                    before[name] for name in task.objects if name in before
                )
                still = {name: after[name] for name in resting if name in after}
                self.rest.setdefault(version, []).extend(still.values())
                for name, far in still.items():
                    if far <= DRIFT:
                        continue
                    text = f"{task.name} row {row}: {name} moves {1000 * far:.3g} mm in {version}"
                    text += (
                        f"; {1000 * fine[name]:.3g} mm at finer steps without creep"
                        if name in fine
                        else ""
                    )
                    text += "; the engine has a contact outside of it" if name in false else ""
                    self.moving.append(text)
                    self.unexplained += name not in false and fine.get(name, np.inf) > DRIFT

    def row(self, name: str, versions: list[str]) -> str:
        """The counts as a row of a table."""
        if not self.states:
            return f"{name:18} nothing is settled yet"
        cells = [f"{name:18} {self.states:6} {self.objects:7} {self.at_rest:7}"]
        cells.append(f"{1000 * max(self.way, default=0.0):9.3g}")
        cells.append(f"{np.median(self.cpu):7.2f} {max(self.cpu):7.2f}")
        for version in versions:
            for values in (self.stored.get(version, []), self.rest.get(version, [])):
                cells.append(f"{1000 * np.median(values):8.3g}" if values else f"{'-':>8}")
                cells.append(f"{1000 * max(values):8.3g}" if values else f"{'-':>8}")
        return " ".join(cells)


def print_table(tasks: list[Task], versions: list[str]) -> int:
    """Print the counts by task and in total, and return the number of unexplained movements."""
    head = f"{'task':18} {'states':>6} {'objects':>7} {'at rest':>7} {'moved mm':>9} {'CPU s':>15}"
    for version in versions:
        head += f" {'stored ' + version:>17} {'at rest ' + version:>17}"
    print(
        head
        + "\n"
        + f"{'':50} {'median':>8} {'max':>7}"
        + f"{'  median      max' * 2}" * len(versions)
    )
    total, suites = Counts(), dict[str, Counts]()
    for task in tasks:
        counts = Counts()
        suite = suites.setdefault(task.name.rpartition("_")[0] or task.name, Counts())
        for sums in (counts, suite, total):
            sums.add(task, versions)
        print(counts.row(task.name, versions))
    for name, sums in [*suites.items(), ("all", total)]:
        print(sums.row(name, versions))
    for version in versions:
        stored, rest = (
            np.array(total.stored.get(version, [])),
            np.array(total.rest.get(version, [])),
        )
        print(
            f"MuJoCo {version}, in 2 s: of {len(stored)} stored objects {np.sum(stored > 1e-3)} "
            f"move by more than 1 mm; of {len(rest)} objects at rest {np.sum(rest > DRIFT)} by "
            "more than .1 mm"
        )
    for line in total.moving:
        print("  " + line)
    return total.unexplained


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", type=Path, help="folder of TASK.xml and TASK.npy")
    parser.add_argument("--rows", type=int, default=None, help="only the first states of each task")
    parser.add_argument("--only", default="*", help="names of the tasks, with wildcards")
    parser.add_argument("--engine", action="append", default=[], help="interpreter with MuJoCo")
    parser.add_argument("--results", type=Path, default=None, help="default: FOLDER/audit")
    parser.add_argument("--table", action="store_true", help="print the table only")
    parser.add_argument(
        "--again",
        choices=["open", "all"],
        help="settle the states again that have an object not at rest, or all",
    )
    options = parser.parse_args()
    results = options.results or options.folder / "audit"
    scenes = [
        path for path in sorted(options.folder.glob("*.xml")) if fnmatch(path.stem, options.only)
    ]
    tasks = [read_task(path, results) for path in scenes if path.with_suffix(".npy").exists()]
    engines = {version_of(path): path for path in options.engine or [sys.executable]}
    for task in tasks if not options.table else ():
        audit(task, engines, options.rows, options.again)
    return 1 if print_table(tasks, list(engines)) else 0


def audit(task: Task, engines: dict[str, str], count: int | None, again: str | None) -> None:
    """Settle and simulate the first states of a task that have no results yet."""
    rows = range(len(task.states))[:count]
    done = task.settled()
    faulty = {row for row, line in done.items() if set(line["states"].values()) != {"at-rest"}}
    keep = {None: set(done), "open": set(done) - faulty, "all": set()}[again]
    for line in settle(task, [row for row in rows if row not in keep]):
        _append(task.results / f"{task.name}.settled.jsonl", line)
        faults = [f"{name} {state}" for name, state in line["states"].items() if state != "at-rest"]
        print(
            f"{task.name} row {line['row']}: {line['cpu']:.2f} CPU s {'; '.join(faults)}",
            flush=True,
        )
    done = task.settled()
    for version, interpreter in engines.items():
        states = [task.states[row] for row in rows]
        states += [np.array(done[row]["qpos"]) for row in rows if row in done]
        simulate(task, interpreter, version, states)
        moving = [row for row in rows if row in done and task.moving(row, version)]
        far = [np.array(done[row]["qpos"]) for row in moving]
        simulate(task, interpreter, version, far, "finer")


if __name__ == "__main__":
    sys.exit(main())
