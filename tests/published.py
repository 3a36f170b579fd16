"""Every answer that a test makes, judged by its published schema."""

import functools
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib import import_module
from typing import Any
from unittest import mock

import fastjsonschema

from kilter.files import schema

WRITERS = {
    "batch": "kilter.analysis.many.batch.Batch",
    "check": "kilter.analysis.verdict.verdict.Verdict",
    "check-plan": "kilter.analysis.placing.check_plan.CheckedPlan",
    "contacts": "kilter.contact.contact_set.ContactSet",
    "hold": "kilter.analysis.planning.hold.fixture.Fixture",
    "margin": "kilter.analysis.margins.margin_answer.Margin",
    "orient": "kilter.analysis.turning.orientation.Orientation",
    "place": "kilter.analysis.placing.place.Places",
    "plan": "kilter.analysis.planning.order.order.Order",
    "region": "kilter.analysis.regions.region.Region",
    "scene": "kilter.analysis.scene_states.scene_report.SceneReport",
    "settle": "kilter.analysis.settled_pose.settle.Settled",
    "settle-states": "kilter.analysis.many.settle_states.SettledStates",
    "transport": "kilter.analysis.transport.transport_answer.Transport",
    "verify": "kilter.analysis.verification.Verification",
    "why": "kilter.analysis.engine_contacts.judged.Judged",
}
"""Class of each answer, whose method `to_dict` writes the data."""


@functools.cache
def validator(verb: str) -> Callable[[Any], Any]:
    """The compiled schema of an answer; it raises an error for data that do not match."""
    judge: Callable[[Any], Any] = fastjsonschema.compile(schema(verb))
    return judge


@contextmanager
def judged_answers() -> Iterator[None]:
    """Validate the data of each `to_dict` of an answer while the context lasts."""
    with ExitStack() as stack:
        for verb, place in WRITERS.items():
            module, _, name = place.rpartition(".")
            writer = getattr(import_module(module), name)
            judged = _judged(verb, writer.to_dict)
            stack.enter_context(mock.patch.object(writer, "to_dict", judged))
        yield


def _judged(verb: str, write: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A method `to_dict` whose data are validated."""

    @functools.wraps(write)
    def to_dict(answer: Any) -> Any:
        data = write(answer)
        validator(verb)(data)
        return data

    return to_dict
