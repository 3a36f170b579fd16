"""False statements with the evidence of a valid proof, for every kind of proof file.

Each forger changes a valid proof so that its statement is false: other words, values, signs, sets,
paths, polygons, entries of another assembly, or evidence for an assembly of the opposite verdict.
Each gets a fresh digest, so that only the physics can refuse it.
"""

import copy
import dataclasses
import functools
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from forged_evidence import forged_forces, forged_motions
from lashings import direct
from limit_cases import limit_case

import kilter
from kilter import Assembly, Box, Part, PlanRules
from kilter.mechanics.bundle_changes import restored
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import Evidence, digest_of, make_proof
from kilter.scenes import SCENES, scene
from kilter.scenes.pieces import block

Data = dict[str, Any]
Random = np.random.Generator
Lie = Callable[[Data, Random], None]


@dataclass(frozen=True, slots=True, eq=False)
class Forgery:
    """A false proof of an assembly.

    Attributes
    ----------
    kind, title : str
        Kind of proof, and the lie.
    assembly : Assembly
    proof : dict
        JSON data with a fresh digest.
    require : str or None
        Level that the proof must not reach; None: the claimed level.
    """

    kind: str
    title: str
    assembly: Assembly
    proof: Data
    require: str | None = None

    def __repr__(self) -> str:
        return f"<Forgery: {self.kind}, {self.title}>"


def signed(proof: Data) -> Data:
    """The proof with a digest that fits; without one if the data are no JSON."""
    body = {key: value for key, value in proof.items() if key != "digest"}
    try:
        return {**body, "digest": digest_of(body)}
    except ValueError:
        return {**body, "digest": "0"}


def copied(proof: Data) -> Data:
    """A deep copy, as a file holds it."""
    data: Data = json.loads(json.dumps(proof))
    return data


Forger = Callable[[Random], Iterator[Forgery]]

# forces and motions ------------------------------------------------------------------------


def _forces(rng: Random) -> Iterator[Forgery]:
    """Forces for an assembly that falls, by optimisation and squeezes."""
    case = _certain(rng, stays=False)
    touching = kilter.contacts(case)
    program = build_program(case, touching)
    rough = bool(program.mu.any())
    for given in forged_forces(program, rng):
        judged = check_forces(program, *given)
        evidence = Evidence("open") if rough else None
        proof = make_proof(case, touching, program, judged, {}, evidence=evidence)
        yield Forgery("force", "forces of an assembly that falls", case, proof, "equilibrium")


def _motion(rng: Random) -> Iterator[Forgery]:
    """Motions for an assembly that stays, by optimisation and lifts."""
    case = _certain(rng, stays=True)
    touching = kilter.contacts(case)
    program = build_program(case, touching, possible=True)
    given = list(forged_motions(program, rng))
    for k in rng.permutation(len(given))[:12]:
        proof = make_proof(case, touching, program, check_motion(program, given[k]), {})
        yield Forgery("motion", "a motion of an assembly that stays", case, proof)


def _certain(rng: Random, *, stays: bool) -> Assembly:
    """An assembly whose verdict is certain, at a random distance from its limit."""
    while True:
        case = limit_case(int(rng.integers(10**6)))
        if case.certain and case.stays == stays:
            return case.assembly


# levels ------------------------------------------------------------------------------------


@functools.cache
def _checked(name: str, require: str = "settles") -> tuple[Assembly, str]:
    """A scene, and the text of its proof."""
    verdict = kilter.check(scene(name), require=require)
    return verdict.assembly, json.dumps(verdict.proof())


NOT_SETTLED = [name for name, entry in SCENES.items() if entry.answer == "potentially-stable"]
"""Scenes that a second motion with friction keeps from settling."""


def _settles(rng: Random) -> Iterator[Forgery]:
    """The level settles, for scenes in which a second motion obeys the contact law."""
    for name in rng.permutation(NOT_SETTLED)[:2].tolist():
        assembly, text = _checked(name)
        proof = json.loads(text)
        if proof["verdict"] != "potentially-stable" or "friction" not in proof:
            continue
        proof["verdict"] = "settles"
        proof["friction"].update(guarantee="open", witness=None, exclusion=None)
        proof["friction"]["tries"] = {"passed": 8, "of": 8}
        yield Forgery("settles", name, assembly, signed(proof))
        proof = json.loads(text)
        proof["verdict"] = "stable"
        proof["friction"].update(guarantee="proved", witness=None)
        for steps in ([], [{"power": {"rows": [], "values": [], "tangent": None}}]):
            proof["friction"]["exclusion"] = {
                "kind": "moments", "programs": 1, "assumes": "", "opening": None, "steps": steps,
            }  # fmt: skip
            yield Forgery("exclusion", f"{name} without steps", assembly, signed(proof))


