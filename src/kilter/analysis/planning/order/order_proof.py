"""The proof of a plan as data: its steps, why fewer holds are not enough, or an impossibility.

Before the proofs stands, as `rules`, what the order keeps to: most parts held at once, precedence,
groups, parts that are not held, screws. Each proof is of one state, and says what it is about

    whole           the finished assembly holds
    step            what stands while a part comes in, along its `legs` reversed, holds
    pressed         the same with the part in place, under the force that presses it in
    turned          what stands after a step, still as it was during it: then all is turned
    not fewer       at a step with parts held: one of `parts` must be held, or they move
    refused         of a set that bars every order: one of `parts` must be held, or they move
    finished falls  the finished assembly does not hold, so that there is no order
    falls alone     a part that no order without holds reaches
    locked          a part that those present let move nowhere, by its `multipliers`

`kilter.analysis.planning.order.order_check` judges it again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kilter.analysis.planning.order.locking import Locked
from kilter.analysis.planning.order.plan_step import Step
from kilter.analysis.planning.states.holds import Cut, Holds
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.mechanics.bundle import make_bundle

__all__ = ["order_proof"]

Stated = tuple[dict[str, Any], State, States]
"""What a proof is about, its state, and the states that it is one of."""


def order_proof(
    states: States,
    whole: State,
    steps: Sequence[Step],
    falling: Sequence[State],
    locked: Sequence[Locked],
    refused: Sequence[Holds[State]],
    rules: Mapping[str, Any],
    options: Mapping[str, Any],
) -> dict[str, Any]:
    """The proofs of a plan in one file.

    Parameters
    ----------
    states : States
    whole : State
        The finished assembly.
    steps : sequence of Step
        Empty where there is none.
    falling : sequence of State
        Each part that no order without holds reaches, alone free on all that are reached.
    locked : sequence of Locked
        Parts that lock one another.
    refused : sequence of Holds
        Sets that need more held than may be, and bar every order.
    rules, options : mapping
        What the order keeps to; how the file is read.
    """
    names, proofs = states.assembly.names, []
    stated = _of_steps(states, whole, steps) if steps else []
    if whole.stable is False:
        stated.append(({"about": "finished falls"}, whole, states))
    stated += [
        ({"about": "falls alone", "part": names[int(np.flatnonzero(one.free)[0])]}, one, states)
        for one in falling
    ]
    stated += [
        (
            {"about": "locked", "part": names[one.part], "multipliers": one.multipliers.tolist()},
            one.state,
            states,
        )
        for one in locked
    ]
    stated += [
        ({"about": "refused", "parts": _names(names, cut)}, cut.state, states)
        for known in refused
        for cut in known.cuts
    ]
    for about, state, of in stated:
        change: dict[str, Any] = {
            "without": [n for n, here in zip(names, state.present, strict=True) if not here],
            "held": states.held_names(state),
        }
        proof = of.proof(state, options=dict(options))
        if about["about"] == "pressed":
            change["loads"] = proof["loads"]
        elif of is not states:
            change["down"] = of.assembly.down.tolist()
        proofs.append(({**about, "change": change}, proof))
    return make_bundle("plan", proofs, rules=dict(rules))


def _of_steps(states: States, whole: State, steps: Sequence[Step]) -> list[Stated]:
    names = states.assembly.names
    stated: list[Stated] = [({"about": "whole"}, whole, states)]
    for number, step in enumerate(steps, 1):
        of = states if step.turned is None else step.turned
        stated.append((_step(step), step.state, of))
        if step.between is not None:
            stated.append(({"about": "turned", "step": number}, step.between, of))
        if step.pressed is not None and step.under is not None:
            stated.append(({"about": "pressed", "step": number}, step.pressed, step.under))
        if step.needs is None or not step.needs.fewest:
            continue
        for cut in step.needs.cuts:
            about = {"about": "not fewer", "step": number, "parts": _names(names, cut)}
            stated.append((about, cut.state, states))
    return stated


def _names(names: Sequence[str], cut: Cut[State]) -> list[str]:
    return [name for name, one in zip(names, cut.parts, strict=True) if one]


def _step(step: Step) -> dict[str, Any]:
    return {
        "about": "step",
        "parts": list(step.parts),
        "legs": [
            [list(leg.direction), leg.length if np.isfinite(leg.length) else None]
            for leg in step.legs
        ],
        "over": step.over,
    }
