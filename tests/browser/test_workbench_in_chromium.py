"""The workbench in a real browser: each control does its action, and the command repeats it."""

import base64
import json
import shlex
import shutil
from pathlib import Path

import pytest
import trimesh
from test_tools_in_chromium import AXE, spot, violations
from workbench_page import WorkbenchPage, loaded

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.cli import main
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.workbench import uploads

pytestmark = pytest.mark.browser

AS1 = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if" / "as1-oc-214.stp"
FOCUSED = "document.activeElement.textContent"
HOSTILE = "<img src=x onerror=window.hit=1>"


def test_figure_8_is_decided_by_clicks_and_by_keys(user, capsys, monkeypatch):
    page = user("paper-figure-8")
    assert page.text("verdict") == "Unstable"
    box = page.page.locator("#picture")
    box.click(position={"x": 5, "y": 5})
    page.page.mouse.click(*spot(page, 2, [0.2, -0.5, 0.2]))
    assert page.text("part-name") == "C3"
    page.click("#do-hold")
    assert page.choices()["held"] == ["C3"]
    assert (
        page.command_agrees(capsys, monkeypatch)["verdict"]
        == kilter.check(scene("paper-figure-8").with_grounded(["C3"])).verdict
    )
    # the same with keys alone
    page.after(lambda: page.press("Control+z"))
    assert "held" not in page.choices()
    page.page.focus("body")
    page.tab_to("#find")
    page.page.keyboard.type("C2")
    page.press("Enter")
    page.tab_to("#do-hold")
    page.after(lambda: page.press("Enter"))
    assert page.choices()["held"] == ["C2"]
    page.command_agrees(capsys, monkeypatch)
    assert page.text("do-hold") == "Release"


def test_as1_from_the_drop_to_a_saved_stable_state(user, folder, capsys):
    if not AS1.is_file():
        pytest.skip("real data is not here: ../shared/data beside the checkout")
    pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
    page = user(None)
    drop = (
        "([name, text]) => { const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));"
        " const data = new DataTransfer(); data.items.add(new File([bytes], name));"
        " document.getElementById('drop').dispatchEvent("
        "new DragEvent('drop', {dataTransfer: data, bubbles: true})); }"
    )
    text = base64.b64encode(AS1.read_bytes()).decode()
    page.after(lambda: page.js(drop, [AS1.name, text]))
    assert page.text("verdict") == "Unstable"  # on an assumed floor
    page.choose("floor")
    assert page.text("hold-note").startswith("A floor is assumed")
    page.page.fill("#find", "plate")
    page.page.press("#find", "Enter")
    page.click("#do-hold")
    assert page.text("verdict") == "Unstable"
    page.click("text=Join all of them")
    page.enter("friction-number", "0.3")
    assert page.text("verdict") == "Stable"
    with page.page.expect_download() as download:
        page.page.click("#save")
    download.value.save_as(folder / "as1-oc-214.kilter.json")
    shutil.copy(AS1, folder / AS1.name)
    capsys.readouterr()
    main(["check", str(folder / "as1-oc-214.kilter.json"), "--json"])
    by_file = json.loads(capsys.readouterr().out)
    options = ["--ground", "plate", "--fasten-suggested", "--friction", "0.3", "--json"]
    main(["check", str(folder / AS1.name), *options])
    by_options = json.loads(capsys.readouterr().out)
    for answer in (by_file, by_options):
        answer.pop("seconds", None)
    assert by_file["verdict"] == "stable"
    assert by_file["parts"] == by_options["parts"]
    # opened again from the folder: all choices are there
    page.page.reload()
    page.begin().answered()
    page.page.click("#open-file")
    page.until("document.querySelectorAll('#listed button').length > 1")
    page.after(lambda: page.page.click("#listed button:has-text('as1-oc-214.kilter.json')"))
    choices = page.choices()
    assert (choices["held"], choices["friction"]) == (["plate"], 0.3)
    assert choices["fasten_suggested"] is True
    assert page.text("verdict") == "Stable"