@functools.cache
def _exclusions() -> list[tuple[Assembly, str]]:
    """Small assemblies with friction whose proof excludes every motion, with its text."""
    found = []
    for mu in (0.3, 0.6):
        for lean in (0.05, 0.15):
            parts = [
                block("floor", [-5, -5, -1], [5, 5, 0], grounded=True),
                block("box", [-1, -1, 0], [1, 1, 1], mass=1.0),
            ]
            down = [np.sin(lean), 0, -np.cos(lean)]
            verdict = kilter.check(Assembly(parts, friction=mu).with_down(down))
            proof = verdict.proof()
            if (proof.get("friction") or {}).get("exclusion"):
                found.append((verdict.assembly, json.dumps(proof)))
    return found


def _exclusion(rng: Random) -> Iterator[Forgery]:
    """Exclusions of one assembly for scenes in which a second motion obeys the contact law."""
    for _, text in _exclusions():
        for name in rng.permutation(NOT_SETTLED)[:2].tolist():
            assembly, other = _checked(name)
            proof = json.loads(other)
            if proof["verdict"] != "potentially-stable" or "friction" not in proof:
                continue
            proof["verdict"] = "stable"
            exclusion = json.loads(text)["friction"]["exclusion"]
            size = 10 ** rng.uniform(-3, 12)
            for step in exclusion["steps"]:
                _scale_numbers(step, size)
            proof["friction"].update(guarantee="proved", witness=None, exclusion=exclusion)
            yield Forgery("exclusion", f"of a box, for {name}", assembly, signed(proof))


def _scale_numbers(data: Any, size: float) -> None:
    for key, value in list(data.items()):
        if isinstance(value, dict):
            _scale_numbers(value, size)
        elif key in ("values", "equal", "positive", "cones"):
            data[key] = [size * x for x in value]


BALANCED = [
    name
    for name, entry in SCENES.items()
    if entry.answer == "balanced" and len(entry.build().parts) <= 6
]
"""Small scenes that a small push makes fall."""


def _second_order(rng: Random) -> Iterator[Forgery]:
    """Strict or stable, for balanced scenes; balanced, for scenes at a minimum."""
    for name in rng.permutation(BALANCED)[:2].tolist():
        assembly, text = _checked(name, "strict")
        proof = json.loads(text)
        second = proof.get("second_order")
        if proof["verdict"] != "balanced" or second is None:
            continue
        for state in ("minimum", "free", "balanced"):
            lie = copied(proof)
            lie["verdict"] = "stable"
            lie["second_order"]["state"] = state
            for entry in lie["second_order"].get("clusters") or []:
                if entry is not None:
                    entry["state"] = state
            for key in ("rolling", "neutral", "free"):
                if rng.random() < 0.3:
                    lie["second_order"].pop(key, None)
            yield Forgery("second order", f"{name} is {state}", assembly, signed(lie), "proved")


# poses at rest -----------------------------------------------------------------------------

TABLE = Part("table", Box([4, 4, 1]), [0, 0, -0.5], grounded=True)


@functools.cache
def _resting(friction: float) -> tuple[Assembly, str]:
    box = Part("box", Box([1, 1, 1]), [0, 0, 0.51], mass=1.0)
    drawn = Assembly([TABLE, box], friction=friction)
    answer = kilter.settle(drawn)
    return answer.assembly, json.dumps(answer.proof())


