"""Facts of the answer of margins: tilt, least friction, bonds, loads, worst case, remedies."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from kilter.errors import some
from kilter.tell.check_facts import Answer, Fact, bond_words, joint_facts
from kilter.tell.numbers import angle, force, number, plain, rounded_up, vector

LEVEL_WORDS = {
    "settles": ("it settles", "it does not settle"),
    "proved": ("no motion can start", "no proof that excludes every motion was found"),
}
"""Words of a level that is reached, and of a level that is not."""
AT_MU = "at mu ="
"""Words before a friction coefficient at which a level is reached."""
UNKNOWN = {
    "failed": "not known: the solver failed",
    "time": "not known: the time limit was reached",
    "interrupted": "not known: the command was interrupted",
}
"""Words of a limit whose program no solver finished."""


def margin_facts(answer: Answer) -> list[Fact]:
    """Return the lines below the sentence of `kilter margin`, each a term and its words."""
    facts = [*joint_facts(answer), *_at_its_limit(answer), ("tilt", _tilt(answer))]
    about = answer["about"]
    if about is not None:
        turn = about["tilt_deg"]
        sense = f"about {vector(about['axis'])} by the right-hand rule"
        words = f"{'a full turn is held' if turn is None else angle(turn)} {sense}"
        at_level = _at_level(answer, "about_deg", angle)
        facts.append(("about axis", words + _starting(about["limit"]) + at_level))
    facts.append(("friction", _least_friction(answer)))
    if answer["bond_limit"] is not None or answer["missing"].get("bond") is not None:
        facts.append((" and ".join(answer["clamped_by"]), _bonds(answer)))
    limits = answer["load_limits"]
    if limits is not None:
        ends = answer["load_factor"]
        none = "none: no load factor is held, however small or large"
        words = UNKNOWN.get(answer["missing"].get("load_factor"), none + _as_drawn(answer))
        if ends is not None:
            words = _interval(ends) + _starting(limits[1]) + _factor_at_level(answer)
        facts.append(("load factor", words))
    if answer["load_factor_bracket"] is not None:
        facts.append(("bracket", _bracket(answer["load_factor_bracket"]["greatest"])))
    if "none" in [why for key, why in answer["missing"].items() if key.startswith("push of")]:
        facts.append(("pushes", "no push is resisted: it is not in equilibrium as given"))
    facts += _worst_case(answer["uncertainty"])
    changes = [change["sentence"] for change in answer["improvements"]]
    facts += [("" if k else "helps", words) for k, words in enumerate(changes)]
    return facts + _made_stand(answer["made_stand"])


def _made_stand(made: Answer | None) -> list[Fact]:
    """Return the lines of the least change after which it stands."""
    if made is None:
        return []
    required = angle(made["required_deg"])
    if not made["stands"]:
        return [
            ("to stand", f"no change was found after which it stands up to a tilt of {required}")
        ]
    changes = [change["sentence"] for change in made["changes"]] or ["no change is needed"]
    done = f"then it stands up to a tilt of {angle(made['tilt_deg'])}, which is proved"
    return [("" if k else "to stand", words) for k, words in enumerate([*changes, done])]


def moved_by_least(answer: Answer) -> tuple[str, ...]:
    """Return the causes, "tilt" or "push", of which the least in a direction moves the assembly.

    Examples
    --------
    >>> moved_by_least({"tilt_deg": 0.0, "pushes": [{"force": 0.0}, {"force": None}]})
    ('tilt', 'push')
    """
    tilted = bool(answer["tilt_deg"] == 0.0)
    pushed = any(push["force"] == 0.0 for push in answer["pushes"])
    return ("tilt",) * tilted + ("push",) * pushed


def _at_its_limit(answer: Answer) -> list[Fact]:
    """Return the line of an assembly without any reserve; no line if it has a reserve."""
    causes = moved_by_least(answer)
    if not causes:
        return []
    moved = f"the least {' or '.join(causes)} in some directions moves it"
    if answer["level"] == "equilibrium":  # friction is stated already
        return [("at its limit", moved)]
    rub = "--friction MU states the friction of its contacts"
    return [("at its limit", f"without friction {moved}; {rub}")]


def _as_drawn(answer: Answer) -> str:
    """Return the words that limit a margin to the assembly without its undecided (open) pairs.

    Empty without open pairs.
    """
    return " if its open pairs carry no force" if answer["open_pairs"] else ""


def _interval(ends: Sequence[float | None]) -> str:
    """Return an interval of load factors as text; None is an end without limit."""
    return " to ".join("unlimited" if end is None else number(end) for end in ends)


def _starting(limit: Answer | None) -> str:
    """Return which parts start to move beyond a limit; empty if they are not known."""
    names = [] if limit is None else [plain(name) for name in limit["moves"]]
    if limit is None or limit["mechanism"] is None:
        return ""
    return f"; then {some(names)} start{'s' if len(names) == 1 else ''} to move"


def _tilt(answer: Answer) -> str:
    """Return the tilt margin (largest safe tilt) and its bounds, in words."""
    tilt, lower = answer["tilt_deg"], answer["tilt_lower_deg"]
    if tilt is None:
        why = answer["missing"].get("tilt")
        if why is None:
            return "not defined: loads, bonds, straps, joint friction or springs do not turn"
        none = "none: not held as given, nor with gravity in any direction within 90 deg of it"
        return UNKNOWN.get(why, none + _as_drawn(answer))
    if answer["tilt_down"] is None:
        held = "forces that hold it exist" if answer["level"] == "equilibrium" else "it holds"
        return f"at least 90 deg: {held} after every tilt up to a right angle"
    down = vector(answer["tilt_down"])
    if lower is None:
        upper, held = answer["tilt_upper_deg"], f"the nearest held direction of gravity is {down}"
        known = upper - tilt <= 1e-6 * max(-tilt, 1e-3)
        least = "" if known else f" (no direction within {number(-upper)} deg is held)"
        return f"{angle(tilt)}: not held as given; {held}{least}"
    if answer["tilt_limit"]["mechanism"] is None:
        return f"at least {angle(tilt)}, toward gravity along {down}; the limit is not proved"
    fails = "that fails"
    if answer["tilt_outside"] == "undecided":
        open_pairs = bool(answer["open_pairs"])
        fails = "at which open pairs decide" if open_pairs else "that is not decided"
    words = f"{angle(tilt)} to the nearest direction of gravity {fails}"
    if tilt - lower > 1e-6 * max(tilt, 1e-12):
        words += f" (at least {number(lower)} deg)"
    words = f"{words}, {down}{_starting(answer['tilt_limit'])}"
    if answer["level"] == "equilibrium":
        words += "; up to this tilt forces that hold it exist"
    return words + _at_level(answer, "tilt_deg", angle, " toward this direction")


def _at_level(
    answer: Answer, key: str, words: Callable[[float], str], more: str = "", bound: str = "up to"
) -> str:
    """Return the words about a limit at the required level; empty if none was computed."""
    at_level = answer["at_level"]
    return (
        ""
        if at_level is None
        else level_words(at_level["level"], at_level[key], words, more, bound)
    )


def level_words(
    level: str,
    limit: Answer | None,
    words: Callable[[float], str],
    more: str = "",
    bound: str = "up to",
) -> str:
    """Return the words about a limit at a higher level; they continue an equilibrium phrase.

    Empty if a work limit or time limit ended the search; a warning of the answer reports this for
    all limits together.

    Arguments: `limit`: its values `inside` and `outside`, and `why` they are unknown; None without
    a limit.

    Examples
    --------
    >>> level_words("settles", {"inside": 11.2, "outside": 11.201, "why": None}, angle)
    '; it settles up to 11.2 deg'
    """
    if limit is None:
        return ""
    verb, fails = LEVEL_WORDS[level]
    if limit["why"] == "none":
        with_any = "with any coefficient that was tried"
        return f"; {fails} {with_any}" if bound == AT_MU else f"; as drawn {fails}"
    if limit["why"] is not None:
        return ""
    if limit["outside"] is None:
        return f"; {verb} {bound} {words(limit['inside'])}{more}, the largest value tried"
    apart = abs(limit["outside"] - limit["inside"])
    wide = apart > 1e-3 * max(abs(limit["outside"]), abs(limit["inside"]))
    until = f" (not decided between it and {words(limit['outside'])})" if wide else ""
    return f"; {verb} {bound} {words(limit['inside'])}{more}{until}"


def part_level_words(answer: Answer, key: str, part: str) -> str:
    """Return the words about the push or load of a part at the required level; empty if unknown.

    `key` is "pushes" or "loads".
    """
    at_level = answer["at_level"]
    if at_level is None:
        return ""
    return level_words(at_level["level"], at_level[key].get(part), force)


def _factor_at_level(answer: Answer) -> str:
    """Return the words about load factors at the required level; empty if none were computed."""
    at_level = answer["at_level"]
    ends = None if at_level is None else at_level["load_factor"]
    if ends is None:
        return ""
    least = ends[0]["inside"]
    bound = "up to" if least is None else f"from {number(least)} up to"
    return level_words(at_level["level"], ends[1], number, bound=bound)


WIDE = 0.01
"""Relative distance of the bounds of the least friction above which both are named alike [-]."""


def _least_friction(answer: Answer) -> str:
    """Return the least friction coefficient that holds an assembly, and its lower bound."""
    least = answer["friction"]
    if least is None:
        none = "no friction coefficient is enough to hold it" + _as_drawn(answer)
        return UNKNOWN.get(answer["missing"].get("friction"), none)
    if least == 0.0:
        attained = answer["friction_limit"]["attained"]
        return (
            "no friction is needed"
            if attained
            else "any mu above 0 is enough: parts clamped between others can press with any force"
            + _at_level(answer, "friction", number, bound=AT_MU)
        )
    lower = answer["friction_limit"]["lower"]
    words = f"mu >= {rounded_up(least)}, the same at every contact"
    if least - lower > WIDE * least:
        words = (
            f"mu = {number(least)} at every contact is enough, mu = {number(lower)} is proved not "
            "to be; the least mu is between them"
        )
    elif least - lower > 1e-6 * least:
        words += f" ({number(lower)} is proved not to be enough)"
    return words + _at_level(answer, "friction", number, bound=AT_MU)


def _bonds(answer: Answer) -> str:
    """Return the fraction of their strength that bonds need, and the bonds that fail first."""
    why, limit, share = answer["missing"].get("bond"), answer["bond_limit"], answer["bond"]
    if why is not None:
        return UNKNOWN.get(why, "no strength is enough" + _as_drawn(answer))
    if "straps" in answer["clamped_by"] and share is None:
        return "no strength is needed: it holds without them"
    if share is None:
        return bond_words(0.0, ())
    return bond_words(share, [patch["parts"] for patch in limit["opens"]])


def _bracket(greatest: Sequence[float | None] | None) -> str:
    """Return proved bounds of the largest load factor, for friction without dilation, in words."""
    if greatest is None:
        return "no load factor is held"
    low, high = greatest
    proved = "for no factor" if low is None else f"up to {number(round(low, 12))}"
    most = "for every factor" if high is None else f"up to {number(high)}"
    return f"proved to hold {proved}; forces that hold it exist {most}; the limit lies between"


def _worst_case(worst: Answer | None) -> list[Fact]:
    """Return the lines about the worst case over the given intervals of input values."""
    if worst is None:
        return []
    exact, tilt = worst["kind"] == "exact", worst["tilt_deg"]
    if not worst["held"]:
        words = "some cases are not held as given"
        if not exact:
            words = "not proved that all cases are held as given; nor that a case fails"
        words = UNKNOWN.get(worst["missing"]["held"], words)
    elif worst["missing"].get("tilt") in UNKNOWN:
        words = f"all cases are held as given; the tilt is {UNKNOWN[worst['missing']['tilt']]}"
    else:
        words = "all cases are held as given"
        if tilt is not None:
            words = f"{'' if exact else 'at least '}{angle(tilt)} of tilt"
        words += " (exact)" if exact else " (a bound: it may be more)"
    facts = [("worst case", words)]
    if worst["missing"].get("load_factor") in UNKNOWN:
        facts.append(("", f"load factor {UNKNOWN[worst['missing']['load_factor']]}"))
    if worst["load_factor"] is not None:
        facts.append(("", f"load factor {_interval(worst['load_factor'])}"))
    return facts
