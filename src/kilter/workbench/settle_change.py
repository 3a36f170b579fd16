"""The change of the workbench that settles the parts: their poses at rest as choices.

The pose is that of `kilter check --settle`. Choices state the poses of parts. Points and axes of
their loads, joints and bonds move with the parts. Those of the file itself cannot move, as choices
do not state them; then the change is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from kilter.analysis.settled_pose.settle import settle
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.saved_entries import with_interactions
from kilter.tell.numbers import count
from kilter.tell.settle_words import moved_words
from kilter.workbench.live_assembly import Prepared

__all__ = ["settle_offer", "settling_action"]

PLACED = ("point", "axis", "points", "normal")
"""Keys of loads, joints and bonds that move with a part."""
ENTRIES = ("loads", "joints", "bonds")
"""Keys of choices whose entries may have points."""


def settle_offer(verdict: Verdict) -> dict[str, str] | None:
    """Parts that overlap, nearly touch or hang, and the known result of settling them, in words.

    None if there is no such part. The result is empty if it was not tried.

    Examples
    --------
    >>> from kilter import check
    >>> from kilter.scenes import scene
    >>> settle_offer(check(scene("tower"))) is None
    True
    """
    contacts = verdict.contact_set
    kinds = [pair.kind for pair in contacts.open_pairs]
    free = ~verdict.assembly.geometry.grounded
    numbers = {
        "overlapping pair": kinds.count("overlap"),
        "nearly touching pair": kinds.count("near"),
        "hanging part": len({one.part for one in contacts.neighbours if free[one.part]}),
    }
    found = ", ".join(count(number, word) for word, number in numbers.items() if number)
    tried = [one.to_dict()["words"] for one in verdict.remedies if one.option == "--settle"]
    result = tried[0].partition(": ")[2] if tried else ""
    return {"parts": found, "result": result} if found else None


def settling_action(
    prepared: Prepared, keys: Mapping[str, Any], progress: Callable[[str], None]
) -> dict[str, Any]:
    """The action that moves the parts to their pose at rest.

    Raises `InputError` if no pose at rest is found, if the parts are at rest already, or if choices
    cannot state the pose.
    """
    answer = settle(
        prepared.assembly,
        contacts=prepared.contacts,
        tolerance=prepared.tolerance,
        effort=0.0,
        require="equilibrium",
        progress=progress,
    )
    data = answer.to_dict()
    moved = {entry["part"] for entry in data["moved"]}
    if answer.state != "at-rest":
        raise InputError(data["sentence"].rstrip("."), hint="decide the open pairs instead")
    if not moved:
        raise InputError("no part moves: the parts are at rest as drawn")
    drawn, settled = answer.drawn, answer.assembly
    return {
        "do": "poses",
        "poses": {
            part.name: {
                "position": part.pose.position.tolist(),
                "rotation": part.pose.rotation.tolist(),
            }
            for part in settled.parts
            if part.name in moved
        },
        "replaced": {key: _replaced(key, drawn, settled, keys) for key in ENTRIES},
        "moved": moved_words(data),
        "sha256": keys.get("sha256"),
        "units": keys.get("units"),
    }


def _replaced(
    key: str, drawn: Assembly, settled: Assembly, keys: Mapping[str, Any]
) -> list[list[dict[str, Any]]]:
    """Pairs of an entry of the choices, as it is and as it moves with its part.

    Raises `InputError` if an entry of the file itself moves.
    """
    before, after = list(getattr(drawn, key)), list(getattr(settled, key))
    moved = {k for k, entry in enumerate(before) if entry != after[k]}
    pairs = []
    for entry in keys.get(key, []) if moved else []:
        built = getattr(with_interactions(drawn, {key: [entry]}), key)[-1]
        if built not in before:
            continue  # of a part that is left out
        k = before.index(built)
        if k in moved:
            places = {name: _as_list(getattr(after[k], name)) for name in PLACED if name in entry}
            pairs.append([dict(entry), {**entry, **places}])
            moved -= {j for j, other in enumerate(before) if other == built}
    if moved:
        raise InputError(
            f"the {key} of the file move with their parts, which choices cannot state",
            hint="'kilter settle FILE -o REST.kilter.json' writes the complete assembly",
        )
    return pairs


def _as_list(value: Any) -> Any:
    return None if value is None else np.asarray(value).tolist()
