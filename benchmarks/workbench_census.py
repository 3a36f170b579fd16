"""Random changes in the workbench, each answer compared with `check` of the saved file.

    python benchmarks/workbench_census.py [SEQUENCES] [FIRST SEED] [--changes N] [--files FILE ...]

A sequence opens an example, or one of the given files, through the WebSocket of a real server and
makes 30 random changes with undo, redo and revert. After each change the complete answer (picture,
words, facts, open pairs, suggestions, ladder) is compared with the answer to the same choices,
which are written to a file and read anew. Every tenth sequence also runs `kilter check --json` on
this file at its end and compares the verdict. Prints the differences, the median and the worst time
from a change to its equilibrium and to its complete answer, the memory of the processes, and the
processes that remain at the end.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "workbench"))
from driver import Page

import kilter
from kilter.assembly import Assembly
from kilter.files.own.choices import Choices
from kilter.files.own.choices_writing import write_choices
from kilter.scenes import scene
from kilter.scenes.registry import SCENES
from kilter.workbench.answering import answer_data, scene_data
from kilter.workbench.live_assembly import LiveAssembly
from kilter.workbench.server import Workbench

MOST_PARTS = 30
SLOW = ("dome", "pile", "vault")
"""Examples with friction whose complete answer takes seconds."""


def main() -> int:
    """Run the sequences; return 1 if an answer differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sequences", nargs="?", type=int, default=20)
    parser.add_argument("first", nargs="?", type=int, default=1)
    parser.add_argument("--changes", type=int, default=30)
    parser.add_argument("--files", nargs="*", type=Path, default=[])
    given = parser.parse_args()
    differences, quick, full = 0, [], []
    names = [n for n in sorted(SCENES) if len(scene(n).parts) <= MOST_PARTS]
    names = [n for n in names if not any(word in n for word in SLOW)]
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as place, Workbench(None, folder=Path(place)) as bench:
        page = Page(bench)
        for seed in range(given.first, given.first + given.sequences):
            rng = random.Random(seed)
            if given.files:
                source = rng.choice(given.files)
                file = Path(place, source.name)
                if not file.exists():
                    shutil.copy(source, file)
            else:
                name = rng.choice(names)
                file = Path(place, f"{name}-{seed}.kilter.json")
                kilter.dump(scene(name), file)
            Path(place, f".{file.name}.workbench.json").unlink(missing_ok=True)
            found = sequence(page, file, rng, given.changes, quick, full, last=seed % 10 == 0)
            differences += len(found)
            for line in found:
                print(f"seed {seed} {file.name}: {line}", flush=True)
        assert bench.session is not None
        worker = bench.session.jobs.worker.pid
        memory = [resident(pid) for pid in ("self", worker)]
        page.close()
    time.sleep(1.0)
    left = alive(worker)
    print(
        f"{given.sequences} sequences, {len(full)} answers, {differences} different; equilibrium "
        f"median {statistics.median(quick):.3f} s, worst {max(quick):.2f}; complete median "
        f"{statistics.median(full):.3f} s, worst {max(full):.2f}; memory {memory[0]} and "
        f"{memory[1]} MB; worker left: {left}; {time.perf_counter() - began:.0f} s"
    )
    return 1 if differences or left else 0


def sequence(
    page: Page,
    file: Path,
    rng: random.Random,
    changes: int,
    quick: list[float],
    full: list[float],
    *,
    last: bool,
) -> list[str]:
    """Make the changes of a sequence; return a line for each answer that differs."""
    reply = page.say(do="open", file=file.name)
    if not reply["ok"]:
        return [f"not opened: {reply['error']}"]
    page.answer()
    drawn = kilter.load(file)
    found = []
    for k in range(changes):
        request = random_request(page, drawn, rng)
        started = time.perf_counter()
        reply = page.say(**request)
        if not reply["ok"] or (request["do"] == "settle" and not settled(page)):
            continue  # a change that does not fit; its sentence is tested elsewhere
        first = page.hear(lambda m: m.get("is") in ("answer", "problem") and newest(page, m))
        quick.append(time.perf_counter() - started)
        shown = first
        if first["is"] == "answer" and first["phase"] == "equilibrium":
            shown = page.hear(lambda m: m.get("is") in ("answer", "problem") and newest(page, m))
        full.append(time.perf_counter() - started)
        session = page.last["session"]
        wrong = compare(file, session["choices"], shown)
        if wrong:
            found.append(f"change {k + 1} {json.dumps(request)}: {wrong}")
    if last and page.last["session"]["file"]:
        found += command_line(page, file)
    return found


def settled(page: Page) -> bool:
    """Wait for the end of a search for the pose at rest; whether the parts have moved."""
    state = page.last["session"]["state"]

    def ends(message: dict[str, Any]) -> bool:
        moved = message.get("is") == "session" and message["state"] > state
        return moved or (message.get("is") == "tab" and message["name"] == "settle")

    return page.hear(ends)["is"] == "session"


def newest(page: Page, message: dict[str, Any]) -> bool:
    return message["state"] == page.last["session"]["state"]


