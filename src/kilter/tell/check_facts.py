"""Facts of the answer of a check: parts, proof, guarantee of friction, level, forces, motions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from kilter.errors import some
from kilter.tell.body_words import body_sentences
from kilter.tell.ladder_words import ladder_facts
from kilter.tell.numbers import counts, force, mass, number, percent, plain, shortened, vector
from kilter.tell.open_words import open_facts
from kilter.tell.second_order_words import is_shown, second_order_words

# Facts that several kinds of answers share: parts, joints, gravity, tolerances, equilibrium.


Answer = Mapping[str, Any]
Fact = tuple[str, str]


def parts_phrase(parts: Sequence[Answer]) -> str:
    """Return the number of parts and the names of the held parts."""
    held = [plain(part["name"]) for part in parts if part.get("grounded")]
    return f"{len(parts)}, held: {some(held) or 'none (joints to the ground)'}"


def gravity_phrase(answer: Answer) -> str:
    """Return the size and the direction of gravity."""
    size = math.hypot(*answer["gravity"])
    along = [component / size for component in answer["gravity"]]
    return f"{number(size)} m/s^2 along {vector(along)}"


def bond_words(share: float, fail: Sequence[Sequence[str]]) -> str:
    """Return the fraction of their strength that bonds need, and the bonds that fail first.

    Examples
    --------
    >>> bond_words(0.75, [("arm", "post")])
    '0.75 times their strength is needed; arm on post fails first'
    """
    if share == 0.0:
        return "no bond strength is needed: it holds without bonds"
    words = f"{number(share)} times their strength is needed"
    if not fail:
        return words
    names = some([f"{plain(a)} on {plain(b)}" for a, b in fail], 3)
    return f"{words}; {names} fail{'s' if len(fail) == 1 else ''} first"


def joint_facts(answer: Answer, *, listed: bool = False) -> list[Fact]:
    """Return a line for each kind of joint, with the number of such joints.

    `listed`: whether a table of the answer names the joints that options made.
    """
    facts: list[Fact] = []
    joints = [joint for joint in answer.get("joints", ()) if not (listed and joint.get("why"))]
    short = shortened(dict.fromkeys(name for joint in joints for name in joint["parts"]))
    for kind in dict.fromkeys(joint["kind"] for joint in joints):
        pairs = [
            " - ".join(short[name] for name in joint["parts"])
            for joint in joints
            if joint["kind"] == kind
        ]
        facts.append(("" if facts else "joints", f"{len(pairs)} {kind}: {some(pairs)}"))
    return facts


def touching_phrase(gap: str, degrees: float, clearance: float | None, unit: str) -> str:
    """Return the tolerances with which faces count as touching, in words."""
    words = f"gap up to {gap}, angle up to {number(degrees, 3)} deg"
    if clearance is None:
        return words
    return f"{words}, clearances up to {number(clearance, 3)} {unit} counted as closed"


def balance_phrase(residual: float) -> str:
    """Return the largest residual of the force balance of the parts, in words."""
    how = f"to {residual:.1e} of its weight" if residual else "exactly"
    return f"contact forces that balance every part {how}"


def instability_phrase(answer: Answer) -> str:
    """Return z, the optimum of the displacement program, and kappa, the rate of fall."""
    words = f"z = {number(answer['z'])} kg {answer['units']} (displacement program, gravity 1)"
    if answer["instability"] is not None:
        words += f", kappa = {number(answer['instability'])} (0 stable, 1 free fall)"
    return words


MOST_OF_FREE_FALL = 0.9
"""Largest power bound that is shown, as a share of the power of free fall [-]."""
GUARANTEE = {
    "proved": "proved: Coulomb's law allows no motion",
    "refuted": "refuted: Coulomb's law also allows a motion",
    "open": "open: neither proved nor refuted",
}
SEATED = {
    "yes": "yes: placed carefully, it is held by the friction that its own weight creates",
    "runs-away": "no: from every starting state that was tried its parts move away",
    "not-found": "not determined",
}
WHY = {
    "refuted": "Coulomb's law also allows a motion",
    "jams": "forces that hold it exist, but put down loosely it did not always come to rest",
    "squeeze": "it holds only if forces other than its weight press the parts together",
    "balanced": "the slightest push makes it fall",
    "not-asked": "settling and other motions were not examined",
    "push-open": "whether a small push makes parts fall is not decided",
    "not-found": "whether its own weight can hold it was not determined",
}
UNDONE = "not every try was finished for lack of {}"
"""Reason of the level if a seat was found but the tries were not finished, for lack of effort or
time."""


def check_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the verdict of `kilter check`, each a term and its words."""
    facts = [
        *ladder_facts(answer),
        *_body_facts(answer),
        ("parts", parts_phrase(answer["parts"])),
        ("units", f"{_size(answer)}; {_density(answer['density'])}"),
        ("mass", f"{mass(_free_mass(answer['parts']))} (all free parts)"),
        ("gravity", gravity_phrase(answer)),
        ("contacts", counts(**answer["contacts"])),
        *joint_facts(answer, listed=True),
        ("proof", _proof(answer)),
    ]
    facts += open_facts(answer)
    friction = answer["friction"]
    if friction is not None:
        facts.append(("guarantee", _guarantee(answer["guarantee"], friction)))
    if answer["seated"] is not None:
        facts.append(("seated", SEATED[answer["seated"]]))
        facts.append(("settles", _settles(answer)))
    if answer["level"] is not None:
        facts.append(("level", _level(answer)))
    forces = forces_phrase(answer["forces"])
    if forces is not None:
        facts.append(("forces", forces))
    facts += _guide_facts(answer)
    if answer["bonds_needed"] is not None:
        facts.append(("bonds", bond_words(**answer["bonds_needed"])))
    if answer["z"] is not None and answer["verdict"] != "stable":
        facts.append(("instability", instability_phrase(answer)))
    second = answer.get("second_order")
    second = second if is_shown(second, answer["require"]) else None
    if second is not None:
        facts.append(("second order", second_order_words(second)))
    if answer["neutral"] is not None:
        closed = answer["counted_gap"] is not None
        facts.append(("neutral", _neutral_words(**answer["neutral"], second=second, closed=closed)))
    return [*facts, *_seconds(answer)]


