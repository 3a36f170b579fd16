"""Proof of a plan as JSON data: its steps, the need for held parts, or that no order exists.

The key `rules` precedes the proofs. It has the limit of parts held at once, precedence, groups,
parts that must not be held, and screws. Each proof is of a single state and has a subject:

    whole           the finished assembly holds
    step            the standing parts hold while a part comes in along its `legs`, reversed
    carried         a step or (step 0) the finished assembly holds at an acceleration of its carrier
    pressed         the same with the part in place, under the force that presses it in
    turned          the parts after a step hold under its direction, before the assembly is turned
    not fewer       at a step with held parts: a part of `parts` must be held, or they move
    refused         in a set that bars every order: a part of `parts` must be held, or they move
    finished falls  the finished assembly does not hold, so no order exists
    falls alone     a part that no order without holds reaches
    locked          the other present parts lock a part, proved by `multipliers`

If the states must carry accelerations, a motion may be that of the parts at one of these: the
change then has the `gravity` that the parts feel.

`kilter.analysis.planning.order.order_check` verifies it.
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
"""A statement of a proof file: its description, the state that proves it, and all states."""


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
    """Proofs of a plan as data for a proof file.

    Arguments: `falling`: states of the parts that no order without holds reaches, each alone free
    on the reached parts.
    """
    names, proofs = states.assembly.names, []
    stated = _of_steps(states, whole, steps) if steps or not whole.free.any() else []
    if whole.stable is False:
        stated.append(({"about": "finished falls"}, whole, states))
    stated += [
        ({"about": "falls alone", "part": names[int(np.flatnonzero(entry.free)[0])]}, entry, states)
        for entry in falling
    ]
    stated += [
        (
            {
                "about": "locked",
                "part": names[entry.part],
                "multipliers": entry.multipliers.tolist(),
            },
            entry.state,
            states,
        )
        for entry in locked
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
        of = of.owner(state)
        proof = of.proof(state, options=dict(options))
        if about["about"] == "pressed":
            change["loads"] = proof["loads"]
        elif of in states.carried:
            change["gravity"] = of.assembly.gravity.tolist()
        elif of is not states:
            change["down"] = of.assembly.down.tolist()
        proofs.append(({**about, "change": change}, proof))
    return make_bundle("plan", proofs, rules=dict(rules))


def _of_steps(states: States, whole: State, steps: Sequence[Step]) -> list[Stated]:
    """List, for each proof of a plan, its description, its state and the `States` it belongs to."""
    names = states.assembly.names
    stated: list[Stated] = [({"about": "whole"}, whole, states)]
    for number, state in enumerate([whole, *(step.state for step in steps)] if steps else []):
        stated += [
            (
                {"about": "carried", "step": number},
                accelerated.judge(state.present, state.present & ~state.free),
                accelerated,
            )
            for accelerated in states.carried
        ]
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
    return [name for name, moves in zip(names, cut.parts, strict=True) if moves]


def _step(step: Step) -> dict[str, Any]:
    """A step of a plan as JSON data: its parts, path and held parts."""
    return {
        "about": "step",
        "parts": list(step.parts),
        "legs": [
            [list(leg.direction), leg.length if np.isfinite(leg.length) else None]
            for leg in step.legs
        ],
        "over": step.over,
    }
