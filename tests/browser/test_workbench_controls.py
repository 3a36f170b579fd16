"""Each control of the workbench has a test: a table names it, and the page is compared with it."""

import ast
import json
import re
import shlex
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from test_what_helps import stack
from workbench_page import DESK, FLOATS, WorkbenchPage, desk_page, loaded

import kilter
from kilter import Assembly, Bond, Box, Joint, Part, Pose
from kilter.cli import main
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.workbench.history import remember_file

pytestmark = pytest.mark.browser

HERE = Path(__file__).parent
CLIPBOARD = ["clipboard-read", "clipboard-write"]


def two_open_pairs() -> Assembly:
    """Two legs, each with a lid that overlaps it by a tenth, on a held base."""
    parts = [Part("base", Box([6, 6, 1]), Pose([0, 0, -0.5]), grounded=True)]
    for k, x in enumerate((-2, 2), start=1):
        parts.append(Part(f"leg-{k}", Box([1, 1, 2]), Pose([x, 0, 1])))
        parts.append(Part(f"lid-{k}", Box([1, 1, 1]), Pose([x, 0, 2.4])))
    return Assembly(parts)


def tab(page: WorkbenchPage, name: str) -> None:
    """Open a tab and wait for its result."""
    page.page.click(f"#tab-{name}")
    page.until(f"window.bench.tabs.results.has('{name}')", 60)


def press(page: WorkbenchPage, label: str, name: str) -> None:
    """Press a button of an open tab and wait for the new result."""
    page.page.click(f"#sheet-controls button:has-text('{label}')")
    page.until(f"!window.bench.tabs.asked.size && window.bench.tabs.results.has('{name}')", 60)


def tab_agrees(page: WorkbenchPage, name: str, capsys: Any, monkeypatch: Any) -> dict[str, Any]:
    """Run the command of a tab, and compare its whole answer with that of the page."""
    shown: dict[str, Any] = page.js("n => window.bench.tabs.results.get(n).data", name)
    monkeypatch.chdir(page.folder)
    capsys.readouterr()
    main([*shlex.split(page.text("tab-command"))[1:], "--json"])
    printed = json.loads(capsys.readouterr().out)
    assert without_times(printed) == without_times(shown)
    return shown


def without_times(data: Any) -> Any:
    """JSON data without durations, which differ from run to run."""
    if isinstance(data, dict):
        return {key: without_times(value) for key, value in data.items() if key != "seconds"}
    return [without_times(value) for value in data] if isinstance(data, list) else data


def test_a_material_is_chosen_and_taken_back(user, capsys, monkeypatch):
    page = user(loaded())
    page.choose("low", "side")
    page.after(lambda: page.page.select_option("#do-material", "oak"))
    assert [one["name"] for one in page.choices()["materials"]] == ["oak", "oak"]
    changed = page.command_agrees(capsys, monkeypatch)["parts"][1]["mass"]
    page.after(lambda: page.page.select_option("#do-material", "file"))  # as in the file
    assert "materials" not in page.choices()
    assert page.command_agrees(capsys, monkeypatch)["parts"][1]["mass"] != changed
    assert page.page.input_value("#do-material") == ""


def test_open_pairs_are_settled_one_by_one_and_all_together(user, capsys, monkeypatch):
    page = user(two_open_pairs())
    pairs = [["leg-1", "lid-1"], ["leg-2", "lid-2"]]
    for label, as_ in (
        ("All of them touch", "touching"),
        ("are apart", "apart"),
        ("are joined", "joined"),
    ):
        page.click(f"#open-pairs > button:has-text('{label}')")
        assert page.choices()["open_pairs"] == [{"parts": pair, "as": as_} for pair in pairs]
        page.command_agrees(capsys, monkeypatch)
        page.click("#undo")
    for label, as_ in (("Touch", "touching"), ("Apart", "apart"), ("Join", "joined")):
        page.click(f"#open-pairs li button:text-is('{label}')")
        assert page.choices()["open_pairs"] == [{"parts": pairs[0], "as": as_}]
        page.command_agrees(capsys, monkeypatch)
        page.click("#joined button:has-text('Remove')")
        assert "open_pairs" not in page.choices()


