"""Verify that the proofs in the file of a margin or of a transport prove its stated limits.

Each entry states a limit, a value, and whether the assembly is held there. The value follows from
the change of the assembly, for instance the angle between the directions of gravity. Entries that
are held lie on one side of the limit, and entries that fall on the other side.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kilter.analysis.analysis_tolerances import ACROSS_GRAVITY
from kilter.analysis.transport.carrier import CarrierMotion
from kilter.analysis.transport.transport_answer import (
    ALPHA,
    CARRIER,
    carried_change,
    participating_mass,
)
from kilter.arrays import TINY, Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import InputError
from kilter.mechanics.mechanics_tolerances import AGREES
from kilter.mechanics.proof_form import (
    FLAG,
    NUMBER,
    VECTOR,
    every,
    keys,
    list_of,
    optional_keys,
)
from kilter.tell.numbers import number

Entry = Mapping[str, Any]
LIMITS = keys(
    proofs=list_of(
        every(
            keys(value=NUMBER, held=FLAG),
            optional_keys(
                push=VECTOR,
                axis=VECTOR,
                motion=keys(**dict.fromkeys(CARRIER, VECTOR)),
                participating_mass=NUMBER,
            ),
        )
    )
)
"""Statements of a margin or of a transport."""
ABOUT = "tilt about the axis"
TILTS = ("tilt", ABOUT, "nearest held")
"""Limits of a turn of gravity."""
FALLING = ("friction", "bond", "nearest held", "least load factor")
"""Limits below which the assembly falls; above all others it falls."""


def wrong_limits(
    assembly: Assembly, contacts: ContactSet, bundle: Entry, verdicts: Sequence[str]
) -> Iterator[str]:
    """Yield the reasons why proofs that are valid one by one do not prove the stated limits."""
    sides: dict[str, tuple[list[float], list[float]]] = {}
    weaker = [entry["change"].get("mu_share") for entry in bundle["proofs"]]
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        name, value = entry["about"], float(entry["value"])
        if entry["held"] != (verdict != "unstable"):
            yield f"{name} {value:.6g}: it states held {entry['held']}, its proof is {verdict}"
        if not _fits(assembly, bundle["kind"], entry):
            yield f"{name} {value:.6g}: the value differs from the changed gravity or loads"
        if not _fits_multiplier(assembly, entry):
            yield f"{name} {value:.6g}: the direction or participating mass is not of its motion"
        held, falls = sides.setdefault(name, ([], []))
        (held if entry["held"] else falls).append(value)
    if bundle["kind"] == "transport" and any(share != weaker[0] for share in weaker):
        yield "its proofs are for different friction"
    for name, (held, falls) in sides.items():
        sign = -1.0 if name in FALLING else 1.0
        if held and falls and max(sign * v for v in held) >= min(sign * v for v in falls):
            yield f"{name}: values that are held lie beyond values that fall"


def limit_notes(assembly: Assembly, contacts: ContactSet, bundle: Entry) -> Iterator[str]:
    """Yield each stated limit in words, with the values on both sides that were recomputed."""
    names = dict.fromkeys(entry["about"] for entry in bundle["proofs"])
    for name in names:
        words = [
            f"{'held' if entry['held'] else 'falls'} at {_value_words(bundle['kind'], entry)}"
            for entry in bundle["proofs"]
            if entry["about"] == name
        ]
        yield f"{name}: {', '.join(words)}"


def _value_words(kind: str, entry: Entry) -> str:
    """The value of a limit with its unit, and the direction or motion for which it is proved."""
    name, value, change = entry["about"], entry["value"], entry["change"]
    if name in TILTS:
        degrees = number(float(np.degrees(value)), 10)
        return f"{degrees} deg with gravity along {_along(change['down'])}"
    if name.startswith("push of "):
        return f"{number(value, 10)} N along {_along(change['loads'][-1]['force'])}"
    if name.startswith("load on "):
        return f"{number(value, 10)} N"
    if kind != "transport":
        return number(value, 10)
    moves = [key for key in CARRIER[:-1] if any(entry["motion"][key])]
    parts = [f"{key.replace('_', ' ')} {entry['motion'][key]}" for key in moves]
    words = f"{number(value, 10)} of the motion ({', '.join(parts)})"
    mass = entry.get("participating_mass")
    words += "" if mass is None else f", participating mass {number(mass, 8)} kg"
    share = change.get("mu_share")
    return words if share is None else f"{words} with {number(share, 8)} times the friction"


def _along(vector: Any) -> str:
    """A direction as words."""
    size = max(float(np.linalg.norm(vector)), TINY)
    return f"({', '.join(number(round(float(x) / size, 6), 3) for x in vector)})"


def _fits(assembly: Assembly, kind: str, entry: Entry) -> bool:
    """Whether the change of the assembly in an entry is that of its stated limit and value."""
    change, value = entry["change"], float(entry["value"])
    if kind == "transport":
        return entry.get("motion") is not None and _fits_motion(assembly, entry)
    name = entry["about"]
    if name == ABOUT:
        return set(change) == {"down"} and _fits_turn(assembly, entry)
    if name in TILTS:
        return set(change) == {"down"} and abs(_angle(assembly.down, change["down"]) - value) < 1e-9
    if name == "friction":
        return bool(change == {"mu": entry["value"]})
    if name == "bond":
        return bool(change == {"strength": entry["value"]})
    if set(change) != {"loads"}:
        return False
    if name in ("load factor", "least load factor"):
        return _fits_factor(assembly, entry)
    part = name.removeprefix("push of ").removeprefix("load on ")
    given, more = change["loads"][:-1], change["loads"][-1:]
    if name == part or not _same_loads(given, _loads_of(assembly)) or not more:
        return False
    [load] = more
    force = np.asarray(load["force"], dtype=float)
    along = name.startswith("push of ") or float(force @ assembly.down) >= (1 - AGREES) * value
    size = float(np.linalg.norm(force))
    plain = load["point"] is None and not any(load["torque"]) and load["part"] == part
    return plain and along and abs(size - value) <= AGREES * max(value, size)


def _fits_factor(assembly: Assembly, entry: Entry) -> bool:
    """Whether the loads of an entry are those of the file times the factor, or a body force."""
    value, given = float(entry["value"]), _loads_of(assembly)
    if entry.get("push") is None:
        scaled = [
            {**load, "force": value * load["force"], "torque": value * load["torque"]}
            for load in given
        ]
        return _same_loads(entry["change"]["loads"], scaled)
    g = float(np.linalg.norm(assembly.gravity))
    mass = assembly.geometry.mass
    pushed = [
        {
            "part": part.name,
            "force": value * mass[k] * np.asarray(entry["push"]) * g,
            "torque": np.zeros(3),
            "point": None,
        }
        for k, part in enumerate(assembly)
        if not part.grounded
    ]
    return _same_loads(entry["change"]["loads"], [*given, *pushed])


def _fits_turn(assembly: Assembly, entry: Entry) -> bool:
    """Whether the gravity of an entry is turned about its axis by its angle, right-handed."""
    axis, down = np.asarray(entry.get("axis", np.zeros(3)), dtype=float), assembly.down
    angle = float(entry["value"])
    across = abs(float(np.linalg.norm(axis)) - 1) <= AGREES and abs(axis @ down) <= ACROSS_GRAVITY
    turned = np.cos(angle) * down + np.sin(angle) * np.cross(axis, down)
    near = np.abs(turned - np.asarray(entry["change"]["down"], dtype=float)).max() <= AGREES
    return bool(across and near and 0 <= angle < 2 * np.pi)


def _fits_motion(assembly: Assembly, entry: Entry) -> bool:
    """Whether the change of an entry is the stated share of the stated motion of the carrier."""
    try:
        motion = CarrierMotion(**{key: entry["motion"][key] for key in CARRIER})
        change = carried_change(assembly, motion, float(entry["value"]))
    except InputError:
        return False
    given = {key: value for key, value in entry["change"].items() if key != "mu_share"}
    if change is None or set(given) != set(change):
        return False
    size = float(np.abs(change["gravity"]).max())
    near = np.abs(np.subtract(given["gravity"], change["gravity"])) <= AGREES * size
    return bool(near.all()) and _same_loads(given.get("loads", []), change.get("loads", []))


def _fits_multiplier(assembly: Assembly, entry: Entry) -> bool:
    """Whether a collapse multiplier is of horizontal weights, with the mass of its mechanism."""
    stated = entry.get("participating_mass")
    if not entry["about"].startswith(ALPHA):
        return stated is None
    motion, g = entry.get("motion"), float(np.linalg.norm(assembly.gravity))
    if motion is None or any(np.any(motion[key]) for key in CARRIER[1:]):
        return False
    acceleration = np.asarray(motion["acceleration"], dtype=float)
    level = abs(float(acceleration @ assembly.down)) <= ACROSS_GRAVITY * g
    if not level or abs(float(np.linalg.norm(acceleration)) - g) > AGREES * g:
        return False
    name = entry["about"].removeprefix(ALPHA)
    axes = {f"{sign}{axis}": way * np.eye(3)[k]
            for k, axis in enumerate("xyz") for sign, way in (("+", -g), ("-", g))}  # fmt: skip
    if name != "least" and np.abs(acceleration - axes.get(name, np.inf)).max() > AGREES * g:
        return False
    if stated is None:
        return True
    moves = entry["proof"].get("motion") or {}
    mass = participating_mass(assembly, acceleration, moves)
    return bool(abs(mass - stated) <= AGREES * abs(stated))


def _angle(first: Array, second: Any) -> float:
    """Angle between two directions [rad]."""
    b = np.asarray(second, dtype=float)
    return float(np.arctan2(np.linalg.norm(np.cross(first, b)), first @ b))


def _loads_of(assembly: Assembly) -> list[dict[str, Any]]:
    """The loads of an assembly as dictionaries of arrays."""
    return [
        {"part": load.part, "force": load.force, "torque": load.torque, "point": load.point}
        for load in assembly.loads
    ]


def _same_loads(given: Sequence[Entry], expected: Sequence[Entry]) -> bool:
    """Whether two lists of loads are equal up to rounding."""
    if len(given) != len(expected):
        return False
    for first, second in zip(given, expected, strict=True):
        if first["part"] != second["part"] or (first["point"] is None) != (second["point"] is None):
            return False
        for key in ("force", "torque", "point"):
            if second[key] is None:
                continue
            a, b = np.asarray(first[key], dtype=float), np.asarray(second[key], dtype=float)
            if (np.abs(a - b) > AGREES * max(float(np.abs(b).max()), 1e-300)).any():
                return False
    return True
