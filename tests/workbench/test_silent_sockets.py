"""Sockets of the workbench: silent and slow connections end, and the address that it listens on."""

from __future__ import annotations

import http.client
import socket
import sys
import time
import urllib.parse
from collections.abc import Iterator
from pathlib import Path

import pytest
from driver import Page

from kilter.errors import InputError
from kilter.workbench import connections, uploads
from kilter.workbench.connections import listen
from kilter.workbench.server import Workbench

SHORT = 0.2
"""Patience of the server in these tests [s]."""


@pytest.fixture
def impatient(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Workbench]:
    monkeypatch.setattr(connections, "PATIENCE", SHORT)
    monkeypatch.setattr(uploads, "PATIENCE", SHORT)
    with Workbench(None, folder=tmp_path) as bench:
        yield bench


def time_to_the_end(bench: Workbench, begin: bytes, drip: bytes = b"") -> float:
    """Time until the server closes a connection, which gets `drip` again and again [s]."""
    started = time.monotonic()
    with socket.create_connection(("127.0.0.1", bench.port), timeout=SHORT / 4) as link:
        link.sendall(begin)
        while time.monotonic() - started < 50 * SHORT:
            try:
                link.sendall(drip)
                if not link.recv(4096):
                    break
            except TimeoutError:
                continue
            except OSError:
                break
    return time.monotonic() - started


HEAD = b"GET /?token=no HTTP/1.1\r\nHost: localhost\r\n"


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("begin", "drip"),
    [(b"", b""), (b"GET /", b"x"), (HEAD, b"a: b\r\n"), (HEAD + b"\r\n", b"G")],
    ids=["silent", "slow line", "slow headers", "slow second request"],
)
def test_a_connection_without_a_request_is_closed(
    begin: bytes, drip: bytes, impatient: Workbench
) -> None:
    assert time_to_the_end(impatient, begin, drip) < 25 * SHORT


@pytest.mark.slow
@pytest.mark.parametrize("drip", [b"", b"x"])
def test_an_upload_that_does_not_advance_is_ended(drip: bytes, impatient: Workbench) -> None:
    query = urllib.parse.urlencode({"token": impatient.token, "name": "a.stl"})
    head = f"POST /upload?{query} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9999999\r\n\r\n"
    assert time_to_the_end(impatient, head.encode(), drip) < 25 * SHORT
    assert impatient.session is not None
    assert list(impatient.session.uploads.iterdir()) == []


@pytest.mark.slow
def test_a_page_that_only_listens_stays_connected(impatient: Workbench) -> None:
    page = Page(impatient)
    time.sleep(3 * SHORT)
    assert page.say(do="stop")["ok"]
    page.close()


def status(address: str, bench: Workbench, host: str) -> tuple[int, str]:
    """Status and text of the page at an address of this machine, with a Host header."""
    link = http.client.HTTPConnection(address, bench.port, timeout=20)
    link.request("GET", f"/?token={bench.token}", headers={"Host": host})
    answer = link.getresponse()
    found = answer.status, answer.read().decode()
    link.close()
    return found


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="127.0.0.2 is an address there")
@pytest.mark.parametrize("word", ["0.0.0.0", "::"])
def test_it_listens_on_all_addresses_only_if_asked(word: str, tmp_path: Path) -> None:
    with Workbench(None, folder=tmp_path) as bench, pytest.raises(ConnectionError):
        status("127.0.0.2", bench, "localhost")
    if ":" in word and not socket.has_ipv6:
        pytest.skip("no IPv6 here")
    try:
        bench = Workbench(None, folder=tmp_path, hosts=[word])
    except InputError:
        pytest.skip("no IPv6 here")
    with bench:
        port = bench.port
        assert bench.url.startswith(f"http://127.0.0.1:{port}/")
        # a forwarded port of a container keeps the name of the other machine
        assert status("127.0.0.2", bench, f"localhost:{port}")[0] == 200
        # the checks of host, origin and token stay
        code, words = status("127.0.0.2", bench, f"10.1.2.3:{port}")
        assert (code, "--host 10.1.2.3" in words) == (403, True)
        code, words = status("127.0.0.2", bench, f"[::]:{port}" if ":" in word else f"{word}:80")
        assert (code, "is no address of a page" in words) == (403, True)
        bench.token += "x"
        assert status("127.0.0.1", bench, "localhost")[0] == 403


def test_a_taken_port_is_a_sentence() -> None:
    with (
        listen(0, ()) as taken,
        pytest.raises(InputError, match="is not available"),
    ):
        listen(taken.getsockname()[1], ())