def random_request(page: Page, drawn: Assembly, rng: random.Random) -> dict[str, Any]:
    """A random change of the present state, sometimes a wrong one."""
    session, parts = page.last["session"], page.last["scene"]["page"]["parts"]
    names = [*parts["full_names"], *page.last["scene"]["page"]["left_out"]]
    names = [name for name in names if name != "floor"] or ["none"]
    one, two = rng.choice(names), rng.choice(names)
    few = rng.sample(names, min(len(names), rng.randint(1, 3)))
    walking = ["undo", "undo", "redo", "revert", "go"]
    kinds = ["hold"] * 4 + ["friction"] * 3 + ["leave_out"] * 2 + walking
    kinds += ["floor", "fasten", "fasten_suggested", "fasten_overlaps", "pair", "material", "mass"]
    kinds += ["pair_friction", "joint", "load", "load_off", "scale_loads", "gravity", "density"]
    kinds += ["bond", "tolerance", "loose", "settle", "poses", "poses"]
    kind = rng.choice(kinds)
    count = len(session["changes"])
    if count and session["changes"][-1]["label"].startswith("place ") and rng.random() < 0.7:
        return {"do": "settle"}
    values: dict[str, dict[str, Any]] = {
        "hold": {"parts": few, "on": rng.random() < 0.7},
        "leave_out": {"parts": few[:1], "on": rng.random() < 0.5},
        "floor": {"on": rng.random() < 0.6},
        "fasten": {"parts": [one, two], "on": rng.random() < 0.8},
        "fasten_suggested": {"on": rng.random() < 0.6},
        "fasten_overlaps": {"on": rng.random() < 0.5},
        "loose": {"on": rng.random() < 0.5},
        "pair": {"pairs": [[one, two]], "as": rng.choice(["joined", "apart", "touching", None])},
        "material": {"parts": few, "density": rng.choice([None, 700, 2700, 7850])},
        "mass": {"part": one, "mass": rng.uniform(0.1, 5)},
        "friction": {
            "mu": rng.choice([None, 0, 0.2, 0.5, 0.8]),
            "live": rng.choice(["", "a", "b"]),
        },
        "pair_friction": {"parts": [one, two], "mu": rng.choice([None, 0, 0.4])},
        "joint": {"parts": [one, two], "kind": "fixed"},
        "bond": {"parts": [one, two], "pull": rng.uniform(0, 20)},
        "load": {"part": one, "force": [rng.uniform(-3, 3) for _ in range(3)]},
        "load_off": {"index": 0},
        "scale_loads": {"factor": rng.uniform(0, 2)},
        "gravity": {"down": rng.choice([None, [0, 0, -1], [0.1, 0, -1], [0, -1, 0]])},
        "density": {"value": rng.choice([None, 500, 2000])},
        "tolerance": {"gap": rng.choice([None, 1e-4])},
        "poses": {"poses": moved_slightly(drawn, rng)},
        "revert": {"index": rng.randrange(count) if count else 0},
        "go": {"index": rng.randint(0, count)},
    }
    return {"do": kind, **values.get(kind, {})}


def moved_slightly(drawn: Assembly, rng: random.Random) -> dict[str, Any] | None:
    """A part near its drawn pose, so that it overlaps or hangs by little; None: as in the file."""
    part = rng.choice(drawn.parts)
    if rng.random() < 0.2:
        return None
    size = float(drawn.geometry.size.min())
    shift = [rng.uniform(-1, 1) * rng.choice([1e-4, 1e-3]) * size for _ in range(3)]
    pose = part.pose
    place = (pose.position + shift).tolist()
    return {part.name: {"position": place, "rotation": pose.rotation.tolist()}}


def compare(file: Path, keys: dict[str, Any], shown: dict[str, Any]) -> str:
    """Compare a shown answer with that to the same choices in a file; empty if they are equal."""
    saved = file.with_name("saved.kilter.json")
    write_choices(Choices.from_dict(keys, folder=file.parent), saved)
    try:
        assembly = kilter.load(saved)
        expected = kilter.check(assembly)
    except kilter.InputError as error:
        return "" if shown["is"] == "problem" else f"{shown['is']}, but the file has: {error.what}"
    finally:
        saved.unlink()
    if shown["is"] == "problem":
        return f"problem {shown['error']!r}, but the file is {expected.verdict}"
    live = LiveAssembly(file)
    prepared = live.prepare(keys)
    center = np.array(scene_data(prepared, live.opened_parts(keys))["center"])
    fresh = json.loads(json.dumps(answer_data(expected, "complete", center)))
    wrong = [key for key in fresh if fresh[key] != shown.get(key)]
    if not wrong:
        return ""
    key = wrong[0]
    return f"{key}: shown {str(shown.get(key))[:200]}, file {str(fresh[key])[:200]}"


def command_line(page: Page, file: Path) -> list[str]:
    """Compare the answer that is shown with `kilter check --json` of the saved choices."""
    reply = page.say(do="save", file=f"last-{file.name.split('.')[0]}.kilter.json")
    if not reply["ok"]:
        return [f"not saved: {reply['error']}"]
    saved = file.with_name(reply["saved"])
    words = [sys.executable, "-m", "kilter", "check", str(saved), "--json", "--quiet"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    shown = page.last.get("answer")
    problem = page.last.get("problem")
    state = page.last["session"]["state"]
    if problem is not None and problem["state"] == state:
        return [] if done.returncode == 2 else [f"problem, but exit code {done.returncode}"]
    if done.returncode == 2:
        return [f"the command says: {done.stderr.strip()[:200]}"]
    answer = json.loads(done.stdout)
    assert shown is not None
    if shown["check"] != {key: answer[key] for key in shown["check"]}:
        return [f"shown {shown['check']}, command {answer['verdict']}"]
    return []


def resident(pid: object) -> int:
    """Resident memory of a process [MB]; 0 on systems without /proc."""
    try:
        text = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0
    return next(int(line.split()[1]) // 1000 for line in text.splitlines() if "VmRSS" in line)


def alive(pid: int) -> bool:
    """Whether a process exists and is no zombie."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


if __name__ == "__main__":
    sys.exit(main())
