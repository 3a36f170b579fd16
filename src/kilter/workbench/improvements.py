"""The tab "What helps": a table of changes, the picture of each, and the choices that make it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.analysis_tolerances import NO_GAIN
from kilter.analysis.margins.margin_answer import Margin
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.files.own.saved_entries import changed_poses
from kilter.rigid import quaternion_to_matrix
from kilter.show.packing import pack
from kilter.show.sections import rows_html, text
from kilter.show.shapes import place_shapes
from kilter.tell.numbers import number
from kilter.workbench.live_assembly import Prepared

LIMITS = {
    "tilt": "tilt [deg]",
    "load factor": "load factor",
    "friction": "least friction",
    "strength": "needed strength [%]",
}
"""Column head of each limit."""
NO_TILT = 90.0 - NO_GAIN
"""Least tilt limit of an assembly that no tilt up to a right angle moves [deg]."""
LESS = ("friction", "strength")
"""Limits that improve if they become less."""
APPLY = "'Apply' makes the change a choice, which undo takes back."
STAND = "'Make it stand' finds the least change after which it stands."
SAVE = (
    "Choices cannot state sizes, additional bricks, held parts with a load, or movements from a "
    "pose that is not the drawn one; 'Save as a file' downloads the changed assembly."
)


@dataclass(frozen=True, slots=True, eq=False)
class ShownChange:
    """A change in a row of the table, and the changed assembly."""

    sentences: tuple[str, ...]
    """Each change in words, without its gain."""
    parts: tuple[str, ...]
    limit: str
    """The limit before and after the change."""
    gain: str
    changed: Assembly


def helps_data(
    answer: Margin, prepared: Prepared, keys: Mapping[str, Any], center: Array
) -> dict[str, Any]:
    """Data of the tab for the page; `changed` are the changed assemblies, which stay here.

    Arguments: `keys`: JSON data of the choices; `center` (3,): point to which the positions of the
    picture are relative, world frame [length unit].
    """
    shown = shown_changes(answer)
    actions = [action_of(each, prepared, keys) for each in shown]
    return {
        "html": changes_html(answer, shown, actions),
        "changes": [
            {"action": action, **change_picture(each, prepared.assembly, center)}
            for each, action in zip(shown, actions, strict=True)
        ],
        "changed": [each.changed for each in shown],
    }


def shown_changes(answer: Margin) -> list[ShownChange]:
    """The rows of the table: the change that makes the assembly stand, or the changes tried."""
    made = answer.made_stand
    if made is not None:
        if not made.changes:  # none was found, or none is needed
            return []
        before, after = answer.tilt_deg or 0.0, made.tilt_deg or 0.0
        falls = answer.tilt_deg is None or before < 0
        change = ShownChange(
            tuple(each.sentence for each in made.changes),
            tuple(dict.fromkeys(name for each in made.changes for name in each.parts)),
            f"{'it falls' if falls else number(before, 5)} \u2192 {number(after, 5)}",
            "" if falls else f"{after - before:+.3g}",
            made.assembly,
        )
        return [change]
    shown = []
    for each in answer.improvements:
        sign = -1.0 if each.of in LESS else 1.0
        scale = 100.0 if each.of == "strength" else 1.0
        before, gain = scale * (each.limit - sign * each.gain), sign * scale * each.gain
        limited = math.isfinite(each.gain) and not (each.of == "tilt" and each.limit >= NO_TILT)
        limit = number(scale * each.limit, 5) if limited else "no limit"
        shown.append(
            ShownChange(
                (each.sentence.rpartition(": ")[0],),
                each.parts,
                f"{number(before, 5)} \u2192 {limit}" if math.isfinite(before) else limit,
                f"{gain:+.3g}" if limited else "",
                each.changed,
            )
        )
    return shown


def changes_html(
    answer: Margin, shown: Sequence[ShownChange], actions: Sequence[Mapping[str, Any] | None]
) -> str:
    """HTML of the tab: the verdict, a table of the changes with buttons, and what they do."""
    made = answer.made_stand
    first = [answer.sentence]
    if made is not None:
        required = f"it stands up to a tilt of {number(made.required_deg)} deg"
        if not made.stands:
            first.append(f"No change was found after which {required}.")
        elif not made.changes:
            first.append(f"No change is needed: {required}; this is proved.")
        else:
            first.append(f"After this change {required}; this is proved.")
    body = [f"<p>{text(sentence)}</p>" for sentence in first]
    rows = [
        [
            f'<button type="button" class="link" data-change aria-pressed="false">'
            f"{'<br>'.join(map(text, each.sentences))}</button>",
            text(each.limit),
            text(each.gain),
            f'<button type="button" class="small-button" data-make>'
            f"{'Save as a file' if action is None else 'Apply'}</button>",
        ]
        for each, action in zip(shown, actions, strict=True)
    ]
    if made is None and not rows and answer.verdict == "unstable":
        body.append(f"<p>{text(STAND)}</p>")
    if rows:
        limit = "tilt" if made is not None else answer.improvements[0].of
        body.append(rows_html(["change", LIMITS[limit], "gain", ""], rows, len(rows)))
        notes = [APPLY] * any(actions) + [SAVE] * (None in actions)
        body.append(f'<p class="soft">{text(" ".join(notes))}</p>')
    body += [f"<p>{text(f'{warning[0].upper()}{warning[1:]}.')}</p>" for warning in answer.warnings]
    return "".join(body)


def action_of(
    shown: ShownChange, prepared: Prepared, keys: Mapping[str, Any]
) -> dict[str, Any] | None:
    """The action after which choices state a changed assembly; None if choices cannot state it."""
    given = prepared.assembly
    before, after = given.parts, shown.changed.parts
    gone = [part.name for part in before if part.name not in shown.changed.index]
    if gone:
        return _action(shown, [{"do": "leave_out", "parts": gone, "on": True}])
    kept = len(after) == len(before) and len(shown.changed.loads) == len(given.loads)
    if not kept or any(new.shape is not old.shape for old, new in zip(before, after, strict=True)):
        return None
    actions: list[dict[str, Any]] = []
    poses = changed_poses(given, shown.changed)
    if poses and prepared.moved:
        return None
    if poses:
        read = {key: keys.get(key) for key in ("sha256", "units")}
        actions.append({"do": "poses", "poses": poses, **read})
    for old, new in zip(before, after, strict=True):
        if new.grounded and not old.grounded:
            actions.append({"do": "hold", "parts": [new.name], "on": True})
        if new.given_mass != old.given_mass:
            actions.append({"do": "mass", "part": new.name, "mass": new.given_mass})
    actions += [
        {"do": "pair_friction", "parts": list(pair.parts), "mu": pair.mu}
        for pair in shown.changed.friction_pairs
        if pair not in given.friction_pairs
    ]
    return _action(shown, actions)


def _action(shown: ShownChange, actions: list[dict[str, Any]]) -> dict[str, Any]:
    return {"do": "improve", "label": "; ".join(shown.sentences), "actions": actions}


def change_picture(shown: ShownChange, given: Assembly, center: Array) -> dict[str, Any]:
    """Data of a change for the picture: its parts, arrows of movements, and the changed shapes."""
    parts, changed, index = given.parts, shown.changed, given.index
    poses: dict[str, Any] = {}
    ghosts = [k for k, part in enumerate(changed.parts) if part.name not in index]
    if len(changed.parts) == len(parts):  # else a brick comes or goes, and no part moves
        poses = changed_poses(given, changed)
        ghosts = [
            k
            for k, (old, new) in enumerate(zip(parts, changed.parts, strict=True))
            if new.name in poses or new.shape is not old.shape
        ]
    return {
        "parts": [index[name] for name in shown.parts if name in index],
        "pushes": [
            {
                "part": index[name],
                "along": (np.array(pose["position"]) - parts[index[name]].pose.position).tolist(),
            }
            for name, pose in poses.items()
        ],
        "ghost": _merged(changed, ghosts, center) if ghosts else None,
    }


def _merged(assembly: Assembly, parts: Sequence[int], center: Array) -> dict[str, Any]:
    """Shapes of some parts as a single shape, relative to `center`."""
    places = place_shapes(assembly)
    turns, count = quaternion_to_matrix(places.rotation), 0
    positions, triangles, edges = [], [], []
    for k in parts:
        shape = places.shapes[places.shape[k]]
        positions.append(shape.positions @ turns[k].T + places.position[k] - center)
        triangles.append(shape.triangles + count)
        edges.append(shape.edges + count)
        count += len(shape.positions)
    return {
        "positions": pack(np.concatenate(positions)),
        "triangles": pack(np.concatenate(triangles), "index"),
        "edges": pack(np.concatenate(edges), "index"),
    }
