"""Hostile messages, silent sockets, and files that the workbench owns."""

import csv
import http.client
import io
import json
import os
import random
import re
import socket
import sys
import threading
import time
import urllib.parse
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from driver import Page
from test_view_command import EFFECTS
from websockets.sync.client import connect

import kilter
from kilter.errors import InputError
from kilter.files.writing import write_text
from kilter.scenes import scene
from kilter.workbench import connections, uploads
from kilter.workbench.connections import listen
from kilter.workbench.history import autosave_path, upload_autosave_path
from kilter.workbench.jobs import FAULT
from kilter.workbench.server import Workbench

COUNT = 500
"""Messages, and a fifth as many uploads, for each seed."""


def posted(bench: Workbench, query: dict[str, str], body: Any = b"x") -> tuple[int, dict[str, str]]:
    """Status and answer of an upload."""
    link = http.client.HTTPConnection("127.0.0.1", bench.port, timeout=60)
    words = urllib.parse.urlencode({"token": bench.token, **query}, errors="surrogatepass")
    link.request("POST", f"/upload?{words}", body=body)
    answer = link.getresponse()
    found = answer.status, json.loads(answer.read())
    link.close()
    return found


def uploads_of(bench: Workbench) -> Path:
    assert bench.session is not None
    return bench.session.uploads


UPLOADS = [
    ({"name": "a\0b.stl"}, "is not usable"),
    ({"name": "x" * 5000}, "is not usable"),
    ({"name": "x" * 300}, "is not usable"),
    ({"name": "a.stl", "folder": "x" * 300}, "is not usable"),
    ({"name": "a\nb.stl"}, "is not usable"),
    ({"name": "a\ud800b.stl"}, None),
    ({"name": ".hidden"}, "is not usable"),
    ({"name": "../a.stl"}, "is not usable"),
    ({"name": "a.stl", "folder": ".."}, "is not usable"),
    ({"name": "a\\b.stl"}, "is not usable"),
    ({}, "has no name"),
    ({"name": "a.stl", "folder": "taken"}, "cannot be kept"),
    ({"name": "parts"}, "cannot be kept"),
]


@pytest.mark.parametrize(("query", "said"), UPLOADS)
def test_an_upload_with_a_wrong_name_is_refused(query, said, bench):
    """An invalid byte in a name is replaced by the decoder of addresses, so it is no fault."""
    assert posted(bench, {"name": "taken"})[0] == 200
    assert posted(bench, {"name": "a.stl", "folder": "parts"}) == (200, {"file": "parts"})
    before = sorted(os.listdir(uploads_of(bench)))
    code, answer = posted(bench, query)
    if said is None:
        assert code == 200
        return
    assert 400 <= code < 500
    assert said in answer["error"]
    assert len(answer["error"]) < 160
    assert sorted(os.listdir(uploads_of(bench))) == before


def test_two_uploads_of_one_name_are_each_whole(bench):
    bodies = [bytes([k]) * 3_000_000 for k in (1, 2)]
    codes: list[int] = []

    def send(body: bytes) -> None:
        pieces = (body[k : k + 100_000] for k in range(0, len(body), 100_000))
        codes.append(posted(bench, {"name": "same.stl"}, pieces)[0])

    threads = [threading.Thread(target=send, args=(body,)) for body in bodies]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert codes == [200, 200]
    assert (uploads_of(bench) / "same.stl").read_bytes() in bodies
    assert not list(uploads_of(bench).glob("*.partial"))


RAW = [
    "[" * 100_000,
    '{"id": 1, "do": ' + "[" * 100_000,
    "",
    "null",
    "[]",
    "\0",
    '{"id": 1',
    '{"id": {"a": 1}, "do": "undo", "x": "\\ud800"}',
]