def test_suggestions_are_joined_one_by_one_and_all_together(user, capsys, monkeypatch):
    page = user("cad-export")
    page.page.click("#suggestions button.link")
    names = "[...window.kilter.selection].map(k => window.kilter.page.parts.full_names[k])"
    assert sorted(page.js(names)) == ["post", "screw"]
    page.click("#suggestions li button:text-is('Join')")
    assert page.choices()["joined"] == [["screw", "post"]]
    page.command_agrees(capsys, monkeypatch)
    page.click("#undo")
    page.click("#suggestions > button:has-text('Join all of them')")
    assert page.choices()["fasten_suggested"] is True
    page.command_agrees(capsys, monkeypatch)
    page.click("#joined button:has-text('Remove')")
    assert "fasten_suggested" not in page.choices()


def test_the_parts_are_settled(user, capsys, monkeypatch):
    page = user(two_open_pairs())
    lids = "(z => [2, 4].map(k => z[3 * k + 2] - z[2]))(window.kilter.page.parts.position)"
    assert page.js(lids) == pytest.approx([2.9, 2.9], abs=1e-6)  # above the base
    assert "2 overlapping pairs" in page.text("settle")
    page.click("#settle button:has-text('Settle')")
    assert page.text("verdict") == "Stable"
    assert set(page.choices()["poses"]) == {"lid-1", "lid-2"}
    assert page.js(lids) == pytest.approx([3.0, 3.0], abs=1e-6)
    assert not page.page.query_selector("#settle button")
    page.command_agrees(capsys, monkeypatch)
    # undone and done again by keys
    page.after(lambda: page.press("Control+z"))
    assert page.js(lids) == pytest.approx([2.9, 2.9], abs=1e-6)
    assert page.text("verdict") == "Undecided"
    page.after(lambda: page.press("Control+y"))
    assert page.text("verdict") == "Stable"
    page.click("#joined button:has-text('Remove')")
    assert "poses" not in page.choices()
    assert page.text("verdict") == "Undecided"


def test_settling_is_stopped_or_refused_beside_its_button(user):
    wall = wall_of(300)
    above = {part.name: Pose(part.pose.position * [1, 1, 1.001]) for part in wall.parts[1:]}
    page = user(wall.with_poses(above))
    page.page.click("#settle button:has-text('Settle')")
    page.page.click("#settle button:has-text('Stop')")
    page.until("document.getElementById('settle').textContent.includes('stopped')")
    ends = [Part(f"end-{x}", Box([1, 1, 1]), Pose([x, 0, 0.5]), grounded=True) for x in (-1, 1)]
    page = user(Assembly([*ends, Part("wedged", Box([1.1, 1, 1]), Pose([0, 0, 0.5]))]))
    page.page.click("#settle button:has-text('Settle')")
    page.until("document.getElementById('settle').textContent.includes('do not fit')")
    assert page.page.is_visible("#settle button:has-text('Settle')")


def test_analyses_with_options_are_repeated_by_their_commands(user, capsys, monkeypatch):
    page = user(loaded(), permissions=CLIPBOARD)
    agrees = lambda name: tab_agrees(page, name, capsys, monkeypatch)  # noqa: E731
    page.page.click("#tab-transport")
    press(page, "Limits of all axes", "transport")
    assert len(agrees("transport")["limits"]) >= 6
    page.page.click("#sheet-controls button:has-text('By this rule')")
    assert page.text("trouble-words") == "Choose a rule."
    page.page.click("#end-trouble")
    page.page.select_option("#sheet-controls select", "en12195")
    page.page.click("#sheet-controls button:has-text('By this rule')")
    page.until("/--code/.test(document.getElementById('tab-command').textContent)", 60)
    assert agrees("transport")["cases"]
    page.page.fill("#sheet-controls input", "fast")
    page.page.click("#sheet-controls button:has-text('At this acceleration')")
    assert page.text("trouble-words").startswith("Give the acceleration")
    page.page.click("#end-trouble")
    tab(page, "margin")
    agrees("margin")
    press(page, "With the capacity of each part", "margin")
    assert "--loads" in page.text("tab-command")
    assert agrees("margin")["loads"]
    page.page.click("#copy-tab-command")
    assert page.js("navigator.clipboard.readText()") == page.text("tab-command")
    tab(page, "plan")
    assert agrees("plan")["found"]
    with page.page.expect_download() as download:
        page.page.click("#sheet-controls button:has-text('Save the page of the plan')")
    assert download.value.suggested_filename == "plan.html"
    for name in ("orient", "contacts"):
        tab(page, name)
        agrees(name)


