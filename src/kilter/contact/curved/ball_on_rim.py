"""Candidate contacts of balls with the round rims of narrower holes.

The end of a hollow cylinder at the height t of its axis a is a circle of radius r about the point
c = p + t a. A ball of radius R > r about the axis, with its centre at the height h over c, outside
of the hole, touches the whole rim if r^2 + h^2 = R^2. The normals of the contact are those of the
ball: from its centre to the rim, (r u - h a) / R for the direction u away from the axis.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, SPHERE
from kilter.contact.curved.candidates import CIRCLE, Candidates, dot, make_candidates
from kilter.contact.curved.coverage import bands_of

__all__ = ["balls_on_rims"]


def balls_on_rims(geometry: Geometry, i: Index, j: Index, gap: Array) -> Candidates:
    """Candidate circle contacts of balls with the ends of hollow cylinders.

    Parameters
    ----------
    geometry : Geometry
    i, j : ndarray of int, shape (n,)
        Surfaces of each pair; pairs of other kinds have no candidates.
    gap : ndarray, shape (n,)
        Largest distance of the ball's centre from the axis [length unit].

    Returns
    -------
    Candidates
        Of the form CIRCLE; normals lead from i to j.
    """
    s = geometry.surfaces

    def are(first: Index, second: Index) -> Index:
        """Rows with a ball in `first` and a narrower hollow cylinder in `second`."""
        pairs = (s.kind[first] == SPHERE) & ~s.hollow[first]
        pairs &= (s.kind[second] == CYLINDER) & s.hollow[second]
        return np.flatnonzero(pairs & (s.radius[second] < s.radius[first]))

    forth, back = are(i, j), are(j, i)
    row = np.concatenate([forth, back])
    if not len(row):
        return Candidates.join([])
    ball, hole = np.append(i[forth], j[back]), np.append(j[forth], i[back])
    sense = np.append(np.ones(len(forth)), -np.ones(len(back)))
    used, band_row = np.unique(hole, return_inverse=True)
    bands = bands_of(geometry, used)
    ends = [(bands.low[band_row], -1.0), (bands.high[band_row], 1.0)]
    blocks = []
    for height, end in ends:
        axis, radius = s.axis[hole], s.radius[hole]
        center = s.point[hole] + height[:, None] * axis
        over = dot(s.point[ball] - center, axis)
        aside = np.linalg.norm(s.point[ball] - center - over[:, None] * axis, axis=1)
        distance = np.hypot(radius, over)
        keep = np.flatnonzero((end * over > 0) & (aside <= gap[row]))
        out, up = radius / distance, -over / distance
        normal = sense[:, None] * np.column_stack([out, up, 0 * out])
        blocks.append(
            make_candidates(
                row[keep],
                CIRCLE,
                center[keep],
                normal[keep],
                (distance - s.radius[ball])[keep],
                along=axis[keep],
                radius=radius[keep],
                swing=(aside * out)[keep],
                bend=s.radius[ball[keep]],
                rim=np.where(sense > 0, 2.0, 1.0)[keep],
            )
        )
    return Candidates.join(blocks)
