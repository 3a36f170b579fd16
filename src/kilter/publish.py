"""Pages and figures of an assembly: `report`, `view`, `draw`.

Every answer is asked for first (`kilter.analysis.everything`), then handed to what draws
(`kilter.show`), which computes nothing.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from kilter.errors import InputError
from kilter.files.fingerprint import fingerprint
from kilter.work import EFFORT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly import Assembly
    from kilter.contact import ContactSet, Tolerance
    from kilter.second_order.answer.path_places import PathPlaces
    from kilter.show.serve import PageServer

__all__ = ["Report", "animate", "draw", "report", "view"]

PAUSE = 0.4
"""Between two looks at a file [s]."""
PAGES = (".html", ".htm")
"""Endings of pages: no input ends so, and a slip cannot write over one."""
FILMS = (".glb",)
"""Endings of what is played by others."""
MOST = 50_000
"""Parts on a page: it takes a kilobyte for each, and seconds to open."""
Tell = Callable[[str], None]
Given = tuple["Assembly", "ContactSet | None"]


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """One offline page.

    Attributes
    ----------
    html : str
    verdict : str
        Of gravity as given, as of `kilter.Verdict`; of a plan, as of `kilter.Order`.
    """

    html: str
    verdict: str

    def __repr__(self) -> str:
        return f"Report({self.verdict!r}, {len(self.html.encode()) / 1e6:.2f} MB)"


def report(
    assembly: Assembly | Order,
    out: str | Path | None = None,
    *,
    title: str = "",
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    margins: bool = False,
    command: str = "",
    progress: Tell | None = None,
) -> Report:
    """One offline page: the assembly in space, its motion and forces, the gravity ball.

    Of a plan: its steps as a film and as a strip of pictures, what is held and why.

    Parameters
    ----------
    assembly : Assembly or Order
        What `kilter.plan` found is shown as it is; nothing is asked again.
    out : path, optional
        Where the page is written, ending in .html.
    title : str
        Shown above; the name of the file where it is not given.
    contacts, tolerance, effort, time_limit, progress
        As of `kilter.check`.
    margins : bool
        Margins where more than 20 parts are free, too; up to 20 they are always on the page.
    command : str
        How to make the page again, shown on it.

    Raises
    ------
    InputError
        If nothing is held, the geometry is not usable, there are more than 50,000 parts, or the
        page cannot be written.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> report(scene("tower")).verdict
    'stable'
    """
    if out is not None:
        require_ending(out, PAGES, "page")
    made = _plan_page(assembly, title, command, progress) or _page(
        assembly,
        contacts,
        title=title,
        tolerance=tolerance,
        effort=effort,
        time_limit=time_limit,
        margins=margins,
        command=command,
        live=False,
        progress=progress,
    )
    if out is not None:
        from kilter.files import write_text

        write_text(Path(out), made.html)
    return made


def _plan_page(subject: Any, title: str, command: str, progress: Tell | None) -> Report | None:
    """The page of a plan; None of anything else."""
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
    title: str,
    tolerance: Tolerance | None,
    effort: float,
    time_limit: float | None,
    command: str,
    live: bool,
    margins: bool = False,
    progress: Tell | None,
) -> Report:
    from kilter.analysis.everything import everything
    from kilter.assembly.assembly import require_assembly
    from kilter.show.page import render

    require_assembly(assembly, "report")
    if len(assembly) > MOST:
        raise InputError(
            f"a page of {len(assembly)} parts is too much for a browser, up to {MOST} are shown",
            file=assembly.source or None,
            hint="leave parts out with assembly.without(...), or ask kilter.check",
            option="leave parts out with --without NAME, or ask 'kilter check'",
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
    html = render(answers, name, command=command, live=live)
    return Report(html, str(answers.given.check["verdict"]))


def view(
    source: Assembly | str | Path,
    *,
    port: int = 0,
    browser: bool = True,
    read: Callable[[], Given] | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    command: str = "",
    say: Tell | None = None,
    progress: Tell | None = None,
) -> None:
    """The page of an assembly in the browser; made anew whenever its file changes.

    It is served to this machine alone, until it is interrupted.

    Parameters
    ----------
    source : Assembly or path
        A path is watched.
    port : int
        0: any that is free.
    browser : bool
        Open the page in a browser.
    read : callable, optional
        How the file is read: gives the assembly, and its contacts where they are known;
        `kilter.load` where it is not given.
    tolerance, effort, time_limit, progress
        As of `kilter.check`.
    command : str
        How to see the page again, shown on it.
    say : callable, optional
        Called with a line about the page: where it is, and what has changed.

    Raises
    ------
    InputError
        If the port is taken, or as `report`.
    """
    from kilter.show.serve import PageServer

    tell = say or (lambda line: None)
    path = os.fspath(source) if isinstance(source, str | os.PathLike) else None

    def made() -> Report:
        if progress is not None:
            progress("reading")
        assembly, contacts = read() if read is not None else _read(source)
        return _page(
            assembly,
            contacts,
            title="" if path is None else title_of(path),
            tolerance=tolerance,
            effort=effort,
            time_limit=time_limit,
            command=command,
            live=True,
            progress=progress,
        )

    watched = None if path is None else _Watched(path, made, tell, command)
    first = made()
    with PageServer(first.html, port) as server:
        try:
            tell(f"{server.url}  ({first.verdict}; Ctrl-C ends it)")
            if browser:
                import webbrowser

                webbrowser.open(server.url)
            last = first.html
            while True:
                time.sleep(PAUSE)
                if watched is not None:
                    last = watched.look(server, last)
        except KeyboardInterrupt:
            return


def _read(source: Any) -> Given:
    if not isinstance(source, str | os.PathLike):
        return source, None
    from kilter.files import load

    return load(os.fspath(source)), None


class _Watched:
    """A file whose page is served anew when it has changed."""

    def __init__(self, path: str, made: Callable[[], Report], tell: Tell, command: str) -> None:
        self.path, self.made, self.tell, self.command = path, made, tell, command
        self.seen = fingerprint(path)

    def look(self, server: PageServer, last: str) -> str:
        """Serve the file anew if it has changed; its last page that was right.

        A moment later, since it may be half written. Where it cannot be judged, the page that was
        right stays, below the reason.
        """
        from kilter.show.page import error_page

        if fingerprint(self.path) == self.seen:
            return last
        time.sleep(PAUSE / 2)
        self.seen = fingerprint(self.path)
        try:
            page = self.made()
        except InputError as error:
            # only a command names itself: its error speaks of options
            words = error.for_command if self.command else str(error)
            server.publish(error_page(words, last))
            self.tell(f"changed: not judged: {words}")
            return last
        server.publish(page.html)
        self.tell(f"changed: {page.verdict}")
        return page.html


def animate(subject: Order | Region | Verdict, out: str | Path | None = None) -> bytes:
    """A plan or a motion as an animated GLB, for any viewer.

    Of a plan each part comes in along its way, and held parts are marked; at rest all is put
    together. Of a verdict the parts that move start to move, and stop before one enters another;
    where it is balanced they fall along its path (`kilter.second_order.answer.path_places`).
    Lengths in metres, y up, as glTF has it.

    Parameters
    ----------
    subject : Order or Verdict
        What `kilter.plan` or `kilter.check` found; a region has no motion, and is refused.
    out : path, optional
        Where the film is written, ending in .glb.

    Raises
    ------
    InputError
        If no order was found, nothing is known to move, there are more than 3,000 parts to move,
        or the file cannot be written.

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
    from kilter.analysis.verdict.verdict import Verdict

    if out is not None:
        require_ending(out, FILMS, "film")
    if isinstance(subject, Verdict):
        film = _film_of(subject)
    else:
        from kilter.show.plan_film import film_of_plan

        if not isinstance(subject, Order):
            raise InputError(
                f"a {type(subject).__name__.lower()} has no motion",
                hint="animate what kilter.check or kilter.plan found",
            )
        _require_steps(subject)
        film = film_of_plan(subject.states.assembly, subject.to_dict())
    if out is not None:
        from kilter.files import write_bytes

        write_bytes(Path(out), film)
    return film


