"""`kilter.report`: an assembly, a plan or a map of places as an offline page."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.assembly.question import Question, question
from kilter.errors import InputError
from kilter.publish.films import PAGES, changed_subject, require_ending, title_of

if TYPE_CHECKING:
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.assembly.question import AssemblyOrPath


MOST = 50_000
"""Maximum number of parts on a page. A part takes a kilobyte; larger pages open too slowly."""
Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """Offline HTML page about an assembly, a plan or a map of places.

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


@question(lacks="require")
def report(
    assembly: AssemblyOrPath | Order | Places,
    out: str | Path | None = None,
    *,
    asked: Question,
    title: str = "",
    margins: bool = False,
    moved: Mapping[str, Any] | None = None,
    turned: Mapping[str, Any] | None = None,
    command: str = "",
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
    title : str
        Title of the page; by default the name of the file.
    margins : bool
        Compute margins even for more than 20 free parts; up to 20 the page always has them.
    moved, turned : mapping, optional
        Movements of supports, as in `Verdict.support_movement`: the page plays the movement that
        follows, magnified, with its hinges.
    command : str
        Command that reproduces the page, shown on it.

    Raises
    ------
    InputError
        If no part is held, the geometry is not usable, there are more than 50,000 parts, or the
        page cannot be written.

    See Also
    --------
    kilter.draw : a picture for a document.
    kilter.view : the workbench, which changes the assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> report(scene("tower")).verdict
    'stable'
    """
    if out is not None:
        require_ending(out, PAGES, "page")
    subject = changed_subject(assembly, asked)
    places = _map_of(subject)
    if places is not None and places.question is not None:
        subject, asked = places.assembly, asked.but(contacts=places.question.contacts)
    page = _plan_page(subject, title, command, asked) or _page(
        subject, asked, places, title, command, margins=margins, moved=moved, turned=turned
    )
    if out is not None:
        from kilter.files import write_text

        write_text(Path(out), page.html)
    return page


def _map_of(subject: Any) -> Places | None:
    """The map of places that a page shows; None if `subject` is no answer about places.

    Raises `InputError` if the answer is about a given place.
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


def _plan_page(subject: Any, title: str, command: str, asked: Question) -> Report | None:
    """Build the page of a plan; None if `subject` is not a plan."""
    from kilter.analysis.planning.order.order import Order

    if not isinstance(subject, Order):
        return None
    from kilter.analysis.planning.order.explained import explain
    from kilter.show.page import render_plan

    asked.tell("page")
    name = title or title_of(subject.states.assembly.source or "an assembly")
    return Report(render_plan(subject, explain(subject), name, command=command), subject.verdict)


def _page(
    assembly: Any,
    asked: Question,
    places: Places | None,
    title: str,
    command: str,
    **options: Any,
) -> Report:
    """Build the page of an assembly; `options` are those of `everything`."""
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
    answers = everything(asked.but(assembly=assembly), **options)
    asked.tell("page")
    name = title or title_of(assembly.source or "an assembly")
    html = render(answers, name, command=command, places=places)
    return Report(html, str(answers.given.check["verdict"]))
