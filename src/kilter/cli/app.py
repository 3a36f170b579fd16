"""The program `kilter` with its commands, built with the library of options."""

from __future__ import annotations

import inspect
from functools import wraps
from typing import Annotated, Any, get_args

import typer

from kilter.cli.commands import COMMANDS, Command, functions_of
from kilter.cli.declarations import Declaration
from kilter.cli.overview import PURPOSE, overview

__all__ = ["command"]


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
    for function in functions_of(name if name in COMMANDS else None):
        app.command(cls=_Command)(_with_typer_options(function))
    program = typer.main.get_command(app)
    for described in (program, *getattr(program, "commands", {}).values()):
        described.help = _help_text(described.help)
        for option in described.params:
            option.help = _help_text(getattr(option, "help", None))
    return program


def _with_typer_options(function: Command) -> Command:
    """The function of a command with a signature of typer's options in place of declarations."""
    signature = inspect.signature(function, eval_str=True)
    parameters = [_with_typer_option(parameter) for parameter in signature.parameters.values()]

    @wraps(function)
    def same(**values: Any) -> int:
        return function(**values)

    # typer reads the signature and the annotations
    same.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    same.__annotations__ = {entry.name: entry.annotation for entry in parameters}
    return same


def _with_typer_option(parameter: inspect.Parameter) -> inspect.Parameter:
    """The parameter with the option or argument of typer that its declaration describes."""
    kind, declared = get_args(parameter.annotation)
    assert isinstance(declared, Declaration)
    option = getattr(typer, declared.kind)(*declared.names, **declared.settings)
    return parameter.replace(annotation=Annotated[kind, option])


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