def _body_facts(answer: Answer) -> list[Fact]:
    """Return the lines about the bodies of parts that touch: those that stand, and the others."""
    lines = body_sentences(answer.get("bodies", ()), answer["units"])
    return [("" if k else "bodies", line) for k, line in enumerate(lines)]


def _level(answer: Answer) -> str:
    """Return the reached level (such as "settles"), its reason, and a higher required level."""
    level, why = answer["level"], answer["why"]
    seated = why == "not-found" and answer["seated"] == "yes"
    lack = "effort" if answer["time_limit"] is None else "time"
    words = level if why is None else f"{level}: {UNDONE.format(lack) if seated else WHY[why]}"
    return words if answer["stable"] else f"{words} (required: {answer['require']})"


def _settles(answer: Answer) -> str:
    """Return how many simulated drops came to rest, and the option that may finish the others."""
    tries, friction = answer["tries"], answer["friction"]
    settling, more = friction["settling"], math.floor(max(friction["effort"], 1.0)) + 1
    undone = settling["of"] - len(settling["ends"]) + settling["ends"].count("not-found")
    finished = settling["of"] - undone
    lack, remedy = "effort", f"--effort {more}"
    if answer["time_limit"] is not None:
        lack, remedy = "time", "a longer --time-limit"
    if not finished:
        return f"not tried for lack of {lack}: {remedy}"
    words = f"{tries['passed']} of {finished} tries came to rest"
    left = f"{undone} more {'was' if undone == 1 else 'were'} not finished for lack of {lack}"
    return f"{words}; {left}: {remedy}" if undone else words


def _free_mass(parts: Iterable[Answer]) -> float:
    return math.fsum(part["mass"] for part in parts if not part["grounded"])


def _guide_facts(answer: Answer) -> list[Fact]:
    """Return a line for each joint that a stop, friction or a spring holds, with their forces."""
    facts: list[Fact] = []
    for joint in (answer["forces"] or {}).get("joints", ()):
        unit = "" if joint["kind"] == "prismatic" else f" {answer['units']}"
        acting = [
            f"{name} {force(abs(joint[name]))}{unit}"
            for name in ("stop", "friction", "spring")
            if joint[name]
        ]
        if acting:
            facts.append(("" if facts else "joint forces",
                          f"{' - '.join(joint['parts'])}: {', '.join(acting)}"))  # fmt: skip
    return facts