def test_the_found_supports_are_held(user, capsys, monkeypatch):
    page = user("paper-figure-8")
    tab(page, "hold")
    found = tab_agrees(page, "hold", capsys, monkeypatch)
    grips = [one["part"] for one in found["supports"] if one["kind"] == "grip"]
    assert grips
    page.click("#sheet-controls button:has-text('Hold')")
    assert page.choices()["held"] == grips
    assert page.command_agrees(capsys, monkeypatch)["level"] is not None
    # an undone change is listed, and done again from the list
    page.page.click("#tab-changes")
    page.click("#undo")
    page.click("#sheet-body button:has-text('Redo')")
    assert page.choices()["held"] == grips


def test_a_computation_is_stopped_in_the_bar_and_started_again(user):
    page = user(wall_of(1000))
    page.page.click("#tab-plan")
    page.until("window.bench.tabs.asked.size && !document.getElementById('progress').hidden")
    page.js("document.getElementById('stop').click()")  # at once, however busy the page is
    page.until("!window.bench.tabs.asked.size")
    assert page.plan_was_stopped()
    page.page.click("#tab-contacts")
    page.until("window.bench.tabs.results.has('contacts')", 60)
    page.js("window.bench.tabs.results.clear()")
    page.js("window.bench.tabs.draw()")
    press(page, "Compute", "contacts")


def test_places_are_mapped_by_the_button(user, capsys, monkeypatch):
    page = user("tower")
    page.page.click("#tab-place")
    page.page.fill("#place-size", "small")
    page.page.click("#sheet-controls button:has-text('Map the places')")
    assert page.text("trouble-words").startswith("Give the size of the box")
    page.page.fill("#place-size", "0.5 0.5 0.5")
    page.page.fill("#place-mass", "2")
    press(page, "Map the places", "place")
    assert tab_agrees(page, "place", capsys, monkeypatch)["levels"]


def test_two_states_are_compared(user):
    page = user("arch")
    page.enter("friction-number", "0.3")
    page.enter("friction-number", "0.5")
    page.page.click("#tab-compare")
    page.page.select_option("#sheet-controls select >> nth=0", "1")
    page.page.select_option("#sheet-controls select >> nth=1", "2")
    press(page, "Compare", "compare")
    words = page.text("sheet-body")
    assert "Unstable" in words or "unstable" in words


def test_every_entry_of_the_lists_is_removed(user, capsys, monkeypatch):
    page = user(loaded())
    pair = ["low", "high"]
    actions: dict[str, dict[str, Any]] = {
        "joined": {"do": "fasten", "parts": pair, "on": True},
        "open_pairs": {"do": "pair", "pairs": [pair], "as": "touching"},
        "joints": {"do": "joint", "parts": ["low", "side"], "kind": "fixed"},
        "bonds": {"do": "bond", "parts": pair, "pull": 50},
        "friction_pairs": {"do": "pair_friction", "parts": pair, "mu": 0.2},
        "loose": {"do": "loose", "on": True},
        "fasten_overlaps": {"do": "fasten_overlaps", "on": True},
    }
    for key, action in actions.items():
        page.act(action)
        assert page.choices()[key]
        page.command_agrees(capsys, monkeypatch)
        page.click("#joined button:has-text('Remove')")
        assert key not in page.choices()


def test_the_notices_and_the_measuring_close_and_the_command_is_copied(user):
    page = user(loaded(), permissions=CLIPBOARD)
    page.page.click("#copy-command")
    assert page.js("navigator.clipboard.readText()") == page.text("command")
    page.page.click("#save")
    page.until("!document.getElementById('message').hidden")
    page.page.click("#end-message")
    assert not page.page.is_visible("#message")
    page.page.click("#measure")
    assert page.page.is_visible("#measured")
    page.page.click("#end-measure")
    assert not page.page.is_visible("#measured")
    assert page.page.get_attribute("#measure", "aria-pressed") == "false"


def test_found_parts_are_selected_and_brought_nearer(user):
    page = user(loaded())
    page.page.fill("#find", "*i*")  # side and high
    page.page.click("#select-found")
    names = "[...window.kilter.selection].map(k => window.kilter.page.parts.full_names[k])"
    assert sorted(page.js(names)) == ["high", "side"]
    distance = "window.kilter.stage.camera.position.distanceTo(window.kilter.stage.controls.target)"
    page.choose("high")
    before = page.js(distance)
    page.page.click("#zoom")
    assert page.js(distance) < before


