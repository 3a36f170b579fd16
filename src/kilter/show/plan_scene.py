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
    assembly, answer = states.assembly, order.to_dict()
    things = build_things(assembly, states.contacts)
    center = np.array(things["center"])
    steps = [
        _step(assembly, step, support, center)
        for step, support in zip(answer["steps"], explained.supports, strict=True)
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
