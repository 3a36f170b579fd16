"""Verdicts and motions in words, each phrase once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kilter.arrays import Array
from kilter.tell.numbers import NO_ANGLE, number, vector

__all__ = [
    "NAMED",
    "VERDICTS",
    "found_sentence",
    "live_words",
    "motion_summary",
    "motion_words",
    "verdict_sentence",
]


VERDICTS = {
    "stable": "Stable",
    "settles": "Settles",
    "potentially-stable": "Potentially stable",
    "balanced": "Balanced",
    "unstable": "Unstable",
    "undecided": "Undecided",
    "unknown": "Not known",
}
"""Of a page also `unknown`: a direction of gravity that was not answered."""
SMALL = 1e-3
"""A component below this part of a motion is left out of the words."""
ALONG = 1e-6
"""A direction this near to an axis, or to gravity, is called by its name."""
LEVEL = 5e-4
"""A direction that leans by less is level as it is shown, with three decimals."""
NAMED = 2
"""Parts that `motion_summary` describes, the fastest."""
SENTENCES = {
    ("stable", None): "Stable{within}: it cannot start to move{slippery}.",
    ("stable", "first order"): (
        "Stable to first order, as in the paper{within}: it cannot start to move{slippery}."
    ),
    ("stable", "proved"): (
        "Stable{within}: with this friction no motion can start, whatever the contact forces "
        "were before{assumed}."
    ),
    ("settles", None): (
        "Settles{within}: put down loosely, it came to rest in each of {of} tries, by the friction "
        "that its own weight makes; no motion was found, though that there is none is not proved."
    ),
    ("potentially-stable", "refuted"): (
        "Potentially stable{within}: its own weight can make the friction that holds it, but "
        "released loose it could also move like this."
    ),
    ("potentially-stable", "refuted squeeze"): (
        "Potentially stable{within}, held only by squeeze: it stays only if something other than "
        "its weight presses the parts together; else it moves like this."
    ),
    ("potentially-stable", "jams"): (
        "Potentially stable{within}: it can jam, but put down loosely it came to rest in {passed} "
        "of {tried} tries; no motion was found."
    ),
    ("potentially-stable", "squeeze"): (
        "Potentially stable{within}, held only by squeeze: it stays only if something other than "
        "its weight presses the parts together; no motion was found."
    ),
    ("potentially-stable", "not-asked"): (
        "Potentially stable{within}: forces that hold it exist; settling and other motions were "
        "not examined."
    ),
    ("potentially-stable", "not-found"): (
        "Potentially stable{within}: forces that hold it exist; no motion was found, and whether "
        "it settles was not found out."
    ),
    ("unstable", None): (
        "Unstable{beyond}: {smooth}no contact forces can hold it; here is how it starts to move."
    ),
}
"""Sentence of a verdict and of what friction guarantees."""


BASIS = {
    "exact": "the exact cone of stable directions; the margin is the angle to its nearest side",
    "friction": "the cone of directions for which forces that hold it exist",
    "band": (
        "the cone of directions for which forces that hold it exist; friction makes it round, so "
        "it is known between two cones of flat sides: inside the inner one forces are proved, "
        "outside the outer one there are none, in between it is undecided"
    ),
    "inner": (
        "the cone of directions that hold even without friction and without contacts that are not "
        "modelled; outside of it these may still hold it, so there it is undecided"
    ),
}
"""What the answer of a page for a direction rests on."""
QUESTION = {
    "exact": "Inside the region it cannot start to move, outside it does.",
    "friction": (
        "Inside the region forces that hold it exist (the level equilibrium), outside there are "
        "none. Whether friction is sure to hold it is told only of the given and of the "
        "recommended direction."
    ),
    "inner": (
        "Inside the region it holds however slippery the parts; outside, friction or contacts "
        "that are not modelled may hold it, which is left open."
    ),
}
"""What a page asks of each direction of gravity."""
INSIDE = {
    "exact": "stable",
    "friction": "forces that hold it exist",
    "inner": "stable, however slippery",
}
"""What the colour of the region says."""
NONE = {
    "exact": "no direction of gravity is stable",
    "friction": "no direction of gravity is held by the modelled contacts, not even with friction",
    "inner": (
        "no direction of gravity is held by the frictionless contacts alone; further forces might"
    ),
}


def verdict_sentence(
    verdict: str,
    *,
    guarantee: str | None = None,
    why: str | None = None,
    squeeze: bool = False,
    tries: tuple[int, int, int] = (0, 0, 0),
    first_order: bool = False,
    frictionless: bool = False,
    assumed: str = "",
    coarse: bool = False,
    counted: str = "",
    bonded: bool = False,
) -> str:
    """The sentence of a verdict that is not undecided.

    Parameters
    ----------
    verdict : {"stable", "settles", "potentially-stable", "unstable"}
    guarantee : str, optional
        What friction guarantees, where the verdict rests on it.
    why : str, optional
        Why it is only potentially stable.
    squeeze : bool
        Every seat runs away.
    tries : tuple of int
        Passed, made, and asked for.
    first_order : bool
        Second order leaves a neutral motion free or open.
    frictionless : bool
        No contact of the assembly has friction.
    assumed : str
        The bound on contact forces that the proof of "proved" assumes.
    coarse : bool
        The data are coarser than float64.
    counted : str
        The widest gap that only a widened tolerance counts as closed.
    bonded : bool
        Bonds may pull.

    Examples
    --------
    >>> verdict_sentence("stable")
    'Stable: it cannot start to move, however slippery the parts.'
    >>> verdict_sentence("stable", counted="1 mm")
    'Stable, counting gaps up to 1 mm as closed: it cannot start to move.'
    """
    key = guarantee if verdict == "stable" else why
    if verdict == "stable" and guarantee is None and first_order:
        key = "first order"
    if why == "refuted" and squeeze:
        key = "refuted squeeze"
    passed, tried, of = tries
    counting = f", counting gaps up to {counted} as closed" if counted else ""
    counting += ", if no bond breaks below its capacity" if bonded else ""
    return SENTENCES[verdict, key].format(
        within=(" within the accuracy of the coordinates" if coarse else "") + counting,
        slippery="" if counted else ", however slippery the parts",
        smooth="without friction " if frictionless else "",
        assumed=f" (up to {assumed})" if assumed else "",
        beyond=", and not by rounding of its coordinates" if coarse else "",
        passed=passed,
        tried=tried,
        of=of,
    )


def found_sentence(
    down: Array,
    margin_deg: float,
    *,
    friction: bool,
    exact: bool,
    within: str | None,
    half_angle_deg: float | None,
) -> str:
    """That a direction of gravity was found, and how far it may tilt from there.

    Parameters
    ----------
    down : ndarray, shape (3,)
    margin_deg : float
        To the boundary [deg].
    friction, exact : bool
        Friction was counted; nothing was left out that might hold more.
    within : str, optional
        The kind of region, where it is more than one direction.
    half_angle_deg : float, optional
        Of the region [deg].

    Examples
    --------
    >>> thin = {"friction": False, "exact": True, "within": "fan", "half_angle_deg": 45.0}
    >>> found_sentence(np.array([0.0, 0, -1]), 4.8e-15, **thin)
    "Stable with gravity along (0, 0, -1) of the assembly's frame: it may tilt by 45 degrees \
within the fan, not out of it."
    """
    at, tilt = f"{vector(down)} of the assembly's frame", f"{number(margin_deg, 4)} degrees"
    if friction:
        turn = "any turn keeps them" if margin_deg >= 180 else f"a tilt by {tilt} keeps them"
        options = " ".join(vector([c])[1:-1] for c in down)
        return (
            f"Forces that hold it exist with gravity along {at}, and {turn}; 'kilter check --down "
            f"{options}' tells what friction guarantees there."
        )
    if margin_deg >= 180:
        words = "it may be turned in any way"
    elif margin_deg > NO_ANGLE:
        words = f"it may tilt by {tilt}"
    elif within is not None and half_angle_deg is not None:
        half = number(half_angle_deg, 4)
        words = f"it may tilt by {half} degrees within the {within}, not out of it"
    else:
        words = "it may not tilt at all"
    return f"Stable with gravity along {at}: {words if exact else f'without friction {words}'}."


def live_words(*, exact: bool, band: bool, friction: bool) -> dict[str, str]:
    """What a page says of a direction of gravity that it answers by the region alone.

    Parameters
    ----------
    exact : bool
        The region is all of it.
    band : bool
        There is an inner and an outer cone.
    friction : bool
        Friction was counted.

    Examples
    --------
    >>> live_words(exact=True, band=False, friction=False)["nearest"]
    'stable direction'
    """
    basis = BASIS["band" if band else "friction" if friction else "exact" if exact else "inner"]
    asked = "friction" if friction else "exact" if exact else "inner"
    return {
        "none": NONE["exact" if exact else "friction" if friction else "inner"],
        "question": QUESTION[asked],
        "inside": INSIDE[asked],
        "basis": f"Live: by {basis}.",
        "nearest": "stable direction" if exact else "direction that surely holds",
    }


def motion_words(
    acceleration: Array,
    relative: Array,
    down: Array,
    *,
    center: Array | None = None,
    unit: float = 1.0,
) -> str:
    """How a part starts to move, from its accelerations.

    A part that turns about a line that stays is said to turn about that line; any other
    rotation is told about the centre of mass, with the acceleration of the centre. It *tips*
    where the line is level, and *turns* elsewhere. What *slides* has a level or oblique
    acceleration, what *drops* or *rises* a vertical one.

    Parameters
    ----------
    acceleration : ndarray, shape (6,)
        Linear [m/s^2] and angular [rad/s^2].
    relative : ndarray, shape (2,)
        Linear, and radius x angular, over gravity [-].
    down : ndarray, shape (3,)
    center : ndarray, shape (3,), optional
        Centre of mass [length unit], for the point that a line of rotation goes through.
    unit : float
        Metres of the length unit.

    Examples
    --------
    >>> down = np.array([0., 0, -1])
    >>> motion_words(np.array([0, 0, -9.81, 0, 0, 0]), np.array([1.0, 0]), down)
    'falls freely at 1 g'
    >>> motion_words(np.array([4.9, 0, 0, 0, 0, 0]), np.array([0.4995, 0]), down)
    'slides +x at 0.4995 g'
    >>> motion_words(np.array([4.9, 0, -4.9, 0, 0, 0]), np.array([0.7064, 0]), down)
    'slides down along (0.707, 0, -0.707) at 0.7064 g'
    >>> motion_words(np.array([0.6, 0.8, 1e-4, 0, 0, 0]), np.array([0.1, 0]), down)
    'slides along (0.6, 0.8, 0) at 0.1 g'
    >>> tipping = np.array([0, 0, -3.0, 0, 6.0, 0])
    >>> motion_words(tipping, np.array([0.3058, 0.5]), down, center=np.array([0.5, 0, 1]))
    'tips about +y through (0, 0, 1) at 6 rad/s^2, its centre drops at 0.3058 g'
    >>> motion_words(np.zeros(6), np.zeros(2), down)
    'stays'
    """
    linear, angular = float(relative[0]), float(relative[1])
    if max(linear, angular) == 0.0:
        return "stays"
    if angular <= SMALL * linear:
        return _translation(acceleration[:3], linear, down)
    spin = acceleration[3:]
    speed = float(np.linalg.norm(spin))
    verb = "tips" if abs(float(spin @ down)) < ALONG * speed else "turns"
    about, at = f"{verb} about {_direction(spin)}", f" at {speed:.4g} rad/s^2"
    if linear <= SMALL * angular:
        return about + at
    fixed = abs(float(spin @ acceleration[:3])) < ALONG * speed * np.linalg.norm(acceleration[:3])
    if fixed and center is not None:
        arm = np.cross(spin, acceleration[:3]) / (speed**2 * unit)
        about += f" through {_point(center + arm)}"
    return f"{about}{at}, its centre {_translation(acceleration[:3], linear, down)}"


def motion_summary(phrases: Sequence[str], total: int) -> str:
    """The fastest parts in one sentence.

    Parameters
    ----------
    phrases : sequence of str
        Name and words of the fastest parts, the fastest first; more than `NAMED` are counted.
    total : int
        Parts that move.

    Examples
    --------
    >>> motion_summary(["C3 slides +x at 0.43 g", "C2 drops at 0.25 g"], 5)
    'C3 slides +x at 0.43 g, C2 drops at 0.25 g and 3 more'
    >>> motion_summary(["C3 slides +x at 0.43 g", "C2 drops at 0.25 g"], 2)
    'C3 slides +x at 0.43 g and C2 drops at 0.25 g'
    >>> motion_summary([], 0)
    'nothing moves'
    """
    named = list(phrases[:NAMED])
    if not named:
        return "nothing moves"
    if total > len(named):
        return f"{', '.join(named)} and {total - len(named)} more"
    return " and ".join([", ".join(named[:-1]), named[-1]] if len(named) > 1 else named)


def _translation(linear: Array, size: float, down: Array) -> str:
    direction = linear / np.linalg.norm(linear)
    fall = float(direction @ down)
    level = float(np.linalg.norm(direction - fall * down))
    if level < ALONG:
        verb = "rises" if fall < 0 else "falls freely" if abs(size - 1) < 1e-9 else "drops"
        return f"{verb} at {size:.4g} g"
    toward = "" if abs(fall) < LEVEL else " down" if fall > 0 else " up"
    name = _direction(linear)
    along = name if name[0] in "+-" else f"along {name}"
    return f"slides{toward} {along} at {size:.4g} g"


def _direction(vector: Array) -> str:
    """An axis by name where the vector lies along it, else its unit vector."""
    unit = vector / np.linalg.norm(vector)
    axis = int(np.abs(unit).argmax())
    if np.linalg.norm(np.delete(unit, axis)) < ALONG:
        return ("+" if unit[axis] > 0 else "-") + "xyz"[axis]
    return _point(unit)


def _point(point: Array) -> str:
    """A point to 3 decimals of its largest coordinate."""
    digits = 3 - max(0, int(np.ceil(np.log10(max(float(np.abs(point).max()), 1e-6)))))
    return "(" + ", ".join(f"{round(float(c), digits) + 0.0:g}" for c in point) + ")"
