"""The actions of a user: what each changes, what it refuses, and that a revert keeps the rest."""

from __future__ import annotations

import random

import pytest

from kilter.errors import InputError
from kilter.workbench.actions import ACTIONS, apply
from kilter.workbench.history import Change, History
from kilter.workbench.opened_parts import OpenedParts

BODIES = OpenedParts(
    ("plate", "rod", "nut_1", "nut_2"), frozenset({"rod"}), (2e-3, 1e-3, 1e-5, 0.0)
)
START = {"kilter": 1, "file": "a.step"}

EFFECTS = [
    ({"do": "hold", "parts": ["plate"], "on": True}, {"held": ["plate"]}),
    ({"do": "hold", "parts": ["nut_*"], "on": True}, {"held": ["nut_1", "nut_2"]}),
    ({"do": "floor", "on": True}, {"floor": True}),
    ({"do": "floor", "on": -2.5}, {"floor": -2.5}),
    ({"do": "leave_out", "parts": ["nut_1"], "on": True}, {"left_out": ["nut_1"]}),
    ({"do": "fasten", "parts": ["plate", "nut_1"], "on": True}, {"joined": [["plate", "nut_1"]]}),
    ({"do": "fasten_suggested", "on": True}, {"fasten_suggested": True}),
    ({"do": "fasten_overlaps", "on": True}, {"fasten_overlaps": True}),
    ({"do": "loose", "on": True}, {"loose": True}),
    (
        {"do": "pair", "pairs": [["plate", "rod"]], "as": "apart"},
        {"open_pairs": [{"parts": ["plate", "rod"], "as": "apart"}]},
    ),
    (
        {"do": "material", "parts": ["plate"], "density": 2700, "name": "aluminium"},
        {"materials": [{"parts": "plate", "density": 2700.0, "name": "aluminium"}]},
    ),
    (
        {"do": "mass", "part": "plate", "mass": 16},
        {"materials": [{"parts": "plate", "density": 8000.0}]},
    ),
    ({"do": "friction", "mu": 0.3}, {"friction": 0.3}),
    (
        {"do": "pair_friction", "parts": ["plate", "rod"], "mu": 0},
        {"friction_pairs": [{"parts": ["plate", "rod"], "mu": 0.0}]},
    ),
    (
        {"do": "joint", "parts": ["plate", "rod"], "kind": "fixed"},
        {"joints": [{"parts": ["plate", "rod"], "kind": "fixed"}]},
    ),
    (
        {"do": "bond", "parts": ["plate", "rod"], "pull": 5, "shear": "mu"},
        {"bonds": [{"parts": ["plate", "rod"], "pull": 5.0, "shear": "mu"}]},
    ),
    (
        {"do": "load", "part": "nut_1", "force": [0, 0, -5]},
        {"loads": [{"part": "nut_1", "force": [0.0, 0.0, -5.0]}]},
    ),
    (
        {"do": "poses", "poses": {"rod": {"position": [0, 0, 1], "rotation": [1, 0, 0, 0]}}},
        {"poses": {"rod": {"position": [0.0, 0.0, 1.0], "rotation": [1.0, 0.0, 0.0, 0.0]}}},
    ),
    ({"do": "gravity", "up": "y"}, {"up": "y"}),
    ({"do": "gravity", "down": [0, 0, 2]}, {"gravity": [0.0, 0.0, 9.81]}),
    ({"do": "units", "value": "mm"}, {"units": "mm"}),
    ({"do": "density", "value": 7850}, {"density": 7850.0}),
    ({"do": "tolerance", "gap": 0.1}, {"tolerance": {"gap": 0.1}}),
    ({"do": "contacts", "value": "geometry"}, {"contacts": "geometry"}),
]


@pytest.mark.parametrize(("action", "keys"), EFFECTS, ids=lambda value: str(value.get("do", "")))
def test_an_action_changes_its_key(action: dict, keys: dict) -> None:
    new, label = apply(action, START, BODIES)
    assert new == {**START, **keys}
    assert label


def test_each_action_has_a_test() -> None:
    listed = {action["do"] for action, _ in EFFECTS}
    removing = {"joint_off", "bond_off", "load_off", "scale_loads"}
    assert listed | removing == set(ACTIONS)


@pytest.mark.parametrize(("key", "do"), [("joints", "joint"), ("bonds", "bond"), ("loads", "load")])
def test_an_entry_of_a_list_is_removed(key: str, do: str) -> None:
    [action] = [action for action, _ in EFFECTS if action["do"] == do]
    one, _ = apply(action, START, BODIES)
    two, _ = apply(action, one, BODIES)
    assert len(two[key]) == 2
    assert apply({"do": f"{do}_off", "index": 1}, two, BODIES)[0] == one
    with pytest.raises(InputError, match="there is no"):
        apply({"do": f"{do}_off", "index": 2}, two, BODIES)


