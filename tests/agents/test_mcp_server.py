"""The server for agents, called by the client of the official library over stdio; its page."""

import json
import re
import subprocess
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter.agents.short_answers import LIMIT
from kilter.agents.tool_calls import ToolCalls
from kilter.agents.tool_schemas import TOOLS
from kilter.cli import main

DOCS = Path(__file__).resolve().parents[2] / "docs"


def with_client(folder: Path, act: Callable[[Any], Awaitable[None]]) -> None:
    """Start `kilter mcp` for a folder, and let `act` use a client that is connected to it."""
    anyio = pytest.importorskip("anyio")
    client = pytest.importorskip(
        "mcp.client.client", reason="mcp is not installed: pip install 'kilter[mcp]'"
    )
    from mcp.client.stdio import StdioServerParameters, stdio_client

    server = StdioServerParameters(
        command=sys.executable, args=["-m", "kilter", "mcp", str(folder)]
    )

    async def run() -> None:
        async with client.Client(stdio_client(server)) as connected:
            await act(connected)

    anyio.run(run)


@pytest.mark.slow
def test_a_client_lists_and_calls_the_tools_over_stdio(tmp_path):
    kilter.dump(kilter.example("paper-figure-8"), tmp_path / "f.kilter.json")

    async def act(client: Any) -> None:
        listed = await client.list_tools()
        assert [tool.name for tool in listed.tools] == [tool.name for tool in TOOLS]
        assert all(tool.input_schema["type"] == "object" for tool in listed.tools)
        direct = ToolCalls(tmp_path)
        for name in ("check", "scene", "contacts"):
            done = await client.call_tool(name, {"file": "f.kilter.json"})
            assert not done.is_error
            [content] = done.content
            assert content.text == direct.call(name, {"file": "f.kilter.json"}).text
            assert len(content.text.encode()) <= LIMIT
        resource = json.loads(content.text)["complete"]
        whole = await client.read_resource(resource)
        same = json.loads(direct.answers[resource])
        assert json.loads(whole.contents[0].text).keys() == same.keys()
        assert resource in [str(entry.uri) for entry in (await client.list_resources()).resources]

    with_client(tmp_path, act)


@pytest.mark.slow
def test_errors_and_pictures_over_stdio(tmp_path):
    kilter.dump(kilter.example("paper-figure-8"), tmp_path / "f.kilter.json")

    async def act(client: Any) -> None:
        from mcp.shared.exceptions import MCPError

        refused = await client.call_tool("check", {"file": "../f.kilter.json"})
        assert refused.is_error
        assert "outside of the start folder" in refused.content[0].text
        unknown = await client.call_tool("chek", {})
        assert unknown.is_error
        with pytest.raises(MCPError, match="there is no answer"):
            await client.read_resource("kilter://answers/check-0")
        picture = await client.call_tool("draw", {"file": "f.kilter.json"})
        assert [entry.type for entry in picture.content] == ["text", "image"]
        again = await client.call_tool("check", {"file": "f.kilter.json"})
        assert not again.is_error  # the server lives on after errors

    with_client(tmp_path, act)


@pytest.mark.slow
def test_the_server_ends_with_its_input(tmp_path):
    pytest.importorskip("mcp", reason="mcp is not installed: pip install 'kilter[mcp]'")
    command = [sys.executable, "-m", "kilter", "mcp", str(tmp_path)]
    done = subprocess.run(
        command, input="", capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.slow
def test_a_missing_folder_and_a_missing_extra_are_one_sentence(tmp_path, capsys):
    code = (
        "import sys; sys.modules['mcp'] = None; sys.modules['mcp_types'] = None\n"
        "from kilter.cli import main\n"
        "sys.exit(main(['mcp']))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert 'pip install "kilter[mcp]"' in done.stderr
    pytest.importorskip("mcp", reason="mcp is not installed: pip install 'kilter[mcp]'")
    assert main(["mcp", str(tmp_path / "none")]) == 2
    assert "no such folder" in capsys.readouterr().err


# the page -------------------------------------------------------------------------------------


def dialogues() -> list[str]:
    text = (DOCS / "guides/agents.md").read_text(encoding="utf-8")
    return [block for block in re.findall(r"```text\n(.*?)```", text, re.S) if block[0] == ">"]


@pytest.mark.quick(1)
@pytest.mark.parametrize("number", range(2))
@pytest.mark.slow
def test_the_dialogues_of_the_page_are_real(number, tmp_path, monkeypatch):
    assert len(dialogues()) == 2
    monkeypatch.chdir(tmp_path)
    scene = (DOCS / "reference/scenes.md").read_text(encoding="utf-8")
    exec(scene.split("```python\n")[1].split("```")[0], {})
    calls = ToolCalls(tmp_path)
    for call, shown in re.findall(r"^> (.*)\n([^>]*)", dialogues()[number], re.M):
        words = re.fullmatch(r"(\w+) (\{.*\})", call)
        assert words is not None, call
        done = calls.call(words[1], json.loads(words[2]))
        assert not done.failed, done.text
        place = 0
        for piece in shown.strip().split(" ... "):
            found = done.text.find(piece.strip(), place)
            assert found >= 0, (piece, done.text)
            place = found + len(piece.strip())


def test_the_page_lists_every_tool():
    text = (DOCS / "guides/agents.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `(\w+)` \|", text, re.M) == [tool.name for tool in TOOLS]
