"""Facts of the answers about directions of gravity: regions, orientations, places of rest."""

from __future__ import annotations

from kilter.tell.check_facts import Answer, Fact, balance_phrase, instability_phrase, joint_facts
from kilter.tell.numbers import angle, number, vector
from kilter.tell.second_order_words import second_order_words

ROWS = 20
"""Largest number of vectors of each kind that are listed."""
DIRECTIONS = {
    "lines": "each direction and its opposite belong to the region",
    "rays": "extreme directions of the region",
    "equations": "normals q: every direction g of the region has q.g = 0",
    "facets": "inward normals q: every direction g of the region has q.g >= 0",
}


def orient_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence of `kilter orient`, each a term and its words."""
    turn = (
        f"quaternion (w, x, y, z) {vector(answer['rotation'])}: rotates this direction to the "
        "gravity of the file"
    )
    facts = [
        ("down", f"{vector(answer['down'])}: direction of gravity in the assembly's frame"),
        ("turn", turn),
    ]
    if answer["found"]:
        margin = angle(answer["tilt_margin_deg"])
        outside = "that is not held" if answer["friction"] else "that is unstable"
        facts.append(("margin", f"{margin} to the nearest direction {outside}"))
        facts.append(("region", region_phrase(**answer["region"])))
        if answer["residual"] is not None:
            facts.append(("proof", balance_phrase(answer["residual"])))
    elif answer["nearest"] is not None:  # None for a large assembly whose open pairs decide
        facts.append(("instability", instability_phrase(answer)))
        facts += _nearest(answer["nearest"], answer["units"])
    return [*facts, *joint_facts(answer), ("programs", f"{answer['programs']} solved")]


def _nearest(near: Answer | None, units: str) -> list[Fact]:
    """Return the lines about the directions nearest to stable, by three measures."""
    if near is None:
        return []
    known = {key: entry for key, entry in near.items() if entry is not None}
    at = {key: vector(entry["direction"]) for key, entry in known.items()}
    value = {key: number(entry["value"]) for key, entry in known.items()}
    least = "least kappa: not known, no solver finished it"
    if "kappa" in known:
        bound = number(near["kappa"]["bound"])
        found = f"{at['kappa']} has the least kappa found: {value['kappa']}"
        least = f"{found} (proved lower bound: {bound})"
    greatest = f"has the greatest z, {{}} kg {units}, of all"
    diamond, sphere = (greatest.format(value[key]) for key in ("diamond", "sphere"))
    return [
        ("nearest", f"{at['diamond']} {diamond} g with |x| + |y| + |z| = 1"),
        ("", f"{at['sphere']} {sphere} unit vectors g"),
        ("", least),
    ]


def region_phrase(kind: str, half_angle_deg: float | None, *, friction: bool) -> str:
    """Return the kind and angular width of a region of stable directions of gravity.

    Examples
    --------
    >>> region_phrase("fan", 45.0, friction=False)
    'fan, half angle 45 deg'
    """
    width = "" if half_angle_deg is None else f", half angle {angle(half_angle_deg)}"
    return f"{kind}{width}{', with friction' if friction else ''}"


def region_words(answer: Answer, *, proved_none: bool) -> str:
    """Return the kind and angular width of a stable region, and whether it may be larger."""
    words = region_phrase(answer["kind"], answer["half_angle_deg"], friction=answer["friction"])
    if answer["complete"] or proved_none:
        return words
    return f"{words}; more directions may be stable, since not every possible force was counted"


def region_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence of `kilter region`, each a term and its words."""
    facts = [("kind", f"{answer['kind']}, dimension {answer['dimension']}")]
    if answer["center"] is not None:
        center = f"{vector(answer['center'])}: the direction with the widest tilt margin"
        facts.append(("center", center))
    if answer["half_angle_deg"] is not None:
        half = angle(answer["half_angle_deg"])
        inside = "sector" if answer["dimension"] == 2 else "circular cone"
        facts.append(("half angle", f"{half}, of the widest {inside} inside"))
    if answer["gap_deg"] is not None:
        gap = f"at most {answer['gap_deg']:.3g} deg between rays (inside) and facets (outside)"
        facts.append(("gap", gap))
    for name, meaning in DIRECTIONS.items():
        listed = [vector(row) for row in answer[name][:ROWS]]
        facts += [
            ("" if k else name, words if k else f"{words}  ({meaning})")
            for k, words in enumerate(listed)
        ]
        if len(answer[name]) > ROWS:
            facts.append(("", f"and {len(answer[name]) - ROWS} more"))
    return [
        *facts,
        *_rests(answer),
        *joint_facts(answer),
        ("programs", f"{answer['programs']} solved"),
    ]


def _rests(answer: Answer) -> list[Fact]:
    """Return the lines about the resting state for each direction of gravity in `--rests`."""
    phrases = [f"{vector(rest['down'])}: {rest_words(rest)}" for rest in answer.get("rests", ())]
    return [("" if k else "rests", words) for k, words in enumerate(phrases)]


def rest_words(rest: Answer) -> str:
    """Return the state of rest of the assembly for one direction of gravity, in words.

    Examples
    --------
    >>> corner = {"state": "minimum", "rate": None, "moving": [], "why": None, "tilt_deg": 35.3}
    >>> rest_words(corner).split("; ")[1]
    'it stays after any tilt up to 35.3 deg'
    """
    words = [second_order_words({**rest, "motion": rest["moving"], "free": 0})]
    if rest["state"] == "minimum" and rest["tilt_deg"]:
        words.append(f"it stays after any tilt up to {angle(rest['tilt_deg'])}")
    if rest.get("well"):
        words += _well_words(rest["well"])
    return "; ".join(words)


def _well_words(well: Answer) -> list[str]:
    """Return lines about the energy minimum of a body on a table: width, depth, stiffness."""
    words = []
    if well["barrier"] is not None:
        over = f"on its table it comes back from any tilt below {angle(well['over_deg'])}"
        words += [over, f"tipping it needs {number(well['barrier'], 4)} J"]
    elif well["over_deg"] is not None:
        words.append("on its table it comes back from any tilt")
    if well["stiffness"] is not None:
        moment = f"its righting moment is at least {number(well['stiffness'], 4)} N m/rad"
        words += [moment, f"its slowest swing has a period of {number(well['period'], 4)} s"]
    return words
