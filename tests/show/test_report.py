"""The commands report and view: output, rejected input, server and watched files."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import pytest

import kilter
from kilter import publish
from kilter.cli import main
from kilter.errors import InputError
from kilter.files.fingerprint import fingerprint
from kilter.scenes import scene
from kilter.scenes.stacks import tower as tower_of
from kilter.scenes.walls import wall_of
from kilter.show.serve import PageServer


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), "tower.kilter.json")
    return tmp_path


@pytest.mark.slow
def test_report_writes_one_page_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "tower.kilter.json", "-o", "out.html"]) == 0
    page = Path("out.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    assert page.rstrip().endswith("</html>")
    said = capsys.readouterr()
    assert said.out == ""
    assert "out.html: verdict stable" in said.err


@pytest.mark.slow
def test_report_exits_with_0_whatever_the_verdict_and_may_be_quiet(
    capsys: pytest.CaptureFixture[str],
) -> None:
    kilter.dump(scene("hanging-brick"), "h.json")
    assert main(["report", "h.json", "-o", "h.html", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.slow
def test_more_parts_than_a_browser_can_show_are_refused_before_anything_is_asked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tower = scene("tower")
    monkeypatch.setattr(publish, "MOST", len(tower))
    assert kilter.report(tower).verdict == "stable"
    monkeypatch.setattr(publish, "MOST", len(tower) - 1)
    with pytest.raises(InputError, match=r"a page of 6 parts .* up to 5; .* assembly\.without"):
        kilter.report(tower)
    assert main(["report", "tower.kilter.json", "-o", "out.html"]) == 2
    assert "--without NAME" in capsys.readouterr().err
    assert not Path("out.html").exists()


@pytest.mark.slow
def test_a_page_grows_by_a_kilobyte_a_part() -> None:
    walls = [wall_of(bricks) for bricks in (4000, 5000)]  # both above the row limit of tables
    small, large = (len(kilter.report(wall).html) for wall in walls)
    assert 200 < (large - small) / (len(walls[1]) - len(walls[0])) < 1024


@pytest.mark.slow
def test_the_command_on_the_page_makes_the_page_again() -> None:
    words = ["report", "tower.kilter.json", "--down", "0.1", "0", "-1", "--without", "cube-5"]
    words += ["--friction", "0.25", "--gap", "0.001", "-o", "a b.html", "--quiet"]
    assert main(words) == 0
    first = Path("a b.html").read_text(encoding="utf-8")
    import html
    import shlex

    found = re.search(r"<dt>command</dt><dd><code>(.*?)</code>", first)
    assert found is not None
    again = shlex.split(html.unescape(found[1]))
    assert again[0] == "kilter"
    Path("a b.html").unlink()
    assert main([*again[1:], "--quiet"]) == 0
    seconds = re.compile(r"<dt>seconds</dt><dd>.*?</dd>")
    second = Path("a b.html").read_text(encoding="utf-8")
    assert seconds.sub("", second) == seconds.sub("", first)


@pytest.mark.slow
def test_margins_are_on_the_page_up_to_a_size_and_above_it_where_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import kilter.analysis.everything as module

    kilter.dump(tower_of(2), "two.json")
    written = ["report", "two.json", "-o", "two.html", "--quiet"]
    assert main(written) == 0
    assert 'id="margins"' in Path("two.html").read_text(encoding="utf-8")
    monkeypatch.setattr(module, "MARGIN_PARTS", 1)
    assert main(written) == 0
    page = Path("two.html").read_text(encoding="utf-8")
    assert 'id="margins"' not in page
    assert "the page computes margins for up to 1 free parts" in page
    assert main([*written, "--margins"]) == 0
    page = Path("two.html").read_text(encoding="utf-8")
    assert 'id="margins"' in page
    assert "--margins</code>" in page


@pytest.mark.slow
def test_a_page_of_eighteen_parts_of_step_has_less_than_a_megabyte() -> None:
    file = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if" / "as1-oc-214.stp"
    pytest.importorskip("OCP")
    if not file.exists():
        pytest.skip("real data is not here: ../shared/data beside the checkout")
    made = kilter.report(kilter.load(file, ground=["plate"]))
    assert len(made.html.encode()) < 1e6


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "-o out.html"),
        (["-o", "tower.kilter.json"], "ends in .html"),
        (["-o", "part.stl"], "ends in .html"),
        (["-o", "nowhere/out.html"], "cannot be written"),
        (["-o", "out.html", "--down", "0", "0", "0"], "down"),
        (["-o", "out.html", "--ground", "nobody"], "nobody"),
    ],
)
def test_report_refuses_with_one_sentence(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = Path("tower.kilter.json").read_bytes()
    assert main(["report", "tower.kilter.json", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert Path("tower.kilter.json").read_bytes() == before
    assert not Path("out.html").exists()


def test_an_input_that_is_named_like_a_page_is_not_written_over(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("tower.kilter.json").rename("tower.html")
    assert main(["report", "tower.html", "-o", "tower.html"]) == 2
    assert "overwritten" in capsys.readouterr().err


@pytest.mark.slow
def test_a_page_that_was_there_is_replaced_whole() -> None:
    Path("out.html").write_text("old")
    assert main(["report", "tower.kilter.json", "-o", "out.html", "--quiet"]) == 0
    assert Path("out.html").read_text(encoding="utf-8").startswith("<!doctype")
    assert sorted(p.name for p in Path().iterdir()) == ["out.html", "tower.kilter.json"]


def asked(url: str, **headers: str) -> tuple[int, str]:
    request = urllib.request.Request(url, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=10) as answer:
            return answer.status, answer.read().decode("utf-8")
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read().decode("utf-8")


def test_the_server_gives_the_page_and_its_version_and_no_more() -> None:
    with PageServer("first") as server:
        assert server.url.startswith("http://127.0.0.1:")
        assert asked(server.url) == (200, "first")
        assert asked(server.url + "version") == (200, "1")
        server.publish("second \u2713")
        assert asked(server.url) == (200, "second \u2713")
        assert asked(server.url + "version") == (200, "2")
        assert asked(server.url + "../../etc/passwd")[0] == 404
        assert asked(server.url + "?x")[0] == 404


def test_the_server_listens_to_this_machine_alone() -> None:
    with PageServer("page") as server:
        assert server._server.server_address[0] == "127.0.0.1"
        assert asked(server.url, Host="elsewhere.example")[0] == 403
        assert asked(server.url, Host=f"localhost:{server.port}")[0] == 200
        assert asked(server.url, Host=f"127.0.0.1:{server.port}")[0] == 200


def said(server: PageServer, *lines: str) -> tuple[int, dict[str, str], str]:
    """Status, headers and body of the response to a request with exactly these lines."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=10) as link:
        link.sendall("\r\n".join([*lines, "", ""]).encode("latin-1"))
        with link.makefile("rb") as stream:
            head, _, body = stream.read().decode("utf-8").partition("\r\n\r\n")
    first, *rest = head.split("\r\n")
    return int(first.split()[1]), dict(line.split(": ", 1) for line in rest), body


