"""Sockets of the workbench: the address on which it listens, and the end of silent connections.

The server listens on the loopback address. In a container, the browser is outside of it, and the
server has to listen on all addresses: ``--host 0.0.0.0``.
"""

from __future__ import annotations

import asyncio
import json
import math
import re
import socket
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from uvicorn.protocols.http.h11_impl import H11Protocol

from kilter.errors import InputError

LOOPBACK = "127.0.0.1"
EVERY_ADDRESS = ("0.0.0.0", "::", "[::]")
"""Words for all addresses of a machine, in place of a host name."""
PATIENCE = 10.0
"""Time in which a connection must send a whole request, before it is closed [s]."""


class PromptProtocol(H11Protocol):
    """HTTP connection that is closed if no request arrives in time, also if its bytes drip.

    uvicorn itself limits only the time between two requests, and any byte ends this limit.
    """

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for the first request."""
        super().connection_made(transport)
        self._seen: Any = None
        self._clock = self.loop.call_later(PATIENCE, self._look)

    def _look(self) -> None:
        """Close the connection if it has waited for the same request since the last look."""
        waits = self.cycle is None or self.cycle.response_complete
        if waits and self._seen is self.cycle:
            self.transport.close()
            return
        self._seen = self.cycle if waits else None
        self._clock = self.loop.call_later(PATIENCE, self._look)

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Pass the connection on: a page that only listens stays connected."""
        self._clock.cancel()
        super().handle_websocket_upgrade(event)

    def connection_lost(self, exc: Exception | None) -> None:
        """End the wait."""
        self._clock.cancel()
        super().connection_lost(exc)


def listen(port: int, hosts: Sequence[str]) -> socket.socket:
    """A listening socket on the loopback address, or on all if `hosts` has such a word.

    Raises `InputError` if the port is not available.
    """
    every = [name for name in hosts if name in EVERY_ADDRESS]
    family = socket.AF_INET6 if every and ":" in every[0] else socket.AF_INET
    address = every[0].strip("[]") if every else LOOPBACK
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        if family is socket.AF_INET6:  # addresses of both versions
            listening.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 0)
        listening.bind((address, port))
        listening.listen()
    except OSError as error:
        listening.close()
        raise InputError(
            f"port {port} is not available ({error.strerror})", hint="give another --port"
        ) from None
    return listening


# Messages of a page: parse them strictly, so that each gets an answer and none harms the others.


MOST = 10**9
"""All indices are below this number."""
DEEPEST = 20
"""Deepest nesting of lists and objects in a message."""
NUMBER = re.compile(r'\s*\{\s*"id"\s*:\s*([0-9]{1,9})\s*[,}]')
"""Beginning of a message of the page, with its number."""


def parse_message(text: str) -> dict[str, Any]:
    """The JSON object of a message.

    Raises `InputError` if the text is no JSON object, is nested too deeply, has a lone surrogate,
    or a number that is not finite.

    Examples
    --------
    >>> parse_message('{"id": 1, "do": "undo"}')
    {'id': 1, 'do': 'undo'}
    >>> parse_message('{"do": "go", "index": Infinity}')
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the message has the number Infinity; reload the page
    """
    try:
        message = json.loads(
            text, parse_float=_finite, parse_int=_short_integer, parse_constant=_no_number
        )
    except InputError:
        raise
    except RecursionError:
        raise _wrong("is nested too deeply") from None
    except ValueError as error:
        raise _wrong(f"is no JSON: {error}") from None
    if not isinstance(message, dict):
        raise _wrong("is no JSON object")
    _validate(message)
    return message


def message_id(text: str) -> int | None:
    """The number of a message that cannot be parsed, as the page writes it; None without one."""
    found = NUMBER.match(text)
    return int(found[1]) if found else None


def index_of(message: Mapping[str, Any], key: str) -> int:
    """An index in a message, which is a whole number from 0 to `MOST`.

    Raises `InputError` if it is missing, or something else.
    """
    value = message.get(key)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < MOST:
        raise InputError(f"{key} is {value!r:.40}", hint="give a whole number, 0 or more")
    return value


def direction_of(message: Mapping[str, Any], key: str) -> list[float]:
    """A direction in a message, three numbers that are not all 0.

    Raises `InputError` if it is missing, or something else.
    """
    value = message.get(key)
    if isinstance(value, list) and len(value) == 3 and all(map(_is_number, value)):
        down = [float(x) for x in value]
        if math.hypot(*down) > 0:
            return down
    raise InputError(f"{key} is {value!r:.60}", hint="give three numbers, not all 0")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def to_json(message: Mapping[str, Any]) -> str:
    """JSON text that every page can read: ASCII, and null for a number that is not finite."""
    try:
        return json.dumps(message, separators=(",", ":"), allow_nan=False)
    except ValueError:
        return json.dumps(_only_finite(message), separators=(",", ":"))


def _only_finite(value: Any) -> Any:
    """JSON data with None for each number that is not finite."""
    if isinstance(value, Mapping):
        return {key: _only_finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_only_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _validate(message: dict[str, Any]) -> None:
    """Raise `InputError` for deep nesting and for texts with a lone surrogate."""
    layer: list[Any] = [message]
    for _ in range(DEEPEST):
        below: list[Any] = []
        for value in layer:
            if isinstance(value, dict):
                below += [*value.keys(), *value.values()]
            elif isinstance(value, list):
                below += value
            elif isinstance(value, str) and not value.isascii():
                _require_encodable(value)
        layer = below
        if not layer:
            return
    raise _wrong("is nested too deeply")


def _require_encodable(text: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise _wrong("has an invalid character (a lone surrogate)") from None


def _finite(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        _no_number(digits)
    return value


def _short_integer(digits: str) -> int:
    _finite(digits)
    return int(digits)


def _no_number(digits: str) -> NoReturn:
    raise _wrong(f"has the number {digits:.30}")


def _wrong(words: str) -> InputError:
    return InputError(f"the message {words}"[:160], hint="reload the page")