def test_loads_are_scaled() -> None:
    keys = {**START, "loads": [{"part": "nut_1", "force": [0, 0, -4], "torque": [1, 0, 0]}]}
    new, _ = apply({"do": "scale_loads", "factor": 2.5}, keys, BODIES)
    assert new["loads"] == [{"part": "nut_1", "force": [0, 0, -10], "torque": [2.5, 0, 0]}]


def test_a_release_takes_a_part_out_of_a_pattern() -> None:
    keys = {**START, "held": ["nut_*", "plate"]}
    new, _ = apply({"do": "hold", "parts": ["nut_2"], "on": False}, keys, BODIES)
    assert new["held"] == ["nut_1", "plate"]


WRONG = [
    ({"do": "fly"}, "unknown action"),
    ({"do": "hold", "parts": ["gone"], "on": True}, "there is no part gone"),
    ({"do": "hold", "parts": ["rod"], "on": False}, "the file itself holds rod"),
    ({"do": "leave_out", "parts": ["*"], "on": True}, "no part would be left"),
    ({"do": "fasten", "parts": ["plate", "plate"], "on": True}, "with itself"),
    ({"do": "fasten", "parts": ["plate", "gone"], "on": True}, "there is no part 'gone'"),
    ({"do": "fasten", "parts": ["plate", "rod"], "on": False}, "no single choice joins"),
    ({"do": "pair", "pairs": [["plate", "rod"]], "as": "glued"}, "a pair is 'glued'"),
    ({"do": "friction", "mu": -1}, "the friction coefficient is -1"),
    ({"do": "friction", "mu": "much"}, "is 'much'; give a number"),
    ({"do": "density", "value": 0}, "the density is 0"),
    ({"do": "mass", "part": "nut_2", "mass": 1}, "has no volume"),
    ({"do": "load", "part": "rod", "force": [1, 2]}, "has 2 numbers"),
    ({"do": "load", "part": "rod", "force": [1, 2, float("nan")]}, "the force is nan"),
    ({"do": "gravity", "down": [0, 0, 0]}, "is zero"),
    ({"do": "units", "value": "mile"}, "units"),
    ({"do": "hold"}, "a wrong value"),
]


@pytest.mark.parametrize(("action", "said"), WRONG)
def test_a_wrong_action_is_refused_in_a_sentence(action: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        apply(action, START, BODIES)


def test_the_positions_of_a_dragged_slider_are_one_change() -> None:
    history = History(START, BODIES)
    for drag, values in (("1", (0.1, 0.2, 0.3)), ("2", (0.4, 0.5))):
        for mu in values:
            history.add({"do": "friction", "mu": mu, "live": drag})
    history.add({"do": "friction", "mu": 0.6})
    labels = [change.label for change in history.changes]
    assert labels == ["friction 0.3", "friction 0.5", "friction 0.6"]
    history.go(1)
    assert history.keys["friction"] == 0.3
    history.undo()
    assert history.keys == START


def test_a_revert_keeps_the_other_changes_of_the_same_key() -> None:
    history = History(START, BODIES)
    history.add({"do": "hold", "parts": ["plate"], "on": True})
    history.add({"do": "hold", "parts": ["nut_1"], "on": True})
    history.revert(0)
    assert history.keys["held"] == ["nut_1"]
    history.redo()
    assert history.keys["held"] == ["nut_1", "plate"]


def test_a_change_that_a_later_change_needs_is_not_reverted() -> None:
    history = History(START, BODIES)
    history.add({"do": "load", "part": "nut_1", "force": [0, 0, -5]})
    history.add({"do": "load_off", "index": 0})
    with pytest.raises(InputError, match="a later change needs"):
        history.revert(0)
    assert len(history.changes) == 2


@pytest.mark.parametrize("seed", range(6))
def test_undo_and_redo_are_inverse_and_the_file_keeps_them(seed: int) -> None:
    rng = random.Random(seed)
    history = History(START, BODIES)
    seen = [history.keys]
    for _ in range(30):
        action = rng.choice(EFFECTS)[0]
        try:
            history.add(action)
        except InputError:
            continue
        seen.append(history.keys)
    count = len(history.changes)
    assert count == len(seen) - 1
    for k in rng.sample(range(count + 1), 5):
        history.go(k)
        assert history.keys == seen[k]
        again = History.from_text(history.to_text().encode(), BODIES)
        assert again.keys == history.keys
        again.go(count)
        assert again.keys == seen[-1]


def test_a_damaged_file_of_changes_is_refused() -> None:
    for text in (b"", b"{}", b'{"kilter_workbench": 1}', b'{"kilter_workbench": 1, "base": {}}'):
        with pytest.raises(InputError):
            History.from_text(text, BODIES)


def test_a_change_has_a_label() -> None:
    assert Change({"do": "floor", "on": True}, "floor").label == "floor"
