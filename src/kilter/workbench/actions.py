"""Actions of a user on the choices about a file: hold, fasten, leave out, friction, loads.

An action is JSON data with the key `do`. `apply` returns the changed keys of the choices and a
label for the list of changes. An action is stored as it is, and the state of a session is the
choices with which it began plus its actions. So an action can be reverted although later actions
changed the same key.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from kilter.assembly.assumption import valid_rung
from kilter.assembly.straps import Strap
from kilter.errors import InputError, short_name
from kilter.files.own.choices import Choices
from kilter.workbench.connections import index_of
from kilter.workbench.live_assembly import OpenedParts

Keys = dict[str, Any]
Action = Mapping[str, Any]
LONGEST_LABEL = 240
"""Longest label of a change [characters]."""
STATES = ("joined", "touching", "apart")
"""Decisions about a pair of parts."""


def apply(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    """Apply an action to the keys of choices; return the new keys and a label of the change.

    Parameters
    ----------
    action : mapping
        `do` names the action; its other keys depend on it.
    keys : dict
        JSON data of the choices (`Choices.to_dict`).
    bodies : OpenedParts

    Raises
    ------
    InputError
        If the action is unknown or invalid.

    Examples
    --------
    >>> bodies = OpenedParts(("plate", "rod"), frozenset(), (1.0, 1.0))
    >>> keys = {"kilter": 1, "file": "a.step"}
    >>> apply({"do": "hold", "parts": ["plate"], "on": True}, keys, bodies)
    ({'kilter': 1, 'file': 'a.step', 'held': ['plate']}, 'hold plate')
    """
    name = action.get("do")
    change = ACTIONS.get(name) if isinstance(name, str) else None
    if change is None:
        raise InputError(f"unknown action {name!r:.40}", hint="reload the page")
    try:
        changes, label = change(action, keys, bodies)
    except (KeyError, TypeError, ValueError) as error:  # a value is missing, or of another type
        raise InputError(
            f"the action {name!r} has a wrong value: {error}"[:160], hint="reload the page"
        ) from None
    new = {key: value for key, value in {**keys, **changes}.items() if value not in (None, [], {})}
    new = {key: value for key, value in new.items() if value is not False}
    return Choices.from_dict(new).to_dict(), short_name(label, LONGEST_LABEL)


def drag_of(action: Action) -> str:
    """Name of the drag of a slider to whose positions an action belongs; empty for other actions.

    A position replaces the position before it of the same drag.
    """
    drag = action.get("live")
    return drag if isinstance(drag, str) else ""


# parts ---------------------------------------------------------------------------------


def _hold(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    parts, on = _parts(action, bodies), bool(action["on"])
    fixed = [name for name in parts if name in bodies.held]
    if fixed and not on:
        raise InputError(
            f"the file itself holds {_named(fixed)}", hint="change 'grounded' in the file"
        )
    held = _toggled(keys.get("held", []), parts, on, bodies)
    return {"held": held}, f"{'hold' if on else 'release'} {_named(parts)}"


def _leave_out(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    parts, on = _parts(action, bodies), bool(action["on"])
    left_out = _toggled(keys.get("left_out", []), parts, on, bodies)
    if on and len(bodies.matching(left_out)) == len(bodies.names):
        raise InputError("no part would be left", hint="keep at least one part")
    return {"left_out": left_out}, f"{'leave out' if on else 'bring back'} {_named(parts)}"


def _floor(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    on = action["on"]
    if on is False or on is None:
        return {"floor": None}, "no floor"
    if on is True:
        return {"floor": True}, "floor under the lowest point"
    height = _finite(on, "the height of the floor")
    return {"floor": height}, f"floor at height {height:g}"


def _material(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    parts, density = _parts(action, bodies), action.get("density")
    kept = [entry for entry in keys.get("materials", []) if entry["parts"] not in parts]
    if density is None:
        return {"materials": kept}, f"material of {_named(parts)} as in the file"
    value = _positive(density, "the density")
    name = action.get("name")
    more = [{"parts": part, "density": value, "name": name} for part in parts]
    words = name or f"{value:g} kg/m3"
    return {"materials": [*kept, *map(_plain, more)]}, f"{_named(parts)}: {words}"


def _mass(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    part, mass = str(action["part"]), _positive(action["mass"], "the mass")
    volume = bodies.volume_of(part)
    if volume <= 0:
        raise InputError(f"part {part!r} has no volume", hint="give the mass in the file")
    entry = {"do": "material", "parts": [part], "density": mass / volume}
    return _material(entry, keys, bodies)[0], f"{part}: {mass:g} kg"


def _poses(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    """New poses of parts, as `kilter.workbench.answering` finds them; None: as in the file.

    Loads, joints and bonds at points of these parts are replaced by the moved entries.
    """
    poses, replaced = action.get("poses"), action.get("replaced") or {}
    if poses is None:
        return {"poses": None}, "parts placed as in the file"
    if not isinstance(poses, dict) or not isinstance(replaced, dict):
        raise InputError("the poses have another form", hint="settle the parts again")
    unknown = [name for name in poses if name not in bodies.names]
    if unknown:
        raise InputError(f"there is no part {_named(unknown)}", hint="settle the parts again")
    for key, words in (("sha256", "for other content of the file"), ("units", "in other units")):
        if key in action and action[key] != keys.get(key):
            raise InputError(f"the poses are {words}", hint="settle the parts again")
    new = {
        name: {
            "position": _vector(pose["position"], "the position"),
            "rotation": [_finite(x, "the rotation") for x in pose["rotation"]],
        }
        for name, pose in poses.items()
    }
    changes: Keys = {"poses": {**keys.get("poses", {}), **new}}
    for key, pairs in replaced.items():
        changes[key] = [
            next((after for before, after in pairs if before == entry), entry)
            for entry in keys.get(key, [])
        ]
    moved = action.get("moved")
    return changes, f"settle: parts move by up to {moved}" if moved else f"place {_named([*new])}"


# pairs ---------------------------------------------------------------------------------


def _fasten(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    a, b = _pair(action["parts"], bodies)
    joined = [pair for pair in keys.get("joined", []) if set(pair) != {a, b}]
    if action["on"]:
        return {"joined": [*joined, [a, b]]}, f"join {a} and {b}"
    if len(joined) == len(keys.get("joined", [])):
        raise InputError(
            f"no single choice joins {a!r} and {b!r}",
            hint="undo the choice that joins several pairs, or decide that the pair is apart",
        )
    return {"joined": joined}, f"do not join {a} and {b}"


def _switch(key: str, words: str) -> Callable[[Action, Keys, OpenedParts], tuple[Keys, str]]:
    """The action that sets a choice that is only true or false."""

    def change(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
        on = bool(action["on"])
        return {key: on or None}, words if on else f"not: {words}"

    return change


def _decide(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    pairs, state = [_pair(pair, bodies) for pair in action["pairs"]], action["as"]
    if state is not None and state not in STATES:
        raise InputError(f"a pair is {state!r:.40}", hint=f"use {', '.join(STATES)}")
    decided = [set(pair) for pair in pairs]
    kept = [entry for entry in keys.get("open_pairs", []) if set(entry["parts"]) not in decided]
    new = [] if state is None else [{"parts": list(pair), "as": state} for pair in pairs]
    about = f"{pairs[0][0]} and {pairs[0][1]}" if len(pairs) == 1 else f"{len(pairs)} pairs"
    words = "not decided" if state is None else state
    return {"open_pairs": [*kept, *new]}, f"{about}: {words}"


def _pair_friction(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    a, b = _pair(action["parts"], bodies, floor=True)
    kept = [entry for entry in keys.get("friction_pairs", []) if set(entry["parts"]) != {a, b}]
    if action.get("mu") is None:
        return {"friction_pairs": kept}, f"friction of {a} and {b} as of all contacts"
    mu = _not_negative(action["mu"], "the friction coefficient")
    entry = {"parts": [a, b], "mu": mu}
    return {"friction_pairs": [*kept, entry]}, f"friction of {a} and {b}: {mu:g}"


def _joint(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    a, b = _pair(action["parts"], bodies, floor=True, ground=True)
    entry = {
        "parts": [a, b],
        "kind": str(action["kind"]),
        "point": action.get("point"),
        "axis": action.get("axis"),
    }
    return (
        {"joints": [*keys.get("joints", []), _plain(entry)]},
        f"{entry['kind']} joint of {a} and {b}",
    )


def _bond(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    a, b = _pair(action["parts"], bodies, floor=True)
    pull = _not_negative(action["pull"], "the strength of the bond")
    entry = {"parts": [a, b], "pull": pull, "shear": action.get("shear")}
    return {"bonds": [*keys.get("bonds", []), _plain(entry)]}, f"bond of {a} and {b}: {pull:g} N"


def _index_in(entries: Sequence[Any], action: Action, words: str) -> int:
    """The index of an action in a list; an InputError if the list has no such entry."""
    index = index_of(action, "index")
    if index >= len(entries):
        raise InputError(f"there is no {words} number {index + 1}", hint="reload the page")
    return index


def _removal(key: str, words: str) -> Callable[[Action, Keys, OpenedParts], tuple[Keys, str]]:
    """The action that removes an entry of a list by its index."""

    def change(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
        entries = list(keys.get(key, []))
        index = _index_in(entries, action, words)
        del entries[index]
        return {key: entries}, f"remove {words} {index + 1}"

    return change


# forces --------------------------------------------------------------------------------


def _load(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    part = str(action["part"])
    if part not in bodies.names:
        raise InputError(f"there is no part {part!r:.60}", hint="select a part")
    entry = _plain(
        {
            "part": part,
            "force": _vector(action["force"], "the force"),
            "point": _vector(action["point"], "the point") if action.get("point") else None,
            "torque": _vector(action["torque"], "the torque") if action.get("torque") else None,
        }
    )
    loads = list(keys.get("loads", []))
    size = math.hypot(*entry["force"])
    if action.get("index") is None:
        return {"loads": [*loads, entry]}, f"load of {size:.3g} N on {part}"
    index = _index_in(loads, action, "load")
    loads[index] = entry
    return {"loads": loads}, f"load {index + 1}: {size:.3g} N on {part}"


def _strap(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    tension = _not_negative(action.get("tension"), "the tension")
    path = action.get("path")
    if not isinstance(path, list) or not all(isinstance(p, list) and len(p) == 2 for p in path):
        raise InputError(f"the path of a strap is {path!r:.60}", hint="click two or more points")
    points = [[str(name), _vector(at, "the point of a strap")] for name, at in path]
    entry = Strap([(name, at) for name, at in points], tension=tension)
    straps = [*keys.get("straps", []), {"path": points, "tension": entry.tension}]
    return {"straps": straps}, f"strap {len(straps)} of {tension:.3g} N over {len(points)} points"


def _scale_loads(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    factor = _not_negative(action["factor"], "the factor of the loads")
    loads = [
        {
            **load,
            **{key: [factor * x for x in load[key]] for key in ("force", "torque") if key in load},
        }
        for load in keys.get("loads", [])
    ]
    return {"loads": loads}, f"loads times {factor:g}"


def _friction(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    if action.get("mu") is None:
        return {"friction": None}, "friction as in the file"
    mu = _not_negative(action["mu"], "the friction coefficient")
    return {"friction": mu}, f"friction {mu:g}"


def _gravity(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    if action.get("up") is not None:
        return {"up": str(action["up"]), "gravity": None}, f"{action['up']} points up"
    if action.get("down") is None:
        return {"up": None, "gravity": None}, "gravity as in the file"
    down = _vector(action["down"], "the direction of gravity")
    length = math.hypot(*down)
    if not length > 0:
        raise InputError("the direction of gravity is zero", hint="give a direction")
    size = action.get("size", GRAVITY)
    gravity = [size * x / length + 0.0 for x in down]
    return {"up": None, "gravity": gravity}, f"gravity along {_numbers(down)}"


GRAVITY = 9.81
"""Standard size of gravity, for a direction that the user gives without a size [m/s^2]."""


def _improve(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    """A change that helps, from several actions; `label` states it in words."""
    actions = action["actions"]
    if any(each["do"] == "improve" for each in actions):
        raise InputError("a change contains another change", hint="reload the page")
    new = keys
    for each in actions:
        new, _ = apply(each, new, bodies)
    return {key: new.get(key) for key in {**keys, **new}}, str(action["label"])


# reading -------------------------------------------------------------------------------


def _assume(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    """The rung of the ladder of assumptions, and the friction that its row assumes."""
    rung = valid_rung(str(action["rung"]))
    if action.get("mu") is None:
        return {"assume": rung}, f"assume {rung}"
    mu = _not_negative(action["mu"], "the friction coefficient")
    return {"assume": rung, "friction": mu}, f"assume {rung}, friction {mu:g}"


def _units(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    units = action.get("value")
    if keys.get("poses"):
        raise InputError("moved parts have poses in the present units", hint="undo the movement")
    return {"units": units}, f"units {units}" if units else "units as in the file"


def _density(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    if action.get("value") is None:
        return {"density": None}, "density as in the file"
    value = _positive(action["value"], "the density")
    return {"density": value}, f"density {value:g} kg/m3"


def _tolerance(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    old = keys.get("tolerance") or {}
    names = ("gap", "angle_deg", "clearance")
    new = _plain({name: action.get(name, old.get(name)) for name in names})
    words = ", ".join(f"{name.removesuffix('_deg')} {value:g}" for name, value in new.items())
    return {"tolerance": new}, f"tolerance: {words or 'default'}"


def _contacts(action: Action, keys: Keys, bodies: OpenedParts) -> tuple[Keys, str]:
    source = action.get("value")
    return {"contacts": source}, f"contacts of the {source}" if source else "contacts: default"


ACTIONS: dict[str, Callable[[Action, Keys, OpenedParts], tuple[Keys, str]]] = {
    "assume": _assume,
    "hold": _hold,
    "floor": _floor,
    "leave_out": _leave_out,
    "fasten": _fasten,
    "fasten_suggested": _switch("fasten_suggested", "join the pairs that look fastened"),
    "fasten_overlaps": _switch("fasten_overlaps", "join the pairs that overlap"),
    "loose": _switch("loose", "loose tolerances"),
    "pair": _decide,
    "material": _material,
    "mass": _mass,
    "poses": _poses,
    "improve": _improve,
    "friction": _friction,
    "pair_friction": _pair_friction,
    "joint": _joint,
    "joint_off": _removal("joints", "joint"),
    "bond": _bond,
    "bond_off": _removal("bonds", "bond"),
    "load": _load,
    "load_off": _removal("loads", "load"),
    "scale_loads": _scale_loads,
    "gravity": _gravity,
    "strap": _strap,
    "strap_off": _removal("straps", "strap"),
    "units": _units,
    "density": _density,
    "tolerance": _tolerance,
    "contacts": _contacts,
}
"""Function of each action."""


# values --------------------------------------------------------------------------------


def _parts(action: Action, bodies: OpenedParts) -> list[str]:
    """Names of the parts of an action; at least a single part must exist."""
    parts = [str(name) for name in action["parts"]]
    known = bodies.matching(parts)
    if not known:
        raise InputError(f"there is no part {_named(parts) or '(none given)'}", hint="select parts")
    return known


def _pair(
    parts: Sequence[str], bodies: OpenedParts, *, floor: bool = False, ground: bool = False
) -> tuple[str, str]:
    a, b = (str(name) for name in parts)
    further = [*["floor"] * floor, *["ground"] * ground]
    for name in (a, b):
        if name not in bodies.names and name not in further:
            raise InputError(f"there is no part {name!r:.60}", hint="select two parts")
    if a == b:
        raise InputError(f"a pair of {a!r} with itself", hint="select two parts")
    return a, b


def _toggled(patterns: Sequence[str], parts: list[str], on: bool, bodies: OpenedParts) -> list[str]:
    """Patterns of names that include, or do not include, the given parts.

    Patterns with wildcards are replaced by names if they match a part that is not included.
    """
    if on:
        there = set(bodies.matching(patterns))
        return [*patterns, *(name for name in parts if name not in there)]
    gone = set(parts)
    kept: list[str] = []
    for pattern in patterns:
        matched = bodies.matching([pattern])
        hit = gone & set(matched)
        kept += [name for name in matched if name not in gone] if hit else [pattern]
    return kept


def _named(parts: Sequence[str]) -> str:
    """Names of parts for a label: the first two, and the number of the others."""
    if len(parts) <= 3:
        return ", ".join(map(short_name, parts))
    return f"{short_name(parts[0])}, {short_name(parts[1])} and {len(parts) - 2} others"


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{value:.4g}" for value in values)


def _plain(entry: Keys) -> Keys:
    return {key: value for key, value in entry.items() if value is not None}


def _finite(value: Any, what: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if isinstance(value, bool) or not math.isfinite(number):
        raise InputError(f"{what} is {value!r:.40}", hint="give a number")
    return number


def _positive(value: Any, what: str) -> float:
    number = _finite(value, what)
    if not number > 0:
        raise InputError(f"{what} is {number:g}", hint="give a number above 0")
    return number


def _not_negative(value: Any, what: str) -> float:
    number = _finite(value, what)
    if number < 0:
        raise InputError(f"{what} is {number:g}", hint="give 0 or a larger number")
    return number


def _vector(value: Any, what: str) -> list[float]:
    vector = [_finite(x, what) for x in value]
    if len(vector) != 3:
        raise InputError(f"{what} has {len(vector)} numbers", hint="give 3 numbers")
    return vector