def _rest(rng: Random) -> Iterator[Forgery]:
    """Rest of a box that floats, slides or stays."""
    assembly, text = _resting(0.0)
    lift = float(10 ** rng.uniform(-6, 1))
    floats = assembly.with_pose("box", assembly.parts[1].pose.position + np.array([0, 0, lift]))
    proof = _of(assembly, floats, text)
    proof["rest"] = {"gap": 2 * lift}
    for point in proof["points"]:
        point["x"][2] += lift / 2
    yield Forgery("rest", "a box that floats", floats, signed(proof), "equilibrium")
    proof["rest"] = {"gap": 1e-9}
    yield Forgery("rest", "a box that floats, small gap", floats, signed(proof), "equilibrium")
    lean = float(10 ** rng.uniform(-7, -0.5))
    slides = assembly.with_down([np.sin(lean), 0, -np.cos(lean)])
    rough = assembly.with_friction(1.0).with_down(slides.down)
    own = kilter.check(rough, require="equilibrium").proof()
    own["verdict"] = "potentially-stable"
    if own.get("friction") is not None:
        own["friction"].update(guarantee="open", exclusion=None, witness=None)
        own["rest"] = {"gap": 1e-9}
        yield Forgery("rest", "friction of its own", slides, signed(own), "equilibrium")
    tilted = _of(assembly, slides, text)
    tilted.pop("second_order", None)
    for point in tilted["points"]:
        point["normal"] = (-slides.down * np.sign(point["normal"][2])).tolist()
    level = _balanced(tilted, slides)
    yield Forgery("rest", "normals of its own", slides, signed(level), "equilibrium")
    high = assembly.with_pose("box", [0, 0, 3.0])
    falls = kilter.check(high).proof()
    falls["parts"], falls["points"] = json.loads(text)["parts"], []
    falls["rest"] = {"gap": 1e-9}
    yield Forgery("rest", "a motion of a box at rest", assembly, signed(falls))


def _of(assembly: Assembly, other: Assembly, text: str) -> Data:
    """The proof of an assembly with the centres and the gravity of another."""
    proof: Data = json.loads(text)
    for k, part in enumerate(proof["parts"]):
        part["center"] = other.geometry.center[k].tolist()
    proof["gravity"], proof["down"] = other.gravity.tolist(), other.down.tolist()
    return proof


def _balanced(proof: Data, assembly: Assembly) -> Data:
    """The proof with forces along its normals that balance the only free part as well as can be."""
    from scipy.optimize import nnls

    points = np.array([point["x"] for point in proof["points"]])
    normals = np.array([point["normal"] for point in proof["points"]])
    arms = np.cross(points - assembly.geometry.center[1], normals)
    load = assembly.geometry.mass[1] * assembly.gravity
    matrix = np.vstack([normals.T, arms.T])
    shares, rest = nnls(matrix, -np.append(load, np.zeros(3)))
    proof["forces"] = (shares[:, None] * normals).tolist()
    proof["certificate"]["residual"] = rest / float(np.linalg.norm(load))
    return proof


# files of several proofs -------------------------------------------------------------------


@functools.cache
def _bundle(kind: str) -> tuple[Assembly, str]:
    """A valid file of several proofs of a kind, and its assembly."""
    parts = [
        block("floor", [-5, -5, -1], [5, 5, 0], grounded=True),
        block("box", [-1, -1, 0], [1, 1, 1], mass=1.0),
        block("top", [-0.5, -0.5, 1], [0.5, 0.5, 2], mass=0.3),
    ]
    rough, smooth = Assembly(parts, friction=0.3), Assembly(parts)
    walls = [
        block("wall-x", [1, -3, 0], [2, 3, 2], grounded=True),
        block("wall-y", [-3, 1, 0], [1, 2, 2], grounded=True),
    ]
    corner = Assembly([parts[0], *walls, parts[1]])
    hanging = Assembly(
        [
            block("floor", [-2, -2, -1], [2, 2, 0], grounded=True),
            block("left", [-4, -0.5, 0], [-1.2, 0.5, 1], mass=1.0),
            block("right", [1.2, -0.5, 0], [4, 0.5, 1], mass=2.0),
        ]
    )
    lever = Assembly(
        [
            block("base", [0, 0, -1], [1, 1, 0], grounded=True),
            block("a", [0.3, 0, 0], [2.1, 1, 0.5]),
            block("b", [0.3, 0, 0.5], [0.9, 1, 2.5]),
        ]
    )
    load = direct(45, 2000.0)
    bare = dataclasses.replace(load, straps=())
    level = Assembly(parts[:2], friction=0.3)
    around = [
        kilter.Strap([("ground", [4 * x, 4 * y, 0.3]), ("box", [x, y, 0.3])], capacity=3.0)
        for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
    ]
    made: dict[str, Callable[[], tuple[Assembly, Any]]] = {
        "region": lambda: (corner, kilter.region(corner)),
        "margin": lambda: (rough, kilter.margin(rough, about=[0, 1, 0], push=[1, 0, 0])),
        "transport": lambda: (rough, kilter.transport(rough, collapse=True)),
        "plan": lambda: (smooth, kilter.plan(smooth)),
        "no plan": lambda: (lever, kilter.plan(lever, PlanRules(hold=0))),
        "held plan": lambda: (lever, kilter.plan(lever, PlanRules(hold=1))),
        "hold": lambda: (hanging, kilter.hold(hanging)),
        "lashing": lambda: (
            bare,
            kilter.hold(bare, straps=[load.straps[0]] * 2, require="equilibrium"),
        ),
        "lashing of a code": lambda: (
            level,
            kilter.hold(level, straps=around, code="eumos:0.5", require="equilibrium"),
        ),
        "place": lambda: (
            smooth,
            kilter.place(smooth, kilter.box_to_place([0.7, 0.5, 0.2], 0.2), accuracy=0.1),
        ),
    }
    assembly, answer = made[kind]()
    proof = answer.proof()
    assert kilter.verify(assembly, copied(proof)).holds, kind
    return assembly, json.dumps(restored(proof))


