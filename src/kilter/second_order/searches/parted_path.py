"""Falling paths along which the falling parts also separate from their neighbours.

While they fall, all parts also move level, away from a common point or in a common direction. Parts
on level faces keep their height, while sharp points and contacts that stay closed along the path
open: so a box falls from among others.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kilter.arrays import Array
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_span import scaled_columns
from kilter.second_order.motions.sharp_points import sharp_points
from kilter.second_order.parts.bearing import level_axes
from kilter.second_order.proofs.level_rest import level_rows
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.level_rest_search import find_parting
from kilter.second_order.searches.path_search import find_path
from kilter.second_order.second_order_tolerances import ACROSS
from kilter.work import Work

__all__ = ["parted_paths"]

SHARES = (0.3, 1.0, 3.0)
"""Lengths of the added horizontal motion, over the length of the path [-]."""
MOST = 4
"""Largest number of paths that are tried; paths of few parts come first."""


def parted_paths(
    program: Program,
    contacts: ContactSet,
    problem: Stationary,
    paths: tuple[Path, ...],
    work: Work,
) -> Iterator[Path]:
    """Yield falling paths near given ones, with added shifts that open other contacts."""

    def moved(path: Path) -> int:
        by_part = path.first.reshape(-1, len(program.freedoms))
        return int((np.abs(by_part).max(axis=1) > ACROSS).sum())

    shifts = _level_shifts(program, contacts, problem, work)
    for path in sorted(paths, key=moved)[:MOST]:
        for away in shifts:
            for share in SHARES:
                parted = find_path(problem, path.first + share * away, work=work)
                if parted is not None and parted.falls:
                    yield parted


def _level_shifts(
    program: Program, contacts: ContactSet, problem: Stationary, work: Work
) -> list[Array]:
    """Horizontal motions, (n,): parts away from a common point, and all parts alike."""
    points = sharp_points(program, contacts)
    parting = find_parting(program, level_rows(program, contacts), points, work)
    motions = [] if parting is None else [parting]
    for axis in level_axes(program):
        for sense in (1.0, -1.0):
            motion = np.zeros((len(program.names), 6))
            motion[program.free, :3] = sense * axis
            motions.append(motion)
    columns = scaled_columns(program, problem, np.array(motions))
    return list((columns / np.linalg.norm(columns, axis=0)).T)