@pytest.mark.slow
def test_a_text_that_is_no_message_is_answered(page, bench):
    other = Page(bench)
    for text in (*RAW, b"\xff\x00"):
        with connect(
            bench.url.replace("http", "ws").replace("/?", "/live?"), max_size=None
        ) as link:
            link.send(text)
            assert answered(link, [])["ok"] is False
    assert other.say(do="stop")["ok"]
    assert page.after(do="hold", parts=["C2"], on=True)["is"] == "answer"
    other.close()


def answered(link: Any, heard: list[str]) -> dict[str, Any]:
    """The next reply; other messages are appended to `heard`."""
    while True:
        text = link.recv(timeout=60)
        message: dict[str, Any] = json.loads(text, parse_constant=not_json)
        if "re" in message:
            return message
        heard.append(text)


def not_json(word: str) -> None:
    raise AssertionError(f"the browser cannot read {word}")


EVIL = [
    -1, 0, 10**400, 1.5, -1e308, 5e-324, True, None, [], {}, "", "\0", "\ud800", "x" * 70_000, "*",
    "C1", "C2", "../../etc/passwd", "x" * 300, "=1", [[]], ["C1", "C2"], ["C1", "C1"], [1, 2, 3],
    float("inf"), float("nan"), [float("nan")] * 3, [1e308] * 3, {"C1": 1}, {"a": {"b": [{}]}},
    json.loads("[" * 60 + "]" * 60), "\x1b[8m", "\u202e", "m", "joined", "fixed", "revolute",
]  # fmt: skip
OTHERS = [
    {"do": "go", "index": 0}, {"do": "revert", "index": 0}, {"do": "undo"}, {"do": "redo"},
    {"do": "compare", "a": 0, "b": 1}, {"do": "ask", "tab": "contacts", "options": {}},
    {"do": "ask", "tab": "place", "options": {"size": [1, 1, 1], "mass": 1}}, {"do": "stop"},
    {"do": "ask", "tab": "transport", "options": {"code": "gdv"}}, {"do": "settle"},
    {"do": "save", "file": None}, {"do": "open", "file": "f8.kilter.json"},
    {"do": "open", "example": "tower"}, {"do": "load_off", "index": 0},
    {"do": "scale_loads", "factor": 2}, {"do": "joint_off", "index": 0},
]  # fmt: skip
ACTIONS = [json.loads(json.dumps(action).replace("plate", "C2").replace("rod", "C3")
           .replace("nut_1", "C1").replace("nut_2", "C1")) for action, _ in EFFECTS]  # fmt: skip


def message(rng: random.Random, number: int) -> str:
    """A text that is nearly a message: valid but for a value, a key, or a few characters."""
    data: dict[str, Any] = {"id": number, **rng.choice([*ACTIONS, *OTHERS])}
    if data["do"] == "open" and rng.random() < 0.7:  # the reader takes its time
        data["do"] = "gone"
    for _ in range(rng.choice([0, 1, 1, 1, 2, 3])):
        key = rng.choice([*data, "index", "live", "mu", "on"])
        inner = data.get(key)
        if isinstance(inner, list | dict) and inner and rng.random() < 0.5:
            place = rng.choice(list(inner) if isinstance(inner, dict) else range(len(inner)))
            data[key] = inner = inner.copy()
            inner[place] = rng.choice(EVIL)
        elif rng.random() < 0.15:
            data.pop(key, None)
        else:
            data[key] = rng.choice(EVIL)
    text = json.dumps(data)
    if rng.random() < 0.15:
        at = rng.randrange(len(text))
        text = (
            text[:at] + rng.choice(["", "[" * 3000, '"', "1e999", "\\ud800", "{", "\0"]) + text[at:]
        )
    if rng.random() < 0.1:
        text = text[: rng.randrange(len(text))]
    return text


