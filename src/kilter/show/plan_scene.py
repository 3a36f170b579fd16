"""The data of a plan's page: steps with paths, hands and forces, and the exploded view.

Positions are relative to `center` of the picture. In the exploded view a part is displaced back
along its path, beyond the parts on which it is seated,

    apart_p = apart_q - size_p d_p        q: the part under p with the largest displacement

The parts on which p is seated are those that it touches without sliding along them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix
from kilter.show.glb_film import Film, xyzw
from kilter.show.packing import pack, readable
from kilter.show.scene import build_things, view_box
from kilter.show.sections import (
    facts_html,
    graph_svg,
    made_section,
    name_html,
    rows_html,
    section,
    text,
    warnings_section,
)
from kilter.tell.facts import facts
from kilter.tell.plan_words import LEVELS, order_facts, step_cells, step_facts
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.analysis.planning.order.explained import Explained, Hand, StepForces
    from kilter.analysis.planning.order.order import Order
    from kilter.assembly import Assembly


# A plan as an animated GLB film: each part is inserted along its path.


LEAD, STEP, MOVES = 0.8, 1.25, 1.0
"""Time before the first step, duration of a step, and duration of the motion in it [s]."""
KEYS = 13
"""Number of key frames of a track along a path."""
NEAR = 1.2
"""Greatest distance of a part from its first corner at the start [size of the assembly]."""
TURNS = 3
"""Number of turns that a nut makes on its thread in the film."""
MARK = 0.28
"""Size of the mark of a held part [bounding radius of the part]."""


def film_of_plan(assembly: Assembly, answer: Mapping[str, Any]) -> bytes:
    """Encode the steps of a plan as a GLB film."""
    film, index = Film(assembly), assembly.index
    places = film.places
    for k, step in enumerate(answer["steps"]):
        start = LEAD + k * STEP
        times = start + MOVES * np.linspace(0.0, 1.0, KEYS)
        path = _sampled_path(np.array(step["path"]), NEAR * film.size)
        for part in (index[name] for name in step["parts"]):
            film.animate(part, "scale", [0.0, start], [[0.0] * 3, [1.0] * 3], "STEP")
            film.animate(part, "translation", times, places.position[part] - film.center + path)
            if step["over"] is not None:
                turning = _nut_rotations(np.array(step["direction"]), places.rotation[part])
                film.animate(
                    part, "rotation", np.linspace(start, start + MOVES, len(turning)), turning
                )
    for name, changes in _held_times(answer["steps"]).items():
        part = index[name]
        mark = film.add_mark(f"hold {name}", assembly.geometry.center[part])
        reach = MARK * float(assembly.geometry.radius[part])
        sizes = [[reach * on] * 3 for _, on in changes]
        film.animate(mark, "scale", [at for at, _ in changes], sizes, "STEP")
    return film.to_bytes("plan")


def _sampled_path(path: Array, reach: float) -> Array:
    """Points of an insertion path at equal times, slow at both ends, shape (KEYS, 3).

    `path`, shape (k, 3), ends at the seat; its first segment is cut to `reach` [length unit].
    """
    first = path[0] - path[1]
    far = float(np.linalg.norm(first))
    path = np.vstack([path[1] + first * min(1.0, reach / far), path[1:]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    t = np.linspace(0.0, 1.0, KEYS)
    at = along[-1] * t * t * (3 - 2 * t)
    return np.column_stack([np.interp(at, along, path[:, i]) for i in range(3)])


def _nut_rotations(along: Array, rest: Array) -> Array:
    """Quaternions x, y, z, w, (k, 4), of a nut that turns on a right-handed thread to its seat.

    `along`, shape (3,), is the direction of insertion; `rest` is the quaternion in the seat.
    """
    angles = np.linspace(-2 * np.pi * TURNS, 0.0, 4 * TURNS + 1)
    turns = np.column_stack([np.cos(angles / 2), np.sin(angles / 2)[:, None] * along])
    turned = quaternion_to_matrix(turns) @ quaternion_to_matrix(rest)
    return np.array([xyzw(matrix_to_quaternion(matrix)) for matrix in turned])


def _held_times(steps: list[dict[str, Any]]) -> dict[str, list[tuple[float, int]]]:
    """For each part that is ever held, the times [s] at which it is gripped (1) or released (0).

    Each list begins at the time 0.
    """
    changes: dict[str, list[tuple[float, int]]] = {}
    for k, step in enumerate([*steps, {"held": []}]):
        for name in step["held"]:
            changes.setdefault(name, [(0.0, 0)])
        for name, times in changes.items():
            if (name in step["held"]) != bool(times[-1][1]):
                times.append((LEAD + k * STEP, int(name in step["held"])))
    return changes


WORDS = {
    "found": "There is an order",
    "impossible": "Impossible",
    "none-found": "No order found",
    "fails": "This order fails",
}
"""Words for the verdicts of a plan."""
GAP = 0.85
"""Gap between a part and the part under it in the exploded view [extent of the part in this
direction]."""
FARTHEST = 1.1
"""Largest displacement of a part in the exploded view [radius of the picture]."""


def build_plan_scene(order: Order, explained: Explained) -> dict[str, Any]:
    """JSON data of a plan's page: shapes, steps with paths, hands and forces."""
    states = order.states
    things = build_things(states.assembly, states.contacts)
    return {
        **things,
        "given": {"down": states.assembly.down.tolist()},
        "recommended": None,
        "region": None,
        "plan": build_film(order, explained, np.array(things["center"])),
    }


