"""Subjects of pages, figures and films: an assembly with changes, or an answer as it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kilter.errors import InputError

if TYPE_CHECKING:
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly.question import Question
    from kilter.second_order.answer.path_places import PathPlaces

__all__ = ["changed_subject", "path_of", "require_steps"]


def changed_subject(subject: Any, asked: Question) -> Any:
    """Return an assembly with the changes of the keywords; an answer rejects changes."""
    from kilter.analysis.placing.place import Places
    from kilter.analysis.planning.order.order import Order
    from kilter.analysis.regions.region import Region
    from kilter.analysis.settled_pose.settle import Settled
    from kilter.analysis.transport.transport_answer import Transport
    from kilter.analysis.verdict.verdict import Verdict

    if not isinstance(subject, Verdict | Region | Order | Settled | Transport | Places):
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