def query(rng: random.Random) -> dict[str, str]:
    """Names of an upload that are nearly usable."""
    letters = ["a", ".", "/", "\\", "\0", "\n", "\ud800", "é", " ", "..", "x" * 300, "C:", "%00"]
    found = {"name": "".join(rng.choices(letters, k=rng.randrange(4))) + ".stl"}
    if rng.random() < 0.5:
        found["folder"] = rng.choice(["a", "taken.stl", "x" * 5000, "..", "\0", "b/c"])
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_thousands_of_malformed_messages_are_answered(seed, page, bench, folder, capfd, caplog):
    """3,600 in all: none is silent, none is a fault, and the file is as before."""
    page.close()
    rng, heard, silent = random.Random(seed), [], 0
    kept = (folder / "f8.kilter.json").read_bytes()
    assert posted(bench, {"name": "taken.stl"})[0] == 200
    url = bench.url.replace("http", "ws").replace("/?", "/live?")
    with connect(url, max_size=None) as link:
        for number in range(COUNT):
            # a long list of changes would be sent again and again
            text = (
                message(rng, number)
                if number % 25
                else f'{{"id": {number}, "do": "go", "index": 0}}'
            )
            link.send(text)
            reply = answered(link, heard)
            assert reply["ok"] or (reply["error"] and FAULT not in reply["error"]), (text, reply)
            assert "Traceback" not in str(reply)
            silent += reply["re"] != number and text.startswith(f'{{"id": {number},')
            if number % 5 == 0:
                code, answer = posted(bench, query(rng))
                assert code == 200 or (400 <= code < 500 and answer["error"])
    assert silent == 0
    faults = [text[:400] for text in heard if FAULT in text or "Traceback" in text]
    assert faults == []
    assert "Traceback" not in capfd.readouterr().err + caplog.text
    assert (folder / "f8.kilter.json").read_bytes() == kept
    # a user goes on as if nothing had happened
    user = Page(bench)
    assert user.say(do="open", file="f8.kilter.json")["ok"]
    user.say(do="go", index=0)
    expected = kilter.check(scene("paper-figure-8").with_grounded(["C3"]))
    assert user.after(do="hold", parts=["C3"], on=True)["check"]["verdict"] == expected.verdict
    user.close()


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
def test_a_connection_without_a_request_is_closed(begin, drip, impatient):
    assert time_to_the_end(impatient, begin, drip) < 25 * SHORT


@pytest.mark.slow
@pytest.mark.parametrize("drip", [b"", b"x"])
def test_an_upload_that_does_not_advance_is_ended(drip, impatient):
    query = urllib.parse.urlencode({"token": impatient.token, "name": "a.stl"})
    head = f"POST /upload?{query} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9999999\r\n\r\n"
    assert time_to_the_end(impatient, head.encode(), drip) < 25 * SHORT
    assert impatient.session is not None
    assert list(impatient.session.uploads.iterdir()) == []


@pytest.mark.slow
def test_a_page_that_only_listens_stays_connected(impatient):
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
def test_it_listens_on_all_addresses_only_if_asked(word, tmp_path):
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


def test_a_taken_port_is_a_sentence():
    with (
        listen(0, ()) as taken,
        pytest.raises(InputError, match="is not available"),
    ):
        listen(taken.getsockname()[1], ())


POSIX = pytest.mark.skipif(os.name != "posix", reason="links and pipes of POSIX")
VICTIM = b"export PATH=/usr/bin\n"


def to_file(link: Path, victim: Path) -> None:
    link.symlink_to(victim)


def to_nothing(link: Path, victim: Path) -> None:
    link.symlink_to(victim.with_name("gone"))


def to_folder(link: Path, victim: Path) -> None:
    link.symlink_to(victim.parent, target_is_directory=True)


def pipe(link: Path, victim: Path) -> None:
    os.mkfifo(link)


@pytest.fixture
def victim(tmp_path: Path) -> Path:
    path = tmp_path / "home" / "profile"
    path.parent.mkdir()
    path.write_bytes(VICTIM)
    return path


TRAPS = [to_file, to_nothing, to_folder, pipe]


