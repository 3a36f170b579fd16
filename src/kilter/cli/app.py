"""The program `kilter` and its commands."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Any

import typer

from kilter.cli.overview import GROUPS, PURPOSE, overview

__all__ = ["COMMANDS", "command"]

Command = Callable[..., int]
"""Function of a command: the values of its options become an exit code."""
COMMANDS = tuple(name for group in GROUPS.values() for name in group)
"""Names of all commands, in the order of the help text."""


def _untyped(params: list[Any]) -> list[Any]:
    """Hide type names such as `<bool>` in the help of flags and arguments."""
    for param in params:
        if param.param_type_name == "argument" or getattr(param, "is_flag", False):
            param.display_type_rich = lambda ctx: None
    return params


class _Command(typer.core.TyperCommand):
    def get_params(self, ctx: Any) -> list[Any]:
        return _untyped(super().get_params(ctx))


class _Group(typer.core.TyperGroup):
    def get_params(self, ctx: Any) -> list[Any]:
        return _untyped(super().get_params(ctx))

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the commands in groups, on a screen of 80 x 24 characters."""
        formatter.write(overview())


def command(name: str | None = None) -> Any:
    """Create the program with its commands and their help texts.

    Parameters
    ----------
    name : str, optional
        Name of the only command to create, for a short start-up. All commands are created if it
        is missing or no command has this name.
    """
    app = typer.Typer(
        name="kilter",
        cls=_Group,
        help=PURPOSE,
        invoke_without_command=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(kilter_options)
    for function in _functions(name if name in COMMANDS else None):
        app.command(cls=_Command)(function)
    program = typer.main.get_command(app)
    for described in (program, *getattr(program, "commands", {}).values()):
        described.help = _help_text(described.help)
        for option in described.params:
            option.help = _help_text(getattr(option, "help", None))
    return program


def _functions(name: str | None) -> list[Command]:
    """The function of a command, or the functions of all commands in the order of the help text.

    Only the modules that contain them are imported.
    """
    loaders = LOADERS if name is None else [load for load in LOADERS if name in LOADERS[load]]
    functions = {each.__name__: each for load in loaders for each in load()}
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
    from kilter.cli.planning import plan

    return hold, improve, plan


def _others() -> tuple[Command, ...]:
    from kilter.cli.batches import batch
    from kilter.cli.doctoring import doctor
    from kilter.cli.saving import save
    from kilter.cli.transporting import transport

    return batch, doctor, save, transport


LOADERS: dict[Callable[[], tuple[Command, ...]], tuple[str, ...]] = {
    _judging: ("check", "contacts", "example", "verify"),
    _directions: ("margin", "orient", "region"),
    _pages: ("draw", "report", "view"),
    _plans: ("hold", "improve", "plan"),
    _others: ("batch", "doctor", "save", "transport"),
}
"""Functions that import the commands of these names."""


def _help_text(text: str | None) -> str | None:
    """Help text with brackets protected from markup, and each paragraph in a single line."""
    paragraphs = inspect.cleandoc(text or "").split("\n\n")
    joined = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
    return joined.replace("[", "\\[") or None


def _version(wanted: bool) -> None:
    if wanted:
        import kilter

        print(f"kilter {kilter.__version__}")
        raise typer.Exit


def kilter_options(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option(
            "-V", "--version", callback=_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Handle the options of the program. Without a command, print the help."""
    if context.invoked_subcommand is None:
        print(context.get_help())
