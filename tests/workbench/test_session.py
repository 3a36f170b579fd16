"""A session of the workbench: its state, files, exports and settled poses."""

import json
import os
import shlex
import signal
import time
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from driver import Message, Page
from forwarding import Forwarding
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

import kilter
from kilter import Assembly, Box, Joint, Load, Part, Pose
from kilter.analysis.check import check_equilibrium
from kilter.cli import main
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.workbench.server import Workbench


def test_held_parts_change_the_verdict_and_undo_takes_it_back(page):
    assert page.last["answer"]["check"]["verdict"] == "unstable"
    held = page.after(do="hold", parts=["C3"], on=True)
    command = page.last["session"]["command"]
    assert command == "kilter check f8.kilter.json --ground C3"
    expected = kilter.check(scene("paper-figure-8").with_grounded(["C3"]))
    assert held["check"]["verdict"] == expected.verdict
    assert page.after(do="undo")["check"]["verdict"] == "unstable"
    assert page.after(do="redo")["check"] == held["check"]


@pytest.mark.slow
def test_the_saved_choices_give_the_same_answer(page, folder):
    page.after(do="friction", mu=0.4)
    page.after(do="hold", parts=["C2"], on=True)
    shown = page.after(do="load", part="C3", force=[0, 0, -2])
    assert page.say(do="save")["saved"] == "f8.choices.kilter.json"
    session = page.last["session"]
    assert session["command"] == "kilter check f8.choices.kilter.json"
    assert not session["dirty"]
    verdict = kilter.check(folder / "f8.choices.kilter.json")
    assert shown["check"] == {k: verdict.to_dict()[k] for k in ("verdict", "level", "why")}
    assert shown["given"]["sentence"] == verdict.sentence


def test_a_second_page_shows_the_same_state(page, bench):
    page.after(do="hold", parts=["C2"], on=True)
    other = Page(bench)
    other.hear(lambda message: message.get("is") == "answer")
    assert other.last["session"]["choices"] == page.last["session"]["choices"]
    assert other.last["scene"]["page"]["shapes"] is not None
    other.say(do="friction", mu=0.2)
    page.hear(lambda message: message.get("is") == "session")
    assert page.last["session"]["choices"]["friction"] == 0.2
    other.close()


def test_tabs_have_answer_and_command(page):
    page.after(do="hold", parts=["C2"], on=True)
    for name in ("orient", "margin", "hold", "plan", "contacts", "transport"):
        assert page.say(do="ask", tab=name)["ok"]
        tab = page.hear(lambda message: message.get("is") == "tab")
        assert (tab["name"], tab["error"]) == (name, "")
        pushes = " --pushes" if name == "margin" else ""
        assert tab["command"] == f"kilter {name} f8.kilter.json --ground C2{pushes}"
        assert "<" in tab["html"]


