"""Sentences for verdicts, for directions of gravity and for motions; each phrase stands once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.tell.numbers import NO_ANGLE, number, vector

VERDICTS = {
    "stable": "Stable",
    "settles": "Settles",
    "potentially-stable": "Potentially stable",
    "balanced": "Balanced",
    "unstable": "Unstable",
    "undecided": "Undecided",
    "unknown": "Not known",
}
"""Words of the verdicts. Only a page uses `unknown`: a direction of gravity without an answer."""
SMALL = 1e-3
"""A component below this share of the whole motion is not mentioned [-]."""
ALONG = 1e-6
"""A direction within this distance of an axis or of gravity is named after it [rad]."""
LEVEL = 5e-4
"""A slope below this is described as level, since vectors are shown with three decimals [rad]."""
GAINS = "in a motion that gains energy"
"""Words for the motion of a proof, which shows that parts start to move, but not how fast."""
NAMED = 2
"""Number of parts, the fastest first, that `motion_summary` describes."""
SENTENCES = {
    ("stable", None): "Stable{within}: it cannot start to move{slippery}.",
    ("stable", "proved"): (
        "Stable{within}: with this friction no motion can start, whatever the initial contact "
        "forces are{assumed}."
    ),
    ("settles", None): (
        "Settles{within}: put down loosely, it came to rest in all {of} tries, held by the "
        "friction that its own weight creates. No motion from rest was found, but it is not proved "
        "that none exists."
    ),
    ("potentially-stable", "refuted"): (
        "Potentially stable{within}: the friction that its own weight creates can hold it. "
        "Released loosely, it could also start to move like this."
    ),
    ("potentially-stable", "refuted squeeze"): (
        "Potentially stable{within}, held only by preload: it stays only if forces other than its "
        "weight press the parts together. Otherwise it moves like this."
    ),
    ("potentially-stable", "jams"): (
        "Potentially stable{within}: forces that hold it exist. Put down loosely, it came to rest "
        "in only {passed} of {tried} tries. No motion from rest was found."
    ),
    ("potentially-stable", "squeeze"): (
        "Potentially stable{within}, held only by preload: it stays only if forces other than its "
        "weight press the parts together. No motion from rest was found."
    ),
    ("potentially-stable", "not-asked"): (
        "Potentially stable{within}: forces that hold it exist; settling and other motions were "
        "not examined."
    ),
    ("potentially-stable", "not-found"): (
        "Potentially stable{within}: forces that hold it exist, and no motion from rest was found. "
        "Whether it settles was not determined."
    ),
    ("unstable", None): (
        "Unstable{beyond}: {smooth}no contact forces can hold it{here} is how it starts to move."
    ),
}
"""Sentences by verdict and, if the verdict rests on friction, by guarantee or by reason."""


BASIS = {
    "exact": "the exact cone of stable directions. The margin is the angle to its nearest facet",
    "friction": "the cone of directions for which forces that hold it exist",
    "band": (
        "the cone of directions for which forces that hold it exist. Friction makes this cone "
        "round, so two cones with flat facets bound it. Inside the inner cone the forces are "
        "proved to exist. Outside the outer cone no such forces exist. Between the two cones the "
        "answer is undecided"
    ),
    "inner": (
        "the cone of directions that are stable without friction and without the contacts that "
        "are not modelled. Outside this cone friction or these contacts may hold it, so there "
        "the answer is undecided"
    ),
}
"""Basis of the answer that a page gives for any direction of gravity."""
QUESTION = {
    "exact": "Inside the region it cannot start to move. Outside the region it starts to move.",
    "friction": (
        "Inside the region forces that hold it exist (level equilibrium). Outside the region no "
        "such forces exist. What friction guarantees is known only for the given and for the "
        "recommended direction."
    ),
    "inner": (
        "Inside the region it is stable even without friction. Outside the region friction or "
        "contacts that are not modelled may hold it: there the answer is undecided."
    ),
}
"""Meaning of the inside and the outside of the region on a page."""
INSIDE = {
    "exact": "stable",
    "friction": "forces that hold it exist",
    "inner": "stable, even without friction",
}
"""Meaning of the colour of the region."""
NONE = {
    "exact": "no direction of gravity is stable",
    "friction": "no direction of gravity is held by the modelled contacts, not even with friction",
    "inner": (
        "no direction of gravity is held by the frictionless contacts alone; further forces might "
        "hold it"
    ),
}


def verdict_sentence(verdict: str, **about: Any) -> str:
    """Return the sentence of a verdict other than undecided, from facts `about` its assembly.

    Of friction: `guarantee`, `why`, `seated`, `tries` (numbers of passed, made and planned tries)
    and `assumed` (by the proof). Of the input: `coarse` coordinates, the widest `counted` gap with
    its unit, `bonded`, `has_open_pairs`, `frictionless` contacts and `rubbing_joints`.

    Examples
    --------
    >>> verdict_sentence("unstable", has_open_pairs=True)
    'Unstable: no contact forces can hold it, not even with forces at its open pairs. Here is \
how it starts to move.'
    >>> verdict_sentence("stable")
    'Stable: it cannot start to move, even without friction.'
    >>> verdict_sentence("stable", counted="1 mm")
    'Stable, counting gaps up to 1 mm as closed: it cannot start to move.'
    """
    given = defaultdict(str, about)
    key = about.get("guarantee" if verdict == "stable" else "why")
    if key == "refuted" and given["seated"] == "runs-away":
        key = "refuted squeeze"
    passed, tried, of = about.get("tries", (0, 0, 0))
    counted, coarse = given["counted"], given["coarse"]
    counting = f", counting gaps up to {counted} as closed" if counted else ""
    counting += ", if no bond breaks below its capacity" if given["bonded"] else ""
    contacts_only = " of contacts" if given["rubbing_joints"] else ""
    return SENTENCES[verdict, key].format(
        within=(", up to the accuracy of its coordinates" if coarse else "") + counting,
        slippery="" if counted else f", even without friction{contacts_only}",
        smooth="without friction " if given["frictionless"] else "",
        assumed=f" ({given['assumed']})" if given["assumed"] else "",
        beyond=", by more than the accuracy of its coordinates" if coarse else "",
        here=", not even with forces at its open pairs. Here"
        if given["has_open_pairs"]
        else "; here",
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
    """Return the sentence of a recommended direction of gravity, and its tilt margin.

    Parameters
    ----------
    down : ndarray, shape (3,)
        Unit vector in the frame of the assembly.
    margin_deg : float
        Angle to the boundary of the region [deg].
    friction : bool
        Whether friction was counted.
    exact : bool
        Whether every force that could hold the assembly was counted.
    within : str, optional
        Kind of the region, if it has more than one direction.
    half_angle_deg : float, optional
        Half angle of the widest circular cone inside the region [deg].

    Examples
    --------
    >>> thin = {"friction": False, "exact": True, "within": "fan", "half_angle_deg": 45.0}
    >>> found_sentence(np.array([0.0, 0, -1]), 4.8e-15, **thin)
    "Stable with gravity along (0, 0, -1) of the assembly's frame: gravity may turn by 45 degrees \
inside the fan, not out of it."
    """
    at, tilt = f"{vector(down)} of the assembly's frame", f"{number(margin_deg, 4)} degrees"
    if friction:
        turn = "after any turn" if margin_deg >= 180 else f"after any tilt up to {tilt}"
        options = " ".join(vector([c])[1:-1] for c in down)
        return (
            f"Forces that hold it exist with gravity along {at}, and {turn}. 'kilter check --down "
            f"{options}' reports what friction guarantees there."
        )
    if margin_deg >= 180:
        words = "it may be turned in any way"
    elif margin_deg > NO_ANGLE:
        words = f"it may tilt by {tilt}"
    elif within is not None and half_angle_deg is not None:
        half = number(half_angle_deg, 4)
        words = f"gravity may turn by {half} degrees inside the {within}, not out of it"
    else:
        words = "it may not tilt at all"
    return f"Stable with gravity along {at}: {'' if exact else 'even without friction '}{words}."


def live_words(*, exact: bool, band: bool, friction: bool) -> dict[str, str]:
    """Return the phrases that a page shows for directions of gravity other than the computed one.

    Examples
    --------
    >>> live_words(exact=True, band=False, friction=False)["nearest"]
    'stable direction'
    """
    basis = BASIS["band" if band else "friction" if friction else "exact" if exact else "inner"]
    kind = "friction" if friction else "exact" if exact else "inner"
    return {
        "none": NONE["exact" if exact else "friction" if friction else "inner"],
        "question": QUESTION[kind],
        "inside": INSIDE[kind],
        "basis": f"Live: by {basis}.",
        "nearest": "stable direction" if exact else "direction that is proved to hold",
    }


@dataclass(frozen=True, slots=True, eq=False)
class RoundMantle:
    """Sphere, or mantle of a cylinder, on which a part may roll."""

    center: Array
    """Centre of the sphere, or a point of the axis [length unit], shape (3,)."""
    axis: Array | None
    """Unit vector of the axis, shape (3,); None for a sphere."""
    radius: float

    def touches(self, point: Array, along: Array) -> bool:
        """Whether the line through a point along a unit vector is a tangent or a generator."""
        if self.axis is not None and np.linalg.norm(np.cross(self.axis, along)) > ALONG:
            return False
        arm = point - self.center
        away = float(np.linalg.norm(arm - (arm @ along) * along))
        return abs(away - self.radius) <= SMALL * self.radius


def motion_words(
    acceleration: Array,
    relative: Array,
    down: Array,
    *,
    center: Array | None = None,
    unit: float = 1.0,
    sizes: bool = True,
    mantle: RoundMantle | None = None,
) -> str:
    """Return how a part starts to move (slides, tips ...), from its accelerations.

    If the part rotates about a line at rest, the words name this line. Any other rotation is
    described about the centre of mass, with the acceleration of the centre. The part *tips* if
    the axis is level and *turns* otherwise. It *rolls* if its round mantle touches a level axis at
    rest. It *slides* if its acceleration is level or oblique,
    and *drops* or *rises* if its acceleration is vertical.

    Arguments: `acceleration` (6,) [m/s^2]; `relative` (2,) [-]; `down` (3,); `center` (3,) [length
    unit]; `unit` [m]; `mantle` [length unit].

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
    >>> motion_words(tipping, np.array([0.3058, 0.5]), down, center=np.ones(3), sizes=False)
    'tips about +y through (0.5, 1, 1)'
    >>> ball = RoundMantle(np.array([0.5, 0, 1]), None, 0.5)
    >>> rolling = np.array([3.0, 0, 0, 0, 6.0, 0])
    >>> motion_words(rolling, np.array([0.3058, 0.5]), down, center=ball.center, mantle=ball)
    'rolls +x at 0.3058 g'
    >>> motion_words(np.zeros(6), np.zeros(2), down)
    'stays'
    """
    linear, angular = float(relative[0]), float(relative[1])
    if max(linear, angular) == 0.0:
        return "stays"
    if angular <= SMALL * linear:
        return _translation(acceleration[:3], linear, down, sizes)
    spin = acceleration[3:]
    speed = float(np.linalg.norm(spin))
    verb = "tips" if abs(float(spin @ down)) < ALONG * speed else "turns"
    about, at = f"{verb} about {_direction(spin)}", f" at {speed:.4g} rad/s^2" if sizes else ""
    if linear <= SMALL * angular:
        return about + at
    fixed = abs(float(spin @ acceleration[:3])) < ALONG * speed * np.linalg.norm(acceleration[:3])
    if fixed and center is not None:
        arm = np.cross(spin, acceleration[:3]) / (speed**2 * unit)
        if mantle is not None and verb == "tips" and mantle.touches(center + arm, spin / speed):
            words = _translation(acceleration[:3], linear, down, sizes)
            return f"rolls {words.split(maxsplit=1)[1]}"
        size = angular / linear * float(np.linalg.norm(acceleration[:3])) / (speed * unit)
        about += f" through {_point(center + arm, size)}"
    if fixed and not sizes:
        return about
    return f"{about}{at}, its centre {_translation(acceleration[:3], linear, down, sizes)}"


def fall_words(distance: float, units: str, *, lands: bool) -> str:
    """Return a straight fall in words that end before the name of the part below.

    `lands`: whether the part below stays at rest, so that the length of the fall is known.

    Examples
    --------
    >>> fall_words(18.0, "mm", lands=True), fall_words(0.5, "m", lands=False)
    ('falls 18 mm onto', 'falls freely 0.5 m above')
    """
    size = f"{number(distance, 3)} {units}"
    return f"falls {size} onto" if lands else f"falls freely {size} above"


def upward_words(up: str) -> str:
    """Return the proposal of another upward axis, with which the assembly holds.

    Examples
    --------
    >>> print(upward_words("y")[-59:])
    if y points up in the file, give --up y (in Python up='y')
    """
    return (
        f"with z up it falls even if parts that touch are joined, with {up} up it then stays: if "
        f"{up} points up in the file, give --up {up} (in Python up={up!r})"
    )


def motion_summary(phrases: Sequence[str], total: int) -> str:
    """Return a phrase about the parts that move fastest.

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


