"""A forwarded port and a reverse proxy in front of the workbench, as SSH and a notebook have them.

`Forwarding` copies each byte, as ``ssh -L`` does. With a prefix it is a reverse proxy: it serves
the workbench below this path and removes the path, as jupyter-server-proxy does for
``/user/x/proxy/PORT/``. With `host` it also replaces the Host header, as nginx and the tunnels of
hosted editors do. WebSockets pass through.
"""

import asyncio
import contextlib
import re
import threading
from typing import Self

NOT_FOUND = b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"


class Forwarding:
    """A port of this machine whose connections go to another port.

    Parameters
    ----------
    port : int
        The port of the workbench.
    prefix : str
        Path below which the workbench is served, such as ``/user/x/proxy/8899``.
    host : str
        Value that replaces the Host header; by default the header stays.
    """

    def __init__(self, port: int, *, prefix: str = "", host: str = "") -> None:
        self.target, self.prefix, self.host = port, prefix, host
        self.paths: list[str] = []
        """Paths of the requests, before the prefix is removed."""
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        started = asyncio.start_server(self._accept, "127.0.0.1", 0)
        self._server = asyncio.run_coroutine_threadsafe(started, self._loop).result()
        self.port = int(self._server.sockets[0].getsockname()[1])
        return self

    def __exit__(self, *details: object) -> None:
        asyncio.run_coroutine_threadsafe(self._end(), self._loop).result()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def url(self, address: str, host: str = "127.0.0.1") -> str:
        """The address of the workbench, seen through this port."""
        return address.replace(f"127.0.0.1:{self.target}/", f"{host}:{self.port}{self.prefix}/")

    async def _end(self) -> None:
        self._server.close()
        others = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)

    async def _accept(self, incoming: asyncio.StreamReader, back: asyncio.StreamWriter) -> None:
        with contextlib.suppress(OSError, asyncio.IncompleteReadError):
            head = b""
            if self.prefix or self.host:
                head = self._changed(await incoming.readuntil(b"\r\n\r\n"))
            if head == NOT_FOUND:
                back.write(NOT_FOUND)
            else:
                there, onward = await asyncio.open_connection("127.0.0.1", self.target)
                onward.write(head)
                await asyncio.gather(_copy(incoming, onward), _copy(there, back))
        back.close()

    def _changed(self, head: bytes) -> bytes:
        """The head of a request as the workbench gets it; a connection has a single request."""
        method, path, version = head.decode("latin-1").split("\r\n", 1)[0].split(" ")
        self.paths.append(path)
        rest = path.removeprefix(self.prefix)
        if not path.startswith(self.prefix) or rest[:1] not in ("/", "?"):
            return NOT_FOUND
        lines = head.decode("latin-1").split("\r\n")[1:-2]
        if self.host:
            lines = [re.sub(r"(?i)^host:.*", f"Host: {self.host}", line) for line in lines]
        if not any(re.match(r"(?i)upgrade:", line) for line in lines):
            lines = [line for line in lines if not re.match(r"(?i)connection:", line)]
            lines.append("Connection: close")
        first = f"{method} {rest if rest[0] == '/' else '/' + rest} {version}"
        return "\r\n".join([first, *lines, "", ""]).encode("latin-1")


async def _copy(source: asyncio.StreamReader, target: asyncio.StreamWriter) -> None:
    """Copy bytes until the source ends, then end the target."""
    try:
        while piece := await source.read(1 << 16):
            target.write(piece)
            await target.drain()
    finally:
        target.close()