def test_the_arrows_of_the_motion_are_switched_off(user):
    page = user("paper-figure-8")
    assert page.page.is_visible("#motion-key")
    page.page.uncheck("#show-motion")
    assert not page.page.is_visible("#motion-key")
    page.page.check("#show-motion")
    assert page.page.is_visible("#motion-key")


def test_a_workbench_is_switched_between_light_and_dark(user):
    page = user("tower")
    colour = "getComputedStyle(document.body).backgroundColor"
    before = page.js(colour)
    page.page.click("#theme")
    assert page.js(colour) != before


# the table ---------------------------------------------------------------------------------

PARTS = "test_each_action_on_parts_is_done_and_repeated_by_the_command"
PAIR = "test_each_action_on_a_pair_is_done_and_repeated_by_the_command"
SETTLED = "test_open_pairs_are_settled_one_by_one_and_all_together"
SUGGESTED = "test_suggestions_are_joined_one_by_one_and_all_together"
OPTIONS = "test_analyses_with_options_are_repeated_by_their_commands"
CHANGES = "test_undo_redo_revert_go_back_and_compare"
WRONG = "test_wrong_huge_changed_and_removed_files_are_sentences"
CLOSED = "test_the_notices_and_the_measuring_close_and_the_command_is_copied"
AS1 = "test_as1_from_the_drop_to_a_saved_stable_state"
CUTS = "test_three_planes_cut_and_show_the_inside"
STAGE = "test_the_motion_at_a_limit_is_on_the_stage"
HELP = "test_the_help_lists_the_keys_and_leads_around"
PANELS = "test_panels_are_switched_and_their_edges_move"
BAR = "test_the_bar_beside_a_part_acts_on_it"
FALL = "test_play_goes_to_the_end_and_the_mark_with_it"
SECTION = "test_section_see_through_contacts_and_force_size_change_the_picture"
SEARCH = "test_search_and_tree_select_hide_and_open_groups"
HIDDEN = "test_a_hidden_moving_part_is_seen_at_first"
BUTTONS = "test_buttons_go_to_the_given_the_recommended_and_the_nearest_direction"
PICKED = "test_a_part_is_picked_hidden_isolated_and_shown_again"
MEASURE = "test_two_clicks_measure_and_the_result_is_copied"
FRICTION = "test_the_friction_slider_changes_the_verdict_of_the_arch_at_its_limit"
FLOOR = "test_floor_axis_and_gravity"
VIEWS = "test_the_view_cube_and_keys_show_standard_views"
LADDER = "test_a_rung_is_chosen_by_click_by_row_and_by_key_as_one_change"
BLINK = "test_bodies_have_colours_and_loose_bodies_blink_once_and_are_selected"
TABS = "test_analyses_are_tabs_with_their_command"
PLACE = "test_places_are_mapped_by_the_button"
SUPPORTS = "test_a_support_moves_by_typed_numbers_as_in_python"
MOVED = "test_a_movement_of_supports_plays_with_its_hinges"
CONTROLS = {
    # the bar, the start page, the notices, the command
    "open-file": WRONG,
    "undo": CHANGES,
    "redo": CHANGES,
    "save": AS1,
    "export": "test_exports_are_downloaded_and_a_refusal_is_a_sentence",
    "theme": "test_a_workbench_is_switched_between_light_and_dark",
    "files": WRONG,
    "folder": "test_a_chosen_folder_of_meshes_is_sent_and_opened",
    "end-start": WRONG,
    "listed *": AS1,
    "examples *": "test_an_example_is_opened_from_the_start_page",
    "end-trouble": WRONG,
    "end-message": CLOSED,
    "copy-command": CLOSED,
    "stop": "test_a_computation_is_stopped_in_the_bar_and_started_again",
    # the picture
    "picture": "test_keys_turn_the_view",
    "cube": VIEWS,
    "home": VIEWS,
    "view": VIEWS,
    "measure": MEASURE,
    "copy-measured": MEASURE,
    "end-measure": CLOSED,
    # parts
    "find": SEARCH,
    "tree *": SEARCH,
    "select-found": "test_found_parts_are_selected_and_brought_nearer",
    "show-all": PICKED,
    "copy-name": "test_names_are_short_and_copied_in_full",
    "hide": PICKED,
    "isolate": SEARCH,
    "zoom": "test_found_parts_are_selected_and_brought_nearer",
    "do-hold": "test_figure_8_is_decided_by_clicks_and_by_keys",
    "do-leave-out": PARTS,
    "left-out Bring back": PARTS,
    "do-material": "test_a_material_is_chosen_and_taken_back",
    "do-density": PARTS,
    "density-form Set": "enter",
    "do-mass": PARTS,
    "mass-form Set": "enter",
    "do-load": PARTS,
    "load-form Add": "enter",
    "do-move": SUPPORTS,
    "move-form Move this support": "enter",
    # pairs
    "do-join": PAIR,
    "do-touching": PAIR,
    "do-apart": PAIR,
    "do-undecided": PAIR,
    "do-pair-friction": PAIR,
    "pair-friction-form Set": "enter",
    "do-bond": PAIR,
    "bond-form Add": "enter",
    "do-joint": PAIR,
    "joint-form Add": PAIR,
    "joint-point": PAIR,
    "joint-axis": PAIR,
    "joined Remove": "test_every_entry_of_the_lists_is_removed",
    # to decide
    **dict.fromkeys(("rung-drawn", "rung-play", "rung-fits", "rung-joined"), LADDER),
    "ladder *": LADDER,
    "loose-bodies *": BLINK,
    "bodies *": BLINK,
    "settle Settle": "test_the_parts_are_settled",
    "settle Stop": "test_settling_is_stopped_or_refused_beside_its_button",
    "suggestions *": SUGGESTED,
    "suggestions Join": SUGGESTED,
    "suggestions Join all of them": SUGGESTED,
    "open-pairs *": "test_open_pairs_are_shown_and_settled",
    "open-pairs Touch": SETTLED,
    "open-pairs Apart": SETTLED,
    "open-pairs Join": SETTLED,
    "open-pairs All of them touch": SETTLED,
    "open-pairs are apart": SETTLED,
    "open-pairs are joined": SETTLED,
    # friction, loads, gravity
    "friction": FRICTION,
    "friction-number": FRICTION,
    "friction-file": FRICTION,
    "scale-loads": PARTS,
    "loads Edit": PARTS,
    "loads Remove": PARTS,
    "floor": FLOOR,
    "up": FLOOR,
    "use-gravity": FLOOR,
    "ball": "test_the_arrow_keys_change_the_verdict_where_the_cone_says",
    "go-given": BUTTONS,
    "go-recommended": BUTTONS,
    "go-nearest": BUTTONS,
    # tabs
    **dict.fromkeys(("open-answer", "open-gravity", "open-forces", "open-display"), PANELS),
    **dict.fromkeys(("edge-left", "edge-right", "edge-sheet"), PANELS),
    "show-help": HELP,
    "help *": HELP,
    "selected-bar *": BAR,
    "tilt": "test_a_typed_tilt_is_judged_as_python_judges_it",
    "tilt-form Show": "enter",
    "limit-case": STAGE,
    **dict.fromkeys(
        (
            "strap-tension",
            "sheet-controls Place a strap",
            "sheet-controls Add the strap",
            "sheet-controls Cancel",
        ),
        "test_a_strap_is_placed_by_clicks",
    ),
    **dict.fromkeys(
        ("film-strip *", "sheet-controls Play", "sheet-controls Back", "sheet-controls Forward"),
        "test_the_film_of_an_order_is_on_the_stage",
    ),
    "tab-forces": "test_ranges_of_forces_are_those_of_python",
    "sheet-controls All pairs": "test_ranges_of_forces_are_those_of_python",
    "sheet-controls Between the two selected parts": "test_ranges_of_forces_are_those_of_python",
    "tab-supports": SUPPORTS,
    "sheet-controls Move all back": SUPPORTS,
    "featured *": "test_the_start_page_has_pictures_and_recent_files",
    "recent *": "test_the_start_page_has_pictures_and_recent_files",
    "examples-title": "test_an_example_is_opened_from_the_start_page",
    "idle-pairs *": "test_pairs_that_change_nothing_are_folded",
    **dict.fromkeys(
        (
            "tab-helps",
            *("sheet-body *", "sheet-body Apply"),
            "sheet-controls Try changes",
            "sheet-controls Try to hold selected parts",
        ),
        "test_a_change_that_helps_is_on_the_stage_and_becomes_a_choice",
    ),
    **dict.fromkeys(
        (
            *("allow-move", "allow-mass", "allow-size", "allow-friction", "stand-tilt"),
            "sheet-body Save as a file",
            "sheet-controls Make it stand",
        ),
        "test_a_falling_stack_is_made_to_stand",
    ),
    "tab-changes": CHANGES,
    "tab-orient": TABS,
    "tab-margin": OPTIONS,
    "tab-plan": OPTIONS,
    "tab-hold": "test_the_found_supports_are_held",
    "tab-transport": OPTIONS,
    "tab-place": PLACE,
    "place-size": PLACE,
    "place-mass": PLACE,
    "sheet-controls Map the places": PLACE,
    "tab-contacts": OPTIONS,
    "tab-compare": "test_two_states_are_compared",
    "copy-tab-command": OPTIONS,
    "sheet-body Revert": CHANGES,
    "sheet-body Go back to here": CHANGES,
    "sheet-body Redo": "test_the_found_supports_are_held",
    "sheet-controls Stop": "test_the_phase_is_stated_and_an_analysis_is_stopped",
    "sheet-controls Compute": "test_a_computation_is_stopped_in_the_bar_and_started_again",
    "sheet-controls With the capacity of each part": OPTIONS,
    "sheet-controls Limits of all axes": OPTIONS,
    "sheet-controls At this acceleration [m/s²]": OPTIONS,
    "sheet-controls By this rule": OPTIONS,
    "sheet-controls acceleration of the carrier x y z [m/s²]": OPTIONS,
    "sheet-controls rule of load securing": OPTIONS,
    "sheet-controls Show this direction": TABS,
    "sheet-controls Use this direction": TABS,
    "sheet-controls Hold": "test_the_found_supports_are_held",
    "sheet-controls Save the page of the plan": OPTIONS,
    "sheet-controls first state": "test_two_states_are_compared",
    "sheet-controls second state": "test_two_states_are_compared",
    "sheet-controls Compare": "test_two_states_are_compared",
    # the fall, the display
    "fall-play": FALL,
    "fall-at": FALL,
    "supports-play": MOVED,
    "supports-at": MOVED,
    "motion": "test_a_slider_moves_parts",
    "play": "test_the_motion_plays",
    "explode": "test_all_stays_in_the_frame_pulled_apart_and_turned",
    "section-x-side": SECTION,
    "section-x": SECTION,
    **dict.fromkeys(("section-y-side", "section-y", "section-z-side", "section-z"), CUTS),
    "flat": "test_the_view_without_perspective_keeps_sizes_and_parallels",
    "see-through": HIDDEN,
    "see-through-of": HIDDEN,
    "force-size": SECTION,
    "colour-of": "test_parts_are_coloured_by_the_bond_that_they_use_most",
    "show-motion": "test_the_arrows_of_the_motion_are_switched_off",
    "show-forces": SECTION,
    "force-mode": "test_resultants_are_those_of_python",
    "show-thrust": "test_the_line_of_thrust_goes_through_the_arch",
    "show-contacts": SECTION,
    "show-open": "test_open_pairs_are_marked_where_they_are_and_go_with_their_parts",
    "show-names": SECTION,
}
"""The test of each control. A control without an id is named by the box in which it lies and by its
label, `*` for labels that are names. "enter": a key in its field does the same, as the other tests
of the form show.
"""
LISTS = (
    *("listed", "recent", "featured", "examples", "tree", "ladder"),
    *("loose-bodies", "bodies", "idle-pairs", "selected-bar", "film-strip", "help"),
)
LIST_CONTROLS = """(lists) => {
  const labelled = (e) => (e.getAttribute("aria-label") || e.textContent || e.title).trim();
  const key = (e) => {
    if (e.id) return e.id;
    const list = lists.find((name) => e.closest(`#${name}`));
    if (list) return `${list} *`;
    const box = e.closest("[id]");
    if (!e.classList.contains("link")) return `${box.id} ${labelled(e)}`;
    return ["suggestions", "open-pairs", "sheet-body"].includes(box.id) ? `${box.id} *` : "links *";
  };
  const found = document.querySelectorAll(
    "button, input, select, textarea, summary, a[href], [role=slider], [role=separator],"
      + " [role=application], #cube",
  );
  return [...found].map(key).map((name) => name.replace(/^(sheet-controls Hold) .*/, "$1"));
}"""


