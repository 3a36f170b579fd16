"""HTTP server for a single page on this machine only; the page polls its version to reload."""

from __future__ import annotations

import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType

from kilter.errors import InputError

__all__ = ["PageServer"]

LOOPBACK = "127.0.0.1"
NAMES = (LOOPBACK, "localhost")
"""Host names that a request may use. Other names are refused, so that a foreign web page cannot
read this page through a host name of its own (DNS rebinding)."""

HTTP = 80
"""Default port of HTTP; browsers omit it from the Host header."""
POLL = 0.05
"""Interval at which the server looks for its end [s]; a larger value delays the end."""


class PageServer:
    """Server of a single page, for this machine only, in a separate thread.

    Parameters
    ----------
    page : str
        HTML of the page.
    port : int
        Port to listen on; 0 selects a free port.

    Raises
    ------
    InputError
        If the port is not available.
    """

    def __init__(self, page: str, port: int = 0) -> None:
        self._lock = threading.Lock()
        self._page = page.encode("utf-8")
        self._version = 1
        try:
            self._server = ThreadingHTTPServer((LOOPBACK, port), _handler(self))
        except OSError as error:
            raise InputError(
                f"port {port} is not available ({error.strerror})", hint="give another --port"
            ) from None
        self._server.daemon_threads = True
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(POLL,), daemon=True
        )

    @property
    def port(self) -> int:
        """Port on which the page server listens."""
        return int(self._server.server_address[1])

    @property
    def url(self) -> str:
        """URL of the served page."""
        return f"http://{LOOPBACK}:{self.port}/"

    @property
    def hosts(self) -> list[list[str]]:
        """Accepted values of the Host headers of a request, as lists of headers."""
        hosts = [[f"{name}:{self.port}"] for name in NAMES]
        return hosts + [[name] for name in NAMES] if self.port == HTTP else hosts

    def publish(self, page: str) -> None:
        """Replace the served page and increase its version."""
        with self._lock:
            self._page = page.encode("utf-8")
            self._version += 1

    def now(self) -> tuple[bytes, int]:
        """The served page and its version."""
        with self._lock:
            return self._page, self._version

    def __enter__(self) -> PageServer:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._server.shutdown()
        self._server.server_close()


def _handler(server: PageServer) -> type[BaseHTTPRequestHandler]:
    """Create the request handler class for a server; it answers GET / and GET /version only."""

    class Handler(BaseHTTPRequestHandler):
        """Request handler that answers GET / and GET /version only."""

        server_version = "kilter"
        sys_version = ""
        timeout = 30

        def do_GET(self) -> None:
            """Answer a request, but first refuse a request with a foreign host name."""
            page, version = server.now()
            if self.headers.get_all("Host") not in server.hosts:
                self._reply(
                    HTTPStatus.FORBIDDEN,
                    b"this page is served to this machine only\n",
                    "text/plain",
                )
            elif self.path == "/":
                self._reply(HTTPStatus.OK, page, "text/html; charset=utf-8")
            elif self.path == "/version":
                self._reply(HTTPStatus.OK, str(version).encode(), "text/plain")
            else:
                self._reply(HTTPStatus.NOT_FOUND, b"not found: the only page is /\n", "text/plain")

        def _reply(self, status: HTTPStatus, body: bytes, kind: str) -> None:
            """Send a response that no other origin may read and no cache may keep."""
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.send_header("X-Content-Type-Options", "nosniff")
            self.send_header("Content-Security-Policy", "frame-ancestors 'none'")
            self.send_header("Cross-Origin-Resource-Policy", "same-origin")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            """Suppress the log line that would be printed for each request."""

    return Handler
