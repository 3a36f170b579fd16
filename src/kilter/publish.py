"""Pages, figures and films of answers: `report`, `view`, `draw`, `animate`.

The answers are computed first (`kilter.analysis.everything`) and then passed to the drawing
functions (`kilter.show`), which compute nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from kilter.errors import InputError
from kilter.work import EFFORT

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly import Assembly
    from kilter.assembly.verb_keywords import AssemblyOrPath
    from kilter.contact import ContactSet, Tolerance
    from kilter.second_order.answer.path_places import PathPlaces

__all__ = ["Report", "animate", "draw", "report"]

DRAWING = 1.0
"""Time of a time limit that is kept for drawing the figure, at most half of it [s]."""
PAUSE = 0.4
"""Time between two checks of a watched file [s]."""
PAGES = (".html", ".htm")
"""File endings of pages; no input file has them, so a typing error cannot overwrite an input."""
FILMS = (".glb",)
"""Endings of films."""
MOST = 50_000
"""Maximum number of parts on a page. A part takes a kilobyte; larger pages open too slowly."""
Tell = Callable[[str], None]
Given = tuple["Assembly", "ContactSet | None"]


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """One offline HTML page about an assembly, a plan or a map of places.

    Attributes
    ----------
    html : str
    verdict : str
        Verdict for gravity as given (see `kilter.Verdict`), or of the plan (see `kilter.Order`).
    """

    html: str
    verdict: str

    def __repr__(self) -> str:
        return f"Report({self.verdict!r}, {len(self.html.encode()) / 1e6:.2f} MB)"


def report(
    assembly: AssemblyOrPath | Order | Places,
    out: str | Path | None = None,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    title: str = "",
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    margins: bool = False,
    command: str = "",
    progress: Tell | None = None,
) -> Report:
    """Build an offline page: the assembly in 3D, its motion and forces, the gravity ball.

    The page of a plan shows its steps as a film and as a strip of pictures, with the held parts.
    The page of a map of places shows the assembly and the map; the part follows the pointer.

    Parameters
    ----------
    assembly : Assembly, path, Order, or Places
        An `Order` of `kilter.plan` is shown unchanged; nothing is computed again. The page of
        `Places` of `kilter.place` is that of their assembly, with the map as a layer.
    out : path, optional
        File of the page, ending in .html.
    friction, down, ground, floor : optional
        Changes of the assembly before the question, as in `kilter.check`.
    title : str
        Title of the page; by default the name of the file.
    contacts, tolerance, effort, time_limit, progress : optional
        As in `kilter.check`.
    margins : bool
        Compute margins even for more than 20 free parts; up to 20 the page always has them.
    command : str
        Command that reproduces the page, shown on it.

    Raises
    ------
    InputError
        If no part is held, the geometry is not usable, there are more than 50,000 parts, or the
        page cannot be written.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> report(scene("tower")).verdict
    'stable'
    """
    if out is not None:
        require_ending(out, PAGES, "page")
    subject = _changed(
        assembly, "report", contacts, friction=friction, down=down, ground=ground, floor=floor
    )
    places = _map_of(subject)
    if places is not None and places.question is not None:
        subject, contacts = places.assembly, places.question.contacts
    page = _plan_page(subject, title, command, progress) or _page(
        subject,
        contacts,
        places=places,
        title=title,
        tolerance=tolerance,
        effort=effort,
        time_limit=time_limit,
        margins=margins,
        command=command,
        progress=progress,
    )
    if out is not None:
        from kilter.files import write_text

        write_text(Path(out), page.html)
    return page


def _changed(subject: Any, verb: str, contacts: ContactSet | None, **changes: Any) -> Any:
    """Return an assembly with the changes of the keywords; an answer rejects changes."""
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly.verb_keywords import asked_assembly, require_unchanged

    if not isinstance(subject, Verdict | Region | Order | Settled | Transport | Places):
        return asked_assembly(subject, verb, contacts, **changes)
    require_unchanged(subject, **changes)
    return subject


def _map_of(subject: Any) -> Places | None:
    """The map of places that a page shows; None if `subject` is no answer about places.

    Raises
    ------
    InputError
        If the answer is about a given place.
    """
    from kilter.analysis.placing.place import Places

    if not isinstance(subject, Places):
        return None
    if subject.prism is None or subject.question is None:
        raise InputError(
            "the answer about a given place has no map to show",
            hint="show kilter.place(assembly, part) without a place",
        )
    return subject


def _plan_page(subject: Any, title: str, command: str, progress: Tell | None) -> Report | None:
    """Build the page of a plan; None if `subject` is not a plan."""
    from kilter.analysis.planning.order.order import Order

    if not isinstance(subject, Order):
        return None
    from kilter.analysis.planning.order.explained import explain
    from kilter.show.page import render_plan

    if progress is not None:
        progress("page")
    name = title or title_of(subject.states.assembly.source or "an assembly")
    return Report(render_plan(subject, explain(subject), name, command=command), subject.verdict)


def _page(
    assembly: Any,
    contacts: ContactSet | None,
    *,
    places: Places | None = None,
    title: str,
    tolerance: Tolerance | None,
    effort: float,
    time_limit: float | None,
    command: str,
    margins: bool = False,
    progress: Tell | None,
) -> Report:
    """Build the page of an assembly, with the arguments of `report` and `view`."""
    from kilter.analysis.everything import everything
    from kilter.assembly.assembly import require_assembly
    from kilter.show.page import render

    require_assembly(assembly, "report")
    if len(assembly) > MOST:
        raise InputError(
            f"a page of {len(assembly)} parts is too large for a browser; it can have up to {MOST}",
            file=assembly.source or None,
            hint="leave parts out with assembly.without(...), or use kilter.check",
            option="leave parts out with --without NAME, or use 'kilter check'",
        )
    answers = everything(
        assembly,
        contacts=contacts,
        tolerance=tolerance,
        effort=effort,
        time_limit=time_limit,
        margins=margins,
        progress=progress,
    )
    if progress is not None:
        progress("page")
    name = title or title_of(assembly.source or "an assembly")
    html = render(answers, name, command=command, places=places)
    return Report(html, str(answers.given.check["verdict"]))


def animate(subject: Order | Region | Verdict | Transport, out: str | Path | None = None) -> bytes:
    """Export a plan or a motion as an animated GLB file, for any glTF viewer.

    The film of a plan inserts each part along its path and marks held parts; without animation,
    a viewer shows the complete assembly. The film of a verdict moves the moving parts along their
    impending motion until parts would overlap. The parts of a balanced assembly fall along their
    path (`kilter.second_order.answer.path_places`). The film of an answer about transport shows the
    mechanism that starts first. Lengths are metres and y is up, as required by glTF.

    Parameters
    ----------
    subject : Order, Verdict or Transport
        Answer of `kilter.plan`, `kilter.check` or `kilter.transport`; a region has no motion and is
        rejected.
    out : path, optional
        File of the film, ending in .glb.

    Raises
    ------
    InputError
        If no order was found, no part is known to move, more than 3,000 parts move, or the file
        cannot be written.

    Examples
    --------
    >>> from kilter.analysis.check import check
    >>> from kilter.analysis.planning.order.plan import plan
    >>> from kilter.scenes import scene
    >>> animate(plan(scene("tower")))[:4]
    b'glTF'
    >>> animate(check(scene("paper-figure-8")))[:4]
    b'glTF'
    """
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict

    if out is not None:
        require_ending(out, FILMS, "film")
    if isinstance(subject, Verdict):
        film = _film_of(subject)
    elif isinstance(subject, Transport):
        film = _film_of_mechanism(subject)
    else:
        from kilter.show.plan_film import film_of_plan

        if not isinstance(subject, Order):
            raise InputError(
                f"a {type(subject).__name__.lower()} has no motion",
                hint="animate the answer of kilter.check or kilter.plan",
            )
        _require_steps(subject)
        film = film_of_plan(subject.states.assembly, subject.to_dict())
    if out is not None:
        from kilter.files import write_bytes

        write_bytes(Path(out), film)
    return film


def _film_of(verdict: Verdict) -> bytes:
    """GLB film of the impending motion, or of the fall of a balanced assembly."""
    from kilter.analysis.verdict.free_travel import free_travel
    from kilter.show.motion_film import film_of_fall, film_of_motion

    path = _path_of(verdict)
    if path is not None:
        return film_of_fall(verdict.assembly, path.motions, path.lengths)
    return film_of_motion(verdict.assembly, free_travel(verdict))


def _film_of_mechanism(answer: Transport) -> bytes:
    """GLB film of the motion that starts first on an accelerated carrier, seen from the carrier."""
    from kilter.analysis.margins.load_limit import starting
    from kilter.analysis.verdict.free_travel import travel_along
    from kilter.show.motion_film import film_of_motion

    mechanism = answer.mechanism
    if mechanism is None:
        raise InputError(
            "no part is known to move, so there is no motion to show",
            hint="ask for accelerations that are not carried",
        )
    moving = set(starting(answer.program, mechanism))
    screws = mechanism.motion * [[float(name in moving)] for name in answer.program.names]
    return film_of_motion(answer.assembly, travel_along(answer.assembly, screws))


def _path_of(verdict: Verdict) -> PathPlaces | None:
    """Path along which a balanced assembly falls; None for any other verdict."""
    from kilter.second_order.answer.path_places import find_path_places

    second = verdict.second_order
    return None if second is None else find_path_places(verdict.assembly, second)


def _require_steps(order: Order) -> None:
    """Raise `InputError` if a plan has no steps to show."""
    if not order.found:
        raise InputError("no order was found: there are no steps to show")
    if not order.steps:
        raise InputError("every part is held: there are no steps to show")


def draw(
    subject: AssemblyOrPath | Verdict | Region | Order | Settled | Transport | Places,
    out: str | Path | None = None,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    what: Literal["assembly", "region"] = "assembly",
    view: tuple[float, float] | None = None,
    names: bool | None = None,
    contacts: ContactSet | bool | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    progress: Tell | None = None,
) -> Figure:
    """Draw the parts with their motion or forces, or the stable region on the sphere.

    The figure of a plan is a sheet with one picture per step.

    Parameters
    ----------
    subject : Assembly, path, Verdict, Region, Order, Settled, Transport or Places
        An answer is drawn unchanged. For an assembly, the answer selected by `what` is computed.
    out : path, optional
        File of the figure, ending in .svg, .png or .pdf.
    friction, down, ground, floor : optional
        Changes of the assembly before the question, as in `kilter.check`.
    what : {"assembly", "region"}
        Figure of an assembly: its verdict or its stable region.
    view : (float, float), optional
        Azimuth (to the right of -y) and elevation of the eye [deg], with gravity down.
    names : bool, optional
        Write the names of the parts; by default only for few parts.
    contacts : ContactSet or bool, optional
        Contacts of this assembly; by default they are detected from its geometry. True or False
        decides whether contact patches are drawn; by default only few patches are drawn.
    tolerance, effort, time_limit, progress : optional
        As in `kilter.check`.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If matplotlib is not installed, the assembly is not valid, or the ending of the file is
        unknown.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> draw(scene("tower"), what="region").get_size_inches().tolist()
    [7.0, 4.3]
    """
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.show.canvas import encode_figure
    from kilter.show.figures import draw_assembly
    from kilter.show.movement_figure import draw_movement
    from kilter.show.plan_figure import draw_plan
    from kilter.show.sphere import draw_region

    require_figure(out, view)
    shown = contacts if isinstance(contacts, bool) else None
    known = None if isinstance(contacts, bool) else contacts
    subject = _changed(
        subject, "draw", known, friction=friction, down=down, ground=ground, floor=floor
    )
    answer = answer_to_draw(
        subject,
        what,
        contacts=known,
        tolerance=tolerance,
        effort=effort,
        time_limit=time_limit,
        progress=progress,
    )
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
    elif isinstance(answer, Order):
        _require_steps(answer)
        figure = draw_plan(answer.states.assembly, answer.to_dict(), view=view)
    else:
        path = _path_of(answer)
        fall = None if path is None else path.motions[path.half_way]
        figure = draw_assembly(answer, view=view, names=names, contacts=shown, fall=fall)
    if out is not None:
        from kilter.files import write_bytes

        write_bytes(Path(out), encode_figure(figure, Path(out).suffix))
    return figure


def _draw_transport(answer: Transport) -> Figure:
    """Draw the speed factor of a path, or the polar figure; an error if the answer has neither."""
    from kilter.show.path_profile import draw_path_profile
    from kilter.show.polar import draw_polar

    if answer.path is not None:
        if answer.path.limit is None:
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


def _draw_places(answer: Places) -> Figure:
    """Draw the map of places; an error if the answer is about a given place."""
    from kilter.show.place_figure import draw_places

    if answer.prism is None or answer.at is not None:
        raise InputError(
            "the answer about a given place has no map to draw",
            hint="draw kilter.place(assembly, part) without a place",
        )
    return draw_places(answer.to_dict(), answer.assembly, answer.prism.footprint.tolist())


def answer_to_draw(
    subject: Any,
    what: str,
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    progress: Tell | None = None,
) -> Any:
    """The answer that `draw` shows: the subject itself, or the verdict or region of an assembly."""
    from kilter.analysis.check import check
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region, region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly.assembly import require_assembly

    if isinstance(subject, Verdict | Region | Order | Settled | Transport | Places):
        return subject
    require_assembly(subject, "draw")
    if time_limit is not None:
        time_limit = max(time_limit - DRAWING, time_limit / 2)
    if what == "region":
        return region(
            subject,
            contacts=contacts,
            tolerance=tolerance,
            time_limit=time_limit,
            progress=progress,
        )
    if what != "assembly":
        raise InputError(f"there is no figure {what!r}", hint="give 'assembly' or 'region'")
    return check(
        subject,
        contacts=contacts,
        tolerance=tolerance,
        effort=effort,
        time_limit=time_limit,
        progress=progress,
    )


def require_ending(out: str | Path, endings: tuple[str, ...], what: str) -> None:
    """Reject an output name with a wrong ending, so that no input file is overwritten."""
    if Path(out).suffix.lower() not in endings:
        hint = f"use a name that ends in {', '.join(endings)}"
        raise InputError(f"not a file name for a {what}", file=str(out), hint=hint)


def require_film(what: str, view: tuple[float, float] | None) -> None:
    """Reject options that do not apply to a film, before any computation."""
    if what != "assembly":
        raise InputError(
            f"a {what} has no motion", hint="write a figure: out.svg, out.png or out.pdf"
        )
    if view is not None:
        raise InputError("a film has no view", hint="leave the view out; its viewer turns the film")


def require_figure(out: str | Path | None, view: tuple[float, float] | None) -> None:
    """Reject a file ending or a view that cannot be drawn, before any computation."""
    from kilter.show.canvas import SUFFIXES, require

    if out is not None:
        require_ending(out, SUFFIXES, "figure")
    if view is not None and not all(math.isfinite(angle) for angle in view):
        raise InputError(
            f"the view is {view[0]} {view[1]}",
            hint="give two angles in degrees",
            option="give two angles in degrees: --view -32 22",
        )
    require()


def title_of(source: str) -> str:
    """Name of a file without its folders and endings, as a title."""
    if source == "-":
        return "standard input"
    return Path(source).resolve().name.removesuffix(".json").removesuffix(".kilter")
