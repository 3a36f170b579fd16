"""`kilter.draw`: an answer as a figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from kilter.assembly.question import Question, question
from kilter.errors import InputError
from kilter.publish.films import (
    changed_subject,
    is_drawn_answer,
    known_movement,
    path_of,
    require_figure,
    require_movement,
    require_steps,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kilter.analysis.margins.margin_answer import Margin
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly.question import AssemblyOrPath
    from kilter.contact import ContactSet


DRAWING = 1.0
"""Time of a time limit that is kept for drawing the figure, at most half of it [s]."""
Tell = Callable[[str], None]


@question(lacks="contacts require")
def draw(
    subject: AssemblyOrPath | Verdict | Region | Order | Settled | Transport | Places | Margin,
    out: str | Path | None = None,
    *,
    asked: Question,
    what: Literal["assembly", "region", "changes", "thrust", "movement"] = "assembly",
    view: tuple[float, float] | None = None,
    names: bool | None = None,
    contacts: ContactSet | bool | None = None,
    moved: Mapping[str, Any] | None = None,
    turned: Mapping[str, Any] | None = None,
) -> Figure:
    """Draw the parts with their motion or forces, the stable region, or the changes that help.

    The figure of a plan is a sheet with a picture per step. That of a margin has an arrow on each
    part, along which a movement raises the limit most, and beside it the assembly with the best
    change of `improve`, or the one that `make_stand` found.

    Parameters
    ----------
    subject : Assembly, path, Verdict, Region, Order, Settled, Transport, Places or Margin
        An answer is drawn unchanged. For an assembly, the answer is computed.
    out : path, optional
        File of the figure, ending in .svg, .png or .pdf.
    what : {"assembly", "region", "changes", "thrust", "movement"}
        Figure of an assembly: its verdict, its stable region, the changes that help, the lines of
        least and greatest thrust of a chain of parts, or the movement of the parts after a movement
        of supports, magnified, with hinges. The last two also apply to a `Verdict`.
    view : (float, float), optional
        Azimuth (to the right of -y) and elevation of the eye [deg], with gravity down.
    names : bool, optional
        Write the names of the parts; by default only for few parts.
    contacts : ContactSet or bool, optional
        Contacts of this assembly; by default they are detected from its geometry. True or False
        decides whether contact patches are drawn; by default only few patches are drawn.
    moved, turned : mapping, optional
        Movements of supports for the figure of a movement, as in `Verdict.support_movement`.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If matplotlib is not installed, the assembly is not valid, or the ending of the file is
        unknown.

    See Also
    --------
    kilter.report : an interactive page.
    kilter.animate : a film.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> draw(scene("tower"), what="region").get_size_inches().tolist()
    [7.0, 4.3]
    """
    from kilter.analysis.margins.margin_answer import Margin
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.show.canvas import encode_figure
    from kilter.show.figures import draw_assembly
    from kilter.show.plan_figure import draw_movement, draw_plan
    from kilter.show.sphere import draw_region

    require_figure(out, view)
    require_movement(what, moved, turned)
    shown = contacts if isinstance(contacts, bool) else None
    known = None if isinstance(contacts, bool) else contacts
    asked = asked.but(contacts=known)
    answer = answer_to_draw(changed_subject(subject, asked.but(verb=what)), what, asked)
    if isinstance(answer, Region):
        figure = draw_region(answer)
    elif isinstance(answer, Settled):
        figure = draw_movement(
            answer.drawn, answer.movement, answer.to_dict()["sentence"], view=view
        )
    elif isinstance(answer, Transport):
        figure = _draw_transport(answer)
    elif isinstance(answer, Places):
        figure = _draw_places(answer)
    elif isinstance(answer, Margin):
        figure = _draw_changes(answer, view)
    elif isinstance(answer, Order):
        require_steps(answer)
        figure = draw_plan(answer.states.assembly, answer.to_dict(), view=view)
    elif what == "thrust":
        figure = _draw_thrust(answer, view)
    elif what == "movement":
        figure = _draw_movement(answer, moved or {}, turned or {}, view)
    else:
        path = path_of(answer)
        fall = None if path is None else path.motions[path.half_way]
        figure = draw_assembly(answer, view=view, names=names, contacts=shown, fall=fall)
    if out is not None:
        from kilter.files import write_bytes

        write_bytes(Path(out), encode_figure(figure, Path(out).suffix))
    return figure


def _draw_transport(answer: Transport) -> Figure:
    """Draw the speed factor of a path, or the polar figure; an error if the answer has neither."""
    from kilter.show.polar import draw_path_profile, draw_polar

    if answer.speed is not None:
        if answer.speed.limit is None:
            raise InputError(
                "the path is carried at every speed, so there is nothing to draw",
                hint="draw a path that limits the speed",
            )
        return draw_path_profile(answer.to_dict())
    if answer.polar is None:
        raise InputError(
            "this answer about transport has no horizontal accelerations to draw",
            hint="draw kilter.transport(assembly) of an assembly in space that holds at rest",
        )
    return draw_polar(answer.to_dict())


def _draw_changes(answer: Margin, view: tuple[float, float] | None) -> Figure:
    """Draw movements that help and the changed assembly; an error if nothing helps."""
    from kilter.analysis.margins.best_movements import best_forces, best_movements
    from kilter.show.changes_figure import draw_changes
    from kilter.tell.numbers import number

    given, words, changed = answer.assembly, "", None
    sentence = "No single change that was tried helps."
    if answer.made_stand is not None and answer.made_stand.stands:
        changed = answer.made_stand.assembly
        sentence = "; ".join(change.sentence for change in answer.made_stand.changes)
    elif answer.improvements:
        changed, sentence = answer.improvements[0].changed, answer.improvements[0].sentence
    arrows = np.zeros((len(given.parts), 3))
    try:
        gradient = answer.gradient()
        arrows, kind = best_movements(given, answer.contacts, gradient), "movement"
        per = given.units
        if not arrows.any():
            arrows, kind, per = best_forces(given, gradient), "force", "N"
        most = number(float(np.linalg.norm(arrows, axis=1).max()), 3)
        unit = "" if gradient.unit == "-" else f"{gradient.unit} "
        gain = "lowers the least" if gradient.of == "friction" else "raises the"
        words = f"a {kind} that {gain} {gradient.of}, longest {most} {unit}per {per}"
    except InputError:  # bonds have no gradient
        if changed is None:
            raise
    sentence = f"{sentence[0].upper()}{sentence[1:]}"
    return draw_changes(given, changed, arrows, words, sentence, view=view)


def _draw_thrust(verdict: Verdict, view: tuple[float, float] | None) -> Figure:
    """Draw the lines of least and of greatest thrust of a chain of parts."""
    from kilter.analysis.thrust_lines import find_thrust_lines
    from kilter.show.support_figure import draw_thrust
    from kilter.tell.numbers import force

    found = find_thrust_lines(verdict)
    words = []
    for name, end in (("least ", found.thrust.least), ("greatest ", found.thrust.greatest)):
        value = "without limit" if end.value is None else force(end.value)
        words.append(f"{name}thrust {value if end.proved else 'not known'}")
    if found.thrust.is_single:
        words = [words[0].removeprefix("least ")]
    sentence = ", ".join(words)
    lines = list(zip((found.least, found.greatest), words, strict=False))
    title = f"{sentence[0].upper()}{sentence[1:]}."
    return draw_thrust(found.assembly, found.span, lines, title, view=view)


def _draw_movement(
    verdict: Verdict,
    moved: Mapping[str, Any],
    turned: Mapping[str, Any],
    view: tuple[float, float] | None,
) -> Figure:
    """Draw an assembly after a magnified movement of its supports."""
    from kilter.show.support_figure import draw_support_movement

    found = known_movement(verdict, moved, turned)
    assembly, program = verdict.assembly, verdict.program
    supports = []
    for support in found.supports:
        part = assembly.index_of(support.part)
        points = program.point[(program.part_a == part) | (program.part_b == part)]
        center = assembly.geometry.center[part]
        supports.append((part, points.mean(axis=0) if len(points) else center))
    return draw_support_movement(assembly, found, supports, view=view)


def _draw_places(answer: Places) -> Figure:
    """Draw the map of places; an error if the answer is about a given place."""
    from kilter.show.place_figure import draw_places

    if answer.prism is None or answer.at is not None:
        raise InputError(
            "the answer about a given place has no map to draw",
            hint="draw kilter.place(assembly, part) without a place",
        )
    return draw_places(answer.to_dict(), answer.assembly, answer.prism.footprint.tolist())


def answer_to_draw(subject: Any, what: str, asked: Question) -> Any:
    """The answer that `draw` shows: the subject itself, or the verdict or region of an assembly."""
    from kilter.analysis.check import check
    from kilter.analysis.margins.margin import margin
    from kilter.analysis.regions.region import region
    from kilter.assembly.assembly import require_assembly

    if is_drawn_answer(subject):
        return subject
    require_assembly(subject, "draw")
    left = asked.seconds_left
    asked = asked.within(None if left is None else max(left - DRAWING, left / 2))
    asked = asked.but(assembly=subject)
    if what == "region":
        return region(asked)
    if what == "changes":
        return margin(asked, improve=True)
    if what not in ("assembly", "thrust", "movement"):
        raise InputError(
            f"there is no figure {what!r}",
            hint="give 'assembly', 'region', 'changes', 'thrust' or 'movement'",
        )
    return check(asked.but(verb="check"))  # so that the assumption of the file counts
