"""Sockets of the workbench: the address on which it listens, and the end of silent connections.

The server listens on the loopback address. In a container, the browser is outside of it, and the
server has to listen on all addresses: ``--host 0.0.0.0``.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Sequence
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from kilter.errors import InputError

__all__ = ["EVERY_ADDRESS", "LOOPBACK", "PromptProtocol", "listen"]

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
