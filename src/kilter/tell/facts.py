"""What an answer says beside its sentence: terms, and what they are in words.

Every voice says these and no others: the terminal, a notebook, the page. They are read from
the answer as data (its `to_dict()`, which `--json` prints), never from what made it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from kilter.errors import some
from kilter.tell.numbers import angle, counts, force, number, plain, vector
from kilter.tell.open_words import open_facts

__all__ = [
    "ROWS",
    "Answer",
    "Fact",
    "facts",
    "forces_phrase",
    "kind_of",
    "region_phrase",
    "region_words",
]

Answer = Mapping[str, Any]
Fact = tuple[str, str]

ROWS = 20
"""Vectors of a region that are told one by one."""
TELLING = {
    "kilter": "assembly",
    "rotation": "orient",
    "facets": "region",
    "tilt_deg": "margin",
    "histogram": "contacts",
    "reasons": "verify",
    "certificate": "check",
}
"""A key that only one kind of answer has; the first that is there tells the kind."""
MOST_OF_FREE_FALL = 0.9
"""A bound of the power of any motion that is above this share of free fall is not worth words."""
GUARANTEE = {
    "proved": "proved: no other motion obeys Coulomb's law",
    "refuted": "refuted: another motion obeys Coulomb's law",
    "open": "open: neither proved nor refuted",
}
SEATED = {
    "yes": "yes: put there with care, its own weight holds it",
    "runs-away": "no: from every start its parts run away",
    "not-found": "not found",
}
WHY = {
    "refuted": "a motion obeys the contact law too",
    "jams": "it can jam, but does not come to rest in every try",
    "squeeze": "only squeeze holds it",
    "not-found": "no seat was found, or not every try was made to its end",
}
DIRECTIONS = {
    "lines": "both senses stable",
    "rays": "extreme directions",
    "equations": "q.g = 0",
    "facets": "q.g >= 0",
}


def kind_of(answer: Answer) -> str:
    """Which answer it is: check, contacts, orient, region, margin, verify or assembly.

    Raises
    ------
    ValueError
        If it is none of them.

    Examples
    --------
    >>> kind_of({"histogram": {}})
    'contacts'
    """
    for key, kind in TELLING.items():
        if key in answer:
            return kind
    raise ValueError(f"no answer of kilter has only the keys {', '.join(answer)}")


def facts(answer: Answer) -> list[Fact]:
    """Terms of an answer and what they are, in words; an empty term goes on with the last.

    Parameters
    ----------
    answer : mapping
        The data of an answer (`to_dict()`), or of an assembly (`kilter.files.to_dict`).

    Examples
    --------
    >>> facts({"kilter": 1, "units": "mm", "parts": [{"name": "a", "grounded": True}]})
    [('parts', '1, held: a'), ('units', 'mm')]
    """
    return _TELLERS[kind_of(answer)](answer)


def _check(answer: Answer) -> list[Fact]:
    found = [
        ("parts", _parts(answer["parts"])),
        ("units", f"{answer['units']}; {_density(answer['density'])}"),
        ("mass", f"{number(_free_mass(answer['parts']))} kg free"),
        ("gravity", _gravity(answer)),
        ("contacts", counts(**answer["contacts"])),
        *_joints(answer),
        ("proof", _proof(answer)),
    ]
    found += open_facts(answer)
    friction = answer["friction"]
    if friction is not None:
        found.append(("guarantee", _guarantee(answer["guarantee"], friction)))
    if answer["seated"] is not None:
        found.append(("seated", SEATED[answer["seated"]]))
        found.append(("settles", _settles(**answer["tries"], asked=friction["settling"]["of"])))
    if answer["level"] is not None:
        found.append(("level", _level(answer)))
    forces = forces_phrase(answer["forces"])
    if forces is not None:
        found.append(("forces", forces))
    if answer["z"] is not None and answer["verdict"] != "stable":
        found.append(("instability", _instability(answer)))
    if answer["neutral"] is not None:
        closed = answer["counted_gap"] is not None
        found.append(("neutral", _neutral(**answer["neutral"], closed=closed)))
    return [*found, *_seconds(answer)]


def _level(answer: Answer) -> str:
    """The level reached, and what was asked for."""
    level, why = answer["level"], answer["why"]
    words = level if why is None else f"{level}: {WHY[why]}"
    return words if answer["holds"] else f"{words} (asked for: {answer['require']})"


def _settles(passed: int, of: int, *, asked: int) -> str:
    """How it came to rest when it was put down loosely."""
    words = f"{passed} of {of} loose tries came to rest"
    return words if of == asked else f"{words}; {asked} were to be made"


def _parts(parts: Sequence[Answer]) -> str:
    held = [plain(part["name"]) for part in parts if part.get("grounded")]
    return f"{len(parts)}, held: {some(held) or 'none (joints to the ground)'}"


def _free_mass(parts: Iterable[Answer]) -> float:
    return math.fsum(part["mass"] for part in parts if not part["grounded"])


def _density(density: Answer) -> str:
    """What the masses of the free parts rest on."""
    words = []
    if density["given"] is not None:
        ends = [number(end) for end in dict.fromkeys(density["given"])]
        words.append(f"density {' to '.join(ends)} kg/m^3")
    if density["default"] is not None:
        words.append(f"density {number(density['default'])} kg/m^3 where none is given")
    return ", ".join(words) or "masses as given"


def _gravity(answer: Answer) -> str:
    size = math.hypot(*answer["gravity"])
    along = [component / size for component in answer["gravity"]]
    return f"{number(size)} m/s^2 along {vector(along)}"


def _joints(answer: Answer) -> list[Fact]:
    """The joints, a row a kind."""
    found: list[Fact] = []
    joints = answer.get("joints", ())
    for kind in dict.fromkeys(joint["kind"] for joint in joints):
        pairs = [
            " - ".join(plain(name) for name in joint["parts"])
            for joint in joints
            if joint["kind"] == kind
        ]
        found.append(("" if found else "joints", f"{len(pairs)} {kind}: {some(pairs)}"))
    return found


def _proof(answer: Answer) -> str:
    """What proves a verdict."""
    proof = answer["certificate"]
    if proof["kind"] == "forces":
        limit = f"(tolerance {answer['tolerance']['verdict']:.0e})"
        return f"{_balance(proof['residual'])} {limit}, recomputed apart from the solver"
    if proof["kind"] == "motion":
        return (
            f"a motion that gains {proof['power']:.4g} W at 1 m/s and violates "
            f"{_violation(proof['violation'])}, recomputed apart from the solver"
        )
    return "none"


def _violation(violation: float) -> str:
    return f"contacts by {abs(violation):.0e}" if violation else "no contact"


def _balance(residual: float) -> str:
    how = f"to {residual:.1e} of its weight" if residual else "exactly"
    return f"contact forces that balance every part {how}"


def _guarantee(guarantee: str, friction: Answer) -> str:
    """What friction guarantees, and how that is known."""
    words = GUARANTEE[guarantee]
    if guarantee == "open":
        words += f" (more than --effort {number(friction['effort'])} may decide)"
    exclusion, witness = friction["exclusion"], friction["witness"]
    if exclusion is not None and exclusion["proved"]:
        words += f" ({exclusion['kind']}, {exclusion['programs']} programs)"
    elif guarantee == "open" and exclusion is not None and exclusion["bound"] < MOST_OF_FREE_FALL:
        share = f"{100 * exclusion['bound']:.2g} %"
        words += f"; any motion starts with at most {share} of the power of free fall"
    if witness is not None:
        words += f" (to {witness['residual']:.1e})" if witness["residual"] else " (exactly)"
    return words


def forces_phrase(forces: Answer | None) -> str | None:
    """The greatest contact force, and where most of the friction is used; None of none."""
    patches = [] if forces is None else forces["patches"]
    if not patches:
        return None
    greatest = max(patches, key=lambda patch: math.hypot(*patch["resultant"]))
    words = f"up to {force(math.hypot(*greatest['resultant']))}, {_pair(greatest)}"
    rubs = [patch for patch in patches if patch["utilisation"]]
    if rubs:
        most = max(rubs, key=lambda patch: float(patch["utilisation"]))
        words += f"; friction used up to {100 * most['utilisation']:.3g} %, {_pair(most)}"
    return words


def _pair(patch: Answer) -> str:
    first, second = patch["parts"]
    return f"{plain(first)} on {plain(second)}"


def _instability(answer: Answer) -> str:
    words = f"z = {number(answer['z'])} (LP (9): kg, {answer['units']}, gravity 1)"
    if answer["instability"] is not None:
        words += f", kappa = {number(answer['instability'])} (0 stable, 1 free fall)"
    return words


def _neutral(two_sided: int, one_sided: int, *, closed: bool = False) -> str:
    if two_sided + one_sided == 0:
        return "none, counting gaps as closed" if closed else "none: strictly held"
    return (
        f"{two_sided} two-sided, {one_sided} one-sided motions cost no energy to first order; "
        "only there does second order matter"
    )


def _seconds(answer: Answer) -> list[Fact]:
    taken = answer.get("seconds") or {}
    words = ", ".join(f"{key} {value:.2g}" for key, value in taken.items())
    return [("seconds", words)] if words else []


def _orient(answer: Answer) -> list[Fact]:
    turn = f"quaternion (w, x, y, z) {vector(answer['rotation'])}: takes it to the file's gravity"
    found = [
        ("down", f"{vector(answer['down'])} in the frame of the assembly"),
        ("turn", turn),
    ]
    if answer["found"]:
        margin = angle(answer["tilt_margin_deg"])
        found.append(("margin", f"{margin} to the nearest unstable direction"))
        found.append(("region", region_phrase(**answer["region"])))
        if answer["residual"] is not None:
            found.append(("proof", _balance(answer["residual"])))
    else:
        found.append(("instability", _instability(answer)))
        found += _nearest(answer["nearest"])
    return [*found, *_joints(answer), ("programs", f"{answer['programs']} solved")]


def _nearest(near: Answer | None) -> list[Fact]:
    """The directions nearest to stable, in three senses."""
    if near is None:
        return []
    at = {key: vector(one["direction"]) for key, one in near.items()}
    value = {key: number(one["value"]) for key, one in near.items()}
    bound = number(near["kappa"]["bound"])
    return [
        ("nearest", f"{at['diamond']} on the paper's diamond, z = {value['diamond']}"),
        ("", f"{at['sphere']} on the sphere, z = {value['sphere']}"),
        ("", f"{at['kappa']} by kappa, {value['kappa']} (no direction has less than {bound})"),
    ]


def region_phrase(kind: str, half_angle_deg: float | None, *, friction: bool) -> str:
    """A region in few words.

    Examples
    --------
    >>> region_phrase("fan", 45.0, friction=False)
    'fan, half angle 45 deg'
    """
    width = "" if half_angle_deg is None else f", half angle {angle(half_angle_deg)}"
    return f"{kind}{width}{', with friction' if friction else ''}"


def region_words(answer: Answer, *, proved_none: bool) -> str:
    """A region in few words, and whether it is all of it."""
    words = region_phrase(answer["kind"], answer["half_angle_deg"], friction=answer["friction"])
    if answer["complete"] or proved_none:
        return words
    return f"{words}; an inner one: further forces may make it larger"


def _region(answer: Answer) -> list[Fact]:
    found = [("kind", f"{answer['kind']}, dimension {answer['dimension']}")]
    if answer["center"] is not None:
        center = f"{vector(answer['center'])}: the direction with the widest margin"
        found.append(("center", center))
    if answer["half_angle_deg"] is not None:
        half = angle(answer["half_angle_deg"])
        found.append(("half angle", f"{half}, of the widest circular cone inside"))
    if answer["gap_deg"] is not None:
        gap = f"{answer['gap_deg']:.3g} deg at most between rays inside, facets outside"
        found.append(("gap", gap))
    for name, what in DIRECTIONS.items():
        listed = [vector(one) for one in answer[name][:ROWS]]
        found += [
            ("" if k else name, words if k else f"{words}  ({what})")
            for k, words in enumerate(listed)
        ]
        if len(answer[name]) > ROWS:
            found.append(("", f"and {len(answer[name]) - ROWS} more"))
    return [*found, *_joints(answer), ("programs", f"{answer['programs']} solved")]


def _margin(answer: Answer) -> list[Fact]:
    found = [*_joints(answer), ("tilt", _tilt(answer))]
    about = answer["about"]
    if about is not None:
        turn = about["tilt_deg"]
        words = "a full turn is held" if turn is None else angle(turn)
        found.append(("about axis", words + _starting(about["limit"])))
    found.append(("friction", _least_friction(answer)))
    limits = answer["load_limits"]
    if limits is not None:
        ends = answer["load_factor"]
        words = "not known: the numbers failed"
        if answer["missing"].get("load_factor") != "failed":
            words = "no factor is held, however small or large"
        words = words if ends is None else _interval(ends) + _starting(limits[1])
        found.append(("load factor", words))
    if answer["load_factor_bracket"] is not None:
        found.append(("bracket", _bracket(answer["load_factor_bracket"]["greatest"])))
    if "none" in [why for what, why in answer["missing"].items() if what.startswith("push of")]:
        found.append(("pushes", "none is resisted: it is not in balance as given"))
    found += _worst(answer["uncertainty"])
    helps = [one["sentence"] for one in answer["helps"]]
    return found + [("" if k else "helps", words) for k, words in enumerate(helps)]


def _interval(ends: Sequence[float | None]) -> str:
    return " to ".join("unlimited" if end is None else number(end) for end in ends)


def _starting(limit: Answer | None) -> str:
    """What starts to move beyond a limit."""
    names = [] if limit is None else [plain(name) for name in limit["moves"]]
    if limit is None or limit["mechanism"] is None:
        return ""
    return f"; then {some(names)} start{'s' if len(names) == 1 else ''} to move"


def _tilt(answer: Answer) -> str:
    tilt, lower = answer["tilt_deg"], answer["tilt_lower_deg"]
    if tilt is None:
        why = answer["missing"].get("tilt")
        if why is None:
            return "none: given loads do not turn with gravity"
        if why == "failed":
            return "not known: the numbers failed"
        return "none: not held as given, nor with gravity along any direction within a right angle"
    down = vector(answer["tilt_down"])
    if lower is None:
        return f"{angle(tilt)}: outside; the nearest held direction is {down}"
    if answer["tilt_limit"]["mechanism"] is None:
        return "more than 90 deg: no tilt up to a right angle fails"
    words = f"{angle(tilt)} to the nearest direction that fails"
    if tilt - lower > 1e-6 * max(tilt, 1e-12):
        words += f" (at least {number(lower)})"
    return f"{words}, down = {down}{_starting(answer['tilt_limit'])}"


def _least_friction(answer: Answer) -> str:
    least = answer["friction"]
    if least is None:
        failed = answer["missing"].get("friction") == "failed"
        return "not known: the numbers failed" if failed else "none is enough to hold it"
    if least == 0.0:
        attained = answer["friction_limit"]["attained"]
        return (
            "none is needed"
            if attained
            else "any mu above 0 holds, since parts are clamped between others"
        )
    return f"mu >= {number(least)}, the same at every contact"


def _bracket(greatest: Sequence[float | None] | None) -> str:
    """Where the greatest load factor lies where sliding does not dilate."""
    if greatest is None:
        return "no factor is held"
    low, high = greatest
    sure = "none" if low is None else number(round(low, 12))
    most = "unlimited" if high is None else number(high)
    return f"guaranteed up to {sure}, held by forces up to {most}: the limit lies between"


def _worst(worst: Answer | None) -> list[Fact]:
    """The worst case over intervals."""
    if worst is None:
        return []
    exact, tilt = worst["kind"] == "exact", worst["tilt_deg"]
    if not worst["held"]:
        words = "some are not held as given" if exact else "not shown that all are held as given"
    else:
        words = "all are held as given" if tilt is None else angle(tilt)
        words += " (exact)" if exact else " (inner: at least that)"
    found = [("worst case", words)]
    if worst["load_factor"] is not None:
        found.append(("", f"load factor {_interval(worst['load_factor'])}"))
    return found


def _contacts(answer: Answer) -> list[Fact]:
    tolerance = answer["tolerance"]
    gap = f"{number(tolerance['gap'], 3)} {answer['units']}"
    touching = _touching(gap, tolerance["angle_deg"], tolerance["clearance"], answer["units"])
    return [("touching", touching), *_joints(answer)]


def _touching(gap: str, degrees: float, clearance: float | None, unit: str) -> str:
    """When faces count as touching."""
    words = f"gap up to {gap}, angle up to {number(degrees, 3)} deg"
    if clearance is None:
        return words
    return f"{words}, clearances up to {number(clearance, 3)} {unit} taken as closed"


def _verify(answer: Answer) -> list[Fact]:
    if not answer["holds"]:
        return [("" if k else "because", words) for k, words in enumerate(answer["reasons"])]
    figure = (
        _balance(answer["residual"])
        if answer["residual"] is not None
        else f"a motion that gains {answer['power']:.4g} W at 1 m/s"
    )
    found = [("proof", figure)]
    found += [("" if k else "notes", words) for k, words in enumerate(answer["notes"])]
    held = [plain(name) for name in answer["held"]]
    found.append(("held", some(held) or "joints to the ground"))
    found.append(("gravity", _gravity(answer)))
    if answer["options"]:
        found.append(("read with", ", ".join(_option(*one) for one in answer["options"].items())))
    limits, unit = answer["tolerance"], answer["units"]
    gap = f"{limits['gap']:g} {unit}" if limits["gap"] else f"{limits['relative_gap']:g} of a part"
    degrees = math.degrees(limits["angle"])
    return [*found, ("touching", _touching(gap, degrees, limits.get("clearance"), unit))]


def _option(name: str, value: Any) -> str:
    """An option that a file was read with; `True` is its name alone."""
    words = name.replace("_", "-")
    return words if value is True else f"{words} {value}"


def _assembly(answer: Answer) -> list[Fact]:
    found = [("parts", _parts(answer["parts"])), ("units", answer.get("units", "m"))]
    if "gravity" in answer:
        found.append(("gravity", f"{vector(answer['gravity'])} m/s^2"))
    if answer.get("friction"):
        found.append(("friction", f"{number(answer['friction'])} where none is given"))
    found += _joints(answer)
    for key in ("loads", "contacts"):
        if answer.get(key):
            found.append((key, f"{len(answer[key])} given"))
    return found


_TELLERS: dict[str, Callable[[Answer], list[Fact]]] = {
    "assembly": _assembly,
    "check": _check,
    "contacts": _contacts,
    "margin": _margin,
    "orient": _orient,
    "region": _region,
    "verify": _verify,
}