@POSIX
@pytest.mark.parametrize("trap", TRAPS)
def test_an_owned_file_replaces_no_link(trap, victim, tmp_path):
    place = tmp_path / "owned.json"
    trap(place, victim)
    before = sorted(os.listdir(tmp_path)), sorted(os.listdir(victim.parent))
    with pytest.raises(InputError, match=r"owned\.json: is (a link|no regular file)"):
        write_text(place, "text", links=False)
    assert (sorted(os.listdir(tmp_path)), sorted(os.listdir(victim.parent))) == before
    assert victim.read_bytes() == VICTIM


@pytest.mark.quick(1)
@POSIX
@pytest.mark.parametrize("trap", TRAPS)
@pytest.mark.slow
def test_a_click_writes_through_no_link(trap, victim, page, folder):
    trap(autosave_path(folder / "f8.kilter.json"), victim)
    trap(folder / "f8.choices.kilter.json", victim)
    page.after(do="hold", parts=["C3"], on=True)
    said = page.last["session"]["message"]
    assert re.search("not kept beside the file.* is (a link|no regular file).*remove it", said)
    reply = page.say(do="save")
    assert not reply["ok"]
    assert re.search("is (a link|no regular file)|something other", reply["error"])
    assert victim.read_bytes() == VICTIM
    assert os.listdir(victim.parent) == [victim.name]


@pytest.mark.slow
def test_a_file_with_the_longest_name_keeps_its_changes(page, folder):
    name = f"{'n' * 240}.kilter.json"
    kilter.dump(scene("paper-figure-8"), folder / name)
    assert page.say(do="open", file=name)["ok"]
    page.answer()
    page.after(do="hold", parts=["C3"], on=True)
    assert page.last["session"]["message"] == ""
    assert page.say(do="open", file=name)["ok"]
    assert "1 change of the earlier session restored" in page.last["session"]["message"]


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "content",
    [
        b"[" * 100_000,
        b"\xff\xfe",
        b'{"kilter_workbench": 1, "base": {}, "changes": [5], "undone": []}',
        b'{"kilter_workbench": 1, "base": {}, "changes": [{"do": "go", "x": NaN}], "undone": []}',
        b'{"kilter_workbench": 1, "base": [], "changes": {"a": 1}, "undone": 3}',
        b'{"kilter_workbench": 1, "base": {}, "undone": [], "changes": [' + b"1," * 9999 + b"1]}",
    ],
)
def test_a_damaged_autosave_is_a_sentence(content, page, folder):
    autosave_path(folder / "f8.kilter.json").write_bytes(content)
    assert page.say(do="open", file="f8.kilter.json")["ok"]
    assert "could not be restored" in page.last["session"]["message"]
    assert page.answer()["is"] == "answer"


@POSIX
def test_changes_of_a_dropped_file_follow_no_link(bench, page, victim):
    assert page.say(do="open", example="paper-figure-8")["ok"]
    page.answer()
    digest = page.last["session"]["choices"]["sha256"]
    place = upload_autosave_path(digest)
    place.parent.mkdir(parents=True)
    place.symlink_to(victim)
    page.after(do="hold", parts=["C3"], on=True)
    assert "is a link" in page.last["session"]["message"]
    assert victim.read_bytes() == VICTIM


def test_the_table_of_contacts_begins_no_cell_with_a_formula(page, bench, folder):
    base = kilter.Part("=1+1", kilter.Box([2, 2, 1]), [0, 0, 0], grounded=True)
    top = kilter.Part("@SUM(A1)\x1b", kilter.Box([1, 1, 1]), [0, 0, 1])
    kilter.dump(kilter.Assembly([base, top]), folder / "names.kilter.json")
    assert page.say(do="open", file="names.kilter.json")["ok"]
    page.answer()
    address = bench.url.replace("/?", "/export/contacts.csv?")
    with urllib.request.urlopen(address, timeout=60) as answer:
        _, row = csv.reader(io.StringIO(answer.read().decode()))
    assert row[:2] == ["'=1+1", "'@SUM(A1)\\x1b"]
    assert all(cell[0] != "'" for cell in row[3:])
    assert float(row[-1]) in (-1.0, 1.0)


