"""Poses at rest beside MuJoCo: simulated states and floating scenes.

    pip install -e ".[mujoco]"
    python benchmarks/rest_in_mujoco.py simulated --scenes 200
    python benchmarks/rest_in_mujoco.py floating --scenes 20 --seed 100
    python benchmarks/rest_in_mujoco.py floating --only 17      one scene, part by part
    python benchmarks/rest_in_mujoco.py --limits                seconds and memory of large scenes

**simulated**: objects dropped for 3 s; contacts of a simulator are soft, so they end sunk into each
other. `kilter.settle` brings that state to rest, at the level equilibrium. If an object has passed
into another one, which is no state of rest, it is dropped again with shorter time steps and
stiffer contacts. A row counts

    moved       largest movement over the permitted one: `CHAIN` times the sunk depth, summed along
                the chain of MuJoCo's own contacts from the object down to a held body
    drift       largest movement of an object in 2 s, from the simulated state and from the pose at
                rest. The pose at rest has no overlap, so each object first sinks by its own depth
                again: both states sink for half a second, with the damping of the drop, before the
                2 s begin
    lifted      the drift of a third state: the simulated one with each object raised by the sunk
                depth of its chain. It sinks as the pose at rest does, and shows what that alone
                changes
    raw         the same movement with that of the sinking

**floating**: stacks with gaps between 1 mm and .3 m, some off centre. Every object is at rest or is
named as leaving. MuJoCo with stiff contacts simulates the pose at rest of the objects that stay for
2 s; those that move by more than 1 mm are listed, with their movement if all contacts are `STIFFER`
squared times as stiff. A movement that vanishes then is that of soft contacts. The poses are tilted
by `TILT`: MuJoCo normalises the rounding of the axis of an upright cylinder, and its contact with a
plane is then up to millimetres deep (scene 79). A pose at rest has no overlaps, so contacts of the
engine that are deeper than `THROUGH` at its begin are false; their depth is stated (scene 110).

Each scene is a line of JSON in the file of `--results`; scenes that it contains are not repeated.
`--again` repeats them.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from mujoco_scenes import Scene, Simulated, floating_scene, simulated_scene
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import kilter
from kilter.rigid import Pose, matrix_to_quaternion

Array = NDArray[np.float64]
DROP, SINKING, AFTER = 3.0, 0.5, 2.0
"""Simulated time of a drop, of the sinking of a pose at rest, and of a drift [s]."""
THROUGH, FINER = 2e-3, (1, 4, 8)
"""Sunk depth from which an object has passed into another one [m], and the divisors that are tried
of the time step and of the time constant of the contacts. The thinnest piece is 5 mm thick."""
DAMPING = 2.0
"""Rate at which motions decay during a drop [1/s]."""
STILL = 5e-3
"""Speed below which a simulated scene counts as still [m/s]."""
CHAIN = 3.0
"""Permitted movement over the sunk depth of a chain of contacts [-]."""
FINE = 1e-6
"""Movement that is always permitted, and drift that counts as none [m]."""
STIFFER = 4.0
"""Divisor of the time step and of the time constant of contacts in the second simulation."""
TILT = 1e-9
"""Random rotation of each object before the simulation [rad]."""
MOVED = 1e-3
"""Movement in MuJoCo above which an object does not rest [m]."""


def settled(scene: Scene, poses: dict[str, Array], limit: float) -> tuple[kilter.Settled, float]:
    """The pose at rest of a scene in a state, and its CPU time [s], without reading."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.xml"
        file.write_text(scene.xml(poses))
        assembly = kilter.load(str(file))
    begun = time.process_time()
    answer = kilter.settle(assembly, require="equilibrium", time_limit=limit)
    return answer, time.process_time() - begun


def poses_at_rest(answer: kilter.Settled, poses: dict[str, Array]) -> dict[str, Array]:
    """Position and quaternion of each free body after the movement of its part."""
    result = {}
    for name, seven in poses.items():
        old, new = answer.drawn[name].pose, answer.assembly[name].pose
        body = Pose(seven[:3], seven[3:])
        turn = new.matrix @ old.matrix.T
        place = new.apply(old.inverse().apply([body.position]))[0]
        result[name] = np.concatenate([place, matrix_to_quaternion(turn @ body.matrix)])
    return result


