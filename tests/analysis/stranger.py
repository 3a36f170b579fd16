"""Independent reader of a proof file: numpy and the numbers of the file, without kilter.

    opening of a point   (dr_b + dtheta_b x (x - c_b) - dr_a - dtheta_a x (x - c_a)) . n
    balance of a part    sum of forces and torques about its centre, weight and loads included

Torques are divided by the largest arm of the part, so that one relative number tells all.
"""

from __future__ import annotations

from typing import Any

import numpy as np

PLANE = np.array([1.0, 0, 1, 0, 1, 0])


def _parts(proof: dict[str, Any]) -> dict[str, dict[str, Any]]:
    parts = {part["name"]: dict(part) for part in proof["parts"]}
    for part in parts.values():
        part["center"] = np.array(part["center"])
        part["wrench"] = np.zeros(6)
        part["sum"] = 0.0
        part["arm"] = 1e-300
    return parts


def _push(part: dict[str, Any], force: Any, point: Any, torque: Any = (0, 0, 0)) -> None:
    arm = np.asarray(point) - part["center"]
    part["wrench"] += np.concatenate([force, np.cross(arm, force) + np.asarray(torque)])
    force, torque = np.linalg.norm(force), np.linalg.norm(torque)
    part["arm"] = max(part["arm"], float(np.linalg.norm(arm)))
    if force > 0:  # a torque is a couple of such forces that far apart
        part["arm"] = max(part["arm"], float(torque / force))


def _load(parts: dict[str, dict[str, Any]], proof: dict[str, Any]) -> None:
    for part in parts.values():
        force = part["mass"] * np.array(proof["gravity"])
        _push(part, force, part["center"])
        part["sum"] += float(np.linalg.norm(force))
    for load in proof["loads"]:
        part = parts[load["part"]]
        point = part["center"] if load["point"] is None else load["point"]
        _push(part, np.array(load["force"]), point, load["torque"])
        part["sum"] += float(np.linalg.norm(load["force"]))


def imbalance(proof: dict[str, Any]) -> float:
    """Worst imbalance of a free part over the sizes of all forces on it; cones are checked."""
    parts = _parts(proof)
    _load(parts, proof)
    for point, force in zip(proof["points"], np.array(proof["forces"]).reshape(-1, 3), strict=True):
        size = float(force @ point["normal"])
        pull = point.get("pull", 0.0)
        assert size >= -pull * (1 + 1e-12)
        mu = point["mu"] if "friction" in proof else 0.0
        aside = float(np.linalg.norm(force - size * np.array(point["normal"])))
        presses = size + pull
        most = mu * presses + point.get("shear", 0.0)
        assert point.get("tied") or aside <= most + 1e-9 * max(presses, most, 1e-9)
        for name, sign in zip(point["parts"], (-1, 1), strict=True):
            _push(parts[name], sign * force, point["x"])
            parts[name]["sum"] += abs(size) + pull
    for joint in proof["joints"]:
        wrench = np.array(joint["wrench"])
        _carries(joint, wrench)
        for name, sign in zip(joint["parts"], (-1, 1), strict=True):
            if name in parts:
                _push(parts[name], sign * wrench[:3], joint["point"], sign * wrench[3:])
                parts[name]["sum"] += float(np.abs(wrench[:3]).sum())
                arm = max(parts[name]["arm"], 1e-3)
                parts[name]["sum"] += float(np.abs(wrench[3:]).sum()) / arm
    worst = 0.0
    for part in parts.values():
        if not part["grounded"]:
            wrench = part["wrench"] * (PLANE if proof["planar"] else 1.0)
            wrench[3:] /= max(part["arm"], 1e-300)
            worst = max(worst, float(np.linalg.norm(wrench)) / part["sum"])
    return worst


def _carries(joint: dict[str, Any], wrench: np.ndarray) -> None:
    """A joint carries no force along what it lets slide, no torque about what it lets turn."""
    size = 1e-9 * (1 + np.abs(wrench).max()) * (1 + np.abs(joint["point"]).max())
    if joint["kind"] in ("prismatic", "cylindrical"):
        assert abs(wrench[:3] @ joint["axis"]) <= size
    if joint["kind"] in ("revolute", "cylindrical"):
        assert abs(wrench[3:] @ joint["axis"]) <= size
    if joint["kind"] == "spherical":
        assert np.abs(wrench[3:]).max() <= size


def opening_and_power(proof: dict[str, Any]) -> tuple[float, float]:
    """Least opening of a contact or joint, and the power left by bonds, of the motion of a proof.

    With friction the opening of a contact is u_n - mu |u_t|: the dual of Coulomb's cone.
    """
    parts = _parts(proof)
    _load(parts, proof)
    motion = {name: np.zeros(6) for name in [*parts, "ground"]}
    motion.update({name: np.array(six) for name, six in proof["motion"].items()})

    def at(name: str, x: Any) -> np.ndarray:
        center = parts[name]["center"] if name in parts else np.zeros(3)
        return motion[name][:3] + np.cross(motion[name][3:], np.asarray(x) - center)

    openings, absorbed = [0.0], 0.0
    for point in proof["points"]:
        a, b = point["parts"]
        u, n = at(b, point["x"]) - at(a, point["x"]), np.array(point["normal"])
        slip = float(np.linalg.norm(u - (u @ n) * n))
        openings.append(float(u @ n - point["mu"] * slip))
        if point.get("tied"):
            openings.append(-slip)
        absorbed += point.get("pull", 0.0) * float(u @ n) + point.get("shear", 0.0) * slip
    for joint in proof["joints"]:
        a, b = joint["parts"]
        slip = at(b, joint["point"]) - at(a, joint["point"])
        turn = motion[b][3:] - motion[a][3:]
        if joint["kind"] in ("prismatic", "cylindrical"):
            slip = np.cross(slip, joint["axis"])
        if joint["kind"] in ("revolute", "cylindrical"):
            turn = np.cross(turn, joint["axis"])
        if joint["kind"] == "spherical":
            turn = np.zeros(3)
        arms = [np.linalg.norm(parts[n]["center"] - joint["point"]) for n in (a, b) if n in parts]
        turn = turn * (max(arms) or 1.0)
        openings.append(-float(max(np.abs(slip).max(), np.abs(turn).max())))
    power = sum(
        float(part["wrench"] @ motion[name]) for name, part in parts.items() if not part["grounded"]
    )
    return min(openings), power - absorbed
