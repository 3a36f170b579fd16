"""Names of the commands, and the functions that they call."""

from __future__ import annotations

from collections.abc import Callable

from kilter.cli.overview import GROUPS

__all__ = ["COMMANDS", "Command", "functions_of"]

Command = Callable[..., int]
"""Function of a command: the values of its options become an exit code."""
COMMANDS = tuple(name for group in GROUPS.values() for name in group)
"""Names of all commands, in the order of the help text."""


def functions_of(name: str | None) -> list[Command]:
    """The function of a command, or the functions of all commands in the order of the help text.

    Only the modules that contain them are imported.

    Parameters
    ----------
    name : str, optional
        One of `COMMANDS`; all commands if it is missing.
    """
    loaders = LOADERS if name is None else [load for load in LOADERS if name in LOADERS[load]]
    functions = {each.__name__.replace("_", "-"): each for load in loaders for each in load()}
    return [functions[each] for each in (COMMANDS if name is None else (name,))]


def _judging() -> tuple[Command, ...]:
    from kilter.cli.judging import check, contacts, example, verify

    return check, contacts, example, verify


def _directions() -> tuple[Command, ...]:
    from kilter.cli.directions import margin, orient, region

    return margin, orient, region


def _pages() -> tuple[Command, ...]:
    from kilter.cli.pages import draw, report, view

    return draw, report, view


def _plans() -> tuple[Command, ...]:
    from kilter.cli.holding import hold
    from kilter.cli.improving import improve
    from kilter.cli.packing_plans import check_plan
    from kilter.cli.placing import place
    from kilter.cli.planning import plan
    from kilter.cli.resting import settle

    return hold, improve, plan, place, check_plan, settle


def _others() -> tuple[Command, ...]:
    from kilter.cli.batches import batch
    from kilter.cli.doctoring import doctor
    from kilter.cli.saving import save
    from kilter.cli.scene_states import scene
    from kilter.cli.serving_agents import mcp
    from kilter.cli.transporting import transport

    return batch, doctor, mcp, save, scene, transport


LOADERS: dict[Callable[[], tuple[Command, ...]], tuple[str, ...]] = {
    _judging: ("check", "contacts", "example", "verify"),
    _directions: ("margin", "orient", "region"),
    _pages: ("draw", "report", "view"),
    _plans: ("hold", "improve", "plan", "place", "check-plan", "settle"),
    _others: ("batch", "doctor", "mcp", "save", "scene", "transport"),
}
"""Functions that import the commands of these names."""
