"""`kilter.animate`: a plan or a motion as a film."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError
from kilter.validate import LARGEST
from kilter.values.guesses import guarded

if TYPE_CHECKING:
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.support_movement import SupportMovement
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly.question import Question
    from kilter.second_order.answer.path_places import PathPlaces


# Names of pages, figures and films: their endings, and the titles of pages.


PAGES = (".html", ".htm")
"""File endings of pages; no input file has them, so a typing error cannot overwrite an input."""
FILMS = (".glb",)
"""Endings of films."""


def require_ending(out: str | Path, endings: tuple[str, ...], what: str, also: str = "") -> None:
    """Reject an output name with a wrong ending, so that no input file is overwritten."""
    if Path(out).suffix.lower() not in endings:
        hint = f"use a name that ends in {', '.join(endings)}{also}"
        raise InputError(f"not a file name for a {what}", file=str(out), hint=hint)


def require_film(what: str, view: tuple[float, float] | None) -> None:
    """Reject options that do not apply to a film, before any computation."""
    if what not in ("assembly", "movement"):
        raise InputError(
            f"a {what} has no motion", hint="write a figure: out.svg, out.png or out.pdf"
        )
    if view is not None:
        raise InputError("a film has no view", hint="leave the view out; its viewer turns the film")


def require_movement(
    what: str, moved: Mapping[str, Any] | None, turned: Mapping[str, Any] | None
) -> None:
    """Reject a figure of a movement without a moved support, and moved supports without it."""
    if (what == "movement") != bool(moved or turned):
        raise InputError(
            "the figure of a movement and moved supports belong together",
            hint="give both: what='movement', moved={'NAME': (x, y, z)}",
            option="give both: --what movement --move NAME=DX,DY,DZ",
        )


def require_figure(out: str | Path | None, view: tuple[float, float] | None) -> None:
    """Reject a file ending or a view that cannot be drawn, before any computation."""
    from kilter.show.canvas import SUFFIXES, require

    if out is not None:
        require_ending(out, SUFFIXES, "figure", f", or in {', '.join(FILMS)} for a film")
    # not `isfinite`: it fails for an integer of hundreds of digits
    if view is not None and not all(abs(angle) < LARGEST for angle in view):
        raise InputError(
            f"the view is {view[0]!s:.20} {view[1]!s:.20}",
            hint="give two angles in degrees",
            option="give two angles in degrees: --view -32 22",
        )
    require()


def title_of(source: str) -> str:
    """Name of a file without its folders and endings, as a title."""
    if source == "-":
        return "standard input"
    return Path(source).resolve().name.removesuffix(".json").removesuffix(".kilter")


# Subjects of pages, figures and films: an assembly with changes, or an answer as it is.


def is_drawn_answer(subject: Any) -> bool:
    """Whether a figure shows this answer as it is."""
    from kilter.analysis.margins.margin_answer import Margin
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict

    return isinstance(subject, Verdict | Region | Order | Settled | Transport | Places | Margin)


def changed_subject(subject: Any, asked: Question) -> Any:
    """Return an assembly with the changes of the keywords; an answer rejects changes."""
    if not is_drawn_answer(subject):
        return asked.read(subject)
    asked.require_unchanged(subject)
    return subject


def path_of(verdict: Verdict) -> PathPlaces | None:
    """Path along which a balanced assembly falls; None for any other verdict."""
    from kilter.second_order.answer.path_places import find_path_places

    second = verdict.second_order_answer
    return None if second is None else find_path_places(verdict.assembly, second)


def require_steps(order: Order) -> None:
    """Raise `InputError` if a plan has no steps to show."""
    if not order.found:
        raise InputError("no order was found: there are no steps to show")
    if not order.steps:
        raise InputError("every part is held: there are no steps to show")


@guarded
def animate(
    subject: Order | Region | Verdict | Transport,
    out: str | Path | None = None,
    *,
    moved: Mapping[str, Any] | None = None,
    turned: Mapping[str, Any] | None = None,
) -> bytes:
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
    moved, turned : mapping, optional
        Movements of supports, as in `Verdict.support_movement`: the film of a verdict shows the
        movement that follows, magnified. The name of its animation states the factor.

    Raises
    ------
    InputError
        If no order was found, no part is known to move, more than 3,000 parts move, or the file
        cannot be written.

    See Also
    --------
    kilter.draw : a picture of the motion.
    kilter.report : a page that plays the steps.

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
        film = (
            _film_of_movement(subject, moved or {}, turned or {})
            if moved or turned
            else _film_of(subject)
        )
    elif isinstance(subject, Transport):
        film = _film_of_mechanism(subject)
    else:
        from kilter.show.plan_scene import film_of_plan

        if not isinstance(subject, Order):
            raise InputError(
                f"a {type(subject).__name__.lower()} has no motion",
                hint="animate the answer of kilter.check or kilter.plan",
            )
        require_steps(subject)
        film = film_of_plan(subject.states.assembly, subject.to_dict())
    if out is not None:
        from kilter.files import write_bytes

        write_bytes(Path(out), film)
    return film


def _film_of(verdict: Verdict) -> bytes:
    """GLB film of the impending motion, or of the fall of a balanced assembly."""
    from kilter.analysis.verdict.free_travel import free_travel
    from kilter.show.glb_film import film_of_fall, film_of_motion

    path = path_of(verdict)
    if path is not None:
        return film_of_fall(verdict.assembly, path.motions, path.lengths)
    return film_of_motion(verdict.assembly, free_travel(verdict))


def known_movement(
    verdict: Verdict, moved: Mapping[str, Any], turned: Mapping[str, Any]
) -> SupportMovement:
    """The movement of parts after a movement of supports; an error if no movement is known."""
    found = verdict.support_movement(moved, turned)
    if not found.moves:
        raise InputError(f"there is no movement to show: {found.sentence}")
    return found


def _film_of_movement(
    verdict: Verdict, moved: Mapping[str, Any], turned: Mapping[str, Any]
) -> bytes:
    """GLB film of the magnified movement of the parts after a movement of supports."""
    from kilter.show.glb_film import film_of_movement
    from kilter.show.movement_scene import movement_factor
    from kilter.tell.numbers import number

    motion = known_movement(verdict, moved, turned).motion
    factor = movement_factor(verdict.assembly, motion)
    return film_of_movement(verdict.assembly, factor * motion, f"movement x {number(factor)}")


def _film_of_mechanism(answer: Transport) -> bytes:
    """GLB film of the motion that starts first on an accelerated carrier, seen from the carrier."""
    from kilter.analysis.load_limit import starting
    from kilter.analysis.verdict.free_travel import travel_along
    from kilter.show.glb_film import film_of_motion

    mechanism = answer.mechanism
    if mechanism is None:
        raise InputError(
            "no part is known to move, so there is no motion to show",
            hint="ask for accelerations that are not carried",
        )
    moving = set(starting(answer.program, mechanism))
    screws = mechanism.motion * [[float(name in moving)] for name in answer.program.names]
    return film_of_motion(answer.assembly, travel_along(answer.assembly, screws))