def dropped(scene: Scene) -> Simulated:
    """A scene after its drop, whose last tenth has the settings of the scene."""
    for divisor in FINER:
        state = Simulated(scene)
        model = state.model
        step, soft = model.opt.timestep, model.geom_solref[:, 0].copy()
        model.opt.timestep, model.geom_solref[:, 0] = step / divisor, soft / divisor
        state.run(0.9 * DROP, DAMPING)
        model.opt.timestep, model.geom_solref[:, 0] = step, soft
        state.run(0.1 * DROP, DAMPING)
        if max(state.sunk().values(), default=0.0) <= THROUGH:
            break
    return state


def drifts(scene: Scene, poses: dict[str, Array]) -> tuple[Array, Array]:
    """Movement of each free object in `AFTER` from a pose at zero speed [m].

    Without and with that of the sinking before it.
    """
    simulated = Simulated(scene, poses)
    begin = simulated.centers()
    simulated.run(SINKING, DAMPING)
    sunk = simulated.centers()
    simulated.run(AFTER)
    end = simulated.centers()
    return np.linalg.norm(end - sunk, axis=1), np.linalg.norm(end - begin, axis=1)


def tilted(poses: dict[str, Array]) -> dict[str, Array]:
    """The poses, each turned by `TILT` about a random axis."""
    rng = np.random.default_rng(0)
    turns = rng.normal(size=(len(poses), 3))
    turns *= TILT / np.linalg.norm(turns, axis=1)[:, None]
    result = {}
    for (name, seven), turn in zip(poses.items(), turns, strict=True):
        quaternion = Rotation.from_rotvec(turn) * Rotation.from_quat(seven[3:], scalar_first=True)
        result[name] = np.append(seven[:3], quaternion.as_quat(scalar_first=True))
    return result


def stays(scene: Scene, poses: dict[str, Array], divisor: float = 1.0) -> tuple[Array, float]:
    """Movement of each free object in `AFTER` from poses [m], and the deepest first contact [m].

    The time step and the time constant of the contacts are shorter by a divisor.
    """
    simulated = Simulated(scene, tilted(poses))
    simulated.model.opt.timestep /= divisor
    simulated.model.geom_solref[:, 0] /= divisor
    begin, deep = simulated.centers(), max(simulated.sunk().values(), default=0.0)
    simulated.run(AFTER)
    return np.linalg.norm(simulated.centers() - begin, axis=1), deep


def shift_and_turn(before: Array, after: Array) -> tuple[float, float]:
    """Distance [m] and angle [deg] between two poses of a body."""
    turn = (
        Rotation.from_quat(after[3:], scalar_first=True)
        * Rotation.from_quat(before[3:], scalar_first=True).inv()
    )
    return float(np.linalg.norm(after[:3] - before[:3])), float(np.degrees(turn.magnitude()))


def failed(answer: kilter.Settled | None, error: kilter.KilterError | None) -> dict[str, Any]:
    """State, level and cause of an answer, or of its error."""
    if answer is None:
        return {"state": "error", "why": str(error), "level": None, "parts": [], "leaves": []}
    return {
        "state": answer.state,
        "level": answer.level,
        "why": answer.why,
        "parts": list(answer.parts),
        "leaves": list(answer.leaves),
    }


def noted(
    row: dict[str, Any], scene: Scene, poses: dict[str, Array], limit: float
) -> kilter.Settled | None:
    """The answer about a state, None after an error; its state and CPU time enter the row."""
    answer, error = None, None
    begun = time.process_time()
    try:
        answer, row["seconds"] = settled(scene, poses, limit)
    except kilter.KilterError as raised:
        error, row["seconds"] = raised, time.process_time() - begun
    row |= failed(answer, error)
    return answer


