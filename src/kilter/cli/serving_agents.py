"""The command `mcp`: a server of tools for agents."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from kilter.cli.declarations import Argument
from kilter.cli.exit_codes import WRITTEN

__all__ = ["mcp"]


def mcp(
    folder: Annotated[
        Path,
        Argument(
            metavar="[FOLDER]",
            help="Start folder: only files below it are opened. By default the present folder.",
            show_default=False,
        ),
    ] = Path(),
) -> int:
    """Serve the questions of kilter as tools for agents, on standard input and output.

    The server speaks the Model Context Protocol (extra 'mcp'). Its tools are check, contacts,
    margin, hold, plan, settle, place, transport, scene, draw and example. Each answer has at most
    4 kB and names the resource that has the whole answer.

    Exit code: 0 when standard input ends.
    """
    from kilter.agents.mcp_server import serve

    serve(folder)
    return WRITTEN
