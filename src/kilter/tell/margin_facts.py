"""What the answer of margins says: tilt, least friction, loads, the worst case, what helps."""

from __future__ import annotations

from collections.abc import Sequence

from kilter.errors import some
from kilter.tell.numbers import angle, number, plain, vector
from kilter.tell.shared_facts import Answer, Fact, joint_facts

__all__ = ["margin_facts"]


def margin_facts(answer: Answer) -> list[Fact]:
    """Terms of margins and what they are."""
    found = [*joint_facts(answer), ("tilt", _tilt(answer))]
    about = answer["about"]
    if about is not None:
        turn = about["tilt_deg"]
        words = "a full turn is held" if turn is None else angle(turn)
        found.append(("about axis", words + _starting(about["limit"])))
    found.append(("friction", _least_friction(answer)))
    if answer["bond_limit"] is not None or answer["missing"].get("bond") is not None:
        found.append(("bonds", _bonds(answer)))
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
            return "none: given loads, or what bonds hold, would not turn with gravity"
        if why == "failed":
            return "not known: the numbers failed"
        return "none: not held as given, nor with gravity along any direction within a right angle"
    if answer["tilt_down"] is None:
        held = "forces that hold it exist" if answer["level"] == "equilibrium" else "it holds"
        return f"more than 90 deg: {held} at every tilt up to a right angle"
    down = vector(answer["tilt_down"])
    if lower is None:
        upper, held = answer["tilt_upper_deg"], f"the nearest held direction is {down}"
        known = upper - tilt <= 1e-6 * max(-tilt, 1e-3)
        least = "" if known else f" (none within {number(-upper)} is held)"
        return f"{angle(tilt)}: not held as it lies; {held}{least}"
    if answer["tilt_limit"]["mechanism"] is None:
        return f"{angle(tilt)} are held, down = {down}; that no more are is not proved"
    fails = "that fails"
    if answer["tilt_outside"] == "undecided":
        fails = "at which open contacts decide"
    words = f"{angle(tilt)} to the nearest direction {fails}"
    if tilt - lower > 1e-6 * max(tilt, 1e-12):
        words += f" (at least {number(lower)})"
    words = f"{words}, down = {down}{_starting(answer['tilt_limit'])}"
    if answer["level"] == "equilibrium":
        words += "; up to there forces that hold it exist"
    at_level = answer["tilt_at_level"]
    if at_level is None:
        return words
    verb = {"settles": "it settles", "proved": "no motion can start"}[at_level["level"]]
    return f"{words}; {verb} up to {angle(at_level['tilt_deg'])} toward that direction"


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
    lower = answer["friction_limit"]["lower"]
    words = f"mu >= {number(least)}, the same at every contact"
    if least - lower > 1e-6 * least:
        words += f" ({number(lower)} is proved not to be enough)"
    return words


def _bonds(answer: Answer) -> str:
    """Which share of their strength bonds need, and which gives way first."""
    why, limit, share = answer["missing"].get("bond"), answer["bond_limit"], answer["bond"]
    if why is not None:
        return "not known: the numbers failed" if why == "failed" else "no strength is enough"
    if share is None:
        return "none is needed: it stands without"
    words = f"{number(share)} of their strength is needed"
    opens = limit["opens"]
    if not opens:
        return words
    names = some([f"{plain(a)} on {plain(b)}" for a, b in (one["parts"] for one in opens)], 3)
    return f"{words}; {names} give{'s' if len(opens) == 1 else ''} way first"


def _bracket(greatest: Sequence[float | None] | None) -> str:
    """Where the greatest load factor lies where sliding does not dilate."""
    if greatest is None:
        return "no factor is held"
    low, high = greatest
    sure = "none" if low is None else number(round(low, 12))
    most = "unlimited" if high is None else number(high)
    return (
        f"sure to hold up to {sure}; forces that hold it exist up to {most}; the limit lies between"
    )


def _worst(worst: Answer | None) -> list[Fact]:
    """The worst case over intervals."""
    if worst is None:
        return []
    exact, tilt = worst["kind"] == "exact", worst["tilt_deg"]
    unknown = "not known: the numbers failed"
    if not worst["held"]:
        words = "some are not held as given" if exact else "not shown that all are held as given"
        words = unknown if worst["missing"]["held"] == "failed" else words
    elif worst["missing"].get("tilt") == "failed":
        words = f"all are held as given; the tilt is {unknown}"
    else:
        words = "all are held as given" if tilt is None else angle(tilt)
        words += " (exact)" if exact else " (at least; it may be more)"
    found = [("worst case", words)]
    if worst["missing"].get("load_factor") == "failed":
        found.append(("", f"load factor {unknown}"))
    if worst["load_factor"] is not None:
        found.append(("", f"load factor {_interval(worst['load_factor'])}"))
    return found