def test_a_motion_that_only_the_complete_answer_finds_is_visible_at_first(user, folder):
    if not AS1.is_file():
        pytest.skip("real data is not here: ../shared/data beside the checkout")
    pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
    page = user(None)
    shutil.copy(AS1, folder / "file.stp")
    choices = {"kilter": 1, "file": "file.stp", "held": ["plate"], "friction": 0.3}
    (folder / "file.kilter.json").write_text(json.dumps(choices))
    page.act({"do": "open", "file": "file.kilter.json"})
    assert page.text("verdict") == "Potentially stable"
    # the nuts below the plate move; they are seen through the other parts
    assert float(page.page.input_value("#see-through")) > 0


def test_a_chosen_folder_of_meshes_is_sent_and_opened(user, tmp_path):
    page = user(None)
    (tmp_path / "parts").mkdir()
    for name, size, height in (("base", 4, 0.5), ("cube", 1, 1.5)):
        box = trimesh.creation.box([size, size, 1])
        box.apply_translation([0, 0, height])
        box.export(tmp_path / "parts" / f"{name}.stl")
    page.after(lambda: page.page.set_input_files("#folder", tmp_path / "parts"))
    assert page.js("window.kilter.page.parts.full_names") == ["base", "cube", "floor"]
    assert page.text("verdict") == "Stable"  # on an assumed floor
    page.click("#floor")
    assert page.text("verdict") == "Stable"


def test_as1_with_keys_alone(user, folder):
    if not AS1.is_file():
        pytest.skip("real data is not here: ../shared/data beside the checkout")
    pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
    page = user(None)
    shutil.copy(AS1, folder / AS1.name)
    page.page.reload()
    page.begin().tab_to("#listed button")
    page.after(lambda: page.press("Enter"))
    page.tab_to("#find")
    page.page.keyboard.type("plate")
    page.press("Enter")
    page.tab_to("#do-hold")
    page.after(lambda: page.press("Enter"))
    page.tab_to("#suggestions button:not(.link)")
    page.after(lambda: page.press(" "))
    page.tab_to("#panel-list [aria-selected='true']").press("ArrowRight", "ArrowRight", "Enter")
    page.tab_to("#friction-number")
    page.page.keyboard.type("0.3")
    page.after(lambda: page.press("Enter"))
    assert page.text("verdict") == "Stable"
    page.press("Control+s")
    page.until("!window.bench.session.dirty")
    assert kilter.check(kilter.load(folder / "as1-oc-214.kilter.json")).verdict == "stable"
    # opened again with keys alone, from another example in between: all choices are there
    saved = page.choices()
    for listed in ("#examples button", "#listed button"):
        page.page.focus("body")
        page.tab_to("#open-file").press("Enter")
        if listed == "#examples button":
            page.tab_to("#examples-title").press("Enter")
        page.tab_to(listed)
        while listed == "#listed button" and page.js(FOCUSED) != "as1-oc-214.kilter.json":
            page.press("Tab").tab_to(listed)
        page.after(lambda: page.press("Enter"))
    assert page.choices() == saved
    assert page.page.input_value("#friction-number") == "0.3"
    assert page.text("verdict") == "Stable"


def test_the_phase_is_stated_and_an_analysis_is_stopped(user):
    page = user(wall_of(1000))
    # in one turn of the page: no answer of the server comes between
    level, busy = page.js(
        "(() => { const b = window.bench; b.hear({...b.answer, phase: 'equilibrium'});"
        " return [document.getElementById('level').textContent,"
        " document.getElementById('banner').getAttribute('aria-busy')]; })()"
    )
    assert level == "equilibrium; the complete answer is being computed"
    assert busy == "true"
    page.page.click("#tab-plan")
    page.until("window.bench.tabs.asked.size && !document.getElementById('progress').hidden")
    # at once: a click of the mouse waits until the page of 1,000 bricks is still
    page.js(
        "[...document.querySelectorAll('#sheet-controls button')]"
        ".find((each) => each.textContent.includes('Stop')).click()"
    )
    page.until("!window.bench.tabs.asked.size")
    assert page.plan_was_stopped()
    page.js("window.kilter.select(5)")
    page.click("#do-hold")


def overhang() -> Assembly:
    """A plank that extends .3 beyond the edge of a table at x = 0."""
    table = Part("table", Box([2, 1, 1]), Pose([-1, 0, -0.5]), grounded=True)
    return Assembly([table, Part("plank", Box([1, 1, 0.1]), Pose([-0.2, 0, 0.05]), mass=2)])


