"""The command `mcp`: a server of tools for agents."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from kilter.cli.exit_codes import WRITTEN
from kilter.cli.options import takes
from kilter.values.declaration import argument

__all__ = ["mcp"]


@dataclass(frozen=True, kw_only=True)
class McpOptions:
    """Options of `mcp`."""

    folder: Path = argument(
        "[FOLDER]",
        "Start folder: only files below it are opened. By default the present folder.",
        default=Path(),
    )


@takes
def mcp(options: McpOptions) -> int:
    """Serve the questions of kilter as tools for agents, on standard input and output.

    The server speaks the Model Context Protocol (extra 'mcp'). Its tools are check, contacts,
    margin, hold, plan, settle, place, transport, scene, draw and example. Each answer has at most
    4 kB and names the resource that has the whole answer.

    Exit code: 0 when standard input ends.
    """
    from kilter.agents.mcp_server import serve

    serve(options.folder)
    return WRITTEN