def _size(answer: Answer) -> str:
    """Return a phrase about the extents of the free parts; it says if the unit is assumed.

    Examples
    --------
    >>> _size({"size": [120, 80, 40], "units": "mm", "assumed": ["units"]})
    'size 120 x 80 x 40 mm, units assumed; --units m'
    """
    unit = answer["units"]
    words = f"size {' x '.join(number(extent) for extent in answer['size'])} {unit}"
    if "units" not in answer["assumed"]:
        return words
    return f"{words}, units assumed; --units {'m' if unit != 'm' else 'mm'}"


def _density(density: Answer) -> str:
    """Return a phrase about the densities from which the masses of free parts were computed."""
    words = []
    if density["given"] is not None:
        ends = [number(end) for end in dict.fromkeys(density["given"])]
        words.append(f"density {' to '.join(ends)} kg/m^3")
    if density["default"] is not None:
        words.append(
            f"density {number(density['default'])} kg/m^3 for parts without a given density "
            "(--density sets it)"
        )
    return ", ".join(words) or "masses as given"


def _proof(answer: Answer) -> str:
    """Return the kind of proof of a verdict (forces or motion) and its residual."""
    proof = answer["certificate"]
    if proof["kind"] == "forces":
        limit = f"(tolerance {answer['tolerance']['verdict']:.0e})"
        return f"{balance_phrase(proof['residual'])} {limit}, verified independently of the solver"
    if proof["kind"] == "motion":
        return (
            f"a motion that gains {proof['power']:.4g} W at 1 m/s and violates "
            f"{_violation(proof['violation'])}, verified independently of the solver"
        )
    return "none"


def _violation(violation: float) -> str:
    return f"contacts by {abs(violation):.0e}" if violation else "no contact"


def _guarantee(guarantee: str, friction: Answer) -> str:
    """Return how surely friction holds the assembly, with the proof or the excluded motions."""
    words = GUARANTEE[guarantee]
    if guarantee == "open":
        words += f" (an --effort above {number(friction['effort'])} may decide)"
    exclusion, witness = friction["exclusion"], friction["witness"]
    if exclusion is not None and exclusion["proved"]:
        words += f" ({exclusion['kind']}, {exclusion['programs']} programs)"
    elif guarantee == "open" and exclusion is not None and exclusion["bound"] < MOST_OF_FREE_FALL:
        share = f"{100 * exclusion['bound']:.2g} %"
        words += f"; any motion starts with at most {share} of the power of free fall"
    if witness is not None:
        residual = witness["residual"]
        words += f" (residual {residual:.1e})" if residual else " (residual 0)"
    return words


def forces_phrase(forces: Answer | None) -> str | None:
    """Return the largest contact force, and the largest share of the friction that is needed."""
    patches = [] if forces is None else forces["patches"]
    if not patches:
        return None
    greatest = max(patches, key=lambda patch: math.hypot(*patch["resultant"]))
    words = f"up to {force(math.hypot(*greatest['resultant']))} ({_pair(greatest)})"
    rubs = [patch for patch in patches if patch["utilisation"]]
    if rubs:
        most = max(rubs, key=lambda patch: float(patch["utilisation"]))
        words += f"; needs up to {percent(most['utilisation'])} of the friction ({_pair(most)})"
    return words


def _pair(patch: Answer) -> str:
    first, second = patch["parts"]
    return f"{plain(first)} on {plain(second)}"


def _neutral_words(
    two_sided: int, one_sided: int, *, second: Answer | None = None, closed: bool = False
) -> str:
    """Return the words about motions whose potential energy is constant to first order."""
    if two_sided + one_sided == 0:
        return (
            "none, counting gaps as closed"
            if closed
            else "none: strictly held, every motion costs energy"
        )
    words = (
        f"{two_sided} two-sided and {one_sided} one-sided independent motions do not change the "
        "energy to first order; second order (curvature) examines these motions"
    )
    if second is None or second["state"] != "open":
        return words
    return f"{words}; second order is {second_order_words(second)}"


def _seconds(answer: Answer) -> list[Fact]:
    taken = answer.get("seconds") or {}
    words = ", ".join(f"{key} {value:.2g}" for key, value in taken.items())
    return [("seconds", words)] if words else []