def test_the_box_to_place_follows_the_pointer_and_shows_whether_it_stands(user):
    page = user(overhang(), viewport={"width": 1400, "height": 900})
    page.page.click("#tab-place")
    page.page.fill("#place-size", "0.2 0.2 0.1")
    page.page.fill("#place-mass", "4")
    page.page.press("#place-mass", "Enter")
    page.until("!window.bench.tabs.asked.size && window.bench.tabs.results.has('place')", 60)
    assert page.text("sheet-error") == ""
    assert page.text("tab-command").endswith("place file.kilter.json --box 0.2x0.2x0.1 --mass 4")

    page.page.wait_for_timeout(300)
    asked = len(page.asked)
    page.js(
        "(() => { window.sent = []; const { link } = window.bench;"
        " const send = link.send.bind(link);"
        " link.send = (action) => { window.sent.push(action); return send(action); }; })()"
    )
    page.page.locator("#picture").scroll_into_view_if_needed()
    seen = []
    # the heaviest reach of 4 kg is W (L/2 - e) / w = .1
    for x in (-0.3, 0.04, 0.16, 0.25):
        spot_ = page.js(
            "([x, y, z]) => { const { stage, page } = window.kilter;"
            " const box = stage.canvas.getBoundingClientRect();"
            " const at = stage.onScreen([x, y, z].map((c, k) => c - page.center[k]));"
            " return [box.left + at[0], box.top + at[1]]; }",
            [x, -0.1, 0.1],
        )
        page.page.mouse.move(*spot_)
        page.until("document.getElementById('place-state').textContent.startsWith('x ')")
        seen.append(page.js("document.getElementById('place-state').dataset.state"))
        assert page.js("window.kilter.stage.places.part.visible")
    part = kilter.box_to_place([0.2, 0.2, 0.1], 4)
    verdicts = [
        kilter.place(overhang(), part, at=[x, -0.1]).at.verdict for x in (-0.3, 0.04, 0.16, 0.25)
    ]
    assert [state == "stands" for state in seen] == [word == "stable" for word in verdicts]
    assert seen == ["stands", "stands", "falls", "falls"]
    assert (page.js("window.sent"), len(page.asked)) == ([], asked)
    shown = page.drawn()
    page.page.click("#tab-place")  # the closed tab shows no map
    assert page.drawn() != shown
    assert not page.js("window.kilter.stage.places.group.visible")


def test_the_friction_slider_changes_the_verdict_of_the_arch_at_its_limit(user):
    page = user("arch")
    # the slider begins at the friction of the file
    assert page.page.input_value("#friction") == "0.7"
    assert page.page.get_attribute("#friction-number", "placeholder") == "0.7"
    page.page.focus("#friction")
    for mu, held in ((0.7, True), (0.36, True), (0.35, False), (0.3, False)):
        page.after(lambda mu=mu: page.slide("friction", mu))  # type: ignore[misc]
        page.until(f"window.bench.session.choices.friction === {mu}")
        page.answered()
        assert (page.text("verdict") in ("Stable", "Settles", "Potentially stable")) == held, mu
    # a drag is a single change
    assert page.js("window.bench.session.changes.length") == 1
    for mu, held in (("0.3514", True), ("0.3512", False)):
        page.enter("friction-number", mu)
        assert (page.text("verdict") != "Unstable") == held
    page.click("#friction-file")
    assert "friction" not in page.choices()
    assert page.page.input_value("#friction") == "0.7"


