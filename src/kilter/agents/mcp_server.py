"""A server of the Model Context Protocol on standard input and output, by its official library.

Calls are answered in turn, in a thread of their own, so that the server responds to
other requests in the meantime. Whole answers are resources.

References
----------
Model Context Protocol, specification 2025-11-25: tools, resources, the transport stdio.
"""

from __future__ import annotations

import base64
from importlib.metadata import version
from pathlib import Path
from typing import Any

from kilter.agents.tool_calls import ToolCalls
from kilter.agents.tool_schemas import TOOLS, Tool
from kilter.errors import InputError

__all__ = ["build_server", "serve"]

INSTRUCTIONS = (
    "kilter decides by statics, with proofs, whether assemblies and scenes of rigid parts stay "
    "together under gravity. Files are paths below the start folder (kilter JSON, STEP, OBJ, STL, "
    "3MF, GLB, MJCF, URDF, USD, folders of meshes). Something must be held: ground, floor, or by "
    "the file. Begin with scene (simulator scenes) or check; its remedies were tried. An answer "
    "has at most 4 kB; the resource named by `complete` has the whole answer."
)
NOT_FOUND = -32002
"""Error code of the protocol for a resource that does not exist."""


def serve(folder: str | Path) -> None:
    """Serve the tools until standard input ends.

    Raises `InputError` if the library `mcp` is not installed, or the folder does not exist.
    """
    server = build_server(folder)
    import anyio
    from mcp.server.stdio import stdio_server

    async def run() -> None:
        async with stdio_server() as (reading, writing):
            await server.run(reading, writing, server.create_initialization_options())

    anyio.run(run)


def build_server(folder: str | Path) -> Any:
    """Build the server, of the type `mcp.server.lowlevel.Server`.

    Raises `InputError` as `serve`.
    """
    try:
        import anyio
        import mcp_types as types
        from mcp.server.lowlevel import Server
        from mcp.shared.exceptions import MCPError
    except ImportError:
        raise InputError(
            "the server for agents needs mcp 2, which is not installed",
            hint='pip install "kilter[mcp]"',
        ) from None
    calls = ToolCalls(folder)
    lock = anyio.Lock()

    async def list_tools(context: Any, request: Any) -> Any:
        return types.ListToolsResult(tools=[_described(tool, types) for tool in TOOLS])

    async def call_tool(context: Any, request: Any) -> Any:
        async with lock:
            done = await anyio.to_thread.run_sync(calls.call, request.name, request.arguments or {})
        content: list[Any] = [types.TextContent(text=_encodable(done.text))]
        if done.image is not None:
            data = base64.b64encode(done.image).decode()
            content.append(types.ImageContent(data=data, mime_type="image/png"))
        return types.CallToolResult(content=content, is_error=done.failed)

    async def list_resources(context: Any, request: Any) -> Any:
        resources = [
            types.Resource(uri=uri, name=uri.rpartition("/")[2], mime_type="application/json")
            for uri in calls.answers
        ]
        return types.ListResourcesResult(resources=resources)

    async def read_resource(context: Any, request: Any) -> Any:
        uri = str(request.uri)
        if uri not in calls.answers:
            raise MCPError(NOT_FOUND, f"there is no answer {uri}; ask again")
        text = types.TextResourceContents(
            uri=uri, mime_type="application/json", text=_encodable(calls.answers[uri])
        )
        return types.ReadResourceResult(contents=[text])

    return Server(
        "kilter",
        version=version("kilter"),
        instructions=INSTRUCTIONS,
        on_list_tools=list_tools,
        on_call_tool=call_tool,
        on_list_resources=list_resources,
        on_read_resource=read_resource,
    )


def _described(tool: Tool, types: Any) -> Any:
    """A tool as the protocol lists it."""
    return types.Tool(
        name=tool.name,
        description=tool.description,
        input_schema=tool.schema,
        annotations=types.ToolAnnotations(
            read_only_hint=tool.name not in ("example", "settle", "scene"),
            destructive_hint=False,
            open_world_hint=False,
        ),
    )


def _encodable(text: str) -> str:
    """A text with escapes for lone surrogates, which a name of a file may have."""
    return text.encode("utf-8", "backslashreplace").decode()
