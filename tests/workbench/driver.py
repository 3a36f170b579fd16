"""A page of the workbench without a browser: it talks to the server through the WebSocket."""

import json
import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

from websockets.sync.client import connect

from kilter.workbench.server import Workbench

Message = dict[str, Any]
PATIENCE = 60.0


class Page:
    """A connected page, with the last message of each kind."""

    def __init__(self, bench: Workbench | str) -> None:
        address = bench if isinstance(bench, str) else bench.url
        url = address.replace("http://", "ws://").replace("/?", "/live?")
        self._open = ExitStack()
        self._link = self._open.enter_context(connect(url, max_size=None))
        self._number = 0
        self.last: dict[str, Message] = {}

    def hear(self, wanted: Callable[[Message], bool]) -> Message:
        """The next message that is wanted; all messages before it are taken in."""
        end = time.monotonic() + PATIENCE
        while True:
            message: Message = json.loads(self._link.recv(max(end - time.monotonic(), 0.01)))
            self.last[message.get("is", "reply")] = message
            if wanted(message):
                return message

    def say(self, **request: Any) -> Message:
        """Send a request and wait for the reply."""
        self._number += 1
        number = self._number
        self._link.send(json.dumps({"id": number, **request}))
        return self.hear(lambda message: message.get("re") == number)

    def answer(self) -> Message:
        """The complete answer, or the problem, of the present state."""
        state = self.last["session"]["state"]

        def ends(message: Message) -> bool:
            complete = message.get("is") == "answer" and message["phase"] == "complete"
            return message.get("state") == state and (complete or message.get("is") == "problem")

        return self.hear(ends)

    def after(self, **action: Any) -> Message:
        """Do an action, and wait for the complete answer."""
        reply = self.say(**action)
        assert reply["ok"], reply
        return self.answer()

    def opened(self) -> Message:
        """Wait until a file is open and answered."""
        self.hear(lambda message: message.get("is") == "session" and bool(message["file"]))
        return self.answer()

    def close(self) -> None:
        """End the connection."""
        self._open.close()
