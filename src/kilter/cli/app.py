"""The program `kilter` and its commands."""

from __future__ import annotations

import inspect
from collections.abc import Callable
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

GROUPS: dict[str, dict[Callable[..., int], str]] = {
    "ask": {
        check: "does it stay together, and which parts move if not?",
        contacts: "which parts touch, and which nearly touch?",
        orient: "in which orientation does it stay with the widest margin?",
        region: "in which directions of gravity does it stay?",
        margin: "how far may it tilt, how little friction does it need?",
        transport: "how hard may it be accelerated?",
    },
    "plan": {
        plan: "in which order can it be put together?",
        hold: "which supports are the fewest that hold it?",
        improve: "which toy brick makes it stand?",
    },
    "show": {
        report: "write an offline page in 3D with all answers",
        view: "show the page in the browser, updated with the file",
        draw: "write a figure or a film",
    },
    "files": {
        save: "save the options about a file for all later commands",
        verify: "recompute a proof without any solver",
        batch: "check many files, and write a table",
        example: "list the built-in examples, or write one of them",
        doctor: "test this installation",
    },
}
"""Commands by group, each with its summary in a few words."""
JUDGING = (check, orient, region, margin, transport, plan, hold)
COMMANDS = tuple(entry for group in GROUPS.values() for entry in group)
PURPOSE = "Does an assembly of rigid parts stay together under gravity? With a proof."


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


def overview() -> str:
    """Help text of the program: its purpose, and its commands in groups."""
    lines = [PURPOSE, ""]
    for group, entries in GROUPS.items():
        for k, (entry, summary) in enumerate(entries.items()):
            lines.append(f"{'' if k else group:7}{entry.__name__:10}{summary}")
    return (
        "\n".join(
            [
                *lines,
                "",
                "options: kilter COMMAND --help; kilter --version, kilter --install-completion",
            ]
        )
        + "\n"
    )


app = typer.Typer(
    name="kilter",
    cls=_Group,
    help=PURPOSE,
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def command() -> Any:
    """Create the program with all its commands and their help texts."""
    program = typer.main.get_command(app)
    for entry in (program, *getattr(program, "commands", {}).values()):
        entry.help = _help_text(entry.help)
        for option in entry.params:
            option.help = _help_text(getattr(option, "help", None))
    return program


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