def test_each_action_on_parts_is_done_and_repeated_by_the_command(user, capsys, monkeypatch):
    page = user(loaded())
    agrees = lambda: page.command_agrees(capsys, monkeypatch)  # noqa: E731
    page.choose("high").click("#do-leave-out")
    assert page.choices()["left_out"] == ["high"]
    assert page.js("document.activeElement.getAttribute('role')") == "treeitem"
    assert [part["name"] for part in agrees()["parts"]] == ["base", "low", "side"]
    page.click("#left-out button")
    assert "left_out" not in page.choices()
    page.choose("low")
    page.after(lambda: page.page.select_option("#do-material", "steel"))
    assert page.choices()["materials"][0]["density"] == 7850
    assert agrees()["parts"][1]["mass"] == pytest.approx(7850)
    page.choose("low").enter("do-density", "1200")
    assert "1200 kg" in page.text("part-facts")
    page.choose("low").enter("do-mass", "55")
    assert "55 kg" in page.text("part-facts")
    page.choose("high").enter("do-load", "200 0 0")
    assert page.choices()["loads"] == [{"part": "high", "force": [200, 0, 0]}]
    assert agrees()["verdict"] == "stable"
    assert page.page.is_visible("#load-key")
    page.page.click("#loads button:has-text('Edit')")
    page.enter("do-load", "9000 0 0")
    assert page.choices()["loads"] == [{"part": "high", "force": [9000, 0, 0]}]
    assert agrees()["verdict"] == "unstable"
    page.after(
        lambda: page.page.locator("#scale-loads").evaluate(
            "e => { e.value = -1; e.dispatchEvent(new Event('change')); }"
        )
    )
    assert page.choices()["loads"][0]["force"] == [900, 0, 0]
    # the tip of the arrow is dragged, in the plane of the screen
    page.js("window.kilter.stage.view([0, -1, 0])")
    page.js("window.kilter.stage.render()")
    x, y = page.js(
        "(() => { const k = window.kilter; const at = k.stage.parts.placeOf(k.page.loads[0].part);"
        " at[0] += k.loadScale() * 900; return k.stage.onScreen(at); })()"
    )
    box = page.page.locator("#picture").bounding_box()
    mouse = page.page.mouse
    mouse.move(box["x"] + x, box["y"] + y)
    mouse.down()
    mouse.move(box["x"] + x, box["y"] + y + 60, steps=3)
    page.after(mouse.up)
    force = page.choices()["loads"][0]["force"]
    assert force[0] == pytest.approx(900, rel=0.05)
    assert force[2] < -100
    assert abs(force[1]) < 1
    page.click("#loads button:has-text('Remove')")
    assert "loads" not in page.choices()


def test_each_action_on_a_pair_is_done_and_repeated_by_the_command(user, capsys, monkeypatch):
    page = user(loaded())
    agrees = lambda: page.command_agrees(capsys, monkeypatch)  # noqa: E731
    page.choose("low").tab_to("#tree [tabindex='0']")
    assert not page.page.is_visible("#pair-actions")
    pair = ("low", "high")
    page.choose(*pair).click("#do-join")
    assert page.choices()["joined"] == [list(pair)]
    assert agrees()["verdict"] == "stable"
    page.click("#joined button")
    page.choose(*pair).enter("do-pair-friction", "0.1")
    assert page.choices()["friction_pairs"] == [{"parts": list(pair), "mu": 0.1}]
    agrees()
    page.click("#joined button")
    page.choose(*pair).enter("do-bond", "50")
    assert page.choices()["bonds"][0]["pull"] == 50
    agrees()
    page.click("#joined button")
    page.choose(*pair)
    page.page.select_option("#do-joint", "revolute")
    assert len(page.page.input_value("#joint-point").split()) == 3  # middle of the contact
    page.page.fill("#joint-axis", "0 1 0")
    page.click("#joint-form button")
    assert page.choices()["joints"][0]["axis"] == [0, 1, 0]
    agrees()
    page.click("#joined button")
    for button, state in (("#do-touching", "touching"), ("#do-apart", "apart")):
        page.choose(*pair).click(button)
        assert page.choices()["open_pairs"] == [{"parts": list(pair), "as": state}]
    agrees()
    page.choose(*pair).click("#do-undecided")
    assert "open_pairs" not in page.choices()
    # a wrong number is a sentence, and no change
    page.page.fill("#do-bond", "much")
    page.page.press("#do-bond", "Enter")
    assert page.text("trouble-words") == "Give a number."


def test_open_pairs_are_shown_and_settled(user, capsys, monkeypatch):
    base = Part("base", Box([6, 6, 1]), Pose([0, 0, -0.5]), grounded=True)
    leg = Part("leg", Box([1, 1, 2]), Pose([2, 0, 1]))
    lid = Part("lid", Box([1, 1, 1]), Pose([2, 0, 2.4]))  # overlaps the leg by 0.1
    page = user(Assembly([base, leg, lid]))
    assert "leg" in page.text("open-pairs")
    page.page.click("#open-pairs button.link")
    assert page.js("[...window.kilter.selection]") == [1, 2]
    page.click("#open-pairs button:has-text('Join')")
    assert page.choices()["open_pairs"] == [{"parts": ["leg", "lid"], "as": "joined"}]
    assert page.command_agrees(capsys, monkeypatch)["verdict"] == "stable"
    assert not page.page.is_visible("#decide")


