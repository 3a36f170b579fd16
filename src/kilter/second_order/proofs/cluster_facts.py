"""Data of a cluster that proofs are verified against, computed from the assembly alone.

Judges and searches use the same facts; each is computed when it is first used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from kilter.arrays import Index, Mask
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.clusters import Cluster
from kilter.mechanics.program import Program
from kilter.mechanics.rows import POSSIBLE
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.stationary import Stationary, bounded, formed_for_all, problem_of
from kilter.second_order.gaps.touched_surfaces import Touched, planes_of, touched_surfaces
from kilter.second_order.motions.free_motions import FreeMotions, find_free_motions

Judged = str | tuple[str, int | None, int | None]
"""Result of a verification: the reason of failure, or the proved state, number of neutral motions
and number of free motions.

The counts of a balanced cluster are None: a path that leads down does not prove them.
"""


class ClusterFacts:
    """Geometry and contact gaps of a cluster, for the verification of proofs; lazy.

    Arguments: `program`: contacts of the cluster, without friction; groups of tied parts are
    merged.
    """

    def __init__(
        self,
        assembly: Assembly,
        contacts: ContactSet,
        program: Program,
        find_features: Callable[[], Features],
    ) -> None:
        self.assembly, self.contacts, self.program = assembly, contacts, program
        self._find_features = find_features

    def taking(self, rows: Index | Mask) -> ClusterFacts:
        """The same data for a subset of the contacts."""
        chosen = np.arange(len(self.program.kind))[rows]
        return ClusterFacts(
            self.assembly,
            self.contacts,
            self.program.taking(chosen),
            lambda: self.features.take(chosen),
        )

    def of_cluster(self, cluster: Cluster) -> ClusterFacts:
        """The same data for a cluster whose program is part of this program."""
        return ClusterFacts(
            self.assembly,
            self.contacts,
            cluster.program,
            lambda: self.features.take(cluster.rows),
        )

    @cached_property
    def certain(self) -> ClusterFacts:
        """The same data without contacts of edges and corners that have no unique normal."""
        rows = self.program.kind != POSSIBLE
        return self if rows.all() else self.taking(rows)

    @cached_property
    def features(self) -> Features:
        """Features (face, edge, vertex) of both parts at the cluster's contact rows."""
        return self._find_features()

    @cached_property
    def known(self) -> Mask:
        """Mask of the contact rows whose gap has a second derivative, shape (K,)."""
        return formed_for_all(self.program, self.features)

    @cached_property
    def touched(self) -> tuple[Touched, Touched]:
        """Exact surfaces of parts a and of parts b at the cluster's contact rows."""
        return touched_surfaces(self.program, self.features, self.contacts, self.assembly.joints)

    @cached_property
    def free_motions(self) -> FreeMotions:
        """Motions of the cluster's parts that keep every gap and the energy exactly."""
        return find_free_motions(self.program, self.features, self.touched)

    @cached_property
    def problem(self) -> Stationary:
        """Contact gaps and load of the cluster, to second order."""
        problem = problem_of(self.program, self.features, self.assembly.joints)
        return replace(problem, on_plane=planes_of(self.touched))

    def bounded(self, sense: float) -> Stationary:
        """Contact gaps to second order, at the upper (1) or lower (-1) bounds of all curvatures."""
        if not self.features.doubted:
            return self.problem
        problem = bounded(self.program, self.features, sense, self.assembly.joints)
        return replace(problem, on_plane=planes_of(self.touched))