def _film_of(verdict: Verdict) -> bytes:
    """How parts start to move, or how what is balanced falls."""
    from kilter.analysis.verdict.free_travel import free_travel
    from kilter.show.motion_film import film_of_fall, film_of_motion

    path = _path_of(verdict)
    if path is not None:
        return film_of_fall(verdict.assembly, path.motions, path.lengths)
    return film_of_motion(verdict.assembly, free_travel(verdict))


def _path_of(verdict: Verdict) -> PathPlaces | None:
    """How what is balanced falls."""
    from kilter.second_order.answer.path_places import find_path_places

    second = verdict.second_order
    return None if second is None else find_path_places(verdict.assembly, second)


def _require_steps(order: Order) -> None:
    if not order.found:
        raise InputError("no order was found: there are no steps to show")


def draw(
    subject: Assembly | Verdict | Region | Order,
    out: str | Path | None = None,
    *,
    what: Literal["assembly", "region"] = "assembly",
    view: tuple[float, float] | None = None,
    names: bool | None = None,
    contacts: ContactSet | bool | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    progress: Tell | None = None,
) -> Figure:
    """A figure: the parts with their motion or forces, or the stable region on the sphere.

    Of a plan: a sheet with a picture a step.

    Parameters
    ----------
    subject : Assembly, Verdict, Region or Order
        An answer is drawn as it is; of an assembly `what` is asked first.
    out : path, optional
        Where the figure is written: .svg, .png or .pdf.
    what : {"assembly", "region"}
        Of an assembly.
    view : (float, float), optional
        Azimuth (to the right of -y) and elevation of the eye [deg], with gravity down.
    names : bool, optional
        Write names; where not given, where there are few.
    contacts : ContactSet or bool, optional
        Those of an assembly; or whether contact patches are shown, where not given where
        there are few.
    tolerance, effort, time_limit, progress
        As of `kilter.check`.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If matplotlib is not installed, the subject cannot be judged, or the name of the figure
        has no known ending.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> draw(scene("tower"), what="region").get_size_inches().tolist()
    [7.0, 4.3]
    """
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.show.canvas import rendered
    from kilter.show.figures import draw_assembly
    from kilter.show.plan_figure import draw_plan
    from kilter.show.sphere import draw_region

    require_figure(out, view)
    shown = contacts if isinstance(contacts, bool) else None
    known = None if isinstance(contacts, bool) else contacts
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
    elif isinstance(answer, Order):
        _require_steps(answer)
        figure = draw_plan(answer.states.assembly, answer.to_dict(), view=view)
    else:
        path = _path_of(answer)
        fall = None if path is None else path.motions[path.half_way]
        figure = draw_assembly(answer, view=view, names=names, contacts=shown, fall=fall)
    if out is not None:
        from kilter.files import write_bytes

        write_bytes(Path(out), rendered(figure, Path(out).suffix))
    return figure


