"""Answers to the calls of tools: read the file, compute the answer, and shorten it.

All files are below the start folder. An error in the arguments or in a file is a single sentence.
"""

from __future__ import annotations

import base64
import io
import os
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from kilter.agents.short_answers import LIMIT, complete_text, resource_name, short_text
from kilter.agents.tool_schemas import READING, TOOLS, Tool, required_of, tool_named
from kilter.assembly import Assembly
from kilter.contact import contacts
from kilter.contact.fits.fastening import fastened
from kilter.errors import FAULT, NO_MEMORY, InputError, fault_words, nearest_name, visible
from kilter.files.limits import only_below, require_below
from kilter.files.usd.usd_assembly import write_usd_poses
from kilter.files.writing import to_text, write_text
from kilter.loading import load
from kilter.publish import draw
from kilter.scenes import SCENES
from kilter.scenes import scene as example_of

KEPT = 100
"""Number of whole answers that are kept as resources."""
TYPES: dict[str, tuple[type, ...]] = {
    "string": (str,), "boolean": (bool,), "integer": (int,), "number": (int, float),
    "array": (list,),
}  # fmt: skip
"""Types of Python for the types of a JSON schema."""
DOTS = 110
"""Resolution of pictures [dots per inch]."""


@dataclass(frozen=True, slots=True)
class Called:
    """Result of a call: the text of the answer or of the error, and a picture."""

    text: str
    image: bytes | None = None
    """PNG data."""
    failed: bool = False
    """Whether the text is an error."""