def test_undo_redo_revert_go_back_and_compare(user):
    page = user(loaded())
    assert not page.page.is_visible("#undo")
    page.enter("friction-number", "0.2")
    page.choose("side").click("#do-hold")
    page.page.click("#tab-changes")
    assert "2. hold side" in page.text("sheet-body")
    page.click("#undo")
    assert "held" not in page.choices()
    page.click("#redo")
    assert page.choices()["held"] == ["side"]
    page.click("#sheet-body button:has-text('Revert')")
    assert "friction" not in page.choices()
    assert page.choices()["held"] == ["side"]
    page.click("#sheet-body button:has-text('Go back to here')")
    assert "held" not in page.choices()
    page.enter("friction-number", "0.4")
    page.page.click("#tab-compare")
    page.page.click("#sheet-controls button:has-text('Compare')")
    page.until("window.bench.tabs.results.has('compare')")
    assert "Both states are" in page.text("sheet-body")


def test_analyses_are_tabs_with_their_command(user, capsys, monkeypatch):
    page = user(loaded())
    monkeypatch.chdir(page.folder)
    for name in ("orient", "margin", "plan", "hold", "contacts"):
        page.page.click(f"#tab-{name}")
        page.until(f"window.bench.tabs.results.has('{name}')", 60)
        words = shlex.split(page.text("tab-command"))
        capsys.readouterr()
        main([*words[1:], "--json"])
        data = page.js("n => window.bench.tabs.results.get(n).data", name)
        told = json.loads(capsys.readouterr().out)
        for key in ("verdict", "sentence", "down", "tilt_deg", "steps", "supports", "patches"):
            assert data.get(key) == told.get(key), (name, key)
    page.page.click("#tab-transport")
    page.page.fill("#sheet-controls input", "20 0 0")
    page.page.click("text=At this acceleration")
    page.until("window.bench.tabs.results.has('transport')", 60)
    assert "--accelerate 20 0 0" in page.text("tab-command")
    # a change makes the results old: they disappear
    page.enter("friction-number", "0.3")
    assert page.js("window.bench.tabs.results.size") == 0
    page.page.click("#tab-orient")
    page.until("window.bench.tabs.results.has('orient')", 60)
    page.page.click("text=Show this direction")
    page.click("text=Use this direction")
    assert len(page.choices()["gravity"]) == 3


def test_floor_axis_and_gravity(user, capsys, monkeypatch):
    page = user(loaded())
    page.click("#floor")
    assert page.choices()["floor"] is True
    page.command_agrees(capsys, monkeypatch)
    page.click("#floor")
    page.after(lambda: page.page.select_option("#up", "x"))
    assert page.choices()["up"] == "x"
    assert page.down() == pytest.approx([-1, 0, 0])
    page.command_agrees(capsys, monkeypatch)
    page.after(lambda: page.page.select_option("#up", ""))
    page.until("window.kilter.page.region !== null")  # the ball is coloured
    page.js("window.kilter.ask([0.6, 0, -0.8])")
    page.click("#use-gravity")
    assert page.down() == pytest.approx([0.6, 0, -0.8])
    page.command_agrees(capsys, monkeypatch)


def test_an_old_answer_is_dropped_and_a_lost_connection_returns(user):
    page = user(loaded())
    before = page.page.inner_text("#banner")
    page.js(
        "(() => { const b = window.bench; b.hear({...b.answer, state: b.answer.state - 1,"
        " given: {...b.answer.given, verdict: 'unstable'}}); })()"
    )
    assert page.page.inner_text("#banner") == before
    page.page.evaluate("window.bench.link.socket.close()")
    page.until("!document.getElementById('connection').hidden")
    assert "is lost" in page.text("connection")
    page.until("document.getElementById('connection').hidden")
    page.choose("low").click("#do-hold")
    # a page that is loaded again, and a second page, show the same state
    page.page.reload()
    page.begin().answered()
    assert page.choices()["held"] == ["low"]


