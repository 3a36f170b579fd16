"""Malformed messages and uploads: each gets an answer in a sentence, and none disturbs the others.

A message here is any text; an upload is any query with any body.
"""

from __future__ import annotations

import http.client
import json
import os
import random
import threading
import urllib.parse
from pathlib import Path
from typing import Any

import pytest
from driver import Page
from test_actions import EFFECTS
from websockets.sync.client import connect

import kilter
from kilter.scenes import scene
from kilter.workbench.job_queue import FAULT
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
def test_an_upload_with_a_wrong_name_is_refused(
    query: dict[str, str], said: str | None, bench: Workbench
) -> None:
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


def test_two_uploads_of_one_name_are_each_whole(bench: Workbench) -> None:
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


def test_a_text_that_is_no_message_is_answered(page: Page, bench: Workbench) -> None:
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
def test_thousands_of_malformed_messages_are_answered(
    seed: int,
    page: Page,
    bench: Workbench,
    folder: Path,
    capfd: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
) -> None:
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