@cache
def sources() -> dict[str, str]:
    """The text of each test of the page, by its name."""
    found = {}
    for path in sorted(HERE.glob("test_*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef):
                found[node.name] = ast.get_source_segment(text, node) or ""
    return found


def test_an_example_is_opened_from_the_start_page(user):
    page = user(None)
    page.page.click("#examples-title")
    page.click("#examples button:text-is('tower')")
    assert page.text("title") == "tower.kilter.json"
    assert page.text("verdict") == "Stable"


@pytest.mark.parametrize("control", [name for name in CONTROLS if CONTROLS[name] != "enter"])
def test_the_test_of_a_control_uses_it(control):
    text = sources()[CONTROLS[control]]
    box, _, label = control.partition(" ")
    asked = {"*": box, "": box, "Bring back": box, "first state": "sheet-controls"}
    asked |= {"second state": "sheet-controls", "rule of load securing": "sheet-controls"}
    asked |= {"acceleration of the carrier x y z [m/s²]": "sheet-controls", "Add": box}
    word = asked.get(label, label.removesuffix(" [m/s²]"))
    by_tab = f'"{word.removeprefix("tab-")}"'  # `tab(page, "plan")`, or a loop over the names
    assert re.search(rf"\b{re.escape(word)}(?![-\w])", text) or by_tab in text, word


def test_every_control_of_the_page_has_a_test(user, folder):
    """In many states of the page, so that controls that are made on demand appear."""
    elsewhere = folder.parent / "elsewhere"
    elsewhere.mkdir(exist_ok=True)
    kilter.dump(scene("tower"), elsewhere / "far.kilter.json")
    remember_file(elsewhere / "far.kilter.json")
    page = user(None)
    found = set(page.js(LIST_CONTROLS, LISTS))
    look = lambda: found.update(page.js(LIST_CONTROLS, LISTS))  # noqa: E731
    for what in (everything_at_once(), "cad-export", "paper-figure-1"):
        page = user(what)
        look()
        if isinstance(what, str):
            continue
        for action in (
            {"do": "load", "part": "lid-1", "force": [0, 0, -1]},
            {"do": "pair", "pairs": [["leg-1", "lid-1"]], "as": "joined"},
            {"do": "leave_out", "parts": ["spare"], "on": True},
        ):
            page.act(action)
        look()
        page.click("#undo")
        for name in ("changes", "compare", "transport", "place"):
            page.page.click(f"#tab-{name}")
            look()
        page.page.click("#tab-transport")
        page.page.click("#sheet-controls button:has-text('Place a strap')")
        look()
        page.page.click("#sheet-controls button:has-text('Cancel')")
        tab(page, "forces")
        look()
        page.choose("base")
        page.page.fill("#do-move", "0 0 -0.01")
        page.page.press("#do-move", "Enter")
        page.until("window.bench.tabs.results.has('supports')", 60)
        look()
        page.page.click("#tab-margin")
        look()  # while it is computed
        for name in ("margin", "orient", "contacts"):
            if page.js("window.bench.tabs.now") != name:
                page.page.click(f"#tab-{name}")
            page.until(f"window.bench.tabs.results.has('{name}')", 60)
            look()
    page = desk_page(user, folder, DESK | FLOATS)
    look()
    page = user("paper-figure-8")
    page.choose("C2")
    for name in ("hold", "orient"):
        tab(page, name)
        look()
    page = user("tower")
    for name in ("plan", "margin"):
        tab(page, name)
        look()
    page = user(stack(0.3))
    tab(page, "helps")
    look()
    without = sorted(found - set(CONTROLS))
    assert without == [], "add the control and its test to the table CONTROLS of this file"
    seldom = {
        f"sheet-controls {label}" for label in ("Compute", "Stop", "Save the page of the plan")
    } | {"settle Stop"}
    assert set(CONTROLS) - found - seldom == set(), "these controls are not on the page"


def everything_at_once() -> Assembly:
    """Open pairs, a joint, a bond, and a part to leave out."""
    start = two_open_pairs()
    parts = [*start.parts, Part("spare", Box([1, 1, 1]), Pose([0, 2, 0.5]))]
    bonds = [Bond(["base", "spare"], pull=1e6)]
    return Assembly(parts, bonds=bonds, joints=[Joint(["leg-1", "base"], "fixed")])