def answer_to_draw(
    subject: Any,
    what: str,
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    progress: Tell | None = None,
) -> Verdict | Region | Order:
    """What a figure shows: of an assembly its verdict or its region; an answer as it is."""
    from kilter.analysis.check import check
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region, region
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly.assembly import require_assembly

    if isinstance(subject, Verdict | Region | Order):
        return subject
    require_assembly(subject, "draw")
    if what == "region":
        return region(subject, contacts=contacts, tolerance=tolerance, progress=progress)
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
    """Refuse a name that could be that of an input."""
    if Path(out).suffix.lower() not in endings:
        hint = f"end it in {', '.join(endings)}"
        raise InputError(f"is no name of a {what}", file=str(out), hint=hint)


def require_film(what: str, view: tuple[float, float] | None) -> None:
    """Refuse what no film of a motion shows, before anything is asked."""
    if what != "assembly":
        raise InputError(f"a {what} has no motion", hint="name a figure: out.svg, out.png, out.pdf")
    if view is not None:
        raise InputError("a film has no view", hint="its viewer turns it: leave the view out")


def require_figure(out: str | Path | None, view: tuple[float, float] | None) -> None:
    """Refuse what cannot be drawn before anything is asked."""
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
    """The name of a file, without its folders and endings."""
    if source == "-":
        return "standard input"
    return Path(source).resolve().name.removesuffix(".json").removesuffix(".kilter")
