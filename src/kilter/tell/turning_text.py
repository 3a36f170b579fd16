"""Answers about orientations as text for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.tell.text import LISTED, joint_rows, moving_lines, table, vector

if TYPE_CHECKING:
    from kilter.analysis.regions.region import Region
    from kilter.analysis.turning.orientation import Orientation

__all__ = ["orient_text", "region_text"]

KINDS = {
    "none": "No direction of gravity is stable.",
    "ray": "One direction of gravity is stable, and none near it.",
    "line": "Two opposite directions of gravity are stable, and none near them.",
    "fan": "The stable directions of gravity are a fan: a flat sector.",
    "half-plane": "The stable directions of gravity are a half-plane.",
    "plane": "The stable directions of gravity are all those of a plane.",
    "cone": "The stable directions of gravity are a cone with a tip.",
    "wedge": "The stable directions of gravity are a wedge between two planes.",
    "half-space": "The stable directions of gravity are a half-space.",
    "all": "Every direction of gravity is stable: it is locked.",
}

HELD = "With friction, where forces that hold it exist ('kilter check --down' tells the rest):"


def orient_text(answer: Orientation) -> str:
    """The answer of `kilter orient`."""
    rows = [
        ["down", f"{vector(answer.down)} in the frame of the assembly"],
        [
            "turn",
            f"quaternion (w, x, y, z) {vector(answer.rotation)}: takes it to the file's gravity",
        ],
    ]
    if answer.found:
        rows.append(
            ["margin", f"{answer.tilt_margin_deg:.6g} deg to the nearest unstable direction"]
        )
        rows.append(["region", str(answer.region)])
        forces = answer.judgement.forces
        if forces is not None:
            rows.append(
                ["proof", f"forces that balance every part to {forces.residual:.1e} of its weight"]
            )
    else:
        rows.append(["z", f"{answer.z:.6g} (LP (9)), kappa {answer.instability:.6g}"])
        rows += _nearest(answer)
    rows += joint_rows(answer.assembly)
    rows.append(["programs", f"{answer.programs} solved"])
    lines = [answer.sentence, ""]
    if answer.check is not None:
        lines += moving_lines(answer.check)
    return "\n".join([*lines, *table(rows, indent="")])


def _nearest(answer: Orientation) -> list[list[str]]:
    """The directions nearest to stable, in three senses."""
    near = answer.nearest
    if near is None:
        return []
    diamond, sphere, kappa = near.diamond, near.sphere, near.kappa
    least = f"{kappa.value:.6g} (no direction has less than {kappa.bound:.6g})"
    return [
        ["nearest", f"{vector(diamond.direction)} on the paper's diamond, z = {diamond.value:.6g}"],
        ["", f"{vector(sphere.direction)} on the sphere, z = {sphere.value:.6g}"],
        ["", f"{vector(kappa.direction)} by kappa, {least}"],
    ]


def region_text(region: Region) -> str:
    """The answer of `kilter region`."""
    head = KINDS[region.kind]
    if region.friction:
        head = f"{HELD} {head.replace('stable', 'held')}"
    elif not region.exact:
        head = f"Without friction and contacts not modelled: {head[0].lower()}{head[1:]}"
    lines = [head, ""]
    rows = [["kind", f"{region.kind}, dimension {region.dimension}"]]
    half = region.half_angle_deg
    if region.center is not None:
        rows.append(["center", f"{vector(region.center)}: the direction with the widest margin"])
    if half is not None:
        rows.append(["half angle", f"{half:.6g} deg, of the widest circular cone inside"])
    if region.gap_deg is not None:
        rows.append(
            ["gap", f"{region.gap_deg:.3g} deg at most between rays inside, facets outside"]
        )
    for name, what, vectors in (
        ("lines", "both senses stable", region.lines),
        ("rays", "extreme directions", region.rays),
        ("equations", "q.g = 0", region.equations),
        ("facets", "q.g >= 0", region.facets),
    ):
        for k, one in enumerate(np.asarray(vectors)[:LISTED]):
            rows.append([name if k == 0 else "", f"{vector(one)}{f'  ({what})' if k == 0 else ''}"])
        if len(vectors) > LISTED:
            rows.append(["", f"and {len(vectors) - LISTED} more (--json lists all)"])
    rows += joint_rows(region.assemblies[0])
    rows.append(["programs", f"{region.programs} solved"])
    return "\n".join([*lines, *table(rows, indent="")])
