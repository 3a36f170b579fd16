"""The program `kilter` and its commands."""

from __future__ import annotations

import inspect
from typing import Annotated, Any

import typer

from kilter.cli.batches import batch
from kilter.cli.directions import margin, orient, region
from kilter.cli.doctoring import doctor
from kilter.cli.holding import hold
from kilter.cli.improving import improve
from kilter.cli.judging import check, contacts, example, verify
from kilter.cli.pages import draw, report, view
from kilter.cli.planning import plan
from kilter.cli.saving import save
from kilter.cli.transporting import transport

__all__ = ["command"]

JUDGING = (check, orient, region, margin, transport, plan, hold)
COMMANDS = (*JUDGING, improve, report, view, draw, contacts, verify, batch, save, example, doctor)


def _untyped(params: list[Any]) -> list[Any]:
    """Hide the type in the help of flags and arguments: no `<bool>` after a flag."""
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


app = typer.Typer(
    name="kilter",
    cls=_Group,
    help="Does an assembly of rigid parts stay together under gravity? kilter gives an exact "
    "verdict with a proof. Answers are of first order. If motions without any first-order change "
    "of energy remain (see 'neutral'), 'check' also decides them to second order "
    "('second_order'): a ball on top of a ball is balanced.",
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def command() -> Any:
    """Return the program with all its commands and their help texts."""
    program = typer.main.get_command(app)
    for entry in (program, *getattr(program, "commands", {}).values()):
        entry.help = _help_text(entry.help)
        for option in entry.params:
            option.help = _help_text(getattr(option, "help", None))
    return program


def _help_text(text: str | None) -> str | None:
    """Return a help text whose brackets are no markup and whose paragraphs are single lines."""
    paragraphs = inspect.cleandoc(text or "").split("\n\n")
    joined = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
    return joined.replace("[", "\\[") or None


def _version(wanted: bool) -> None:
    if wanted:
        import kilter

        print(f"kilter {kilter.__version__}")
        raise typer.Exit


@app.callback()
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


for _function in COMMANDS:
    app.command(cls=_Command)(_function)