class ToolCalls:
    """The tools of a server with a start folder.

    - `answers`: texts of the latest whole answers, by the name of their resource.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(os.path.realpath(folder))
        if not self.folder.is_dir():
            raise InputError("no such folder", file=str(folder), hint="check the path")
        self.answers: OrderedDict[str, str] = OrderedDict()

    def call(self, name: str, arguments: Mapping[str, Any]) -> Called:
        """Answer a call. Every fault is a result with a single sentence, that of the command."""
        try:
            tool = tool_named(name)
            if tool is None:
                names = [entry.name for entry in TOOLS]
                near = nearest_name(name, names)
                hint = f"did you mean {near!r}?" if near else f"the tools are {', '.join(names)}"
                raise InputError(f"there is no tool {name!r:.40}", hint=hint)
            _validate(tool, arguments)
            with only_below(self.folder):
                return self._answer(tool, dict(arguments))
        except InputError as error:
            words = str(error)
        except MemoryError:
            words = NO_MEMORY
        except Exception as error:
            given = [name, *(str(arguments[key]) for key in ("file",) if key in arguments)]
            words = f"{fault_words(error, given)} (exit code {FAULT})"
        return Called(visible(self._relative(words)), failed=True)

    def _relative(self, text: str) -> str:
        """A text without the path of the start folder."""
        return text.replace(f"{self.folder}{os.sep}", "")

    def _answer(self, tool: Tool, arguments: dict[str, Any]) -> Called:
        """Answer a valid call."""
        if tool.name == "example":
            return self._example(arguments.get("name"))
        resource = resource_name(tool.name, arguments)
        file = str(arguments.get("file"))
        assembly = self._read({key: arguments.pop(key) for key in READING if key in arguments})
        if tool.name == "draw":
            return _draw(assembly, arguments)
        answer = self._asked(tool, file, assembly, arguments)
        text = self._relative(complete_text(answer))
        self.answers[resource] = text
        self.answers.move_to_end(resource)
        while len(self.answers) > KEPT:
            self.answers.popitem(last=False)
        return Called(self._relative(short_text(tool.name, answer, resource)))

    def _asked(
        self, tool: Tool, file: str, assembly: Assembly, arguments: dict[str, Any]
    ) -> Mapping[str, Any]:
        """Data of the answer to a question; a new pose is written to the file `output`."""
        output = arguments.pop("output", None)
        target = None if output is None else self._new_file(output)
        if tool.name not in ("scene", "settle"):
            return ASK[tool.name](assembly, arguments)
        answer = POSED[tool.name](assembly, arguments)
        if target is not None:
            drawn = answer.drawn
            if drawn is None or (tool.name == "settle" and answer.resting is None):
                why = "give settle: true" if drawn is None else "no pose at rest was found"
                raise InputError("nothing was written", file=output, hint=why)
            _write_pose(self.path_of(file), target, drawn, answer.assembly)
        data: Mapping[str, Any] = answer.to_dict()
        return data

    def _new_file(self, name: str) -> Path:
        """Path of a file that does not exist yet, with the ending of a format of poses."""
        path = self.path_of(name)
        if path.exists():
            raise InputError("already exists", file=name, hint="give another name")
        if not name.endswith((".kilter.json", ".xml", ".usda")):
            raise InputError(
                "is no format of a pose", file=name, hint="give X.kilter.json, X.xml or X.usda"
            )
        return path

    def path_of(self, name: str) -> Path:
        """Path of a file of the start folder.

        Raises `InputError` if the path leads out of the start folder.
        """
        path = self.folder / name
        if name in ("", "-"):
            raise InputError(f"the file is {name!r}", hint="give a path below the start folder")
        with only_below(self.folder):
            try:
                require_below(path)
                path.exists()
            except InputError as error:
                raise InputError(error.what, file=name, hint=error.hint) from None
            except OSError as error:  # a name that is too long
                raise InputError(
                    f"cannot be opened: {error.strerror}", file=name, hint="give another name"
                ) from None
        return path

    def _read(self, options: dict[str, Any]) -> Assembly:
        """Read the assembly of a call."""
        fasten = [tuple(pair) for pair in options.pop("fasten", ())]
        path = self.path_of(options.pop("file"))
        assembly = load(path, **options)
        return fastened(assembly, fasten) if fasten else assembly

    def _example(self, name: str | None) -> Called:
        """List the examples, or write an example into the start folder."""
        if name is None:
            lines = [f"{entry.name}: {entry.answer}; {entry.title}" for entry in SCENES.values()]
            return Called(_cut("\n".join(lines)))
        assembly = example_of(name)
        path = self.path_of(f"{name}.kilter.json")
        text = to_text(assembly)
        if path.exists() and path.read_text(encoding="utf-8") != text:
            raise InputError("already exists", file=path.name, hint="remove the file first")
        write_text(path, text)
        return Called(f"{path.name}: {SCENES[name].title}")


def _cut(text: str) -> str:
    """A text of whole lines within the limit of an answer."""
    lines, size = [], 0
    for line in text.splitlines():
        size += len(line.encode()) + 1
        if size > LIMIT - 40:
            lines.append("... (and more)")
            break
        lines.append(line)
    return "\n".join(lines)


def _validate(tool: Tool, arguments: Mapping[str, Any]) -> None:
    """Verify the names and types of arguments.

    Raises `InputError` if an argument is unknown, missing, or of another type.
    """
    known = tool.arguments
    for name, value in arguments.items():
        if name not in known:
            near = nearest_name(name, known)
            hint = f"did you mean {near!r}?" if near else f"there are {', '.join(known)}"
            raise InputError(f"{tool.name} has no argument {name!r:.40}", hint=hint)
        _require_type(name, value, known[name])
    for name in required_of(tool):
        if name not in arguments:
            raise InputError(f"{tool.name} needs the argument {name!r}", hint=f"give {name!r}")


def _require_type(name: str, value: Any, schema: Mapping[str, Any]) -> None:
    """Verify that a value has the type, length and words of a schema."""
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    right = any(
        isinstance(value, TYPES[kind]) and (kind == "boolean" or not isinstance(value, bool))
        for kind in kinds
    )
    words = schema.get("enum")
    size = (schema.get("minItems", 0), schema.get("maxItems", 10**6))
    if isinstance(value, list) and right:
        right = size[0] <= len(value) <= size[1]
        for entry in value if right else ():
            _require_type(name, entry, schema["items"])
    if not right or (words and value not in words):
        wanted = f"one of {', '.join(words)}" if words else " or ".join(kinds)
        if "minItems" in schema:
            wanted = f"a list of {schema['minItems']}"
        raise InputError(f"{name} is {value!r:.60}", hint=f"give {wanted}")


def _draw(assembly: Assembly, options: Mapping[str, Any]) -> Called:
    """A picture of an assembly as PNG."""
    view = tuple(options["view"]) if "view" in options else None
    figure = draw(assembly, what=options.get("what", "assembly"), view=view)
    data = io.BytesIO()
    # metadata would contain the version of the drawing program
    figure.savefig(data, format="png", dpi=DOTS, metadata={"Software": None})
    held = sum(part.grounded for part in assembly)
    return Called(f"picture of {len(assembly)} parts, {held} held", data.getvalue())


# questions ------------------------------------------------------------------------------------


def _check(assembly: Assembly, options: Mapping[str, Any]) -> Mapping[str, Any]:
    from kilter.analysis.check import check

    return check(assembly, **options).to_dict()


def _contacts(assembly: Assembly, options: Mapping[str, Any]) -> Mapping[str, Any]:
    return contacts(assembly, **options).to_dict()


def _margin(assembly: Assembly, options: Mapping[str, Any]) -> Mapping[str, Any]:
    from kilter.analysis.margins.margin import margin

    return margin(assembly, **options).to_dict()


def _hold(assembly: Assembly, options: Mapping[str, Any]) -> Mapping[str, Any]:
    from kilter.analysis.planning.hold.hold import hold

    return hold(assembly, **options).to_dict()


def _plan(assembly: Assembly, options: Mapping[str, Any]) -> Mapping[str, Any]:
    from kilter.analysis.planning.order.plan import plan

    return plan(assembly, **options).to_dict()


def _place(assembly: Assembly, options: Mapping[str, Any]) -> Mapping[str, Any]:
    from kilter.analysis.placing.place import box_to_place, place

    if "box" not in options or "mass" not in options:
        raise InputError("the box is not given", hint="give box [a, b, c] and mass in kg")
    part = box_to_place(options["box"], options["mass"], turn=options.get("turn", 0.0))
    at = tuple(options["at"]) if "at" in options else None
    return place(assembly, part, at=at).to_dict()


def _transport(assembly: Assembly, options: Mapping[str, Any]) -> Mapping[str, Any]:
    from kilter.analysis.transport.transport import transport

    return transport(assembly, **options).to_dict()


def _scene(assembly: Assembly, options: Mapping[str, Any]) -> Any:
    from kilter.analysis.scene_states.object_states import scene

    return scene(assembly, **options)


def _settle(assembly: Assembly, options: Mapping[str, Any]) -> Any:
    from kilter.analysis.settled_pose.settle import settle

    return settle(assembly, **options)


def _write_pose(source: Path, target: Path, drawn: Assembly, assembly: Assembly) -> None:
    """Write a new pose in the format that the ending of the file names."""
    if target.suffix == ".usda":
        write_usd_poses(source, target, drawn, assembly)
    else:
        write_text(target, assembly.to_mjcf() if target.suffix == ".xml" else to_text(assembly))


ASK: dict[str, Callable[[Assembly, Mapping[str, Any]], Mapping[str, Any]]] = {
    "check": _check,
    "contacts": _contacts,
    "margin": _margin,
    "hold": _hold,
    "plan": _plan,
    "place": _place,
    "transport": _transport,
}
"""Function that answers each question about an assembly."""
POSED: dict[str, Callable[[Assembly, Mapping[str, Any]], Any]] = {
    "scene": _scene,
    "settle": _settle,
}
"""Function that answers each question whose answer may have a new pose."""


# A server of the Model Context Protocol on standard input and output, by its official library.


INSTRUCTIONS = (
    "kilter decides by statics, with proofs, whether assemblies and scenes of rigid parts stay "
    "together under gravity. Files are paths below the start folder (kilter JSON, STEP, OBJ, STL, "
    "3MF, GLB, MJCF, URDF, USD, folders of meshes). Something must be held: ground, floor, or by "
    "the file. Begin with scene (simulator scenes) or check; its ladder decides drawings on each "
    "assumption. An answer has at most 4 kB; the resource named by `complete` has the whole answer."
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
