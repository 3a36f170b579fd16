"""Damaged messages to the servers: pages of the workbench, and tools for agents.

The workbench serves in this process for all cases. Each case connects a page, sends some messages,
and then a valid message, whose answer shows that the server still lives.
"""

import json
import os
from contextlib import suppress
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
from fuzz_corpus import corpus
from fuzz_mutations import damaged

Random = np.random.Generator
Outcome = tuple[str, list[str]]
MESSAGES: tuple[dict[str, Any], ...] = (
    {"do": "hold", "parts": ["cube-1"], "on": True},
    {"do": "leave_out", "parts": ["cube-2"], "on": True},
    {"do": "floor", "value": True},
    {"do": "friction", "value": 0.4},
    {"do": "join", "pairs": [["cube-1", "cube-2"]], "on": True},
    {"do": "open", "file": "tower.kilter.json"},
    {"do": "open", "example": "arch"},
    {"do": "save", "file": "saved.json"},
    {"do": "undo"},
    {"do": "redo"},
    {"do": "revert", "index": 0},
    {"do": "go", "index": 1},
    {"do": "compare", "a": 0, "b": 1},
    {"do": "ask", "tab": "margin", "options": {}},
    {"do": "settle"},
    {"do": "stop"},
)
"""Messages of a page, without their number."""
MOST_MESSAGES = 6
"""Largest number of damaged messages of a case."""
TOO_LARGE = 1009
"""Code with which a connection is closed after a message of more than a megabyte."""
PATIENCE = 20.0
"""Time in which a message is answered [s]."""
CALLS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("check", {"file": "tower.kilter.json", "friction": 0.3, "down": [0, 0.1, -1]}),
    ("contacts", {"file": "tower.kilter.json", "ground": ["base"], "floor": True}),
    ("margin", {"file": "tower.kilter.json", "without": ["cube-2"]}),
    ("hold", {"file": "slope.kilter.json", "most": 2, "require": "equilibrium"}),
    ("plan", {"file": "tower.kilter.json", "fasten": [["cube-1", "cube-2"]]}),
    ("settle", {"file": "tower.kilter.json", "reach": 0.1, "nearest": True, "keep": ["cube-1"]}),
    ("place", {"file": "tower.kilter.json", "box": [1, 1, 1], "mass": 2, "at": [0, 0], "turn": 5}),
    ("transport", {"file": "tower.kilter.json", "accelerate": [1, 0, 0]}),
    ("scene", {"file": "tower.kilter.json", "settle": True, "output": "new.kilter.json"}),
    ("draw", {"file": "tower.kilter.json", "what": "assembly", "view": [30, 20]}),
    ("example", {"name": "arch"}),
)
"""Calls of tools, with arguments of all types."""


def faults_of_messages(rng: Random) -> Outcome:
    """Every message gets an answer, and a valid message afterwards is answered as usual."""
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    address = _workbench().url.replace("http://", "ws://").replace("/?", "/live?")
    answered, found = 0, []
    with connect(address, max_size=None) as link:
        texts = [_damaged_message(rng) for _ in range(int(rng.integers(1, MOST_MESSAGES + 1)))]
        try:
            for text in texts:
                link.send(text)
            link.send('{"id": "last", "do": "stop"}')
            while answered < len(texts) + 1:
                message = json.loads(link.recv(PATIENCE))
                if "re" in message:
                    answered += 1
                    found += _wrong_reply(message)
        except (TimeoutError, ConnectionClosed) as error:
            if getattr(getattr(error, "rcvd", None), "code", None) == TOO_LARGE:
                return "too large a message", found
            found.append(f"no answer ({type(error).__name__}) after {[t[:200] for t in texts]}")
    return f"{answered} answers", found


def _wrong_reply(message: dict[str, Any]) -> list[str]:
    """The fault of a reply: a fault of the program itself instead of a sentence."""
    error = str(message.get("error", ""))
    return [f"a reply is {error[:200]}"] if "fault" in error or "Traceback" in error else []


def _damaged_message(rng: Random) -> str:
    """A message of a page with damage, as text."""
    message = {"id": int(rng.integers(100)), **MESSAGES[int(rng.integers(len(MESSAGES)))]}
    content = json.dumps(message).encode()
    return damaged("message.json", content, rng).decode("utf-8", "replace")


@cache
def _workbench() -> Any:
    """A workbench with an open file, which serves until the process ends."""
    from kilter.workbench.server import Workbench

    folder = Path(mkdtemp(prefix="fuzz-"))
    path = folder / "tower.kilter.json"
    path.write_bytes(corpus()["tower.kilter.json"])
    bench = Workbench(path)
    bench.__enter__()
    return bench


def faults_of_call(rng: Random, number: int, folder: Path) -> Outcome:
    """A call is answered, or refused with a sentence; nothing is raised."""
    from kilter.agents.tool_calls import ToolCalls

    for name in ("tower.kilter.json", "slope.kilter.json"):
        (folder / name).write_bytes(corpus()[name])
    tool, arguments = CALLS[number % len(CALLS)]
    content = damaged("call.json", json.dumps(arguments).encode(), rng)
    with suppress(ValueError, RecursionError):
        arguments = json.loads(content)
    if not isinstance(arguments, dict):
        arguments = {"file": arguments}
    before = set(os.listdir(folder))
    done = ToolCalls(folder).call(tool, arguments)
    left = set(os.listdir(folder)) - before
    for name in left:
        (folder / name).unlink()
    found = [f"a file is left: {left}"] if done.failed and left else []
    if "\n" in done.text.strip() and done.failed:
        found.append(f"an error of several lines: {done.text[:200]!r}")
    if "fault of kilter" in done.text or "Traceback" in done.text:
        found.append(done.text[:300])
    return f"{tool}: {'refused' if done.failed else 'answered'}", found