def build_film(order: Order, explained: Explained, center: Array) -> dict[str, Any]:
    """JSON data of the steps of a plan, without the shapes and parts of its assembly.

    Arguments: `center` (3,): middle of the picture [length unit].
    """
    assembly, answer = order.states.assembly, order.to_dict()
    steps = [
        _step(assembly, step, support, center)
        for step, support in zip(answer["steps"], explained.supports, strict=True)
    ]
    radius = float(np.linalg.norm(view_box(assembly)[1]))
    return {
        "verdict": answer["verdict"],
        "word": WORDS[answer["verdict"]],
        "sentence": readable(answer["sentence"]),
        "more": readable("; ".join(f"{k}: {v}" for k, v in order_facts(answer)[:2])),
        "base": [assembly.index[name] for name in answer["base"]],
        "steps": steps,
        "falls": _falls(order),
        "explode": pack(_in_view(pulled_apart(assembly, answer["steps"]), radius)),
    }


def _step(
    assembly: Assembly, step: Mapping[str, Any], support: StepForces, center: Array
) -> dict[str, Any]:
    """JSON data of a step of a plan, for the page.

    Arguments: `center` (3,): middle of the picture [length unit].
    """
    index, metres, over = assembly.index, metres_per_unit(assembly.units), step["over"]
    hands = [
        {
            "part": hand.part,
            "force": None if hand.force is None else float(np.linalg.norm(hand.force)),
            "torque": None if hand.torque is None else float(np.linalg.norm(hand.torque)) * metres,
            "weight": float(assembly.geometry.mass[index[hand.part]])
            * float(np.linalg.norm(assembly.gravity)),
            "radius": float(assembly.geometry.radius[index[hand.part]]) * metres,
            "least": hand.least,
            "falls": list(hand.falls),
        }
        for hand in support.hands
    ]
    return {
        "parts": [index[name] for name in step["parts"]],
        # a part without a path is in its seat from the beginning of its step
        "path": step["path"] if step["direction"] else 2 * step["path"],
        "direction": step["direction"] or step["down"],
        "down": step["down"],
        "held": [index[name] for name in step["held"]],
        "over": None if over is None else index[over],
        "thread": 0.0 if over is None else _thread(assembly, step, over),
        "facts": [[readable(k), readable(v)] for k, v in step_facts(step, hands)],
        "hands": [_hand(assembly, hand) for hand in support.hands],
        "support": {
            "points": pack(support.points - center),
            "parts": pack(support.parts, "index"),
            "forces": pack(support.forces),
        },
    }


def _hand(assembly: Assembly, hand: Hand) -> dict[str, Any]:
    """JSON data of a hand that holds a part: its force [N], and the motion without the hand."""
    index = assembly.index
    return {
        "part": index[hand.part],
        "force": None if hand.force is None else hand.force.tolist(),
        "moves": [index[name] for name in hand.falls],
        "motion": None if hand.motion is None else pack(hand.motion),
    }


def _falls(order: Order) -> list[dict[str, Any]]:
    """Groups of parts that fall in every reached state, if no order was found; else empty."""
    if order.steps:
        return []
    groups = []
    for state in order.falling:
        moves = [int(k) for k in np.flatnonzero(state.free)]
        motion = None if state.motion is None else pack(state.motion.motion)
        groups.append({"part": moves[0], "moves": moves, "motion": motion})
    return [group for group in groups if group["motion"] is not None]