def test_the_map_of_places_is_that_of_its_command(page, folder, capsys, monkeypatch):
    kilter.dump(scene("tower"), folder / "tower.kilter.json")
    assert page.say(do="open", file="tower.kilter.json")["ok"]
    page.answer()
    page.say(do="ask", tab="place", options={"size": [0.5, 0.5, 0.25], "mass": 2})
    tab = page.hear(lambda message: message.get("is") == "tab")
    assert tab["command"] == "kilter place tower.kilter.json --box 0.5x0.5x0.25 --mass 2"
    assert tab["place"]["below"] == pytest.approx(0.125)
    monkeypatch.chdir(folder)
    capsys.readouterr()
    assert main([*shlex.split(tab["command"])[1:], "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    for key in ("levels", "best", "sentence"):
        assert printed[key] == tab["data"][key]


@pytest.mark.parametrize("options", [{}, {"size": [1, 1, 1]}, {"size": [1, 1, -1], "mass": 1}])
@pytest.mark.slow
def test_a_wrong_box_to_place_is_a_sentence(page, options):
    page.after(do="hold", parts=["C2"], on=True)
    page.say(do="ask", tab="place", options=options)
    tab = page.hear(lambda message: message.get("is") == "tab")
    assert tab["name"] == "place"
    assert tab["error"]


def test_two_states_are_compared(page):
    page.after(do="hold", parts=["C2"], on=True)
    page.after(do="hold", parts=["C3"], on=True)
    page.say(do="compare", a=0, b=2)
    tab = page.hear(lambda message: message.get("is") == "tab")
    assert tab["sentence"] == "The verdict changes from unstable to stable."


def test_a_problem_is_a_sentence_and_the_scene_stays(page, folder):
    data = json.loads((folder / "f8.kilter.json").read_text())
    for part in data["parts"]:
        part.pop("grounded", None)
    (folder / "free.kilter.json").write_text(json.dumps(data))
    assert page.say(do="open", file="free.kilter.json")["ok"]
    problem = page.answer()
    assert (problem["is"], problem["error"]) == ("problem", "nothing is held")
    assert page.last["scene"]["state"] == problem["state"]
    assert page.after(do="floor", on=True)["is"] == "answer"


def test_a_wrong_request_is_refused_in_a_sentence(page):
    """The other pages, and the next message, are not disturbed."""
    for request, said in (
        ({"do": "open", "file": "../../etc/passwd"}, "there is no file"),
        ({"do": "open", "file": "gone.step"}, "there is no file"),
        ({"do": "open", "example": "gone"}, "there is no example"),
        ({"do": "save", "file": "../x.kilter.json"}, "beside their file"),
        ({"do": "save", "file": "f8.kilter.json"}, "is not overwritten"),
        ({"do": "revert", "index": 3}, "there are 0 changes"),
        ({"do": "nothing"}, "unknown request"),
        ({"do": "go"}, "index is None"),
        ({"do": "revert", "index": -1}, "index is -1"),
        ({"do": "go", "index": True}, "index is True"),
        ({"do": "go", "index": float("inf")}, "the number Infinity"),
        ({"do": "load", "part": "C3", "force": [0, 0, 10**309]}, "the number 1000"),
        ({"do": "load", "part": "C3", "force": [0, 0, -1], "index": -1}, "index is -1"),
        ({"do": "load_off", "index": 10**300}, "index is 1000"),
        ({"do": "load_off", "index": 5}, "there is no load number 6"),
        ({"do": "hold", "parts": ["\ud800"], "on": True}, "a lone surrogate"),
        ({"do": "hold", "parts": ["x" * 70_000], "on": True}, "there is no part"),
        ({"do": ["hold"]}, "unknown request"),
        ({"do": "open", "file": "x" * 300 + ".step"}, "there is no file"),
        ({"do": "open", "file": "a\0b"}, "there is no file"),
        ({"do": "save", "file": "x" * 300 + ".kilter.json"}, "cannot be written"),
        ({"do": "save", "file": "a\0.kilter.json"}, "cannot be written"),
        ({"do": "save", "file": ".bashrc"}, "the name is '.bashrc'"),
        ({"do": "ask", "tab": 3}, "there is no tab"),
        ({"do": "compare", "a": 0, "b": 1e300}, "b is 1e+300"),
        ({"do": "poses", "poses": [1]}, "the poses have another form"),
        (json.loads("[" * 30 + "]" * 30), "nested too deeply"),
    ):
        reply = page.say(**(request if isinstance(request, dict) else {"do": request}))
        assert not reply["ok"], request
        assert said in reply["error"]
        assert len(reply["error"]) <= 200
    assert page.after(do="hold", parts=["C2"], on=True)["is"] == "answer"


def test_the_first_answer_has_the_verdict_and_leaves_the_displacements_to_the_second():
    assembly = scene("paper-figure-8")
    found = kilter.contacts(assembly)
    quick, complete = check_equilibrium(assembly, found), kilter.check(assembly)
    first, second = quick.to_dict(), complete.to_dict()
    assert (first["verdict"], first["sentence"]) == (second["verdict"], second["sentence"])
    assert quick.moving == complete.moving
    assert second["z"] < 0
    assert second["instability"] > 0
    assert first["z"] is None
    assert all(part["displacement"] is None for part in first["parts"])
    assert "displacement" not in vars(quick)  # its program was not solved


def test_an_example_opens(page):
    assert page.say(do="open", example="tower")["ok"]
    assert page.answer()["check"]["verdict"] == "stable"
    assert page.last["session"]["file"] == "tower.kilter.json"


@pytest.mark.slow
def test_changes_survive_the_end_of_the_server(tmp_path):
    kilter.dump(scene("paper-figure-8"), tmp_path / "f8.kilter.json")
    for count in (0, 1):
        with Workbench(tmp_path / "f8.kilter.json") as bench:
            page = Page(bench)
            page.opened()
            assert len(page.last["session"]["changes"]) == count
            if not count:
                page.after(do="hold", parts=["C3"], on=True)
            else:
                assert "1 change of the earlier session restored" in page.last["session"]["message"]
            page.close()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="the process is killed with a POSIX signal")
def test_a_killed_worker_is_started_again(page, bench):
    assert bench.session is not None
    before = bench.session.jobs.worker.pid
    os.kill(before, signal.SIGKILL)
    deadline = time.monotonic() + 20
    while bench.session.jobs.worker.pid == before and time.monotonic() < deadline:
        time.sleep(0.05)
    assert page.after(do="hold", parts=["C2"], on=True)["is"] == "answer"
    assert bench.session.jobs.worker.pid not in (0, before)


@pytest.mark.slow
def test_a_changed_file_is_read_again(page, folder):
    page.after(do="hold", parts=["C2"], on=True)
    data = json.loads((folder / "f8.kilter.json").read_text())
    data["parts"] = [part for part in data["parts"] if part["name"] != "C3"]
    (folder / "f8.kilter.json").write_text(json.dumps(data))
    page.hear(lambda m: m.get("is") == "session" and "was read again" in m["message"])
    assert page.last["session"]["choices"]["held"] == ["C2"]
    (folder / "f8.kilter.json").unlink()
    page.hear(lambda m: m.get("is") == "session" and "was removed" in m["message"])


def fetched(bench: Workbench, path: str, **headers: str) -> tuple[int, bytes]:
    request = urllib.request.Request(f"http://127.0.0.1:{bench.port}{path}", headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read()


@pytest.mark.slow
def test_exports_are_those_of_the_commands(page, bench, folder):
    page.after(do="hold", parts=["C3"], on=True)
    query = f"?token={bench.token}"
    code, proof = fetched(bench, f"/export/proof.json{query}")
    assert code == 200
    (folder / "p.json").write_bytes(proof)
    held = kilter.load(folder / "f8.kilter.json", ground="C3")
    assert kilter.verify(held, json.loads(proof)).holds
    code, choices = fetched(bench, f"/export/choices.kilter.json{query}")
    assert json.loads(choices)["held"] == ["C3"]
    code, answer = fetched(bench, f"/export/answer.json{query}")
    assert json.loads(answer)["verdict"] == kilter.check(held).verdict
    code, rows = fetched(bench, f"/export/contacts.csv{query}")
    assert rows.startswith(b"part_a,part_b,kind")
    code, refused = fetched(bench, f"/export/gone.txt{query}")
    assert (code, b"there is no export" in refused) == (409, True)


ACTIONS = [
    [{"do": "hold", "parts": ["C3"], "on": True}],
    [{"do": "hold", "parts": ["C2", "C3"], "on": True}, {"do": "friction", "mu": 0.45}],
    [{"do": "floor", "on": True}, {"do": "leave_out", "parts": ["C3"], "on": True}],
    [{"do": "fasten", "parts": ["C1", "C2"], "on": True}],
    [{"do": "gravity", "down": [0.1, 0, -1]}],
    [{"do": "material", "parts": ["C2"], "density": 2700, "name": "aluminium"}],
    [{"do": "material", "parts": ["C2"], "density": 2700}, {"do": "material", "parts": ["C2"]}],
    [{"do": "mass", "part": "C3", "mass": 4}],
    [{"do": "pair_friction", "parts": ["C1", "C2"], "mu": 0.8}],
    [{"do": "pair", "pairs": [["C2", "C3"], ["C1", "C2"]], "as": "joined"}],
    [{"do": "joint", "parts": ["C2", "C3"], "kind": "fixed"}],
    [{"do": "bond", "parts": ["C2", "C3"], "pull": 3}],
    [{"do": "load", "part": "C3", "force": [0, 0, 5]}, {"do": "scale_loads", "factor": 2}],
    [{"do": "tolerance", "gap": 1e-3}, {"do": "loose", "on": True}],
]


@pytest.mark.slow
@pytest.mark.parametrize("actions", ACTIONS, ids=lambda actions: actions[0]["do"])
def test_the_shown_command_prints_the_whole_answer(
    actions, page, bench, folder, monkeypatch, capsys
):
    for action in actions:
        page.after(**action)
    page.say(do="save")
    _, exported = fetched(bench, f"/export/answer.json?token={bench.token}")
    program, *words = shlex.split(page.last["session"]["command"])
    assert program == "kilter"
    monkeypatch.chdir(folder)
    assert main([*words, "--json"]) in (0, 1, 3, 4)
    printed, shown = json.loads(capsys.readouterr().out), json.loads(exported)
    for answer in (printed, shown):
        del answer["seconds"]
    assert printed == shown


@pytest.mark.slow
def test_figure_film_and_plan_are_exported(page, bench):
    query = f"?token={bench.token}"
    code, film = fetched(bench, f"/export/film.glb{query}")
    assert (code, film[:4]) == (200, b"glTF")
    code, figure = fetched(bench, f"/export/figure.svg{query}")
    assert (code, b"</svg>" in figure) == (200, True)
    page.after(do="hold", parts=["C2"], on=True)
    page.after(do="hold", parts=["C3"], on=True)
    code, _ = fetched(bench, f"/export/plan.html{query}")
    assert code in (200, 409)
    code, report = fetched(bench, f"/export/report.html{query}")
    assert (code, report[:15]) == (200, b"<!doctype html>")


def test_only_this_machine_with_the_token_is_answered(bench):
    query = f"/?token={bench.token}"
    own = f"127.0.0.1:{bench.port}"
    assert fetched(bench, query)[0] == 200
    assert fetched(bench, query, Host="localhost:9")[0] == 200  # a port that SSH forwards
    assert fetched(bench, query, Host="LOCALHOST:9")[0] == 200
    assert fetched(bench, query, Origin=f"http://{own}")[0] == 200
    for path, headers in (
        ("/", {}),
        ("/?token=guess", {}),
        (query, {"Host": "elsewhere.example"}),
        (query, {"Host": f"127.0.0.1:{bench.port}.elsewhere.example"}),
        (query, {"Host": f"127.0.0.1:{bench.port}@elsewhere.example"}),
        (query, {"Host": ""}),
        *((query, {"Origin": origin}) for origin in FOREIGN),
        ("/export/answer.json", {}),
    ):
        code, body = fetched(bench, path, **headers)
        assert code == 403, (path, headers)
        assert bench.token.encode() not in body
    assert fetched(bench, f"/../../etc/passwd?token={bench.token}")[0] == 404


FOREIGN = (
    "https://elsewhere.example",
    "null",
    "http://[",
    "http://localhost:1",  # another page of this machine
    "http://hub.example.org.elsewhere.example",
    "http://elsewhere.example/hub.example.org",
    "file://hub.example.org",
    "",
)
"""Origins that no workbench of these tests accepts."""


def test_a_proxy_is_answered_under_the_names_that_the_user_allows(folder):
    with Workbench(None, folder=folder, hosts=["Hub.example.org"]) as bench:
        query = f"/?token={bench.token}"
        name = "hub.example.org"
        for host, origin in (
            (name, None),
            (name, f"https://{name}"),
            (f"{name}:8443", f"https://{name}:8443"),
            ("127.0.0.1:80", f"https://{name}"),  # the proxy has replaced the host
        ):
            headers = {"Host": host, **({} if origin is None else {"Origin": origin})}
            assert fetched(bench, query, **headers)[0] == 200, headers
        assert fetched(bench, "/", Host=name)[0] == 403
        for host in (name, f"127.0.0.1:{bench.port}"):
            for origin in FOREIGN:
                assert fetched(bench, query, Host=host, Origin=origin)[0] == 403, (host, origin)
                with pytest.raises(InvalidStatus):
                    connect(f"ws://127.0.0.1:{bench.port}/live{query[1:]}", origin=Origin(origin))
        code, body = fetched(bench, query, Host="sub.hub.example.org")
        assert (code, b"--host sub.hub.example.org" in body) == (403, True)


@pytest.mark.parametrize(
    "name", ["", "*", "https://hub.example.org", "hub.example.org:8443", "a/b"]
)
def test_a_host_that_is_no_name_is_refused(name, folder):
    with pytest.raises(kilter.InputError, match="is no name of a host"):
        Workbench(None, folder=folder, hosts=[name])


@pytest.mark.slow
def test_the_page_works_through_a_forwarded_port_and_below_a_path(folder):
    kilter.dump(scene("paper-figure-8"), folder / "f8.kilter.json")
    with Workbench(None, folder=folder) as bench:
        for options in ({}, {"prefix": "/user/x/proxy/8899"}):
            with Forwarding(bench.port, **options) as port:
                page = Page(port.url(bench.url, "localhost"))
                assert page.say(do="open", file="f8.kilter.json")["ok"]
                assert page.after(do="hold", parts=["C3"], on=True)["is"] == "answer"
                page.close()


def uploaded(bench: Workbench, name: str, data: bytes) -> tuple[int, dict]:
    path = f"/upload?token={bench.token}&name={name}"
    request = urllib.request.Request(f"http://127.0.0.1:{bench.port}{path}", data, method="POST")
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.load(error)


def test_an_uploaded_file_opens(page, bench, folder):
    data = (folder / "f8.kilter.json").read_bytes()
    assert uploaded(bench, "dropped.kilter.json", data) == (200, {"file": "dropped.kilter.json"})
    assert page.say(do="open", file="dropped.kilter.json")["ok"]
    assert page.answer()["check"]["verdict"] == "unstable"
    for name in ("..%2Fx.step", ".hidden", "", "a%5Cb.step"):
        code, reply = uploaded(bench, name, data)
        assert code == 409, name
        assert reply["error"]


def test_changes_of_an_uploaded_file_outlive_it(page, bench, folder, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    data = (folder / "f8.kilter.json").read_bytes()
    for name, count in (("first.kilter.json", 0), ("second.kilter.json", 1)):
        uploaded(bench, name, data)
        assert page.say(do="open", file=name)["ok"]
        page.answer()
        session = page.last["session"]
        assert session["temporary"]
        assert len(session["changes"]) == count
        if not count:
            page.after(do="hold", parts=["C3"], on=True)
    assert len(list((tmp_path / "kilter" / "workbench").glob("*.json"))) == 1


def test_a_wrong_file_leaves_the_open_file_open(page, bench):
    assert uploaded(bench, "wrong.step", b"not a step file")[0] == 200
    reply = page.say(do="open", file="wrong.step")
    assert not reply["ok"]
    assert reply["error"]
    assert page.last["session"]["file"] == "f8.kilter.json"
    assert page.after(do="hold", parts=["C3"], on=True)["is"] == "answer"


def test_a_port_that_is_taken_is_named(bench):
    with pytest.raises(kilter.InputError, match=f"port {bench.port} is not available"):
        Workbench(None, port=bench.port)


DEPTH = 1e-3
"""Depth of each overlap, and height of each hanging part [m]."""


def sunken(**more: Any) -> Assembly:
    """A block sunk into the base, and a block sunk into this block."""
    base = Part("base", Box([6, 6, 1]), Pose([0, 0, -0.5]), grounded=True)
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5 - DEPTH]))
    high = Part("high", Box([1, 1, 1]), Pose([0.2, 0, 1.5 - 2 * DEPTH]))
    return Assembly([base, low, high], friction=0.5, **more)