def _translation(linear: Array, size: float, down: Array, sizes: bool) -> str:
    """Return a translation in words, with its acceleration relative to gravity if `sizes`."""
    direction = linear / np.linalg.norm(linear)
    fall = float(direction @ down)
    level = float(np.linalg.norm(direction - fall * down))
    at = f" at {size:.4g} g" if sizes else ""
    if level < ALONG:
        free = sizes and abs(size - 1) < 1e-9
        return f"{'rises' if fall < 0 else 'falls freely' if free else 'drops'}{at}"
    toward = "" if abs(fall) < LEVEL else " down" if fall > 0 else " up"
    name = _direction(linear)
    along = name if name[0] in "+-" else f"along {name}"
    return f"slides{toward} {along}{at}"


def _direction(vector: Array) -> str:
    """Return the name of the axis along a vector, or the unit vector if it is along none."""
    unit = vector / np.linalg.norm(vector)
    axis = int(np.abs(unit).argmax())
    if np.linalg.norm(np.delete(unit, axis)) < ALONG:
        return ("+" if unit[axis] > 0 else "-") + "xyz"[axis]
    return _point(unit, 1.0)


def _point(point: Array, size: float) -> str:
    """Return a point as text, rounded to 3 significant digits of a length `size`."""
    digits = 3 - int(np.ceil(np.log10(max(size, 1e-6))))
    return "(" + ", ".join(f"{round(float(c), digits) + 0.0:.12g}" for c in point) + ")"
