"""A page served to this machine alone, and its version, so that the page can ask for news."""

from __future__ import annotations

import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType

from kilter.errors import InputError

__all__ = ["PageServer"]

LOOPBACK = "127.0.0.1"
NAMES = (LOOPBACK, "localhost")
"""Names that a browser on this machine may call it by; any other is refused, so that a page
from elsewhere cannot read this one under a name of its own (DNS rebinding)."""

HTTP = 80
"""The port that a browser leaves out."""


class PageServer:
    """Serves one page on the loopback interface, in a thread of its own.

    Parameters
    ----------
    page : str
    port : int
        0: any that is free.

    Raises
    ------
    InputError
        If the port is taken.
    """

    def __init__(self, page: str, port: int = 0) -> None:
        self._lock = threading.Lock()
        self._page = page.encode("utf-8")
        self._version = 1
        try:
            self._server = ThreadingHTTPServer((LOOPBACK, port), _handler(self))
        except OSError as error:
            raise InputError(
                f"port {port} cannot be had ({error.strerror})", hint="give another --port"
            ) from None
        self._server.daemon_threads = True
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)

    @property
    def port(self) -> int:
        """The port that it listens on."""
        return int(self._server.server_address[1])

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://{LOOPBACK}:{self.port}/"

    @property
    def hosts(self) -> list[list[str]]:
        """What the headers of a request may call it, which a browser says with the port."""
        hosts = [[f"{name}:{self.port}"] for name in NAMES]
        return hosts + [[name] for name in NAMES] if self.port == HTTP else hosts

    def publish(self, page: str) -> None:
        """Serve another page from now on."""
        with self._lock:
            self._page = page.encode("utf-8")
            self._version += 1

    def now(self) -> tuple[bytes, int]:
        """The page and its version."""
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
    class Handler(BaseHTTPRequestHandler):
        """Answers GET / and GET /version."""

        server_version = "kilter"
        sys_version = ""
        timeout = 30

        def do_GET(self) -> None:
            page, version = server.now()
            if self.headers.get_all("Host") not in server.hosts:
                self._reply(HTTPStatus.FORBIDDEN, b"only for this machine\n", "text/plain")
            elif self.path == "/":
                self._reply(HTTPStatus.OK, page, "text/html; charset=utf-8")
            elif self.path == "/version":
                self._reply(HTTPStatus.OK, str(version).encode(), "text/plain")
            else:
                self._reply(HTTPStatus.NOT_FOUND, b"there is only /\n", "text/plain")

        def _reply(self, status: HTTPStatus, body: bytes, kind: str) -> None:
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
            """Nothing is printed here."""

    return Handler