def simulated_row(seed: int, limit: float, each: bool) -> dict[str, Any]:
    """Drop a scene, settle its state, and simulate both; `each`: print a line for each object."""
    scene = simulated_scene(seed)
    before = dropped(scene)
    poses, chains = before.poses(), before.chains()
    row: dict[str, Any] = {
        "family": "simulated", "seed": seed, "kind": scene.kind, "objects": len(poses),
        "pieces": scene.pieces, "speed": before.speed(), "sunk": max(before.sunk().values()),
    }  # fmt: skip
    answer = noted(row, scene, poses, limit)
    if answer is None:
        return row
    after = poses_at_rest(answer, poses)
    moved = np.array([answer.distance[answer.drawn.index[name]] for name in poses])
    share = moved / (CHAIN * chains + FINE)
    row["moved"] = float(np.nanmax(share))
    row["most_moved"] = list(poses)[int(np.nanargmax(share))]
    old, old_raw = drifts(scene, poses)
    new, new_raw = drifts(scene, after)
    raised = {
        name: seven + np.append([0.0, 0.0, depth], np.zeros(4))
        for (name, seven), depth in zip(poses.items(), np.nan_to_num(chains), strict=True)
    }
    row["drift"] = [float(old.max()), float(new.max())]
    row["lifted"] = float(drifts(scene, raised)[0].max())
    row["raw"] = [float(old_raw.max()), float(new_raw.max())]
    if each:
        for k, name in enumerate(poses):
            _, angle = shift_and_turn(poses[name], after[name])
            print(
                f"    {name:12} moved {moved[k]:.2e} m {angle:.4f} deg, chain {chains[k]:.2e}, "
                f"drift {old[k]:.2e} -> {new[k]:.2e}, raw {old_raw[k]:.2e} -> {new_raw[k]:.2e}"
            )
    return row


def floating_row(seed: int, limit: float, each: bool) -> dict[str, Any]:
    """Settle a floating scene, and simulate the objects that stay."""
    scene = floating_scene(seed)
    poses = Simulated(scene).poses()
    row: dict[str, Any] = {
        "family": "floating", "seed": seed, "objects": len(poses), "pieces": scene.pieces
    }  # fmt: skip
    answer = noted(row, scene, poses, limit)
    if answer is None:
        return row
    after = poses_at_rest(answer, poses)
    row["open"] = sorted(set(answer.parts) - set(answer.leaves))
    row["rest"] = len(poses) - len(set(answer.parts) | set(answer.leaves))
    left = scene.without(row["leaves"])
    if not row["rest"]:
        return row
    names = [thing.name for thing in left.things if not thing.held]
    moved, row["false"] = stays(left, after)
    far = [k for k, name in enumerate(names) if moved[k] > MOVED and name not in answer.parts]
    row["moves"] = {names[k]: float(moved[k]) for k in far}
    if far:
        stiff, _ = stays(left, after, STIFFER)
        row["stiff"] = {names[k]: float(stiff[k]) for k in far}
    if each:
        for name, way in zip(names, moved, strict=True):
            print(f"    {name:12} moves {way:.2e} m; settled by {answer.drawn.index[name]}")
    return row


ROWS = {"simulated": simulated_row, "floating": floating_row}


def line(row: dict[str, Any]) -> str:
    """A scene in a line."""
    text = f"{row['family']} {row['seed']:4} {row['objects']:3} objects"
    text += f" of up to {row['pieces']:2} pieces {row['seconds']:6.2f} s {row['state']}"
    if row["state"] == "error" or row["family"] == "floating":
        if row.get("leaves"):
            text += f", leaves: {', '.join(row['leaves'])}"
        if row.get("open") or row.get("why"):
            text += f", open: {', '.join(row.get('open', []))} {row['why']}"
        for name, way in row.get("moves", {}).items():
            text += f", {name} moves {1000 * way:.1f} mm in MuJoCo"
            text += f" ({1000 * row['stiff'][name]:.2g} mm with stiffer contacts)"
        if row.get("false", 0.0) > THROUGH:
            text += f", a false contact of MuJoCo is {1000 * row['false']:.3g} mm deep"
        return text
    (old, new), (old_raw, new_raw) = row["drift"], row["raw"]
    text += f" {row['level']} ({row['kind']})"
    if row["speed"] > STILL:
        text += f", moving at {row['speed']:.3f} m/s"
    text += f", moved {row['moved']:.2f} ({row['most_moved']}), drift {old:.1e} -> {new:.1e}"
    text += f" (lifted {row['lifted']:.1e}, raw {old_raw:.1e} -> {new_raw:.1e})"
    return text + (f", {row['why']} {', '.join(row['parts'])}" if row["why"] else "")


