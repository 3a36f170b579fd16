"""Table of the places of rest: direction of gravity, supporting parts, state, limits of tilt."""

from __future__ import annotations

from collections.abc import Sequence

from kilter.tell.check_facts import Answer
from kilter.tell.numbers import angle, number, plain, vector
from kilter.tell.tables import Table

REST_SIGNS = {
    "minimum": "strict minimum",
    "free": "slides or rolls freely",
    "balanced": "only balances",
    "open": "open",
}
"""Words of the states of rest, the safest first."""
HEAD = ("gravity", "lies on", "rest", "tilt", "energy to tip", "righting moment", "swing")
"""Column heads; the swing is a period [s], or a rate [1/s] if the period is not known."""


def rest_table(region: Answer) -> Table:
    """Return the table of resting positions in a region, the strict minima of energy first.

    Examples
    --------
    >>> corner = {"down": [0, 0, -1], "on": ["floor"], "state": "minimum", "tilt_deg": 35.3,
    ...           "rate": None, "well": None}
    >>> rest_table({"rests": [corner]}).rows(1)
    [['(0, 0, -1)', 'floor', 'strict minimum', '35.3 deg', '', '', '']]
    """
    order = {state: k for k, state in enumerate(REST_SIGNS)}
    rests = sorted(region["rests"], key=lambda rest: order[rest["state"]])
    return Table("", HEAD, rests, _row)


def _row(rest: Answer) -> Sequence[str]:
    """Return the cells of a resting position, in the order of `HEAD`."""
    well = rest["well"] or {}
    tilt = rest["tilt_deg"] if rest["state"] == "minimum" else None
    tilt = well.get("over_deg", tilt) if well else tilt
    period = well.get("period")
    return [
        vector(rest["down"], 3),
        ", ".join(plain(name) for name in rest["on"]),
        REST_SIGNS[rest["state"]],
        angle(tilt) if tilt else "",
        _measure(well.get("barrier"), "J"),
        _measure(well.get("stiffness"), "N m/rad"),
        _measure(period, "s") if period else _measure(rest["rate"], "1/s"),
    ]


def _measure(value: float | None, unit: str) -> str:
    return "" if value is None else f"{number(value, 4)} {unit}"
