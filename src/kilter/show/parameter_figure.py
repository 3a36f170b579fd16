"""Figure of the values of a parameter at which an assembly stands, and of those at which not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kilter.show.canvas import new_figure
from kilter.tell.palette import ROLES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kilter.analysis.margins.parameter_limit import ParameterLimit


def parameter_figure(limit: ParameterLimit) -> Figure:
    """A matplotlib figure: the decided values, by the verdict, and the limit as a line.

    Raises `InputError` if matplotlib is not installed.
    """
    figure = new_figure(7.0, 2.6)
    axes = figure.add_subplot()
    for reached, mark in ((True, "o"), (False, "x")):
        values = [each.value for each in limit.values if each.reached == reached]
        words = [each.verdict for each in limit.values if each.reached == reached]
        axes.plot(values, words, mark, color=ROLES["ink" if reached else "unstable"].light)
    for value in (limit.inside, limit.outside):
        axes.axvline(value, color=ROLES["soft"].light, linewidth=0.8)
    axes.set_xlabel("parameter")
    axes.set_title(limit.sentence, fontsize=9)
    return figure
