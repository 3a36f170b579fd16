"""A plan as data to draw: its steps with their ways, hands and forces, and how it is pulled apart.

Positions are about `center` of the picture. Apart, a part stands back along the way that it came,
beyond the parts that it was put on,

    apart_p = apart_q - size_p d_p        q: of the parts it is seated on the one farthest apart

where seated on are the parts that it touches and does not slide along.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.show.packing import pack, readable
from kilter.show.scene import build_things
from kilter.tell.plan_words import order_facts
from kilter.tell.step_facts import step_facts
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.analysis.planning.order.explained import Explained, Hand, StepForces
    from kilter.analysis.planning.order.order import Order
    from kilter.assembly import Assembly

__all__ = ["build_plan_scene", "pulled_apart"]

WORDS = {
    "found": "There is an order",
    "impossible": "Impossible",
    "none-found": "None found",
    "fails": "This order fails",
}
"""Of a plan by its verdict."""
GAP = 0.85
"""Between a part and what it was put on, pulled apart [extent of the part along its way]."""
FARTHEST = 1.1
"""No part is pulled farther [radius of the picture]."""


def build_plan_scene(order: Order, explained: Explained) -> dict[str, Any]:
    """What the page of a plan draws, as JSON data."""
    states = order.states
    assembly, answer = states.assembly, order.to_dict()
    things = build_things(assembly, states.contacts)
    center = np.array(things["center"])
    steps = [
        _step(assembly, told, support, center)
        for told, support in zip(answer["steps"], explained.supports, strict=True)
    ]
    sentence = answer["sentence"]
    return {
        **things,
        "given": {"down": assembly.down.tolist()},
        "recommended": None,
        "region": None,
        "plan": {
            "verdict": answer["verdict"],
            "word": WORDS[answer["verdict"]],
            "sentence": readable(sentence),
            "more": readable("; ".join(f"{k}: {v}" for k, v in order_facts(answer)[:2])),
            "base": [assembly.index[name] for name in answer["base"]],
            "steps": steps,
            "falls": _falls(order),
            "explode": pack(_in_view(pulled_apart(assembly, answer["steps"]), things["radius"])),
        },
    }


def _step(
    assembly: Assembly, told: dict[str, Any], support: StepForces, center: Array
) -> dict[str, Any]:
    index, metres, over = assembly.index, metres_per_unit(assembly.units), told["over"]
    hands = [
        {
            "part": hand.part,
            "force": None if hand.force is None else float(np.linalg.norm(hand.force)),
            "torque": None if hand.torque is None else float(np.linalg.norm(hand.torque)) * metres,
            "weight": float(assembly.geometry.mass[index[hand.part]])
            * float(np.linalg.norm(assembly.gravity)),
            "radius": float(assembly.geometry.radius[index[hand.part]]) * metres,
            "falls": list(hand.falls),
        }
        for hand in support.hands
    ]
    return {
        "parts": [index[name] for name in told["parts"]],
        # without a way a part is there at once
        "path": told["path"] if told["direction"] else 2 * told["path"],
        "direction": told["direction"] or told["down"],
        "down": told["down"],
        "held": [index[name] for name in told["held"]],
        "over": None if over is None else index[over],
        "thread": 0.0 if over is None else _thread(assembly, told, over),
        "facts": [[readable(k), readable(v)] for k, v in step_facts(told, hands)],
        "hands": [_hand(assembly, hand) for hand in support.hands],
        "support": {
            "points": pack(support.points - center),
            "parts": pack(support.parts, "index"),
            "forces": pack(support.forces),
        },
    }


def _hand(assembly: Assembly, hand: Hand) -> dict[str, Any]:
    index = assembly.index
    return {
        "part": index[hand.part],
        "force": None if hand.force is None else hand.force.tolist(),
        "moves": [index[name] for name in hand.falls],
        "motion": None if hand.motion is None else pack(hand.motion),
    }


def _falls(order: Order) -> list[dict[str, Any]]:
    """Parts that nothing that can be reached holds, where no order was found, and how they fall."""
    if order.steps:
        return []
    found = []
    for state in order.falling:
        moves = [int(k) for k in np.flatnonzero(state.free)]
        motion = None if state.motion is None else pack(state.motion.motion)
        found.append({"part": moves[0], "moves": moves, "motion": motion})
    return [one for one in found if one["motion"] is not None]


def _thread(assembly: Assembly, told: dict[str, Any], over: str) -> float:
    """How far a nut moves while it is on its bolt [length unit]."""
    along = np.array(told["direction"])
    nut, bolt = (
        assembly.geometry.corners_of(assembly.index[name]).reshape(-1, 3) @ along
        for name in (told["parts"][0], over)
    )
    return float(max(nut.max() - bolt.min(), 0.0))


def _in_view(apart: Array, radius: float) -> Array:
    """The same, no farther than the picture reaches."""
    farthest = float(np.linalg.norm(apart, axis=1).max(initial=0.0))
    return apart * min(1.0, FARTHEST * radius / farthest) if farthest > 0 else apart


def pulled_apart(assembly: Assembly, steps: list[dict[str, Any]]) -> Array:
    """How far each part stands from its seat where all is pulled apart, shape (N, 3).

    Parameters
    ----------
    assembly : Assembly
    steps : list of dict
        `steps` of a plan.
    """
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