def _lies(kind: str, lies: list[tuple[str, Lie]]) -> Forger:
    """A forger that applies each of some lies to the valid file of a kind."""

    def forger(rng: Random) -> Iterator[Forgery]:
        assembly, text = _bundle(kind)
        for title, lie in lies:
            proof = json.loads(text)
            lie(proof, rng)
            yield Forgery(kind, title, assembly, signed(proof))

    return forger


def _any(rng: Random, entries: list[Any]) -> Any:
    return entries[int(rng.integers(len(entries)))]


def _drop(proof: Data, about: str, rng: Random) -> None:
    proof["proofs"].remove(_any(rng, [e for e in proof["proofs"] if e["about"] == about]))


def _shares(rng: Random) -> float:
    """A factor that is not 1."""
    return float(_any(rng, [1e-6, 0.5, 0.9, 1.001, 1.1, 2.0, 1e6]))


def _flip(proof: Data, rng: Random) -> None:
    entry = _any(rng, proof["proofs"])
    entry["held"] = not entry["held"]


def _value(proof: Data, rng: Random) -> None:
    entry = _any(rng, proof["proofs"])
    entry["value"] *= _shares(rng)


def _another_axis(proof: Data, rng: Random) -> None:
    entry = _any(rng, [e for e in proof["proofs"] if "axis" in e])
    turn = rng.uniform(0.01, np.pi)
    entry["axis"] = _any(
        rng, [[0.0, -1.0, 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 1.0, 0.1]]
    )


def _another_end(proof: Data, rng: Random) -> None:
    """The names of the least and of the greatest load factor are exchanged."""
    names = {"load factor": "least load factor", "least load factor": "load factor"}
    for entry in proof["proofs"]:
        entry["about"] = names.get(entry["about"], entry["about"])


def _another_mass(proof: Data, rng: Random) -> None:
    entry = _any(rng, [e for e in proof["proofs"] if "participating_mass" in e])
    entry["participating_mass"] *= _shares(rng)


def _as_multiplier(proof: Data, rng: Random) -> None:
    """A vertical limit, one of half the weights, or one of the opposite forces."""
    entry = _any(rng, [e for e in proof["proofs"] if e["about"][0] in "+-"])
    if entry["about"][1] != "z":
        if rng.random() < 0.5:
            entry["value"] *= 2
            entry["motion"]["acceleration"] = [x / 2 for x in entry["motion"]["acceleration"]]
        else:
            entry["about"] = entry["about"].translate(str.maketrans("+-", "-+"))
    entry["about"] = "alpha " + entry["about"].translate(str.maketrans("+-", "-+"))


def _more_loads(proof: Data, rng: Random) -> None:
    entry = _any(rng, proof["proofs"])
    key = _any(rng, ["mu", "strength", "held", "without"])
    entry["change"][key] = 5.0 if key in ("mu", "strength") else ["box"]