def summary(rows: list[dict[str, Any]]) -> str:
    """Counts over all scenes of a family."""
    count = len(rows)
    seconds = [row["seconds"] for row in rows]
    states: dict[str, int] = {}
    for row in rows:
        states[row["state"]] = states.get(row["state"], 0) + 1
    text = f"{count} scenes: {', '.join(f'{n} {state}' for state, n in sorted(states.items()))}\n"
    text += f"CPU s: median {np.median(seconds):.2f}, largest {max(seconds):.2f}\n"
    answered = [row for row in rows if row["state"] != "error"]
    if rows[0]["family"] == "floating":
        objects, rest = (sum(row.get(key, 0) for row in rows) for key in ("objects", "rest"))
        leaves = sum(len(row["leaves"]) for row in answered)
        moves = sum(len(row.get("moves", {})) for row in answered)
        stiff = sum(way > MOVED for row in answered for way in row.get("stiff", {}).values())
        return text + (
            f"objects: {objects}; at rest {rest}, leaving {leaves}, neither "
            f"{objects - rest - leaves}; over 1 mm in MuJoCo: {moves} "
            f"({100 * moves / max(rest, 1):.1f} % of those at rest), with stiffer contacts {stiff}"
        )
    rest = [row for row in answered if row["state"] == "at-rest" and row["level"] is not None]
    still = [row for row in rest if row["speed"] <= STILL]
    within = sum(row["moved"] <= 1 for row in still)
    calm, raw = (
        sum(row[key][1] <= row[key][0] + FINE for row in still) for key in ("drift", "raw")
    )
    lifted = sum(row["lifted"] <= row["drift"][0] + FINE for row in still)
    either = sum(row["drift"][1] <= max(row["drift"][0], row["lifted"]) + FINE for row in still)
    return text + (
        f"at rest at the level equilibrium or above: {len(rest)}; the simulator had ended its "
        f"motion in {len(still)} of them, and of these\n"
        f"  {within} moved by at most {CHAIN:g} times the sunk depth of the chain\n"
        f"  drift not above that of the simulated state: {calm} after sinking, {raw} raw;\n"
        f"  that of the lifted state: {lifted}; pose at rest not above the larger of both: {either}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("family", nargs="?", choices=list(ROWS), default="simulated")
    parser.add_argument("--scenes", type=int, default=200, help="number of scenes")
    parser.add_argument("--seed", type=int, default=0, help="first seed")
    parser.add_argument("--only", type=int, help="a single seed, with a line for each object")
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of a scene [s]")
    parser.add_argument("--results", default="", help="file of results (JSON lines)")
    parser.add_argument("--again", action="store_true", help="repeat the scenes of the file")
    parser.add_argument("--limits", nargs="?", const="all", help="large scenes: all, or a name")
    options = parser.parse_args()
    if options.limits:
        from rest_limits import measure

        sys.exit(measure(options.limits))
    if options.only is not None:
        print(line(ROWS[options.family](options.only, options.seconds, True)))
        return
    seeds = range(options.seed, options.seed + options.scenes)
    file = Path(options.results) if options.results else None
    known: dict[int, dict[str, Any]] = {}
    if file and file.exists() and not options.again:
        read = [json.loads(each) for each in file.read_text().splitlines()]
        known = {row["seed"]: row for row in read if row["family"] == options.family}
    for seed in seeds:
        if seed not in known:
            known[seed] = ROWS[options.family](seed, options.seconds, False)
            print(line(known[seed]), flush=True)
            if file:
                with file.open("a") as written:
                    written.write(json.dumps(known[seed]) + "\n")
    print(summary([known[seed] for seed in seeds]))


if __name__ == "__main__":
    main()