def opened(page: Page, folder: Path, assembly: Assembly, name: str) -> Message:
    """Open an assembly in the workbench; return its answer."""
    kilter.dump(assembly, folder / name)
    assert page.say(do="open", file=name)["ok"]
    return page.answer()


def settle(page: Page) -> Message:
    """Settle the parts, and wait for the complete answer, or for the refusal."""
    state = page.last["session"]["state"]
    assert page.say(do="settle")["ok"]
    ended = page.hear(
        lambda m: (m.get("is") == "session" and m["state"] > state) or m.get("is") == "tab"
    )
    return ended if ended["is"] == "tab" else page.answer()


def without_seconds(text: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(text)
    del data["seconds"]
    return data


def exported(bench: Workbench) -> dict[str, Any]:
    """The answer of the present state, as the page downloads it."""
    address = f"http://127.0.0.1:{bench.port}/export/answer.json?token={bench.token}"
    with urllib.request.urlopen(address, timeout=60) as answer:
        return without_seconds(answer.read())


@pytest.mark.slow
def test_the_settled_state_is_saved_and_repeated_by_the_command(
    page, bench, folder, monkeypatch, capsys
):
    drawn = opened(page, folder, sunken(), "sunken.kilter.json")
    assert drawn["check"]["verdict"] == "undecided"
    assert drawn["settle"] == {"parts": "2 overlapping pairs"}
    answer = settle(page)
    assert answer["check"]["verdict"] == "stable"
    assert answer["settle"] is None
    poses = page.last["session"]["choices"]["poses"]
    assert poses["low"]["position"] == pytest.approx([0, 0, 0.5], abs=1e-8)
    assert poses["high"]["position"] == pytest.approx([0.2, 0, 1.5], abs=1e-8)
    assert page.last["session"]["command_needs_save"]
    page.say(do="save")
    shown = exported(bench)
    monkeypatch.chdir(folder)
    capsys.readouterr()
    assert main([*shlex.split(page.last["session"]["command"])[1:], "--json"]) == 0
    assert without_seconds(capsys.readouterr().out) == shown


@pytest.mark.slow
def test_the_movement_is_undone_redone_restored_and_shown_by_a_second_page(page, bench, folder):
    drawn = opened(page, folder, sunken(), "twice.kilter.json")
    before = page.last["session"]["choices"]
    at_rest = settle(page)
    moved = page.last["session"]["choices"]
    other = Page(bench)
    other.hear(lambda m: m.get("is") == "answer")
    assert other.last["session"]["choices"] == moved
    assert other.last["answer"]["check"] == at_rest["check"]
    other.close()
    assert page.after(do="undo")["check"] == drawn["check"]
    assert page.last["session"]["choices"] == before
    assert page.after(do="redo")["check"] == at_rest["check"]
    assert page.last["session"]["choices"] == moved
    # the changes are kept in a file: the reopened file has them
    page.say(do="close")
    page.say(do="open", file="twice.kilter.json")
    assert page.answer()["check"] == at_rest["check"]
    assert page.last["session"]["choices"] == moved
    assert page.after(do="poses", poses=None)["check"] == drawn["check"]
    assert "poses" not in page.last["session"]["choices"]


@pytest.mark.slow
def test_a_load_of_the_choices_moves_with_its_part(page, folder):
    opened(page, folder, sunken(), "loaded.kilter.json")
    tip = [0.2, 0, 2 - 2 * DEPTH]
    page.after(do="load", part="high", force=[0, 0, -1], point=tip)
    page.after(do="load", part="high", force=[0, 0, -2])
    assert settle(page)["check"]["verdict"] == "stable"
    first, second = page.last["session"]["choices"]["loads"]
    assert first["point"] == pytest.approx([0.2, 0, 2], abs=1e-8)
    assert "point" not in second
    page.after(do="undo")
    assert page.last["session"]["choices"]["loads"][0]["point"] == tip


REFUSED = {
    "does not fit": (
        Assembly(
            [
                Part("left", Box([1, 1, 1]), Pose([-1, 0, 0.5]), grounded=True),
                Part("right", Box([1, 1, 1]), Pose([1, 0, 0.5]), grounded=True),
                Part("wedged", Box([1.001, 1, 1]), Pose([0, 0, 0.5])),
            ]
        ),
        "do not fit",
    ),
    "at rest": (
        sunken().with_poses({"low": Pose([0, 0, 0.5]), "high": Pose([0.2, 0, 1.5])}),
        "at rest as drawn",
    ),
    "load of the file": (
        sunken(loads=[Load("high", [0, 0, -1], point=[0.2, 0, 2 - 2 * DEPTH])]),
        "the loads of the file move",
    ),
    "joint of the file": (
        sunken(joints=[Joint(["low", "ground"], "prismatic", [0, 0, 0.5], [0, 0, 1])]),
        "the joints of the file move",
    ),
}  # fmt: skip


@pytest.mark.quick("does not fit")
@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_is_a_sentence_and_changes_nothing(name, page, folder):
    assembly, said = REFUSED[name]
    opened(page, folder, assembly, "refused.kilter.json")
    before = page.last["session"]["state"]
    reply = settle(page)
    assert (reply["is"], reply["name"]) == ("tab", "settle")
    assert said in reply["error"]
    assert page.last["session"]["state"] == before


@pytest.mark.slow
def test_another_change_and_a_stop_end_the_search(page, folder):
    wall = wall_of(300)
    lifted = {part.name: Pose(part.pose.position * [1, 1, 1 + DEPTH]) for part in wall.parts[1:]}
    opened(page, folder, wall.with_poses(lifted), "wall.kilter.json")
    assert page.say(do="settle")["ok"]
    page.hear(lambda m: m.get("is") == "progress" and m["what"] == "settle" and m["working"])
    assert page.say(do="stop")["ok"]
    stopped = page.hear(lambda m: m.get("is") == "tab")
    assert (stopped["name"], stopped["error"]) == ("settle", "the computation was stopped")
    assert page.say(do="settle")["ok"]
    assert page.after(do="friction", mu=0.6)["is"] == "answer"
    assert set(page.last["session"]["choices"]) == {"kilter", "file", "sha256", "friction"}


@pytest.mark.slow
def test_poses_do_not_fit_another_content_of_the_file(page, folder):
    opened(page, folder, sunken(), "changed.kilter.json")
    page.after(do="friction", mu=0.7)
    settle(page)
    wide = sunken().with_poses({"base": Pose([0, 0, -0.7])})
    kilter.dump(wide, folder / "changed.kilter.json")
    page.hear(lambda m: m.get("is") == "session" and "was read again" in m["message"])
    session = page.last["session"]
    assert session["message"].endswith(
        "these changes do not fit any more: settle: parts move by up to 0.002 m"
    )
    assert session["choices"]["friction"] == 0.7
    assert "poses" not in session["choices"]