OTHER_HOSTS = [
    [],
    ["Host:"],
    ["Host: elsewhere.example"],
    ["Host: elsewhere.example:{port}"],
    ["Host: 127.0.0.1"],
    ["Host: localhost:1"],
    ["Host: [::1]:{port}"],
    ["Host: 127.0.0.1:{port}.elsewhere.example"],
    ["Host: 127.0.0.1:{port}@elsewhere.example"],
    ["Host: 127.0.0.1:{port}", "Host: elsewhere.example"],
    ["Host: elsewhere.example", "X-Forwarded-Host: 127.0.0.1:{port}"],
]
OTHER_PATHS = [
    *("/..", "/./", "/?", "/version/", "/version?x", "/%2e%2e/etc/passwd", "/../../etc/passwd"),
    *("/tower.kilter.json", "/.git/config", "/index.html", "http://127.0.0.1/etc/passwd", "*"),
    *("/\0", "/" + "x" * 5000),
]


def test_who_calls_it_by_another_name_is_told_nothing() -> None:
    with PageServer("<p>secret") as server:
        for host in OTHER_HOSTS:
            own = [line.format(port=server.port) for line in host]
            for path in ("/", "/version"):
                code, _, body = said(server, f"GET {path} HTTP/1.0", *own)
                assert (code, body) == (403, "this page is served to this machine only\n"), host
        code, _, body = said(server, "GET / HTTP/1.0", f"Host: 127.0.0.1:{server.port}")
        assert (code, body) == (200, "<p>secret")


def test_there_is_no_other_path() -> None:
    with PageServer("<p>secret") as server:
        for path in OTHER_PATHS:
            code, _, body = said(server, f"GET {path} HTTP/1.0", f"Host: localhost:{server.port}")
            assert code in (400, 404), path
            assert "secret" not in body
            assert "passwd" not in body


def test_there_is_nothing_to_be_done_to_it() -> None:
    with PageServer("<p>secret") as server:
        for verb in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "CONNECT"):
            code, headers, body = said(
                server, f"{verb} / HTTP/1.0", f"Host: localhost:{server.port}"
            )
            assert code == 501, verb
            assert "secret" not in body
            assert not any(name.lower().startswith("access-control") for name in headers)


