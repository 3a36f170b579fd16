"""HTTP and WebSocket server of the workbench, for this machine.

The server listens on the loopback address, or on all addresses for a container. Each request needs
the token of the session and a host name of this machine, with any port, or a name that the user
allows, for a proxy. If the browser sends an origin, it must be that of this host, or have an
allowed name: some proxies replace the host by the loopback address. So no foreign web page can use
the workbench. All addresses of the page are relative, so a proxy may serve it below any path.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import secrets
import sys
import tempfile
import threading
from collections.abc import AsyncIterator, Callable, Sequence
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from kilter.assembly import Assembly
from kilter.errors import InputError, short_name
from kilter.files.writing import dump
from kilter.scenes.registry import scene
from kilter.show.page import workbench_page
from kilter.show.thumbnail import thumbnail
from kilter.tell.guide_pages import as_text, title, topics
from kilter.values.guesses import guarded
from kilter.workbench.connections import (
    EVERY_ADDRESS,
    LOOPBACK,
    PromptProtocol,
    listen,
    message_id,
    parse_message,
    to_json,
)
from kilter.workbench.jobs import FAULT
from kilter.workbench.session import FEATURED, Session
from kilter.workbench.uploads import receive_upload

LOCAL = ("127.0.0.1", "localhost", "[::1]")
"""Host names of this machine; the port may differ, for a port that SSH forwards."""
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}
READ = ("tutorials", "guides")
"""Kinds of pages of the documentation that the help lists."""
WAITING = 64
"""Messages that wait for a slow page; with more, the page is disconnected and connects again."""


class _Guard:
    """Decides which requests are answered: token, host name and origin."""

    def __init__(self, token: str, hosts: Sequence[str]) -> None:
        hosts = [name for name in hosts if name not in EVERY_ADDRESS]
        for name in hosts:
            if not name or _name_of(name) != name:
                raise InputError(
                    f"the host {name!r:.80} is no name of a host",
                    hint="give the name alone, for example hub.example.org",
                )
        self.token = token
        self.named = frozenset(name.lower() for name in hosts)

    def refusal(self, connection: HTTPConnection) -> str:
        """Reason for which a request is refused; empty if it is answered."""
        host = connection.headers.get("host", "").lower()
        name = _name_of(host)
        if len(connection.headers.getlist("host")) != 1 or not name:
            return "the request names no single host"
        if name in EVERY_ADDRESS:
            return f"{name} is no address of a page: use the address that 'kilter view' printed"
        if name not in LOCAL and name not in self.named:
            return (
                f"this page is served to this machine only; if a proxy serves it as {name}, "
                f"start 'kilter view' with --host {name}"
            )
        origin = connection.headers.get("origin")
        if origin is not None and not self._is_own(origin.lower(), host):
            return "requests from other pages are refused"
        given = connection.query_params.get("token", "")
        if not secrets.compare_digest(given.encode(), self.token.encode()):
            return "the address has no valid token: use the address that 'kilter view' printed"
        return ""

    def _is_own(self, origin: str, host: str) -> bool:
        """Whether an origin is the page at this host, or at a name that the user allows."""
        found = re.fullmatch(r"https?://(.+)", origin)
        return found is not None and (found[1] == host or _name_of(found[1]) in self.named)


def _name_of(host: str) -> str:
    """Host name of a Host header, without its port; empty if the header is no name and port."""
    found = re.fullmatch(r"(\[[0-9A-Fa-f:]+\]|[A-Za-z0-9._-]+)(:[0-9]{1,5})?", host)
    return found[1] if found else ""


async def _guide(request: Request) -> Response:
    """A page of the documentation as text."""
    pages, topic = topics(), request.path_params["topic"]
    if topic not in pages:
        raise InputError(f"there is no page {topic!r:.40}")
    return PlainTextResponse(as_text(pages[topic].read_text(encoding="utf-8")))


async def _picture(request: Request) -> Response:
    """The picture of an example on the start page."""
    name = request.path_params["name"]
    if name not in FEATURED:
        raise InputError(f"there is no picture of {name!r:.40}")
    return Response(thumbnail(scene(name)), media_type="image/svg+xml")


def build_app(session_of: Callable[[], Session], token: str, hosts: Sequence[str]) -> Starlette:
    """The ASGI application of a session."""
    guard = _Guard(token, hosts)
    guides = [[topic, title(path)] for topic, path in topics().items() if path.parent.name in READ]

    def guarded(answer: Callable[[Request], Any]) -> Callable[[Request], Any]:
        async def endpoint(request: Request) -> Response:
            refusal = guard.refusal(request)
            if refusal:
                return PlainTextResponse(refusal + "\n", 403, headers=HEADERS)
            try:
                response: Response = await answer(request)
            except InputError as error:
                response = JSONResponse(_words(error), 409)
            except Exception as error:
                response = JSONResponse({"error": _fault_words(error), "hint": ""}, 500)
            response.headers.update(HEADERS)
            return response

        return endpoint

    async def page(request: Request) -> Response:
        return HTMLResponse(
            workbench_page(token, guides),
            headers={"Content-Security-Policy": "frame-ancestors 'self'"},
        )

    async def upload(request: Request) -> Response:
        return JSONResponse({"file": await receive_upload(request, session_of().uploads)})

    async def export(request: Request) -> Response:
        made = await session_of().export(request.path_params["kind"])
        name = made["name"]
        return Response(
            made["data"],
            media_type="application/octet-stream",
            headers={"Content-Disposition": f'attachment; filename="{name}"'},
        )

    async def live(socket: WebSocket) -> None:
        if guard.refusal(socket):
            await socket.close(4403)
            return
        await socket.accept()
        await _talk(session_of(), socket)

    return Starlette(
        routes=[
            Route("/", guarded(page)),
            Route("/upload", guarded(upload), methods=["POST"]),
            Route("/export/{kind}", guarded(export)),
            Route("/picture/{name}", guarded(_picture)),
            Route("/guide/{topic}", guarded(_guide)),
            WebSocketRoute("/live", live),
        ]
    )


async def _talk(session: Session, socket: WebSocket) -> None:
    """Pass messages between a page and the session until the page leaves."""
    outgoing: asyncio.Queue[str | None] = asyncio.Queue(WAITING)

    def send(text: str) -> None:
        try:
            outgoing.put_nowait(text)
        except asyncio.QueueFull:
            session.leave(send)
            with contextlib.suppress(asyncio.QueueEmpty):
                while True:
                    outgoing.get_nowait()
            outgoing.put_nowait(None)

    async def write() -> None:
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):  # the page has left
            while (text := await outgoing.get()) is not None:
                await socket.send_text(text)
            await socket.close(1013)

    writer = asyncio.create_task(write())
    session.join(send)
    tasks: set[asyncio.Task[None]] = set()
    try:
        while True:
            text = await _receive_text(socket)
            task = asyncio.create_task(_reply(session, text, send))
            tasks.add(task)
            task.add_done_callback(tasks.discard)
    except WebSocketDisconnect:
        pass
    finally:
        session.leave(send)
        writer.cancel()


async def _receive_text(socket: WebSocket) -> str:
    """The next text message; empty for a binary message, which is no request."""
    message = await socket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message.get("code", 1005), message.get("reason"))
    return message.get("text") or ""


async def _reply(session: Session, text: str, send: Callable[[str], None]) -> None:
    """Handle a message of a page, and answer it, whatever it is."""
    number: Any = message_id(text)
    try:
        message = parse_message(text)
        number = message.get("id")
        reply = {"re": number, "ok": True, **await session.handle(message)}
    except InputError as error:
        reply = {"re": number, "ok": False, **_words(error)}
    except Exception as error:
        reply = {"re": number, "ok": False, "error": _fault_words(error), "hint": ""}
    send(to_json(reply))


def _words(error: InputError) -> dict[str, str]:
    """The sentence of an error with the name of its file, and the remedy."""
    name = short_name(Path(error.file).name) if error.file else None
    sentence = str(InputError(error.what, file=name, part=error.part))
    return {"error": sentence, "hint": error.hint or ""}


def _fault_words(error: Exception) -> str:
    """Sentence about an exception that nothing expected."""
    return f"{FAULT}: {type(error).__name__}: {error}"[:300]


class Workbench:
    """A workbench with its server: `run` serves until an interruption, `with` serves in a thread.

    Arguments: `path`: the file to open; None: the start page; `hosts`: further host names, for a
    proxy; 0.0.0.0 or :: listens on all addresses of this machine. Raises `InputError` if the port
    is not available, or a host name is invalid.
    """

    def __init__(
        self,
        path: Path | None,
        *,
        first: dict[str, Any] | None = None,
        folder: Path | None = None,
        port: int = 0,
        hosts: Sequence[str] = (),
        say: Callable[[str], None] = lambda line: None,
    ) -> None:
        self.token = secrets.token_urlsafe(16)
        self._path, self._first, self._say = path, first or {}, say
        self._folder = folder or folder_of(path)
        self.session: Session | None = None
        app = build_app(lambda: _present(self.session), self.token, hosts)
        self._listening = listen(port, hosts)
        self._hosts = hosts
        app.router.lifespan_context = self._life
        self._server = uvicorn.Server(
            uvicorn.Config(
                app,
                log_level="critical",
                access_log=False,
                lifespan="on",
                http=PromptProtocol,
                ws="websockets-sansio",
                ws_max_size=MOST_MESSAGE,
                timeout_graceful_shutdown=1,
            )
        )
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._started = threading.Event()

    @property
    def port(self) -> int:
        """Port on which the server listens."""
        return int(self._listening.getsockname()[1])

    @property
    def url(self) -> str:
        """Address of the page, with the token."""
        return f"http://{LOOPBACK}:{self.port}/?token={self.token}"

    def run(self, ready: Callable[[], None] = lambda: None) -> None:
        """Serve until an interruption; `ready` is called when the server answers."""
        with contextlib.suppress(KeyboardInterrupt), self:
            ready()
            if any(name in EVERY_ADDRESS for name in self._hosts):
                self._say(EXPOSED)
            while self._thread.is_alive():
                self._thread.join(STARTS)

    def __enter__(self) -> Workbench:
        # in a thread, since the server would replace the handlers of signals in the main thread
        self._thread.start()
        self._started.wait(STARTS)
        return self

    def __exit__(self, *details: object) -> None:
        self._server.should_exit = True
        self._thread.join(STARTS)
        self._listening.close()

    def _serve(self) -> None:
        self._server.run(sockets=[self._listening])

    @contextlib.asynccontextmanager
    async def _life(self, app: Starlette) -> AsyncIterator[None]:
        """Life of the session: from the start of the server to its end."""
        with tempfile.TemporaryDirectory(prefix="kilter-") as uploads:
            session = self.session = Session(self._folder, Path(uploads))
            opening = None
            if self._path is not None:
                opening = asyncio.create_task(self._open(session, self._path))
            self._started.set()
            try:
                yield
            finally:
                if opening is not None:
                    opening.cancel()
                await session.end()

    async def _open(self, session: Session, path: Path) -> None:
        """Open the first file; a failure is shown by the page and in the terminal."""
        try:
            await session.open(path, **self._first)
        except InputError as error:
            session.tell(str(error))
            self._say(str(error))


def folder_of(path: Path | None) -> Path:
    """The folder that contains a file, or a link to it; without a file, the working folder."""
    if path is None:
        return Path.cwd()
    if path.name in ("", ".."):  # "." and ".." are in the folder above their own
        return Path(os.path.realpath(path)).parent
    return Path(os.path.realpath(path.parent))


EXPOSED = (
    "warning: other computers can reach this page. Everybody with its address and token can read "
    "the files of the opened folder, and the connection is not encrypted."
)
"""Sentence about a server that listens on all addresses."""
STARTS = 20.0
"""Time in which the server starts or ends [s]."""


def _present(session: Session | None) -> Session:
    """The session, which exists while the server answers."""
    assert session is not None
    return session


MOST_MESSAGE = 1 << 20
"""Largest message of a page [bytes]."""


# `kilter.view`: open the workbench in the browser.


@guarded
def view(
    source: Assembly | str | Path | None = None,
    *,
    port: int = 0,
    browser: bool = True,
    hosts: Sequence[str] = (),
    folder: str | Path | None = None,
    keys: dict[str, Any] | None = None,
    down: Sequence[float] | None = None,
    say: Callable[[str], None] | None = None,
) -> None:
    """Open the workbench: the page on which an assembly is held, joined, loaded and judged.

    The page is served to this machine only. The function returns after an interruption (Ctrl-C).
    Only files of the opened folder can be opened, and named by these files.

    Parameters
    ----------
    source : Assembly or path, optional
        Assembly, or a file; without it, the page begins with a list of files and examples.
    port : int
        Port of the server; 0 selects a free port.
    browser : bool
        Open the page in a browser.
    hosts : sequence of str
        Further host names under which a proxy serves the page; pages of these names are trusted.
        "0.0.0.0" or "::" also listens on all addresses of this machine, for a container.
    folder : path, optional
        The opened folder; that of `source` by default.
    keys : dict, optional
        First choices about the file, as JSON data.
    down : sequence of 3 float, optional
        Direction of gravity in these choices.
    say : callable, optional
        Function that is called with each line for the user; the first is the address.

    Raises
    ------
    InputError
        If the port is not available, the file or the folder does not exist, the file is a link that
        leads out of the opened folder, a host name is invalid, or the function is called in a cell
        of a notebook, which it would block.

    See Also
    --------
    kilter.report : a page as a file, without a server.
    kilter.draw : a picture as a file.
    """
    if in_notebook():
        raise InputError(
            "view serves a page until it is interrupted, so it would block the cell",
            hint="use assembly.show() in a notebook, or 'kilter view FILE' in a terminal",
        )
    # imported late: the server libraries take longer to import than kilter

    tell = say or (lambda line: None)
    opened = None if folder is None else Path(folder)
    if opened is not None and not opened.is_dir():
        raise InputError("no such folder", file=str(opened), hint="check the path")
    with tempfile.TemporaryDirectory(prefix="kilter-") as temporary:
        path = _path_of(source, Path(temporary))
        if path is not None:
            _require_inside(path, opened or folder_of(path))
        first = {"keys": keys, "down": down}
        bench = Workbench(path, first=first, folder=opened, port=port, hosts=hosts, say=tell)

        def ready() -> None:
            tell(bench.url)
            if browser:
                import webbrowser

                webbrowser.open(bench.url)

        bench.run(ready)


def in_notebook() -> bool:
    """Whether this code runs in a cell of a notebook: IPython runs, and with a kernel."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return hasattr(shell, "kernel")


def _require_inside(path: Path, folder: Path) -> None:
    """Raise `InputError` if a file is not below the opened folder, after links are followed."""
    place = Path(os.path.realpath(path))
    if not place.is_relative_to(os.path.realpath(folder)):
        raise InputError(
            f"leads out of the opened folder, to {str(place)!r}",
            file=str(path),
            hint="open the file there, or give the folder above both with --folder",
        )


def _path_of(source: Any, folder: Path) -> Path | None:
    """Path of the file to open; an assembly is written to a temporary folder first."""
    if source is None:
        return None
    if isinstance(source, Assembly):
        path = folder / f"{Path(source.source or 'assembly').stem or 'assembly'}.kilter.json"
        dump(source, path)
        return path
    path = Path(os.fspath(source))
    if not path.exists():
        raise InputError("no such file", file=str(path), hint="check the path")
    return path