def _coarse(value: Any) -> Any:
    """A value whose numbers are rounded, so that equal values compare equal."""
    if isinstance(value, dict):
        return {key: _coarse(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_coarse(inner) for inner in value]
    return round(value, 6) if isinstance(value, float) else value


def _exchange(key: str) -> Callable[[Data, Random], None]:
    def lie(proof: Data, rng: Random) -> None:
        kinds = [
            (a, b)
            for a in proof["proofs"]
            for b in proof["proofs"]
            if _coarse(a[key]) != _coarse(b[key])
        ]
        first, second = _any(rng, kinds)
        first[key], second[key] = second[key], first[key]

    return lie


def _exchange_evidence(proof: Data, rng: Random) -> None:
    held = [e for e in proof["proofs"] if "forces" in e["proof"]]
    falls = [e for e in proof["proofs"] if "motion" in e["proof"]]
    first, second = _any(rng, held), _any(rng, falls or held[:1])
    if first is second:
        first["proof"]["forces"] = [[0.0] * 3 for _ in first["proof"]["forces"]]
    first["proof"], second["proof"] = second["proof"], first["proof"]


def _turn_ray(proof: Data, rng: Random) -> None:
    """A ray beyond the region: away from the walls, so that the box slides."""
    entry = _any(rng, [e for e in proof["proofs"] if e["about"] == "ray"])
    beyond = np.array(entry["vector"]) - [*rng.uniform(1.1, 3, size=2), 0.0]
    down = (beyond / np.linalg.norm(beyond)).tolist()
    entry["vector"] = entry["change"]["down"] = entry["proof"]["down"] = down
    entry["proof"]["gravity"] = (9.81 * np.array(down)).tolist()


def _small_gap(proof: Data, rng: Random) -> None:
    """The stated gap, with a facet left out."""
    _drop(proof, "facet", rng)
    proof["gap_deg"] = 1e-3


def _rougher(proof: Data, rng: Random) -> None:
    for entry in proof["proofs"]:
        if entry["about"] == "ray":
            entry["change"]["mu"] = 5.0


def _no_step(proof: Data, rng: Random) -> None:
    _drop(proof, "step", rng)


def _steps_exchanged(proof: Data, rng: Random) -> None:
    steps = [k for k, e in enumerate(proof["proofs"]) if e["about"] == "step"]
    a, b = steps[:2]
    proof["proofs"][a], proof["proofs"][b] = proof["proofs"][b], proof["proofs"][a]


def _path(legs: list[Any]) -> Callable[[Data, Random], None]:
    def lie(proof: Data, rng: Random) -> None:
        _any(rng, [e for e in proof["proofs"] if e["about"] == "step"])["legs"] = legs

    return lie


def _rules(**rules: Any) -> Callable[[Data, Random], None]:
    def lie(proof: Data, rng: Random) -> None:
        proof["rules"].update(rules)

    return lie


def _no_grip(proof: Data, rng: Random) -> None:
    step = _any(rng, [e for e in proof["proofs"] if e["about"] == "step" and e["change"]["held"]])
    step["change"]["held"] = []


def _no_motion(proof: Data, rng: Random) -> None:
    proof["proofs"] = [e for e in proof["proofs"] if "motion" not in e["proof"]]


def _one_motion(proof: Data, rng: Random) -> None:
    proof["proofs"] = [_any(rng, proof["proofs"])]


def _fewer(key: str) -> Callable[[Data, Random], None]:
    def lie(proof: Data, rng: Random) -> None:
        entry = next(e for e in proof["proofs"] if e["about"] == "held")
        entry[key] = entry[key][:1]

    return lie


def _wider(name: str) -> Callable[[Data, Random], None]:
    """Places that are stated beyond the proved places, by 1 % to 100 % of the domain."""

    def lie(proof: Data, rng: Random) -> None:
        low_x, low_y, high_x, high_y = proof["map"]["domain"]
        more = rng.uniform(0.01, 1) * (high_x - low_x)
        square = [[low_x, low_y], [high_x + more, low_y], [high_x + more, high_y], [low_x, high_y]]
        _any(rng, proof["map"]["levels"])[name] = [[square]]

    return lie


KINDS: dict[str, Forger] = {
    "force": _forces,
    "motion": _motion,
    "settles": _settles,
    "exclusion": _exclusion,
    "second order": _second_order,
    "rest": _rest,
    "region": _lies("region", [
        ("a ray beyond", _turn_ray), ("a facet left out", _small_gap), ("rougher rays", _rougher),
        ("more changes", _more_loads), ("vectors exchanged", _exchange("vector")),
        ("evidence exchanged", _exchange_evidence), ("words exchanged", _exchange("about")),
    ]),
    "margin": _lies("margin", [
        ("held flipped", _flip), ("another value", _value), ("more changes", _more_loads),
        ("values exchanged", _exchange("value")), ("evidence exchanged", _exchange_evidence),
        ("changes exchanged", _exchange("change")), ("another axis", _another_axis),
        ("another end of the load factors", _another_end),
    ]),
    "transport": _lies("transport", [
        ("held flipped", _flip), ("another value", _value), ("more changes", _more_loads),
        ("values exchanged", _exchange("value")), ("evidence exchanged", _exchange_evidence),
        ("changes exchanged", _exchange("change")), ("another mass", _another_mass),
        ("an acceleration as a multiplier", _as_multiplier),
    ]),
    "plan": _lies("plan", [
        ("a step left out", _no_step), ("steps exchanged", _steps_exchanged),
        ("no path", _path([])), ("a short path", _path([[[0.0, 0.0, 1.0], 1e-3]])),
        ("a path through the floor", _path([[[0.0, 0.0, -1.0], None]])),
    ]),
    "no plan": _lies("no plan", [
        ("one part may be held", _rules(hold=1)), ("all may be held", _rules(hold=9)),
        ("a part left out", _one_motion),
        ("parts move together", _rules(hold=1, groups=[["a", "b"]])),
    ]),
    "held plan": _lies("held plan", [
        ("no part is held", _no_grip), ("no part may be held", _rules(hold=0)),
        ("a step left out", _no_step), ("no part is holdable", _rules(never_held=["a", "b"])),
    ]),
    "hold": _lies("hold", [
        ("no motion", _no_motion), ("fewer supports", _fewer("supports")),
        ("more are needed", _rules(least=3)), ("evidence exchanged", _exchange_evidence),
    ]),
    "lashing": _lies("lashing", [
        ("no motion", _no_motion), ("fewer straps", _fewer("chosen")),
        ("more are needed", _rules(least=3)), ("fewer are needed", _rules(least=1)),
    ]),
    "lashing of a code": _lies("lashing of a code", [
        ("no motion", _no_motion), ("fewer straps", _fewer("chosen")),
        ("more are needed", _rules(least=5)), ("fewer are needed", _rules(least=3)),
        ("a direction left out", lambda proof, rng: _drop(proof, "held", rng)),
        ("a harder code", _rules(code={"name": "en12195", "forward": [1.0, 0.0, 0.0]})),
        ("no code", _rules(code=None)),
    ]),
    "place": _lies("place", [
        ("stands everywhere", _wider("stands")), ("falls everywhere", _wider("falls")),
    ]),
}  # fmt: skip
"""Forgers by kind of proof."""

# damage ------------------------------------------------------------------------------------

STATED = {
    "about", "verdict", "value", "held", "gap_deg", "rules", "levels", "vector", "tolerance",
    "options", "second_order", "kilter_proof", "kilter_proofs", "kind", "map", "change",
}  # fmt: skip
"""Keys that make the statement, whose loss could make it true."""
JUNK: list[Any] = [
    None, True, -1, 0, 1e300, -1e300, 1e150, 10**400, float("nan"), float("inf"), "", "x", [], {},
    [[]], "\x00", 2**63,
]  # fmt: skip


def damaged(forgery: Forgery, rng: Random) -> Forgery:
    """A forgery with a random key dropped, or a value of another type or size, at any depth."""
    proof = copy.deepcopy(forgery.proof)
    place: Any = proof
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        keys = [key for key in keys if key not in STATED]
        if not keys:
            break
        key = _any(rng, keys)
        inner = place[key]
        if isinstance(inner, dict | list) and len(inner) and rng.random() < 0.8:
            place = inner
            continue
        if isinstance(place, dict) and rng.random() < 0.3:
            del place[key]
        elif place is not proof.get("proofs"):
            place[key] = _any(rng, JUNK)
        break
    return dataclasses.replace(forgery, title=f"{forgery.title}, damaged", proof=signed(proof))


def forgeries(kind: str, seed: int) -> Iterator[Forgery]:
    """Forgeries of a kind, each followed by a damaged copy; equal seeds give equal forgeries."""
    rng = np.random.default_rng([seed, sorted(KINDS).index(kind)])
    for forgery in KINDS[kind](rng):
        yield forgery
        yield damaged(forgery, rng)
