"""The program `kilter` and its commands."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from kilter.cli.batches import batch
from kilter.cli.directions import margin, orient, region
from kilter.cli.holding import hold
from kilter.cli.judging import check, contacts, example, verify
from kilter.cli.pages import draw, report, view
from kilter.cli.planning import plan

__all__ = ["command"]

JUDGING = (check, orient, region, margin, plan, hold)
COMMANDS = (*JUDGING, report, view, draw, contacts, verify, batch, example)

app = typer.Typer(
    name="kilter",
    help="Does an assembly of rigid parts stay together under gravity? An exact verdict, with a "
    "proof. All answers are of first order: where motions that cost no energy to first order "
    "are left (see 'neutral'), second order decides, a ball on a ball among them.",
    add_completion=False,
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def command() -> Any:
    """The command with its subcommands."""
    return typer.main.get_command(app)


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
        typer.Option("--version", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Options of kilter itself; without a command, the help is shown."""
    if context.invoked_subcommand is None:
        print(context.get_help())


for _one in COMMANDS:
    app.command()(_one)
