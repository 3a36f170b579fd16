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

__all__ = ["command"]

JUDGING = (check, orient, region, margin, plan, hold)
COMMANDS = (*JUDGING, improve, report, view, draw, contacts, verify, batch, example, doctor)


def _untyped(params: list[Any]) -> list[Any]:
    """Options as a help lists them: no `<bool>` after a flag, no `<str>` after FILE."""
    for one in params:
        if one.param_type_name == "argument" or getattr(one, "is_flag", False):
            one.display_type_rich = lambda ctx: None
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
    help="Does an assembly of rigid parts stay together under gravity? An exact verdict, with a "
    "proof. Answers are of first order; where motions that cost no energy to first order are "
    "left (see 'neutral'), check says what second order makes of them ('second_order'): a ball "
    "on a ball is balanced.",
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def command() -> Any:
    """The command with its subcommands."""
    made = typer.main.get_command(app)
    for one in (made, *getattr(made, "commands", {}).values()):
        one.help = _as_written(one.help)
        for option in one.params:
            option.help = _as_written(getattr(option, "help", None))
    return made


def _as_written(text: str | None) -> str | None:
    """A text of a help: brackets are no markup, and lines end where the terminal does."""
    paragraphs = inspect.cleandoc(text or "").split("\n\n")
    joined = "\n\n".join(" ".join(one.split()) for one in paragraphs)
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
        typer.Option("-V", "--version", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Options of kilter itself; without a command, the help is shown."""
    if context.invoked_subcommand is None:
        print(context.get_help())


for _one in COMMANDS:
    app.command(cls=_Command)(_one)