def _thread(assembly: Assembly, step: Mapping[str, Any], over: str) -> float:
    """Length of the path along which a nut turns on the bolt `over` [length unit]."""
    along = np.array(step["direction"])
    nut, bolt = (
        assembly.geometry.corners_of(assembly.index[name]).reshape(-1, 3) @ along
        for name in (step["parts"][0], over)
    )
    return float(max(nut.max() - bolt.min(), 0.0))


def _in_view(apart: Array, radius: float) -> Array:
    """Scale displacements of parts, shape (N, 3), so that none exceeds `FARTHEST`."""
    farthest = float(np.linalg.norm(apart, axis=1).max(initial=0.0))
    return apart * min(1.0, FARTHEST * radius / farthest) if farthest > 0 else apart


def pulled_apart(assembly: Assembly, steps: Sequence[Mapping[str, Any]]) -> Array:
    """Displacement of each part in the exploded view, shape (N, 3), from its final position."""
    index, geometry = assembly.index, assembly.geometry
    apart = np.zeros((len(assembly), 3))
    for step in steps:
        if step["direction"] is None:
            continue
        group = [index[name] for name in step["parts"]]
        along = np.array(step["direction"])
        seats = [index[name] for name in step["touches"] if name not in step["rubs"]]
        below = max((apart[q] for q in seats), key=lambda v: float(-(v @ along)), default=apart[0])
        corners = np.concatenate([geometry.corners_of(k).reshape(-1, 3) for k in group])
        apart[group] = below - GAP * float(np.ptp(corners @ along)) * along
    return apart


# Text sections of a plan's page: result, steps, precedence graph, warnings, reproduction.


DRAWN = 150
"""Largest number of steps for which the precedence graph is drawn."""
PLAYED = (
    "Playing starts no computation: paths, held parts and forces are those of the plan. The forces "
    "are those of the proof of the step, and not unique. The turning of a nut is illustration."
)


def plan_sections(
    order: Order, explained: Explained, *, command: str, versions: dict[str, str]
) -> str:
    """HTML of all text sections of a plan's page, below the picture."""
    answer = order.to_dict()
    parts = [_result(answer), _steps(answer), _graph(answer, explained)]
    parts.append(warnings_section(answer["warnings"]))
    parts.append(made_section(command, versions, ("the film", PLAYED)))
    return "\n".join(filter(None, parts))


def _result(answer: Mapping[str, Any]) -> str:
    rows = [("in words", text(answer["sentence"]))]
    rows += [(term, text(words)) for term, words in facts(answer)]
    if answer["level"] is not None:
        rows.append(("meaning of the level", text(LEVELS[answer["level"]])))
    return section("Result", facts_html(rows))


def _steps(answer: Mapping[str, Any]) -> str:
    """HTML section with a table of the steps of a plan; empty without steps."""
    if not answer["steps"]:
        return ""

    def row(k: int, step: Mapping[str, Any]) -> list[str]:
        way, held, freed, level = step_cells(step)
        names = "".join(name_html(name) for name in step["parts"])
        button = f'<button type="button" class="link" data-step="{k}">{names}</button>'
        touches = ", ".join(step["touches"])
        return [str(k + 1), button, *map(text, (way, touches, held, freed, level))]

    head = ["", "part", "inserted", "touches", "held during the step", "released after", "level"]
    body = rows_html(head, [row(k, s) for k, s in enumerate(answer["steps"])], len(answer["steps"]))
    return section(f"Steps ({len(answer['steps'])})", body)


def _graph(answer: Mapping[str, Any], explained: Explained) -> str:
    """HTML section with the precedence graph of a plan.

    Empty without steps or with more than `DRAWN` steps.
    """
    if not answer["steps"] or len(answer["steps"]) > DRAWN:
        return ""
    needs = [(need.before, need.after) for need in explained.needs]
    reason = (
        "because of an option or because the second would block the path of the first"
        if explained.swept
        else "because of `--before` or `--screws` (paths are not compared for this many parts)"
    )
    note = (
        f"Nodes are steps. A dark arrow: the first step must come before the second, {reason}. "
        "A pale line: the part of the second step touches that of the first. Arrows and lines that "
        "follow from others are left out. Blue: the part is held by a hand at some time."
    )
    body = (
        f'<div id="graph" class="wide">{graph_svg(answer, needs)}</div><p class="small">{note}</p>'
    )
    return section("Precedence", body)
