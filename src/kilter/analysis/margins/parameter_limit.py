"""The value of a parameter up to which an assembly reaches a verdict level, proved on both sides.

A function builds the assembly for each value: an arch of a given thickness, a stack of a given
overhang. Even samples show where the verdict changes; bisection narrows the first change. The
verdict need not be monotone in the parameter: every value that was decided is in the table.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from kilter.analysis.check import check
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly, require_assembly
from kilter.errors import InputError
from kilter.hooks import hook
from kilter.tell.levels import holds, require_level
from kilter.tell.numbers import number
from kilter.validate import number as finite_number

SAMPLES = 9
"""Number of even samples, with both ends."""
MOST = 60
"""Largest number of bisections."""


@dataclass(frozen=True, slots=True)
class DecidedValue:
    """A value of the parameter, and the verdict on the assembly with it."""

    value: float
    """Value of the parameter."""
    verdict: str
    """Verdict of `kilter.check`."""
    level: str | None
    """Level of the verdict."""
    reached: bool
    """Whether the required level is reached."""


@dataclass(frozen=True, slots=True, eq=False)
class ParameterLimit:
    """The values on both sides of the limit of a parameter, with their verdicts."""

    inside: float
    """Last value at which the required level is reached; NaN if none was found."""
    outside: float
    """First value beyond it at which the level is not reached; NaN if all decided values reach it.
    """
    require: str
    """Required verdict level."""
    proved: bool
    """Whether forces prove the inner value and a motion refutes the outer one."""
    changes: int
    """Number of changes between reached and not reached among the even samples."""
    within: Verdict | None
    """Verdict at `inside`; its `proof` is the proof of this side."""
    beyond: Verdict | None
    """Verdict at `outside`."""
    values: tuple[DecidedValue, ...]
    """All values that were decided, ascending."""

    @property
    def sentence(self) -> str:
        """The limit in words."""
        if math.isnan(self.inside):
            return f"No decided value reaches the level {self.require}."
        if math.isnan(self.outside):
            return f"All decided values reach the level {self.require}."
        proof = "both proved" if self.proved else "not both proved"
        more = f"; the verdict changes {self.changes} times" if self.changes > 1 else ""
        ends = f"{number(self.inside)} reaches the level {self.require}, "
        return f"{ends}{number(self.outside)} does not ({proof}{more})."

    @property
    def table(self) -> str:
        """The decided values, a line each: value, verdict, level."""
        return "\n".join(
            f"{number(each.value):>12}  {'yes' if each.reached else 'no ':3}  {each.verdict}"
            + (f", {each.level}" if each.level else "")
            for each in self.values
        )

    def plot(self) -> Any:
        """A matplotlib figure of the decided values.

        Raises
        ------
        InputError
            If matplotlib is not installed.
        """
        return hook("parameter_figure")(self)

    def __repr__(self) -> str:
        return f"ParameterLimit({self.inside:.6g} | {self.outside:.6g})"


def limit(
    build: Callable[[float], Assembly],
    low: float,
    high: float,
    *,
    require: str = "equilibrium",
    accuracy: float = 1e-4,
    progress: Callable[[str], None] | None = None,
) -> ParameterLimit:
    """Find the value of a parameter up to which an assembly stands, or from which on.

    Parameters
    ----------
    build : callable
        Function from a value to the assembly with it.
    low, high : float
        Ends of the interval that is searched.
    require : {"equilibrium", "settles", "proved", "strict"}
        Verdict level that counts.
    accuracy : float
        Largest distance of both sides of the limit, as a share of the interval [-].
    progress : callable, optional
        Function that receives a line of text after each decided value.

    Returns
    -------
    ParameterLimit
        The values on both sides, with their verdicts and a table of all decided values.

    Raises
    ------
    InputError
        If the interval is empty, the accuracy is not between 0 and 1, or the function returns no
        assembly.

    See Also
    --------
    kilter.margin : limits of tilt, friction and loads, which need no function.
    kilter.check : the verdict on a single assembly.

    Examples
    --------
    The largest overhang of a block is half of its length:

    >>> from kilter import Assembly, Box, Part
    >>> def overhang(x):
    ...     bench = Part("bench", Box(4, 1, 1), [-2, 0, -0.5], grounded=True)
    ...     return Assembly([bench, Part("block", Box(1, 1, 0.2), [x - 0.5, 0, 0.1])], friction=0.5)
    >>> found = limit(overhang, 0.0, 1.0)
    >>> abs(found.inside - 0.5) < 1e-3, found.outside - found.inside <= 1e-4, found.proved
    (True, True, True)
    """
    low, high = finite_number(low, "low"), finite_number(high, "high")
    accuracy = finite_number(accuracy, "accuracy", lowest=0, above=True)
    level = require_level(require)
    if not low < high:
        raise InputError(f"the interval from {low:g} to {high:g} is empty", hint="give low < high")
    if accuracy >= 1:
        raise InputError(f"the accuracy is {accuracy:g}", hint="give a share below 1")
    search = _ParameterSearch(build, level, progress)
    samples = [low + (high - low) * k / (SAMPLES - 1) for k in range(SAMPLES)]
    reached = [search.reached(value) for value in samples]
    ends = [(a, b) for a, b in _pairs(samples, reached) if a != b]
    if not ends:
        return search.answer(*((high, math.nan) if reached[0] else (math.nan, low)), 0)
    inside, outside = ends[0]
    for _ in range(MOST):
        if abs(outside - inside) <= accuracy * (high - low):
            break
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if search.reached(middle) else (inside, middle)
    return search.answer(inside, outside, len(ends))


def _pairs(samples: list[float], reached: list[bool]) -> Iterator[tuple[float, float]]:
    """Neighbouring samples with different answers: the value that reaches the level first."""
    for k in range(len(samples) - 1):
        if reached[k] != reached[k + 1]:
            yield (samples[k], samples[k + 1]) if reached[k] else (samples[k + 1], samples[k])


class _ParameterSearch:
    """Verdicts of the assemblies of a function; each value is decided once."""

    def __init__(
        self,
        build: Callable[[float], Assembly],
        require: str,
        progress: Callable[[str], None] | None,
    ) -> None:
        self.build, self.require, self.progress = build, require, progress
        self.known: dict[float, Verdict] = {}

    def reached(self, value: float) -> bool:
        """Whether the assembly with a value reaches the required level."""
        if value not in self.known:
            assembly = self.build(value)
            require_assembly(assembly, "limit")
            self.known[value] = check(assembly, require=self.require)
            if self.progress is not None:
                self.progress(f"{number(value)}: {self.known[value].verdict}")
        return bool(holds(self.known[value].level, self.require))

    def answer(self, inside: float, outside: float, changes: int) -> ParameterLimit:
        """The answer with the verdicts on both sides."""
        within, beyond = self.known.get(inside), self.known.get(outside)
        refuted = beyond is not None and (
            beyond.verdict == "unstable" or beyond.guarantee == "refuted"
        )
        return ParameterLimit(
            inside=inside,
            outside=outside,
            require=self.require,
            proved=within is not None and refuted,
            changes=changes,
            within=within,
            beyond=beyond,
            values=tuple(
                DecidedValue(value, verdict.verdict, verdict.level, self.reached(value))
                for value, verdict in sorted(self.known.items())
            ),
        )
