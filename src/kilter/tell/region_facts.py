"""What an answer about directions of gravity says: a region, or the turn into it."""

from __future__ import annotations

from kilter.tell.numbers import angle, number, vector
from kilter.tell.second_order_words import second_order_words
from kilter.tell.shared_facts import Answer, Fact, balance_phrase, instability_phrase, joint_facts

__all__ = ["orient_facts", "region_facts", "region_phrase", "region_words", "rest_words"]

ROWS = 20
"""Vectors of a region that are told one by one."""
DIRECTIONS = {
    "lines": "both senses stable",
    "rays": "extreme directions",
    "equations": "q.g = 0",
    "facets": "q.g >= 0",
}


def orient_facts(answer: Answer) -> list[Fact]:
    """Terms of a direction that was looked for and what they are."""
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
            found.append(("proof", balance_phrase(answer["residual"])))
    else:
        found.append(("instability", instability_phrase(answer)))
        found += _nearest(answer["nearest"])
    return [*found, *joint_facts(answer), ("programs", f"{answer['programs']} solved")]


def _nearest(near: Answer | None) -> list[Fact]:
    """The directions nearest to stable, in three senses."""
    if near is None:
        return []
    known = {key: one for key, one in near.items() if one is not None}
    at = {key: vector(one["direction"]) for key, one in known.items()}
    value = {key: number(one["value"]) for key, one in known.items()}
    least = "by kappa not known: no solver finished it"
    if "kappa" in known:
        bound = number(near["kappa"]["bound"])
        least = f"{at['kappa']} by kappa, {value['kappa']} (no direction has less than {bound})"
    return [
        ("nearest", f"{at['diamond']} on the paper's diamond, z = {value['diamond']}"),
        ("", f"{at['sphere']} on the sphere, z = {value['sphere']}"),
        ("", least),
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
    return f"{words}; more directions may be stable: not every force there may be was counted"


def region_facts(answer: Answer) -> list[Fact]:
    """Terms of a region and what they are."""
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
    return [
        *found,
        *_rests(answer),
        *joint_facts(answer),
        ("programs", f"{answer['programs']} solved"),
    ]


def _rests(answer: Answer) -> list[Fact]:
    """How it rests in each direction that was asked."""
    words = [f"{vector(one['down'])}: {rest_words(one)}" for one in answer.get("rests", ())]
    return [("" if k else "rests", one) for k, one in enumerate(words)]


def rest_words(rest: Answer) -> str:
    """How it rests in one direction.

    Examples
    --------
    >>> corner = {"state": "minimum", "rate": None, "moving": [], "why": None, "tilt_deg": 35.3}
    >>> rest_words(corner).split("; ")[1]
    'tilted up to 35.3 deg it stays'
    """
    words = [second_order_words({**rest, "motion": rest["moving"], "free": 0})]
    if rest["state"] == "minimum" and rest["tilt_deg"]:
        words.append(f"tilted up to {angle(rest['tilt_deg'])} it stays")
    if rest.get("well"):
        words += _well_words(rest["well"])
    return "; ".join(words)


def _well_words(well: Answer) -> list[str]:
    """How wide, deep and stiff the well of a body on a table is."""
    words = []
    if well["barrier"] is not None:
        over = f"tilted on its table by less than {angle(well['over_deg'])} it comes back"
        words += [over, f"to tip it takes {number(well['barrier'], 4)} J"]
    elif well["over_deg"] is not None:
        words.append("however it is tilted on its table, it comes back")
    if well["stiffness"] is not None:
        moment = f"it rights itself by {number(well['stiffness'], 4)} N m a radian at least"
        words += [moment, f"its slowest swing takes {number(well['period'], 4)} s"]
    return words