def test_no_page_from_elsewhere_may_read_it() -> None:
    with PageServer("page") as server:
        own = f"Host: localhost:{server.port}"
        for path in ("/", "/version"):
            code, headers, _ = said(
                server, f"GET {path} HTTP/1.0", own, "Origin: https://elsewhere.example"
            )
            assert code == 200
            assert not any(name.lower().startswith("access-control") for name in headers)
            assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
            assert headers["X-Content-Type-Options"] == "nosniff"
            assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]


@pytest.mark.slow
def test_who_says_nothing_holds_up_nobody() -> None:
    with PageServer("page") as server:
        silent = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(20)]
        for link in silent[::2]:
            link.sendall(b"GET / HT")
        assert asked(server.url) == (200, "page")
        for link in silent:
            link.close()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="ports are taken otherwise there")
def test_view_says_that_its_port_is_taken(capsys: pytest.CaptureFixture[str]) -> None:
    with PageServer("page") as server:
        port = str(server.port)
        assert main(["view", "tower.kilter.json", "--port", port, "--no-browser"]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"kilter: port {port} is not available")
    assert error.count("\n") == 1


def test_a_port_that_is_taken_is_named() -> None:
    with (
        PageServer("page") as server,
        pytest.raises(InputError, match=f"port {server.port} is not available"),
    ):
        PageServer("other", server.port)


def test_the_port_is_free_again_at_the_end() -> None:
    with PageServer("page") as server:
        port = server.port
    with socket.socket() as probe:
        assert probe.connect_ex(("127.0.0.1", port)) != 0


@pytest.mark.parametrize(
    ("words", "said"), [(["-"], "cannot watch"), (["x", "--port", "70000"], "port")]
)
def test_view_refuses(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["view", *words]) == 2
    assert said in capsys.readouterr().err


def test_a_change_of_a_file_or_of_a_mesh_that_it_names_is_seen(tmp_path: Path) -> None:
    first = fingerprint("tower.kilter.json")
    assert fingerprint("tower.kilter.json") == first
    data = json.loads(Path("tower.kilter.json").read_text())
    data["parts"][0] = {"name": "base", "mesh": "base.stl"}
    Path("tower.kilter.json").write_text(json.dumps(data))
    second = fingerprint("tower.kilter.json")
    assert second != first
    Path("base.stl").write_text("solid")
    third = fingerprint("tower.kilter.json")
    assert third != second
    os.utime("base.stl", ns=(1, 1))
    assert fingerprint("tower.kilter.json") != third
    folder = fingerprint(".")
    Path("new.stl").write_text("solid")
    assert fingerprint(".") != folder
    assert fingerprint("gone.json") == ()


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C is sent otherwise there")
def test_view_serves_sees_changes_and_faults_and_ends_well(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "kilter", "view", "tower.kilter.json", "--no-browser"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            line = process.stdout.readline()
            url = line.split()[0]
            assert "stable" in line
            assert "reload" not in asked(url)[1][:200]
            assert '"verdict":"stable"' in asked(url)[1]
            kilter.dump(scene("hanging-brick"), "tower.kilter.json")
            wait_for(url, "2")
            assert '"verdict":"unstable"' in asked(url)[1]
            Path("tower.kilter.json").write_text('{"kilter": 1, "parts": [{"name": "<b>"}]}')
            wait_for(url, "3")
            assert "&lt;b&gt;" in asked(url)[1]
            assert '"verdict":"unstable"' in asked(url)[1]
            Path("tower.kilter.json").write_text('{"kilter": 1')
            wait_for(url, "4")
            assert asked(url)[1].count('class="problem"') == 1
            assert '"verdict":"unstable"' in asked(url)[1]
            kilter.dump(scene("tower"), "tower.kilter.json")
            wait_for(url, "5")
            assert '"verdict":"stable"' in asked(url)[1]
            assert 'class="problem"' not in asked(url)[1]
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=20)
            assert process.returncode == 0
            assert errors.count("\n") == 4
        finally:
            process.kill()


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C is sent otherwise there")
def test_view_ends_well_where_a_script_started_it_in_the_background() -> None:
    """Background processes inherit SIGINT as ignored."""
    command = "trap '' INT; exec \"$0\" -m kilter view tower.kilter.json --no-browser"
    with subprocess.Popen(
        ["sh", "-c", command, sys.executable],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert "Ctrl-C ends it" in process.stdout.readline()
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=20)
            assert (process.returncode, errors) == (0, "")
        finally:
            process.kill()


def wait_for(url: str, version: str) -> None:
    deadline = time.monotonic() + 60
    while asked(url + "version")[1] != version:
        assert time.monotonic() < deadline, f"no version {version}"
        time.sleep(0.1)
