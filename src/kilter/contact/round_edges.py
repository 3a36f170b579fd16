"""Whether a flat contact ends at a round edge, which its corners replace by an inscribed polygon.

An assembly tips over the polygon and not over the circle, so a tilt limit is too small by up to
1 - cos(pi / n) of the distance to the edge, for n corners.
"""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet

__all__ = ["has_round_edges"]

SAME_CORNER = 1e-9
"""A contact point within this share of the size of a part is a corner of this part [-]."""


def has_round_edges(assembly: Assembly, contacts: ContactSet) -> bool:
    """Whether a corner of a flat contact is a corner of a facet of a curved surface.

    Examples
    --------
    >>> from kilter import Box, Cylinder, Part, contacts
    >>> table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    >>> for shape in (Box(1, 1, 4), Cylinder(1, 4)):
    ...     stood = Assembly([table, Part("tower", shape, [0, 0, 2])])
    ...     print(has_round_edges(stood, contacts(stood)))
    False
    True
    """
    g = assembly.geometry
    curved = g.triangle_surface >= 0
    flat = [k for k, kind in enumerate(contacts.patch_kind) if kind == "plane"]
    if not (curved.any() and flat):
        return False
    from scipy.spatial import cKDTree  # slow to import

    corners = cKDTree(g.vertices[np.unique(g.triangles[curved])])
    rows = np.concatenate(
        [np.arange(contacts.patch_start[k], contacts.patch_start[k + 1]) for k in flat]
    )
    away, _ = corners.query(contacts.points[rows])
    return bool(away.min() <= SAME_CORNER * g.size.max())