def test_the_view_and_the_selection_stay_when_the_assembly_changes(user):
    page = user(loaded())
    page.choose("high")
    page.page.click("#hide")
    page.choose("side")
    page.js("window.kilter.stage.orbit(0.4, 0.1, 0.8)")
    view = "window.kilter.stage.camera.position.clone().sub(window.kilter.stage.controls.target)"
    before = page.js(f"{view}.normalize().toArray()")
    page.click("#do-hold")
    page.choose("low").click("#do-leave-out")
    assert page.js(f"{view}.normalize().toArray()") == pytest.approx(before, abs=1e-6)
    parts = "window.kilter.page.parts.full_names"
    gone = f"{parts}.filter((_, k) => !window.kilter.stage.parts.visible[k])"
    assert page.js(gone) == ["high"]


def test_wrong_huge_changed_and_removed_files_are_sentences(user, folder, monkeypatch):
    page = user(loaded())
    (folder / "wrong.kilter.json").write_text('{"kilter": 1, "parts": 3}')
    files = [{"name": "text.stp", "mimeType": "text/plain", "buffer": b"no STEP"}]
    page.page.click("#open-file")
    page.page.set_input_files("#files", files=files)
    page.until("!document.getElementById('trouble').hidden")
    assert "text.stp" in page.text("trouble-words") or "STEP" in page.text("trouble-words")
    page.page.click("#end-trouble")
    monkeypatch.setattr(uploads, "MOST_BYTES", 3)
    page.page.set_input_files("#files", files=files)
    page.until("!document.getElementById('trouble').hidden")
    assert "larger than" in page.text("trouble-words")
    page.page.click("#end-start")
    assert page.js("window.bench.session.file") == "file.kilter.json"
    page.choose("side").click("#do-hold")
    higher = Assembly([*loaded().parts, Part("new", Box([1, 1, 1]), Pose([-2, 0, 0.5]))])
    page.after(lambda: kilter.dump(higher, folder / "file.kilter.json"))
    page.until("window.kilter.page.parts.full_names.includes('new')")
    page.until("!document.getElementById('message').hidden")
    assert page.choices()["held"] == ["side"]
    (folder / "file.kilter.json").unlink()
    page.until("/removed/.test(document.getElementById('message').textContent)")
    assert page.js("document.getElementById('show').hidden") is False


def test_a_name_with_markup_is_text(user, capsys, monkeypatch):
    base = Part("base", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    page = user(Assembly([base, Part(HOSTILE, Box([1, 1, 1]), Pose([0, 0, 0.5]))]))
    page.choose(HOSTILE).click("#do-hold")
    assert page.choices()["held"] == [HOSTILE]
    page.command_agrees(capsys, monkeypatch)
    page.page.click("#tab-changes")
    assert HOSTILE in page.text("sheet-body")
    page.page.click("#tab-contacts")
    page.until("window.bench.tabs.results.has('contacts')")
    assert page.js("document.querySelectorAll('img').length") == 0
    assert page.js("window.hit") is None


def test_exports_are_downloaded_and_a_refusal_is_a_sentence(user, tmp_path):
    page = user(loaded())
    for name in ("report.html", "answer.json", "contacts.csv", "choices.kilter.json"):
        with page.page.expect_download() as download:
            page.page.select_option("#export", name)
        assert download.value.suggested_filename == name
        download.value.save_as(tmp_path / name)
    assert "Stable" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "answer.json").read_text())["verdict"] == "stable"


def test_two_pages_of_a_session_agree(user, chromium, bench):
    page = user(loaded())
    other = WorkbenchPage(chromium.new_page(), bench, page.folder).begin().answered()
    page.choose("low").click("#do-hold")
    other.until("(window.bench.session.choices.held || []).includes('low')")
    other.answered()
    assert other.page.inner_text("#banner") == page.page.inner_text("#banner")
    other.page.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [400, 1360])
def test_axe_finds_no_serious_violation(width, scheme, user):
    if not AXE.is_file():
        pytest.skip("axe-core is not here: npm ci in web/")
    page = user(None, color_scheme=scheme, viewport={"width": width, "height": 900})
    assert violations(page.page) == []
    kilter.dump(loaded(), page.folder / "file.kilter.json")
    page.page.reload()
    page.begin()
    page.after(lambda: page.page.click("#listed button"))
    page.choose("low", "high")
    for name in ("margin", "helps"):
        page.js("name => document.getElementById(`tab-${name}`).click()", name)
        page.until(f"window.bench.tabs.results.has('{name}')", 60)
        if name == "helps":
            page.page.locator("#sheet-body [data-change]").first.click()
        assert violations(page.page) == []
        assert page.js("document.documentElement.scrollWidth") <= width
