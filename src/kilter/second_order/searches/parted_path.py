"""Paths that lead down and part what touches beside, as boxes that fall from among others.

Parts also move level while they fall, away from one place or all alike: what lies on level faces is
none the higher for it, and what has no one normal, or stays in touch along the path, is opened.
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
"""Of the motion away, over that of the path."""
MOST = 4
"""Paths that are parted, those of fewest parts first."""


def parted_paths(
    program: Program,
    contacts: ContactSet,
    problem: Stationary,
    paths: tuple[Path, ...],
    work: Work,
) -> Iterator[Path]:
    """Such paths near to some.

    Parameters
    ----------
    program : Program
        Also with the rows of points that have no one normal (`with_sharp`).
    contacts : ContactSet
    problem : Stationary
        Of the contacts that are certain.
    paths : tuple of Path
    """

    def moved(path: Path) -> int:
        by_part = path.first.reshape(-1, len(program.freedoms))
        return int((np.abs(by_part).max(axis=1) > ACROSS).sum())

    shifts = _level_shifts(program, contacts, problem, work)
    for one in sorted(paths, key=moved)[:MOST]:
        for away in shifts:
            for share in SHARES:
                found = find_path(problem, one.first + share * away, work=work)
                if found is not None and found.falls:
                    yield found


def _level_shifts(
    program: Program, contacts: ContactSet, problem: Stationary, work: Work
) -> list[Array]:
    """All parts away from one place, where that parts what is not level, and all alike."""
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