# the opened folder -----------------------------------------------------------------------------

TETRAHEDRON = """v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""
MESH = '<mujoco><asset><mesh name="m" file="{}"/></asset><worldbody><geom type="mesh" mesh="m"/>'
MESH += '<body><freejoint/><geom size="1"/></body></worldbody></mujoco>'
INCLUDE = '<mujoco><include file="{}"/></mujoco>'
URDF = '<robot name="r"><link name="a"><collision><geometry><mesh filename="{}"/></geometry>'
URDF += "</collision></link></robot>"
USD = '#usda 1.0\n(\n    subLayers = [@{}@]\n)\ndef Xform "a" {{}}\n'
SCENES = {
    "MJCF mesh": ("scene.xml", MESH, "t.obj"),
    "MJCF include": ("scene.xml", INCLUDE, "inc.xml"),
    "URDF mesh": ("robot.urdf", URDF, "t.obj"),
    "USD layer": ("stage.usda", USD, "layer.usda"),
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A folder with meshes, beside the folder of the scenes."""
    (tmp_path / "project" / "meshes").mkdir(parents=True)
    (tmp_path / "project" / "scenes").mkdir()
    meshes = tmp_path / "project" / "meshes"
    (meshes / "t.obj").write_text(TETRAHEDRON)
    (meshes / "inc.xml").write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    (meshes / "layer.usda").write_text('#usda 1.0\ndef Cube "c" {}\n')
    return tmp_path / "project"


@pytest.mark.slow
@pytest.mark.parametrize("absolute", [False, True])
@pytest.mark.parametrize("kind", SCENES)
def test_a_named_file_outside_is_refused_with_the_folder_to_open(kind, absolute, project):
    """With the folder above as the opened folder, the refusal ends."""
    name, text, named = SCENES[kind]
    modules = {"MJCF mesh": "mujoco", "MJCF include": "mujoco", "USD layer": "pxr"}
    if kind in modules:
        pytest.importorskip(modules[kind])
    target = project / "meshes" / named
    scheme = "file://" if absolute and kind == "URDF mesh" else ""
    (project / "scenes" / name).write_text(
        text.format(scheme + target.as_posix() if absolute else f"../meshes/{named}")
    )
    with Workbench(None, folder=project / "scenes") as bench:
        page = Page(bench)
        reply = page.say(do="open", file=name)
        page.close()
    assert not reply["ok"]
    assert "outside of the opened folder" in reply["error"]
    assert reply["hint"].endswith(f"--folder {os.path.realpath(project)}")
    with Workbench(None, folder=project) as bench:
        page = Page(bench)
        reply = page.say(do="open", file=f"scenes/{name}")
        page.close()
    assert "opened folder" not in str(reply)


@POSIX
def test_a_link_to_a_file_outside_is_refused(page, folder, project):
    meshes = folder / "meshes"
    meshes.mkdir()
    (meshes / "a.obj").symlink_to(project / "meshes" / "t.obj")
    reply = page.say(do="open", file="meshes")
    assert not reply["ok"]
    assert "outside of the opened folder" in reply["error"]
    (meshes / "a.obj").unlink()
    meshes.rmdir()


@pytest.mark.slow
@POSIX
def test_the_whole_disk_is_never_proposed(page, folder):
    (folder / "all.obj").symlink_to("/etc/hostname")
    with Workbench(folder / "all.obj", folder=folder) as bench:
        other = Page(bench)
        other.hear(lambda m: "outside of the opened folder" in m.get("message", ""))
        assert "copy it" in other.last["session"]["message"]
        other.close()


def test_the_option_names_the_opened_folder(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        kilter.view(folder=tmp_path / "gone", browser=False)
