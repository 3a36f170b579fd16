"""`kilter.animate`: a plan or a motion as a film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kilter.errors import InputError
from kilter.publish.output_files import FILMS, require_ending
from kilter.publish.subjects import path_of, require_steps
from kilter.values.guesses import guarded

if TYPE_CHECKING:
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict

__all__ = ["animate"]


@guarded
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
        require_steps(subject)
        film = film_of_plan(subject.states.assembly, subject.to_dict())
    if out is not None:
        from kilter.files import write_bytes

        write_bytes(Path(out), film)
    return film


def _film_of(verdict: Verdict) -> bytes:
    """GLB film of the impending motion, or of the fall of a balanced assembly."""
    from kilter.analysis.verdict.free_travel import free_travel
    from kilter.show.motion_film import film_of_fall, film_of_motion

    path = path_of(verdict)
    if path is not None:
        return film_of_fall(verdict.assembly, path.motions, path.lengths)
    return film_of_motion(verdict.assembly, free_travel(verdict))


def _film_of_mechanism(answer: Transport) -> bytes:
    """GLB film of the motion that starts first on an accelerated carrier, seen from the carrier."""
    from kilter.analysis.load_limit import starting
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
